"""Servers of the designer, each a process forked from one that has imported what takes long."""

from __future__ import annotations

import multiprocessing
import os
import sys
from pathlib import Path

WITH_FORKS = "forkserver" in multiprocessing.get_all_start_methods()
HEAVY = [
    "fuzzyarm.apps.cli.designer", "fuzzyarm.apps.designer.server", "numpy", "uvicorn.server",
    "uvicorn.lifespan.on", "uvicorn.protocols.http.h11_impl",
    "uvicorn.protocols.websockets.websockets_sansio_impl", "websockets.speedups",
]  # fmt: skip


def start(words: list[str], state: str, log: Path) -> tuple[multiprocessing.Process, str]:
    """Start ``fuzzyarm WORDS``; return its process and the first line of its output."""
    context = multiprocessing.get_context("forkserver" if WITH_FORKS else "spawn")
    if WITH_FORKS:
        context.set_forkserver_preload(HEAVY)
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_run, args=(words, state, str(log), theirs))
    process.start()
    theirs.close()
    with os.fdopen(os.dup(ours.fileno()), encoding="utf-8") as output:
        ours.close()
        return process, output.readline().strip()


def _run(words: list[str], state: str, log: str, output) -> None:
    from fuzzyarm.apps.cli.main import main

    os.dup2(output.fileno(), 1)
    os.dup2(os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), 2)
    output.close()
    sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stderr = open(2, "w", encoding="utf-8", closefd=False, buffering=1)  # noqa: SIM115
    os.environ["XDG_STATE_HOME"] = state
    sys.exit(main(words))
