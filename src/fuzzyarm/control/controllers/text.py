"""Controllers as text: their files, mismatches, and execution step by step."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import islice
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from fuzzyarm.base.diagnostic import Diagnostic, RuleBaseError
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.files import demand_allowed, real_path
from fuzzyarm.base.names import near_hint
from fuzzyarm.base.protected import SourceFileError
from fuzzyarm.base.shipped_files import shipped, shipped_names
from fuzzyarm.base.shown import Shown
from fuzzyarm.base.value_kinds import CONTROLLER, OfKind
from fuzzyarm.control.controllers.code import AXIS, ControllerCode, Sheet, SourceError, Wiring
from fuzzyarm.control.controllers.files import demand_text_file, without_controller
from fuzzyarm.control.controllers.kernel import step
from fuzzyarm.control.controllers.law import Gain, unknown_gain, view
from fuzzyarm.control.controllers.program import write_down
from fuzzyarm.inference.errors import NotANumberError
from fuzzyarm.inference.inputs import number_of
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.language.model.controller import (
    Amount,
    Axes,
    ControllerModel,
    Learn,
    Line,
    SignalLine,
    Use,
    Zoom,
)
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.language.reading import load_rulebase, parse_once, read_text
from fuzzyarm.plant.own import beside
from fuzzyarm.plant.setting import (
    CLOCK,
    LAST,
    PERIOD,
    SINGLE,
    RunArithmetic,
    stored_double,
    stored_single,
)
from fuzzyarm.requests.bounds import LARGEST_RATE
from fuzzyarm.symbolic.kernels import has_machine_code, routine
from fuzzyarm.table import SUFFIXES, LookupTable, read_table

Change = Callable[[ControllerModel], ControllerModel]

ZERO = "zero"
"""In place of a file: a table of zeros on the grid of the performance table."""


@dataclass(frozen=True, repr=False)
class ControllerText(Shown, OfKind):
    """A controller as text, with its rule bases and tables.

    Attributes
    ----------
    model : ControllerModel
        Model of the text.
    sheets : mapping of str to tuple of RuleBase or LookupTable
        By the names of the text, one for all axes or one for each.
    path : str
        Path of the file, empty without one.
    source : str
        The text of the file; empty if the controller has been changed since.
    """

    kind_of_value = CONTROLLER

    model: ControllerModel
    sheets: Mapping[str, tuple[Sheet, ...]] = field(default_factory=dict)
    path: str = ""
    source: str = field(default="", compare=False)

    def called(self) -> str:
        """Return the name of the controller, for a message."""
        return self.model.name

    def __repr__(self) -> str:
        return f"<{type(self).__name__}{repr(self.model).removeprefix('<ControllerModel')}"

    def __str__(self) -> str:
        """Return the text of the file."""
        return self.source or repr(self)

    def run(self, **options: Any) -> ControllerRun:
        """Start it for the user's own loop; see :class:`ControllerRun`."""
        return ControllerRun(self, **options)

    def with_gains(self, gains: Mapping[str, float | Sequence[float]]) -> ControllerText:
        """Return the controller with some gains replaced, by a number or one for each axis.

        Raises
        ------
        GainError
            If it does not have a gain, or one cannot have such a value.
        """
        known = {gain.name: gain for gain in gains_of(self.model)}
        values = {}
        for name, value in gains.items():
            if name not in known:
                raise unknown_gain(self.model.name, known, name)
            given = known[name].with_value(np.atleast_1d(value).tolist())
            values[name] = tuple(map(Amount.of, given.value))
        changed = tuple(
            replace(gain, values=values.get(gain.name, gain.values)) for gain in self.model.gains
        )
        return replace(self, model=replace(self.model, gains=changed), source="")

    @property
    def claims(self) -> tuple[LoopClaim, ...]:
        """Its ``prove`` lines, with files of plants relative to the working folder.

        In the text they are relative to the folder of the controller, like those of ``use`` lines.
        """
        folder = str(home_of(self.path)) if self.path else "."
        return tuple(
            claim if folder == "." else replace(claim, plant=beside(claim.plant, folder))
            for claim in self.model.claim_lines
        )

    def learners(self) -> Iterator[Learn]:
        """Iterate over the lines that teach a table."""
        return (line for _, line in self.model.lines() if isinstance(line, Learn))


