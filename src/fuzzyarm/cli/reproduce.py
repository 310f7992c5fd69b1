"""Run the study's published experiments again and compare.

ROW is a table (7.1.1), a controller (cdid+ie) or both (7.1.1/cdid+ie); every row by
default. Where the study's text and figures disagree a row runs in both variants,
as-described and as-printed; the bounds are for as-printed.

The eight figures of a row are the RMS error and the final error (on pick-and-place the
maximum) of links 1 and 2 on the first trajectory, then on the second, in degrees.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fuzzyarm.study import PublishedRow, Reproduced


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm reproduce``."""
    parser.add_argument("rows", nargs="*", metavar="ROW", help="which rows; all by default")
    parser.add_argument("--list", action="store_true", help="list the rows")
    parser.add_argument("--plot", metavar="DIR", help="draw the error profiles into a folder")
    parser.add_argument("--markdown", action="store_true", help="print tables for a page")
    parser.add_argument("--json", action="store_true")


def run(arguments: argparse.Namespace) -> int:
    """Run ``fuzzyarm reproduce``."""
    from fuzzyarm.study import find_rows, runnable

    rows = find_rows(arguments.rows)
    if arguments.list:
        for row in rows:
            print(f"{row.identifier:<24}{row.row:<20}{row.condition}")
        return 0
    ready = [row for row in rows if runnable(row)]
    missing = [row for row in rows if not runnable(row)]
    # Nothing is printed while the bar is on the screen: it would swallow it.
    results = list(_watched(ready))
    if arguments.plot:
        for result in results:
            _plot(result, Path(arguments.plot))
    if arguments.json:
        print(json.dumps([_as_json(result) for result in results], indent=1))
    elif arguments.markdown:
        print("\n".join(_markdown(results)))
    else:
        for result in results:
            print(_as_text(result), end="\n\n")
        _summary(results)
    if missing:
        names = ", ".join(dict.fromkeys(row.controller for row in missing))
        print(
            f"fuzzyarm: left out, because there is no controller for them: {names}", file=sys.stderr
        )
    return 0


def _watched(rows: list[PublishedRow]) -> Iterator[Reproduced]:
    """Run the rows, with a progress bar where a terminal shows it."""
    from fuzzyarm.study import reproduce_row, variants

    jobs = [(row, variant) for row in rows for variant in variants(row)]
    shown: Iterable[Any] = jobs
    if sys.stderr.isatty():
        from rich.console import Console
        from rich.progress import track

        shown = track(jobs, "rows", console=Console(stderr=True), transient=True)
    for row, variant in shown:
        yield reproduce_row(row, variant)


def _as_json(result: Reproduced) -> dict[str, Any]:
    row = result.published
    return {
        "row": row.row,
        "table": row.table,
        "controller": row.controller,
        "condition": row.condition,
        "variant": result.variant,
        "trajectories": list(row.trajectories),
        "published": list(row.figures),
        "reproduced": list(result.figures),
        "difference": _differences(result),
        "within": result.judgement.within,
        "verdict": result.judgement.sentence,
        "note": result.judgement.note,
        "diverged": [run.diverged for run in result.runs],
    }


def _differences(result: Reproduced) -> list[float | None]:
    """Return relative differences; null where zero was printed."""
    return [
        got / wanted - 1.0 if wanted else None
        for got, wanted in zip(result.figures, result.published.figures, strict=True)
    ]


def _as_text(result: Reproduced) -> str:
    row = result.published
    apart = ["" if each is None else f"{100 * each:+.2f} %" for each in _differences(result)]
    lines = [
        f"{row.table}  {row.row}  ({row.condition})  {result.variant}",
        _line("", [f"{name}" for name in _headings(row)]),
        _line("published", [f"{value:.4f}" for value in row.figures]),
        _line("reproduced", [f"{value:.4f}" for value in result.figures]),
        _line("difference", apart),
    ]
    judgement = result.judgement
    if result.variant == "as-described":
        lines.append(f"  as the text has it; {judgement.sentence}")
    else:
        lines.append(f"  {judgement.sentence}")
    if judgement.note:
        lines.append(f"  note: {judgement.note}")
    return "\n".join(lines)


def _markdown(results: list[Reproduced]) -> Iterator[str]:
    """Yield a table: the published figures of each row, and what each variant gives."""
    yield "| row | | first trajectory: RMS, last 1; RMS, last 2 | second | RMS off | |"
    yield "|---|---|---|---|---|---|"
    shown = ""
    for result in results:
        row, judgement = result.published, result.judgement
        if row.identifier != shown:
            label = f"{row.table} {row.row}, {row.condition}"
            yield f"| {label} | published | {_eight(row.figures)} | | |"
            shown = row.identifier
        verdict = "agrees" if judgement.within else "differs"
        off = f"{100 * judgement.worst_rms:.2f} %"
        yield f"| | {result.variant} | {_eight(result.figures)} | {off} | {verdict} |"


def _eight(figures: Sequence[float]) -> str:
    cells = [f"{value:.4f}" for value in figures]
    first, second = (f"{cells[i]}, {cells[i + 1]}; {cells[i + 2]}, {cells[i + 3]}" for i in (0, 4))
    return f"{first} | {second}"


def _line(name: str, cells: list[str]) -> str:
    left = "".join(f"{cell:>10}" for cell in cells[:4])
    right = "".join(f"{cell:>10}" for cell in cells[4:])
    return f"  {name:<11}{left}   {right}"


def _headings(row: PublishedRow) -> list[str]:
    words = []
    for trajectory in row.trajectories:
        last = "max" if trajectory == "pick-and-place" else "final"
        words += ["rms 1", f"{last} 1", "rms 2", f"{last} 2"]
    return words


def _summary(results: list[Reproduced]) -> None:
    printed = [result for result in results if result.variant == "as-printed"]
    good = sum(result.judgement.within for result in printed)
    print(f"{good} of {len(printed)} rows agree within their bounds (as-printed)")
    for result in printed:
        if not result.judgement.within:
            print(f"  {result.published.identifier}: {result.judgement.sentence}")


def _plot(result: Reproduced, folder: Path) -> None:
    from fuzzyarm.study.profiles import draw_profiles, save_figure

    folder.mkdir(parents=True, exist_ok=True)
    row = result.published
    variant = "" if result.variant == "as-printed" else f"-{result.variant}"
    name = f"{row.table}-{row.controller}{variant}.png"
    figure = draw_profiles(result.runs, f"{row.row} ({row.condition}), {result.variant}")
    save_figure(figure, folder / name)
