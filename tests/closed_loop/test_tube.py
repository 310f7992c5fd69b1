"""Tubes attacked: runs of `simulate` from anywhere in the starts never leave them."""

import copy
import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from budget import cases
from scipy.optimize import minimize

import fuzzyarm
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.control.loop.course import Options, Sensor
from fuzzyarm.control.loop.simulation import simulate
from fuzzyarm.plant import Plant, Port
from fuzzyarm.plant.own import find_plant
from fuzzyarm.plant.plant import with_parameters
from fuzzyarm.proof.claim.problem import LoopProofError, loop_problem
from fuzzyarm.proof.loop.enclosure import EnclosureError
from fuzzyarm.proof.loop.follower import Follower
from fuzzyarm.proof.loop.readings import UnenclosedError
from fuzzyarm.proof.loop.tube import Demand, tube

EXAMPLES = Path(__file__).parents[2] / "examples" / "closed_loop"

SLACK = 2e-6
"""Share of the width and size of a tube that the integrator of a run may be off; see below."""

LOOPS = {  # controller, plant, duration, starts, parameters, set points
    "single pendulum": (
        EXAMPLES / "single-pendulum.frb", EXAMPLES / "single_pendulum.py", 1.0,
        {"angle": (1.0, 1.175), "rate": (0.0, 0.2)}, {}, {},
    ),
    "tora": (
        EXAMPLES / "tora-reach.frb", EXAMPLES / "tora.py", 5.0,
        {"x1": (-0.77, -0.75), "x2": (-0.45, -0.43), "x3": (0.51, 0.54), "x4": (-0.3, -0.28)}, {},
        {"x3": -1.0},
    ),
    "cruise": (
        EXAMPLES / "acc.frb", EXAMPLES / "acc.py", 2.0,
        {"x_lead": (90, 110), "v_lead": (32, 32.2), "x_ego": (10, 11), "v_ego": (30, 30.2)},
        {"a_lead": (-2.2, -2.0)}, {},
    ),
    "servo": (
        "servo.frb", "motor", 0.04, {"position": (-0.05, 0.05), "velocity": (-0.1, 0.1)},
        {"J": (0.009, 0.011), "T": (-0.1, 0.1)}, {"position": 1.0},
    ),
    "tanks": (  # an integral that holds at the limits of its pump, a filtered rate
        "tanks.frb", "tanks", 8.0, {"level1": (0.1, 0.15), "level2": (0.1, 0.12)}, {},
        {"level2": 0.2},
    ),
    "heater": (  # an integral with bounds, a slew
        "heater.frb", "room", 400.0, {"temperature": (14, 16), "wall": (14, 16)},
        {"outside": (0.0, 5.0)}, {"temperature": 20.0},
    ),
    "cart-pole": (
        "cartpole.frb", "cartpole", 0.3, {"x": (-0.1, 0.1), "theta": (-0.1, 0.1)},
        {"m": (0.1, 0.12)}, {"x": 0.0},
    ),
    "ball and beam": (
        "ball-and-beam.frb", "ball-and-beam", 0.15, {"position": (0.1, 0.12)}, {},
        {"position": 0.0},
    ),
}  # fmt: skip


def problem_of(name, **changes):
    controller, plant, duration, start, parameters, set_point = LOOPS[name]
    path = controller if isinstance(controller, Path) else fuzzyarm.shipped(controller)
    facts = {"start": start, "parameters": parameters, "set_point": set_point, **changes}
    return loop_problem(fuzzyarm.load(path), find_plant(str(plant)), **facts), duration


def run(problem, duration, start, parameters, parts=16, sensors=None):
    """Return a run with steps so fine that its integrator is exact to what SLACK says."""
    plant = with_parameters(problem.plant, parameters)
    plant.start = lambda rng: [start[name] for name in plant.states]
    plant.longest_step = problem.period / parts
    label = problem.site.interface.label
    references = {
        label(port): value
        for port, value in problem.set_point.items()
        if not problem.site.interface.references[port].order
    }
    options = Options(sensors=sensors) if sensors else None
    return simulate(problem.text, plant, reference=references, duration=duration, options=options)


def chosen(generator, intervals, corner):
    return {
        name: float(generator.choice([low, high]) if corner else generator.uniform(low, high))
        for name, (low, high) in intervals.items()
    }


