"""Claims that tubes decide, alone or as far as a region; what they prove is attacked by runs."""

import math
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import cast

import numpy as np
import pytest
from budget import cases

import fuzzyarm
from fuzzyarm.control.loop import Options, Sensor, simulate
from fuzzyarm.plant import find_plant
from fuzzyarm.plant.own import starting_at
from fuzzyarm.proof.check.loop import checked_loop
from fuzzyarm.proof.claim.problem import LoopProblem
from fuzzyarm.proof.claim.text import problem_of
from fuzzyarm.proof.loop import LoopProofError, prove_loop, read_claim
from fuzzyarm.proof.loop.form import Assumptions
from fuzzyarm.proof.loop.form_maker import FormMaker
from fuzzyarm.proof.loop.runs import sampled_runs
from fuzzyarm.proof.loop.timed import Haven, claim_of_stability, first_open_box
from fuzzyarm.proof.loop.tube import Tube
from fuzzyarm.proof.loop.zonotope import Forms, stacked
from fuzzyarm.proof.map.bounds import Bounds
from fuzzyarm.proof.map.prover import Prover
from fuzzyarm.proof.stop import Stop

EXAMPLES = Path(__file__).parents[2] / "examples" / "closed_loop"
PENDULUM = EXAMPLES / "single_pendulum.py"
START = "from angle in 1 .. 1.175, rate in 0 .. 0.2"


@pytest.fixture(scope="module")
def pendulum():
    return fuzzyarm.load(EXAMPLES / "single-pendulum.frb")


@pytest.mark.parametrize(
    ("claim", "expected"),
    [
        ("angle in 0 .. 1 during 0.5 .. 1 s", "proved"),
        ("angle in 0 .. 0.9 during 0.5 .. 1 s", "refuted"),
        ("angle in 0 .. 1 during 0.2 .. 1 s", "refuted"),
        ("torque in -1 .. 1 during 0 .. 200 ms", "proved"),  # of a drive: its limits
        ("torque in -0.1 .. 1 during 0 .. 200 ms", "refuted"),
    ],
)
def test_a_claim_for_a_bounded_time(pendulum, claim, expected):
    port = next(iter(find_plant(str(PENDULUM)).inputs))
    verdict = fuzzyarm.prove(
        pendulum, f"{START}: {claim.replace('torque', port)}", plant=str(PENDULUM)
    )
    assert verdict.verdict == expected, str(verdict)
    assert (verdict.tube is not None) == (expected == "proved")
    assert bool(verdict.evidence) == (expected == "refuted")


@pytest.mark.slow
def test_what_is_true_but_beyond_a_tube_is_undecided_and_says_which_box(pendulum):
    problem = problem_of(pendulum, read_claim(f"{START}: angle in 0 .. 1", str(PENDULUM)))
    runs = sampled_runs(problem, 1.0, 40)
    most = max(float(run.outputs["angle"][10]) for run in runs)  # at 0.5 s, a corner
    claim = f"{START}: angle in 0 .. {most + 1e-7!r} during 0.5 .. 0.5 s"
    verdict = fuzzyarm.prove(pendulum, claim, plant=str(PENDULUM), budget=1.0)
    assert verdict.verdict == "undecided"
    assert "tube" in verdict.reason
    assert any("in the way: angle in" in line for line in verdict.evidence)


def test_an_end_that_is_no_whole_number_of_periods(pendulum):
    claim = f"{START}: angle in 0.9 .. 1.2 during 0.01 .. 0.13 s"
    assert fuzzyarm.prove(pendulum, claim, plant=str(PENDULUM)).proved


def test_a_tube_says_nothing_of_continuous_time(servo):
    claim = "from position in 0.01 .. 0.02: position in 0 .. 0.03 during 0 .. 3 ms"
    assert fuzzyarm.prove(servo, claim, plant="motor").proved
    verdict = fuzzyarm.prove(servo, claim, plant="motor", continuous=True)
    assert verdict.verdict == "undecided"
    assert "sampled" in verdict.reason


# ── as far as a region ───────────────────────────────────────────────────────────────


