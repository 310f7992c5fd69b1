"""A budget counts work, so that a busy machine changes no verdict; the clock ends what hangs."""

from __future__ import annotations

import threading
import time

from fuzzyarm.proof import stop as stop_module
from fuzzyarm.proof.stop import Stop


def test_waiting_is_no_work() -> None:
    stop = Stop(0.1)
    time.sleep(0.25)  # as if others had the processor
    assert not stop.now
    assert stop.left > 0.05
    begun = time.thread_time()
    while time.thread_time() - begun < 0.12:
        pass
    assert stop.now


def test_the_clock_ends_what_waits_for_long(monkeypatch) -> None:
    monkeypatch.setattr(stop_module, "PATIENCE", 2.0)
    stop = Stop(0.1)
    time.sleep(0.25)
    assert stop.now


def test_in_another_thread_the_clock_counts() -> None:
    stop, found = Stop(0.1), list[bool]()
    time.sleep(0.15)
    thread = threading.Thread(target=lambda: found.append(stop.now))
    thread.start()
    thread.join()
    assert found == [True]
