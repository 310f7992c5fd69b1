"""A Python that begins with its libraries loaded: a process for each script, forked from one.

`fuzzyarm.exchange.live` starts ``PYTHON gather.py SCRIPT ANSWER OPTIONS``, and that process loads
NumPy, SciPy, networkx and matplotlib before the first line of a script says anything: 0.6 s of a
processor. The program that :func:`forked_python` writes asks a server by a socket, which has
loaded them, forks, and runs ``gather.py`` in the child with the streams, the folder and the
environment of whoever asked. The libraries of fuzzy systems themselves are loaded by the script.
"""

from __future__ import annotations

import contextlib
import gc
import json
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

with contextlib.suppress(ImportError):  # the server knows of no tests
    from budget import cases

LIBRARIES = ("skfuzzy.control", "simpful", "pyit2fls", "fuzzylogic.classes")
"""What is loaded with all that it needs, and then forgotten."""

CLIENT = """\
#!{python} -IS
import json, os, socket, sys
line = socket.socket(socket.AF_UNIX)
line.connect({address!r})
job = json.dumps([sys.argv[1:], os.getcwd(), dict(os.environ)])
socket.send_fds(line, [job.encode() + b"\\n"], [0, 1, 2])
status = int(line.makefile().readline() or 1)
if status < 0:
    os.kill(os.getpid(), -status)
sys.exit(status)
"""


@contextlib.contextmanager
def forked_python(folder: Path) -> Iterator[str]:
    """Yield the path of such a Python; its server ends behind it.

    With ``--thorough``, and where nothing forks, it is the one that runs here.
    """
    if cases(0, 1) or not hasattr(os, "fork"):
        yield sys.executable
        return
    address = str(folder / "line")
    program = folder / "python"
    program.write_text(CLIENT.format(python=sys.executable, address=address), "utf-8")
    program.chmod(0o755)
    environment = os.environ | {"MPLBACKEND": "Agg"}
    words = [sys.executable, __file__, address]
    streams = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen(words, env=environment, text=True, **streams) as server:
        assert server.stdout is not None
        assert server.stdout.readline() == "ready\n"
        yield str(program)
        server.terminate()


def asked(address: str) -> tuple[list[str], socket.socket]:
    """Wait for jobs; return the words of one, in the child that runs it."""
    for name in LIBRARIES:
        with contextlib.suppress(ImportError):
            import_module(name)
    import fuzzyarm.exchange.formats.tables
    import fuzzyarm.exchange.live.objects
    import fuzzyarm.exchange.live.pyit2fls  # noqa: F401

    forgotten = {name.partition(".")[0] for name in LIBRARIES}
    for name in [name for name in sys.modules if name.partition(".")[0] in forgotten]:
        del sys.modules[name]
    gc.collect()
    gc.freeze()
    threading.Thread(target=end_with_tests, daemon=True).start()
    listening = socket.socket(socket.AF_UNIX)
    listening.bind(address)
    listening.listen()
    print("ready", flush=True)  # noqa: T201
    while True:
        line, _ = listening.accept()
        job, streams, *_ = socket.recv_fds(line, 1 << 20, 3)
        while not job.endswith(b"\n"):
            job += line.recv(1 << 20)
        child = os.fork()
        if child:
            for stream in streams:
                os.close(stream)
            threading.Thread(target=tell, args=(line, child), daemon=True).start()
            continue
        listening.close()
        words, folder, environment = json.loads(job)
        for number, stream in enumerate(streams):
            os.dup2(stream, number)
            os.close(stream)
        os.chdir(folder)
        os.environ.clear()
        os.environ.update(environment)
        return words, line


def end_with_tests() -> None:
    """End the server when the tests have ended, however they did."""
    sys.stdin.read()
    os._exit(0)


def tell(line: socket.socket, child: int) -> None:
    """Tell who asked how a child has ended."""
    with contextlib.suppress(OSError), line:
        line.sendall(b"%d\n" % os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))


def end_with(line: socket.socket) -> None:
    """End this process when whoever asked for it has been ended."""
    line.recv(1)
    os.kill(os.getpid(), signal.SIGKILL)


if __name__ == "__main__":
    words, line = asked(sys.argv[1])
    threading.Thread(target=end_with, args=(line,), daemon=True).start()
    sys.stdin = open(0, closefd=False)  # noqa: SIM115 - a thread of the server waits in the other
    sys.argv, sys.path[0] = words, str(Path(words[0]).parent)
    names: dict[str, Any] = {"__name__": "gather", "__file__": words[0]}
    exec(compile(Path(words[0]).read_bytes(), words[0], "exec"), names)
    names["main"]()