def excess(found, course):
    """Return how far a run is outside a tube, in shares of widths and sizes; negative inside."""
    worst = -np.inf
    for column, name in enumerate(found.ports):
        driven = name in course.drives
        values = course.drives[name] if driven else course.outputs[name]
        # Drives are held over a period that begins at the sample.
        low, high = (found.low, found.high) if driven else (found.low_at, found.high_at)
        low, high = low[: len(values), column], high[: len(values), column]
        width = high - low + np.maximum(np.abs(low), np.abs(high)) + 1e-3
        worst = max(worst, float((np.maximum(low - values, values - high) / width).max()))
    return worst


@pytest.fixture(scope="module")
def tubes():
    made = {}

    def find(name):
        if name not in made:
            made[name] = tube(*problem_of(name))
        return made[name]

    return find


@pytest.mark.slow
@pytest.mark.parametrize("name", LOOPS)
def test_no_run_leaves_the_tube(tubes, name):
    found = tubes(name)
    assert found.complete
    problem = found.problem
    generator = np.random.default_rng(2)
    for number in range(cases(8, 12500)):  # of eight loops: 64 and 100,000
        start = chosen(generator, problem.start, number % 2)
        parameters = chosen(generator, problem.parameters, number % 2)
        assert excess(found, run(problem, found.duration, start, parameters)) <= SLACK


@pytest.mark.parametrize("name", LOOPS)
def test_the_integrator_of_the_runs_is_as_exact_as_they_are_taken_to_be(name):
    problem, duration = problem_of(name)
    start = {key: low for key, (low, _) in problem.start.items()}
    parameters = {key: high for key, (_, high) in problem.parameters.items()}
    coarse, fine = (run(problem, duration, start, parameters, parts) for parts in (16, 32))
    for port, values in fine.outputs.items():
        size = np.abs(values).max() + 1e-3
        assert np.abs(values - coarse.outputs[port]).max() <= 0.1 * SLACK * size


@pytest.mark.slow
@pytest.mark.parametrize("name", ["single pendulum", "cruise", "tanks"])
def test_runs_pushed_to_the_border_stay_inside_and_come_near(tubes, name):
    found = tubes(name)
    problem = found.problem
    names = [key for key, (low, high) in problem.start.items() if low < high]
    column = {"single pendulum": 0, "cruise": 0, "tanks": 1}[name]
    low, high = found.low_at[-1, column], found.high_at[-1, column]
    reached = []
    for sign in (1.0, -1.0):
        for seed in range(cases(1, 60)):

            def cost(shares, sign=sign):
                start = {key: pair[0] for key, pair in problem.start.items()}
                for key, share in zip(names, np.clip(shares, 0, 1), strict=True):
                    a, b = problem.start[key]
                    start[key] = a + share * (b - a)
                middles = {k: 0.5 * (a + b) for k, (a, b) in problem.parameters.items()}
                course = run(problem, found.duration, start, middles)
                assert excess(found, course) <= SLACK
                value = course.outputs[found.ports[column]][-1]
                reached.append(value)
                return -sign * value

            begin = np.random.default_rng(seed).uniform(0.2, 0.8, len(names))
            minimize(cost, begin, method="Nelder-Mead", options={"maxfev": cases(25, 60)})
    # Not next to nothing of the tube is reached: it is no idle bound.
    assert max(reached) - min(reached) >= {"tanks": 0.05}.get(name, 0.35) * (high - low)


@pytest.mark.slow
def test_a_tube_that_is_too_narrow_is_left(tubes):
    found = tubes("single pendulum")
    narrow = copy.copy(found)
    for low, high in (("low", "high"), ("low_at", "high_at")):
        a, b = getattr(found, low), getattr(found, high)
        object.__setattr__(narrow, low, a + 0.3 * (b - a))
        object.__setattr__(narrow, high, b - 0.3 * (b - a))
    generator = np.random.default_rng(1)
    problem = found.problem
    courses = (run(problem, 1.0, chosen(generator, problem.start, True), {}) for _ in range(6))
    assert max(excess(narrow, course) for course in courses) > 0.02


