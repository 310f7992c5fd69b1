"""Load and check any file, whatever its kind."""

from __future__ import annotations

import errno
import os
import warnings
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from fuzzyarm.base import above
from fuzzyarm.base.diagnostic import Diagnostic, RuleBaseError, Severity, render_all
from fuzzyarm.base.errors import FuzzyarmError, UsageError, WordError
from fuzzyarm.base.folders import READABLE, TABLES
from fuzzyarm.base.keywords import demand_path, demand_text
from fuzzyarm.base.names import typed
from fuzzyarm.base.numbers import counted
from fuzzyarm.base.shown import one_line
from fuzzyarm.language import Parsed, parse, read_text
from fuzzyarm.language.check import CHECKS, check, judged
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.language.reading import parse_once, text_to_show

if TYPE_CHECKING:
    from fuzzyarm.control.controllers.text import ControllerText
    from fuzzyarm.exchange.export import Exported, ExportedController
    from fuzzyarm.language.model.controller import ControllerModel
    from fuzzyarm.plant.plant import Plant
    from fuzzyarm.proof.map import Verdict
    from fuzzyarm.requests.making import CompileRequest, ExportRequest
    from fuzzyarm.table import LookupTable


__all__ = [
    "FileWarning", "Judgement", "PlantOf", "Review", "UnknownKindError", "WrongKindError",
    "check_file", "check_parsed", "check_text", "export_file", "judge", "load", "load_controller",
    "load_rulebase",
]  # fmt: skip


class FileWarning(UserWarning):
    """A warning of :func:`load` about a file of another program.

    Attributes
    ----------
    diagnostic : Diagnostic
        The finding, with its position.
    """

    def __init__(self, diagnostic: Diagnostic) -> None:
        super().__init__(str(diagnostic))
        self.diagnostic = diagnostic


class UnknownKindError(FuzzyarmError, ValueError):
    """The suffix of a file is unknown.

    Attributes
    ----------
    path : str
        The file.
    """

    def __init__(self, path: str) -> None:
        from fuzzyarm.base.shipped_files import missing_file_hint  # imports pathlib
        from fuzzyarm.exchange.formats.not_texts import called

        endings = ", ".join((*READABLE, *TABLES))
        message, hint = f"{path}: cannot tell what kind of file this is", f"known: {endings}"
        if known_as := called(path):
            message, hint = f"{path}: this is {known_as[0]}, not a text", known_as[1]
        elif not os.path.exists(path) and (near := missing_file_hint(path)):
            message, hint = f"{path}: no such file", near
        super().__init__(message, hint=hint)
        self.path = path


class WrongKindError(FuzzyarmError, ValueError):
    """A file is of another kind than the caller expects.

    Attributes
    ----------
    path : str
        The file.
    """

    def __init__(self, path: str, message: str, hint: str) -> None:
        super().__init__(f"{path} is {message}", hint=hint)
        self.path = path


def load(path: str | os.PathLike[str]) -> RuleBase | LookupTable | ControllerText:
    """Return the rule base, controller or lookup table in the file at `path`, by its suffix.

    Where the kind is known, use :func:`load_rulebase`, :func:`load_controller` or
    :func:`fuzzyarm.read_table`: their return types are exact.

    Parameters
    ----------
    path : path-like
        A rule base or a controller (``.frb``), a rule base of another program (``.fll``,
        ``.fcl``, ``.fis``, ``.t2fis``, ``.fml``, ``.xml``) or a table (``.lut``, ``.csv``,
        ``.npz``, ``.json``).

    Warns
    -----
    FileWarning
        For every warning about a file of another program: something was dropped, or could be
        read in several ways. Errors are the same as those of :func:`check_file`.

    Raises
    ------
    OSError
        If the file cannot be read.
    RuleBaseError
        If it has mistakes; `diagnostics` has all of them.
    UnknownKindError
        If the suffix is none of these.
    """
    return _load(path)


def _load(path: str | os.PathLike[str]) -> RuleBase | LookupTable | ControllerText:
    """Load a file; warnings name the caller of the caller."""
    name, suffix = _name_and_suffix(path)
    if suffix == ".frb":
        source = read_text(path)
        parsed = parse_once(source, name)
        if parsed.controller is not None:
            return _controller(parsed.controller, source, name)
        if parsed.rulebase is None:
            raise RuleBaseError(parsed.diagnostics)
        return parsed.rulebase
    if suffix in TABLES:
        from fuzzyarm.table import read_table

        return read_table(name)
    return _foreign(path, suffix, stacklevel=4)


