"""Maps of starts: what is proved comes to rest, what is refuted is lost."""

from __future__ import annotations

import copy
import math
import pickle
import re
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fuzzyarm
from fuzzyarm.base.errors import UsageError
from fuzzyarm.plant import find_plant
from fuzzyarm.proof.claim.problem import ClaimError, LoopProblem, LoopProofError
from fuzzyarm.proof.claim.text import problem_of
from fuzzyarm.proof.loop import StartMap, read_claim
from fuzzyarm.proof.loop.algebra import Zonotopes
from fuzzyarm.proof.loop.cover import Cover
from fuzzyarm.proof.loop.enclosure import Intervals
from fuzzyarm.proof.loop.follower import Box, Nearness
from fuzzyarm.proof.loop.map_search import MapSearch, _read_row, _remaining, map_starts
from fuzzyarm.proof.loop.planes import RulePlanes
from fuzzyarm.proof.loop.pool import Pool, _Swarm
from fuzzyarm.proof.loop.runs import run_of
from fuzzyarm.proof.loop.start_map import MappedBox
from fuzzyarm.proof.loop.symmetry import is_odd
from fuzzyarm.proof.loop.zonotope import Forms
from fuzzyarm.proof.stop import Stop
from fuzzyarm.requests.journal import JournalError
from fuzzyarm.requests.prove import ProveRequest

WINDOW = "position in 0.25 .. 0.5, velocity in 0 .. 2"

SERVO = fuzzyarm.shipped("servo.frb")

CLIFF = """from fuzzyarm.plant import Plant, Port


class Cliff(Plant):
    name = "cliff"
    inputs = {"push": Port("N", -1.0, 1.0)}
    outputs = {"y": Port("m", -4.0, 4.0, bound=10.0)}
    states = {"y": "m"}
    duration = 20.0

    def derivative(self, t, x, u, p):
        return [0.5 * x[0] + u[0]]
"""


@pytest.fixture(scope="module")
def servo() -> StartMap:
    return fuzzyarm.prove(SERVO, plant="motor", map=True, over=WINDOW, budget=60.0)


def _motor_step(x: np.ndarray, voltage: np.ndarray) -> np.ndarray:
    """One period of the motor, by its matrix exponential written out as a series."""
    inertia, friction, torque, resistance, inductance = 0.01, 0.02, 0.35, 2.0, 0.004
    a = np.array(
        [
            [0.0, 1.0, 0.0, 0.0],
            [0.0, -friction / inertia, torque / inertia, 0.0],
            [0.0, -torque / inductance, -resistance / inductance, 1.0 / inductance],
            [0.0, 0.0, 0.0, 0.0],
        ]
    )
    total, term = np.eye(4), np.eye(4)
    for k in range(1, 30):
        term = term @ a * (0.001 / k)
        total = total + term
    return x @ total[:3, :3].T + voltage[:, None] * total[:3, 3]


@pytest.mark.slow
@pytest.mark.parametrize("again", [copy.deepcopy, lambda found: pickle.loads(pickle.dumps(found))])
def test_a_map_is_a_value(servo: StartMap, again: Callable[[StartMap], StartMap]) -> None:
    assert again(servo) == servo


def test_a_map_fills_its_window(servo: StartMap) -> None:
    assert servo.share("proved") == pytest.approx(1.0)
    shares = sum(servo.share(verdict) for verdict in ("proved", "refuted", "open"))
    assert shares == pytest.approx(1.0, abs=1e-12)
    assert servo.settled == servo.settled_proved > 0


def test_runs_from_proved_boxes_are_in_the_region_when_it_says(servo: StartMap) -> None:
    generator = np.random.default_rng(2)
    rules = fuzzyarm.load_rulebase(fuzzyarm.shipped("pd7.frb"))
    boxes = [box for box in servo.boxes if box.verdict == "proved"]
    starts, ends = [], []
    for box in boxes:
        low, high = np.array(box.low), np.array(box.high)
        shares = np.vstack([generator.random((2, 2)), [[0, 0], [0, 1], [1, 0], [1, 1]]])
        starts += [*(low + shares * (high - low))]
        ends += [box.periods] * len(shares)
    x = np.column_stack([np.array(starts), np.zeros(len(starts))])
    periods = np.array(ends)
    most = np.array([servo.region[name][1] for name in ("position", "velocity", "current")])
    for period in range(periods.max() + 1):
        arrived = x[periods == period]
        assert (np.abs(arrived) <= most).all()
        inputs = {"e": np.clip(-16 * x[:, 0], -6, 6), "ce": np.clip(-0.7 * x[:, 1], -6, 6)}
        u = np.asarray(fuzzyarm.infer(rules, inputs)["u"])
        x = _motor_step(x, np.clip(4.5 * u, -24.0, 24.0))


