"""Write the files of cases: `topics` asks, `exact` answers, `second` confirms it.

    python -m conformance.make_cases

A number on which both ways do not agree to 1e-13 of its range is not written; the script ends
with the case.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from typing import Any

from conformance import exact, second
from conformance.suite import CASES
from conformance.topics import TOPICS

AGREE = Fraction(1, 10**13)  # of the range of the output
LONGEST = 120  # digits of a fraction that is worth writing down
CURVED = {"gaussian", "sigmoid", "s", "z", "pi", "bell"}


def converted(part: Any, number: Callable[[str], Any]) -> Any:
    """Return data with every number as a fraction or a decimal: its decimal digits, all of them."""
    return json.loads(json.dumps(part), parse_float=number, parse_int=number)


def expected(case: dict[str, Any], point: dict[str, Any], output: str) -> dict[str, Any]:
    """Return what is to come out, and how it was found.

    Raises
    ------
    ArithmeticError
        Where the two ways do not agree.
    """
    value = exact.number(converted(case, Fraction), output, converted(point["inputs"], Fraction))
    again = second.number(converted(case, Decimal), output, converted(point["inputs"], Decimal))
    if value is None or again is None:
        if value is not None or again is not None:
            raise ArithmeticError(f"{case['name']} {point['inputs']}: {value} and {again}")
        return {"none": True}
    low, high = case["outputs"][output]["range"]
    off = abs(value - Fraction(again))
    if off > AGREE * Fraction(high - low):
        raise ArithmeticError(f"{case['name']} {point['inputs']}: {float(value)!r} and {again:.20}")
    text = f"{value.numerator}/{value.denominator}"
    rational = len(str(value.denominator)) < exact.DIGITS - 5
    written = {"value": float(value)}
    return {"rational": text, **written} if rational and len(text) <= LONGEST else written


def compact(data: Any) -> str:
    """Return JSON with a line to each rule, point and variable."""
    text = json.dumps(data, ensure_ascii=False, indent=1)
    lines, depth = [], 0
    for line in text.splitlines():
        indent = len(line) - len(line.lstrip())
        if indent > 4 or (indent == 4 and line.strip() in {"}", "},", "]", "],"} and depth):
            lines[-1] += (" " if lines[-1][-1] in ",:" else "") + line.strip()
            depth = 1
        else:
            lines.append(line)
            depth = 1 if indent == 4 else 0
    return "\n".join(lines) + "\n"


def main() -> int:
    """Write all files, or say which case fails."""
    chosen = sys.argv[1:] or list(TOPICS)
    count = 0
    for topic in chosen:
        cases = []
        for case in TOPICS[topic]():
            for point in case["points"]:
                try:
                    point["expected"] = {
                        name: expected(case, point, name) for name in case["outputs"]
                    }
                except ArithmeticError as error:
                    print(f"not written: {error}", file=sys.stderr)
                    return 1
            cases.append(case)
        path = CASES / f"{topic}.json"
        doc = TOPICS[topic].__doc__ or ""
        path.write_text(
            compact({"topic": topic, "says": doc.strip(), "cases": cases}), encoding="utf-8"
        )
        count += len(cases)
        print(f"{path.name}: {len(cases)} cases")
    print(f"{count} cases, each number found twice")
    return 0


if __name__ == "__main__":
    sys.exit(main())
