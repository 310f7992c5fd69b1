"""Functions of cones: what they prove of loops with an edge at rest, and what they must not."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from budget import cases

from fuzzyarm import load_controller, prove
from fuzzyarm.plant import Plant, Port
from fuzzyarm.proof.check import check_certificate
from fuzzyarm.proof.check.certificate import RegionProof, read_certificate, write_certificate
from fuzzyarm.proof.check.region import refutation_of_cones, verified
from fuzzyarm.proof.claim.text import problem_of
from fuzzyarm.proof.loop.affine import SignalBound, variable
from fuzzyarm.proof.loop.cones import cone_candidates
from fuzzyarm.proof.loop.form import Form
from fuzzyarm.proof.stop import Stop


class Second(Plant):
    """y'' = -0.4 y' + 4 u."""

    name = "second"
    inputs = {"u": Port("1", -1000.0, 1000.0)}
    outputs = {"y": Port("1", -1.0, 1.0), "v": Port("1/s", -5.0, 5.0, rate_of="y")}
    states = {"y": "1", "v": "1/s"}
    longest_step = 0.005

    def derivative(self, t, x, u, p):
        return [x[1], -0.4 * x[1] + 4.0 * u[0]]


RULES = """rulebase bent
input e -1 .. 1
output u -9 .. 9
term e N: triangle -2 -1 0
term e Z: triangle -1 0 1
term e P: triangle 0 1 2
term u N: singleton -0.25
term u Z: singleton 0
term u P: singleton {slope}
inference u: aggregation sum, defuzzifier weighted-average
rule if e is N then u is N
rule if e is Z then u is Z
rule if e is P then u is P
"""