@pytest.mark.slow
def test_a_run_beyond_the_bound_refutes_and_a_loop_that_diverges_is_never_proved(
    tmp_path: Path,
) -> None:
    (tmp_path / "cliff.py").write_text(CLIFF)
    (tmp_path / "hold.frb").write_text(
        'controller hold "a push against the fall"\n\nperiod 10 ms\n\n'
        "axis a\n  e = error of y\n  p = e * 2\n  drive push = p\n"
    )
    plant = find_plant(str(tmp_path / "cliff.py"))
    found = fuzzyarm.prove(tmp_path / "hold.frb", plant=plant, map=True, budget=5.0)
    # y' = y/2 + u with |u| ≤ 1 comes back from |y| < 2 and from nowhere else.
    for box in found.boxes:
        near, far = min(map(abs, (*box.low, *box.high))), max(map(abs, (*box.low, *box.high)))
        if box.verdict == "proved":
            assert far <= 2.0
        if box.verdict == "refuted":
            assert far >= 2.0
            assert near >= 1.9
    assert found.share("proved") >= 0.4
    assert found.share("refuted") >= 0.4


@pytest.mark.slow
def test_a_limit_that_some_boxes_reach_holds_no_integral_of_the_others() -> None:
    """A form of a box beside one at the limit had an excess of a rounding, and never arrived."""
    numbers = Zonotopes(2, RulePlanes)
    numbers.count = 1
    demand = Forms.between([1.0, 11.0], [2.0, 13.0]).with_symbols(1, [0])
    moved = numbers.excess(numbers.limit(demand, 0.0, 12.0), demand, 0.0, 12.0).bounds
    assert (moved.low[0], moved.high[0]) == (0.0, 0.0)
    assert moved.low[1] <= -1.0
    found = fuzzyarm.prove(
        fuzzyarm.shipped("tanks.frb"), "stable at level2 = 0.2", plant="tanks", map=True,
        budget=60.0, over={"level1": (0.1, 0.13), "level2": (0.1, 0.13)},
    )  # fmt: skip
    assert found.share("proved") == pytest.approx(1.0)
    assert found.settled == found.settled_proved == 400


@pytest.mark.parametrize(
    ("box", "verdict", "periods"),
    [
        ("0 1", "proved", "²"), ("0 1", "proved", "-1"), ("0 1", "proved", "9" * 10),
        ("1 1", "proved", "1"), ("0 inf", "proved", "1"), ("0 1", "open", "1"),
    ],
)  # fmt: skip
def test_a_row_that_is_no_box_of_a_journal_is_refused(box: str, verdict: str, periods: str) -> None:
    assert _read_row(["0", "1", "proved", "7", ""]) == MappedBox((0.0,), (1.0,), "proved", 7)
    with pytest.raises(ValueError, match=r"^$"):
        _read_row([*box.split(), verdict, periods, ""])


def test_what_is_left_of_a_box() -> None:
    whole = Box((0.0, 0.0), (1.0, 1.0), (0, 0))
    done = [
        MappedBox((0.0, 0.0), (1.0, 0.5), "proved", 1),
        MappedBox((0.5, 0.5), (1.0, 1.0), "proved", 1),
    ]
    assert [(box.low, box.high) for box in _remaining(whole, done)] == [((0.0, 0.5), (0.5, 1.0))]
    assert _remaining(whole, [MappedBox(whole.low, whole.high, "proved", 1)]) == []
    for more in (((0.0, 0.0), (1.0, 1.0)), ((0.75, 0.5), (1.0, 1.0)), ((0.1, 0.6), (0.2, 0.7))):
        with pytest.raises(LoopProofError, match="overlap"):
            _remaining(whole, [*done, MappedBox(*more, "proved", 1)])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["pd7", "balance", "roompi"])
