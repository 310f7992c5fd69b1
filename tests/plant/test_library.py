"""The shipped plants: what physics keeps, and the same bits compiled, interpreted and by hand."""

import math
from itertools import pairwise

import numpy as np
import pytest

from fuzzyarm import load, shipped
from fuzzyarm.control.loop import Options, Signal, simulate
from fuzzyarm.plant import Plant, Port, find_plant
from fuzzyarm.plant.plain_python import plain_motion
from fuzzyarm.plant.plant import CLOCK_SIZE, WORK, numbers_of, with_parameters
from fuzzyarm.plant.setting import RunArithmetic
from fuzzyarm.symbolic.kernels import kernel

CONTROLLERS = {
    "motor": ("servo.frb", "position", 1.0),
    "cartpole": ("cartpole.frb", "x", 0.5),
    "tanks": ("tanks.frb", "level2", 0.15),
    "ball-and-beam": ("ball-and-beam.frb", "position", 0.3),
    "room": ("heater.frb", "temperature", 20.0),
}


def numbers(plant):
    return numbers_of(plant, (), RunArithmetic()).tolist()


def moved(plant, state, inputs, duration, parts):
    """Return the states after a time, by so many Runge-Kutta steps."""
    count = len(plant.states)
    board = np.concatenate([np.asarray(state, float), np.zeros(WORK * count)])
    clock = np.zeros(CLOCK_SIZE)
    clock[:3] = 0.0, duration, parts
    move = plain_motion(plant, count)
    move(board, None, np.asarray(inputs, float), np.array(numbers(plant)), clock)
    return board[:count]


def slopes(plant, state, inputs):
    return plant.derivative(0.0, list(state), list(inputs), numbers(plant))


# --- What physics keeps ---

RANDOM = np.random.default_rng(11)


@pytest.mark.parametrize("state", RANDOM.normal(0.0, [2.0, 20.0, 3.0], (5, 3)))
def test_the_motor_turns_electrical_power_into_heat_and_motion(state):
    motor = with_parameters(find_plant("motor"), {"T": 0.4})
    inertia, friction, _, resistance, inductance, load = numbers(motor)
    _, speed, current = state
    volts = 7.5
    turning, accelerating, changing = slopes(motor, state, [volts])
    stored = inertia * speed * accelerating + inductance * current * changing
    lost = resistance * current**2 + friction * speed**2 + load * speed
    assert turning == speed
    assert volts * current == pytest.approx(stored + lost, rel=1e-12)


def energy_of_cart_and_pole(plant, state):
    cart, pole, half, g, _ = numbers(plant)
    _, v, theta, omega = state
    # The rod's centre moves with the cart and about its hinge; it turns with m (2 l)²/12.
    kinetic = 0.5 * (cart + pole) * v**2 + pole * half * v * omega * math.cos(theta)
    kinetic += 0.5 * pole * half**2 * omega**2 * (1.0 + 1.0 / 3.0)
    return kinetic + pole * g * half * math.cos(theta)


def test_a_cart_and_pole_left_alone_keep_their_energy_to_the_fourth_order():
    plant = find_plant("cartpole")
    state = [0.0, 0.4, 0.7, -0.3]
    before = energy_of_cart_and_pole(plant, state)
    exact = moved(plant, state, [0.0], 2.0, 3200)
    errors = []
    for parts, bound in ((200, 1e-6), (400, 1e-8), (800, 1e-9)):
        after = moved(plant, state, [0.0], 2.0, parts)
        assert energy_of_cart_and_pole(plant, after) == pytest.approx(before, rel=bound)
        errors.append(np.abs(after - exact).max())
    # Half the step, a sixteenth of the error.
    assert all(10.0 < a / b < 20.0 for a, b in pairwise(errors))


def test_the_momentum_of_cart_and_pole_changes_by_the_force_alone():
    plant = find_plant("cartpole")
    cart, pole, half, _, _ = numbers(plant)
    for state in RANDOM.normal(0.0, 1.0, (5, 4)):
        _, acceleration, _, angular = slopes(plant, state, [3.0])
        _, _, theta, omega = state
        turning = angular * math.cos(theta) - omega**2 * math.sin(theta)
        assert (cart + pole) * acceleration + pole * half * turning == pytest.approx(3.0, rel=1e-12)


