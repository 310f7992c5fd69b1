"""Rests that depend on parameters, beside closed forms; the arm with a joint held."""

from dataclasses import replace

import numpy as np
import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyarm import load, prove
from fuzzyarm.control.controllers import ControllerText
from fuzzyarm.exchange.export import ExportError
from fuzzyarm.language import parse
from fuzzyarm.language.model.controller import Amount
from fuzzyarm.plant import Parameter, Plant, Port, find_plant
from fuzzyarm.plant.arm import (
    LOADED,
    RATIOS,
    UNLOADED,
    forward_dynamics,
    gravity_torque,
    mass_matrix,
    motor_torque,
)
from fuzzyarm.proof.check import check_certificate
from fuzzyarm.proof.check.tube import covered
from fuzzyarm.proof.loop import (
    LoopVerdict,
    prove_loop,
    read_certificate,
    read_claim,
    write_certificate,
)

H = 0.1
ARM = "examples/closed_loop/loaded_arm.py"


class Hoist(Plant):
    """A mass under a force and a weight."""

    name = "hoist"
    inputs = {"force": Port("N", -1.0, 1.0)}
    outputs = {"x": Port("m", -2.0, 2.0), "v": Port("m/s", -2.0, 2.0, rate_of="x")}
    states = {"x": "m", "v": "m/s"}
    parameters = {"m": Parameter(1.0, "kg"), "w": Parameter(0.0, "N", "weight")}

    def derivative(self, t, x, u, p):
        return [x[1], (u[0] - p[1]) / p[0]]


def pd(gain, damping):
    parsed = parse(
        f"""controller pd
period 100 ms
axis hoist
  e = error of x
  d = error of v
  u = e * {gain!r} + d * {damping!r}
  drive force = u
"""
    )
    assert parsed.controller is not None, parsed.diagnostics
    return ControllerText(parsed.controller)


def proved(gain, damping, mass, weight):
    claim = f"stable with m in {mass[0]!r} .. {mass[1]!r}, w in {weight[0]!r} .. {weight[1]!r}"
    return prove_loop(pd(gain, damping), read_claim(claim, "hoist"), plant=Hoist(), budget=60.0)


def after_a_period(x, v, gain, damping, mass, weight):
    """Return the exact next states: the force is held."""
    a = (np.clip(-gain * x - damping * v, -1.0, 1.0) - weight) / mass
    return x + H * v + H * H / 2 * a, v + H * a


def test_a_weight_moves_the_rest_as_far_as_its_closed_form_says():
    verdict = proved(2.0, 2.0, (0.9, 1.2), (-0.1, 0.3))
    assert verdict.proved
    low, high = verdict.rests["x"]
    assert low <= -0.3 / 2.0
    assert high >= 0.1 / 2.0
    assert high - low < 1.5 * 0.2  # the operator finds a wider one, since inertia is free in it
    assert "around where it rests" in str(verdict)
    checked = check_certificate(verdict.certificate, pd(2.0, 2.0), Hoist())
    assert checked.proved
    assert checked.rests == verdict.rests


@pytest.mark.slow(seconds=12)
@settings(max_examples=cases(12, 150))
@given(
    gain=st.floats(0.2, 8.0),
    damping=st.floats(0.2, 25.0),
    mass=st.tuples(st.floats(0.5, 1.0), st.floats(0.0, 0.3)),
    weight=st.tuples(st.floats(-1.2, 1.2), st.floats(0.0, 0.4)),
    seed=st.integers(0, 2**32 - 1),
)
def test_no_run_contradicts_a_region_of_all_weights(gain, damping, mass, weight, seed):
    masses, weights = (mass[0], mass[0] + mass[1]), (weight[0], weight[0] + weight[1])
    verdict = proved(gain, damping, masses, weights)
    if not verdict.proved:
        return
    assert max(map(abs, weights)) < 1.0  # there is no rest beyond the limits of the force
    generator = np.random.default_rng(seed)
    for part in verdict.certificate.by_part:
        ends = {name: (low, high) for name, low, high in part.claim.parameters}
        demand_fall(part.region, gain, damping, ends, generator)