def test_planes_of_cells_hold_all_values(name: str) -> None:
    rules = fuzzyarm.load_rulebase(fuzzyarm.shipped(f"{name}.frb"))
    output = rules.outputs[0].name
    grid = RulePlanes(rules, output).grid
    assert grid is not None
    generator = np.random.default_rng(1)
    low, high = grid.low, grid.high
    for size in (0.003, 0.05, 0.4, 3.0):
        centre = generator.uniform(1.4 * low, 1.4 * high, (150, 2))
        sides = generator.normal(size=(6, 2, 150)) * (high - low)[:, None] * size / 10
        found = grid.bands(centre.T, sides)
        assert found is not None
        for k in range(len(centre)):
            shares = generator.uniform(-1.0, 1.0, (60, 6))
            shares[:30] = np.sign(shares[:30])
            points = centre[k] + shares @ sides[:, :, k]
            inside = np.clip(points, low, high)  # `outside clamp`
            inputs = {v.name: inside[:, i] for i, v in enumerate(rules.inputs)}
            values = np.asarray(fuzzyarm.infer(rules, inputs)[output])
            gaps = values - points @ found.slopes[k]
            slack = 1e-12 * (1.0 + np.abs(points).max())
            assert gaps.min() >= found.low[k] - slack
            assert gaps.max() <= found.high[k] + slack


@pytest.mark.parametrize("low", [0.25, 0.3, 1e-3, -0.7])
def test_a_set_halved_on_its_way_holds_all_starts_of_its_box(low: float) -> None:
    problem = loop_of("servo.frb", "motor", f"position in {low!r} .. {low + 1e-9!r}")
    nothing = np.zeros(1, dtype=np.int64)
    pool = Pool(problem, lambda *_: Nearness(np.zeros(1), np.zeros((1, 1)), np.zeros(1)), 9, Stop())
    states, constants = pool.follower.start_forms([pool.follower.first])
    swarm = _Swarm(
        states, constants, {}, [pool.follower.first], nothing, nothing, np.ones((1, 1)), nothing,
        np.ones(1),
    )  # fmt: skip
    for _ in range(3):
        swarm = pool._halved(swarm)
        # By the symbol of the start: the remainder is rounding at the sample of the cut.
        for k, box in enumerate(swarm.boxes):
            centre = Fraction(swarm.states.centre[0, k])
            far = Fraction(abs(swarm.states.parts[0, 0, k]))
            assert centre - far <= Fraction(box.low[0]) < Fraction(box.high[0]) <= centre + far


def test_a_window_names_states_and_has_a_width() -> None:
    with pytest.raises(ClaimError, match="no state 'posiion'"):
        fuzzyarm.prove(SERVO, plant="motor", map=True, over="posiion in 0 .. 1")
    with pytest.raises(ClaimError, match="not a window"):
        fuzzyarm.prove(SERVO, plant="motor", map=True, over="position in 1 .. 1")


def test_options_of_a_map_go_with_it() -> None:
    request = ProveRequest(files=(str(SERVO),), plant="motor", stable=True, over="x in 0 .. 1")
    with pytest.raises(UsageError, match="--over goes with --map"):
        fuzzyarm.prove(request)


def test_a_cover_holds_only_what_is_proved() -> None:
    generator = np.random.default_rng(5)
    window = Box((-1.3, 0.1), (0.7, 9.1), (0, 0))
    boxes, parts = [window], []
    for _ in range(300):
        box = boxes.pop(int(generator.integers(len(boxes))))
        if sum(box.halvings) > 9:
            parts.append(box)
        else:
            boxes += box.halves(int(generator.integers(2)))
    cover = Cover(window)
    proved = [*parts, *boxes[::2]]
    for box in proved:
        cover.add(box.low, box.high)
    lows = np.array([box.low for box in proved])
    highs = np.array([box.high for box in proved])
    low = generator.uniform(window.low, window.high, (400, 2)).T
    asked = Intervals(low, low + generator.uniform(0.0, 0.3, (2, 400)))
    held = cover.holds(asked)
    assert 0 < held.sum() < len(held)
    for k in np.flatnonzero(held):
        at = generator.uniform(asked.low[:, k], asked.high[:, k], (20, 2))
        within = (lows <= at[:, None]) & (at[:, None] <= highs)
        assert within.all(axis=2).any(axis=1).all()


