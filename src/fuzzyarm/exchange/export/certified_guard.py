"""The guard of a certificate: whether the state at a sample is in the certified region.

A certificate's V = zᵀPz counts all states z of the loop. A controller knows some of them: its
measurements and its memory. Let k = K z be the deviations from rest that it knows,

    W(k) = kᵀ (K P⁻¹ Kᵀ)⁻¹ k  is the least V of all states with this k   (Schur complement),

and W = V if it knows all of them. The program computes W as |L k|², L a triangular matrix of
numbers of 32 bits, and compares it with a number t, which follows from bounds of all roundings,
of L too: with s = √W, rows A s + B of rounding and (1 + ε)⁻¹ LᵀL ≤ P ≤ (1 + ε) LᵀL,

    (1 - γ) (s / √(1 + ε) - A s - B)² ≤ computed ≤ (1 + γ) (s √(1 + ε) + A s + B)².

If all states are known, t is so small that a state that passes has V ≤ 1; all states with V ≤ 1 - δ
pass. Otherwise t is so large that all states with V ≤ 1 pass; those that pass have W ≤ 1 + δ.

Rounding is that of floats of 32 bits, in any order, contracted or not, numbers below the normal
ones flushed to 0: an AVR has no other, and everything else rounds less.

Source: N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, SIAM 2002, sections 3.1
and 3.5.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from flint import arb, fmpq, fmpq_mat

from fuzzyarm.base.numbers import number_text
from fuzzyarm.control.controllers.program import skipped_drives
from fuzzyarm.exchange.export.guard import Known, RegionGuard, Seed
from fuzzyarm.exchange.export.numbers import ExportError, rounded, rounded_down
from fuzzyarm.exchange.export.steps import Steps, StepVariable, first_of
from fuzzyarm.language.model.controller import Drive
from fuzzyarm.plant.own import start_of
from fuzzyarm.proof.check.checking import Checked
from fuzzyarm.proof.check.loop import CheckedLoop
from fuzzyarm.proof.check.numbers import (
    Matrix,
    exact,
    float_above,
    float_below,
    is_positive_definite,
    magnitude,
    precisely,
)
from fuzzyarm.proof.claim.problem import LoopProblem

UNIT, FLUSHED = fmpq(1, 2**24), fmpq(1, 2**126)
"""Rounding of a float of 32 bits: relative, and below the normal numbers."""


class _Row(NamedTuple):
    """A known number, and its role in the loop."""

    known: Known
    parts: tuple[fmpq, ...]  # its deviation from rest, by the states of the loop
    doubt: fmpq  # how far the true rest is from `known.rest` at most


@precisely
def region_guard(checked: Checked, steps: Steps) -> RegionGuard:
    """Return the guard of a controller by a certificate of its loop.

    ExportError if that is not of one region of the sampled loop with exact sensors, or the file
    names no fallback.
    """
    _demand_region(checked)
    assert checked.proof is not None
    problem, (loop, proof) = checked.proof.problem, checked.proof.havens[0]
    known = _known(problem, loop, steps, proof.evidence.memory)
    if not known:
        raise ExportError("the controller measures nothing that its certificate knows")
    rows = fmpq_mat([list(x.parts) for x in known])
    inverse = fmpq_mat([[exact(x) for x in row] for row in proof.p]).inv()
    spread = rows * inverse * rows.transpose()
    unknown = () if len(known) == loop.size else _unknown(loop, known)
    factor, limit, delta = _rounded(spread, known, whole=not unknown)
    set_points = {
        x.symbol: problem.set_point[
            problem.site.find(problem.text.model, "reference", (x.axis, x.name))
        ]
        for x in steps.of_sort("reference")
    }
    numbers = tuple(x.known for x in known)
    return RegionGuard(
        numbers, unknown, factor, limit, delta, set_points, _fallback(steps), checked
    )


def start_outside(checked: Checked) -> str:
    """Return in words that a plant starts outside the region of its certificate, or ""."""
    assert checked.proof is not None
    problem, (loop, proof) = checked.proof.problem, checked.proof.havens[0]
    if problem.unknown_start:
        return ""
    rows = [loop.names.index(name) for name in problem.states]
    spread = np.linalg.inv(np.array(proof.p, float))[np.ix_(rows, rows)]
    start = start_of(problem.plant, np.random.default_rng(0))
    away = np.array(start) - [float(loop.rest[name]) for name in problem.states]
    if away @ np.linalg.solve(spread, away) <= 1.0:  # the least V over all memory
        return ""
    words = ", ".join(
        f"{name} = {number_text(x)}" for name, x in zip(problem.states, start, strict=True)
    )
    return (
        f"{problem.plant.name} starts at {words}, outside the region of the certificate: the guard"
        " may refuse the first state already"
    )


def _demand_region(checked: Checked) -> None:
    """Refuse a certificate of anything but one region of the sampled loop."""
    certificate = checked.certificate
    if certificate.tubes:
        what = "a map" if certificate.window else "tubes"
        raise ExportError(
            f"the certificate is of {what}, and a guard is made of a region alone",
            hint="prove --stable --certificate, without --map, --from and --claim",
        )
    if certificate.parts:
        raise ExportError(
            f"the certificate has a region for each of {len(certificate.parts)} parts of its"
            " parameters, and a guard tests one",
            hint="prove it with one value of each parameter",
        )
    if certificate.continuous:
        raise ExportError(
            "the certificate is of the loop in continuous time, and a guard tests at samples",
            hint="leave out --continuous",
        )
    if certificate.region.growth != 1:
        raise ExportError(
            "a run may leave the ellipsoid of starts of this certificate on its way to rest (it has"
            " functions of cones), and a guard tests one ellipsoid",
        )
    if checked.rests:
        raise ExportError(
            "with other parameters the loop of this certificate rests elsewhere, and a guard tests"
            " one ellipsoid",
            hint="prove it with one value of each parameter",
        )
    if certificate.sensors:
        raise ExportError(
            f"the sensor of '{next(iter(certificate.sensors))}' does not give the state at its"
            " sample (a delay, a difference), so that no guard can test it",
            hint="prove it with exact sensors",
        )


def _fallback(steps: Steps) -> dict[str, float | None]:
    """Return the value of each drive after a refused state; refuse a drive without one."""
    fallback: dict[str, float | None] = {}
    for axes in steps.model.axes:
        drives = [line for line in axes.lines if isinstance(line, Drive)]
        said = {line.port for line in drives if line.on_leaving is not None}
        for line in drives:
            if line.port not in said:
                raise ExportError(
                    f"the drive of '{line.port}' does not say what it sends once a guard refuses"
                    " a state",
                    hint="add  , on leaving 0  or  , on leaving hold",
                    span=line.span,
                )
        values = skipped_drives(axes, lambda x: float(steps.precision.outside(x)), "leaving")
        for axis in axes.names:
            for port, (_, value) in values.items():
                fallback[StepVariable("drive", axis, port).symbol] = value
    return fallback


def _known(
    problem: LoopProblem, loop: CheckedLoop, steps: Steps, memory: Mapping[str, str]
) -> list[_Row]:
    """Return the known values of a loop, each independent of those before."""
    model, found = problem.text.model, list[_Row]()
    for x in steps.of_sort("measured"):
        signal = loop.outputs[problem.site.find(model, "measured", (x.axis, x.name))]
        parts = tuple(fmpq(signal.parts.get(name, 0)) for name in loop.names)
        matrix = fmpq_mat([*(list(y.parts) for y in found), list(parts)])
        if matrix.rank() > len(found):
            rest, doubt = _middle(signal.rest)
            found.append(_Row(Known(x.symbol, steps.port_name(x), rest), parts, doubt))
    measured = tuple(found)
    for name, key in memory.items():
        if key not in steps.variables:  # of an actuator
            continue
        rest, doubt = _middle(loop.rest[name])
        known = Known(key, steps.variables[key].name, rest)
        if name not in loop.begin:
            known = known._replace(first=first_of(steps.variables[key].axis))
        if name in loop.seeds:
            seed, more = _seed(loop, name, measured)
            known, doubt = known._replace(seed=seed), doubt + more
        found.append(_Row(known, tuple(fmpq(int(other == name)) for other in loop.names), doubt))
    return found


def _middle(rest: Any) -> tuple[float, fmpq]:
    """Return a float of 32 bits next to a rest value, and its greatest distance from it."""
    middle = float(rounded([float(rest)], np.float32, "a rest")[0])
    return middle, exact(float_above(magnitude(rest - exact(middle))))


def _seed(loop: CheckedLoop, name: str, measured: Sequence[_Row]) -> tuple[Seed, fmpq]:
    """Return the first value of the memory: weights of measured deviations, and its doubt."""
    constant_, parts = loop.seeds[name]
    rows = fmpq_mat([list(x.parts) for x in measured])
    goal = fmpq_mat([[fmpq(parts.get(other, 0)) for other in loop.names]])
    weights = goal * rows.transpose() * (rows * rows.transpose()).inv()
    if weights * rows != goal:
        raise ExportError(f"what '{name}' is before its first sample is not measured")
    pairs = [(j, float(weights[0, j])) for j in range(len(measured)) if weights[0, j] != 0]
    near = ((j, float(rounded([x], np.float32, name)[0])) for j, x in pairs)
    return tuple(near), exact(float_above(magnitude(constant_ - loop.rest[name])))


def _unknown(loop: CheckedLoop, known: Sequence[_Row]) -> tuple[str, ...]:
    """Return the states that are not known directly."""
    alone = {x.parts for x in known}
    units = {n: tuple(fmpq(int(m == n)) for m in loop.names) for n in loop.names}
    return tuple(name for name, row in units.items() if row not in alone)


# ── rounding ─────────────────────────────────────────────────────────────────────────


def _rounded(
    spread: fmpq_mat, known: Sequence[_Row], *, whole: bool
) -> tuple[tuple[tuple[float, ...], ...], float, float]:
    """Return L, t and δ; see the head of this module."""
    size = len(known)
    weight = spread.inv()
    exactly = [[weight[i, j] for j in range(size)] for i in range(size)]
    plain = np.array([[float(x) for x in row] for row in exactly])
    lower = np.linalg.cholesky((plain + plain.T) / 2.0)
    upper = [[float(x) for x in rounded(lower.T[i], np.float32, "the guard")] for i in range(size)]
    factor = fmpq_mat([[exact(x) for x in row] for row in upper])
    off = _distance(exactly, factor.transpose() * factor)
    # |kⱼ| ≤ reach s; the computed value is off by at most slope s + still.
    reach = [arb(spread[j, j]).sqrt() for j in range(size)]
    slope, still = list[arb](), list[arb]()
    for j, (x, _, doubt) in enumerate(known):
        own = UNIT * reach[j], doubt * (1 + UNIT) + FLUSHED
        # Of the first period, over measured values, with their weights rounded, too.
        seed = x.seed or ()
        many = _gamma(len(seed) + 3)
        sown = (
            sum((arb(abs(exact(w))) * (1 + many) * (slope[i] + many * reach[i])
                 for i, w in seed), arb(0)),
            sum((arb(abs(exact(w))) * (1 + many) * still[i] for i, w in seed), arb(0))
            + doubt + (len(seed) + 1) * FLUSHED,
        )  # fmt: skip
        slope.append(arb(own[0]).max(sown[0]))
        still.append(arb(own[1]).max(sown[1]))
    rows, gamma = range(size), _gamma(size)
    moving, standing = arb(0), arb(0)
    for i in rows:
        weights = [(j, arb(abs(exact(upper[i][j])))) for j in range(i, size)]
        a = sum((w * ((1 + gamma) * slope[j] + gamma * reach[j]) for j, w in weights), arb(0))
        b = sum((w * (1 + gamma) * still[j] for j, w in weights), arb(0)) + 2 * size * FLUSHED
        moving, standing = moving + a * a, standing + b * b
    moving, standing, lost = moving.sqrt(), standing.sqrt(), 2 * size * FLUSHED
    stretch = arb(1 + off).sqrt()
    least, most = 1 / stretch - moving, stretch + moving
    if not least > standing:
        raise ExportError("the region is too narrow for a guard by floats of 32 bits")
    if whole:
        bound = (1 - gamma) * (least - standing) ** 2 - lost
        limit = float(rounded_down([float_below(bound)], np.float32, "the guard")[0])
        passed = ((((exact(limit) - lost) / (1 + gamma)).max(0)).sqrt() - standing) / most
        delta = 1 - passed**2
    else:
        bound = (1 + gamma) * (most + standing) ** 2 + lost
        limit = -float(rounded_down([-float_above(bound)], np.float32, "the guard")[0])
        delta = (((exact(limit) + lost) / (1 - gamma)).sqrt() + standing) / least
        delta = delta**2 - 1
    return tuple(tuple(row[i:]) for i, row in enumerate(upper)), limit, float_above(delta)


def _gamma(count: int) -> arb:
    """Return the error bound of so many consecutive roundings."""
    return arb(count * UNIT) / (1 - count * UNIT)


def _distance(exactly: Matrix, product: fmpq_mat) -> fmpq:
    """Return an ε with which both of two matrices are at most 1 + ε times the other."""
    size = range(len(exactly))
    for bits in range(26, 3, -1):
        more = 1 + fmpq(1, 2**bits)
        differences = (
            [[more * product[i, j] - exactly[i][j] for j in size] for i in size],
            [[more * exactly[i][j] - product[i, j] for j in size] for i in size],
        )
        if all(map(is_positive_definite, differences)):
            return more - 1
    raise ExportError("the region is too narrow for a guard by floats of 32 bits")