def load_rulebase(path: str | os.PathLike[str]) -> RuleBase:
    """Return the rule base in the file at `path`, by its suffix.

    Parameters
    ----------
    path : path-like
        ``.frb``, or that of another program: ``.fll``, ``.fcl``, ``.fis``, ``.t2fis``, ``.fml``,
        ``.xml``. Of a controller with a rule base in the same file, the rule base.

    Warns
    -----
    FileWarning
        As :func:`load`.

    Raises
    ------
    OSError, RuleBaseError, UnknownKindError
        As :func:`load`; RuleBaseError also for a controller without a rule base in its file.
    WrongKindError
        If it is a table.
    """
    name, suffix = _name_and_suffix(path)
    if suffix == ".frb":
        from fuzzyarm.language import load_rulebase as load_text

        return load_text(path)
    if suffix in TABLES:
        message = "a lookup table, not a rule base"
        raise WrongKindError(name, message, "fuzzyarm.read_table reads it")
    return _foreign(path, suffix, stacklevel=3)


def load_controller(
    path: str | os.PathLike[str], gains: Mapping[str, float | Sequence[float]] | None = None
) -> ControllerText:
    """Return the controller in the ``.frb`` file at `path`, with its files.

    Parameters
    ----------
    path : path-like
        A ``.frb`` file with a line ``controller``.
    gains : mapping of str to float or sequence of float, optional
        Gains in place of those of the file: a number, or one for each axis.

    Raises
    ------
    OSError, RuleBaseError, UnknownKindError
        As :func:`load`.
    GainError
        If the controller does not have a gain.
    WrongKindError
        If it is a rule base without a controller, or a table.
    """
    from fuzzyarm.control.controllers.text import ControllerText

    model = _load(path)
    if isinstance(model, ControllerText):
        return model.with_gains(gains) if gains else model
    is_rules = isinstance(model, RuleBase)
    found = f"a {'rule base' if is_rules else 'lookup table'}, not a controller"
    reader = "load_rulebase" if is_rules else "read_table"
    raise WrongKindError(os.fspath(path), found, f"fuzzyarm.{reader} reads it")


# --- Arguments of commands ---


def load_sheet(path: str) -> RuleBase | LookupTable:
    """Return the rule base or table in a file; of a controller, the rule base beside it."""
    return _sheet_of(load(path), path)


def _sheet_of(model: RuleBase | LookupTable | ControllerText, path: str) -> RuleBase | LookupTable:
    if isinstance(model, RuleBase):
        return model
    from fuzzyarm.control.controllers.text import sheet_files
    from fuzzyarm.table import LookupTable

    if isinstance(model, LookupTable):
        return model
    if model.model.rulebases:
        return model.model.rulebases[0]
    files = " or ".join(typed(str(file)) for file in sheet_files(model))
    hint = (
        f"it looks up {files}: give that" if files else f"fuzzyarm simulate {typed(path)} runs it"
    )
    raise WordError(f"{path} is a controller, not a rule base or a table", hint=hint)


def controller_if_any(path: str) -> ControllerText | None:
    """Return the controller in a file; None without one."""
    if not path.lower().endswith(".frb"):
        return None
    from fuzzyarm.control.controllers.text import ControllerText

    model = load(path)
    return model if isinstance(model, ControllerText) else None


def load_rules(path: str, option: str) -> RuleBase:
    """Return the rule base in a file from `option`."""
    return _rules_of(load(path), path, option)


def _rules_of(model: RuleBase | LookupTable | ControllerText, path: str, option: str) -> RuleBase:
    sheet = _sheet_of(model, path)
    if not isinstance(sheet, RuleBase):
        raise WordError(f"{option} takes a rule base, but {path} is a table")
    return sheet


