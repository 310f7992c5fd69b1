"""Any plant in the loop: bits, references, sensors, actuators, disturbances."""

import math
import os
from array import array
from collections import deque
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyarm import shipped
from fuzzyarm.base.errors import UsageError
from fuzzyarm.control.controllers import controller
from fuzzyarm.control.controllers.code import SourceError
from fuzzyarm.control.controllers.text import with_files
from fuzzyarm.control.loop import Options, Sensor, Signal, read_signal, simulate
from fuzzyarm.control.loop.analysis import phase_portrait
from fuzzyarm.control.loop.run import ClosedLoop, as_controller, plant_motion
from fuzzyarm.control.loop.words import driven
from fuzzyarm.language import parse
from fuzzyarm.plant import PLANTS, Plant, PlantError, Port, find_plant, reach
from fuzzyarm.plant.plant import interface_of, is_traced, with_actuators, with_parameters
from fuzzyarm.requests.runs import SimulateRequest


def text(*lines, axis="shaft", period="1 ms", every=1, head=()):
    parts = ["controller c", f"period {period}", f"set-point every {every}", *head]
    whole = "\n".join([*parts, f"axis {axis}", *(f"  {line}" for line in lines)]) + "\n"
    parsed = parse(whole)
    assert parsed.controller is not None, parsed.diagnostics
    made, faults = with_files(parsed.controller, shipped("pd7.frb").parent)
    assert faults == []
    return made


SERVO = text("e = error of position", "u = e * 8", "drive voltage = u")

DRIVERS = {
    "motor": SERVO,
    "cartpole": text("a = measured theta", "u = a * 40", "drive f = u", axis="cart"),
    "tanks": text("e = error of level1", "u = e * 60", "drive pump = u", axis="t", period="1 s"),
    "ball-and-beam": text(
        "e = error of position", "w = measured angle", "u = e - w * 3", "drive angle_rate = u",
        axis="beam", period="10 ms",
    ),
    "room": text(
        "e = error of temperature", "u = e * 10 + 200", "drive power = u",
        axis="room", period="10 s",
    ),
}  # fmt: skip

SENSORS = {"motor": {"position": Sensor(0.01, 0.002, 0.003), "velocity": Sensor(difference=0.005)}}


class Plain(Plant):
    """The equations of a shipped plant, as a user writes them."""

    def __init__(self, inner):
        self.inner = inner
        for name in ("inputs", "outputs", "states", "parameters", "axis", "longest_step"):
            setattr(self, name, getattr(inner, name))
        self.name = inner.name

    def start(self, rng):
        return self.inner.start(rng)

    def derivative(self, t, x, u, p):
        return list(self.inner.derivative(t, x, u, p))


class Opaque(Plain):
    """Equations that ask for the value of a state, and so cannot be traced."""

    def derivative(self, t, x, u, p):
        return super().derivative(t, [float(value) for value in x], u, p)


@pytest.mark.parametrize("name", DRIVERS)
def test_machine_code_the_interpreter_and_plain_python_have_the_same_bits(name):
    options = Options(sensors=SENSORS.get(name, {}), disturbance=1e-6, interpolate=True)
    plant = find_plant(name)
    step = {next(iter(plant.outputs)): Signal("step", (0.1,))}
    duration = 200 * DRIVERS[name].model.period
    runs = [
        simulate(DRIVERS[name], each, reference=step, duration=duration, options=chosen)
        for each, chosen in (
            (plant, options),
            (plant, Options(**{**vars(options), "compiled": False})),
            (Plain(plant), options),
            (Plain(plant), Options(**{**vars(options), "compiled": False})),
            (Opaque(plant), options),
            (Opaque(plant), Options(**{**vars(options), "compiled": False})),
        )
    ]
    assert [run.compiled for run in runs] == [
        True,
        False,
        is_traced(Plain(plant)),
        False,
        False,
        False,
    ]
    for run in runs[1:]:
        assert (run.error_matrix == runs[0].error_matrix).all()
        for port, values in runs[0].outputs.items():
            assert (run.outputs[port] == values).all()
    assert runs[0].samples == 200
    assert np.ptp(next(iter(runs[0].drives.values()))) > 0