def demand_fall(region, gain, damping, ends, generator):
    """Demand that V falls along runs from the border of a region, for drawn parameters."""
    count = 500
    m, w = (generator.uniform(*ends[name], count) for name in "mw")
    m[:2], w[:2] = ends["m"], ends["w"]
    p = np.array(region.p, float)
    way = np.linalg.solve(np.linalg.cholesky(p).T, generator.standard_normal((2, count)))
    z = way / np.sqrt(np.einsum("ik,ij,jk->k", way, p, way)) * generator.uniform(0.9, 1, count)
    rest = -w / gain
    x, v = z[0] + rest, z[1]
    before = np.full(count, 1.0)
    for _ in range(100):
        z = np.stack([x - rest, v])
        level = np.einsum("ik,ij,jk->k", z, p, z)
        assert (level <= before * (1.0 + 1e-9) + 1e-18).all()
        before = level
        x, v = after_a_period(x, v, gain, damping, m, w)
    assert level.max() < 1.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mass", "weight"), [((0.4, 1.0), (0.0, 0.1)), ((1.0, 1.0), (0.9, 1.1)), ((1.0, 1.0), (-2, -1))]
)
def test_one_parameter_without_a_stable_rest_is_enough(mass, weight):
    """Of the lightest mass the sampled loop has an eigenvalue beyond 1, of the others a force."""
    gain, damping = 1.0, 9.0
    moves = np.array([after_a_period(*z, gain, damping, mass[0], 0.0) for z in np.eye(2) * 1e-3])
    unstable = abs(np.linalg.eigvals(moves.T * 1e3)).max() > 1.0
    assert unstable == (mass[0] == 0.4)
    verdict = proved(gain, damping, mass, weight)
    assert verdict.verdict == ("refuted" if unstable else "undecided")
    if unstable:  # of a part of the masses
        assert verdict.evidence[1].startswith("with m in 0.4 .. 0.4")


# ── parts of the parameters ──────────────────────────────────────────────────────────


@pytest.fixture(scope="module")
def by_parts():
    verdict = proved(2.0, 2.0, (0.9, 1.2), (-0.9, 0.9))
    assert verdict.proved
    assert len(verdict.parts) > 1
    return verdict


class PushedSpring(Hoist):
    """The mass on a spring that pushes near 0 and pulls far out."""

    name = "pushed"

    def derivative(self, t, x, u, p):
        return [x[1], (u[0] - p[1] + 0.9 * x[0] - 0.7 * x[0] * x[0] * x[0]) / p[0]]


def test_an_interval_around_rest_that_only_grows_is_given_up():
    # Each widening is about the cube of the one before, soon beyond every float.
    claim = read_claim("stable with w in -0.3 .. 0.3", "pushed")
    verdict = prove_loop(pd(1.5, 1.0), claim, plant=PushedSpring(), budget=1.0)
    assert verdict.verdict != "refuted"


def test_a_wide_interval_is_proved_in_parts_with_one_certificate(by_parts, tmp_path):
    low, high = by_parts.rests["x"]
    assert low <= -0.45 < 0.45 <= high
    write_certificate(by_parts.certificate, str(tmp_path / "hoist.json"))
    read = read_certificate(str(tmp_path / "hoist.json"))
    checked = check_certificate(read, pd(2.0, 2.0), Hoist())
    assert checked.proved, checked.reason
    assert (checked.rests, checked.region) == (by_parts.rests, by_parts.region)
    assert f"in {len(by_parts.parts)} parts of its parameters" in str(checked)


def test_parts_state_what_the_smallest_region_reaches(by_parts):
    reach = []
    for part in by_parts.certificate.by_part:
        p = np.array(part.region.p, float)
        reach.append(np.sqrt(np.diag(np.linalg.inv(p))))
    half = [
        (high - low - width) / 2
        for (low, high), width in zip(
            (by_parts.region[name] for name in "xv"),
            (np.diff(by_parts.rests["x"])[0], 0.0),
            strict=True,
        )
    ]
    assert half == pytest.approx(np.min(reach, axis=0).tolist(), rel=1e-6)
    alone = [float(part.region.p[0][0]) ** -0.5 for part in by_parts.certificate.by_part]
    assert by_parts.start_region["x"] == pytest.approx(min(alone), rel=1e-6)


def test_the_picture_is_of_the_part_that_its_title_names(by_parts):
    from fuzzyarm.apps.show.region import region_chart

    (name, low, high), *_ = by_parts.parts[0].claim.parameters
    title = region_chart(pd(2.0, 2.0), by_parts, Hoist()).title
    assert f"{name} in {low:g} .. {high:g}" in title