def read_controller(
    path: str | os.PathLike[str],
    instead: Mapping[str, tuple[Sheet, ...]] | None = None,
    change: Change | None = None,
    source: str | None = None,
) -> ControllerText:
    """Read a controller and the files that it uses.

    Parameters
    ----------
    path : path-like
        A ``.frb`` file with a line ``controller``.
    instead : mapping, optional
        Rule bases and tables in place of those in its ``use`` lines.
    change : callable, optional
        From the model to the sheets to read instead.
    source : str, optional
        The text, if it differs from the file.

    Raises
    ------
    OSError
        If a file cannot be read.
    RuleBaseError
        If it has mistakes or unsuitable files; `diagnostics` has all of them.
    WrongKindError
        If it is a rule base or a table.
    """
    name = os.fspath(path)
    demand_text_file(name)
    source = read_text(path) if source is None else source
    parsed = parse_once(source, name)
    if parsed.controller is None:
        raise without_controller(parsed, name)
    model = change(parsed.controller) if change is not None else parsed.controller
    text, faults = with_files(model, home_of(name), name, instead)
    if faults:
        raise RuleBaseError(faults)
    return text if change is not None else replace(text, source=source)


def used_files(
    model: ControllerModel,
    folder: Path,
    path: str = "",
    instead: Mapping[str, tuple[Sheet, ...]] | None = None,
) -> tuple[dict[str, tuple[Sheet, ...]], list[Diagnostic]]:
    """Return the rule bases and tables of a controller by name, and the unreadable ones."""
    sheets: dict[str, tuple[Sheet, ...]] = {
        rulebase.name: (rulebase,) for rulebase in model.rulebases
    }
    sheets.update(instead or {})
    faults: list[Diagnostic] = []
    for use in model.uses:
        # A table that starts at zero has no file: it has the grid of the performance table, maybe
        # of a later line, and is made by `with_files`.
        if use.name in sheets or use.files == (ZERO,):
            continue
        try:
            sheets[use.name] = tuple(read_sheet(file, folder) for file in use.files)
        except SourceFileError:
            raise
        except (OSError, ValueError) as error:  # a name may have a null byte
            faults.append(_unreadable(use, error, path, folder))
    return sheets, faults


def with_files(
    model: ControllerModel,
    folder: Path,
    path: str = "",
    instead: Mapping[str, tuple[Sheet, ...]] | None = None,
) -> tuple[ControllerText, list[Diagnostic]]:
    """Return a controller with its files, and findings on unreadable or unsuitable ones."""
    sheets, faults = used_files(model, folder, path, instead)
    for use in model.uses:
        if use.name not in sheets and use.files == (ZERO,):
            judge = judge_of(model, use.name, sheets)
            if judge is not None:
                sheets[use.name] = (zeros_like(judge),)
            elif not faults:
                message = f"nothing teaches '{use.name}', which begins at zero"
                hint = f"add a line like  learn {use.name} by P(e, ce)"
                faults.append(Diagnostic("no-learner", message, use.span, hint=hint, path=path))
    text = ControllerText(model, sheets, path)
    return text, [*faults, *misfits(text)]


def _unreadable(use: Use, error: OSError | ValueError, path: str, folder: Path) -> Diagnostic:
    files = " or ".join(f"'{file}'" for file in use.files)
    if isinstance(error, RuleBaseError):
        first = next(filter(attrgetter("is_error"), error.diagnostics), error.diagnostics[0])
        place = f"line {first.span.line}:{first.span.column}"
        message = f"{files} has mistakes: {first.message} ({place})"
        hint = f"in {Path(first.path).name}: {first.hint}" if first.hint and first.path else ""
        return Diagnostic("faulty-file", message, use.span, hint=hint, path=path)
    reason = error.strerror if isinstance(error, OSError) else None
    message = f"cannot read {files}: {reason or error}"
    hint = ""
    if isinstance(error, FileNotFoundError):
        hint = near_hint(Path(error.filename).name, _files_for(folder))[0]
    hint = hint or "files are searched beside the controller, then among the shipped ones"
    return Diagnostic("missing-file", message, use.span, hint=hint, path=path)


def _files_for(folder: Path) -> list[str]:
    """Return the names of possible files of a controller in a folder."""
    names = list(shipped_names())
    with suppress(OSError):
        names += sorted(path.name for path in islice(folder.iterdir(), 1000))
    return names


def read_sheet(file: str, folder: Path) -> Sheet:
    """Read a rule base or a table from beside the controller, or a shipped one."""
    path = sheet_path(file, folder)
    # Cached by the file's stamp, not its time alone: an edit counts in a long run.
    now = path.stat()
    return _read_sheet(path, (now.st_mtime_ns, now.st_ctime_ns, now.st_size))


def home_of(path: str | Path) -> Path:
    """Return the folder of a controller's files: beside it, not beside a link to it.

    Command and designer then run the same files.
    """
    file = Path(path)
    return (real_path(file) if file.is_symlink() else file).parent