def test_the_tanks_keep_the_water_and_stand_where_torricelli_says():
    plant = find_plant("tanks")
    section, hole, pump, g = numbers(plant)
    for state in RANDOM.uniform(0.0, 0.3, (5, 2)):
        first, second = slopes(plant, state, [5.0])
        leaves = hole * math.sqrt(2.0 * g * state[1])
        assert section * (first + second) == pytest.approx(pump * 5.0 - leaves, rel=1e-12)
    steady = (pump * 5.0 / hole) ** 2 / (2.0 * g)
    np.testing.assert_allclose(moved(plant, [0.0, 0.1], [5.0], 900.0, 1800), steady, rtol=1e-6)
    # Emptied, they stay empty.
    assert np.abs(moved(plant, [1e-4, 0.0], [0.0], 60.0, 120)).max() < 1e-3


def test_a_ball_on_a_beam_at_rest_keeps_its_energy():
    plant = find_plant("ball-and-beam")
    g, inertia = numbers(plant)

    def energy(state):
        return 0.5 * (1.0 + inertia) * state[1] ** 2 - g * state[0] * math.sin(state[2])

    state = [-0.2, 0.3, 0.1]
    after = moved(plant, state, [0.0], 0.7, 70)
    assert energy(after) == pytest.approx(energy(state), rel=1e-12)
    fall = g * math.sin(0.1) / (1.0 + inertia)
    assert after[0] == pytest.approx(-0.2 + 0.3 * 0.7 + 0.5 * fall * 0.49, rel=1e-12)


@pytest.mark.slow
def test_the_room_keeps_its_heat_and_ends_where_the_resistances_say():
    plant = find_plant("room")
    power, air, wall, inner, outer, leak, outside, _ = numbers(plant)
    for state in RANDOM.uniform(0.0, 30.0, (5, 2)):
        warming, soaking = slopes(plant, state, [60.0])
        lost = (state[0] - outside) / leak + (state[1] - outside) / outer
        assert air * warming + wall * soaking == pytest.approx(0.6 * power - lost, rel=1e-9)
    through = 1.0 / (1.0 / leak + 1.0 / (inner + outer))
    steady = outside + 0.6 * power * through
    after = moved(plant, [15.0, 15.0], [60.0], 40 * 86400.0, 40 * 1440)
    assert after[0] == pytest.approx(steady, rel=1e-6)


# --- Bits ---


def by_hand(name):
    """Return the slopes of a plant as a reader of the equations writes them."""

    def motor(x, u, p):
        return (x[1], (p[2] * x[2] - p[1] * x[1] - p[5]) / p[0],
                (u[0] - p[3] * x[2] - p[2] * x[1]) / p[4])  # fmt: skip

    def cartpole(x, u, p):
        cart, pole, half, g, _ = p
        s, c, total = math.sin(x[2]), math.cos(x[2]), cart + pole
        f = (u[0] + pole * half * x[3] * x[3] * s) / total
        a = (g * s - c * f) / (half * (4.0 / 3.0 - pole * c * c / total))
        return x[1], f - pole * half * a * c / total, x[3], a

    def tanks(x, u, p):
        q = [p[1] * math.sqrt(2.0 * p[3] * max(h, 0.0)) for h in x]
        return (p[2] * u[0] - q[0]) / p[0], (q[0] - q[1]) / p[0]

    def beam(x, u, p):
        return x[1], (x[0] * u[0] * u[0] + p[0] * math.sin(x[2])) / (1.0 + p[1]), u[0]

    def room(x, u, p):
        inward = (x[0] - x[1]) / p[3]
        air = (0.01 * p[0] * u[0] - inward - (x[0] - p[6]) / p[5]) / p[1]
        return air, (inward - (x[1] - p[6]) / p[4]) / p[2]

    found = {"motor": motor, "cartpole": cartpole, "tanks": tanks, "ball-and-beam": beam}
    return found.get(name, room)


