"""The walk over a control period with floats: the bits of the machine code, in every controller."""

from __future__ import annotations

import math
import struct
from pathlib import Path

import numpy as np
import pytest

import fuzzyarm
from fuzzyarm.control.controllers.floats import ReferenceRun
from fuzzyarm.control.controllers.period import PortValue
from fuzzyarm.control.controllers.text import ControllerText, ports_of

ROOT = Path(__file__).parents[2]
FILES = sorted([*ROOT.glob("rulebases/**/*.frb"), *ROOT.glob("examples/**/*.frb")])
PERIODS = 120


def loaded(path):
    try:
        return fuzzyarm.load(path)
    except ValueError:
        return None


def controllers():
    for path in FILES:
        text = loaded(path)
        if isinstance(text, ControllerText) and not text.model.partners:
            yield pytest.param(text, id=path.stem)


def courses(text, seed):
    """Return references and measured values: walks with jumps, some of them not a number."""
    generator = np.random.default_rng(seed)
    names = [
        PortValue(kind, *address)
        for kind in ("reference", "measured")
        for address in ports_of(text.model, kind)
    ]
    steps = generator.normal(0.0, 0.3, (PERIODS, len(names)))
    steps *= generator.choice([0.1, 1.0, 20.0], (PERIODS, 1))
    values = np.cumsum(steps, axis=0)
    values[generator.random(values.shape) < 0.02] = math.nan
    return [dict(zip(names, row, strict=True)) for row in values.tolist()]


def compiled_run(text, single):
    run = text.run(single=single)
    one = len(text.model.axis_names) == 1
    addresses = sorted(ports_of(text.model, "drive"))

    def step(given):
        by_kind = {"reference": {}, "measured": {}}
        for (kind, axis, port), value in given.items():
            by_kind[kind][port if one else f"{axis}.{port}"] = value
        drives = run.step(by_kind["measured"], by_kind["reference"])
        return [drives[port if one else f"{axis}.{port}"] for axis, port in addresses]

    return run, step


def bits(values):
    return [struct.pack("d", value) for value in values]


@pytest.mark.parametrize("single", [False, True], ids=["double", "single"])
@pytest.mark.parametrize("text", [*controllers()])
def test_floats_have_the_bits_of_the_machine_code(text, single):
    reference = ReferenceRun(text, single=single)
    run, step = compiled_run(text, single)
    for given in courses(text, 36):
        drives = reference.step(given)
        assert bits(step(given)) == bits(drives[address] for address in sorted(drives))
        for (axis, name), value in reference.signals.items():
            assert bits([run.signal(axis, name)]) == bits([value])