def test_a_servo_against_its_equations_in_numpy():
    run = simulate(SERVO, find_plant("motor"), duration=0.5)
    inertia, friction, constant, resistance, inductance = 0.01, 0.02, 0.35, 2.0, 0.004
    system = np.array(
        [
            [0, 1, 0],
            [0, -friction / inertia, constant / inertia],
            [0, -constant / inductance, -resistance / inductance],
        ]
    )
    entry = np.array([0, 0, 1 / inductance])
    x, found = np.zeros(3), []
    for _ in range(500):
        u = min(max(8 * (1.0 - x[0]), -24), 24)
        found.append(x[0])

        def slope(x, u=u):
            return system @ x + entry * u

        h = 0.001
        a = slope(x)
        c = slope(x + h / 2 * a)
        d = slope(x + h / 2 * c)
        e = slope(x + h * d)
        x = x + h / 6 * (a + 2 * c + 2 * d + e)
    assert run.outputs["position"] == pytest.approx(found, abs=1e-12)
    assert run.error_matrix[:, 0] == pytest.approx(np.degrees(1 - np.array(found)), abs=1e-9)


# --- Sensors, actuators, disturbances ---


def sensed(sensor, count=40, **options):
    """Return what a controller sees of a shaft that turns at a steady rate, and what is."""

    class Turning(Plant):
        name = "turning"
        axis = "shaft"
        inputs = {"u": Port()}
        outputs = {"position": Port("1", 0, 4), "velocity": Port("1/s", rate_of="position")}
        states = {"position": "1", "velocity": "1/s"}

        def start(self, rng):
            return [0.0, 1.0]

        def derivative(self, t, x, u, p):
            return [x[1], 0.0]

    seen = text("u = measured position", "drive u = u", period="10 ms")
    run = simulate(
        seen, Turning(), duration=count * 0.01, options=Options(sensors=sensor, **options)
    )
    return run.drives["u"], run.outputs["position"], run


def test_a_resolution_rounds_to_the_next_step():
    seen, true, _ = sensed({"position": Sensor(resolution=0.25)})
    assert seen == pytest.approx(np.floor(true / 0.25 + 0.5) * 0.25, abs=1e-12)
    assert len(set(seen)) == 3


def test_zero_is_a_step_and_the_range_of_a_sensor_ends_it():
    seen, true, _ = sensed({"position": Sensor(resolution=0.3)}, count=600)
    expected = np.clip(np.floor(true / 0.3 + 0.5) * 0.3, 0.0, 4.0)
    assert seen == pytest.approx(expected, abs=1e-12)
    assert seen[0] == 0.0
    assert seen.max() == 4.0 < true.max()
    # The range of the motor's position, -2π to 2π, is not a multiple of a degree's hundredth.
    run = simulate(SERVO, find_plant("motor"), duration=2.0,
                   options=Options(sensors={"position": Sensor(resolution=0.01)}),
                   reference={"position": Signal("step", (0.0,))})  # fmt: skip
    assert not run.error_matrix.any()


def test_a_delay_shows_what_was():
    seen, true, _ = sensed({"position": Sensor(delay=0.05)})
    assert (seen[:5] == true[0]).all()
    assert (seen[5:] == true[:-5]).all()
    seen, true, _ = sensed({"position": Sensor(delay=1e9)})  # without room for a thousand years
    assert (seen == true[0]).all()


@pytest.mark.parametrize(
    ("delay", "periods"), [(0.005, 1), (0.015, 2), (0.025, 3), (0.024, 2), (0.0, 0)]
)
def test_half_a_period_of_delay_counts_up_and_is_said(delay, periods):
    seen, true, run = sensed({"position": Sensor(delay=delay)})
    assert (seen[periods:] == true[: len(true) - periods]).all()
    said = [note for note in run.notes if "'position'" in note and f"{periods} are taken" in note]
    assert len(said) == (delay != 0.0)


