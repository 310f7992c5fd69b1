"""What can be asked for, field by field: a frozen record for each job.

A request is what a command says (``fuzzyarm tune``), what the designer's forms ask, and what the
calls from Python take beside their keywords.
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
    "CompareRequest",
    "CompileRequest",
    "ExportRequest",
    "FitRequest",
    "LearnRequest",
    "ProveRequest",
    "Request",
    "RequestError",
    "SimulateRequest",
    "SweepRequest",
    "TuneRequest",
]

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
