"""Requests as JSON Schema (draft 2020-12): what a form shows, and what other programs may send."""

from __future__ import annotations

import inspect
import math
from typing import Any

from fuzzyarm.requests.fields import Request, RequestField, fields_of

__all__ = ["form_fields", "schema_of"]

_TYPES = {"text": "string", "truth": "boolean", "whole": "integer", "number": "number"}


def schema_of(kind: type[Request]) -> dict[str, Any]:
    """Return the schema of a request.

    Parameters
    ----------
    kind : type
        Of the request.
    """
    known = fields_of(kind)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": kind.__name__,
        "description": (inspect.getdoc(kind) or "").splitlines()[0],
        "type": "object",
        "properties": {each.json_name: property_of(each) for each in known},
        "required": [each.json_name for each in known if each.is_required],
        "additionalProperties": False,
    }


def form_fields(kind: type[Request], *names: str) -> dict[str, dict[str, Any]]:
    """Return the schemas of some fields by their names, for a form."""
    properties: dict[str, dict[str, Any]] = schema_of(kind)["properties"]
    return {name: properties[name] for name in names}


def property_of(known: RequestField) -> dict[str, Any]:
    """Return the schema of a field: its type, limits, default, unit, and what it is."""
    schema = _item(known)
    if known.count is not None:
        fixed = {"minItems": known.count, "maxItems": known.count} if known.count else {}
        schema = {"type": "array", "items": schema, **fixed}
    if known.is_optional:
        schema["type"] = [schema["type"], "null"]
        if "enum" in schema:
            schema["enum"] = [*schema["enum"], None]
    schema["description"] = known.said.help
    if not known.is_required:
        default = known.default
        schema["default"] = list(default) if isinstance(default, tuple) else default
    if known.said.unit:
        schema["unit"] = known.said.unit
    return schema


def _item(known: RequestField) -> dict[str, Any]:
    """Return the schema of one value."""
    schema: dict[str, Any] = {"type": _TYPES[known.kind]}
    limits = known.said.limits
    if known.choices:
        schema["enum"] = list(known.choices)
    if math.isfinite(limits.low):
        schema["exclusiveMinimum" if limits.is_open else "minimum"] = limits.low
    if math.isfinite(limits.high):
        schema["maximum"] = limits.high
    return schema