def test_the_single_pendulum_is_where_it_is_to_be(tubes):
    found = tubes("single pendulum")
    assert found.holds(Demand("angle", 0.0, 1.0, 0.5, 1.0))
    assert not found.holds(Demand("angle", 0.0, 1.0, 0.0, 1.0))
    at_half = found.bounds("angle", 0.5, 0.5)
    assert 0.70 < at_half.low < 0.72
    assert 0.94 < at_half.high < 0.955
    # Between the samples too: whoever looks there sees nothing outside.
    problem = found.problem
    plant = copy.copy(problem.plant)
    plant.start = lambda rng: [1.175, 0.2]
    finest = simulate(problem.text, plant, duration=1.0)
    assert found.bounds("angle", 0.0, 0.05).high >= max(finest.outputs["angle"][:2])


@pytest.mark.slow
def test_demands_are_met_by_halving():
    problem, _ = problem_of("single pendulum", start={"angle": (0.6, 1.175), "rate": (-0.4, 0.4)})
    whole = tube(problem, 0.5)
    bound = whole.bounds("angle", 0.5, 0.5)
    told = []
    demand = Demand("angle", bound.low + 0.01, bound.high - 0.01, 0.5, 0.5)
    found = tube(
        problem, 0.5, demands=[demand], budget=60, progress=lambda *facts: told.append(facts)
    )
    assert whole.boxes == 1 < found.boxes
    assert found.holds(demand)
    assert not found.open
    assert told[-1] == (pytest.approx(1.0), 0)


@pytest.mark.slow
def test_what_is_not_proved_is_said_with_its_box():
    problem, _ = problem_of("single pendulum")
    demand = Demand("angle", 0.0, 0.5, 0.5, 0.5)  # which is false
    found = tube(problem, 0.5, demands=[demand], most=3)
    assert found.open
    assert all(set(box) == {"angle", "rate"} for box in found.open)
    assert found.complete
    assert not found.holds(demand)


@pytest.mark.slow
def test_an_unstable_loop_has_no_tube_for_long():
    text = fuzzyarm.load(EXAMPLES / "single-pendulum.frb")

    class Turned(type(find_plant(str(EXAMPLES / "single_pendulum.py")))):
        def derivative(self, t, x, u, p):
            return [x[1], 2.0 * math.sin(x[0]) - 8.0 * u[0]]

    problem = loop_problem(text, Turned(), start={"angle": (0.0, 0.1), "rate": (0.0, 0.1)})
    found = tube(problem, 1.5, demands=[Demand("angle", -1.0, 1.0, 0.0, 1.5)], most=1, budget=600)
    assert found.open


@pytest.mark.slow
def test_sensors_with_steps_and_delays_are_errors_and_states():
    sensors = {"angle": Sensor(resolution=0.01, delay=0.05), "rate": Sensor(resolution=0.02)}
    problem, _ = problem_of("single pendulum", sensors=sensors)
    found = tube(problem, 0.6)
    assert found.complete
    exact = tube(problem_of("single pendulum")[0], 0.6)
    assert found.high_at[-1, 0] > exact.high_at[-1, 0]
    generator = np.random.default_rng(6)
    for number in range(cases(15, 1500)):
        start = chosen(generator, problem.start, number % 2)
        assert excess(found, run(problem, 0.6, start, {}, sensors=sensors)) <= SLACK


def test_what_cannot_be_traced_or_read_is_refused_by_name():
    class Drawn(Plant):
        name = "drawn"
        inputs = {"torque": Port("N m")}
        outputs = {"angle": Port("rad"), "rate": Port("rad/s")}
        states = {"angle": "rad", "rate": "rad/s"}

        def derivative(self, t, x, u, p):
            return [x[1], u[0] if x[0] > 0 else -u[0]]

    class Rounded(Drawn):
        name = "rounded"

        def derivative(self, t, x, u, p):
            return [x[1], u[0] + math.atan2(x[0], 2.0)]

    text = fuzzyarm.load(EXAMPLES / "single-pendulum.frb")
    with pytest.raises(LoopProofError, match="drawn"):
        tube(loop_problem(text, Drawn()), 0.1)
    with pytest.raises(UnenclosedError, match="atan2"):
        tube(loop_problem(text, Rounded()), 0.1)


def test_a_question_beyond_the_tube_is_refused(tubes):
    with pytest.raises(EnclosureError, match="from 0 to 1 s"):
        tubes("single pendulum").bounds("angle", 0.5, 2.0)