def load_used_rules(path: str, option: str) -> RuleBase:
    """Return the rule base in a file; of a controller its only one."""
    from fuzzyarm.control.controllers.text import ControllerText

    model = load(path)
    if not isinstance(model, ControllerText):
        return _rules_of(model, path, option)
    sheets = (sheet for several in model.sheets.values() for sheet in several)
    used = [sheet for sheet in dict.fromkeys(sheets) if isinstance(sheet, RuleBase)]
    if len(used) > 1:
        names = ", ".join(f"'{rulebase.name}'" for rulebase in used)
        hint = f"it uses {names}: give the file of one, or --columns for a recorded run"
        raise WordError(f"{path} uses {len(used)} rule bases", hint=hint)
    return used[0] if used else _rules_of(model, path, option)


def load_sampled(path: str) -> LookupTable:
    """Return the table in a file; a rule base is compiled at the levels of its file."""
    model = load_sheet(path)
    if not isinstance(model, RuleBase):
        return model
    from fuzzyarm.table import compile_table

    return compile_table(model, source=path)


def table_of_request(request: CompileRequest) -> LookupTable:
    """Return the table of a compile request; `fuzzyarm.compile_table` calls this."""
    from fuzzyarm.exchange.compiled import compiled, making_of
    from fuzzyarm.requests.making import ExportRequest

    rulebase = load_rules(request.file, "compile_table")
    how = making_of(request.as_kind(ExportRequest))
    return compiled(rulebase, request.output, how).table


def export_file(
    file: str | os.PathLike[str] | ExportRequest, out: str | os.PathLike[str], **fields: Any
) -> Exported | ExportedController:
    """Write a rule base, a table or a controller as source text or as a program.

    Parameters
    ----------
    file : str, path-like or ExportRequest
        The file to export, or a request with all options.
    out : str or path-like
        Its suffix selects the language, as in ``fuzzyarm compile``: ``.h``, ``.c``, ``.st``, …
    **fields
        Fields of an `ExportRequest`, if `file` is a path: ``q=15``, ``name="servo"``, ….

    Returns
    -------
    Exported or ExportedController
        With the written files and the names of their functions.

    Raises
    ------
    ExportError
        If the file cannot be exported in this language.
    RequestError
        If a field is unknown or its value is out of range.

    Examples
    --------
    >>> from fuzzyarm import shipped
    >>> export_file(shipped("pd7.frb"), "pd7.h", q=15).calls
    ('int16_t pd7_u(int16_t e, int16_t ce)',)
    """
    from pathlib import Path

    from fuzzyarm.base.files import write_atomically
    from fuzzyarm.base.keywords import demand_alone
    from fuzzyarm.exchange.compiled import making_of, program_of, source_of
    from fuzzyarm.requests.making import ExportRequest

    if isinstance(file, ExportRequest):
        demand_alone("export_file", fields)
        request = file
    else:
        request = ExportRequest(file=demand_path("export_file", file, "file"), **fields)
    out = demand_path("export_file", out, "out")
    if field := request.given(("place", "board", "certificate")):
        raise UsageError(f"{field.spelling} is an option of the command", hint="fuzzyarm compile")
    controller, how = controller_if_any(request.file), making_of(request)
    exported: Exported | ExportedController
    if controller is not None:
        exported, _ = program_of(controller, Path(out), how)
    else:
        exported, _ = source_of(load_sheet(request.file), Path(out), how)
    for path, content in exported.files:
        write_atomically(path, content)
    return exported


def _name_and_suffix(path: str | os.PathLike[str]) -> tuple[str, str]:
    name = demand_path("load", path)
    return name, os.path.splitext(name)[1].lower()


def _controller(model: ControllerModel, source: str, name: str) -> ControllerText:
    """Return a controller with its files."""
    from fuzzyarm.control.controllers.text import home_of, with_files

    text, faults = with_files(model, home_of(name), name)
    if faults:
        raise RuleBaseError(faults)
    return replace(text, source=source)


def _foreign(path: str | os.PathLike[str], suffix: str, *, stacklevel: int) -> RuleBase:
    """Return the rule base in a file of another program; `stacklevel` is that of a warning."""
    if suffix not in READABLE:
        # A word without a suffix is probably a misspelt path, not a file of an unknown kind.
        if not suffix and not os.path.exists(path):
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), os.fspath(path))
        raise UnknownKindError(os.fspath(path))
    from fuzzyarm.exchange.formats import read

    imported = read(path)
    if imported.rulebase is None:
        raise RuleBaseError(imported.diagnostics)
    for diagnostic in imported.diagnostics:
        if diagnostic.severity is Severity.WARNING:
            warnings.warn(FileWarning(diagnostic), stacklevel=stacklevel)
    return imported.rulebase


