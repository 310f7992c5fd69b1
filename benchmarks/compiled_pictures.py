"""Draw what compiled.py measured, for docs/explanation/performance.md."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from fuzzyarm.apps.show.figures.style import new_figure

PICTURES = Path(__file__).resolve().parent.parent / "docs/pictures"
OURS, PEERS, INK = "#1f6f8b", "#b9b4a7", "#333333"


def draw(microseconds: Mapping[str, float], checks: Mapping[int, float]) -> None:
    """Write performance-inference.png and performance-check.png."""
    _bars(microseconds, PICTURES / "performance-inference.png")
    _growth(checks, PICTURES / "performance-check.png")


def _bars(microseconds: Mapping[str, float], path: Path) -> None:
    entries = sorted(microseconds.items(), key=lambda entry: -entry[1])
    figure = new_figure(8.0, 0.42 * len(entries) + 1.1)
    axes = figure.add_subplot()
    names = [name for name, _ in entries]
    values = [value for _, value in entries]
    peers = ("pyfuzzylite", "scikit", "C,")
    colours = [PEERS if name.startswith(peers) else OURS for name in names]
    axes.barh(range(len(entries)), values, color=colours, height=0.66)
    axes.set_yticks(range(len(entries)), names)
    axes.set_xscale("log")
    axes.set_xlim(3e-3, 4e5)
    for i, value in enumerate(values):
        axes.text(1.25 * value, i, f"{value:,.3g}" if value < 1e3 else f"{value:,.0f}",
                  va="center", color=INK, fontsize=9)  # fmt: skip
    axes.set_xlabel("µs a point (logarithmic)")
    axes.set_title("49 rules on two inputs: blue fuzzyarm, grey others", fontsize=10)
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=110)


def _growth(checks: Mapping[int, float], path: Path) -> None:
    figure = new_figure(6.0, 3.6)
    axes = figure.add_subplot()
    rules, seconds = list(checks), list(checks.values())
    base = min(seconds)
    slope = (seconds[-1] - base) / rules[-1]
    dense = [rules[0] * (rules[-1] / rules[0]) ** (i / 60) for i in range(61)]
    axes.loglog(dense, [base + slope * n for n in dense], color=PEERS,
                label=f"{base:.3f} s + {1e6 * slope:.0f} µs a rule")  # fmt: skip
    axes.loglog(rules, seconds, "o", color=OURS, label="measured")
    axes.set_xlabel("rules in the file")
    axes.set_ylabel("processor seconds")
    axes.set_ylim(0.02, 2.0)
    axes.legend(frameon=False)
    axes.set_title("fuzzyarm check, the whole command", fontsize=10)
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=110)
