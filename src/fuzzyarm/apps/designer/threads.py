"""Concurrency of a page's answers: threads, or turns within one thread.

A server answers in the loop of asyncio and runs long work in threads. The Python of a page
(Pyodide) has no threads: there long work and answers take turns, in browsers that can suspend a
function of WebAssembly (JSPI, the JavaScript Promise Integration).
"""

from __future__ import annotations

import asyncio
import queue
import sys
import threading
from collections.abc import Callable, Coroutine
from concurrent.futures import Future
from typing import Any, Generic, ParamSpec, TypeVar

from fuzzyarm.base.lazy import load_packages

IN_A_PAGE = sys.platform == "emscripten"

TURN = 0.004
"""Seconds between two looks of waiting work, without threads."""

ANSWERING = (
    "fuzzyarm.control.controllers",
    "fuzzyarm.control.loop",
    "fuzzyarm.exchange.export",
    "fuzzyarm.learning.tuning",
    "fuzzyarm.proof.loop",
)
"""Packages that answers need (:func:`~fuzzyarm.base.lazy.load_packages`)."""

Result = TypeVar("Result")
Letter = TypeVar("Letter")
Arguments = ParamSpec("Arguments")


async def aside(
    function: Callable[Arguments, Result], *args: Arguments.args, **named: Arguments.kwargs
) -> Result:
    """Call a function beside the answering of questions; in a page, when those before it are."""
    if IN_A_PAGE:
        await asyncio.sleep(0.0)
        return function(*args, **named)
    load_packages(*ANSWERING)
    return await asyncio.to_thread(function, *args, **named)


def can_take_turns() -> bool:
    """Whether work may wait while others are answered."""
    if not IN_A_PAGE:
        return True
    from pyodide.ffi import can_run_sync

    return bool(can_run_sync())


async def run_to_its_end(function: Callable[[], Result]) -> Result:
    """Run work that may wait for the user indefinitely."""
    if IN_A_PAGE:
        await asyncio.sleep(0.0)
        return function()
    load_packages(*ANSWERING)
    ended: Future[Result] = Future()

    def work() -> None:
        result = function()
        # The receiver may be gone, as after the end of the server: then the result is dropped.
        if ended.set_running_or_notify_cancel():
            ended.set_result(result)

    threading.Thread(target=work, name="fuzzyarm-job", daemon=True).start()
    return await asyncio.wrap_future(ended)


def wait_for(telling: Coroutine[Any, Any, None], loop: asyncio.AbstractEventLoop) -> None:
    """Have the answering do something for work, and wait until it has."""
    if not IN_A_PAGE:
        asyncio.run_coroutine_threadsafe(telling, loop).result()
    elif can_take_turns():
        from pyodide.ffi import run_sync

        run_sync(telling)
        run_sync(asyncio.sleep(0.0))  # messages of the meantime are heard
    else:
        _at_once(telling)


def _at_once(telling: Coroutine[Any, Any, None]) -> None:
    """Run a coroutine that sends a message to a page, without waiting."""
    try:
        telling.send(None)
    except StopIteration:
        return
    telling.close()
    raise RuntimeError(
        "messages to a page have to wait, which this browser's WebAssembly cannot do"
    )


class Mailbox(Generic[Letter]):
    """Messages from one thread to another, in order."""

    def __init__(self) -> None:
        self._letters: queue.SimpleQueue[Letter] = queue.SimpleQueue()

    def put(self, letter: Letter) -> None:
        """Say something."""
        self._letters.put(letter)

    def take(self, wait: float = 0.0) -> Letter | None:
        """Return the oldest letter; None after `wait` seconds without one."""
        if IN_A_PAGE:
            self._let_others(wait)
        try:
            return self._letters.get(timeout=wait) if wait and not IN_A_PAGE else self._now()
        except queue.Empty:
            return None

    def _now(self) -> Letter:
        return self._letters.get_nowait()

    def _let_others(self, wait: float) -> None:
        """Let other tasks run until there is a letter or the time is up."""
        if not can_take_turns():
            return
        from pyodide.ffi import run_sync

        passed = 0.0
        while self._letters.empty() and passed < wait:
            run_sync(asyncio.sleep(min(TURN, wait - passed)))
            passed += TURN
