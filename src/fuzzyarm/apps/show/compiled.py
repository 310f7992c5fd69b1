"""Reports on compiled tables, source text and programs, line by line."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.apps.show.drawing import number_words
from fuzzyarm.base.numbers import outward_text, percent

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from fuzzyarm.exchange.export import Exported, ExportedController
    from fuzzyarm.table import CompileReport, Fidelity, LookupTable


def table_words(table: LookupTable, out: str) -> str:
    """Return the shape of a table in a file `out`."""
    shape = " x ".join(map(str, table.shape))
    return f"{out}: {shape} cells of {table.output} over {', '.join(table.names)}"


def report_lines(report: CompileReport, out: str) -> list[str]:
    """Return the lines about a compiled table and its error."""
    lines = [table_words(report.table, out)]
    if report.default_levels:
        lines.append("inputs without levels in the file got 13 even ones")
    lines.append("difference to direct inference, in units of the output:")
    lines += [f"  {fidelity_line(fidelity)}" for fidelity in report.fidelities]
    lines += _large_error(report)
    if report.few_points:
        lines.append("only a few points were compared, because direct inference is slow here")
    if report.tolerance is not None:
        grid_words = (
            "proved"
            if all(fidelity.proved is not None for fidelity in report.fidelities)
            else "sampled"
        )
        lines.append(
            f"this is the smallest even grid within {report.tolerance:g} ({grid_words}),"
            " looked up linearly"
        )
    return lines


LARGE = 0.05
"""Share of the output's range from which on a table's error gets a line."""


def _large_error(report: CompileReport) -> list[str]:
    """Return the worst error beside the range of the output, with a remedy, if it is large."""
    if not report.fidelities:
        return []
    used, values = report.fidelities[0], report.table.values
    low, high = float(values.min()), float(values.max())
    worst = used.worst if used.proved is None else used.proved
    if not worst > LARGE * (high - low) > 0.0:
        return []
    share, ends = worst / (high - low), f"{number_words(low, 4)} .. {number_words(high, 4)}"
    ways = "--levels N" if used.mode == "linear" else "--levels N or --mode linear"
    words = outward_text(worst, up=True, digits=3)
    return [f"worst error {words} of {ends}, {percent(share, 2)}: less with  {ways}"]


def fidelity_line(fidelity: Fidelity) -> str:
    """Return the error of a table against the rules in one lookup mode."""
    where = ", ".join(f"{name} = {number_words(x, 4)}" for name, x in fidelity.at)
    size = " x ".join(map(str, fidelity.points))
    worst = f"{number_words(fidelity.worst, 4)} (sampled)"
    if fidelity.proved is not None:
        worst = f"{outward_text(fidelity.proved, up=True, digits=6)} (proved)"
    return (
        f"{fidelity.mode:<7}  worst {worst:<18} "
        f"rms {number_words(fidelity.rms, 4):<8} worst at {where} (of {size} points)"
    )


def export_lines(exported: Exported) -> list[str]:
    """Return the size of exported files, and of each function its accuracy and cost."""
    from fuzzyarm.exchange.export.routine import proved_words

    lines = _sizes(exported.files)
    for call, routine in zip(exported.calls, exported.routines, strict=True):
        accuracy, cost = routine.accuracy, routine.cost()
        worst = number_words(accuracy.worst, 3)
        lines += [
            call,
            f"  worst error against {accuracy.against}: {worst} (of {accuracy.points:,} points)",
            *([f"  worst error {proved}"] if (proved := proved_words(routine)) else []),
            f"  at most {cost.in_words()}",
        ]
    return lines


def _sizes(files: Iterable[tuple[Path, str | bytes]]) -> list[str]:
    return [
        f"{path}: {len(content.encode()):,} bytes of source"
        if isinstance(content, str)
        else f"{path}: {len(content):,} bytes"
        for path, content in files
    ]


def controller_lines(exported: ExportedController) -> list[str]:
    """Return the size of a controller's files, and their greatest difference from it."""
    trial_run = exported.program.tried
    worst, largest = number_words(trial_run.worst, 3), number_words(trial_run.largest, 3)
    return [
        *_sizes(exported.files),
        *exported.calls,
        f"  worst difference to {exported.program.reference}: {worst}"
        f" ({len(trial_run.vectors.expected)} periods, drives up to {largest})",
        *(f"  {words}" for words in [exported.program.beside_rules] if words),
    ]