CONTROLLER = """controller bent
use bent from "bent.frb"
period 20 ms
axis a
  e = error of y
  u = rules bent(e)
  drive u = u
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cones")
    (folder / "bent.frb").write_text(RULES.format(slope=8))
    (folder / "bent-controller.frb").write_text(CONTROLLER)
    return folder


@pytest.fixture(scope="module")
def text(folder):
    return load_controller(str(folder / "bent-controller.frb"))


@pytest.fixture(scope="module")
def verdict(text):
    return prove(text, "stable", plant=Second())


@pytest.mark.slow
def test_a_loop_with_slopes_of_a_factor_of_32_is_proved_by_two_functions(verdict):
    assert verdict.proved
    region = verdict.certificate.region
    assert len(region.cones) == 2
    assert region.growth > 1


@pytest.mark.slow
def test_runs_from_the_start_stay_below_its_growth_and_fade(verdict):
    region = verdict.certificate.region
    p = np.array(region.p, float)
    root = np.linalg.inv(np.linalg.cholesky(p)).T
    h = 0.02
    decay = math.exp(-0.4 * h)
    for angle in np.linspace(0.0, 2.0 * math.pi, 60, endpoint=False):
        y, v = root @ [math.cos(angle), math.sin(angle)]
        levels = []
        for _ in range(4000):
            z = np.array([y, v])
            levels.append(z @ p @ z)
            u = -y * (8.0 if -y > 0 else 0.25)
            v, y = (
                decay * v + 10.0 * u * (1.0 - decay),
                y + v * (1.0 - decay) / 0.4 + 10.0 * u * (h - (1.0 - decay) / 0.4),
            )
        assert max(levels) <= float(region.growth) * (1.0 + 1e-9)
        assert levels[-1] < 1e-3
        rate = 1.0 - float(region.rate)
        assert all(x <= float(region.growth) * rate**k * 1.0001 for k, x in enumerate(levels))


def test_a_certificate_of_cones_is_checked_as_it_was_written(verdict, text, folder):
    path = str(folder / "bent.json")
    write_certificate(verdict.certificate, path)
    again = read_certificate(path)
    assert again.region == verdict.certificate.region
    checked = check_certificate(again, text, Second())
    assert checked.proved, checked.reason
    assert "in each cone" in str(checked)


def changed(region):
    """Yield names and regions that prove nothing."""
    one, other = region.cones
    yield "a cone less", replace(region, cones=(one,))
    yield "a cone twice", replace(region, cones=(one, one))
    yield "no growth", replace(region, growth=Fraction(1))
    yield "a growth below 1", replace(region, growth=Fraction(1, 2))
    yield "growth alone", replace(region, cones=())
    yield "a rate too high", replace(region, rate=Fraction(1, 2))
    yield "multipliers beside cones", replace(region, multipliers=(Fraction(1),))
    yield "a larger start", replace(region, p=scaled(region.p, Fraction(1, 2)))
    yield "in continuous time", replace(region, continuous=True)
    small = one._replace(p=scaled(one.p, Fraction(1, 2)))
    yield "a function that is less", replace(region, cones=(small, other))
    yield "one fall less", replace(region, cones=(one._replace(falls=one.falls[:1]), other))
    for sign in (-1, 10**9):
        weights = tuple(tuple(x * sign for x in row) for row in one.falls[0].sides)
        fall = one.falls[0]._replace(sides=weights)
        yield (
            f"sides times {sign}",
            replace(region, cones=(one._replace(falls=(fall, *one.falls[1:])), other)),
        )
    lopsided = ((Fraction(0), Fraction(1)), (Fraction(0), Fraction(0)))
    fall = one.falls[0]._replace(sides=lopsided)
    yield (
        "sides of no symmetry",
        replace(region, cones=(one._replace(falls=(fall, *one.falls[1:])), other)),
    )
    (gains,) = one.gains
    wide = gains._replace(gains={n: (low / 2, low / 2) for n, (low, _) in gains.gains.items()})
    yield "slopes that are not there", replace(region, cones=(one._replace(gains=(wide,)), other))
    swapped = (one._replace(gains=other.gains), other._replace(gains=one.gains))
    yield "the slopes of the other side", replace(region, cones=swapped)


def scaled(p, by):
    return tuple(tuple(x * by for x in row) for row in p)


def test_a_changed_certificate_of_cones_is_refused(verdict, text):
    claim = verdict.certificate.claim
    problem = problem_of(text, claim, plant=Second())
    region = verdict.certificate.region
    assert verified(problem, claim, region)[0] == ""
    for words, other in changed(region):
        assert verified(problem, claim, other)[0], words


def test_one_sided_slopes_count_in_cones_only(verdict, text):
    region = verdict.certificate.region
    problem = problem_of(text, verdict.certificate.claim, plant=Second())
    evidence = replace(region.evidence, gains=region.cones[0].gains)
    assert (
        "at rest 'e' is outside"
        in verified(problem, verdict.certificate.claim, replace(region, evidence=evidence))[0]
    )


# ── drawn maps of two states, with an edge at x = 0 ──────────────────────────────────


def drawn_forms(rng, states):
    """Return a form of both sides, and one of each, of a piecewise linear map."""
    a = rng.standard_normal((states, states))
    a *= rng.uniform(0.6, 1.1) / np.abs(np.linalg.eigvals(a)).max()
    push = rng.standard_normal((states, 1)) * rng.uniform(0.1, 1.5)
    edge = np.zeros((1, states))
    edge[0, 0] = 1.0
    maps = [np.round(a + push @ edge * s, 6) for s in (rng.uniform(-1, 1), rng.uniform(-1, 1))]
    names = tuple(f"z{k}" for k in range(states))
    bounds = tuple(SignalBound(variable(n), Fraction(-1), Fraction(1), n) for n in names)

    def form(matrix, sign):
        rows = tuple(tuple(Fraction(float(x)) for x in row) for row in matrix)
        none = tuple(() for _ in names)
        row = tuple(Fraction(int(k == 0)) for k in range(states))
        return Form(
            names, dict.fromkeys(names, Fraction(0)), rows, none,
            tuple((Fraction(0),) * states for _ in names), (), (), bounds, {}, {}, 1.0, None,
            (row,), (True,), (sign,) if sign else (),
        )  # fmt: skip

    return maps, form((maps[0] + maps[1]) / 2, 0), [form(maps[0], 1), form(maps[1], -1)]


def spread(maps, rng):
    """Return by what runs of the map grow in the end, from points all around."""
    z = rng.standard_normal((len(maps[0]), 200))
    z /= np.linalg.norm(z, axis=0)
    for k in range(600):
        z = np.where(z[0] >= 0.0, maps[0] @ z, maps[1] @ z)
        if k == 299:
            z /= np.maximum(np.linalg.norm(z, axis=0), 1e-200)
    return np.linalg.norm(z, axis=0).max()


@pytest.mark.slow
def test_a_map_that_is_proved_comes_to_rest():
    rng = np.random.default_rng(5)
    proved = common = unstable = 0
    for states in [2] * cases(40, 400) + [3] * cases(12, 100):
        maps, base, forms = drawn_forms(rng, states)
        growth = spread(maps, rng)
        unstable += growth > 1.0
        for found in cone_candidates(base, forms, Stop()):
            region = RegionProof(
                None, False, found.p, (), Fraction(0), base.names, found.cones, found.growth
            )
            pairs = list(zip((f.system for f in forms), found.cones, strict=True))
            if refutation_of_cones(base.system, pairs, region):
                continue
            assert growth < 1.0, maps
            proved += 1
            common += found.growth == 1
            p = np.array(found.p, float)
            z = np.linalg.inv(np.linalg.cholesky(p)).T @ rng.standard_normal((states, 50))
            z /= np.sqrt(np.einsum("ik,ij,jk->k", z, p, z))
            for _ in range(50):
                z = np.where(z[0] >= 0.0, maps[0] @ z, maps[1] @ z)
                level = np.einsum("ik,ij,jk->k", z, p, z)
                assert (level <= float(found.growth) * (1.0 + 1e-9)).all()
                assert (np.abs(z) <= 1.0 + 1e-9).all()
    assert proved > common > 0  # some need a function of each side
    assert unstable > 0
