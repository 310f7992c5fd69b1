"""Systems of other fuzzy libraries, live: rule bases of them, and how far their numbers differ.

:func:`from_live` takes an object, :func:`read_script` a script that makes some. Either way the
library's own object is asked for its numbers at a hundred points and the rule base beside it.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import warnings
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, Any

from fuzzyarm.base.diagnostic import NOWHERE, Diagnostic, RuleBaseError, Severity, Span
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.exchange.files import FileWarning
from fuzzyarm.exchange.formats.findings import Findings
from fuzzyarm.exchange.formats.tables import in_tables
from fuzzyarm.exchange.live import gather
from fuzzyarm.exchange.live.comparison import compare
from fuzzyarm.exchange.live.objects import library_of, measured, read_object
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import RuleBase

__all__ = ["ScriptError", "System", "from_live", "read_script"]

# --- One object ---


def from_live(
    system: object, name: str | None = None, *, points: bool = False, lossy: bool = False
) -> RuleBase:
    """Return the rule base that a live object of another fuzzy library is.

    Parameters
    ----------
    system : object
        A ``ControlSystem`` or ``ControlSystemSimulation`` of scikit-fuzzy, an ``Engine`` of
        pyfuzzylite, a ``FuzzySystem`` of simpful, a ``Rule`` of fuzzylogic, or a system of
        pyit2fls (``IT2Mamdani``, ``IT2TSK``, ``IT2FLS``, ``T1Mamdani``, ``T1TSK``).
    name : str, optional
        What the rule base is called; by default that of the library.
    points : bool
        Of scikit-fuzzy: whether every term stays the straight lines between the points of its
        universe, rather than the gaussian, bell and so on that has the same degrees there.
    lossy : bool
        Whether to go on where numbers differ by more than 1 % of the range of an output.

    Returns
    -------
    RuleBase
        With what the library takes for granted written out.

    Warns
    -----
    FileWarning
        For what differs, with the greatest difference at 100 points where the library's own
        object was asked; its `diagnostic` has name and message.

    Raises
    ------
    TypeError
        If the object is none of these.
    RuleBaseError
        If it cannot be carried; `diagnostics` says why.
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
    """A script that nothing could be gathered from.

    Attributes
    ----------
    diagnostics : tuple of Diagnostic
        Why, with the line of the script where there is one.
    """

    def __init__(
        self, message: str, hint: str = "", diagnostics: Sequence[Diagnostic] = ()
    ) -> None:
        super().__init__(message, hint=hint)
        self.diagnostics = tuple(diagnostics)


@dataclass(frozen=True, slots=True)
class System:
    """A fuzzy system that a script has made.

    Attributes
    ----------
    name : str
        The script's variable, as the name of a file.
    library : str
        Whose object it is.
    rulebase : RuleBase or None
        None where any diagnostic is an error.
    text : str
        The rule base as a ``.frb`` text; empty if there is none.
    diagnostics : tuple of Diagnostic
        What was found, the comparison of numbers last.
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
    call: str | None = None,
    points: bool = False,
    lossy: bool = False,
    strict: bool = False,
) -> tuple[tuple[System, ...], tuple[Diagnostic, ...]]:
    """Run a script in a separate process and return the fuzzy systems that it makes.

    The script is run as ``python SCRIPT`` does it, in its own folder, without a terminal, windows,
    servers or devices: a stand-in that does nothing takes the place of their modules, and of those
    that are not installed. ``input()`` is answered with 1, what the script prints or saves as a
    figure is dropped. It can do whatever its user may do: run only what you trust.

    Parameters
    ----------
    path : path-like
        A Python script.
    seconds : float
        Time for the script; what it imports takes 30 s more, at most.
    python : path-like, optional
        Another interpreter (3.11 or newer), for libraries that cannot be installed beside
        fuzzyarm; this one by default.
    call : str, optional
        A function, a class or a `Class.method` of the script that is called when it has run, with
        1 for each argument that it demands; or a call with its arguments, as `fan(20, "low")`.
    points, lossy, strict : bool
        As for :func:`from_live`, and for :func:`fuzzyarm.exchange.formats.read`. `lossy` also
        takes what a script has made before it failed and not yet used.

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
    with script.open("rb"):  # a clear error before any process
        pass
    options = {"seconds": seconds, "call": call, "points": points, "lossy": lossy, "strict": strict}
    try:
        data, last_words = _answer(script, os.fspath(python or sys.executable), options)
    except ScriptError as error:
        raise ScriptError(f"{os.fspath(path)}: {error}", error.hint) from None
    diagnostics = _about_script(data, os.fspath(path), seconds, lossy=lossy, strict=strict)
    systems = tuple(_system(record, lossy=lossy, strict=strict) for record in data["found"])
    if systems:
        return systems, diagnostics
    if data.get("refused"):
        raise ScriptError(f"{os.fspath(path)}: {data['refused']}", last_words, diagnostics)
    raise ScriptError(f"{os.fspath(path)}: no fuzzy system found", _what_to_do(data), diagnostics)