class PlantOf(NamedTuple):
    """The plant for the checks of a controller."""

    plant: Plant  # the plant; a missing port is an error
    # From names of the controller to ports of the plant, if they differ.
    connect: Mapping[str, str] = MappingProxyType({})


class Review(NamedTuple):
    """The findings of one text."""

    text: str  # the text, for showing the positions
    # Errors; without any, also warnings and remarks. In the order of the text.
    diagnostics: tuple[Diagnostic, ...]
    rulebase: RuleBase | None = None  # none for a text with errors, and for tables

    def _repr_html_(self) -> str:
        # A named tuple cannot inherit from Shown, so it has the same method.
        drawing: str = above.function("html_of")(self)
        return drawing

    def __repr__(self) -> str:
        content = "no model" if self.rulebase is None else repr(self.rulebase)
        return one_line(self, f"{self.summary}; {content}")

    def __str__(self) -> str:
        """Return every finding with its line and a caret below the fault."""
        return render_all(self.diagnostics, self.text) or "no findings"

    @property
    def failed(self) -> bool:
        """Whether any finding is an error."""
        return any(diagnostic.is_error for diagnostic in self.diagnostics)

    @property
    def summary(self) -> str:
        """How many findings there are of each severity, as ``1 error, 2 warnings``."""
        counts = Counter(diagnostic.severity for diagnostic in self.diagnostics)
        words = [
            f"{counts[severity]} info"
            if severity is Severity.INFO
            else counted(counts[severity], severity)
            for severity in (Severity.ERROR, Severity.WARNING, Severity.INFO)
            if counts[severity]
        ]
        return ", ".join(words) or "no findings"


def check_text(text: str, path: str = "<text>", on: PlantOf | None = None) -> Review:
    """Check the text of a ``.frb`` file: mistakes first; without any, doubts and expectations.

    Never raises, whatever the text. A controller is checked on the plant of `on`, else on the
    shipped one with its axes.

    Parameters
    ----------
    text : str
        Of a rule base, a controller or both.
    path : str
        Its name, for the findings.
    on : PlantOf, optional
        The plant of a controller.

    Returns
    -------
    Review
        Every finding, in the order of the text.
    """
    demand_text("check_text", text)
    return check_parsed(parse(text, path), text, path, on=on)


def check_parsed(
    parsed: Parsed,
    text: str,
    path: str = "<text>",
    failed: list[Diagnostic] | None = None,
    on_step: Callable[[], None] = lambda: None,
    on: PlantOf | None = None,
    own: Sequence[Plant] = (),
) -> Review:
    """Check a parsed text; see :func:`check_text`. `own` are plants beside the shipped ones."""
    diagnostics, doubts = list(parsed.diagnostics), list[Diagnostic]()
    # Doubts about a controller beside a rule base are judged with those of the rules, below.
    if parsed.whole is not None:
        diagnostics, doubts = _of_controller(parsed.whole, parsed, path, on, own)
    if parsed.rulebase is None:
        if parsed.whole is not None:
            diagnostics = sorted(
                (*diagnostics, *judged(doubts, parsed.document, path)), key=_position
            )
        return Review(text, tuple(diagnostics))
    more = judge(parsed.rulebase, on_step).findings if failed is None else failed
    more = [*more, *doubts]
    findings = check(parsed.rulebase, parsed.document, path=path, more=more, on_step=on_step)
    merged = sorted((*diagnostics, *findings), key=_position)
    return Review(text, tuple(merged), parsed.rulebase)


def _position(finding: Diagnostic) -> tuple[object, str]:
    return finding.span, finding.name


def _of_controller(
    model: ControllerModel, parsed: Parsed, path: str, on: PlantOf | None, own: Sequence[Plant]
) -> tuple[list[Diagnostic], list[Diagnostic]]:
    """Return the errors of a controller and its files, and the findings open to ``# allow``."""
    from fuzzyarm.control.controllers.findings import doubts_of, sound_part
    from fuzzyarm.control.controllers.text import home_of, used_files, with_files

    folder = home_of(path)
    sound: ControllerModel | None = model
    if parsed.controller is None:
        sound = sound_part(model, parsed.document, parsed.diagnostics)
    if sound is None:
        return [*parsed.diagnostics, *used_files(model, folder, path)[1]], []
    controller, faults = with_files(sound, folder, path)
    if sound is not model:  # the line that teaches may be one with a mistake
        faults = [fault for fault in faults if fault.name != "no-learner"]
    plant, connect = on or (None, None)
    doubtful = doubts_of(controller, plant, connect, own)
    diagnostics = [*parsed.diagnostics, *faults, *doubtful]
    doubts = [diagnostic for diagnostic in diagnostics if diagnostic.name in CHECKS]
    return [diagnostic for diagnostic in diagnostics if diagnostic.name not in CHECKS], doubts


