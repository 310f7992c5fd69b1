"""Make the figures of the paper: `python paper/make_figures.py`.

The numbers are those of the referee's suite: its cases and the answers in `conformance/results`.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

HERE = Path(__file__).parent
SUITE = HERE.parent / "conformance"
TOOLS = ("fuzzyarm-point", "pyfuzzylite", "octave", "simpful", "pyit2fls", "scikit-fuzzy")
"""One engine stands for fuzzyarm: the others answer alike."""

NAMES = {"fuzzyarm-point": "fuzzyarm", "octave": "Octave toolkit"}
VERDICTS = (("pass", "passes", "#2a9d8f"), ("wrong", "differs or fails", "#d1495b"),
            ("cannot", "has no such setting", "#d9d9d9"))  # fmt: skip


def counts(tool: str) -> dict[str, int]:
    """Return how many cases a tool passes, misses and cannot be asked."""
    verdicts = json.loads((SUITE / "results" / f"{tool}.json").read_text("utf-8"))["verdicts"]
    found = [verdict["verdict"] for verdict in verdicts.values()]
    wrong = found.count("differs") + found.count("error")
    return {"pass": found.count("pass"), "wrong": wrong, "cannot": found.count("cannot")}


def tips() -> dict[str, float]:
    """Return the tips of the example by their settings, from the cases."""
    data = json.loads((SUITE / "cases" / "sampled-centroids.json").read_text("utf-8"))
    wanted = {
        "tipper-endpoints-26": "26 samples",
        "tipper-endpoints-101": "101 samples (MATLAB)",
        "tipper-trapezoid-101": "101, trapezoid rule (Octave)",
        "tipper-joined-26": "26, joined (scikit-fuzzy)",
        "tipper-exact": "the integral",
    }
    cases = {case["name"]: case["points"][0]["expected"] for case in data["cases"]}
    found = {name: cases[name]["tip"]["value"] for name in wanted}
    return {label: found[name] for name, label in wanted.items()}


def draw_conformance(path: Path) -> None:
    """Draw who passes what."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 2.6), layout="constrained")
    axes = figure.subplots()
    starts = [0] * len(TOOLS)
    for key, label, colour in VERDICTS:
        values = [counts(tool)[key] for tool in TOOLS]
        names = [NAMES.get(tool, tool) for tool in TOOLS]
        axes.barh(names, values, left=starts, color=colour, label=label)
        starts = [start + value for start, value in zip(starts, values, strict=True)]
    axes.invert_yaxis()
    axes.set_xlabel("cases")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, frameon=False)
    figure.savefig(path, dpi=200, metadata={"Software": None})


def draw_tips(path: Path) -> None:
    """Draw one example under five settings."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 2.2), layout="constrained")
    axes = figure.subplots()
    listed = tips()
    for row, (label, value) in enumerate(listed.items()):
        colour = "#2a9d8f" if label == "the integral" else "#33658a"
        axes.plot([value], [row], "o", color=colour)
        axes.annotate(f"{value:.4f}", (value, row), (8, 0), textcoords="offset points", va="center")
    axes.axvline(listed["the integral"], color="#2a9d8f", linewidth=0.8, zorder=0)
    axes.set_yticks(range(len(listed)), list(listed))
    axes.set_ylim(len(listed) - 0.5, -0.5)
    axes.margins(x=0.3)
    axes.set_xlabel("tip")
    figure.savefig(path, dpi=200, metadata={"Software": None})


def main() -> int:
    """Write both figures beside the paper."""
    draw_conformance(HERE / "conformance.png")
    draw_tips(HERE / "tips.png")
    print(f"{HERE.name}: conformance.png, tips.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