def without_a_part(certificate):
    return replace(certificate, parts=certificate.parts[1:])


def narrower(certificate):
    first = certificate.parts[0]
    (name, low, high), *others = first.parameters
    gap = ((name, low, np.nextafter(high, low)), *others)
    return replace(certificate, parts=(first._replace(parameters=gap), *certificate.parts[1:]))


def with_one_name_less(certificate):
    first = certificate.parts[0]
    less = first._replace(parameters=first.parameters[:1])
    return replace(certificate, parts=(less, *certificate.parts[1:]))


def with_one_name_twice(certificate):
    first = certificate.parts[0]
    twice = first._replace(parameters=(*first.parameters, first.parameters[0]))
    return replace(certificate, parts=(twice, *certificate.parts[1:]))


def with_a_region_beside(certificate):
    return replace(certificate, regions=certificate.parts[0].regions)


def with_another_region(certificate):
    first, second, *others = certificate.parts
    return replace(certificate, parts=(first._replace(regions=second.regions), second, *others))


def of_a_map(certificate):
    return replace(certificate, window=(("x", -0.1, 0.1),))


def in_continuous_time(certificate):
    """Return it with one part that another loop proves: the plant under the law without a period.

    Its region is one of that loop, so that nothing else is wrong.
    """
    first = certificate.parts[0]
    words = ", ".join(f"{name} in {low!r} .. {high!r}" for name, low, high in first.parameters)
    claim = read_claim(f"stable with {words}", "hoist")
    verdict = prove_loop(pd(2.0, 2.0), claim, plant=Hoist(), budget=60.0, continuous=True)
    assert verdict.proved
    other = first._replace(regions=verdict.certificate.regions)
    return replace(certificate, parts=(other, *certificate.parts[1:]))


def of_wider_parameters(certificate):
    claim = certificate.claim
    (name, low, high), *others = claim.parameters
    wider = ((name, low, np.nextafter(high, np.inf)), *others)
    return replace(certificate, claim=replace(claim, parameters=wider))


@pytest.mark.parametrize(
    "falsified",
    [without_a_part, narrower, with_one_name_less, with_one_name_twice, with_a_region_beside,
     with_another_region, of_a_map, of_wider_parameters, in_continuous_time],
)  # fmt: skip
def test_parts_that_do_not_prove_the_claim_are_refused(by_parts, falsified):
    certificate = falsified(by_parts.certificate)
    checked = check_certificate(certificate, pd(2.0, 2.0), Hoist())
    assert not checked.proved


def test_a_verdict_of_regions_and_tubes_has_no_facts_of_one_region(by_parts, monkeypatch):
    """The first part has a region, so that its certificate and its reach are at hand."""
    first, second = by_parts.parts[:2]
    tube = replace(second, certificate=None, region={}, start_region={}, evidence=("of v = 0",))
    answers = iter([replace(first, verdict="undecided"), first, first, tube])
    monkeypatch.setattr("fuzzyarm.proof.loop.parts.judged", lambda *_, **__: next(answers))
    verdict = prove_loop(pd(2.0, 2.0), by_parts.claim, plant=Hoist())
    assert (verdict.verdict, verdict.claim) == ("proved", by_parts.claim)
    assert verdict.certificate is None
    assert [verdict.region, verdict.start_region, verdict.rests] == [{}, {}, {}]
    assert "x" not in verdict.rest
    assert verdict.evidence == (
        "in 2 parts of its parameters, each by a region or a tube", "of v = 0",
    )  # fmt: skip


@pytest.mark.parametrize("missing", [None, 0, 1500, 2999])
def test_a_gap_is_found_among_thousands_of_parts(missing):
    ends = np.linspace(0.0, 1.0, 3001)
    kept = np.arange(3000) != (-1 if missing is None else missing)
    lows, highs = ends[:-1][kept, None], ends[1:][kept, None]
    assert covered([(0.0, 1.0)], lows, highs) == (missing is None)


@pytest.mark.slow
def test_a_part_that_is_undecided_is_named(by_parts):
    verdict = prove_loop(
        pd(2.0, 2.0), read_claim("stable with w in 0.5 .. 1.1", "hoist"), plant=Hoist(), budget=60.0
    )
    assert verdict.verdict == "undecided"  # from 1 on there is no rest
    proved_until = max(
        float(line.rpartition(" .. ")[2]) for line in verdict.evidence if "proved" in line
    )
    assert 0.7 < proved_until < 1.0
    assert verdict.reason.startswith("with w in ")