def check_file(path: str | os.PathLike[str], on: PlantOf | None = None) -> Review:
    """Check a file of any kind that :func:`load` takes.

    Parameters
    ----------
    path : path-like
        The file.
    on : PlantOf, optional
        The plant of a controller.

    Raises
    ------
    OSError
        If the file cannot be read.
    UnknownKindError
        If its suffix says nothing.
    """
    name = demand_path("check_file", path)
    suffix = os.path.splitext(name)[1].lower()
    try:
        if suffix == ".frb":
            return check_text(read_text(path), name, on)
        if suffix == ".lut":
            from fuzzyarm.table.files import parse_table

            with open(path, "rb") as file:
                data = file.read()
            text = data.decode("utf-8-sig", "replace")
            return Review(text, tuple(parse_table(data, name).diagnostics))
        if suffix in READABLE:
            return _check_foreign(path, name)
        # Other formats of tables have no checks: reading them is the check.
        load(path)
    except RuleBaseError as error:
        return Review("", error.diagnostics)
    return Review("", ())


def _check_foreign(path: str | os.PathLike[str], name: str) -> Review:
    from fuzzyarm.exchange.formats import read

    imported = read(path)
    text = text_to_show(path)
    if imported.rulebase is None:
        return Review(text, tuple(imported.diagnostics))
    # The other program does compute the file, so a contradiction is only a warning.
    findings = [
        replace(diagnostic, severity=Severity.WARNING) if diagnostic.is_error else diagnostic
        for diagnostic in check(imported.rulebase, path=name)
    ]
    return Review(text, (*imported.diagnostics, *findings), imported.rulebase)


class Judgement(NamedTuple):
    """Whether a file keeps its ``expect`` and ``prove`` lines."""

    # One for each false outcome of an ``expect`` line, and for each ``prove`` line that is refuted
    # or takes too long for a check.
    findings: list[Diagnostic]
    verdicts: tuple[Verdict, ...] = ()  # on the ``prove`` lines


PROOF_SECONDS = 1.0
"""Time limit of one ``prove`` line in a check, s."""


def judge(rulebase: RuleBase, on_step: Callable[[], None] = lambda: None) -> Judgement:
    """Evaluate the ``expect`` lines of a rule base, and judge its ``prove`` lines.

    Parameters
    ----------
    rulebase : RuleBase
        With its lines.
    on_step : callable
        Called now and then; an exception from it ends it.

    Returns
    -------
    Judgement
        The failed lines, and the verdicts on the ``prove`` lines.
    """
    findings: list[Diagnostic] = []
    if rulebase.expectations:
        from fuzzyarm.inference import check_expectations

        findings += check_expectations(rulebase, on_step)
    if not rulebase.properties:
        return Judgement(findings)
    from fuzzyarm.proof.map import prove_all

    verdicts = []
    proving = prove_all(rulebase, budget=PROOF_SECONDS, tell=lambda *_: on_step())
    for claim, verdict in zip(rulebase.properties, proving, strict=True):
        on_step()
        verdicts.append(verdict)
        if verdict.verdict == "refuted":
            message = f"refuted: {verdict.statement}"
            detail = "; ".join(verdict.evidence) or verdict.reason
            findings.append(
                Diagnostic(
                    "refuted-property",
                    f"{message} ({detail})",
                    claim.span,
                    Severity.ERROR,
                    lines=verdict.evidence,
                )
            )
        elif not verdict.proved:
            message = f"left undecided: {verdict.statement} ({verdict.reason})"
            hint = "fuzzyarm prove has more time" if "time ran out" in verdict.reason else ""
            findings.append(
                Diagnostic("undecided-property", message, claim.span, Severity.INFO, hint=hint)
            )
    return Judgement(findings, tuple(verdicts))