def test_noise_is_drawn_by_the_seed():
    first, true, run = sensed({"position": Sensor(noise=0.5)}, seed=3, count=4000)
    again, _, _ = sensed({"position": Sensor(noise=0.5)}, seed=3, count=4000)
    other, _, _ = sensed({"position": Sensor(noise=0.5)}, seed=4, count=4000)
    assert (first == again).all()
    assert (first != other).any()
    assert np.std(first - true) == pytest.approx(0.5, rel=0.05)
    assert np.mean(first - true) == pytest.approx(0.0, abs=0.03)
    assert run.seed == 3


def test_a_rate_may_be_formed_by_difference():
    seen = text("v = measured velocity", "drive voltage = v", period="1 ms")
    plant = find_plant("motor")
    load = {"voltage": Signal("step", (5.0,))}
    exact = simulate(seen, plant, duration=0.1, options=Options(loads=load))
    formed = simulate(
        seen, plant, duration=0.1,
        options=Options(loads=load, sensors={"velocity": Sensor(difference=0.0)}),
    )  # fmt: skip
    positions = formed.outputs["position"]
    expected = np.concatenate([[0.0], np.diff(positions) / 0.001])
    assert formed.drives["voltage"] == pytest.approx(expected, abs=1e-9)
    assert not np.allclose(exact.drives["voltage"], formed.drives["voltage"])


def test_an_actuator_holds_range_and_slew():
    plant = with_actuators(find_plant("motor"), {"voltage": Port(low=-3, high=5, slew=1000)})
    run = simulate(SERVO, plant, duration=0.5)
    drives = run.drives["voltage"]
    assert drives[0] == 1.0  # from rest, 1000 V/s for 1 ms
    assert np.abs(np.diff(drives)).max() <= 1.0 + 1e-12
    assert drives.max() == 5.0
    assert run.limits["voltage"] == (-3, 5)
    assert 0 < run.metrics["shaft"].saturated < 1


def test_a_slew_begins_at_the_start_of_the_actuator():
    motor = find_plant("motor")
    for start, slew, first in ((4.0, 1000, 5.0), (4.0, 100, 4.1), (None, 1000, 1.0)):
        port = Port(low=-3, high=5, slew=slew, start=start)
        run = simulate(SERVO, with_actuators(motor, {"voltage": port}), duration=0.01)
        assert run.drives["voltage"][0] == pytest.approx(first)
    # The start of a plant stays with other limits, brought into them.
    plant = with_actuators(motor, {"voltage": Port(start=4.0)})
    later = with_actuators(plant, {"voltage": Port(low=-3, high=3)})
    assert later.inputs["voltage"].start == 3.0


class Blind(Plant):
    """A lag whose sensor gives no number at first."""

    name = "blind"
    inputs = {"power": Port(low=0, high=50, slew=100, start=20.0)}
    outputs = {"level": Port()}
    states = {"level": "1"}
    axis = "shaft"

    def step(self, t, x, u, p, dt):
        return [x[0] + dt * (u[0] - x[0])]

    def measure(self, t, x, u, p):
        return [math.nan if t < 0.0025 else x[0]]


def test_before_a_first_value_a_drive_is_the_start_of_its_actuator():
    law = text("e = error of level", "u = e * 0", "drive power = u")
    run = simulate(law, Blind(), duration=0.006)
    assert run.drives["power"][0] == 20.0  # not 19.9, on the way to 0