TIPPING = """
from fuzzyarm.plant import Parameter, Plant, Port

class Tipping(Plant):
    axis = "a"
    inputs = {"u": Port("N", -1, 1)}
    outputs = {"x": Port("m", -3, 3, bound=20), "w": Port("m", -1, 1, bound=100)}
    states = {"x": "m", "w": "m"}
    parameters = {"k": Parameter(1.0)}
    longest_step = 0.01

    def derivative(self, t, x, u, p):
        return [p[0] * x[0] + u[0], -x[1]]
"""


@pytest.fixture
def tipping(tmp_path: Path) -> dict[str, Any]:
    """A map of an odd loop that is lost from beyond 1: x' = x + u with u of at most 1 in size."""
    law = "period 10 ms\naxis a\n  e = error of x\n  drive u = e * 2, within -1 .. 1\n"
    (tmp_path / "tip.frb").write_text(f"controller tip\n{law}")
    (tmp_path / "tip.py").write_text(TIPPING)
    plant, window = str(tmp_path / "tip.py"), "x in -0.9 .. 0.9, w in -1 .. 1"
    return {"thing": tmp_path / "tip.frb", "plant": plant, "map": True, "over": window}


@pytest.mark.slow
def test_a_journal_is_gone_on_with(tmp_path: Path, tipping: dict[str, Any]) -> None:
    path = tmp_path / "map.csv"
    asked = {**tipping, "budget": 60.0, "resume": str(path)}
    fuzzyarm.prove(**asked)
    lines = path.read_text().splitlines()
    path.write_text("\n".join(lines[:12]) + "\n")  # as an interruption leaves it
    # Of an odd loop a box stands for its opposite: each counts once.
    assert fuzzyarm.prove(**asked).share("proved") == pytest.approx(1.0)
    assert path.read_text().splitlines()[:12] == lines[:12]
    with pytest.raises(JournalError):
        fuzzyarm.prove(**{**asked, "over": "x in 0 .. 1"})
    for row in (re.sub(r"proved,\d+,", "proved,999,", lines[11]), f"{lines[11][:-1]}g"):
        path.write_text("\n".join([*lines[:11], row, *lines[12:]]) + "\n")
        with pytest.raises(JournalError):
            fuzzyarm.prove(**asked)


@pytest.mark.slow
def test_workers_and_any_executor_find_the_same_shares(tipping: dict[str, Any]) -> None:
    class Counting(ThreadPoolExecutor):
        count = 0

        def submit(self, *words: Any, **more: Any) -> Any:
            self.count += 1
            return super().submit(*words, **more)

    with Counting(2) as executor:
        found = fuzzyarm.prove(**tipping, budget=60.0, executor=executor)
        assert executor.count > 1
        assert executor.submit(int, "1").result() == 1  # it is the caller's: not ended
    for each in (found, fuzzyarm.prove(**tipping, budget=60.0, workers=2)):
        assert each.share("proved") == pytest.approx(1.0)


def test_a_map_is_of_one_value_of_each_parameter(tipping: dict[str, Any]) -> None:
    with pytest.raises(ClaimError, match="no interval of a parameter, as of k"):
        fuzzyarm.prove(**tipping, statement="stable with k in 0.9 .. 1.1")


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4, 5])
def test_a_cover_misses_the_smallest_box(dimensions: int) -> None:
    window = Box((-1.0,) * dimensions, (2.0,) * dimensions, (0,) * dimensions)
    cover, left = Cover(window), window
    for _ in range(8 * dimensions):  # all but a corner, in thin slices
        half, left = left.halves(0)
        cover.add(half.low, half.high)
    corner = Intervals(np.array(left.low)[:, None], np.array(left.high)[:, None])
    assert not cover.holds(corner)[0]
    cover.add(left.low, left.high)
    assert cover.holds(corner)[0]
    cover.add((0.0,) * dimensions, (0.3,) * dimensions)  # no half of a half: not taken in


