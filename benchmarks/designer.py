"""The designer in a browser: a dragged corner, a key stroke, the first paint, the bytes.

    python benchmarks/designer.py

Needs playwright and Chromium. A frame is what the browser shows: with everything drawn anew it
never comes sooner than 16.7 ms after the one before. The inference in the page is printed beside
that of Python in the same run.
"""

from __future__ import annotations

import gzip
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

try:
    from playwright.sync_api import sync_playwright
except ImportError:
    sync_playwright = None

import fuzzyarm
from fuzzyarm.apps.designer.assets import asset, names
from fuzzyarm.base.shipped_files import shipped

FRAMES = """async ([variable, term, index]) => {
  const { store } = designer;
  const found = [...store.scene.inputs, ...store.scene.outputs].find((v) => v.name === variable);
  const held = found.terms.find((t) => t.name === term);
  store.busy = true;
  store.hold(found, await HOLD);
  const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
  const times = [];
  for (let i = 0; i < 90; i++) {
    const moved = [...held.parameters];
    moved[index] += 0.3 * Math.sin(i / 5);
    store.reshape(found, held, moved);
    await frame();
    times.push(performance.now());
  }
  store.busy = false;
  store.forget();
  const steps = times.slice(31).map((t, i) => t - times[30 + i]).sort((a, b) => a - b);
  return [steps[Math.floor(steps.length / 2)], steps[Math.floor(steps.length * 0.95)]];
}""".replace("HOLD", "designer.text.numbers(variable)")

SURFACE = """() => {
  const times = [];
  for (let i = 0; i < 60; i++) {
    const start = performance.now();
    designer.store.surface();
    times.push(performance.now() - start);
  }
  return times.sort((a, b) => a - b)[30];
}"""

KEY = """async () => {
  const { view } = designer.text;
  const list = document.querySelector(".findings");
  const times = [];
  for (let i = 0; i < 24; i++) {
    const heard = new Promise((resolve) => {
      const watch = new MutationObserver(() => { watch.disconnect(); resolve(performance.now()); });
      watch.observe(list, { childList: true });
    });
    const start = performance.now();
    const at = view.state.doc.toString().indexOf("terms");
    if (i % 2) view.dispatch({ changes: { from: at + 1, to: at + 2 } });
    else view.dispatch({ changes: { from: at + 1, insert: "e" } });
    times.push(await heard - start);
    await new Promise((resolve) => setTimeout(resolve, 120));
  }
  return times.sort((a, b) => a - b);
}"""


