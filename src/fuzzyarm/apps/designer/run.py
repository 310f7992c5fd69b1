"""A running controller for the view *Run*, as long work.

A run is stepped by the loop of ``fuzzyarm simulate`` in parts that last as long as a picture is
shown; between two parts the user may pause it, push the plant, move a gain, or change the text.

Actions of the user are `RunWord` messages. News to the page, under ``news``: ``ready`` (the
drawing), ``samples`` (since the last ones, with the picture), ``metrics``, ``reached``, ``over``,
``text`` (whether a new text runs) and ``note`` (with ``field`` for a wrong field of the page).

A run with ``until`` stands still at that time, with all of it in view; to go on, or a hand that
pushes the plant, takes it further. One with ``duration`` is over then.
"""

from __future__ import annotations

import math
import time
from collections.abc import Hashable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.apps.designer.faults import TextRefusedError
from fuzzyarm.apps.designer.forms import RUN
from fuzzyarm.apps.designer.grounds import at_field, check_words, seconds_of, trajectory_motion_of
from fuzzyarm.apps.designer.jobs import WindowJob
from fuzzyarm.apps.designer.names import in_words
from fuzzyarm.apps.designer.records import Absent, MessageError
from fuzzyarm.apps.designer.requests import PlantsWork, RunWord, RunWork
from fuzzyarm.apps.designer.stage import Plants, loads_of
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.base.diagnostic import RuleBaseError
from fuzzyarm.base.errors import FuzzyarmError, WordError
from fuzzyarm.base.names import printable
from fuzzyarm.base.picture import drawing_data, short
from fuzzyarm.control.controllers.catalogue import controller_in
from fuzzyarm.control.controllers.code import SourceError
from fuzzyarm.control.controllers.controller import CompiledController
from fuzzyarm.control.controllers.findings import site_by_axes
from fuzzyarm.control.controllers.law import Gain
from fuzzyarm.control.controllers.on_plant import driven_by, site_of, text_law_of
from fuzzyarm.control.controllers.text import ControllerText, home_of, sheet_path
from fuzzyarm.control.loop.along import equipped
from fuzzyarm.control.loop.course import Motion, Options
from fuzzyarm.control.loop.open_run import OpenRun, StructureError
from fuzzyarm.control.loop.program import scales, shown_units
from fuzzyarm.control.loop.run import ClosedLoop, metric_units, text_of
from fuzzyarm.control.loop.words import connections, driven, motion_of, options_of
from fuzzyarm.language import parse
from fuzzyarm.plant.drawings import PlantScene, drawing_of, is_drawn
from fuzzyarm.plant.plant import Plant, PlantError
from fuzzyarm.plant.setting import PLAIN
from fuzzyarm.requests.experiment import ExperimentRequest

PICTURES = 30.0
"""In a second; a page with reduced motion gets fewer."""

CALM = 4.0
BUDGET = 0.02
"""Of a picture's time so much may go into the loop, s."""

MEASURED_EVERY, LONGEST_WAIT = 0.25, 2.0
"""Shortest and longest time between metrics, s; between them by their cost."""

OPEN_ENDED = 600_000
"""Set points of a run without a duration."""

MOST_POINTS = 2_000_000
"""Set points of a run with one."""

WINDOW_POINTS = 1_500
"""Points of a curve that fit into the window of time."""

MOST_AT_ONCE = 250
"""Points of a curve in one picture: their text takes most of the time."""

FASTEST = 1e9


class Running:
    """The long work ``run``, for the plants of a designer.

    Parameters
    ----------
    plants : Plants
        The plants.
    """

    def __init__(self, plants: Plants) -> None:
        self.plants = plants

    def __call__(self, session: Session, request: RunWork, job: WindowJob) -> None:
        """Run until the page cancels."""
        LiveRun(self.plants, session, request, job).go_on()

    def describe(self, session: Session, request: PlantsWork, job: WindowJob) -> None:
        """Send the plants, and which of them suit the text."""
        text = session.text if request.text is None else request.text
        if session.path.lower().endswith(".lut"):
            raise TextRefusedError(
                "a table does not run by itself",
                hint='a controller looks it up: use NAME from "FILE", u = table NAME(e, ce)',
            )
        job.tell({"uses": _uses(text, session.path)})
        try:
            controller = controller_of(text, session.path)
        except SourceError:
            if not is_rule_base(text, session.path):
                raise
            job.tell({"plants": [], "chosen": "", "likely": "", "direct": "", "alone": True})
            return
        plants = self.plants.described(controller)
        fitting = [plant["name"] for plant in plants if not plant["why"]]
        site = site_by_axes(source_of(controller).model)
        chosen = site.name if site is not None and site.name in fitting else None
        job.tell(
            {
                "plants": plants,
                "chosen": chosen or next(iter(fitting), ""),
                # As the command chooses it; a rule base runs on the plant of its controller.
                "likely": site.name if site is not None else "",
                # A rule base replaces that of a controller of the catalogue.
                "direct": "" if _is_in(controller, text) else controller.name,
                "alone": is_rule_base(text, session.path),
                "form": RUN.fields(),
            }
        )