@pytest.mark.slow
def test_what_is_proved_is_a_goal_where_the_loop_remembers_nothing() -> None:
    """Pole and cart, in a small window: own dynamics and rules, all runs come to rest."""
    window = {"x": (0.4, 0.6), "v": (0.0, 0.1), "theta": (0.0, 0.05), "omega": (0.0, 0.1)}
    found = fuzzyarm.prove(
        fuzzyarm.shipped("cartpole.frb"), plant="cartpole", map=True, over=window, budget=30.0
    )
    assert found.share("proved") > 0.9
    # The way into the next box says nothing about that into the region.
    assert math.isnan(found.longest)
    assert "in the region around rest or a box proved before" in str(found)
    boxes = [box for box in found.boxes if box.verdict == "proved"]
    states = np.array([end for box in boxes for end in (box.low, box.high)])
    for _ in range(1200):
        states = _cartpole_period(states)
    assert np.abs(states).max() < 1e-3


def _cartpole_period(states: np.ndarray) -> np.ndarray:
    """20 ms of the pole under its rules: 2/3 of lean and fall while neither is large."""
    x, v, theta, omega = states.T
    lean, fall = 6.0 * theta + 0.3 * x, 1.5 * omega + 0.6 * v
    assert max(np.abs(lean).max(), np.abs(fall).max()) < 0.75
    return _cartpole_step(states, np.clip(10.0 * 2.0 / 3.0 * (lean + fall), -10.0, 10.0))


def loop_of(controller: str, plant: str, start: str) -> LoopProblem:
    text = fuzzyarm.load_controller(fuzzyarm.shipped(controller))
    return problem_of(text, read_claim(f"stable from {start}", plant))


def test_an_odd_loop_is_told_from_one_that_is_nearly_odd() -> None:
    window = "position in -1 .. 1, velocity in -2 .. 2"
    assert is_odd(loop_of("servo.frb", "motor", window))
    assert is_odd(loop_of("ball-and-beam.frb", "ball-and-beam", "position in -0.1 .. 0.1"))
    # Whose opposite starts are not all in the window, or that is driven to another place.
    assert not is_odd(loop_of("servo.frb", "motor", "position in -1 .. 1.5"))
    text = fuzzyarm.load_controller(fuzzyarm.shipped("servo.frb"))
    claim = read_claim(f"stable at position = 0.1 from {window}", "motor")
    assert not is_odd(problem_of(text, claim))
    loaded = read_claim(f"stable with T in 0 .. 0.1 from {window}", "motor")
    assert not is_odd(problem_of(text, loaded))
    # Terms of its output are opposite but for the last bit.
    assert not is_odd(loop_of("cartpole.frb", "cartpole", "theta in -0.1 .. 0.1"))


@pytest.mark.parametrize(
    "line",
    ["q = p * p\n  drive push = q", "drive push = p, within -1 .. 0.5", "drive push = p + 0.1"],
)
def test_a_line_that_is_not_odd_makes_the_loop_not_odd(line: str, tmp_path: Path) -> None:
    (tmp_path / "cliff.py").write_text(CLIFF)
    path = tmp_path / "c.frb"
    text = "controller c\nperiod 10 ms\naxis a\n  e = error of y\n  p = e * 2\n  {}\n"
    plant = str(tmp_path / "cliff.py")
    for last, odd in (("drive push = p", True), (line, False)):
        path.write_text(text.format(last))
        claim = read_claim("stable from y in -1 .. 1", plant)
        problem = problem_of(fuzzyarm.load_controller(path), claim, plant=find_plant(plant))
        assert is_odd(problem) == odd