@pytest.mark.slow
@pytest.mark.parametrize(
    "claim",
    [
        "stable from position in 0.4 .. 0.5",
        "at position = 0.5 from position in 0 .. 0.05: position in 0.49 .. 0.51 after 0.5 s",
    ],
)
def test_from_beyond_the_region(servo, claim):
    verdict = fuzzyarm.prove(servo, claim, plant="motor")
    assert verdict.proved, str(verdict)
    assert verdict.certificate is None
    assert verdict.tube.arrival > 0.0
    problem = problem_of(servo, read_claim(claim, "motor"))
    rest = np.array([verdict.rest[name] for name in problem.states])
    generator = np.random.default_rng(3)
    for number in range(cases(8, 2000)):
        ends = problem.start.values()
        start = [generator.choice(e) if number % 2 else generator.uniform(*e) for e in ends]
        plant = starting_at(find_plant("motor"), start)
        wanted = {"position": float(problem.set_point["shaft", "position"])}
        run = simulate(servo, plant, reference=wanted, duration=2.0)
        states = np.array([run.outputs[name] for name in problem.states]).T
        arrived = np.searchsorted(run.time, verdict.tube.arrival - 1e-9)
        for name, values in zip(problem.states, states.T, strict=True):
            low, high = verdict.region[name]
            assert (values[arrived:] >= low).all()
            assert (values[arrived:] <= high).all()
        assert np.abs(states[-1] - rest).max() < 1e-3
        if "after" in claim:
            late = run.outputs["position"][run.time >= 0.5]
            assert ((late >= 0.49) & (late <= 0.51)).all()


@pytest.fixture(scope="module")
def haven(servo):
    claim = read_claim("stable", "motor")
    certificate = prove_loop(servo, claim).certificate.region
    maker = FormMaker(problem_of(servo, claim))
    loop = checked_loop(maker.problem, certificate.states, certificate.evidence)
    return Haven(maker, certificate, loop, claim), certificate


@pytest.mark.slow
def test_the_bound_of_v_holds_and_is_near(haven):
    region, certificate = haven
    p = np.array([[float(x) for x in row] for row in certificate.p])
    generator = np.random.default_rng(4)
    for _ in range(cases(40, 2000)):
        centre = generator.normal(size=3) / np.sqrt(np.diag(p))
        parts = (
            generator.normal(size=(4, 3)) * generator.choice([0.0, 1e-3, 0.1]) / np.sqrt(np.diag(p))
        )
        states = Forms(centre[:, None], parts[:, :, None], np.zeros((3, 1)))
        bound = region.values(states, {})[0]
        signs = generator.choice([-1.0, 1.0], (50, 4))
        points = centre + signs @ parts
        reached = np.einsum("ki,ij,kj->k", points, p, points).max()
        assert reached <= bound * (1 + 1e-12)
        if not parts.any():
            assert bound <= reached * (1 + 1e-6)


@pytest.mark.slow
def test_boxes_outside_the_region_have_not_arrived(haven):
    region, certificate = haven
    p = np.array([[float(x) for x in row] for row in certificate.p])
    root = np.linalg.inv(np.linalg.cholesky(p)).T
    way = root @ np.array([0.6, 0.64, 0.48])
    for share, sign in ((0.999, 1), (1.001, 0)):
        states = stacked([Forms.at(np.array([x])) for x in share * way])
        assert region.sign(1, states, {})[0] == sign