# ── a rest at an edge along a rate ───────────────────────────────────────────────────

TWO = """rulebase two
input e -1 .. 1
input d -1 .. 1
output u -1 .. 1
term e L: triangle -3 -1 1.1
term e H: triangle -1 1 3
term d N: triangle -2 -1 0
term d Z: triangle -1 0 1
term d P: triangle 0 1 2
term u NB: singleton -1
term u NS: singleton -0.4
term u ZE: singleton 0
term u PB: singleton 1
inference and product
inference u: aggregation sum, defuzzifier weighted-average
rule if e is L and d is N then u is NB
rule if e is L and d is Z then u is NS
rule if e is L and d is P then u is ZE
rule if e is H and d is N then u is ZE
rule if e is H and d is Z then u is PB
rule if e is H and d is P then u is PB
"""
"""At d = 0 the surface has an edge along d, and along e it is a quotient."""

BESIDE = """controller beside
use two from "two.frb"
period 20 ms
axis spring
  e = error of x
  d = rate of e * 0.5, filter 50 ms
  u = rules two(e, d)
  drive force = u
"""


class Spring(Plant):
    """A damped mass on a spring, so that the loop rests beside its set point."""

    name = "spring"
    inputs = {"force": Port("N", -2.0, 2.0)}
    outputs = {"x": Port("m", -2.0, 2.0), "v": Port("m/s", -9.0, 9.0, rate_of="x")}
    states = {"x": "m", "v": "m/s"}

    def derivative(self, t, x, u, p):
        return [x[1], u[0] - 0.3 * x[0] - 3.0 * x[1]]


def beside_its_set_point(at):
    """Return where the spring rests, of the quotient of two straight degrees."""
    from scipy.optimize import brentq

    def force(e):
        low, high = (1.1 - e) / 2.1, (e + 1.0) / 2.0
        return (-0.4 * low + high) / (low + high)

    return brentq(lambda x: force(at - x) - 0.3 * x, -0.5, 1.2, xtol=1e-15)


@pytest.fixture(scope="module")
def beside(tmp_path_factory):
    folder = tmp_path_factory.mktemp("beside")
    (folder / "two.frb").write_text(TWO)
    (folder / "beside.frb").write_text(BESIDE)
    text = load(folder / "beside.frb")
    claim = read_claim("stable at x = 0.3", "spring")
    return text, prove_loop(text, claim, plant=Spring(), budget=60.0)


def test_a_rest_at_an_edge_along_a_rate_is_proved_to_exist(beside):
    text, verdict = beside
    assert verdict.proved, str(verdict)
    rest = verdict.certificate.region.evidence.rest
    middle, doubt = rest["x"]
    assert doubt > 0  # an irrational one
    assert abs(beside_its_set_point(0.3) - float(middle)) < float(doubt)
    assert check_certificate(verdict.certificate, text, Spring()).proved


@pytest.mark.parametrize(
    "changed",
    [lambda x, far: (x + 2 * far, far), lambda x, far: (x, far / 10**7), lambda x, far: (x, -far)],
)
@pytest.mark.parametrize("name", ["x", "spring.d before"])
def test_another_interval_of_such_a_rest_is_refused(beside, name, changed):
    text, verdict = beside
    region = verdict.certificate.region
    rest = {**region.evidence.rest, name: changed(*region.evidence.rest[name])}
    false = replace(region, evidence=replace(region.evidence, rest=rest))
    assert not check_certificate(
        replace(verdict.certificate, regions=(false,)), text, Spring()
    ).proved


# ── guards ───────────────────────────────────────────────────────────────────────────


def test_a_guard_of_rests_that_differ_is_refused(tmp_path):
    from fuzzyarm.exchange.export.certified_guard import _demand_region

    verdict = proved(2.0, 2.0, (1.0, 1.0), (-0.1, 0.3))
    checked = check_certificate(verdict.certificate, pd(2.0, 2.0), Hoist())
    with pytest.raises(ExportError, match="rests elsewhere"):
        _demand_region(checked)


