"""Units as texts: what is left of a product, and units of one kind that do not cancel."""

from __future__ import annotations

import re
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


def read_unit(text: str) -> Unit | None:
    """Return what a unit like ``N m/rad`` consists of; None where that is not certain."""
    if _WORDS.fullmatch(text) is None or "per" in text.split() or text.count("/") > 1:
        return None
    unit: Unit = {}
    below = False
    for slash, symbol in _SYMBOL.findall(text):
        below = below or bool(slash)
        if symbol != "1":
            unit[symbol] = unit.get(symbol, 0) + (-1 if below else 1)
    return {symbol: power for symbol, power in unit.items() if power}


def product(a: Unit | None, b: Unit | None, power: int = 1) -> Unit | None:
    """Return the unit of a product, or with the power -1 of a quotient."""
    if a is None or b is None:
        return None
    unit = dict(a)
    for symbol, exponent in b.items():
        unit[symbol] = unit.get(symbol, 0) + power * exponent
    return {symbol: exponent for symbol, exponent in unit.items() if exponent}


def of_difference(unit: Unit | None) -> Unit | None:
    """Return the unit of a difference of two values: of temperatures in °C it is K."""
    return {"K": 1} if unit == {"°C": 1} else unit


def unit_text(unit: Unit) -> str:
    """Return a unit as it is written; ``1`` for a plain number."""
    above: list[str] = []
    below: list[str] = []
    for symbol, power in unit.items():
        (above if power > 0 else below).extend([symbol] * abs(power))
    text = " ".join(above) or "1"
    return f"{text}/{' '.join(below)}" if below else text


def unlike(unit: Unit) -> tuple[str, str] | None:
    """Return two symbols of one kind of which one divides the other, as in rad/deg."""
    for first, second in combinations(unit, 2):
        if unit[first] * unit[second] < 0 and any({first, second} <= kind for kind in KINDS):
            return first, second
    return None