@pytest.mark.parametrize(
    ("told", "odd"),
    [
        ("no-rule 0", True), ("no-rule error", True), ("no-rule 0.3", False),
        ("no-rule hold", False), ("no-rule 0\nterm s Q: triangle 0.1 0.2 0.3", False),
    ],
)  # fmt: skip
def test_rules_are_odd_where_none_fires_too(told: str, odd: bool, tmp_path: Path) -> None:
    (tmp_path / "cliff.py").write_text(CLIFF)
    path, plant = tmp_path / "c.frb", str(tmp_path / "cliff.py")
    rule = "rule if s is Q then p is P\n" if " Q" in told else ""
    path.write_text(
        "controller c\nperiod 10 ms\naxis a\n  e = error of y\n  p = rules r(e)\n"
        "  drive push = p\nrulebase r\ninput s -1 .. 1\noutput p -1 .. 1\n"
        "term s N: triangle -1 -0.5 0\nterm s P: triangle 0 0.5 1\n"
        "term p N: singleton -1\nterm p P: singleton 1\n"
        "inference defuzzifier weighted-average, and min, outside clamp, "
        f"{told}\nrule if s is N then p is N\nrule if s is P then p is P\n{rule}"
    )
    claim = read_claim("stable from y in -1 .. 1", plant)
    problem = problem_of(fuzzyarm.load_controller(path), claim, plant=find_plant(plant))
    assert is_odd(problem) == odd


@pytest.mark.parametrize(
    ("plant", "start"), [("motor", {"position": 0.7, "velocity": -9.0}),
                         ("ball-and-beam", {"position": 0.12, "angle": -0.1})],
)  # fmt: skip
def test_runs_of_an_odd_loop_from_opposite_starts_are_opposite(
    plant: str, start: dict[str, float]
) -> None:
    name = "servo.frb" if plant == "motor" else f"{plant}.frb"
    window = ", ".join(f"{n} in {-abs(x)} .. {abs(x)}" for n, x in start.items())
    problem = loop_of(name, plant, window)
    assert is_odd(problem)
    one, two = (
        run_of(problem, {n: sign * start.get(n, 0.0) for n in problem.states}, {}, duration=0.5)
        for sign in (1.0, -1.0)
    )
    for name, course in one.outputs.items():
        assert np.allclose(course, -two.outputs[name], atol=1e-9 * (1 + np.abs(course).max()))


def _beam_rules() -> Any:
    """The rule base of the beam, by its centroid over a fine grid of its output."""
    y = np.linspace(-6.0, 6.0, 481)
    peaks = np.arange(-6.0, 7.0, 2.0)
    shapes = np.maximum(0.0, 1.0 - np.abs(y - peaks[:, None]) / 2.0)
    words = {word: k for k, word in enumerate(["NB", "NM", "NS", "ZE", "PS", "PM", "PB"])}
    rows = (
        "NB NB NB NM NS NS ZE,NB NM NM NM NS ZE PS,NB NM NS NS ZE PS PM,NB NM NS ZE PS PM PB,"
        "NM NS ZE PS PS PM PB,NS ZE PS PM PM PM PB,ZE PS PS PM PB PB PB"
    )
    told = [[words[word] for word in row.split()] for row in rows.split(",")]

    def value(e: np.ndarray, ce: np.ndarray) -> np.ndarray:
        one, two = (
            np.maximum(0.0, 1.0 - np.abs(np.clip(x, -6.0, 6.0)[:, None] - peaks) / 2.0)
            for x in (e, ce)
        )
        fired = np.zeros_like(one)
        for i, row in enumerate(told):
            for j, word in enumerate(row):
                fired[:, word] = np.maximum(fired[:, word], np.minimum(one[:, i], two[:, j]))
        heights = np.minimum(fired[:, :, None], shapes).max(axis=1)
        return np.asarray((heights * y).sum(axis=1) / heights.sum(axis=1))

    return value