def sheet_path(file: str, folder: Path) -> Path:
    """Return the path of a rule base or a table named by a controller in a folder."""
    path = folder / file
    demand_allowed(path)
    return shipped(file) if not path.exists() and file in shipped_names() else path


def files_of(model: ControllerModel, path: str) -> dict[str, Path]:
    """Return the files of a controller, its own included, by name; none without a path."""
    if not path:
        return {}
    home = Path(path)
    file_names = [file for use in model.uses for file in use.files]
    return {home.name: home, **{file: sheet_path(file, home_of(path)) for file in file_names}}


def sheet_files(text: ControllerText) -> list[Path]:
    """Return the files of a controller's rule bases and tables."""
    folder = home_of(text.path)
    names = dict.fromkeys(file for use in text.model.uses for file in use.files if file != ZERO)
    return [sheet_path(name, folder) for name in names]


@cache
def _read_sheet(path: Path, _changed: tuple[int, int, int]) -> Sheet:
    suffix = path.suffix.lower()
    if suffix in SUFFIXES:
        return read_table(path)
    if suffix == ".frb":
        return load_rulebase(path)
    from fuzzyarm.base import above

    imported = above.function("read")(path)
    rulebase: RuleBase | None = imported.rulebase
    if rulebase is None:
        raise RuleBaseError(imported.diagnostics)
    return rulebase


def judge_of(
    model: ControllerModel, name: str, sheets: Mapping[str, tuple[Sheet, ...]]
) -> LookupTable | None:
    """Return the performance table of a table that begins at zero."""
    for _, line in model.lines():
        if isinstance(line, Learn) and line.table == name and line.judge in sheets:
            judge = sheets[line.judge][0]
            if isinstance(judge, LookupTable):
                return judge
    return None


def zeros_like(table: LookupTable) -> LookupTable:
    """Return a table of zeros on the same grid."""
    return replace(
        table, values=np.zeros_like(table.values), output="u", rounding=None, provenance=()
    )


def by_name(name: str, sheet: Sheet) -> Change:
    """Return a change that substitutes a rule base or a table, with its inputs matched by name."""
    inputs = tuple(input_name for input_name in input_names(sheet) if input_name != AXIS)
    what = f"rule base '{sheet.name}'" if isinstance(sheet, RuleBase) else "the table"

    def change(model: ControllerModel) -> ControllerModel:
        def renamed(axes: Axes, line: Line) -> Line:
            if isinstance(line, Learn) and name in (line.table, line.judge):
                return replace(line, inputs=inputs) if name == line.table else line
            if not isinstance(line, SignalLine) or line.source is None or line.source.name != name:
                return line
            signals = [other for other in axes.lines if isinstance(other, SignalLine)]
            lines = [signal for other in signals for signal in other.names]
            for signal in inputs:
                if signal not in lines:
                    names = ", ".join(dict.fromkeys(line.source.inputs))
                    raise SourceError(
                        f"{what} has the input '{signal}', which the controller does not have",
                        hint=f"its inputs may be called {names}, {AXIS}",
                    )
            return replace(line, source=replace(line.source, inputs=inputs))

        axes = tuple(
            replace(axis, lines=tuple(renamed(axis, line) for line in axis.lines))
            for axis in model.axes
        )
        return replace(model, axes=axes)

    return change


def input_names(sheet: Sheet) -> tuple[str, ...]:
    """Return the inputs of a rule base or a table, in their order."""
    if isinstance(sheet, RuleBase):
        return tuple(variable.name for variable in sheet.inputs)
    return sheet.names


def teaching(rate: float | None = None, delay: int | None = None) -> Change:
    """Return a change of the rate and the delay of learners."""

    def change(model: ControllerModel) -> ControllerModel:
        def taught(line: Line) -> Line:
            if not isinstance(line, Learn):
                return line
            changed = {"rate": rate, "delay": None if delay is None else float(delay)}
            options = dict(line.options) | {k: v for k, v in changed.items() if v is not None}
            return replace(line, options=tuple(options.items()))

        axes = tuple(replace(axis, lines=tuple(map(taught, axis.lines))) for axis in model.axes)
        return replace(model, axes=axes)

    return change


# --- Mismatches ---