def test_the_start_of_an_actuator_is_a_word_of_its_option():
    request = SimulateRequest(actuator=("voltage=-3..5,slew=100,start=4",))
    port = driven(request, find_plant("motor")).inputs["voltage"]
    assert (port.slew, port.start) == (100.0, 4.0)
    old = SimulateRequest(actuator=("voltage=-3..5,100",))
    port = driven(old, find_plant("motor")).inputs["voltage"]
    assert (port.slew, port.start) == (100.0, None)
    for words in ("1,slew=2", "lag=1", "start=1,start=2", "start=9"):
        wrong = SimulateRequest(actuator=(f"voltage=-3..5,{words}",))
        with pytest.raises(UsageError, match=r"start=VALUE|a start of 9"):
            driven(wrong, find_plant("motor"))


@pytest.mark.parametrize(
    ("start", "said"),
    [
        (7.0, "a start of 7 is outside -3 .. 5"),
        (math.nan, "a start of nan"),
        ("1", "start of a port is"),
    ],
)
def test_a_start_is_a_number_within_the_limits(start, said):
    with pytest.raises(PlantError, match=said):
        Port(low=-3, high=5, start=start)


def test_a_load_acts_behind_the_actuator():
    still = text("u = 0 * 1", "drive voltage = u")
    loads = {"voltage": Signal("step", (-100.0, 0.05))}
    run = simulate(still, find_plant("motor"), duration=2.0, options=Options(loads=loads))
    assert not run.drives["voltage"].any()
    # At rest: V = R i + k w and k i = b w.
    expected = -100.0 / (0.35 + 2.0 * 0.02 / 0.35)
    assert run.outputs["velocity"][-1] == pytest.approx(expected, rel=1e-3)
    assert not run.outputs["velocity"][:50].any()


def test_interpolated_set_points_move_in_a_straight_line():
    wanted = {"position": Signal("ramp", (2.0,))}
    every = text("e = error of position", "u = e", "drive voltage = u", every=5)
    held = simulate(every, find_plant("motor"), reference=wanted, duration=0.1)
    moved = simulate(
        every,
        find_plant("motor"),
        reference=wanted,
        duration=0.1,
        options=Options(interpolate=True),
    )
    # The sample is taken in the last of five periods: 4/5 of the way to the next set point.
    way = 2.0 * 0.005 * 0.8
    assert moved.wanted["position"][:-1] == pytest.approx(held.wanted["position"][:-1] + way)


def test_arm_laws_see_the_pose_of_what_sensors_say():
    made, path = controller("cdid"), reach(segment=0.5, hold=0.1)
    exact = simulate(made, path)
    rough = Options(sensors={"position": Sensor(resolution=0.05)})
    coarse, again = (simulate(made, path, options=rough) for _ in range(2))
    assert (coarse.error_matrix == again.error_matrix).all()
    assert np.abs(coarse.torques - exact.torques).max() > 1.0
    still = simulate(made, path, options=Options(sensors={"position": Sensor()}))
    assert (still.error_matrix == exact.error_matrix).all()


def test_a_diverged_run_says_when():
    run = simulate(
        text("e = error of theta", "u = e", "drive f = u", axis="cart"), PLANTS["cartpole"]()
    )
    assert run.diverged is not None
    assert 0.2 < run.diverged < 5
    assert abs(run.outputs["theta"][-1]) <= math.pi / 2


# --- References ---


@settings(max_examples=cases(20, 60))
@given(
    st.sampled_from(["sine:0.7,1.3,0.2", "quintic:2,0.8,-1", "ramp:0.5,0.3,1", "step:2,0.5,1"]),
    st.floats(0.01, 1.0),
)
def test_rates_are_derivatives(words, time):
    signal = read_signal(words)
    h = 1e-5
    t = np.array([time - h, time, time + h])
    if any(abs(time - edge) < 2 * h for edge in (0.3, 0.5, 0.8)):
        return
    value, rate, acceleration = signal.at(t)
    assert (value[2] - value[0]) / (2 * h) == pytest.approx(rate[1], abs=1e-6)
    assert (rate[2] - rate[0]) / (2 * h) == pytest.approx(acceleration[1], abs=1e-4)