@pytest.mark.slow
def test_once_time_is_over_no_box_is_followed_alone(monkeypatch):
    text = fuzzyarm.load(fuzzyarm.shipped("servo.frb"))
    problem = loop_problem(text, find_plant("motor"), start={"position": (0.0, 0.1)})
    batches = []
    follow = Follower.follow

    def told(self, boxes, *, whole=True):
        batches.append(len(boxes))
        return follow(self, boxes, whole=whole)

    monkeypatch.setattr(Follower, "follow", told)
    found = tube(problem, 0.01, boxes=[128], budget=0.0)
    assert batches == [64, 64]
    assert not found.complete
    assert len(found.open) == 128


JUMPING = """
import math
from fuzzyarm.plant import Plant, Port
from fuzzyarm.symbolic import op


class Jumping(Plant):
    inputs = {"u": Port("V", -4.0, 4.0)}
    outputs = {"x": Port("m", -50.0, 50.0)}
    states = {"x": "m"}

    def derivative(self, t, x, u, p):
        return [RATE]
"""


def run_of_rate(rate: str, x: float) -> list[float]:
    """Follow x' = rate for a second by small steps, u = limit(-1.5 x) held for 50 ms."""
    code = compile(rate, "rate", "eval")
    names = {"math": math, "op": SimpleNamespace(where=lambda yes, a, b: a if yes else b)}
    course = [x]
    for k in range(20_000):
        if k % 1000 == 0:
            u = min(max(-1.5 * x, -3.0), 3.0)
        x += 5e-5 * float(eval(code, {**names, "x": [x], "u": [u]}))
        course.append(x)
    return course


@pytest.mark.parametrize(
    ("rate", "start"),
    [
        ("5.0 * (x[0] > 0.1) + 0.0 * u[0]", 0.3),
        ("-x[0] + u[0] + 5.0 * (x[0] > 0.1)", 0.4),
        ("-x[0] + u[0] + 5.0 * (x[0] >= 0.1)", 0.4),
        ("-x[0] + u[0] + math.floor(10.0 * x[0])", 0.4),
        ("-x[0] + u[0] + math.ceil(10.0 * x[0])", 0.4),
        ("-x[0] + math.trunc(10.0 * u[0] + 0.5) / 10.0", 0.3),
        ("-x[0] + u[0] + 5.0 * ((x[0] > 0.1) & (x[0] < 9.0))", 0.4),
        ("-x[0] + u[0] + op.where(x[0] > 0.1, 5.0, 0.0)", 0.4),
        ("-x[0] + u[0] + op.where(u[0] < -0.3, 5.0, x[0])", 0.4),
        ("-x[0] + u[0] + 5.0 * (u[0] < -0.3)", 0.4),
        ("1.0 * (x[0] > 0.1)", 0.3),
        ("1.0 + math.fmod(x[0] + 5.0, 0.7) + 0.0 * u[0]", 0.3),
        ("math.fmod(x[0] + 5.0, 0.7) - x[0] + u[0]", 0.9),
    ],
)
def test_what_a_plant_that_jumps_does_is_not_that_of_the_origin(tmp_path, rate, start):
    """Slopes do not see a jump: between two of them a rate looks linear."""
    (tmp_path / "jumping.py").write_text(JUMPING.replace("RATE", rate))
    (tmp_path / "c.frb").write_text(
        "controller c\nperiod 50 ms\naxis s\n  e = error of x\n"
        "  drive u = e * 1.5, within -3 .. 3\n"
    )
    course = run_of_rate(rate, start)
    low, high = min(course), max(course)
    problem = loop_problem(
        fuzzyarm.load_controller(str(tmp_path / "c.frb")),
        find_plant(str(tmp_path / "jumping.py")),
        start={"x": (start, start)},
    )
    demand = Demand("x", low + 0.02 * (high - low), high - 0.02 * (high - low), 0.0, 1.0)
    try:
        found = tube(problem, 1.0, demands=[demand], budget=5.0)
    except FuzzyarmError:
        return  # refused by name
    assert found.open or not found.complete
    if found.complete:
        reached = found.bounds("x", 0.0, 1.0)
        assert reached[0] <= low + 1e-3
        assert reached[1] >= high - 1e-3
        end = found.bounds("x", 1.0, 1.0)
        assert end[0] - 1e-2 <= course[-1] <= end[1] + 1e-2
