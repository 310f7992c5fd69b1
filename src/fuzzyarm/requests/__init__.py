"""Requests: one frozen record for each job, field by field.

A request is the common form of a command (``fuzzyarm tune``), a form of the designer and a call
from Python.

To add an option
----------------
Add a field to the request with ``option``: words, a line of help, default, limits. The option of
the command with its help and errors, ``docs/reference/commands.md``, the field of the page, the
entry of the journal and the keyword of the Python call follow; random commands draw it. Its words
are interpreted in ``control/loop/words.py`` (ports, signals, sensors),
``control/loop/experiments.py`` (files, plants, trajectories), ``learning/tuning/orders.py`` or
``learning/training.py``. An option for the output alone is a field of the command's record in
``apps/cli``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

if TYPE_CHECKING:
    from fuzzyarm.requests.fields import Request, RequestError
    from fuzzyarm.requests.learn import FitRequest, LearnRequest
    from fuzzyarm.requests.making import CompileRequest, ExportRequest
    from fuzzyarm.requests.prove import ProveRequest
    from fuzzyarm.requests.runs import CompareRequest, SimulateRequest, SweepRequest
    from fuzzyarm.requests.tune import TuneRequest

__all__ = [
    "CompareRequest", "CompileRequest", "ExportRequest", "FitRequest", "LearnRequest",
    "ProveRequest", "Request", "RequestError", "SimulateRequest", "SweepRequest", "TuneRequest",
]  # fmt: skip

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(
        __name__,
        {
            "fields": ("Request", "RequestError"),
            "learn": ("FitRequest", "LearnRequest"),
            "making": ("CompileRequest", "ExportRequest"),
            "prove": ("ProveRequest",),
            "runs": ("CompareRequest", "SimulateRequest", "SweepRequest"),
            "tune": ("TuneRequest",),
        },
    )