def test_a_move_rests_at_both_ends():
    value, rate, acceleration = Signal("quintic", (3.0, 2.0, 1.0)).at(
        np.array([0.0, 1.0, 2.0, 9.0])
    )
    assert value == pytest.approx([1.0, 2.0, 3.0, 3.0])
    assert rate[[0, 2, 3]] == pytest.approx(0.0)
    assert acceleration == pytest.approx(0.0, abs=1e-12)


def test_a_reference_from_a_file(tmp_path):
    path = tmp_path / "way.csv"
    path.write_text("time,position\n0,0\n1,2\n3,2\n")
    value, rate, _ = read_signal(str(path)).at(np.array([-1.0, 0.5, 1.0, 2.0, 5.0]))
    assert value.tolist() == [0.0, 1.0, 2.0, 2.0, 2.0]
    assert rate.tolist() == [0.0, 2.0, 0.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("0,0\nx,1\n", ":2: 'x,1' is not two numbers"),
        ("0,0\n0,1\n", ":2: the times must increase"),
        ("0,0\n1,nan\n", ":2: '1,nan' is not finite"),
        ("time,v\n", "has fewer than two times"),
    ],
)
def test_a_damaged_file_is_told_by_its_line(tmp_path, content, message):
    path = tmp_path / "way.csv"
    path.write_text(content)
    with pytest.raises(PlantError) as found:
        read_signal(str(path)).at(np.array([0.0]))
    assert message in str(found.value)


@pytest.mark.parametrize(
    "words", ["stp:1", "step:", "step:1,2,3,4", "sine:1", "quintic:1,0", "step:inf", "step:a", ""]
)
def test_what_is_no_reference_is_refused(words):
    with pytest.raises(PlantError):
        read_signal(words)


# --- What does not fit ---


def test_a_plant_that_is_not_derived_from_anything_runs():
    class Kiln:
        name = "kiln"
        inputs = {"power": Port("%", 0, 100)}
        outputs = {"T": Port("°C")}
        states = {"T": "°C"}
        parameters = {"loss": 0.01}

        def derivative(self, t, x, u, p):
            return [0.2 * u[0] - p[0] * (x[0] - 20.0)]

    heater = text("e = error of temperature", "u = e * 2", "drive power = u", period="1 s")
    kiln = find_plant(Kiln())
    asked = {"reference": {"T": Signal("step", (300.0,))}, "connect": {"temperature": "T"}}
    run = simulate(heater, kiln, **asked)
    assert simulate(heater, Kiln(), **asked).rms == simulate(heater, Kiln, **asked).rms == run.rms
    # 0.2 · 2 · (300 - T) = 0.01 (T - 20)
    assert run.outputs["T"][-1] == pytest.approx((0.4 * 300 + 0.2) / 0.41, abs=1e-6)
    warmer = with_parameters(kiln, {"loss": 0.02})
    assert simulate(heater, warmer, **asked).outputs["T"][-1] < run.outputs["T"][-1]


def test_what_is_not_a_plant_is_told():
    with pytest.raises(PlantError, match="'list' is not a plant") as found:
        simulate(SERVO, [1.0, 2.0])
    assert "inputs, outputs, states and derivative" in found.value.hint


class Belt:
    """A dead time that is filled once, when the plant is made; and a count of its steps."""

    inputs = {"voltage": Port("V", -24, 24)}
    outputs = {"position": Port("rad")}
    states = {"position": "rad"}

    def __init__(self):
        self.queue, self.steps, self.again = deque([0.0] * 5), 0, self.queue_length

    def queue_length(self):
        return len(self.queue)

    def step(self, t, x, u, p, dt):
        self.queue.append(u[0])
        self.steps += 1
        assert self.again() == 6  # of this copy, not of the one it was made from
        return [x[0] + dt * self.queue.popleft() - 0.001 * self.steps * dt]


