"""Rule bases from samples, and judged by samples; controllers that learn along a trajectory.

:func:`read_samples` reads a table of data, :func:`fit` makes a rule base of it,
:func:`validate` judges any rule base by data; :func:`train` teaches a controller.

Reading order: :mod:`.data`, :mod:`.wang_mendel` (rules by counting), :mod:`.starts`,
:mod:`.sugeno` and :mod:`.structure` (models by least squares), :mod:`.fit` (the whole way),
:mod:`.validation`; :mod:`.self_organizing` and :mod:`.training`; :mod:`.tuning`, which moves the
numbers of a file by the costs of its runs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

# Named like their modules, so they must be imported first.
from fuzzyarm.learning.fit import Fit, FitError, fit
from fuzzyarm.learning.fit_options import Options
from fuzzyarm.learning.wang_mendel import wang_mendel

if TYPE_CHECKING:
    from fuzzyarm.learning.data import (
        ColumnError,
        Columns,
        DataError,
        Samples,
        as_samples,
        frame_samples,
        function_samples,
        read_samples,
        rulebase_samples,
        table_samples,
    )
    from fuzzyarm.learning.self_organizing import Snapshot
    from fuzzyarm.learning.training import train
    from fuzzyarm.learning.validation import Validation, ValidationError, validate

__all__ = [
    "ColumnError", "Columns", "DataError", "Fit", "FitError", "Options", "Samples", "Snapshot",
    "Validation", "ValidationError", "as_samples", "fit", "frame_samples", "function_samples",
    "read_samples", "rulebase_samples", "table_samples", "train", "validate", "wang_mendel",
]  # fmt: skip

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(
        __name__,
        {
            "data": (
                "ColumnError",
                "Columns",
                "DataError",
                "Samples",
                "as_samples",
                "frame_samples",
                "function_samples",
                "read_samples",
                "rulebase_samples",
                "table_samples",
            ),
            "self_organizing": ("Snapshot",),
            "training": ("train",),
            "validation": (
                "Validation",
                "ValidationError",
                "validate",
            ),
        },
        __all__,
    )