def cube(terms: int) -> str:
    """Return a rule base over three inputs with a rule for each combination of terms."""
    listed = " ".join(f"T{i}" for i in range(terms))
    lines = ['rulebase cube "three inputs"', *(f"input {name} -1 .. 1" for name in "abc")]
    lines += ["output u -1 .. 1", f"terms a, b, c, u: triangles {listed}"]
    for c in range(terms):
        lines += [f"rules u when c is T{c}", f"  a \\ b  {listed}"]
        for i in range(terms):
            row = (min(terms - 1, max(0, (i + j + c) // 3)) for j in range(terms))
            lines.append(f"  T{i}  " + " ".join(f"T{each}" for each in row))
    return "\n".join(lines) + "\n"


def python_milliseconds(rulebase: fuzzyarm.RuleBase) -> float:
    """Return what 61 × 61 points take in Python, by the compiled kernel."""
    run = fuzzyarm.compiled(rulebase)
    axes = [np.linspace(each.low, each.high, 61) for each in rulebase.inputs[:2]]
    grid = [each.ravel() for each in np.meshgrid(*axes)]
    grid += [np.zeros(61 * 61) for _ in rulebase.inputs[2:]]
    times = []
    for _ in range(30):
        start = time.perf_counter()
        run(*grid)
        times.append(time.perf_counter() - start)
    return 1e3 * statistics.median(times)


def row(what: str, value: float, target: float, unit: str = "ms") -> None:
    """Print a figure beside its target."""
    verdict = "within" if value <= target else "OVER"
    print(f"{what:<58} {value:>9,.1f} {unit:<5} {verdict} {target:,.0f}", flush=True)


def main() -> None:
    """Measure and print."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if sync_playwright is None or chromium is None:
        raise SystemExit("playwright and chromium are needed")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for name in ("pd7.frb", "heater.frb", "roompi.frb"):
            (folder / name).write_text(shipped(name).read_text())
        (folder / "cube.frb").write_text(cube(7))
        words = [sys.executable, "-m", "fuzzyarm", "designer", place, "--no-browser"]
        state = {**os.environ, "XDG_STATE_HOME": str(folder / "state")}
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True, env=state) as server:
            assert server.stdout is not None
            address = server.stdout.readline().strip()
            with sync_playwright() as playwright:
                browser = playwright.chromium.launch(
                    executable_path=chromium, args=["--no-sandbox"]
                )
                measure(browser, address, folder)
                browser.close()
            server.terminate()


FRAMES_DRAWN = 90


def busy(meter: object) -> float:
    """Return the processor time that the page's own thread has taken, in ms."""
    metrics = meter.send("Performance.getMetrics")["metrics"]  # type: ignore[attr-defined]
    return 1e3 * next(each["value"] for each in metrics if each["name"] == "TaskDuration")


@contextmanager
def searching(browser: object, address: str) -> Iterator[None]:
    """Tune the heater in another window."""
    page = browser.new_page()  # type: ignore[attr-defined]
    page.goto(f"{address}#file=heater.frb")
    page.get_by_role("tab", name="Tune").click()
    page.get_by_text("What may move, as the text says").wait_for()
    tune = page.locator("#view-tune")
    tune.get_by_label("Trials", exact=True).fill("100000")
    tune.get_by_label("Reference", exact=True).fill("temperature=step:20")
    tune.get_by_role("button", name="Start").click()
    page.get_by_role("img", name="the best so far costs").wait_for()
    yield
    page.close()


def measure(browser: object, address: str, folder: Path) -> None:
    """Measure both files, then the bytes."""
    files = (("pd7", 49, ("e", "ZE", 1), 33), ("cube", 343, ("a", "T3", 1), 100))
    for name, rules, held, target in files:
        page = browser.new_page(viewport={"width": 1280, "height": 720})  # type: ignore[attr-defined]
        page.goto(f"{address}#file={name}.frb")
        while not page.evaluate("!!window.designer?.store.scene"):
            time.sleep(0.02)
        if name == "pd7":
            paint = "performance.getEntriesByName('first-contentful-paint')[0].startTime"
            row("first paint", page.evaluate(paint), 1500)
        output = ("u", held[1], 1)
        meter = page.context.new_cdp_session(page)
        meter.send("Performance.enable", {"timeDomain": "threadTicks"})
        for corner in (held, output):
            before = busy(meter)
            median, most = page.evaluate(FRAMES, list(corner))
            own = (busy(meter) - before) / FRAMES_DRAWN
            row(f"{rules} rules, a corner of '{corner[0]}' dragged: frame", median, target)
            print(f"{'':<8}{'95 in 100 frames within':<50} {most:>9.1f} ms")
            print(f"{'':<8}{'processor time of the page in each':<50} {own:>9.1f} ms")
        inferred = page.evaluate(SURFACE)
        python = python_milliseconds(fuzzyarm.load(folder / f"{name}.frb"))
        ratio = f"{inferred / python:.1f} times Python's compiled {python:.2f} ms"
        print(f"{'':<8}{'its 61 x 61 points alone':<50} {inferred:>9.2f} ms    {ratio}")
        if name == "pd7":
            times = page.evaluate(KEY)
            row("a key stroke to its findings, median", times[len(times) // 2], 50)
            print(f"{'':<8}{'the slowest of ' + str(len(times)):<50} {times[-1]:>9.1f} ms")
            with searching(browser, address):
                times = sorted(page.evaluate(KEY))
            row("the same while a controller is tuned", times[len(times) // 2], 50)
        page.close()
    used = [name for name in sorted({*names(), "engine.js"}) if not name.endswith(".md")]
    total = sum(len(gzip.compress((asset(name) or (b"", ""))[0])) for name in used)
    row("the page, compressed, no plotting library", total / 1e3, 2000, "kB")


if __name__ == "__main__":
    main()
