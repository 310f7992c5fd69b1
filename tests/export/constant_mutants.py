"""Mutants of exported text: a constant is off by a tenth, and the text's own test must notice."""

from __future__ import annotations

import re
from collections.abc import Iterator

_NUMBER = re.compile(r"(?<![\w.\"])\d+\.\d+(?:e[+-]?\d+)?(?![\w.])")


def mutants(text: str) -> Iterator[str]:
    """Yield the text of a module for MicroPython with one constant of its functions changed."""
    end = text.index("def self_test")
    begin = text.index("from array import array")
    for match in _NUMBER.finditer(text, begin, end):
        line = text[text.rindex("\n", 0, match.start()) + 1 : text.index("\n", match.start())]
        if line.startswith("_test") or line.lstrip().startswith("#") or float(match[0]) == 0.0:
            continue
        yield f"{text[: match.start()]}{float(match[0]) * 1.1!r}{text[match.end() :]}"


def noticed_by_test(text: str) -> bool:
    """Whether the self-test of a module fails."""
    module: dict[str, object] = {}
    exec(compile(text, "mutant", "exec"), module)
    try:
        return module["self_test"]() != 0
    except (ArithmeticError, ValueError, IndexError):
        return True
