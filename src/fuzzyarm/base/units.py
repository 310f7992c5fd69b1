"""Units as text: the unit of a product, and units of one dimension that do not cancel."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import combinations

Unit = dict[str, int]
"""Symbols with their powers; empty for a plain number."""

KINDS = (
    frozenset({"rad", "mrad", "deg", "°", "rev", "turn"}),
    frozenset({"m", "mm", "cm", "km"}),
    frozenset({"s", "ms", "us", "min", "h"}),
    frozenset({"V", "mV", "kV"}),
    frozenset({"A", "mA"}),
    frozenset({"N", "kN", "mN"}),
    frozenset({"W", "kW", "mW", "MW"}),
    frozenset({"K", "mK", "°F"}),
    frozenset({"°C", "°F"}),
    frozenset({"Pa", "hPa", "kPa", "MPa", "bar", "mbar", "psi"}),
    frozenset({"Hz", "kHz", "rpm"}),
    frozenset({"kg", "g", "mg", "t"}),
    frozenset({"J", "kJ", "MJ", "Wh", "kWh"}),
    frozenset({"l", "ml", "L", "mL"}),
)
"""Symbols that measure the same thing on different scales."""

_NAME = r"(?:°?[^\W\d_]+|[°%1])"
_WORDS = re.compile(rf"\s*{_NAME}(?:\s*[\s*·/]\s*{_NAME})*\s*")
_SYMBOL = re.compile(rf"(/?)\s*({_NAME})")


_FORCE = {"kg": 1, "m": 1, "s": -2}
_ENERGY = {"kg": 1, "m": 2, "s": -2}
_POWER = {"kg": 1, "m": 2, "s": -3}
_BASES: tuple[tuple[str, Unit], ...] = (
    ("rad mrad deg ° rev turn %", {}),
    ("m mm cm km", {"m": 1}),
    ("m² cm² mm²", {"m": 2}),
    ("m³ l ml L mL", {"m": 3}),
    ("s ms us min h", {"s": 1}),
    ("s² ms²", {"s": 2}),
    ("Hz kHz rpm", {"s": -1}),
    ("kg g mg t", {"kg": 1}),
    ("N kN mN", _FORCE),
    ("J kJ MJ Wh kWh", _ENERGY),
    ("W kW mW MW", _POWER),
    ("Pa hPa kPa MPa bar mbar psi", {"kg": 1, "m": -1, "s": -2}),
    ("A mA", {"A": 1}),
    ("V mV kV", {**_POWER, "A": -1}),
    ("K mK °C °F", {"K": 1}),
)
_DIMENSIONS = {symbol: base for symbols, base in _BASES for symbol in symbols.split()}
"""Dimensions of symbols, in powers of m, s, kg, A and K; an angle is dimensionless."""


_SPELLED = {
    "radian": "rad", "degree": "deg", "deg": "deg", "rad": "rad", "meter": "m", "metre": "m",
    "sec": "s", "second": "s", "minute": "min", "hour": "h", "hr": "h", "volt": "V", "amp": "A",
    "ampere": "A", "newton": "N", "watt": "W", "kelvin": "K", "celsius": "°C", "degc": "°C",
    "percent": "%", "hertz": "Hz",
}  # fmt: skip
"""Symbols by their spelled-out names, in small letters and in the singular."""


def dimension(unit: Unit) -> Unit | None:
    """Return the dimension of a unit, in powers of the base units; None for an unknown symbol."""
    whole: Unit = {}
    for symbol, power in unit.items():
        if symbol not in _DIMENSIONS:
            return None
        for base, exponent in _DIMENSIONS[symbol].items():
            whole[base] = whole.get(base, 0) + power * exponent
    return {base: exponent for base, exponent in whole.items() if exponent}


NORMALISED = ("normalised", "normalized")
"""Last words of a description that mark a dimensionless variable."""


def described_unit(description: str) -> Unit | None:
    """Return the unit in a description: the whole of ``°C``, the {} of ``error, normalised``."""
    if description.rpartition(",")[2].strip().lower() in NORMALISED:
        return {}
    unit = read_unit(description)
    return unit if unit is not None and dimension(unit) is not None else None


def read_unit(text: str) -> Unit | None:
    """Return the symbols and powers in a unit like ``N m/rad``, ``N/(m s)``; None if uncertain."""
    text = re.sub(r"/\s*\(([^()/]*)\)\s*$", r"/\1", text)
    if _WORDS.fullmatch(text) is None or "per" in text.split() or text.count("/") > 1:
        return None
    unit: Unit = {}
    below = False
    for slash, word in _SYMBOL.findall(text):
        below = below or bool(slash)
        for symbol in _symbols(word):
            unit[symbol] = unit.get(symbol, 0) + (-1 if below else 1)
    return {symbol: power for symbol, power in unit.items() if power}


def _symbols(word: str) -> Sequence[str]:
    """Return the symbols in a word: N and m of ``Nm``; none of ``1``."""
    if word in _DIMENSIONS or word == "1":
        return [word] if word != "1" else []
    # Without a capital it is rather a plural (rads) or another unit (lm).
    is_product = word != word.lower() and {word[:-1], word[-1]} <= set(_DIMENSIONS)
    return [word[:-1], word[-1]] if is_product else [word]


def near_symbol(unit: Unit) -> tuple[str, str] | None:
    """Return an unknown unit symbol and its likely correction."""
    for symbol in unit:
        word = symbol.lower()
        # A capital alone is another unit (T, H).
        if symbol not in _DIMENSIONS and (len(symbol) > 1 or symbol == word):
            spelled = _SPELLED.get(word.removesuffix("s"), word)
            known = next((known for known in _DIMENSIONS if spelled in (known, known.lower())), "")
            if known:
                return symbol, known
    return None


def product(a: Unit | None, b: Unit | None, power: int = 1) -> Unit | None:
    """Return the unit of a product, or with the power -1 of a quotient."""
    if a is None or b is None:
        return None
    unit = dict(a)
    for symbol, exponent in b.items():
        unit[symbol] = unit.get(symbol, 0) + power * exponent
    return {symbol: exponent for symbol, exponent in unit.items() if exponent}


def of_difference(unit: Unit | None) -> Unit | None:
    """Return the unit of a difference of two values: K for temperatures in °C."""
    return {"K": 1} if unit == {"°C": 1} else unit


def unit_text(unit: Unit) -> str:
    """Return the text of a unit; ``1`` for none."""
    above: list[str] = []
    below: list[str] = []
    for symbol, power in unit.items():
        (above if power > 0 else below).extend([symbol] * abs(power))
    text, divisor = " ".join(above) or "1", " ".join(below)
    if len(below) > 1:
        return f"{text}/({divisor})"
    return f"{text}/{divisor}" if below else text


def unlike(unit: Unit) -> tuple[str, str] | None:
    """Return two symbols of one dimension, one dividing the other, as in rad/deg."""
    for first, second in combinations(unit, 2):
        if unit[first] * unit[second] < 0 and any({first, second} <= kind for kind in KINDS):
            return first, second
    return None


def differs(ratio: Unit | None) -> bool:
    """Whether a known unit ratio is not 1: m and V, or rad and deg."""
    return bool(ratio and (unlike(ratio) or dimension(ratio)))
