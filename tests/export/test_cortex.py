"""Controllers with a state on a Cortex-M3: the bits of the model over 2,000 periods."""

from __future__ import annotations

import numpy as np
import pytest
from controller_programs import recorded, shipped_text
from cortex_programs import need_cortex, run_on_cortex

from fuzzyarm.exchange.export.walk_of_steps import steps_of

PERIODS = 2_000


@pytest.mark.parametrize("name", ["servo", "soc-zero"])
@pytest.mark.parametrize("precision", ["float64", "mixed"])
def test_the_processor_drives_the_bits_of_the_model(tmp_path, name, precision):
    need_cortex()
    text = shipped_text(name)
    steps = steps_of(text, precision)
    rows, expected = recorded(text, steps, PERIODS, single=precision == "mixed")
    assert len(rows) == PERIODS
    assert np.ptp(expected) > 0.0
    found = run_on_cortex(name.replace("-", "_"), steps, rows, tmp_path)
    if precision == "mixed":
        expected = expected.astype(np.float32).astype(np.float64)
    assert found.tobytes() == expected.tobytes()


def test_the_table_that_learns_begins_with_zeros(tmp_path):
    """Else what is compared would hold of a table that never changes, too."""
    text = shipped_text("soc-zero")
    steps = steps_of(text, "float64")
    _, expected = recorded(text, steps, 200)
    assert not any(any(table.values) for table in steps.learned.values())
    assert np.abs(expected).max() > 0.0