def misfits(text: ControllerText) -> Iterator[Diagnostic]:
    """Yield mismatches between a controller and its rule bases and tables."""
    for _, line in text.model.lines():
        if isinstance(line, SignalLine) and line.source is not None and line.source.inputs:
            source = line.source
            for sheet in text.sheets.get(source.name, ()):
                yield from _misfit(text, line, sheet, source.kind, source.name, source.inputs)
        elif isinstance(line, Learn):
            for name in (line.table, line.judge):
                for sheet in text.sheets.get(name, ()):
                    yield from _misfit(text, line, sheet, "table", name, line.inputs)
            table = next(iter(text.sheets.get(line.table, ())), None)
            if isinstance(table, LookupTable) and table.default_mode == "linear":
                message = "a table that is interpolated has no responsible cell to correct"
                yield Diagnostic("no-cells", message, line.span, path=text.path)


def _misfit(
    text: ControllerText,
    line: SignalLine | Learn,
    sheet: Sheet,
    kind: str,
    name: str,
    inputs: Sequence[str],
) -> Iterator[Diagnostic]:
    is_rules = isinstance(sheet, RuleBase)
    if is_rules != (kind == "rules"):
        what, word = ("rule base", "rules") if is_rules else ("table", "table")
        message = f"'{name}' is a {what}"
        hint = f"write {word} {name}({', '.join(inputs)})"
        yield Diagnostic("wrong-source", message, line.span, hint=hint, path=text.path)
        return
    if isinstance(sheet, RuleBase):
        assert isinstance(line, SignalLine)
        if len(line.names) != len(sheet.outputs):
            outputs = ", ".join(variable.name for variable in sheet.outputs)
            yield Diagnostic(
                "wrong-count",
                f"'{name}' has {len(sheet.outputs)} outputs, the line names {len(line.names)}",
                line.span,
                hint=f"its outputs are {outputs}",
                path=text.path,
            )
    names = [
        input_name
        for input_name in input_names(sheet)
        if input_name != AXIS or input_name in inputs
    ]
    if len(names) != len(inputs):
        yield Diagnostic(
            "wrong-count",
            f"'{name}' has {len(names)} inputs, the line gives {len(inputs)}",
            line.span,
            hint=f"its inputs are {', '.join(names)}",
            path=text.path,
        )


# --- One step at a time, in the user's own loop ---


class PortError(FuzzyarmError, KeyError):
    """A missing, unknown or non-numeric value; `port` is its name."""

    def __init__(self, message: str, *, port: str, hint: str = "") -> None:
        super().__init__(message, hint=hint)
        self.port = port

    def __str__(self) -> str:
        return str(self.args[0])


def ports_of(model: ControllerModel, kind: str) -> Iterator[tuple[str, str]]:
    """Yield axis and port of the controller's ports."""
    for axes in model.axes:
        for port in axes.ports(kind):
            for axis in axes.names:
                yield axis, port


def wiring_of(model: ControllerModel) -> Wiring:
    """Assign each port of a controller its own cell, after the clock."""
    at = CLOCK
    cells: list[dict[tuple[str, str], int]] = []
    for kind in ("reference", "measured", "drive"):
        ports = list(ports_of(model, kind))
        cells.append({port: at + index for index, port in enumerate(ports)})
        at += len(ports)
    # In one row after the clock: references, measured values, drives.
    references, measured, drives = cells
    return Wiring(references, measured, drives, (), at, {})


def gains_of(model: ControllerModel) -> Iterator[Gain]:
    """Yield the gains of a text, with the range that their use allows."""
    lines = [line for _, line in model.lines()]
    rates = {line.rate for line in lines if isinstance(line, Learn)}
    positive = {line.bound for line in lines if isinstance(line, Learn)}
    for line in lines:
        if isinstance(line, Zoom):
            positive |= {line.by, line.inside}
    for gain in model.gains:
        yield Gain(
            gain.name,
            tuple(value.value(math.pi) for value in gain.values),
            gain.unit or "1",
            "",
            "own",
            positive=gain.name in positive,
            bounds=(0.0, LARGEST_RATE) if gain.name in rates else None,
            places=len(model.axis_names),
        )


def _number(value: object, what: str, port: str) -> float:
    try:
        return number_of(port, value)
    except NotANumberError:
        message = f"the {what} '{port}' is not a number: {value!r}"
        hint = "of a lost sample it is math.nan" if value is None else ""
        raise PortError(message, port=port, hint=hint) from None


