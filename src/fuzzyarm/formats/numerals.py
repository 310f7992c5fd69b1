"""Numbers as the formats write them, in and out without loss."""

from __future__ import annotations

import math
import re

from fuzzyarm.formats.imported import Findings, Word

_PLAIN = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?\Z", re.ASCII)
_SPECIAL = {
    "nan": math.nan, "+nan": math.nan, "-nan": math.nan, "na": math.nan,
    "inf": math.inf, "+inf": math.inf, "-inf": -math.inf,
    "infinity": math.inf, "-infinity": -math.inf,
}  # fmt: skip
_FACTOR = re.compile(r"(pi|\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)", re.ASCII)


def number(text: str) -> float | None:
    """Return the value of `text`, or None where it is no number.

    Besides decimal numbers: ``nan``, ``inf`` and products and quotients with ``pi`` as in
    ``-pi/4`` or ``2*pi``, which people write into ``.fis`` files.
    """
    if _PLAIN.match(text):
        return float(text.replace("d", "e").replace("D", "e"))
    if len(text) > 60:
        return None
    lowered = text.lower()
    if lowered in _SPECIAL:
        return _SPECIAL[lowered]
    return _product(lowered) if "pi" in lowered else None


def _product(text: str) -> float | None:
    sign = -1.0 if text.startswith("-") else 1.0
    rest = text.lstrip("+-")
    parts = re.split(r"([*/])", rest)
    value = 1.0
    operator = "*"
    for index, part in enumerate(parts):
        if index % 2:
            operator = part
            continue
        if not _FACTOR.fullmatch(part):
            return None
        factor = math.pi if part == "pi" else float(part)
        if operator == "/" and factor == 0.0:
            return None
        value = value * factor if operator == "*" else value / factor
    return sign * value


def numbers(words: list[Word], findings: Findings) -> list[float] | None:
    """Return the values of `words`; None, with findings, where one is no number."""
    values: list[float] = []
    failed = False
    for word in words:
        value = number(word.text)
        if value is None:
            findings.error("not-a-number", f"'{word.text[:60]}' is not a number", word)
            failed = True
        else:
            values.append(value)
    return None if failed else values


def written(value: float) -> str:
    """Return the shortest text that reads back as exactly `value`."""
    if math.isnan(value):
        return "nan"
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    text = repr(float(value))
    return text.removesuffix(".0")


def all_written(values: tuple[float, ...]) -> str:
    """Return the numbers with spaces between them."""
    return " ".join(map(written, values))


_THREE = re.compile(r"(?<![\w.])-?\d+\.\d{3}(?![\w.])", re.ASCII)
_OTHER = re.compile(r"(?<![\w.])-?\d+\.(\d{1,2}|\d{4,})(?![\w.])", re.ASCII)


def rounded(text: str) -> re.Match[str] | None:
    """Return the first number that looks cut to three decimals, where all of them are.

    fuzzylite prints three decimals unless told otherwise; a file with nothing but such
    numbers may give other outputs than the program object it came from.
    """
    if _OTHER.search(text):
        return None
    return next((m for m in _THREE.finditer(text) if not m.group().endswith("0")), None)