def runge_kutta(slope, x, u, p, h):
    one = slope(x, u, p)
    two = slope([a + 0.5 * h * b for a, b in zip(x, one, strict=True)], u, p)
    three = slope([a + 0.5 * h * b for a, b in zip(x, two, strict=True)], u, p)
    four = slope([a + h * b for a, b in zip(x, three, strict=True)], u, p)
    weighted = zip(x, one, two, three, four, strict=True)
    return [a + h / 6.0 * (k + 2.0 * m + 2.0 * n + e) for a, k, m, n, e in weighted]


@pytest.mark.parametrize("name", CONTROLLERS)
def test_compiled_interpreted_and_by_hand_it_has_the_same_bits(name):
    file, port, to = CONTROLLERS[name]
    plant, text = find_plant(name), load(shipped(file))
    period = text.model.period

    def run(*, compiled):
        return simulate(text, plant, reference={port: Signal("step", (to,))},
                        duration=200 * period, options=Options(compiled=compiled))  # fmt: skip

    fast, slow = run(compiled=True), run(compiled=False)
    for key, values in {**fast.outputs, **fast.drives}.items():
        np.testing.assert_array_equal(values, {**slow.outputs, **slow.drives}[key])
    # By hand: the recorded drives, held, move the states.
    state = [float(each) for each in plant.start(np.random.default_rng(1))]
    parts = max(1, math.ceil(period / plant.longest_step - 1e-9))
    for index, force in enumerate(fast.drives[next(iter(plant.inputs))]):
        seen = [fast.outputs[output][index] for output in plant.outputs]
        assert state[: len(seen)] == seen
        for _ in range(parts):
            state = runge_kutta(by_hand(name), state, [force], numbers(plant), period / parts)


# --- One's own, written as Python allows ---


class Kiln(Plant):
    """Counts its states from the end."""

    name, axis = "kiln", "room"
    inputs = {"power": Port("W", 0.0, 2000.0)}
    outputs = {"temperature": Port("°C"), "sum": Port("1")}
    states = {"age": "1", "T": "°C", "sum": "1"}
    parameters = {"loss": 1e-3}

    @staticmethod
    @kernel
    def derivative(t, x, u, p):
        total = 0.0
        for i in range(len(x)):
            total += x[i - 1]  # begins with the last
        return 1e-4, 1e-5 * u[-1] - p[-1] * (x[-2] - 10.0), 1e-6 * total

    @staticmethod
    @kernel
    def measure(t, x, u, p):
        return x[-2], x[-1:][0]


def test_equations_of_a_user_may_count_from_the_end():
    text, to = load(shipped("heater.frb")), {"temperature": Signal("step", (20.0,))}
    fast, slow = (
        simulate(text, Kiln(), reference=to, duration=600.0, options=Options(compiled=compiled))
        for compiled in (True, False)
    )
    assert slow.outputs["sum"][-1] > 0.0
    for name, values in slow.outputs.items():
        np.testing.assert_array_equal(fast.outputs[name], values)


# --- Their controllers ---


@pytest.mark.parametrize(
    ("name", "rise", "overshoot", "settling"),
    [
        ("motor", 0.15, 0.5, 0.25),  # degrees
        ("cartpole", 3.5, 0.01, 5.0),
        ("tanks", 25.0, 0.002, 60.0),
        ("ball-and-beam", 0.7, 0.005, 1.2),
        ("room", 1200.0, 0.5, 3600.0),
    ],
)
def test_the_shipped_controller_serves_its_plant(name, rise, overshoot, settling):
    file, port, to = CONTROLLERS[name]
    to = 1.0 if name == "cartpole" else to
    run = simulate(load(shipped(file)), find_plant(name), reference={port: Signal("step", (to,))})
    (found,) = run.metrics.values()
    assert run.diverged is None
    assert found.rise is not None
    assert found.rise < rise
    assert found.overshoot is not None
    assert found.overshoot < overshoot
    assert found.settling is not None
    assert found.settling < settling
