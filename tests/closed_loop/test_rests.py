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
from fuzzyarm.proof.loop import LoopVerdict, prove_loop, read_claim

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
    count = 500
    m, w = (generator.uniform(*ends, count) for ends in (masses, weights))
    m[:2], w[:2] = masses, weights
    p = np.array(verdict.certificate.region.p, float)
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


@pytest.mark.parametrize(
    ("mass", "weight"), [((0.4, 1.0), (0.0, 0.1)), ((1.0, 1.0), (0.9, 1.1)), ((1.0, 1.0), (-2, -1))]
)
def test_one_parameter_without_a_stable_rest_is_enough(mass, weight):
    """Of the lightest mass the sampled loop has an eigenvalue beyond 1, of the others a force."""
    gain, damping = 1.0, 9.0
    moves = np.array([after_a_period(*z, gain, damping, mass[0], 0.0) for z in np.eye(2) * 1e-3])
    unstable = abs(np.linalg.eigvals(moves.T * 1e3)).max() > 1.0
    assert unstable == (mass[0] == 0.4)
    assert not proved(gain, damping, mass, weight).proved


def test_a_guard_of_rests_that_differ_is_refused(tmp_path):
    from fuzzyarm.exchange.export.certified_guard import _demand_region

    verdict = proved(2.0, 2.0, (1.0, 1.0), (-0.1, 0.3))
    checked = check_certificate(verdict.certificate, pd(2.0, 2.0), Hoist())
    with pytest.raises(ExportError, match="rests elsewhere"):
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
    for ends in ((0.0, 0.5), (0.5, 1.0)):
        claim = f"stable on '{ARM}:HeldJoint' with load in {ends[0]} .. {ends[1]}"
        verdict = prove(kept("joint-pd"), claim)
        assert verdict.proved, str(verdict)
        low, high = verdict.rests["position"]
        droop = [-np.interp(x, (0.0, 1.0), gravity) / (100.0 * PER_ERROR) for x in ends]
        assert low <= min(droop) < max(droop) <= high


@pytest.mark.slow(seconds=12)
def test_the_servo_holds_the_arm_level_with_any_load():
    proofs = prove("examples/closed_loop/joint-servo.frb", trust=True)
    verdicts = [proof for proof in proofs if isinstance(proof, LoopVerdict)]
    assert [verdict.verdict for verdict in verdicts] == ["proved"] * 4
    parts = [verdict.claim.parameters[0] for verdict in verdicts]
    assert [end for _, low, high in parts for end in (low, high)] == [
        0.0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1.0,
    ]  # fmt: skip


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
