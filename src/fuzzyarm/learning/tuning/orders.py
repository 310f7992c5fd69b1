"""A request of tuning resolved: the file, its plant, samples, the journal."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from fuzzyarm.base import above
from fuzzyarm.base.errors import UsageError, WordError
from fuzzyarm.base.numbers import read_time
from fuzzyarm.base.shipped_files import shipped, shipped_names
from fuzzyarm.control.controllers.catalogue import controller_of
from fuzzyarm.control.controllers.text import ControllerText, files_of
from fuzzyarm.control.loop.experiments import (
    ALONG,
    files_named,
    follows,
    trajectory_of_request,
    with_drives,
    with_plant,
)
from fuzzyarm.control.loop.sweep import read_range
from fuzzyarm.control.loop.words import (
    connections,
    conventions_of,
    motion_of,
    references_of,
    seconds,
)
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.learning.data import Columns, Samples, column_names, read_samples
from fuzzyarm.learning.tuning.scenarios import Scenario, Stage, plant_scenarios, scenario_along
from fuzzyarm.learning.tuning.search import Journal
from fuzzyarm.learning.tuning.text import demand_not_used
from fuzzyarm.plant.plant import Plant
from fuzzyarm.plant.setting import Conventions
from fuzzyarm.plant.trajectory import carried
from fuzzyarm.requests.journal import question_of
from fuzzyarm.requests.tune import TuneRequest


class Order(NamedTuple):
    """The subject and the task of a tuning.

    Attributes
    ----------
    path : str
        The file.
    subject : ControllerText or RuleBase
        Its content.
    stage : Stage or None
        Where a controller runs.
    samples : dict of str to Samples
        ``data`` and ``test`` of a rule base alone.
    conventions : Conventions
        Conventions of the runs.
    journal : Journal or None
        Where trials are written down.
    """

    path: str
    subject: ControllerText | RuleBase
    stage: Stage | None
    samples: dict[str, Samples]
    conventions: Conventions
    journal: Journal | None


def order_of(request: TuneRequest) -> Order:
    """Resolve a request; a journal is begun."""
    require_sensible(request)
    path, subject = _subject(request.file)
    if request.out is not None:  # before the search, not after it
        demand_not_used(request.out, subject, path)
    stage, samples = None, dict[str, Samples]()
    if isinstance(subject, ControllerText):
        if request.data:
            raise WordError("--data is for a rule base alone; a controller runs in its loop")
        request, plant = with_plant(request, [controller_of(subject)])
        stage = stage_of_request(request, subject, plant)
    else:
        samples = samples_of(request, subject)
    journal = _journal(request, path, subject) if request.journal else None
    return Order(path, subject, stage, samples, conventions_of(request), journal)


def require_sensible(request: TuneRequest) -> None:
    """Raise for mistakes that show before anything is loaded."""
    if request.resume and not request.journal:
        raise UsageError("--resume needs the file of --journal")
    if request.test and not request.data:
        raise UsageError("--test needs --data")


def longest(request: TuneRequest) -> float:
    """Return the greatest duration of the whole, s."""
    limit = read_time(request.time, "--time") if request.time else math.inf
    if not limit > 0.0:
        raise UsageError(f"--time must be above 0 s, not {request.time}")
    return limit


def _subject(word: str) -> tuple[str, ControllerText | RuleBase]:
    """Return a file and its content; a name of the catalogue is a shipped file."""
    path = word
    if not Path(word).exists() and f"{word}.frb" in shipped_names():
        path = str(shipped(f"{word}.frb"))
    model = above.function("load")(path)
    if not isinstance(model, ControllerText | RuleBase):
        raise WordError(f"{word} is a table; a controller or a rule base is tuned")
    return path, model


# --- The task ---


def stage_of_request(request: TuneRequest, text: ControllerText, plant: Plant) -> Stage:
    """Return the stage of a controller: its plant and references."""
    along = follows(request, plant)
    plant, options = with_drives(request, plant)
    connect, vary = connections(request), tuple(map(read_range, request.vary))
    if along:
        payload = 0.0 if request.payload is False else 1.0
        first = plant_scenarios(plant, payload)
        if request.given((*ALONG, "loaded")):
            way = trajectory_of_request(request, plant)
            if request.loaded:
                way = replace(way, loaded=carried(way, segments=request.loaded))
            first = (scenario_along(plant, way, payload),)
        return Stage(plant, first, options, vary, connect=connect)
    motion = motion_of(request, controller_of(text), plant)
    references = references_of(request, controller_of(text), plant)
    first = (Scenario(motion.name, motion),)
    return Stage(plant, first, options, vary, references, seconds(request), connect)


def samples_of(request: TuneRequest, rulebase: RuleBase) -> dict[str, Samples]:
    """Return the samples for a rule base alone, by ``data`` and ``test``."""
    if not request.data:
        if request.cost is not None and ".py:" in request.cost:
            return {}
        message = f"'{rulebase.name}' is a rule base alone: nothing says what is good"
        hint = "--data set.csv, or tune the controller that uses it"
        raise WordError(message, hint=hint)
    columns = columns_for(request.data, rulebase, request.target)
    samples = {"data": read_samples(request.data, columns)}
    if request.test:
        samples["test"] = read_samples(request.test, columns)
    return samples


def columns_for(path: str, rulebase: RuleBase, target: str | None = None) -> Columns:
    """Return the columns of a file for the inputs and the output of a rule base.

    Without a target it is the column named like the only output, or the last one.
    """
    inputs = tuple(variable.name for variable in rulebase.inputs)
    outputs = [output.name for output in rulebase.outputs]
    if target is None and len(outputs) == 1 and outputs[0] in column_names(path):
        target = outputs[0]
    return Columns(target, inputs)


# --- The journal ---


def _journal(request: TuneRequest, path: str, subject: ControllerText | RuleBase) -> Journal:
    files = files_named(request) | {Path(path).name: Path(path)}
    if isinstance(subject, ControllerText):
        files |= files_of(subject.model, path)
    words = [request.data, (request.cost or "").rpartition(":")[0]]
    files |= {word: Path(word) for word in words if word}
    assert request.journal is not None
    return Journal(request.journal, question_of(request.question(), files), resume=request.resume)