@pytest.mark.slow
def test_runs_of_the_beam_from_proved_boxes_come_to_rest() -> None:
    window = "position in -0.03 .. 0.04, velocity in -0.08 .. 0.1, angle in -0.1 .. 0.1"
    found = map_starts(
        fuzzyarm.load_controller(fuzzyarm.shipped("ball-and-beam.frb")),
        read_claim(f"stable from {window}", "ball-and-beam"),
        MapSearch(budget=60.0, runs=0),
        plant=find_plant("ball-and-beam"),
    )
    boxes = [box for box in found.boxes if box.verdict == "proved"]
    assert found.share("proved") == pytest.approx(1.0)
    generator, rules = np.random.default_rng(4), _beam_rules()
    ends = np.array([(box.low, box.high) for box in boxes])
    picked = ends[generator.integers(len(ends), size=150)]
    x = picked[:, 0] + generator.integers(0, 2, (150, 3)) * (picked[:, 1] - picked[:, 0])

    def rates(x: np.ndarray, turn: np.ndarray) -> np.ndarray:
        gained = (x[:, 0] * turn**2 + 9.81 * np.sin(x[:, 2])) / 1.4
        return np.column_stack([x[:, 1], gained, turn])

    for _ in range(400):
        wanted = 0.12 * rules(-20.0 * x[:, 0], -8.0 * x[:, 1])
        turn = np.clip(12.0 * (wanted - x[:, 2]), -2.0, 2.0)
        a = rates(x, turn)
        b = rates(x + 0.005 * a, turn)
        c = rates(x + 0.005 * b, turn)
        x = x + 0.01 / 6.0 * (a + 2.0 * b + 2.0 * c + rates(x + 0.01 * c, turn))
        assert (np.abs(x[:, 0]) <= 0.5).all()
    assert (np.abs(x) <= 5e-3).all()


def _cartpole_step(x: np.ndarray, push: np.ndarray) -> np.ndarray:
    """One period of 20 ms, by two steps of Runge and Kutta's method."""

    def rates(x: np.ndarray) -> np.ndarray:
        sine, cosine = np.sin(x[:, 2]), np.cos(x[:, 2])
        force = (push + 0.05 * x[:, 3] ** 2 * sine) / 1.1
        angular = (9.8 * sine - cosine * force) / (0.5 * (4 / 3 - 0.1 * cosine**2 / 1.1))
        return np.column_stack([x[:, 1], force - 0.05 * angular * cosine / 1.1, x[:, 3], angular])

    for _ in range(2):
        a = rates(x)
        b = rates(x + 0.005 * a)
        c = rates(x + 0.005 * b)
        x = x + 0.01 / 6.0 * (a + 2.0 * b + 2.0 * c + rates(x + 0.01 * c))
    return x


@pytest.mark.slow
def test_runs_of_the_cartpole_from_proved_boxes_come_to_rest() -> None:
    window = "x in 0.9 .. 1.5, v in 0.2 .. 0.6, theta in 0.1 .. 0.15, omega in -0.2 .. 0.2"
    found = map_starts(
        fuzzyarm.load_controller(fuzzyarm.shipped("cartpole.frb")),
        read_claim(f"stable from {window}", "cartpole"),
        MapSearch(budget=40.0, runs=0),
        plant=find_plant("cartpole"),
    )
    boxes = [box for box in found.boxes if box.verdict == "proved"]
    assert found.share("proved") > 0.5
    assert found.share("proved") + found.share("open") == pytest.approx(1.0, abs=1e-9)
    generator, starts = np.random.default_rng(3), []
    corners = np.array(np.meshgrid(*[[0.0, 1.0]] * 4)).reshape(4, -1).T
    for box in boxes:
        low, high = np.array(box.low), np.array(box.high)
        starts += [*(low + np.vstack([corners, generator.random((8, 4))]) * (high - low))]
    x = np.array(starts)
    # The grid of the rules: a sum of two positions in steps of a half, within three steps.
    rows = np.clip(np.add.outer(np.arange(-2, 3), np.arange(-2, 3)), -3, 3) / 3.0
    for _ in range(1000):
        lean = np.clip(6.0 * x[:, 2] + 0.3 * x[:, 0], -1.0, 1.0)
        fall = np.clip(1.5 * x[:, 3] + 0.6 * x[:, 1], -1.0, 1.0)
        i, j = (np.minimum((2.0 * (s + 1.0)).astype(int), 3) for s in (lean, fall))
        p, q = 2.0 * (lean + 1.0) - i, 2.0 * (fall + 1.0) - j
        low = rows[i, j] * (1.0 - q) + rows[i, j + 1] * q
        high = rows[i + 1, j] * (1.0 - q) + rows[i + 1, j + 1] * q
        x = _cartpole_step(x, 10.0 * (low * (1.0 - p) + high * p))
    assert (np.abs(x) <= 1e-3).all()
