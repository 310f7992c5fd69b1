"""Tables as ``.npz``: the values as an array, the header as JSON text beside it."""

from __future__ import annotations

import io
import json

import numpy as np

from fuzzyarm.lut.axis import TableError
from fuzzyarm.lut.files import TableFileError
from fuzzyarm.lut.header import TableHeader
from fuzzyarm.lut.json_text import header_data, header_from
from fuzzyarm.lut.table import LookupTable
from fuzzyarm.rulebase.diagnostic import Diagnostic, Span


def npz_bytes(table: LookupTable) -> bytes:
    """Return the content of the file: ``values``, ``header``, and each axis for convenience."""
    data = header_data(table)
    arrays = {f"levels_{k}": np.array(axis.levels) for k, axis in enumerate(table.axes)}
    out = io.BytesIO()
    header = np.array(json.dumps(data, ensure_ascii=False))
    arrays |= {"values": table.values, "header": header}
    np.savez_compressed(out, allow_pickle=False, **arrays)
    return out.getvalue()


def read_npz(data: bytes, path: str) -> LookupTable:
    """Return the table that :func:`npz_bytes` stored.

    Raises
    ------
    TableFileError
        Whatever is wrong with the archive.
    """
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            head = header_from(json.loads(str(archive["header"][()])))
            values = np.asarray(archive["values"], dtype=np.float64)
        fields = {name: getattr(head, name) for name in TableHeader.__dataclass_fields__}
        values.setflags(write=False)
        return LookupTable(**fields, values=values)
    except TableError as error:
        message = error.message
    except Exception as error:
        message = f"this is no archive of a table ({type(error).__name__})"
    raise TableFileError([Diagnostic("bad-table", message, Span(1, 1, 1, 2), path=path)])
