"""Work beside the answering, and whoever waits for it."""

import asyncio
import subprocess
import sys
import threading

from fuzzyarm.apps.designer.threads import run_to_its_end


def test_work_whose_waiter_has_gone_ends_in_silence(monkeypatch):
    faults: list[threading.ExceptHookArgs] = []
    monkeypatch.setattr(threading, "excepthook", faults.append)
    go_on, begun = threading.Event(), threading.Event()

    def work() -> int:
        begun.set()
        go_on.wait(10.0)
        return 3

    async def waited() -> None:
        waiting = asyncio.ensure_future(run_to_its_end(work))
        await asyncio.to_thread(begun.wait, 10.0)
        waiting.cancel()
        await asyncio.gather(waiting, return_exceptions=True)
        thread = next(each for each in threading.enumerate() if each.name == "fuzzyarm-job")
        go_on.set()
        await asyncio.to_thread(thread.join, 10.0)

    asyncio.run(waited())
    assert not faults


def test_work_is_waited_for():
    assert asyncio.run(run_to_its_end(lambda: 3)) == 3


FIRST_ANSWERS = """
import asyncio
import subprocess
import sys
from importlib import import_module
from fuzzyarm.apps.designer.threads import aside

package = "fuzzyarm.control.controllers"
names = [package, *(f"{package}.{name}" for name in ("program", "period", "on_plant"))]

async def ask():
    await asyncio.gather(*(aside(import_module, name) for name in names))

asyncio.run(ask())
"""


def test_first_answers_do_not_import_half_of_each_other():
    for _ in range(3):
        subprocess.run([sys.executable, "-c", FIRST_ANSWERS], check=True, timeout=60)