def test_a_guard_of_several_parts_is_refused(by_parts):
    from fuzzyarm.exchange.export.certified_guard import _demand_region

    checked = check_certificate(by_parts.certificate, pd(2.0, 2.0), Hoist())
    with pytest.raises(ExportError, match="parts of its parameters"):
        _demand_region(checked)


# ── the arm ──────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(("load_share", "arm"), [(0.0, UNLOADED), (1.0, LOADED)])
def test_the_traced_arms_are_the_arm(load_share, arm):
    both, held = find_plant(f"{ARM}:LoadedArm"), find_plant(f"{ARM}:HeldJoint")
    generator = np.random.default_rng(0)
    for _ in range(20):
        q, v, u = (generator.uniform(-3, 3, 2) for _ in range(3))
        torque = [motor_torque(u[k], v[k], RATIOS[k]) for k in (0, 1)]
        rates = both.derivative(0.0, [q[0], v[0], q[1], v[1]], u.tolist(), [load_share])
        assert rates[1::2] == pytest.approx(forward_dynamics(arm, q, v, torque).tolist())
        # With the other joint held its row is that of the force that holds it.
        free = torque[0] - arm.F_1 * v[0] - gravity_torque(arm, q)[0]
        rates = held.derivative(0.0, [q[0], v[0]], [u[0]], [load_share, q[1]])
        assert rates == pytest.approx([v[0], free / mass_matrix(arm, q)[0, 0]])


def kept(name, **gains):
    """Return a controller of the arm's joint, with other gains."""
    text = load(f"examples/closed_loop/{name}.frb")
    changed = (
        replace(g, values=(Amount(((gains[g.name], False),)),)) if g.name in gains else g
        for g in text.model.gains
    )
    return replace(text, model=replace(text.model, gains=tuple(changed)), source="")


PER_ERROR = 1080.0 / np.pi * 20.0 / 6.0 * motor_torque(1.0, 0.0, RATIOS[0])
"""Torque per error and gain of joint-pd, N m/rad."""


@pytest.mark.slow(seconds=6)
def test_the_linear_law_holds_the_arm_level_with_any_load():
    gravity = [gravity_torque(arm, [0.0, 0.0])[0] for arm in (UNLOADED, LOADED)]
    verdict = prove(kept("joint-pd"), f"stable on '{ARM}:HeldJoint' with load in 0 .. 1")
    assert verdict.proved, str(verdict)
    low, high = verdict.rests["position"]
    droop = [-torque / (100.0 * PER_ERROR) for torque in gravity]
    assert low <= min(droop) < max(droop) <= high


@pytest.mark.slow(seconds=12)
def test_the_servo_holds_the_arm_level_with_any_load():
    proofs = prove("examples/closed_loop/joint-servo.frb", trust=True)
    verdicts = [proof for proof in proofs if isinstance(proof, LoopVerdict)]
    assert [verdict.verdict for verdict in verdicts] == ["proved"]
    assert verdicts[0].claim.parameters == (("load", 0.0, 1.0),)


def radius(damping, arm):
    """Return the spectral radius of joint-pd, level (gravity is constant there), unlimited."""
    from scipy.linalg import expm

    own = motor_torque(0.0, -1.0, RATIOS[0]) + arm.F_1
    inertia = mass_matrix(arm, [0.0, 0.0])[0, 0]
    rates = np.zeros((3, 3))
    rates[0, 1], rates[1, 1], rates[1, 2] = 1.0, -own / inertia, 1.0 / inertia
    flow = expm(rates * 0.0006)
    feedback = -PER_ERROR * np.array([100.0, damping / 100.0])
    return abs(np.linalg.eigvals(flow[:2, :2] + np.outer(flow[:2, 2], feedback))).max()


@pytest.mark.slow(seconds=8)
def test_a_damping_too_small_for_the_whole_load_is_never_proved():
    low, high = 0.0, 16.0
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (low, middle) if radius(middle, LOADED) < 1.0 else (middle, high)
    assert radius(0.999 * low, UNLOADED) < 1.0 < radius(0.999 * low, LOADED)
    claim = f"stable on '{ARM}:HeldJoint' with load in"
    assert not prove(kept("joint-pd", K_d=0.999 * low), f"{claim} 0.99 .. 1").proved
    assert prove(kept("joint-pd", K_d=1.5 * low), f"{claim} 0.99 .. 1").proved