class ControllerRun:
    """A running controller: its state, and a step for each period.

    Parameters
    ----------
    text : ControllerText
        The controller.
    gains : mapping of str to float or sequence of float, optional
        They replace those of the text.
    single : bool, optional
        Whether signals and gains are stored in single precision.
    compiled : bool, optional
        Whether it runs as machine code; by default by the environment.

    Raises
    ------
    SourceError
        If it has a partner, which needs the arm, or a rule base that cannot be evaluated.
    GainError
        If it does not have a gain, or one cannot have such a value.

    Examples
    --------
    >>> from fuzzyarm import load, shipped
    >>> run = load(shipped("fuzzy-direct.frb")).run(compiled=False)
    >>> run.inputs
    ('joint1.position', 'joint2.position', 'joint1.velocity', 'joint2.velocity')
    >>> still = dict.fromkeys(run.inputs, 0.0)
    >>> drives = run.step(still, still | {"joint1.position": 0.001})
    >>> round(drives["joint1.voltage"], 3), round(drives["joint2.voltage"], 3)
    (1.345, 0.0)
    """

    def __init__(
        self,
        text: ControllerText,
        *,
        gains: Mapping[str, Any] | None = None,
        single: bool = False,
        compiled: bool | None = None,
    ) -> None:
        if gains:
            text = text.with_gains(gains)
        model = text.model
        if model.partners:
            name = model.partners[0].name
            message = f"the partner '{name}' is a law of the arm and runs in its loop only"
            raise SourceError(message)
        compiled = has_machine_code() if compiled is None else compiled
        self.text = text
        self.arithmetic = RunArithmetic(single, math.pi, compiled)
        self._wiring = wiring_of(model)
        self.program: ControllerCode = write_down(
            model, text.sheets, {}, self._wiring, self.arithmetic
        )
        binding = {"stored": stored_single if single else stored_double}
        # "if": the kernel takes an int64 array, the code, and a float64 array, the cells.
        self._step: Callable[..., None] = routine(step, "if", binding, compiled=compiled)
        code = np.array(self.program.code, np.int64)
        self._code = code if compiled else view(code)
        one = model.has_one_axis
        self._names = [
            {port if one else f"{axis}.{port}": cell for (axis, port), cell in cells.items()}
            for cells in (self._wiring.references, self._wiring.measured, self._wiring.drives)
        ]
        self._memory = self.program.memory()
        self.start()

    def start(self) -> None:
        """Reset the state."""
        cells = self.program.cells.copy()
        cells[PERIOD] = self.text.model.period
        cells[SINGLE] = float(self.arithmetic.single)
        self._cells = cells if self.arithmetic.compiled else view(cells)
        self._periods = 0

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of its measured inputs: ``port`` with one axis, ``axis.port`` with several."""
        return tuple(self._names[1])

    @property
    def references(self) -> tuple[str, ...]:
        """Names of its references."""
        return tuple(self._names[0])

    @property
    def drives(self) -> tuple[str, ...]:
        """Names of its drives."""
        return tuple(self._names[2])

    @property
    def state(self) -> tuple[float, ...]:
        """Its state: number of periods, then the states of its sources."""
        return (float(self._periods), *(float(self._cells[cell]) for cell in self._memory))

    @state.setter
    def state(self, values: Sequence[float]) -> None:
        """Restore a state; a first number of 0 resets it, whatever follows."""
        periods, *memory = values
        if len(memory) != len(self._memory):
            count = 1 + len(self._memory)
            raise PortError(f"a state of {len(values)} numbers does not fit {count}", port="state")
        if periods == 0:
            self.start()
            return
        self._periods = int(periods)
        for cell, value in zip(self._memory, memory, strict=True):
            self._cells[cell] = value

    def step(
        self, measured: Mapping[str, float], reference: Mapping[str, float]
    ) -> dict[str, float]:
        """Run one period.

        Parameters
        ----------
        measured, reference : mapping of str to float
            By port; other names are ignored.

        Returns
        -------
        dict of str to float
            The drives, by port.

        Raises
        ------
        PortError
            If a value is missing or not a number; NaN is a lost sample.
        """
        cells = self._cells
        for names, numbers, what in (
            (self._names[0], reference, "reference of"),
            (self._names[1], measured, "measured value of"),
        ):
            for name, cell in names.items():
                if name not in numbers:
                    raise PortError(f"no {what} '{name}'", port=name)
                value = numbers[name]
                cells[cell] = value if type(value) is float else _number(value, what, name)
        self._periods += 1
        cells[LAST] = float(self._periods % self.text.model.every == 0)
        self._step(self._code, cells)
        return {name: float(cells[cell]) for name, cell in self._names[2].items()}

    @property
    def skipped(self) -> dict[str, int]:
        """Number of periods that each axis skipped because a value was NaN."""
        return self.program.skipped(self._cells)

    def signal(self, axis: str, name: str) -> float:
        """Return a signal of the last step."""
        return float(self._cells[self.program.signals[axis, name]])