_HINTS = {
    "EOFError": "input() is answered with 1: write the value into the script",
    "ModuleNotFoundError": "--python names an interpreter that has it",
    "SystemExit": "a script that needs arguments gets none: --call NAME calls a function of it",
}
"""What helps against some exceptions of a script."""


def _about_script(
    data: Mapping[str, Any], path: str, seconds: float, *, lossy: bool, strict: bool
) -> tuple[Diagnostic, ...]:
    """Return the findings about a script; raise an error if it yields nothing.

    What had been made before a script ended early is taken, with a warning.
    """
    findings = Findings(path, lossy=lossy, strict=strict)
    if names := data.get("stand_ins"):
        message = f"a stand-in that does nothing took the place of {', '.join(names)}"
        findings.warn("stand-in", message)
    if times := data.get("answers"):
        message = f"input() was answered with 1, {times} {'time' if times == 1 else 'times'}"
        findings.loss("answered-input", message, slight=True)
    has_systems = bool(data["found"])
    so_far = "; what it had made by then is taken" if has_systems else ""
    raised = data.get("raised")
    if data.get("endless"):
        message = f"the script has not ended within {seconds:g} s{so_far}"
        findings.loss("endless-script", message, hint="--seconds gives it more", slight=has_systems)
    elif raised and not (has_systems and raised["kind"] == "SystemExit"):
        line, column = max(1, raised["line"]), max(1, raised["column"])
        at = Span(line, column, line, column + 1) if raised["line"] else NOWHERE
        what = f"'{raised['called']}'" if raised.get("called") else "the script"
        detail = f": {raised['message']}" if raised["message"] else ""
        message = f"{what} ends with {raised['kind']}{detail}{so_far}"
        findings.loss(
            "failed-script", message, at, _HINTS.get(raised["kind"], ""), slight=has_systems
        )
    if left_out := data.get("left_out"):
        message = (
            f"{', '.join(left_out)} had not computed anything before that and may lack rules; "
            "left out"
        )
        findings.warn("failed-script", message, hint="--lossy takes it all the same")
    diagnostics = findings.all()
    if findings.failed and not data.get("refused"):
        name = "does not end" if data.get("endless") else "ends with an error"
        hint = _what_to_do(data) if data.get("builders") else ""
        raise ScriptError(f"{path}: the script {name}; nothing is gathered", hint, diagnostics)
    return diagnostics


def _what_to_do(data: Mapping[str, Any]) -> str:
    """Return what helps where a script has made no system."""
    if builders := data.get("builders"):
        names = ", ".join(builders[:6]) + (", …" if len(builders) > 6 else "")
        return f"--call NAME calls what would build one: {names}"
    if data.get("by_hand"):
        return (
            "the script computes by itself, with interp_membership and the like: its rules are in "
            "no object; a ControlSystem of skfuzzy.control would hold them"
        )
    return (
        "a ControlSystem of scikit-fuzzy, an Engine of pyfuzzylite, a FuzzySystem of simpful, a "
        "Rule of fuzzylogic or a system of pyit2fls must be there when the script has run"
    )


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

_MEASURING = gather.MEASURING + 60.0
"""Seconds for what comes after the script, before the process is ended from outside."""

_LAST_WORDS = 2000
"""Characters of the errors' end that are kept of a script that dies."""


def _answer(script: Path, python: str, options: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """Run the script and return what the process has gathered, and the end of its errors."""
    with tempfile.TemporaryDirectory(prefix="fuzzyarm-") as folder:
        target = Path(folder) / "answer.json"
        words = [python, os.fspath(gather.__file__), str(script), str(target), json.dumps(options)]
        process = subprocess.Popen(
            words,
            cwd=script.parent,
            env=_environment(),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            start_new_session=True,
        )
        assert process.stderr is not None
        tail = bytearray()
        reader = threading.Thread(target=_read_tail, args=(process.stderr, tail), daemon=True)
        reader.start()
        try:
            process.wait(options["seconds"] + gather.LOADING + gather.GRACE + _MEASURING)
        except subprocess.TimeoutExpired:
            pass
        finally:
            _end(process)
        reader.join(1.0)
        last_words = tail.decode(errors="replace").strip().rpartition("\n")[2]
        try:
            return json.loads(target.read_text(encoding="utf-8")), last_words
        except (OSError, ValueError):
            status = process.returncode
            how = f"signal {-status}" if status < 0 else f"status {status}"
            raise ScriptError(f"its process ended with {how}", last_words) from None


def _environment() -> dict[str, str]:
    """Return an environment in which nothing can open a window."""
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    return environment | {
        "MPLBACKEND": "Agg",
        "QT_QPA_PLATFORM": "offscreen",
        "SDL_VIDEODRIVER": "dummy",
        "BROWSER": "true",
        "PYTHONIOENCODING": "utf-8",
    }


def _read_tail(stream: IO[bytes], tail: bytearray) -> None:
    with suppress(OSError, ValueError), stream:
        while part := stream.read1(65536):  # type: ignore[attr-defined]
            tail += part
            del tail[:-_LAST_WORDS]


def _end(process: subprocess.Popen[bytes]) -> None:
    """End the process and what it has started."""
    with suppress(OSError):
        if hasattr(os, "killpg"):
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()
    process.wait()