class Lag(Belt):
    """The same by its rate, which must be asked as often as a run asks it."""

    step = None

    def derivative(self, t, x, u, p):
        self.steps += 1
        return [u[0] - 0.001 * self.steps]


@pytest.mark.parametrize("kind", [Belt, Lag])
def test_a_run_leaves_nothing_behind_in_a_plant(kind):
    alone, plant = simulate(SERVO, kind(), duration=0.1), kind()
    servo = as_controller(SERVO)
    loop = ClosedLoop(servo, plant_motion(servo, find_plant(plant), duration=0.1))
    for run in (simulate(SERVO, plant, duration=0.1), loop.run(), loop.run()):
        assert run.outputs["position"].tolist() == alone.outputs["position"].tolist()
    assert plant.steps == 0
    assert list(plant.queue) == [0.0] * 5


def test_a_plant_runs_with_the_attributes_that_it_has_by_then():
    class Kiln:
        inputs = {"power": Port("%", 0, 100)}
        outputs = {"T": Port("°C")}
        states = {"T": "°C"}

        def __init__(self, gain):
            self.gain = gain

        def derivative(self, t, x, u, p):
            return [self.gain * u[0] - 0.01 * x[0]]

    heater = text("e = error of T", "u = e * 2", "drive power = u", period="1 s")
    kiln = find_plant(Kiln(0.2))
    assert is_traced(kiln)
    chosen = as_controller(heater)
    first = ClosedLoop(chosen, plant_motion(chosen, kiln, {"T": 300.0}))
    before = first.run()
    kiln.gain = 0.1
    asked = {"reference": {"T": 300.0}}
    assert simulate(heater, kiln, **asked).rms == simulate(heater, Kiln(0.1), **asked).rms
    assert first.run().rms == before.rms == simulate(heater, Kiln(0.2), **asked).rms


@pytest.mark.parametrize("frozen", [False, True])
def test_a_plant_may_be_a_dataclass(frozen):
    @dataclass(frozen=frozen)
    class Kiln:
        gain: float = 0.2
        inputs = {"power": Port("%", 0, 100)}
        outputs = {"T": Port("°C")}
        states = {"T": "°C"}

        def derivative(self, t, x, u, p):
            return [self.gain * u[0] - 0.01 * x[0]]

    class Opaque(Kiln):
        def derivative(self, t, x, u, p):
            return super().derivative(t, [float(value) for value in x], u, p)

    heater = text("e = error of T", "u = e * 2", "drive power = u", period="1 s")
    asked = {"reference": {"T": 300.0}}
    kiln, opaque = find_plant(Kiln(0.1)), find_plant(Opaque(0.1))
    assert is_traced(kiln)
    assert not is_traced(opaque)
    chosen = as_controller(heater)
    loop = ClosedLoop(chosen, plant_motion(chosen, kiln, {"T": 300.0}))
    others = [array("d", [0.0] * size) for size in range(1, 100) for _ in range(20)]
    assert loop.run().rms == simulate(heater, opaque, **asked).rms  # no program is written over
    assert len(others) == 1980


def test_what_a_plant_caches_on_its_way_leaves_its_program_where_it_is():
    class Caching(Plant):
        name = "caching"
        inputs = {"power": Port("%", 0, 100)}
        outputs = {"T": Port("°C")}
        states = {"T": "°C"}

        @cached_property
        def first(self):
            return 20.0

        def start(self, rng):
            return [self.first]

        def derivative(self, t, x, u, p):
            return [0.2 * u[0] - 0.01 * x[0]]

    heater = text("e = error of T", "u = e * 2", "drive power = u", period="1 s")
    chosen, plant = as_controller(heater), Caching()
    assert is_traced(plant)
    loop = ClosedLoop(chosen, plant_motion(chosen, plant, {"T": 300.0}))
    first = loop.run().rms
    assert loop.run().rms == first
    others = [array("d", [0.0] * size) for size in range(1, 100) for _ in range(20)]
    assert loop.run().rms == first
    assert len(others) == 1980


