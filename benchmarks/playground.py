"""How long the page of a playground takes: its first paint, and until it can check a text.

Wall time depends on what else the machine does: several visits are measured, and the least and the
median are printed, beside the processor time of the renderer, on all its threads. Linux alone.
"""

from __future__ import annotations

import argparse
import functools
import http.server
import os
import shutil
import statistics
import tempfile
import threading
import time
from pathlib import Path

from playwright.sync_api import sync_playwright

from fuzzyarm.apps.playground.folder import wasm_kernels, write_playground
from fuzzyarm.apps.playground.memory import python_memory

PYODIDE = Path(__file__).parents[1] / "editors/designer/node_modules/pyodide"
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")

PATIENCE = 120.0  # s


class Quiet(http.server.SimpleHTTPRequestHandler):
    """Serves a folder."""

    def log_message(self, *_words: object) -> None:
        """Say nothing."""


def processor_seconds(marker: str) -> float:
    """Return the processor time of the renderers of a browser, by a word on their command line."""
    ticks = 0
    for process in Path("/proc").glob("[0-9]*"):
        try:
            words = (process / "cmdline").read_bytes().decode(errors="replace")
            if marker in words and "--type=renderer" in words:
                ticks += sum(
                    map(int, (process / "stat").read_text().rsplit(")", 1)[1].split()[11:13])
                )
        except OSError:  # it has ended
            continue
    return ticks / os.sysconf("SC_CLK_TCK")


def until(page: object, what: str) -> None:
    """Wait for an expression of the page, whose policy lets no text wait there by itself."""
    end = time.monotonic() + PATIENCE
    while not page.evaluate(what):  # type: ignore[attr-defined]
        if time.monotonic() > end:
            raise TimeoutError(what)
        time.sleep(0.02)


def visit(context: object, address: str, marker: str) -> tuple[float, float, float]:
    """Return first paint, the first file checked and drawn, and the processor time, all in s."""
    page = context.new_page()  # type: ignore[attr-defined]
    before = processor_seconds(marker)
    page.goto(address)
    until(page, "performance.getEntriesByName('ready').length && !!window.designer.store.scene")
    spent = processor_seconds(marker) - before
    checked = page.evaluate("performance.now()")
    paint = page.evaluate("performance.getEntriesByName('first-contentful-paint')[0].startTime")
    until(page, "navigator.serviceWorker.controller !== null")  # its files are kept
    page.close()
    return paint / 1000.0, checked / 1000.0, spent


def measured(folder: Path, visits: int) -> dict[str, list[tuple[float, float, float]]]:
    """Measure first visits, each with an empty browser, and later ones."""
    handler = functools.partial(Quiet, directory=str(folder))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    address = f"http://127.0.0.1:{server.server_port}/"
    found: dict[str, list[tuple[float, float, float]]] = {"first": [], "later": []}
    with sync_playwright() as playwright:
        for _ in range(visits):
            with tempfile.TemporaryDirectory(prefix="playground-") as profile:
                context = playwright.chromium.launch_persistent_context(
                    profile, executable_path=CHROMIUM, args=["--no-sandbox"]
                )
                found["first"].append(visit(context, address, profile))
                found["later"].append(visit(context, address, profile))
                context.close()
    server.shutdown()
    return found


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--visits", type=int, default=3)
    words = parser.parse_args()
    with tempfile.TemporaryDirectory() as room:
        folder = Path(room) / "site"
        size = write_playground(
            folder, pyodide=PYODIDE, kernels=wasm_kernels, memory=python_memory
        ).size
        print(f"folder: {size / 1e6:.1f} MB")
        print(f"{'visit':8}{'':12}{'least':>8}{'median':>8}  seconds")
        for which, rows in measured(folder, words.visits).items():
            columns = zip(*rows, strict=True)
            for name, column in zip(("paint", "checked", "processor"), columns, strict=True):
                print(f"{which:8}{name:12}{min(column):8.2f}{statistics.median(column):8.2f}")


if __name__ == "__main__":
    main()
