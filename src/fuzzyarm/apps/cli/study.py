"""The study's figures: ``fuzzyarm reproduce`` and ``fuzzyarm identify``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fuzzyarm.apps.cli.command import (
    FORCE,
    JSON,
    argument,
    busy,
    command,
    demand_figure,
    flag,
    print_json,
    progress_bar,
)

if TYPE_CHECKING:
    from fuzzyarm.apps.study import Ensemble, PublishedRow, Reproduced, RowJudgement
    from fuzzyarm.apps.study.identify import Identified


_REPRODUCE = """Run the study's published experiments again and compare.

ROW is a table (7.1.1), a controller (cdid+ie) or both (7.1.1/cdid+ie); every row by
default. Where text and figures of the study disagree a row runs in both variants,
as-described and as-printed; the bounds are for as-printed.

The eight figures of a row are the RMS error and the final error (on pick-and-place the
maximum) of links 1 and 2 on the first trajectory, then on the second, in degrees.

Rows with switching between the cells of a table are chaotic in single precision. They run
another --runs times, each with the last bit of every state disturbed at every step.

--plot DIR draws fewer than five rows one by one, more by chapter and all side by side
(overview.png).
"""

_FEW = 5
"""From this number of rows on, figures are by chapter."""


def _reproduce(arguments: argparse.Namespace) -> int:
    from fuzzyarm.apps.study import find_rows

    rows = find_rows(arguments.rows)
    if arguments.list and arguments.json:
        print_json(rows, 1)
        return 0
    if arguments.list:
        for row in rows:
            print(f"{row.identifier:<24}{row.row:<20}{row.condition}")
        return 0
    if not 0 <= arguments.runs <= 100_000:
        print("fuzzyarm reproduce: --runs takes 0 to 100000", file=sys.stderr)
        return 2
    demand_figure(arguments.overview)
    # Nothing is printed below the bar, which would overwrite it.
    results = list(_watched(rows, arguments.runs))
    if arguments.plot:
        _plot(results, Path(arguments.plot))
    if arguments.overview:
        _overview(results, Path(arguments.overview))
    if arguments.json:
        print_json(results, 1)
    elif arguments.markdown:
        print("\n".join(_markdown(results)))
    else:
        _print(results)
    return 0


def _print(results: list[Reproduced]) -> None:
    for result in results:
        print(_reproduced_as_text(result), end="\n\n")
    _summary(results)


def _watched(rows: list[PublishedRow], runs: int) -> Iterator[Reproduced]:
    """Run the rows, with a progress bar on a terminal."""
    from fuzzyarm.apps.study import chaotic, reproduce_row, variants

    jobs = [(row, variant) for row in rows for variant in variants(row)]
    # Two trajectories for each, and `runs` more for each one of a chaotic row.
    total = sum(2 + 2 * runs * chaotic(row) for row, _ in jobs)
    with progress_bar("runs", total) as watch:
        for row, variant in jobs:
            yield reproduce_row(row, variant, runs=runs, watch=watch)
            watch(2)


def _reproduced_as_text(result: Reproduced) -> str:
    row = result.published
    apart = [
        "" if difference is None else f"{100 * difference:+.2f} %"
        for difference in result.differences
    ]
    lines = [
        f"{row.table}  {row.row}  ({row.condition})  {result.variant}",
        _line("", [f"{name}" for name in _headings(row)]),
        _line("published", [f"{value:.4f}" for value in row.figures]),
        _line("reproduced", [f"{value:.4f}" for value in result.figures]),
        _line("difference", apart),
    ]
    if result.ensemble is not None:
        lines += _ensemble_lines(result.ensemble, row)
    judgement = result.judgement
    if result.variant == "as-described":
        lines.append(f"  as the text has it; {judgement.sentence}")
    else:
        lines.append(f"  {judgement.sentence}")
    if judgement.note:
        lines.append(f"  note: {judgement.note}")
    return "\n".join(lines)


def _ensemble_lines(ensemble: Ensemble, row: PublishedRow) -> list[str]:
    rows = {
        "median": ensemble.median,
        "5 %": ensemble.band_low,
        "95 %": ensemble.band_high,
        "lowest": ensemble.lowest,
        "highest": ensemble.highest,
    }
    inside = ["inside" if is_inside else "OUTSIDE" for is_inside in ensemble.inside(row.figures)]
    return [
        f"  {ensemble.runs} runs, each disturbed in the last bit at every step:",
        *(_line(name, [f"{value:.4f}" for value in figures]) for name, figures in rows.items()),
        _line("published", inside),
    ]


def _markdown(results: list[Reproduced]) -> Iterator[str]:
    """Yield a table of the published figures of each row and those of each variant."""
    yield "| row | | first trajectory: RMS, last 1; RMS, last 2 | second | RMS off | |"
    yield "|---|---|---|---|---|---|"
    last_row = ""
    for result in results:
        row, judgement = result.published, result.judgement
        if row.identifier != last_row:
            label = f"{row.table} {row.row}, {row.condition}"
            yield f"| {label} | published | {_eight(row.figures)} | | |"
            last_row = row.identifier
        verdict = "agrees" if judgement.within else "differs"
        off = f"{100 * judgement.worst_rms:.2f} %"
        yield f"| | {result.variant} | {_eight(result.figures)} | {off} | {verdict} |"
        ensemble = result.ensemble
        if ensemble is not None and result.variant == "as-printed":
            for name, figures in (("lowest", ensemble.lowest), ("highest", ensemble.highest)):
                yield f"| | {name} of {ensemble.runs} | {_eight(figures)} | | |"


def _eight(figures: Sequence[float]) -> str:
    cells = [f"{value:.4f}" for value in figures]
    first, second = (f"{cells[i]}, {cells[i + 1]}; {cells[i + 2]}, {cells[i + 3]}" for i in (0, 4))
    return f"{first} | {second}"


def _line(name: str, cells: list[str]) -> str:
    first_half = "".join(f"{cell:>10}" for cell in cells[:4])
    right = "".join(f"{cell:>10}" for cell in cells[4:])
    return f"  {name:<11}{first_half}   {right}"


def _headings(row: PublishedRow) -> list[str]:
    words = []
    for trajectory in row.trajectories:
        last = "max" if trajectory == "pick-and-place" else "final"
        words += ["rms 1", f"{last} 1", "rms 2", f"{last} 2"]
    return words


def _summary(results: list[Reproduced]) -> None:
    as_printed = [result for result in results if result.variant == "as-printed"]
    good = sum(result.judgement.within for result in as_printed)
    print(f"{good} of {len(as_printed)} rows agree within their bounds (as-printed)")
    for result in as_printed:
        if not result.judgement.within:
            print(f"  {result.published.identifier}: {result.judgement.sentence}")
    print(_within_levels([result.judgement for result in as_printed]))
    both = {r.published.identifier for r in results if r.variant == "as-described"}
    if both:
        print("where the variants differ, the row is reproduced by")
    for result in as_printed:
        name = result.published.identifier
        if name in both:
            described = next(
                r for r in results if r.published is result.published and r is not result
            )
            print(f"  {name:<20} {_reproduced_by(described, result)}")


def _within_levels(judgements: Sequence[RowJudgement]) -> str:
    from fuzzyarm.apps.study.reproduce import count_within

    counts_within = count_within(judgements)
    counts = ", ".join(
        f"{count} within {100 * level:g} %" for level, count in counts_within.items()
    )
    return f"whatever the bounds, all four RMS errors of a row: {counts}"


def _reproduced_by(described: Reproduced, printed: Reproduced) -> str:
    names = [r.variant for r in (described, printed) if r.judgement.within]
    return " and ".join(names) if names else "neither"


def _plot(results: Sequence[Reproduced], folder: Path) -> None:
    from fuzzyarm.apps.study.figures import (
        FAMILIES,
        chapter_of,
        draw_chapter,
        draw_profiles,
        save_figure,
    )

    folder.mkdir(parents=True, exist_ok=True)
    if len({result.published.identifier for result in results}) < _FEW:
        for result in results:
            row = result.published
            variant = "" if result.variant == "as-printed" else f"-{result.variant}"
            title = f"{row.row} ({row.condition}), {result.variant}"
            name = f"{row.table}-{row.controller}{variant}.png"
            save_figure(draw_profiles(result.runs, title), folder / name)
        return
    for chapter, (family, _) in FAMILIES.items():
        rows = [r for r in results if chapter_of(r.published) == chapter]
        if rows:
            title = f"Chapter {chapter}: {family} control"
            save_figure(draw_chapter(rows, title), folder / f"chapter-{chapter}.png")
    _overview(results, folder / "overview.png")


def _overview(results: Sequence[Reproduced], path: Path) -> None:
    """Draw the rows of the summary, or all if there are none."""
    from fuzzyarm.apps.study.figures import SUMMARY, draw_overview, save_figure

    summary = [result for result in results if result.published.table[0] == SUMMARY]
    save_figure(draw_overview(summary or results), path)


_IDENTIFY = """Fit the gains that the study does not print to the figures that it does.

