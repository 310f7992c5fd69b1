"""What a runner of this folder shares with the others: lines in, lines out.

A runner reads one case a line from its standard input, as JSON, and prints a line about itself and one a case:

    {"tool": "NAME", "version": "1.2"}
    {"name": "CASE", "points": [{"OUTPUT": 1.5}, {"OUTPUT": null}]}
    {"name": "CASE", "cannot": "why the tool has no such setting"}
    {"name": "CASE", "error": "what it said"}

`null` is no number. A runner in any language can do without this file.
"""

from __future__ import annotations

import contextlib
import json
import math
import sys
from collections.abc import Callable, Iterator
from typing import Any

Case = dict[str, Any]
Numbers = list[dict[str, float | None]]


class CannotError(Exception):
    """The tool has no such setting."""


def demand(holds: bool, reason: str) -> None:
    """Refuse a case with a reason."""
    if not holds:
        raise CannotError(reason)


def cases() -> Iterator[Case]:
    """Yield the cases that are asked."""
    for line in sys.stdin:
        if line.strip():
            yield json.loads(line)


def number(value: Any) -> float | None:
    """Return a number, None for what is none."""
    if value is None:
        return None
    plain = float(value)
    return plain if math.isfinite(plain) else None


def serve(tool: str, version: str, answer: Callable[[Case], Numbers]) -> None:
    """Answer every case; what the tool itself prints goes to the standard error."""
    print(json.dumps({"tool": tool, "version": version}), flush=True)
    for case in cases():
        said: dict[str, Any] = {"name": case["name"]}
        try:
            with contextlib.redirect_stdout(sys.stderr):
                said["points"] = answer(case)
        except CannotError as error:
            said["cannot"] = str(error)
        except Exception as error:
            said["error"] = f"{type(error).__name__}: {error}"[:300]
        print(json.dumps(said), flush=True)


def way_of(case: Case) -> tuple[str, int | None, str]:
    """Return method, number of samples and sampling of a case."""
    way = case["settings"]["defuzzifier"]
    return way["method"], way.get("samples"), way.get("sampling", "exact")


def terms_of(case: Case) -> Iterator[dict[str, Any]]:
    """Yield all terms of a case."""
    for side in ("inputs", "outputs"):
        for variable in case[side].values():
            yield from variable["terms"].values()


def is_type_2(case: Case) -> bool:
    """Tell whether any term has a lower function, or the defuzzifier wants one."""
    method = case["settings"]["defuzzifier"]["method"]
    return any("lower" in term for term in terms_of(case)) or method.startswith(("karnik", "nie"))


def stays_within(case: Case) -> bool:
    """Tell whether every input is in its range."""
    return all(
        low <= point["inputs"][name] <= high
        for point in case["points"]
        for name, (low, high) in ((n, v["range"]) for n, v in case["inputs"].items())
    )


def demand_type_1(case: Case) -> None:
    """Refuse interval type 2."""
    demand(not is_type_2(case), "no interval type 2")


def parts_of(condition: dict[str, Any]) -> tuple[str, list[tuple[str, str, list[str]]]]:
    """Return the one word that joins propositions, and these with their hedges, outermost first."""
    ((word, inner),) = condition.items()
    listed = inner if word in {"and", "or"} else [condition]
    found = []
    for part in listed:
        hedges: list[str] = []
        ((key, value),) = part.items()
        while key in {"not", "very"}:
            hedges.append(key)
            ((key, value),) = value.items()
        demand(key == "is", "no parentheses in a condition")
        found.append((value[0], value[1], hedges))
    return (word if word in {"and", "or"} else "and"), found