class Begun(Plant):
    """Its gain is set by `start`; what is traced must have it."""

    name = "begun"
    inputs = {"power": Port("%", 0, 100)}
    outputs = {"T": Port("°C")}
    states = {"T": "°C"}
    offset = 0.0

    def start(self, rng):
        self.gain = 0.1
        return [0.0]

    def derivative(self, t, x, u, p):
        return [self.gain * u[0] - 0.01 * x[0]]

    def measure(self, t, x, u, p):
        return [x[0] + self.offset]


class Earlier(Begun):
    gain = 0.3

    def __init__(self):
        self.gain = 0.7


class Counted(Earlier):
    def start(self, rng):
        self.gain += 0.4
        return [0.0]


class Drawn(Begun):
    def start(self, rng):
        self.gain = rng.uniform(0.05, 0.15)
        return [0.0]


class Shared(Begun):
    calls = [0]

    def derivative(self, t, x, u, p):
        self.calls[0] += 1
        return super().derivative(t, x, u, p)


class Told(Begun):
    """A gain that is what it is called with: 1.1 of `Counted`, 0.1 of all others."""

    def __init__(self, gain=0.1):
        self.given = gain

    def start(self, rng):
        return [0.0]

    def derivative(self, t, x, u, p):
        return [self.given * u[0] - 0.01 * x[0]]


@pytest.mark.parametrize(
    ("kind", "gain", "is_fast"),
    [(Begun, 0.1, True), (Earlier, 0.1, True), (Counted, 1.1, True), (Shared, 0.1, False)],
)
def test_what_a_start_sets_is_what_equations_read(kind, gain, is_fast):
    heater = text("e = error of T", "u = e * 2", "drive power = u", period="1 s")
    asked = {"reference": {"T": 100.0}, "duration": 200.0}
    plant = find_plant(kind())
    assert is_traced(plant) == is_fast
    wanted = simulate(heater, Told(gain), **asked).outputs["T"]
    for _ in range(2):
        assert simulate(heater, plant, **asked).outputs["T"].tolist() == wanted.tolist()


def test_what_a_start_draws_is_drawn_for_each_run():
    heater = text("e = error of T", "u = e * 2", "drive power = u", period="1 s")
    assert not is_traced(Drawn())
    runs = [
        simulate(heater, Drawn(), reference={"T": 100.0}, options=Options(seed=seed)).final[0]
        for seed in (1, 2, 1)
    ]
    assert runs[0] == runs[2] != runs[1]


@pytest.mark.slow
def test_a_phase_portrait_begins_a_plant_before_it_moves_it():
    class Started(Plain):
        def start(self, rng):
            self.begun = True
            return super().start(rng)

        def derivative(self, t, x, u, p):
            assert self.begun
            return super().derivative(t, [float(value) for value in x], u, p)

    plain = phase_portrait(SERVO, Plain(find_plant("motor")), duration=0.05)
    started = phase_portrait(SERVO, Started(find_plant("motor")), duration=0.05)
    assert [p.tolist() for p in started.paths] == [p.tolist() for p in plain.paths]
    assert len({tuple(path[0]) for path in plain.paths}) > 1