@pytest.mark.slow
def test_who_arrives_late_has_to_arrive_nearer_to_rest(servo, haven):
    _, certificate = haven
    claim = read_claim("position in -0.01 .. 0.01 after 0.5 s", "motor")
    maker = FormMaker(problem_of(servo, claim))
    loop = checked_loop(maker.problem, certificate.states, certificate.evidence)
    region = Haven(maker, certificate, loop, claim)
    p = np.array([[float(x) for x in row] for row in certificate.p])
    way = np.linalg.inv(np.linalg.cholesky(p)).T @ np.array([0.6, 0.64, 0.48])  # V = 1
    last = round(0.5 / maker.problem.period)

    def arrives(period, value):
        states = stacked([Forms.at(np.array([x])) for x in np.sqrt(value) * way])
        return region.sign(period, states, {})[0] == 1

    # At the end of the time V has to be at its level; before, the rate takes it there by then.
    for periods in (0, 1, last // 2, last):
        level = min(1.0, region.level / float(1 - certificate.rate) ** periods)
        assert arrives(last - periods, 0.999 * level)
        assert not arrives(last - periods, 1.001 * level)


@pytest.mark.slow
def test_a_region_that_is_damaged_is_no_haven(servo, haven):
    _, certificate = haven
    claim = read_claim("stable", "motor")
    maker = FormMaker(problem_of(servo, claim))
    loop = checked_loop(maker.problem, certificate.states, certificate.evidence)
    p = [list(row) for row in certificate.p]
    p[0][0] /= 2
    damaged = replace(certificate, p=tuple(map(tuple, p)))
    with pytest.raises(LoopProofError, match="not proved"):
        Haven(maker, damaged, loop, claim)
    faster = replace(certificate, rate=min(Fraction(99, 100), 64 * certificate.rate))
    with pytest.raises(LoopProofError, match="not proved"):
        Haven(maker, faster, loop, claim)


def test_the_claim_of_stability_is_of_the_same_loop():
    claim = read_claim(
        "at position = 1 with J in 1 .. 2 from position in 0 .. 1: position in 0 .. 2 after 1 s",
        "motor",
    )
    stable = claim_of_stability(claim)
    assert (stable.plant, stable.at, stable.parameters) == (claim.plant, claim.at, claim.parameters)
    assert stable.stable
    assert (stable.start, stable.output, stable.begin) == ((), "", 0.0)


# ── sensors and parameters ───────────────────────────────────────────────────────────


@pytest.mark.slow
def test_sensors_and_parameters_of_a_claim(servo):
    inside = "position in -0.2 .. 0.2 during 0 .. 20 ms"
    claim = f"with J in 0.009 .. 0.011 from position in 0.1 .. 0.12: {inside}"
    sensors = {"position": Sensor(resolution=0.001), "velocity": Sensor(delay=0.001)}
    verdict = fuzzyarm.prove(servo, claim, plant="motor", sensors=sensors)
    assert verdict.proved, str(verdict)
    exact = fuzzyarm.prove(servo, claim, plant="motor")
    width = verdict.tube.high_at[-1, 0] - verdict.tube.low_at[-1, 0]
    assert width > exact.tube.high_at[-1, 0] - exact.tube.low_at[-1, 0]
    for start in (0.1, 0.11, 0.12):
        run = simulate(
            servo, starting_at(find_plant("motor"), [start, 0.0, 0.0]),
            reference={"position": 0.0}, duration=0.02, options=Options(sensors=sensors),
        )  # fmt: skip
        values = run.outputs["position"]
        low, high = verdict.tube.low_at[: len(values), 0], verdict.tube.high_at[: len(values), 0]
        assert ((values >= low - 1e-7) & (values <= high + 1e-7)).all()


def test_a_slope_without_ends_in_time_is_no_form(pendulum, monkeypatch):
    """What a prover returns whose time has run out."""
    problem = problem_of(pendulum, read_claim(f"{START}: angle in 0 .. 1", str(PENDULUM)))
    cut_short = Bounds(-math.inf, 1.0, math.nan, math.nan, {}, {}, 0, "", complete=False)
    monkeypatch.setattr(Prover, "slope", lambda _self, _region, _name: cut_short)
    box = dict.fromkeys(problem.states, Fraction(1, 100))
    choice = Assumptions(Fraction(1, 2), box=box, along=False)
    with pytest.raises(LoopProofError, match="time ran out"):
        FormMaker(problem, Stop(60.0)).form(choice, continuous=False)


def test_a_single_start_that_cannot_be_followed_is_said() -> None:
    nothing = np.zeros((0, 0))
    tube = Tube(
        problem=cast(LoopProblem, None),
        duration=20.0,
        ports=(),
        begins=np.zeros(0),
        ends=np.zeros(0),
        low=nothing,
        high=nothing,
        low_at=nothing,
        high_at=nothing,
        boxes=1,
        open=({},),
        complete=False,
        seconds=0.0,
    )
    (line,) = first_open_box(tube)
    assert "too wide before 20 s" in line
    assert first_open_box(replace(tube, complete=True)) == ()
