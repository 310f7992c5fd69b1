"""Live systems of other fuzzy libraries: their rule bases, compared with the originals.

:func:`from_live` converts an object, :func:`read_script` those of a script. The library's own
object and the rule base are evaluated at a hundred points.
"""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from fuzzyarm.base.diagnostic import NOWHERE, Diagnostic, RuleBaseError, Severity, Span
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.exchange.files import FileWarning
from fuzzyarm.exchange.formats.comparison import compare
from fuzzyarm.exchange.formats.findings import Findings
from fuzzyarm.exchange.formats.tables import in_tables
from fuzzyarm.exchange.live import gather
from fuzzyarm.exchange.live.objects import library_of, measured, read_object
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import RuleBase

# --- One object ---


def from_live(
    system: object, name: str | None = None, *, points: bool = False, lossy: bool = False
) -> RuleBase:
    """Return the rule base of a live object of another fuzzy library.

    Parameters
    ----------
    system : object
        A ``ControlSystem`` or ``ControlSystemSimulation`` of scikit-fuzzy, an ``Engine`` of
        pyfuzzylite, a ``FuzzySystem`` of simpful, a ``Rule`` of fuzzylogic, or a system of
        pyit2fls (``IT2Mamdani``, ``IT2TSK``, ``IT2FLS``, ``T1Mamdani``, ``T1TSK``).
    name : str, optional
        Name of the rule base; by default that in the library.
    points : bool
        scikit-fuzzy only: keep every term as straight lines between the points of its universe,
        instead of the gaussian, bell and so on with the same degrees there.
    lossy : bool
        Accept differences of more than 1 % of the range of an output.

    Returns
    -------
    RuleBase
        With the library's implicit defaults written out.

    Warns
    -----
    FileWarning
        For each difference, with its greatest value at 100 points if the library's own object could
        be evaluated; its `diagnostic` has name and message.

    Raises
    ------
    TypeError
        If the object is none of these.
    RuleBaseError
        If it cannot be converted; `diagnostics` have the reasons.
    """
    library = library_of(system)
    name = name or (library.module if library else "")
    imported = read_object(system, name, points=points, lossy=lossy)
    diagnostics = list(imported.diagnostics)
    rulebase = imported.rulebase
    if rulebase is not None:
        rulebase = in_tables(rulebase)
        assert library is not None
        diagnostics += compare(rulebase, measured(system, rulebase), library.name, lossy=lossy)
    diagnostics = [replace(diagnostic, path=diagnostic.path or name) for diagnostic in diagnostics]
    if rulebase is None or any(diagnostic.is_error for diagnostic in diagnostics):
        raise RuleBaseError(diagnostics)
    for diagnostic in diagnostics:
        if diagnostic.severity is Severity.WARNING:
            warnings.warn(FileWarning(diagnostic), stacklevel=2)
    return rulebase


# --- A script ---


class ScriptError(FuzzyarmError, ValueError):
    """A script without a result.

    Attributes
    ----------
    diagnostics : tuple of Diagnostic
        The reasons, with the line of the script if there is one.
    """

    def __init__(
        self, message: str, hint: str = "", diagnostics: Sequence[Diagnostic] = ()
    ) -> None:
        super().__init__(message, hint=hint)
        self.diagnostics = tuple(diagnostics)


@dataclass(frozen=True, slots=True)
class System:
    """A fuzzy system made by a script.

    Attributes
    ----------
    name : str
        The script's variable, as a file name.
    library : str
        Name of its library.
    rulebase : RuleBase or None
        None after any error.
    text : str
        The rule base as a ``.frb`` text; empty if there is none.
    diagnostics : tuple of Diagnostic
        Findings, the comparison of numbers last.
    """

    name: str
    library: str
    rulebase: RuleBase | None
    text: str
    diagnostics: tuple[Diagnostic, ...]


def read_script(
    path: str | os.PathLike[str],
    *,
    seconds: float = 60.0,
    python: str | os.PathLike[str] | None = None,
    points: bool = False,
    lossy: bool = False,
    strict: bool = False,
) -> tuple[tuple[System, ...], tuple[Diagnostic, ...]]:
    """Run a script in a separate process and return its fuzzy systems.

    The script runs like ``python SCRIPT``, with the installed packages, in its own folder, without
    a terminal or windows; its output is dropped. It has all rights of its user: run only scripts
    that you trust.

    Parameters
    ----------
    path : path-like
        A Python script.
    seconds : float
        Time for the script, after which it is interrupted.
    python : path-like, optional
        Another interpreter (3.11 or newer), for libraries that cannot be installed beside
        fuzzyarm; this one by default.
    points, lossy, strict : bool
        As for :func:`from_live`, and for :func:`fuzzyarm.exchange.formats.read`. `lossy` also
        accepts the unused systems of a script that failed.

    Returns
    -------
    systems : tuple of System
        Each with its findings.
    diagnostics : tuple of Diagnostic
        Warnings about the script as a whole.

    Raises
    ------
    OSError
        If the script or the interpreter cannot be started.
    ScriptError
        If the script fails, does not end, or makes no fuzzy system.
    """
    script = Path(path).resolve()
    with script.open("rb"):  # fail before the process is started
        pass
    options = {"seconds": seconds, "points": points, "lossy": lossy, "strict": strict}
    try:
        data, last_words = _answer(script, os.fspath(python or sys.executable), options)
    except ScriptError as error:
        raise ScriptError(f"{os.fspath(path)}: {error}", error.hint) from None
    diagnostics = _about_script(data, os.fspath(path), seconds, lossy=lossy, strict=strict)
    systems = tuple(_system(record, lossy=lossy, strict=strict) for record in data["found"])
    if systems:
        return systems, diagnostics
    reason, hint = data.get("refused", "no fuzzy system found"), last_words
    raise ScriptError(
        f"{os.fspath(path)}: {reason}", hint if "refused" in data else _NOTHING, diagnostics
    )


