"""Data for JSON: no NaN, no infinity, lists for arrays."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any


def jsonable(data: Any) -> Any:
    """Convert data to JSON types.

    Parameters
    ----------
    data : object
        Mappings, sequences, text, numbers, booleans and None, nested; arrays and scalars of NumPy.

    Returns
    -------
    dict, list, str, int, float, bool or None
        Non-finite numbers become None, which is ``null`` in JSON.
    """
    if data is None or isinstance(data, str | int):
        return data
    if isinstance(data, float):
        return float(data) if math.isfinite(data) else None
    if isinstance(data, Mapping):
        return {key: jsonable(item) for key, item in data.items()}
    if hasattr(data, "tolist"):
        return jsonable(data.tolist())
    return [jsonable(item) for item in data]


def script_json(data: object) -> str:
    """Return JSON that is safe inside an HTML script: nothing in it ends a script or a line."""
    import json

    text = json.dumps(data, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