def test_ports_that_are_missing_are_told():
    with pytest.raises(SourceError, match="no drive 'voltage'") as found:
        simulate(SERVO, find_plant("ball-and-beam"))
    assert "--connect voltage=angle_rate" in found.value.hint
    with pytest.raises(SourceError, match=r"pd measures joint1\.position, which the motor"):
        simulate(controller("pd"), find_plant("motor"))
    with pytest.raises(SourceError, match=r"partner .base. \(acdid\) measures joint1.position"):
        simulate(
            text("u = partner base", "drive voltage = u", head=("partner base = acdid",)),
            find_plant("motor"),
        )


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"inputs": {}}, "has no inputs"),
        ({"states": {}}, "has no states"),
        ({"derivative": None}, "has no equations"),
        ({"outputs": {"a": Port(), "b": Port()}}, "has 2 outputs and 1 states"),
        ({"outputs": {"a": Port(rate_of="b")}}, "'b' is not an output"),
    ],
)
def test_an_incomplete_plant_is_refused(changes, message):
    whole = {"inputs": {"u": Port()}, "outputs": {"a": Port()}, "states": {"a": "1"},
             "derivative": lambda self, t, x, u, p: [0.0], "name": "half"}  # fmt: skip
    plant = type("Half", (Plant,), {**whole, **changes})()
    with pytest.raises(PlantError, match=message):
        interface_of(plant)


def test_a_failure_in_a_plant_is_one_sentence():
    class Broken(Plant):
        name = "broken"
        inputs = {"voltage": Port()}
        outputs = {"position": Port()}
        states = {"position": "1"}

        def derivative(self, t, x, u, p):
            return [1.0 / (0.005 - 0.005 * round(t / 0.005))] if t > 0.004 else [0.0]

    with pytest.raises(PlantError, match=r"plant broken failed: .*ZeroDivisionError"):
        simulate(SERVO, Broken(), duration=0.1)


@pytest.mark.parametrize(
    ("late", "message"),
    [
        ({"derivative": None}, "derivative returns nothing"),
        ({"derivative": []}, "derivative returns 0 numbers for 1 states"),
        ({"derivative": ["x"]}, "derivative returns 'x' for 'position', not a number"),
        ({"measure": 3}, "measure returns 3, not a list"),
        ({"step": [1.0, 2.0]}, "step returns 2 numbers for 1 states"),
    ],
)
def test_what_a_plant_returns_later_is_said_with_its_line(late, message):
    what, wrong = next(iter(late.items()))

    def equation(self, t, x, u, p, dt=1.0):
        return wrong if t > 0.004 else [0.0]

    whole = {
        "name": "late", "inputs": {"voltage": Port()}, "outputs": {"position": Port()},
        "states": {"position": "1"}, "derivative": lambda self, t, x, u, p: [0.0],
    }  # fmt: skip
    plant = type("Late", (Plant,), {**whole, what: equation})()
    line = equation.__code__.co_firstlineno
    with pytest.raises(PlantError, match=rf"test_any_plant.py:{line}: plant late: {message}"):
        simulate(SERVO, plant, duration=0.1)


@pytest.mark.parametrize("sensor", [{"noise": -1}, {"resolution": math.nan}, {"delay": math.inf}])
def test_a_sensor_out_of_range_is_refused(sensor):
    with pytest.raises(PlantError, match="out of range"):
        Sensor(**sensor)


def test_rates_that_are_none_and_wrong_sides_are_refused():
    plant = find_plant("motor")
    for options, message in (
        (Options(sensors={"position": Sensor(difference=0.0)}), "not the rate of another"),
        (Options(sensors={"voltage": Sensor()}), "is an input"),
        (Options(loads={"position": Signal("step", (1.0,))}), "is an output"),
        (Options(sensors={"speed": Sensor()}), "no port 'speed'"),
    ):
        with pytest.raises(PlantError, match=message):
            simulate(SERVO, plant, options=options)
    with pytest.raises(PlantError, match="out of range"):
        simulate(SERVO, plant, duration=1e9)


# --- A file is read again when its text is another ---


def test_a_run_of_a_file_counts_what_the_file_says_now(tmp_path):
    path = tmp_path / "servo.frb"
    written = shipped("servo.frb").read_text()
    bits = []
    for content in (written, written, written.replace("gain G_u  = 4.5", "gain G_u  = 3.5")):
        path.write_text(content)
        os.utime(path, ns=(1, 1))  # a clock that stands: the content counts
        bits.append(simulate(path, "motor").error_matrix.tobytes())
    assert bits[0] == bits[1] != bits[2]
