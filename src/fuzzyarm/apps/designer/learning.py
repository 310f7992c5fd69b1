"""Learning, watched and paused by the user: an SOC table that grows cell by cell, and can be saved.

The training is that of ``fuzzyarm learn`` (`Trainee`), and so are the bits of the written file.
Words of a page: ``go`` (``run``, ``pause``, ``step`` for one pass, ``stop``), ``speed`` and
``save``.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.apps.designer.forms import LEARN
from fuzzyarm.apps.designer.grounds import (
    GroundsError,
    at_field,
    check_words,
    plant_named,
    plants_for,
    seconds_of,
    trajectory_motion_of,
)
from fuzzyarm.apps.designer.jobs import WindowJob, save_beside
from fuzzyarm.apps.designer.requests import BareMessage, LearnWord, LearnWork
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.apps.show.learning import error_panel
from fuzzyarm.base.picture import panel_data
from fuzzyarm.language import parse

if TYPE_CHECKING:
    from fuzzyarm.control.loop import Motion
    from fuzzyarm.language.model.controller import ControllerModel
    from fuzzyarm.learning.self_organizing import Snapshot, Trainee

FRAMES = 40
"""Pictures of a pass."""

FRAME = 0.04
"""Minimum seconds between two pictures of a watched pass."""

SPEEDS = {"watch": FRAME, "fast": 0.0}
"""Seconds of a picture; ``fast`` shows whole passes only."""

DEFAULT_PASSES = 6


def controller_model(session: Session) -> ControllerModel | None:
    """Return the controller in a text; None without one, or with mistakes."""
    if session.path.lower().endswith(".lut"):
        return None
    return parse(session.text, session.path).controller


def learnable(session: Session, request: BareMessage, job: WindowJob) -> None:
    """Send the trainable controllers, their plants, and their possible starts."""
    from fuzzyarm.control.controllers.catalogue import TEXTS
    from fuzzyarm.language.model.controller import Learn
    from fuzzyarm.language.reading import read_text

    def fitting(model: ControllerModel) -> list[dict[str, Any]]:
        return [plant for plant in plants_for(model, job.plants) if plant["fits"]]

    def teaches(model: ControllerModel | None) -> bool:
        return model is not None and any(isinstance(line, Learn) for _, line in model.lines())

    trainees = []
    open_model = controller_model(session)
    if open_model is not None and teaches(open_model):
        trainees.append({"name": "", "plants": fitting(open_model)})
    for entry in TEXTS:
        model = parse(read_text(entry.file())).controller
        if model is not None and teaches(model):
            trainees.append({"name": entry.name, "plants": fitting(model)})
    job.tell({
        "texts": trainees,
        "own": teaches(open_model),
        "tables": job.folder.listed(".lut"),
        "form": LEARN.fields(passes=DEFAULT_PASSES),
    })  # fmt: skip


def learn(session: Session, request: LearnWork, job: WindowJob) -> None:
    """Train and report until the page stops."""
    TrainingWork(session, request, job).run()


class TrainingWork:
    """A training for a page.

    Parameters
    ----------
    session : Session
        The open text.
    asked : LearnWork
        The request.
    job : WindowJob
        The channel of messages.
    """

    def __init__(self, session: Session, request: LearnWork, job: WindowJob) -> None:
        self.job = job
        values = {"passes": DEFAULT_PASSES, **request.form}
        self.request = LEARN.request(values, Path(session.path).parent)
        self.passes = self.request.passes
        self.limit = self.passes
        self.name, self.trainee = self._trainee(session)
        self.motion, self.along = self._motion()
        self.mode: str = "step" if request.step else "run"
        self.hold = SPEEDS[request.speed]
        self.errors: list[list[float]] = []
        self.told_errors = 0
        self.last: Snapshot | None = None

    # --- Controller and plant ---

    def _trainee(self, session: Session) -> tuple[str, Trainee]:
        from fuzzyarm.control.controllers.catalogue import (
            CATALOGUE,
            Choice,
            Sources,
            TextEntry,
            text_controller,
        )
        from fuzzyarm.control.controllers.text import teaching
        from fuzzyarm.language.reading import read_text
        from fuzzyarm.learning.self_organizing import Trainee

        request = self.request
        name = request.controller
        path, source = session.path, str(session.text)
        if name:
            entry = CATALOGUE.get(name)
            if not isinstance(entry, TextEntry):
                raise GroundsError(f"'{name}' is not a shipped controller")
            path, source = str(entry.file()), read_text(entry.file())
        elif session.path.lower().endswith(".lut"):
            raise GroundsError("a table does not learn by itself; choose a controller")
        choice = Choice(sources=Sources(table=self._start()))
        controller = text_controller(
            path,
            choice,
            change=teaching(0.0 if request.freeze else request.rate, request.delay),
            source=source,
        )
        title = name or Path(path).name
        model = parse(source, path).controller
        assert model is not None
        plant = plant_named(request.plant or "", model, self.job.plants)
        return title, Trainee(controller, plant, name=title)

    @property
    def start(self) -> str:
        """The file of the table to begin with; empty for that of the text."""
        (word,) = self.request.begin
        return "" if word == "zero" else word

    def _start(self) -> Any:
        """Return the table to begin with; None for that of the text."""
        from fuzzyarm.table import read_table

        name = self.start
        if not name:
            return None
        if name not in self.job.folder.listed(".lut"):
            raise GroundsError(f"'{name}' is not a table of this folder")
        return (read_table(self.job.folder.beside(name, ".lut")),)

    def _motion(self) -> tuple[Motion, str]:
        """Return the set points, and their path in words."""
        from fuzzyarm.control.loop.run import plant_motion
        from fuzzyarm.control.loop.words import signals
        from fuzzyarm.learning.self_organizing import reference_words, trajectory_words

        request, plant = self.request, self.trainee.plant
        if plant.trajectories:
            motion = trajectory_motion_of(
                request.trajectory or "",
                self.trainee.controller,
                plant,
                payload=bool(request.payload),
            )
            return motion, trajectory_words(motion.name, payload=any(motion.carrying))
        check_words(request, plant)
        with at_field("duration"):
            seconds = None if request.duration is None else seconds_of(request.duration)
        motion = plant_motion(self.trainee.controller, plant, signals(request) or None, seconds)
        named = Path(request.plant or plant.name).name  # as in the command
        return motion, reference_words(named, request.reference)

    # --- The training ---

    def run(self) -> None:
        """Train until the page cancels."""
        self._tell_begin()
        for snapshot in self._snapshots():
            self.last = snapshot
            if snapshot.complete:
                self.errors.append([float(error) for error in snapshot.rms])
            for word in self.job.heard(LearnWord):
                self._obey(word)
            if self._is_due(snapshot):
                self.mode = "pause"
            self._show(snapshot)
            while self.mode == "pause":
                self._obey(self.job.word(LearnWord))
            if self.mode == "stop":
                break
            if snapshot.complete and snapshot.passage >= self.limit:  # to be continued
                self.limit += 1 if self.mode == "step" else self.passes
        self.mode = "stop"
        if self.last is not None:
            self._show(self.last)
        while True:  # the result can still be saved
            self._obey(self.job.word(LearnWord))

    def _is_due(self, snapshot: Snapshot) -> bool:
        """Whether it rests here: after one pass, or after the requested number."""
        if not snapshot.complete or snapshot.diverged is not None or self.mode == "stop":
            return False
        return self.mode == "step" or snapshot.passage >= self.limit

    def _snapshots(self) -> Iterator[Snapshot]:
        from fuzzyarm.requests.bounds import MOST_PASSES

        every = max(1, math.ceil(len(self.motion.time) / FRAMES))
        return self.trainee.snapshots(self.motion, MOST_PASSES, every)

    def _obey(self, word: LearnWord) -> None:
        """Obey the page."""
        if word.go is not None and self.mode != "stop":
            self.mode = word.go
        if word.speed is not None:
            self.hold = SPEEDS[word.speed]
        if word.save is not None:
            self._save(word.save, replace=word.replace)

    @property
    def goes_on(self) -> bool:
        """Whether it neither waits nor has been stopped."""
        return self.mode in ("run", "step")

    # --- Messages ---

    def _tell_begin(self) -> None:
        trainee = self.trainee
        down, across = (None, *trainee.start.axes)[-2:]
        assert across is not None
        table = trainee.like
        self.job.tell({
            "begin": {
                "title": self.name,
                "along": self.along,
                "plant": trainee.plant.name,
                "axes": list(trainee.axes),
                "down": None if down is None else {"name": down.name, "levels": list(down.levels)},
                "across": {"name": across.name, "levels": list(across.levels)},
                "paged": len(trainee.start.axes) > 2,
                "low": table.low,
                "high": table.high,
                "rate": trainee.rate,
            },
        })  # fmt: skip

    def _show(self, snapshot: Snapshot) -> None:
        """Send the state; of a fast training only whole passes."""
        if self.hold == 0.0 and self.goes_on and not snapshot.complete:
            return
        begin = time.monotonic()
        self.job.tell(self._news(snapshot))
        rest = max(self.hold, 0.02) - (time.monotonic() - begin)
        if self.goes_on and rest > 0.0:
            time.sleep(rest)

    def _news(self, snapshot: Snapshot) -> dict[str, Any]:
        from fuzzyarm.learning.self_organizing import error_words, state_of

        counts = state_of(snapshot, self.trainee.start)
        pages = snapshot.learned.pages()
        fresh, self.told_errors = self.errors[self.told_errors :], len(self.errors)
        return {
            "mode": "run" if self.goes_on else self.mode,
            "pass": snapshot.passage,
            "limit": self.limit,
            "time": snapshot.time,
            "complete": snapshot.complete,
            "diverged": snapshot.diverged,
            "words": error_words(snapshot),
            "units": list(snapshot.units),
            "errors": fresh,
            "panel": panel_data(
                error_panel(self.trainee.axes, snapshot.units, self.errors, self.limit)
            ),
            "tables": [
                {
                    "values": values.ravel().tolist(),
                    "visits": visits.ravel().tolist(),
                    **count._asdict(),
                }
                for (values, visits), count in zip(pages, counts, strict=True)
            ],
        }

    # --- The file ---

    def _save(self, name: str, *, replace: bool) -> None:
        """Write the present tables; over an existing file only on the page's request."""

        def write(path: Path) -> None:
            from fuzzyarm.table import write_table

            snapshot = self.last
            if snapshot is None:
                raise GroundsError("nothing has been learned yet")
            write_table(self.trainee.table(snapshot.learned, self._provenance(snapshot)), path)

        save_beside(self.job, name, ".lut", write, replace=replace)

    def _provenance(self, snapshot: Snapshot) -> dict[str, str]:
        whole = snapshot.passage if snapshot.complete else snapshot.passage - 1
        rest = "" if snapshot.complete else f" and {snapshot.time:.3f} s of the next"
        pairs = self.trainee.provenance(self.along, f"{whole}{rest}", self.start)
        return {**pairs, "controller": self.name}
