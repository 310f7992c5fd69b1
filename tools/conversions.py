"""Report how far files of other programs and their conversions are apart: `diff` beside a grid.

Every file is read, written in another format, read again and compared by numbers, as `fuzzyarm
diff` does; then at every point of a grid over the ranges of its inputs. Of a difference above
rounding the search has to find at least as much as the grid has.

    python tools/conversions.py DIR [--suffix .fis] [--to .fll] [--points 1000000] [--json]

The exit status is 1 if a grid has a greater difference than the search.
"""

from __future__ import annotations

import argparse
import json
import sys
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.exchange.formats import parse, read, write
from fuzzyarm.inference.apart import apart
from fuzzyarm.inference.infer import infer, with_nan_for_no_rule
from fuzzyarm.language.model.rulebase import RuleBase

ROUNDING = 1e-9
"""Share of the range of an output below which a difference is one of rounding."""

SLACK = 1e-6
"""Share of the difference on the grid by which the search may stay below it."""

AT_ONCE = 50_000
"""Points of a grid in one call."""


@dataclass(frozen=True)
class Pair:
    """An output of a file and of its conversion.

    Attributes
    ----------
    file, output : str
        Names.
    inputs : int
        Number of inputs.
    searched, gridded : float
        Greatest difference found by search and on the grid, as shares of the output's range.
    points : int
        Of the grid.
    """

    file: str
    output: str
    inputs: int
    searched: float
    gridded: float
    points: int

    @property
    def found(self) -> bool:
        """Whether the search has found at least as much as the grid."""
        return self.searched >= self.gridded * (1.0 - SLACK) or self.gridded < ROUNDING


def pairs_of(path: Path, suffix: str, points: int) -> Iterator[Pair]:
    """Yield the outputs of a file beside those of its conversion; ValueError without one."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        before = read(path).rulebase
        if before is None:
            raise ValueError("is not read")
        text = write(before, suffix, lossy=True).text
        after = parse(text, suffix).rulebase if text else None
        if after is None:
            raise ValueError(f"is not written as {suffix}")
        worst, count = on_grid(before, after, points)
        for number, found in enumerate(apart(before, after)):
            output = before.outputs[number]
            size = output.high - output.low
            size = size if 0.0 < size < np.inf else 1.0
            yield Pair(
                path.name, found.output, len(before.inputs), found.worst / size,
                worst[number] / size, count,
            )  # fmt: skip


def on_grid(before: RuleBase, after: RuleBase, points: int) -> tuple[list[float], int]:
    """Return the greatest difference of each output on an even grid, and its number of points."""
    each = max(2, round(points ** (1.0 / len(before.inputs))))
    axes = [np.linspace(variable.low, variable.high, each) for variable in before.inputs]
    count, worst = each ** len(axes), [0.0] * len(before.outputs)
    for first in range(0, count, AT_ONCE):
        which = np.unravel_index(np.arange(first, min(first + AT_ONCE, count)), [each] * len(axes))
        columns = [axis[index] for axis, index in zip(axes, which, strict=True)]
        values = []
        for model in (before, after):
            names = [variable.name for variable in model.inputs]
            found = infer(with_nan_for_no_rule(model), dict(zip(names, columns, strict=True)))
            values.append([np.asarray(found[output.name]) for output in model.outputs])
        for number, (one, two) in enumerate(zip(*values, strict=True)):
            with np.errstate(invalid="ignore"):
                worst[number] = max(worst[number], float(np.nan_to_num(np.abs(two - one)).max()))
    return worst, count


def main(words: Sequence[str] | None = None) -> int:
    """Print the report of a folder."""
    parser = argparse.ArgumentParser(description="how far files and their conversions are apart")
    parser.add_argument("folder", metavar="DIR", type=Path, help="where the files are")
    parser.add_argument("--suffix", default=".fis", help="of the files")
    parser.add_argument("--to", default=".fll", help="the format to convert to")
    parser.add_argument("--points", type=int, default=1_000_000, help="of a grid, about")
    parser.add_argument("--json", action="store_true", help="print the report as JSON")
    asked = parser.parse_args(words)
    pairs: list[Pair] = []
    for path in sorted(asked.folder.rglob(f"*{asked.suffix}")):
        try:
            pairs += pairs_of(path, asked.to, asked.points)
        except (FuzzyarmError, ValueError) as error:
            print(f"{path.name}: {error}", file=sys.stderr)
    if asked.json:
        print(json.dumps([asdict(pair) for pair in pairs], indent=1))
    else:
        for pair in pairs:
            line = f"{pair.searched:10.3g} {pair.gridded:10.3g}  {pair.file}: {pair.output}"
            print(line if pair.found else f"{line}  MISSED")
        files, apart_ = {pair.file for pair in pairs}, [p for p in pairs if p.searched > ROUNDING]
        print(
            f"{len(files)} pairs with {len(pairs)} outputs, {len(apart_)} of them apart; "
            f"{sum(not pair.found for pair in pairs)} grids have more than the search"
        )
    return 0 if all(pair.found for pair in pairs) else 1


if __name__ == "__main__":
    sys.exit(main())
