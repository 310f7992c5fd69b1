"""Words like ``e=1.3,ce=-2``: values of known names."""

from __future__ import annotations

import math
import shlex
from collections.abc import Iterable, Iterator, Sequence

from fuzzyarm.base.errors import UsageError, WordError
from fuzzyarm.base.names import near_hint


def read_assignments(
    words: Iterable[str], names: Iterable[str], *, what: str = "input"
) -> dict[str, float]:
    """Return the values in words like ``e=1.3`` or ``e=1.3,ce=-2``."""
    valid = tuple(names)
    values: dict[str, float] = {}
    for name, text in _pairs(words, valid):
        if name not in valid:
            hint, _ = near_hint(name, valid)
            listed = ", ".join(valid) or "none"
            raise WordError(f"unknown {what} '{name}'", hint=hint or f"there are: {listed}")
        if name in values:
            raise UsageError(f"'{name}' is given twice")
        values[name] = read_number(text, name)
    return values


def read_point(words: Iterable[str], names: Sequence[str]) -> dict[str, float]:
    """Return a value for each of `names`; otherwise as :func:`read_assignments`."""
    values = read_assignments(words, names)
    missing = [name for name in names if name not in values]
    if missing:
        several = "s" if len(missing) > 1 else ""
        example = " ".join(f"{name}=0" for name in missing)
        raise WordError(
            f"no value for input{several} {', '.join(missing)}",
            hint=f"add, for instance, {example}",
        )
    return values


def _pairs(words: Iterable[str], valid: tuple[str, ...]) -> Iterator[tuple[str, str]]:
    for word in words:
        # A name may contain a comma or an equals sign: match known names first.
        rest = word
        while rest:
            name = next((n for n in valid if rest.startswith(f"{n}=")), None)
            if name is None:
                name, equals, _ = rest.partition("=")
                if not equals or not name:
                    message = f"'{rest}' is not an assignment"
                    example = shlex.quote(f"{valid[0] if valid else 'e'}=1.3")
                    raise UsageError(message, hint=f"write, for instance, {example}")
            value, _, rest = rest[len(name) + 1 :].partition(",")
            yield name.strip(), value.strip()


def read_number(text: str, name: str) -> float:
    """Return the finite number in `text`; `name` is for the error."""
    try:
        value = float(text)
    except ValueError:
        raise UsageError(f"the value of '{name}' is not a number: '{text}'") from None
    if not math.isfinite(value):
        raise UsageError(f"the value of '{name}' must be finite, not {text}")
    return value