NAME is a controller with identified gains (acdid+ie, mrac, mrac+ie, dac, dac+ie);
all of them by default. Prints the result of a least-squares search from round numbers beside
the shipped gains, and how well either explains the published RMS errors.
"""


def _identify(arguments: argparse.Namespace) -> int:
    from fuzzyarm.apps.study.identify import PROBLEMS, UnknownProblemError, identify

    for name in arguments.names:
        if name not in PROBLEMS:
            raise UnknownProblemError(name)
    results = []
    for name in arguments.names or PROBLEMS:
        with busy(f"fitting {name}") as update:
            results.append(identify(name, watch=_count_shown(name, update)))
        if not arguments.json:
            print(_identified_as_text(results[-1]), end="\n\n")
    if arguments.json:
        print_json(results, 1)
    return 0


def _count_shown(name: str, update: Callable[[str], None] | None) -> Callable[[int], None] | None:
    if update is None:
        return None
    return lambda count: update(f"fitting {name}: {count} evaluations")


def _identified_as_text(result: Identified) -> str:
    lines = [
        f"{result.name}  ({result.evaluations} evaluations)",
        f"  {'gain':<8}{'fitted':>12}{'± relative':>12}{'shipped':>12}",
    ]
    for label, fitted, spread, shipped in zip(
        result.labels, result.fitted, result.spread, result.shipped, strict=True
    ):
        lines.append(f"  {label:<8}{fitted:>12.5g}{spread:>12.1%}{shipped:>12.5g}")
    for name, apart in (("fitted", result.fitted_rms), ("shipped", result.shipped_rms)):
        worst = max(map(abs, apart))
        mean = sum(map(abs, apart)) / len(apart)
        lines.append(
            f"  RMS errors with {name} gains: {mean:.2%} off in the mean, {worst:.2%} at worst"
        )
    return "\n".join(lines)


COMMANDS = (
    command(
        "reproduce",
        _REPRODUCE,
        _reproduce,
        argument("rows ROW", "rows; all by default", nargs="*"),
        flag("--list", "list the rows"),
        argument(
            "--runs N",
            "disturbed runs of each chaotic row; 200 by default, 0 for none",
            type=int,
            default=200,
        ),
        argument("--plot DIR", "draw the error profiles into a folder"),
        argument("--overview FIG", "draw all rows side by side"),
        FORCE,
        flag("--markdown", "print tables for a page"),
        JSON,
    ),
    command(
        "identify",
        _IDENTIFY,
        _identify,
        argument("names NAME", "which controllers", nargs="*"),
        JSON,
    ),
)
