"""The fuzzy rows of the study as printed, bit for bit.

``as_printed.json`` holds, of each row and trajectory, digests of every sample: they were taken
from hand-written laws, and whatever computes these rows has to give the same bits. A change that
is meant to move them is recorded with ``pytest --update-golden`` and named in the CHANGELOG.
"""

import json
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest

from fuzzyarm.apps.study import find_rows
from fuzzyarm.control.controllers.catalogue import controller
from fuzzyarm.control.loop import Run, simulate
from fuzzyarm.plant.trajectory import pick_and_place, reach_return

GOLDEN = Path(__file__).parent / "as_printed.json"
TRAJECTORIES = (reach_return(), pick_and_place())
ROWS = (
    "fuzzy-lut",
    "fuzzy-lut-x10",
    "fuzzy-direct",
    "ct+fuzzy",
    "ffid+fuzzy",
    "cdid+fuzzy",
    "acdid+fuzzy",
    "mrac+fuzzy",
    "dac+fuzzy",
    "soc-zero",
    "soc-table",
    "stfc",
    "hfie",
    "cfaf",
)


def digest(samples: np.ndarray) -> str:
    """Return the SHA-256 of float64 numbers, least significant byte first, by rows."""
    return sha256(np.ascontiguousarray(samples, "<f8").tobytes()).hexdigest()


def summary(run: Run) -> dict[str, object]:
    """Return what is compared: digests, and the errors that a person would read."""
    assert run.diverged is None
    return {
        "samples": run.samples,
        "rms": run.rms.tolist(),
        "errors": digest(run.error_matrix),
        "torques": digest(run.torques),
    }


def runs_of(name: str) -> dict[str, dict[str, object]]:
    """Run a row as the study counted, with the payload."""
    made = controller(name, variant="as-printed")
    conventions = next(row for row in find_rows([name]) if row.payload).conventions
    return {
        trajectory.name: summary(simulate(made, trajectory, payload=True, conventions=conventions))
        for trajectory in TRAJECTORIES
    }


@pytest.mark.parametrize("name", ROWS)
def test_the_row_has_the_bits_of_the_hand_written_law(name, update_golden):
    found = runs_of(name)
    if update_golden:
        known = json.loads(GOLDEN.read_text()) if GOLDEN.exists() else {}
        ordered = {row: (known | {name: found}).get(row) for row in ROWS}
        present = {row: runs for row, runs in ordered.items() if runs is not None}
        GOLDEN.write_text(json.dumps(present, indent=1) + "\n")
    assert found == json.loads(GOLDEN.read_text())[name]


def test_a_last_bit_of_one_sample_is_seen():
    samples = np.linspace(-1.0, 1.0, 8).reshape(4, 2)
    moved = samples.copy()
    moved[3, 1] = np.nextafter(moved[3, 1], 2.0)
    assert digest(moved) != digest(samples)
