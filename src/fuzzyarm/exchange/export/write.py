"""From rule bases, tables and controllers to exported files."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from fuzzyarm.base.files import demand_companion, demand_writable, write_atomically
from fuzzyarm.base.folders import NETWORK
from fuzzyarm.base.jsonable import entry, json_properties
from fuzzyarm.base.numbers import number_text
from fuzzyarm.exchange.export.c_files import controller_c, routines_c
from fuzzyarm.exchange.export.controller_lowering import controller_program
from fuzzyarm.exchange.export.controllers import ControllerProgram
from fuzzyarm.exchange.export.fmu import controller_fmu, platforms_named, routines_fmu
from fuzzyarm.exchange.export.languages import MODULES
from fuzzyarm.exchange.export.lowering import routines_program
from fuzzyarm.exchange.export.modules import Module, module_of
from fuzzyarm.exchange.export.network import network_bytes, network_of
from fuzzyarm.exchange.export.numbers import C_TYPES, ExportError
from fuzzyarm.exchange.export.plcopen import plcopen_xml, with_test
from fuzzyarm.exchange.export.printer import FunctionPrinter, Printer
from fuzzyarm.exchange.export.routine import MADE, Routine, plain, routine_words
from fuzzyarm.exchange.export.rulebase import direct_routine
from fuzzyarm.exchange.export.scl import scl_source
from fuzzyarm.exchange.export.structured_text import Project, controller_st, routines_st
from fuzzyarm.exchange.export.table import (
    MOST_CELLS,
    TableRoutine,
    fewer_levels,
    fixed_table,
    float_table,
)
from fuzzyarm.exchange.export.typed_program import SelfTest
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.symbolic.identifiers import C_RESERVED, DEVICES, ST_RESERVED, identifier
from fuzzyarm.table import LookupTable

_Texts = tuple[tuple[Path, str | bytes], ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class Files:
    """Files of an export, not yet written."""

    path: Path  # the requested one; others go beside it
    files: _Texts  # paths and contents
    # Calls of the routines: a C prototype, the name of a function block, or its variables.
    calls: tuple[str, ...]

    @property
    def names(self) -> list[str]:
        """Paths of the files."""
        return [str(path) for path, _ in self.files]

    def write(self) -> None:
        """Write the files, each whole; none of them if one cannot be written."""
        for path, content in self.files:
            if path != self.path and isinstance(content, str):
                demand_companion(path, content.encode(), self.path)
            demand_writable(path)
        for path, content in self.files:
            write_atomically(path, content)


@json_properties("call output arguments type worst points against proved operations stack")
@dataclass(frozen=True)
class ExportedFunction:
    """A function of the source text."""

    call: str = entry("its declaration")
    worst: float = entry("the largest difference from `against` at the points that were tried")
    points: int = entry("how many points were tried")
    against: str = entry("the reference of the comparison")
    proved: float | None = entry("the proved error against the rules; null where there is none")
    operations: Mapping[str, int | None] = entry(
        "most operations of a call, by their sort; null where they are not bounded"
    )
    stack: int | None = entry("bytes of local variables; null of a controller")
    output: str = entry("the returned output", default="")
    arguments: Sequence[str] = entry("its arguments", default=())
    type: str = entry("its type", default="")


@json_properties("files=names functions")
@dataclass(frozen=True, eq=False, kw_only=True)
class Exported(Files):
    """Files of rule bases or tables, not yet written.

    Attributes
    ----------
    routines : tuple of Routine
        The functions in them.
    path, files, calls
        As for `Files`.
    """

    routines: tuple[Routine, ...]

    @property
    def functions(self) -> list[ExportedFunction]:
        """The functions in the order of the outputs."""
        return [
            ExportedFunction(
                call,
                routine.accuracy.worst,
                routine.accuracy.points,
                routine.accuracy.against,
                routine.worst_proved() if isinstance(routine, TableRoutine) else None,
                routine.cost().by_sort(),
                routine.cost().stack,
                routine.output.name,
                [argument.name for argument in routine.arguments],
                C_TYPES[routine.kind],
            )
            for call, routine in zip(self.calls, self.routines, strict=True)
        ]


def routines_of(
    model: RuleBase | LookupTable | Sequence[LookupTable],
    *,
    output: str | None = None,
    mode: str | None = None,
    q: int | None = None,
    precision: str = "mixed",
    source: str | Path | None = None,
    proved: Mapping[str, float | None] = MappingProxyType({}),
    widened: bool = False,
) -> tuple[Routine, ...]:
    """Return the routines for the export of a file.

    Parameters
    ----------
    model : RuleBase, LookupTable or sequence of LookupTable
        A rule base is inferred directly, one routine for each output; a table is looked up.
    output : str, optional
        Only this output of a rule base.
    mode : str, optional
        How tables are looked up; their own way by default.
    q : int, optional
        15 or 7 for fixed point; tables only.
    precision : str
        ``mixed``, ``float32`` or ``float64``; without meaning in fixed point.
    source : str or Path, optional
        The file of a rule base, for the head.
    proved : mapping of str to float or None
        Bound of the difference between the table of an output, looked up so, and its rules.
    widened : bool
        Whether parts available in double precision only are computed in it internally, despite
        `precision`.

    Raises
    ------
    ExportError
        If something cannot be exported so.
    """
    if isinstance(model, RuleBase):
        if q is not None:
            raise ExportError(
                "direct inference is exported in floating point only",
                hint="--table makes a table in fixed point",
            )
        if mode is not None:
            raise ExportError("direct inference has no lookup mode", hint="leave out --mode")
        names = [variable.name for variable in model.outputs] if output is None else [output]
        if not names:
            raise ExportError(
                f"'{model.name}' has no outputs", hint="add a line like  output u -1 .. 1"
            )
        return tuple(
            direct_routine(model, name, precision, source, widened=widened) for name in names
        )
    tables = [model] if isinstance(model, LookupTable) else list(model)
    for table in tables:
        if table.values.size > MOST_CELLS:
            raise ExportError(
                f"the table of '{table.output}' has {table.values.size:,} cells; at most"
                f" {MOST_CELLS:,} are exported",
                hint=fewer_levels(len(table.axes), MOST_CELLS),
            )
    if q is not None:
        return tuple(
            TableRoutine(fixed_table(table, q, mode), proved.get(table.output)) for table in tables
        )
    return tuple(
        TableRoutine(float_table(table, mode, precision), proved.get(table.output))
        for table in tables
    )


def export_files(
    routines: Sequence[Routine],
    path: str | Path,
    name: str | None = None,
    *,
    fmi: int = 2,
    platforms: str | None = None,
) -> Exported:
    """Return the files for a path, by its suffix.

    Parameters
    ----------
    routines : sequence of Routine
        What to export.
    path : str or Path
        Its suffix is one of `EXPORTS`; a ``.c`` has its ``.h`` beside it.
    name : str, optional
        Begins every identifier; the name of the file by default.
    fmi : int
        Version of FMI, 2 or 3.
    platforms : str, optional
        Of an FMU, as in ``linux64,win64`` (`fuzzyarm.exchange.export.fmu.PLATFORMS`). By default
        the machine at hand.

    Raises
    ------
    ExportError
        If the suffix is none of these, `name` is not an identifier, or no C compiler is there.
    """
    made = _made(tuple(routines), path, name, fmi, platforms)
    measured = made.measured or tuple(routines)
    assert isinstance(measured, tuple)
    return Exported(routines=measured, path=Path(path), files=made.files, calls=tuple(made.calls))


def write_export(
    routines: Sequence[Routine], path: str | Path, name: str | None = None
) -> Exported:
    """Write exported files, each whole or not at all, and return them.

    Parameters
    ----------
    routines : sequence of Routine
        What the files hold, in order.
    path : path-like
        Its suffix selects the language.
    name : str, optional
        Of the module; by default that of the file.

    Raises
    ------
    ExportError
        As :func:`export_files`.
    OSError
        If the folder cannot be written.
    """
    exported = export_files(routines, path, name)
    exported.write()
    return exported


def _suffix_and_prefix(path: Path, name: str | None) -> tuple[str, str]:
    """Return the suffix of a path and the prefix of identifiers; refuse unusable ones."""
    suffix = path.suffix.lower()
    if suffix not in _FORMS:
        raise ExportError(f"'{path.name}' has no suffix of an export", hint=", ".join(_FORMS))
    # All that cannot be is refused here, before a routine is printed and measured.
    if path.stem.upper() in DEVICES:
        raise ExportError(
            f"'{path.name}' is the name of a device on Windows, not of a file",
            hint="take another name",
        )
    if not path.name.isprintable() or any(mark in path.name for mark in '"\\'):
        raise ExportError(f"{path.name!r} cannot be used in an #include", hint="take another name")
    if name is None:
        return suffix, identifier(path.stem)
    # Structured Text ignores case.
    reserved = name in C_RESERVED or (suffix in _STRUCTURED and name.lower() in ST_RESERVED)
    if identifier(name) != name or reserved:
        raise ExportError(
            f"'{name}' cannot begin an identifier", hint=f"for instance {identifier(name)}_x"
        )
    return suffix, name


# --- Languages by suffix ---

_Given = tuple[Routine, ...] | ControllerProgram


class _To(NamedTuple):
    """The target of an export: path, prefix of identifiers, and options of a unit."""

    path: Path
    prefix: str
    fmi: int
    platforms: str | None

    def file(self, content: str | bytes) -> _Texts:
        return ((self.path, content),)


class _Made(NamedTuple):
    """Files and calls; the measured errors of a file with its own arithmetic."""

    files: _Texts
    calls: Sequence[str]
    measured: _Given | None = None


def _in_c(given: _Given, to: _To) -> _Made:
    # A header alone holds the functions as `static inline`; a source keeps them out of its header.
    stem, suffix = to.path.stem, to.path.suffix.lower()
    if isinstance(given, ControllerProgram):
        vectors, head = given.tried.vectors, given.head()
        made = controller_c(given.steps, to.prefix, stem, suffix, vectors, head, given.guard)
    else:
        made = routines_c(given, to.prefix, stem, suffix)
    files = tuple((to.path.with_suffix(end), text) for end, text in made.files.items())
    return _Made(files, made.prototypes)


def _structured(written: Callable[[Project], str]) -> Callable[[_Given, _To], _Made]:
    def in_structured_text(given: _Given, to: _To) -> _Made:
        if isinstance(given, ControllerProgram):
            project = controller_st(given, to.prefix)
        else:
            project = routines_st(given, to.prefix)
        tested = project if written is Project.text else with_test(project, given)
        return _Made(to.file(written(tested)), project.blocks)

    return in_structured_text


def _module(module: Module) -> Callable[[_Given, _To], _Made]:
    def in_module(given: _Given, to: _To) -> _Made:
        if isinstance(given, ControllerProgram):
            text, calls, measured = controller_module(given, module, to.path.stem)
            return _Made(to.file(text), calls, measured)
        text, calls = routines_module(given, module, to.path.stem)
        return _Made(to.file(text), calls)

    return in_module


def _in_unit(given: _Given, to: _To) -> _Made:
    targets = platforms_named(to.platforms, to.fmi) if to.platforms is not None else ()
    if isinstance(given, ControllerProgram):
        return _Made(to.file(controller_fmu(given, to.prefix, to.fmi, targets)), ())
    unit = routines_fmu(given, to.prefix, to.fmi, targets)
    return _Made(to.file(unit), list(map(_variables_of, given)))


def _in_network(given: _Given, to: _To) -> _Made:
    if isinstance(given, ControllerProgram):
        raise ExportError(
            "a network has no memory, and a controller does",
            hint="compile the rule base that it uses",
        )
    network = network_of(given)
    content = to.file(network_bytes(network, to.prefix))
    return _Made(content, [_variables_of(network)], (network,))


def _variables_of(routine: Routine) -> str:
    inputs = ", ".join(argument.name for argument in routine.arguments if not argument.holds)
    return f"{routine.output.name} of {inputs}"


_STRUCTURED = {".st": Project.text, ".xml": plcopen_xml, ".scl": scl_source}

_FORMS: Mapping[str, Callable[[_Given, _To], _Made]] = MappingProxyType({
    ".h": _in_c, ".c": _in_c,
    **{suffix: _structured(written) for suffix, written in _STRUCTURED.items()},
    **{suffix: _module(module) for suffix, module in MODULES.items()},
    ".fmu": _in_unit, NETWORK: _in_network,
})  # fmt: skip


def _made(
    given: _Given, path: str | Path, name: str | None, fmi: int, platforms: str | None
) -> _Made:
    path = Path(path)
    suffix, prefix = _suffix_and_prefix(path, name)
    if isinstance(given, ControllerProgram) and given.certified and suffix not in (".h", ".c"):
        raise ExportError(
            f"a guard is exported in C, and '{path.name}' is not",
            hint="-o NAME.h or NAME.c, or --for arduino or platformio",
        )
    return _FORMS[suffix](given, _To(path, prefix, fmi, platforms))


# --- Controllers ---


@json_properties(
    "files=names controller=program.text.model.name period=program.text.model.period"
    " references measured drives gains calls precision=program.precision"
    " worst=program.tried.worst largest=program.tried.largest"
    " periods=program.tried.vectors.expected.__len__"
)
@dataclass(frozen=True, eq=False, kw_only=True)
class ExportedController(Files):
    """Files of a controller, not yet written.

    Attributes
    ----------
    program : ControllerProgram
        What is in them.
    path, files, calls
        As for `Files`; a call is a prototype, or the name of a function block.
    """

    program: ControllerProgram

    @property
    def references(self) -> list[str]:
        """Its set points."""
        return self.program.steps.port_names("reference")

    @property
    def measured(self) -> list[str]:
        """Its measured values."""
        return self.program.steps.port_names("measured")

    @property
    def drives(self) -> list[str]:
        """The driven ports."""
        return self.program.steps.port_names("drive")

    @property
    def gains(self) -> list[str]:
        """Its settable gains."""
        return list(dict.fromkeys(gain.name for gain in self.program.steps.of_sort("gain")))


def export_controller(
    program: ControllerProgram,
    path: str | Path,
    name: str | None = None,
    *,
    fmi: int = 2,
    platforms: str | None = None,
) -> ExportedController:
    """Return the files of a controller for a path, by its suffix.

    Parameters
    ----------
    program : ControllerProgram
        The controller.
    path : str or Path
        Its suffix is one of `EXPORTS`; a ``.c`` has its ``.h`` beside it.
    name : str, optional
        Begins every identifier; the name of the file by default.
    fmi : int
        Version of FMI, 2 or 3.
    platforms : str, optional
        Of an FMU, as in ``linux64,win64`` (`fuzzyarm.exchange.export.fmu.PLATFORMS`). By default
        the machine at hand.

    Raises
    ------
    ExportError
        If the suffix is none of these, something cannot be exported, or no C compiler is there.
    """
    made = _made(program, path, name, fmi, platforms)
    measured = made.measured or program
    assert isinstance(measured, ControllerProgram)
    return ExportedController(
        program=measured,
        path=Path(path),
        files=made.files,
        calls=tuple(made.calls),
    )


# --- Modules in one file ---

SINGLE_PERIODS = 1e-2
"""Tolerance of a port with floats of 32 bits in the self-test, as a share of the largest drive."""


def routines_module(
    routines: Sequence[Routine], module: Module, name: str
) -> tuple[str, tuple[str, ...]]:
    """Return a module with a function for every routine, and how they are called."""
    program = routines_program(routines)
    printer = Printer(program, module.target)
    public = [key for key, function in program.functions.items() if function.public]
    calls = tuple(printer.call(key) for key in public)
    words = [
        MADE,
        "",
        *(line for routine, call in zip(routines, calls, strict=True)
          for line in (call, *(f"  {word}" for word in routine_words(routine)), "")),
        module.test.format(name),
    ]  # fmt: skip
    return _headed(words, module, module_of(printer, module, name)), calls


def controller_module(
    program: ControllerProgram, module: Module, name: str
) -> tuple[str, tuple[str, ...], ControllerProgram]:
    """Return a module with a class, its constructor and calls, and the measured program."""
    lowered, vectors = controller_program(program.steps), program.tried.vectors
    assert lowered.step is not None
    rows = [
        (*given, *drives) for given, drives in zip(vectors.inputs, vectors.expected, strict=True)
    ]
    loose = SINGLE_PERIODS * max(program.tried.largest, 1e-30)
    late = program.steps.needs_last
    test = SelfTest("", np.float64, rows, len(vectors.inputs[0]), vectors.tolerance, loose, late)
    lowered.tests.append(test)
    printer = Printer(lowered, module.target)
    body = module_of(printer, module, name)
    if module.target.names == "python":
        program = program.measured(_driven(body, vectors.inputs))
    call = f"step({', '.join(FunctionPrinter(printer, lowered.step).parameter_texts())})"
    drives = [variable.stem for variable in lowered.drives.values()]
    words = [
        *program.head(),
        "",
        f"use: {module.create.removesuffix(';')}, then controller.{call}"
        f" every {number_text(program.text.model.period)} s",
        f"step returns {drives[0] if len(drives) == 1 else ', '.join(drives)}",
        "gains are members of the controller, to be set at any time",
        *_use_words(program, printer),
        module.test.format(name),
    ]
    calls = (module.create.partition("= ")[2].removesuffix(";"), call)
    return _headed(words, module, body), calls, program


def _driven(text: str, inputs: Sequence[Sequence[float]]) -> list[list[float]]:
    """Return the drives of a module of Python, which is executed."""
    names: dict[str, Any] = {}
    exec(compile(text, "module", "exec"), names)
    controller = names["Controller"]()
    found = (controller.step(*row) for row in inputs)
    return [list(drives) if isinstance(drives, tuple) else [drives] for drives in found]


def _use_words(program: ControllerProgram, printer: Printer) -> Iterator[str]:
    steps = program.steps
    if steps.needs_last:
        yield (
            f"a set point lasts {steps.model.every} periods; where the next one comes off that"
            " count, set_point_ends is true in the last period of the present one"
        )
    if steps.learned:
        names = ", ".join(printer.members[key].partition(".")[2] for key in steps.learned)
        yield f"tables that learn are arrays: {names}, each with its visits"


def _headed(words: Sequence[str], module: Module, body: str) -> str:
    """Return a text with its comment at the head."""
    head = [f"{module.comment} {plain(line)}".rstrip() for line in words]
    return "\n".join([*head, body])
