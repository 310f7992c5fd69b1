"""Processes that compile kernels at the same time, so that a first run on a machine begins sooner.

A compiler holds the lock of its process, so each processor needs a process of its own. A
helper is a new Python with the same folders to import from; it is told functions by their names,
and says in lines of JSON what it has begun and what machine code it has made. What it cannot do
(it does not start, it is killed) is compiled here.
"""

from __future__ import annotations

import base64
import contextlib
import importlib
import json
import os
import subprocess
import sys
import zlib
from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

from fuzzyarm.kernels import (
    MachineCode,
    Wanted,
    address_of,
    before_compiling,
    count_functions,
    gathered,
    machine_code,
    size_of,
    take_machine_code,
    to_compile,
)
from fuzzyarm.machine_code import Compiling, tell_begun, telling, watch_compiling

MOST_HELPERS = 3
"""Processes beside this one: a closed loop has few programs, and each process imports numba."""


def foreseen(need: Callable[[], None]) -> AbstractContextManager[None]:
    """Have all that is needed compiled at once as soon as something has to be compiled.

    Parameters
    ----------
    need : callable
        Asks :func:`fuzzyarm.kernels.address_of` for everything, and keeps no address: it gets
        none. It is called only if something is missing.
    """
    return before_compiling(lambda: compile_together(need))


def compile_together(need: Callable[[], None], processors: int | None = None) -> None:
    """Compile what is needed and missing, on several processors at the same time.

    Parameters
    ----------
    need : callable
        See :func:`foreseen`.
    processors : int, optional
        By default those that this process may use.
    """
    with gathered() as wanted:
        need()
    missing = to_compile(wanted)
    processors = processors or _processors()
    own, *others = _shares(missing, min(processors, 1 + MOST_HELPERS))
    if not others:
        return
    with contextlib.ExitStack() as stack:
        helpers = [stack.enter_context(helper) for helper in map(_Helper, others)]
        stack.enter_context(telling(own[0].function.__name__, sum(map(count_functions, missing))))
        for each in own:
            address_of(
                each.function, each.types, dict(each.bindings), compiled=True, inline=each.inline
            )
        for helper in helpers:
            helper.finish()


def _processors() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _shares(missing: Iterable[Wanted], processes: int) -> list[list[Wanted]]:
    """Share functions among processes, the longest first; those without a name stay here."""
    shares: list[list[Wanted]] = [[] for _ in range(processes)]
    work = [0] * processes
    for each in sorted(missing, key=lambda each: (_has_name(each), -size_of(each))):
        least = work.index(min(work)) if _has_name(each) else 0
        shares[least].append(each)
        work[least] += size_of(each)
    own, *others = shares
    return [own, *filter(None, others)]


# --- Functions as words ---


def _has_name(wanted: Wanted) -> bool:
    """Whether another process finds all its functions by their names."""
    functions = [wanted.function, *(bound for _, bound in wanted.bindings)]
    return all(_is_ours(each) for each in functions)


def _is_ours(function: Callable[..., Any]) -> bool:
    home = sys.modules.get(function.__module__)
    ours = function.__module__.startswith("fuzzyarm.")
    return ours and getattr(home, function.__qualname__, None) is function


def _words(wanted: Wanted) -> dict[str, Any]:
    return {
        "function": _name(wanted.function),
        "types": wanted.types,
        "bindings": {name: _name(bound) for name, bound in wanted.bindings},
        "inline": wanted.inline,
    }


def _from_words(words: dict[str, Any]) -> Wanted:
    bindings = tuple((name, _found(bound)) for name, bound in words["bindings"].items())
    return Wanted(_found(words["function"]), words["types"], bindings, words["inline"])


def _name(function: Callable[..., Any]) -> str:
    return f"{function.__module__}:{function.__qualname__}"


def _found(name: str) -> Callable[..., Any]:
    module, _, own = name.partition(":")
    found: Callable[..., Any] = getattr(importlib.import_module(module), own)
    return found


# --- A helper, seen from here ---

_BEGIN = (
    "import sys, json; sys.path[:] = json.loads(sys.argv[1]);"
    "from fuzzyarm.compilers import serve; serve(json.loads(sys.argv[2]))"
)


class _Helper:
    """A process that compiles its share; it ends with the block."""

    def __init__(self, share: Sequence[Wanted]) -> None:
        self.share = share
        self._process: subprocess.Popen[str] | None = None

    def __enter__(self) -> _Helper:
        # A program that only contains Python (a frozen one) would start itself anew.
        if Path(sys.executable or "").stem.lower().startswith("python"):
            words = [json.dumps(sys.path), json.dumps([_words(each) for each in self.share])]
            with contextlib.suppress(OSError):
                self._process = subprocess.Popen(
                    [sys.executable, "-I", "-c", _BEGIN, *words],
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.PIPE,
                    stderr=subprocess.DEVNULL,
                    text=True,
                )
        return self

    def __exit__(self, *_: object) -> None:
        if self._process is not None:
            self._process.kill()
            with self._process:  # closes the pipe and waits
                pass

    def finish(self) -> None:
        """Take what it says until it is done."""
        if self._process is None or self._process.stdout is None:
            return
        with contextlib.suppress(ValueError):  # it was killed in the middle of a line
            for line in self._process.stdout:
                self._take(json.loads(line))

    def _take(self, said: dict[str, Any]) -> None:
        if "begun" in said:
            tell_begun(said["begun"])
        else:
            code = zlib.decompress(base64.b64decode(said["code"]))
            made = MachineCode(code, said["complete"], said["digest"])
            take_machine_code(self.share[said["index"]], made)


# --- A helper, seen from inside ---


def serve(share: Sequence[dict[str, Any]]) -> None:
    """Compile what is asked for and say so on the standard output.

    Parameters
    ----------
    share : sequence of dict
        Functions as words.
    """
    import signal

    signal.signal(signal.SIGINT, signal.SIG_DFL)  # who interrupts the other process says so
    watch_compiling(_say_begun)
    with telling("", len(share)):  # only what is begun: who reads has the count of all
        for index, words in enumerate(share):
            made = machine_code(_from_words(words))
            code = base64.b64encode(zlib.compress(made.code)).decode()
            _say(index=index, code=code, complete=made.complete, digest=made.digest)


def _say_begun(what: Compiling | None) -> None:
    if what is not None and what.name:
        _say(begun=what.name)


def _say(**what: Any) -> None:
    sys.stdout.write(json.dumps(what) + "\n")
    sys.stdout.flush()