def controller_of(text: str, path: str) -> CompiledController:
    """Return the controller in a text; of a rule base the one that evaluates it directly."""
    try:
        return controller_in(text, path)
    except RuleBaseError as error:
        first = error.diagnostics[0]
        named = Path(first.path).name
        whose = "the text" if named in ("", Path(path).name) else printable(named)
        raise TextRefusedError(f"{whose} has mistakes: {first.message}") from error


def _uses(text: str, path: str) -> list[str]:
    """Return the saved files that a controller uses."""
    model = parse(text, path).controller
    return sorted({file for use in model.uses for file in use.files}) if model else []


def is_rule_base(text: str, path: str) -> bool:
    """Whether a text has rules, and no controller around them."""
    parsed = parse(text, path)
    return parsed.rulebase is not None and parsed.controller is None


def _is_in(controller: CompiledController, text: str) -> bool:
    """Whether a text is of a controller, not of a rule base."""
    return source_of(controller).source == text


def source_of(controller: CompiledController) -> ControllerText:
    """Return the source text of a controller."""
    law = text_law_of(controller)
    assert law is not None
    return law.text


class LiveRun:
    """A run watched by a page.

    Parameters
    ----------
    plants : Plants
        The plants.
    session : Session
        The text when it was started.
    request : RunWork
        The request, in the words of ``fuzzyarm simulate``.
    job : WindowJob
        The connection with the page.
    """

    def __init__(self, plants: Plants, session: Session, request: RunWork, job: WindowJob) -> None:
        self.plants, self.path, self.job = plants, session.path, job
        self.request = request
        self.text = session.text
        self.gains: dict[str, list[float]] = {}  # moved by hand, and not in the text (yet)
        self.ranges: dict[Hashable, Range] = {}  # of sliders; a slider keeps its range
        self.speed = _speed(request.speed)
        self.paused = request.paused
        self.pull = (0.0, 0.0)
        self.rate = CALM if request.calm else PICTURES
        self._begin()

    # --- The loop ---

    def _begin(self) -> None:
        """Prepare everything from the present text, and report to the page."""
        self.controller = controller_of(self.text, self.path)
        self.used = self._used()
        self._forget_written()
        self.until: int | None = None  # the set point to stop at
        words = RUN.request(self.request.form, Path(self.path).parent)
        name = words.plant or ""
        check_words(words, self.plants.new(name))
        plant = driven(words, self.plants.new(name))
        motion, options = self._experiment(words, plant)
        chosen = self.controller.with_gains(self.gains)
        self.loop = ClosedLoop(chosen, motion, PLAIN, options, connections(words))
        self.run: OpenRun = self.loop.open(loaded=True)
        self.plant, self.motion = self.loop.course.plant, motion
        self.has_drawing = is_drawn(self.plant)
        self.sent = 0
        self.told_over = self.reached = self.told_reached = False
        self.measured, self.measuring, self.measured_at = -math.inf, 0.0, -1
        # Samples in a second of the loop: a guess, until it is measured.
        self.rate_of_loop = 20_000.0 if self.loop.compiled else 500.0
        self.behind = -math.inf
        self.last_state: tuple[Any, ...] = ()
        self.is_timed = words.duration is not None
        self._tell_ready(name)
        self.run.advance(1)  # for a first picture
        self._show()
        self._anchor()

    def _experiment(self, words: ExperimentRequest, plant: Plant) -> tuple[Motion, Options]:
        options = options_of(words, plant)
        plant = equipped(plant, options)
        if plant.trajectories:
            motion = trajectory_motion_of(
                words.trajectory or "", self.controller, plant, connections(words),
                payload=bool(words.payload),
            )  # fmt: skip
            return motion, options
        site = site_of(plant, connections(words))
        model = text_of(self.controller, site).model
        period = model.period * model.every
        word = words.duration or self.request.until
        if word:
            with at_field("duration"):
                seconds = seconds_of(word)
                if seconds > MOST_POINTS * period:
                    raise WordError(
                        f"the page runs up to {MOST_POINTS:,} set points, here of {period:g} s"
                    )
        if words.duration is None:
            most = OPEN_ENDED * period
            words = _lasting(words, max(most, seconds) if word else most)
            self.until = math.ceil(seconds / period - 1e-9) if word else None
        return motion_of(words, self.controller, plant), options

    # --- Going on ---

    def go_on(self) -> None:
        """Run until the page stops it."""
        while True:
            started = time.perf_counter()
            self._advance(started)
            self._show()
            every = 1.0 / self.rate
            idle = self.paused or self.run.over
            # A paused run waits for a word, and looks after the files it uses.
            pause = 0.2 if idle else max(0.001, every - (time.perf_counter() - started))
            for word in self.job.heard(RunWord, pause):
                self._obey(word)
            self.job.check()
            self._look_at_files()

    def _advance(self, now: float) -> None:
        if self.paused or self.run.over:
            return
        self._hold()
        samples = self.motion.period * self.motion.every
        most = max(1, int(self.rate_of_loop * BUDGET))
        due = self.anchor_at + (now - self.anchor) * self.speed / samples
        until = int(min(due, self.run.next + most))
        late = due - until
        if self.until is not None:
            until = min(until, self.until)
        if until > self.run.next:
            before, count = self.run.seconds, until - self.run.next
            self.run.advance(until)
            spent = max(self.run.seconds - before, 1e-6)
            # The first call of a kernel may compile it: no measure of the next.
            self.rate_of_loop += 0.5 * (min(count / spent, 1e7) - self.rate_of_loop)
        if self.until is not None and self.run.next >= self.until and not self.run.over:
            # A push takes the plant further: it comes back after the release.
            self.paused = self.reached = not any(self.pull)
            self.until = None
        if late > 0.25 * self.speed / samples:  # too slow
            if self.speed < FASTEST:
                self.behind = now
            self._anchor()

    def _anchor(self) -> None:
        """Count simulated and real time from here."""
        self.anchor, self.anchor_at = time.perf_counter(), float(self.run.next)

    def _hold(self) -> None:
        """Apply the pull of the hand at the plant's present position."""
        loads = {}
        if any(self.pull) and len(self.run.record.rows):
            loads = loads_of(self.plant, self._scene(), self.loop.site.interface, *self.pull)
        self.run.push(loads)

    def _scene(self) -> PlantScene:
        return PlantScene(self.loop.so_far(self.run), len(self.run.record.rows) - 1)

    # --- Words of the page ---

    def _obey(self, word: RunWord) -> None:
        before = self.__dict__.copy()
        if not isinstance(word.speed, Absent):
            self.speed = _speed(word.speed)
            self.behind = -math.inf
        if word.pause is not None:
            self.paused = word.pause
            self.reached = False
        if word.calm is not None:
            self.rate = CALM if word.calm else PICTURES
        if not isinstance(word.pull, Absent):
            self._pull(*(word.pull or (0.0, 0.0)))
        self._anchor()
        if word.gains is not None:
            self._move_gains(word.gains)
        if word.text is not None:
            self.text = word.text
            self._take_text()
        if word.step is not None:
            self.paused = True
            self._hold()
            self.run.advance(self.run.next + max(1, min(word.step, 10_000)))
        if word.restart:
            if word.asked is not None:
                self.request = word.asked
            self._try_again(before)

    def _pull(self, x: float, y: float) -> None:
        """Apply the user's push to the plant; a run at its time limit continues."""
        self.pull = (x, y)
        if self.reached and any(self.pull):
            self.paused = self.reached = False

    def _try_again(self, before: Mapping[str, Any]) -> None:
        """Begin anew; on failure restore the state before, and report the reason."""
        try:
            self._begin()
        except (FuzzyarmError, OSError) as error:
            self.__dict__.update(before)
            self._anchor()
            field = getattr(error, "field", "")
            self.job.tell({"news": "note", "text": in_words(error), "field": field})

    def _move_gains(self, values: Mapping[str, Sequence[float]]) -> None:
        gains = {**self.gains, **{name: list(value) for name, value in values.items()}}
        try:
            self.run.take_over(self.controller.with_gains(gains))
        except FuzzyarmError as error:
            self.job.tell({"news": "note", "text": str(error)})
            return
        self.gains = gains

    def _take_text(self) -> None:
        """Continue with the present text, if possible."""
        try:
            controller = controller_of(self.text, self.path)
            moved = {name: gain for name, gain in self.gains.items() if name in controller.gains}
            self.run.take_over(controller.with_gains(moved))
        except StructureError:
            self.job.tell({"news": "text", "taken": False})
            return
        except (FuzzyarmError, OSError) as error:
            self.job.tell({"news": "note", "text": str(error)})
            return
        self.controller, self.used = controller, self._used()
        self._forget_written()
        self.job.tell({"news": "text", "taken": True, "gains": self._gains()})

    def _forget_written(self) -> None:
        """Drop the user's gains that the text has now; keep those that it cannot have."""
        declared = {gain.name for gain in self._own_gains()}
        self.gains = {name: gain for name, gain in self.gains.items() if name not in declared}

    def _own_gains(self) -> Sequence[Any]:
        """Return the gains of the text: none for a rule base."""
        return source_of(self.controller).model.gains if _is_in(self.controller, self.text) else ()

    # --- The files of the controller ---

    def _used(self) -> dict[Path, int]:
        folder = home_of(self.path)
        text = source_of(self.controller)
        files = [sheet_path(file, folder) for use in text.model.uses for file in use.files]
        return {path: path.stat().st_mtime_ns for path in files if path.exists()}

    def _look_at_files(self) -> None:
        """Apply changes of the files that the controller uses."""
        now = time.perf_counter()
        if now - getattr(self, "_looked", -1.0) < 0.5:
            return
        self._looked = now
        used = self._used()
        if used != self.used:
            self.used = used
            self._take_text()

    # --- Messages to the page ---

    def _gains(self) -> list[dict[str, Any]]:
        text = source_of(self.controller)
        tunes = {model.name: model.tune for model in text.model.gains}
        own_names = {own_gain.name for own_gain in self._own_gains()}
        return [
            {
                "name": name,
                "values": self.gains.get(name, list(gain.value)),
                "unit": "" if gain.unit == "1" else gain.unit,
                "written": name in own_names,
                **self._range(name, gain, tunes.get(name)),
            }
            for name, gain in self.controller.gains.items()
        ]

    def _range(self, name: str, gain: Gain, tune: Any) -> dict[str, Any]:
        """Return the range of a gain's slider: the first one, widened for its value."""
        key = (name, tune, gain.bounds)
        low, high, log = self.ranges.setdefault(key, _first_range(gain, tune))
        low, high = min(low, *gain.value), max(high, *gain.value)
        return {"low": low, "high": high, "log": log and low > 0.0}

    def _tell_ready(self, name: str) -> None:
        course, motion, interface = self.loop.course, self.motion, self.loop.site.interface
        period = motion.period * motion.every
        ends = motion.along or self.is_timed
        whole = self.run.count * period
        # A run up to a point is in view from its start to there.
        far = self.until * period if self.until is not None else self._window(period)
        window = whole if ends else min(whole, far)
        self.window = math.ceil(window / period)
        self.every = max(1, math.ceil(self.window / WINDOW_POINTS))
        shown = zip(motion.tracked, shown_units(course), strict=True)
        driven = driven_by(self.loop.controller, self.loop.site)
        drives = [
            (index, port, drive)
            for index, (port, drive) in enumerate(interface.inputs.items())
            if port in driven or port[1] == "torque"
        ]
        self.columns = [index for index, _, _ in drives]
        self.job.tell(
            {
                "news": "ready",
                "controller": self.controller.name,
                "plant": name,
                "drawn": self.has_drawing,
                "window": window,
                "duration": whole if ends else None,
                "period": period,
                "tracked": [{"name": interface.label(port), "unit": unit} for port, unit in shown],
                "drives": [
                    {
                        "name": interface.label(port),
                        "unit": drive.unit,
                        "low": short(drive.low),
                        "high": short(drive.high),
                    }
                    for _, port, drive in drives
                ],
                "units": metric_units(course),
                "gains": self._gains(),
            }
        )

    def _window(self, period: float) -> float:
        """Return the visible duration of an unlimited run, s."""
        word = self.request.window
        if not word:
            return self.plant.duration or 1000 * period
        with at_field("duration"):
            return max(period, seconds_of(word))

    def _show(self) -> None:
        """Send the samples since the last time, and the picture."""
        rows = self.run.record.rows
        state = {
            "time": short(self._time(len(rows)), 9),
            "paused": self.paused,
            "behind": time.perf_counter() - self.behind < 1.0,
        }
        if len(rows) > self.sent:
            # Samples outside the window are not sent.
            first = max(self.sent, len(rows) - self.window)
            news = {"news": "samples", **state, **self._curves(rows[first:], first)}
            self.sent = len(rows)
            self.job.tell({**news, "drawing": self._drawing()})
        elif tuple(state.values()) != self.last_state:
            self.job.tell({"news": "samples", **state, "t": [], "low": []})
        self.last_state = tuple(state.values())
        self._measure()
        if self.reached and not self.told_reached:
            self.told_reached = True
            self.job.tell({"news": "reached", "at": short(self._time(self.run.next))})
        if self.run.over and not self.told_over:
            self.told_over = True
            self.job.tell({"news": "over", **self._end()})

    def _time(self, samples: int) -> float:
        return samples * self.motion.period * self.motion.every

    def _drawing(self) -> dict[str, Any] | None:
        """Return the drawing of the plant; one that fails is not tried again."""
        if not self.has_drawing:
            return None
        try:
            drawing = drawing_of(self.plant, self._scene())
        except PlantError as error:
            self.has_drawing = False
            self.job.tell({"news": "note", "text": str(error)})
            return None
        return None if drawing is None else drawing_data(drawing)

    def _curves(self, rows: NDArray[np.float64], first: int) -> dict[str, Any]:
        """Return envelopes of reference, output and error of tracked outputs, then of drives."""
        course, count = self.loop.course, len(self.motion.tracked)
        scale = scales(course)
        outputs, gains = rows[:, :count] * scale, rows[:, count : 2 * count] * scale
        begin = 2 * count + len(self.loop.site.interface.outputs)
        drives = rows[:, [begin + column for column in self.columns]]
        values = np.hstack([gains, outputs, gains - outputs, drives])
        every = max(self.every, math.ceil(len(values) / MOST_AT_ONCE))
        at = np.arange(0, len(values), every)
        times = self.motion.sampled[self.run.record.taken[first : first + len(rows)][at]]
        curves: dict[str, Any] = {"t": [short(t, 9) for t in times.tolist()]}
        curves["low"] = _columns(np.minimum.reduceat(values, at))
        if every > 1:
            curves["high"] = _columns(np.maximum.reduceat(values, at))
        return curves

    def _measure(self) -> None:
        """Send the metrics of the whole run so far, now and then."""
        now = time.perf_counter()
        done = self.run.over or self.paused
        wait = min(max(MEASURED_EVERY, 20.0 * self.measuring), LONGEST_WAIT)
        if now - self.measured < wait and not done:
            return
        if self.run.next == self.measured_at:
            return
        metrics_now = self.loop.answer(self.run).metrics
        is_first, self.measured_at = self.measured_at < 0, self.run.next
        self.measured = time.perf_counter()
        # The first time imports modules: no measure of the next one.
        self.measuring = 0.0 if is_first else self.measured - now
        metrics = {
            name: {k: None if v is None else short(v, 5) for k, v in value.to_dict().items()}
            for name, value in metrics_now.items()
        }
        at = short(self._time(self.run.next), 9)
        self.job.tell({"news": "metrics", "metrics": metrics, "at": at})

    def _end(self) -> dict[str, Any]:
        """Return the end of the run, in words for the page."""
        stopped = self.run.record.diverged()
        if stopped is None:
            return {"how": "finished", "at": short(self._time(self.run.next))}
        if self.plant.ended:
            return {"how": "ended", "at": short(stopped)}
        board, course = self.run.record.board, self.loop.course
        for port, output in self.loop.site.interface.outputs.items():
            value = float(board[course.output_cell(port)])
            if not abs(value) <= output.bound:
                label = self.loop.site.interface.label(port)
                far = {"port": label, "value": short(value), "bound": short(output.bound)}
                return {"how": "diverged", "at": short(stopped), **far, "unit": output.unit}
        return {"how": "diverged", "at": short(stopped)}


def _columns(values: NDArray[np.float64]) -> list[list[float | None]]:
    return [[short(value) for value in column] for column in values.T.tolist()]


def _speed(speed: float | None) -> float:
    """Return the speed, simulated for real time; None is the greatest possible."""
    if speed is not None and not speed > 0.0:
        raise MessageError("must be positive", "speed")
    return FASTEST if speed is None else min(speed, FASTEST)


def _lasting(words: ExperimentRequest, seconds: float) -> ExperimentRequest:
    return words.replaced(duration=f"{seconds!r}s")


Range = tuple[float, float, bool]
"""Of a slider: its ends, and whether its scale is logarithmic."""


def _first_range(gain: Gain, tune: Any) -> Range:
    """Return the slider range of a gain: its tuning range, or one around its value."""
    if tune is not None:
        return tune.low, tune.high, tune.log
    if gain.bounds is not None:
        return (*gain.bounds, False)
    if all(value > 0.0 for value in gain.value):
        return 0.1 * min(gain.value), 10.0 * max(gain.value), True
    reach = 2.0 * max(map(abs, gain.value)) or 1.0
    return -reach, reach, False
