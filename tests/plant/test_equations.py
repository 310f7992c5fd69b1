"""Equations of a user as machine code: what is traced, what is not; both have the same bits."""

import math
import random
from math import cos, sin

import numpy as np
import pytest

from fuzzyarm import load, shipped
from fuzzyarm.control.loop import Options, Signal, simulate
from fuzzyarm.plant import Port
from fuzzyarm.plant.equations import has_numba, traced
from fuzzyarm.plant.own import as_plant
from fuzzyarm.symbolic.kernels import kernel


class Pendulum:
    """A pendulum that a motor turns; its position is measured in turns of the encoder."""

    name = "pendulum"
    inputs = {"voltage": Port("V", -24.0, 24.0)}
    outputs = {
        "position": Port("rad", -10.0, 10.0),
        "velocity": Port("rad/s", -200.0, 200.0, rate_of="position"),
    }
    states = {"angle": "rad", "rate": "rad/s"}
    parameters = {"gravity": 9.81, "length": 0.4, "friction": 0.3}
    longest_step = 1e-3
    axis = "shaft"

    def derivative(self, t, x, u, p):
        gravity, length, friction = p
        angle, rate = x
        load = max(0.0, sin(3.0 * t)) * min(1.0, abs(rate), 2.0)
        return rate, u[0] - friction * rate - gravity / length * math.sin(angle) - load

    def measure(self, t, x, u, p):
        return x[0] + 0.001 * cos(t), x[-1]


class Asking(Pendulum):
    def derivative(self, t, x, u, p):
        slope = super().derivative(t, x, u, p)
        return slope if x[0] < 1.0 else (slope[0], slope[1] - 1.0)


class Random(Pendulum):
    def derivative(self, t, x, u, p):
        rate, slope = super().derivative(t, x, u, p)
        return rate, slope + random.random()


class Counting(Pendulum):
    calls = 0

    def derivative(self, t, x, u, p):
        self.calls += 1
        return x[1], u[0] * self.calls


class Remainder(Pendulum):
    def derivative(self, t, x, u, p):
        return x[1], u[0] - (x[0] - 3.0) % 2.0


class Resting(Pendulum):
    def derivative(self, t, x, u, p):
        return x[1], 30.0 if x[0] == 0.0 else u[0]


class Unpowered(Pendulum):
    def derivative(self, t, x, u, p):
        return x[1], 0.0 if u[0] in (0.0, 24.0) else u[0] - x[1]


class Stuck(Pendulum):
    """Dry friction: at rest it holds against small voltages, which no drawn point meets."""

    def derivative(self, t, x, u, p):
        if x[1] == 0.0 and abs(u[0]) < 0.5:
            return 0.0, 0.0
        return x[1], u[0] - 3.0 * x[1]


class Moded(Pendulum):
    """A mode that its own value of the parameter does not choose."""

    def derivative(self, t, x, u, p):
        return x[1], u[0] + 20.0 * x[0] if p[2] == 7.0 else u[0] - x[0]


class Meeting(Pendulum):
    def derivative(self, t, x, u, p):
        return x[1], 1.0 if x[0] == u[0] else u[0]


class Chosen(Pendulum):
    def derivative(self, t, x, u, p):
        return x[1], 1.0 if u[0] in {0.3125, 7.75} else u[0]


class Tabled(Pendulum):
    def derivative(self, t, x, u, p):
        return x[1], u[0] - {0.3125: 5.0}.get(p[2], 0.0)


class Kind(Pendulum):
    def derivative(self, t, x, u, p):
        return x[1], u[0] if isinstance(u[0], float) else 0.0


class Trying(Pendulum):
    def derivative(self, t, x, u, p):
        try:
            push = 1.0 if x[0] > 0.5 else 0.0
        except TypeError:
            push = 2.0
        return x[1], u[0] - push


class Leaving(Pendulum):
    def derivative(self, t, x, u, p):
        if not isinstance(u[0], float):
            raise SystemExit
        return x[1], u[0]


class Short(Pendulum):
    def derivative(self, t, x, u, p):
        return (x[1],)


class Marked(Pendulum):
    @staticmethod
    @kernel
    def derivative(t, x, u, p):
        slope = u[0] - p[2] * x[1] - p[0] / p[1] * math.sin(x[0])
        if x[0] > 1.0:
            slope -= 1.0
        return x[1], slope

    measure = None


def run(plant, **options):
    servo = load(shipped("servo.frb"))
    step = {"position": Signal("step", (1.5,))}
    chosen = Options(**options)
    return simulate(servo, as_plant(plant), reference=step, duration=0.3, options=chosen)


def same(one, other):
    assert one.samples == other.samples
    for port, values in one.outputs.items():
        np.testing.assert_array_equal(values, other.outputs[port])


def test_arithmetic_and_functions_of_math_are_traced():
    assert traced(as_plant(Pendulum())) is not None
    compiled = run(Pendulum())
    assert compiled.compiled
    same(compiled, run(Pendulum(), compiled=False))


@pytest.mark.parametrize(
    "plant",
    [
        Asking, Random, Counting, Short, Remainder, Resting, Unpowered, Stuck, Moded, Meeting,
        Chosen, Tabled, Kind, Trying, Leaving,
    ],
)  # fmt: skip
def test_what_asks_for_values_or_changes_its_answer_is_not_traced(plant):
    assert traced(as_plant(plant())) is None


def test_what_is_not_traced_runs_as_python():
    asking = run(Asking())
    assert not asking.compiled
    same(asking, run(Asking(), compiled=False))


def test_parameters_are_not_part_of_the_program():
    class Long(Pendulum):
        parameters = {"gravity": 9.81, "length": 4.0, "friction": 0.3}

    values = [run(plant).outputs["position"] for plant in (Pendulum(), Long())]
    assert (values[0] != values[1]).any()


@pytest.mark.slow
@pytest.mark.skipif(not has_numba(), reason="numba is not installed")
def test_a_marked_kernel_that_is_not_traced_is_compiled_by_numba():
    assert traced(as_plant(Marked())) is None
    compiled = run(Marked())
    assert compiled.compiled
    same(compiled, run(Marked(), compiled=False))


def test_a_marked_kernel_runs_without_numba(monkeypatch):
    monkeypatch.setattr("fuzzyarm.plant.plant.has_numba", lambda: False)
    assert not run(Marked()).compiled
