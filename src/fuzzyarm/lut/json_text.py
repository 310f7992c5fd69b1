"""Tables as ``.json``: one object with named axes, for other programs."""

from __future__ import annotations

import json
import math
from typing import Any

from fuzzyarm.lut.axis import Axis, TableError
from fuzzyarm.lut.header import PlainTable, TableHeader
from fuzzyarm.lut.text import ParsedTable
from fuzzyarm.lut.write_text import FORMAT, VERSION
from fuzzyarm.rulebase.diagnostic import Diagnostic, Span


def header_data(table: TableHeader) -> dict[str, Any]:
    """Return the header of `table` as plain data for JSON; an infinite end is null."""
    return {
        "format": FORMAT,
        "version": VERSION,
        "output": {
            "name": table.output,
            "low": _finite(table.low),
            "high": _finite(table.high),
            "bounded": table.low is not None,
            "description": table.description,
        },
        "index": list(table.names),
        "axes": [
            {
                "name": axis.name,
                "low": _finite(axis.low),
                "high": _finite(axis.high),
                "description": axis.description,
                "levels": list(axis.levels),
                "bins": None if axis.bins is None else list(axis.bins),
            }
            for axis in table.axes
        ],
        "round": table.rounding,
        "mode": table.mode,
        "provenance": [list(pair) for pair in table.provenance],
    }


def write_json(table: PlainTable) -> str:
    """Return the text of `table` as a JSON object; ``values`` is nested in index order."""
    data = header_data(table)
    data["values"] = _nested(list(table.values), table.shape)
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def parse_json(text: str, path: str = "<text>") -> ParsedTable:
    """Read what :func:`write_json` writes; any fault is a diagnostic."""
    try:
        data = json.loads(text)
    except json.JSONDecodeError as error:
        span = Span(error.lineno, error.colno, error.lineno, error.colno + 1)
        return _fault("bad-json", f"this is no JSON: {error.msg}", path, span)
    except (RecursionError, ValueError) as error:
        return _fault("bad-json", f"this JSON is not read: {error}", path)
    try:
        head = header_from(data)
        values = _flat(data["values"], head.shape)
        fields = {name: getattr(head, name) for name in TableHeader.__dataclass_fields__}
        return ParsedTable(PlainTable(**fields, values=tuple(values)), (), head)
    except KeyError as error:
        return _fault("missing-key", f"the object has no {error}", path)
    except TableError as error:
        return _fault("bad-table", error.message, path)
    except (TypeError, ValueError, AttributeError, OverflowError):
        return _fault("bad-table", "the object is not of the form of a table", path)


def header_from(data: Any) -> TableHeader:
    """Return the header that :func:`header_data` made; raise where it is not of that form."""
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise TableError(f'this is no table: "format" is not "{FORMAT}"')
    if data.get("version") != VERSION:
        raise TableError(f"this fuzzyarm reads version {VERSION} of the format")
    index = data["index"]
    axes = tuple(_axis(axis) for axis in data["axes"])
    if list(index) != [axis.name for axis in axes]:
        raise TableError(f"the index order {index} is not that of the axes")
    output = data["output"]
    return TableHeader(
        axes,
        _text(output["name"]),
        low=_end(output.get("low"), -math.inf if output.get("bounded") else None),
        high=_end(output.get("high"), math.inf if output.get("bounded") else None),
        description=_text(output.get("description") or ""),
        rounding=_end(data.get("round"), None),
        mode=data.get("mode"),
        provenance=tuple((_text(key), _text(value)) for key, value in data["provenance"]),
    )


def _axis(data: dict[str, Any]) -> Axis:
    bins = data.get("bins")
    low, high = _end(data.get("low"), -math.inf), _end(data.get("high"), math.inf)
    return Axis(
        _text(data["name"]),
        tuple(_number(x) for x in data["levels"]),
        None if bins is None else tuple(_number(x) for x in bins),
        low=-math.inf if low is None else low,
        high=math.inf if high is None else high,
        description=_text(data.get("description") or ""),
    )


def _finite(x: float | None) -> float | None:
    return None if x is None or math.isinf(x) else x


def _end(value: Any, otherwise: float | None) -> float | None:
    return otherwise if value is None else _number(value)


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise TableError(f"{value!r:.40} is not a number")
    return float(value)


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise TableError(f"{value!r:.40} is not a text")
    return value


def _nested(values: list[float], shape: tuple[int, ...]) -> list[Any]:
    if len(shape) == 1:
        return values
    size = len(values) // shape[0]
    return [_nested(values[i : i + size], shape[1:]) for i in range(0, len(values), size)]


def _flat(values: Any, shape: tuple[int, ...]) -> list[float]:
    if not isinstance(values, list) or len(values) != shape[0]:
        raise TableError(f"the values do not have the shape {shape} that the axes ask for")
    if len(shape) == 1:
        numbers = [_number(x) for x in values]
        if not all(map(math.isfinite, numbers)):
            raise TableError("a value is not finite")
        return numbers
    return [x for part in values for x in _flat(part, shape[1:])]


def _fault(name: str, message: str, path: str, span: Span = Span(1, 1, 1, 2)) -> ParsedTable:  # noqa: B008
    return ParsedTable(None, (Diagnostic(name, message, span, path=path),))
