"""Fit the gains that the study does not print to the figures that it does.

NAME is a controller whose gains were identified (acdid+ie, mrac, mrac+ie, dac, dac+ie);
all of them by default. Prints what a least-squares search from round numbers finds
beside what fuzzyarm ships, and how well either explains the published RMS errors.
"""

from __future__ import annotations

import argparse
import json
import sys
from contextlib import nullcontext
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fuzzyarm.study.identify import Identified


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm identify``."""
    parser.add_argument("names", nargs="*", metavar="NAME", help="which controllers")
    parser.add_argument("--json", action="store_true")


def run(arguments: argparse.Namespace) -> int:
    """Run ``fuzzyarm identify``."""
    from fuzzyarm.study.identify import PROBLEMS, UnknownProblemError, identify

    for name in arguments.names:
        if name not in PROBLEMS:
            raise UnknownProblemError(name)
    results = []
    for name in arguments.names or PROBLEMS:
        with _busy(name) as status:
            watch = None
            if status is not None:
                watch = lambda count, name=name, status=status: status.update(  # noqa: E731
                    f"fitting {name}: {count} evaluations"
                )
            results.append(identify(name, watch=watch))
        if not arguments.json:
            print(_as_text(results[-1]), end="\n\n")
    if arguments.json:
        print(json.dumps([asdict(result) for result in results], indent=1))
    return 0


def _busy(name: str) -> Any:
    if not sys.stderr.isatty():
        return nullcontext()
    from rich.console import Console

    return Console(stderr=True).status(f"fitting {name}")


def _as_text(result: Identified) -> str:
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