_NOTHING = (
    "a ControlSystem of scikit-fuzzy, an Engine of pyfuzzylite, a FuzzySystem of simpful, a Rule "
    "of fuzzylogic or a system of pyit2fls must exist when the script ends: call the function that "
    "builds it; functions such as interp_membership leave no object that holds rules"
)

_HINTS = {
    "EOFError": "input() has no answer: write the value into the script",
    "SystemExit": "the script gets no arguments: write the values into it",
    "AttributeError: 'ControlSystemVisualizer'": "rule.view() fails in this version of "
    "scikit-fuzzy: leave the line out",
}
"""Remedies for common exceptions of a script, by the beginning of their kind and message."""

_PACKAGES = {
    "cv2": "opencv-python", "fuzzylite": "pyfuzzylite", "PIL": "Pillow", "RPi": "RPi.GPIO",
    "serial": "pyserial", "skfuzzy": "scikit-fuzzy", "sklearn": "scikit-learn", "yaml": "PyYAML",
}  # fmt: skip
"""Packages with another name than their module."""

_OF_WINDOWS = {"_winapi", "msvcrt", "nt", "winreg", "winsound"}


def _hint(raised: Mapping[str, Any]) -> str:
    missing = re.match(r"No module named '(\w+)", raised["message"])
    if missing is None or raised["kind"] != "ModuleNotFoundError":
        error = f"{raised['kind']}: {raised['message']}"
        return next((hint for start, hint in _HINTS.items() if error.startswith(start)), "")
    if missing[1] in _OF_WINDOWS:
        return f"{missing[1]} is a part of Python on Windows: run this there, or leave it out"
    package = _PACKAGES.get(missing[1], missing[1])
    return f"pip install {package} ; --python names another interpreter that has it"


def _about_script(
    data: Mapping[str, Any], path: str, seconds: float, *, lossy: bool, strict: bool
) -> tuple[Diagnostic, ...]:
    """Return the findings about a script, early end included; without systems raise an error."""
    findings = Findings(path, lossy=lossy, strict=strict)
    has_systems = bool(data["found"])
    so_far = "; the systems made by then are taken" if has_systems else ""
    raised = data["raised"]
    say = partial(findings.loss, slight=True) if has_systems else findings.error
    if raised and raised["kind"] == "KeyboardInterrupt":
        message = f"the script has not ended within {seconds:g} s{so_far}"
        say("endless-script", message, hint="--seconds gives it more")
    elif raised and not (has_systems and raised["kind"] == "SystemExit"):
        line, column = max(1, raised["line"]), max(1, raised["column"])
        at = Span(line, column, line, column + 1) if raised["line"] else NOWHERE
        detail = f": {raised['message']}" if raised["message"] else ""
        message = f"the script ends with {raised['kind']}{detail}{so_far}"
        say("failed-script", message, at, _hint(raised))
    if left_out := data["left_out"]:
        message = (
            f"{', '.join(left_out)} had not computed anything before that and may lack rules; "
            "left out"
        )
        findings.warn("failed-script", message, hint="--lossy takes it all the same")
    if findings.failed and "refused" not in data:
        raise ScriptError(
            f"{path}: the script ends early; nothing is gathered", diagnostics=findings.all()
        )
    return findings.all()


def _system(objects: Mapping[str, Any], *, lossy: bool, strict: bool) -> System:
    diagnostics = [
        Diagnostic(name, message, severity=Severity(severity), hint=hint)
        for name, message, severity, hint in objects["diagnostics"]
    ]
    text = str(objects["text"] or "")
    rulebase = parse(text).rulebase if text else None
    if rulebase is not None:
        library = str(objects["library"])
        diagnostics += compare(rulebase, objects["points"], library, lossy=lossy, strict=strict)
    if any(diagnostic.is_error for diagnostic in diagnostics):
        rulebase = None
    return System(
        objects["name"], objects["library"], rulebase, text if rulebase else "", tuple(diagnostics)
    )


# --- The process ---

_MEASURING = 10.0 * gather.MEASURING
"""Seconds on the clock, after those of the script, until its process is killed."""


def _answer(script: Path, python: str, options: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """Run the script; return the gathered answer, and the end of its error output."""
    with tempfile.TemporaryDirectory(prefix="fuzzyarm-") as folder:
        target, errors = Path(folder) / "answer.json", Path(folder) / "errors"
        with errors.open("wb") as stream:
            process = subprocess.Popen(
                [python, gather.__file__, str(script), str(target), json.dumps(options)],
                cwd=script.parent,
                env=os.environ | {"MPLBACKEND": "Agg", "PYTHONIOENCODING": "utf-8"},
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=stream,
                start_new_session=True,
            )
            try:
                with suppress(subprocess.TimeoutExpired):
                    process.wait(options["seconds"] + _MEASURING)
            finally:
                _end(process)
        last_words = errors.read_text("utf-8", "replace").strip().rpartition("\n")[2][-2000:]
        try:
            return json.loads(target.read_text(encoding="utf-8")), last_words
        except (OSError, ValueError):
            status = process.returncode
            how = f"signal {-status}" if status < 0 else f"status {status}"
            raise ScriptError(f"its process ended with {how}", last_words) from None


def _end(process: subprocess.Popen[bytes]) -> None:
    """End the process and its children."""
    with suppress(OSError):
        if hasattr(os, "killpg"):
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()
    process.wait()
