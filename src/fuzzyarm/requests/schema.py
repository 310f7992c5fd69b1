"""Requests as JSON Schema (draft 2020-12), for forms and other programs."""

from __future__ import annotations

import inspect
import math
from typing import Any

from fuzzyarm.requests.fields import Request, RequestField, fields_of

_TYPES = {"text": "string", "truth": "boolean", "whole": "integer", "number": "number"}


def schema_of(kind: type[Request]) -> dict[str, Any]:
    """Return the schema of a request."""
    records = fields_of(kind)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": kind.__name__,
        "description": (inspect.getdoc(kind) or "").splitlines()[0],
        "type": "object",
        "properties": {record.json_name: property_of(record) for record in records},
        "required": [record.json_name for record in records if record.is_required],
        "additionalProperties": False,
    }


def form_fields(kind: type[Request], *names: str) -> list[dict[str, Any]]:
    """Return the schemas of some fields for a form, with the spelling of a command.

    Each has its ``name``, its ``title``, the ``option`` of the command (empty for a positional
    argument), the ``placeholder`` of a value, the ``group`` of the help page, and whether the
    option is ``repeated`` or has a ``negatable`` form.
    """
    fields = {field.json_name: field for field in fields_of(kind)}
    return [_form_field(fields[name]) for name in names]


def _form_field(field: RequestField) -> dict[str, Any]:
    """Return the schema of a field with the spelling of a command."""
    options = [word for word in field.spec.words.split() if word.startswith("-")]
    title = field.spelling.lstrip("-").replace("-", " ").replace("_", " ")
    values = [word for word in field.spec.words.split()[1:] if not word.startswith("-")]
    return {
        "name": field.json_name,
        "title": title[:1].upper() + title[1:],
        "option": field.spelling if options else "",
        "placeholder": " ".join(values),
        "group": field.spec.group,
        "repeated": field.spec.is_repeated,
        "negatable": field.spec.is_negatable,
        **property_of(field),
    }


def property_of(field: RequestField) -> dict[str, Any]:
    """Return the schema of a field: type, limits, default, unit, description."""
    schema = _item(field)
    if field.count is not None:
        fixed = {"minItems": field.count, "maxItems": field.count} if field.count else {}
        schema = {"type": "array", "items": schema, **fixed}
    if field.is_optional:
        schema["type"] = [schema["type"], "null"]
        if "enum" in schema:
            schema["enum"] = [*schema["enum"], None]
    schema["description"] = field.spec.help
    if not field.is_required:
        default = field.default
        schema["default"] = list(default) if isinstance(default, tuple) else default
    if field.spec.unit:
        schema["unit"] = field.spec.unit
    return schema


def _item(field: RequestField) -> dict[str, Any]:
    """Return the schema of one value."""
    schema: dict[str, Any] = {"type": _TYPES[field.kind]}
    limits = field.spec.limits
    if field.choices:
        schema["enum"] = list(field.choices)
    if math.isfinite(limits.low):
        schema["exclusiveMinimum" if limits.is_open else "minimum"] = limits.low
    if math.isfinite(limits.high):
        schema["maximum"] = limits.high
    return schema
