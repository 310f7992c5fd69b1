"""The guard of an exported controller: a test of its state before each step, and a fallback.

Which numbers it has follows from a certificate (:mod:`fuzzyarm.exchange.export.certified_guard`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from operator import add, and_
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fuzzyarm.base.numbers import inward_interval, number_text, outward_text
from fuzzyarm.exchange.export.steps import Steps
from fuzzyarm.exchange.export.trial import EvaluatedController
from fuzzyarm.exchange.export.typed_program import (
    TRUTH,
    Function,
    Member,
    Program,
    Truth,
    Variable,
    When,
    cast,
)
from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.nodes import Node, constant, symbol
from fuzzyarm.symbolic.printing import Assign

if TYPE_CHECKING:
    from fuzzyarm.proof.check.checking import Checked

GUARDED_STEP = "guarded_step"
"""Name of the step with the test before it, after the prefix."""

LEFT_REGION = "left the region"
"""Symbol of the member for "left the region", until `init`."""

SENT = "sent"
"""Symbol of the last value of a drive that holds it, before that of the drive."""


Seed = tuple[tuple[int, float], ...]
"""Numbers of others, with their weights."""


class Known(NamedTuple):
    """A number of the loop known to the controller: measured, or remembered."""

    symbol: str  # of the variable of its program
    label: str  # in words
    rest: float  # its rest, of 32 bits, which is subtracted
    # Of a memory without a value in the first period, the symbol of the condition for that.
    first: str = ""
    seed: Seed | None = None  # its deviation, as weights of others; None without one


@dataclass(frozen=True, eq=False)
class RegionGuard:
    """The test of a state, and the drives after it fails."""

    known: tuple[Known, ...]  # the controller's k
    unknown: tuple[str, ...]  # states of the loop over which W is the least V; empty if it is V
    factor: tuple[tuple[float, ...], ...]  # rows of L from the diagonal on
    # t and δ.
    limit: float
    delta: float
    set_points: Mapping[str, float]  # by symbol of a reference, that of the claim
    fallback: Mapping[str, float | None]  # by symbol of a drive; None: its last value
    checked: Checked  # the certificate

    @property
    def untested(self) -> tuple[str, ...]:
        """Conditions of first periods in which a memory has no value."""
        return tuple(dict.fromkeys(x.first for x in self.known if x.first and x.seed is None))

    def words(self, steps: Steps) -> Iterator[str]:
        """Yield the lines about it at the head of a file."""
        certificate = self.checked.certificate

        def name_of(symbol: str) -> str:
            return steps.port_name(steps.variables[symbol])

        delta = outward_text(self.delta, up=True, digits=3)
        least = f", the least over {', '.join(self.unknown)}" * bool(self.unknown)
        yield f"guard: V of {', '.join(x.label for x in self.known)}{least}"
        if self.unknown:
            yield f"  every state with V <= 1 passes; one that passes has such a V <= 1 + {delta}"
        else:
            yield f"  a state that passes has V <= 1; every one with V <= 1 - {delta} passes"
        yield "  by floats of 32 bits or more, measured values and memory taken as they are"
        if certificate.claim.start:  # else it is part of the claim
            region = self.checked.region.items()
            reach = (f"{name} in {inward_interval(*ends, 6)}" for name, ends in region)
            yield f"  V <= 1 reaches to {', '.join(reach)}"
        names = (f"{name_of(x)} = {number_text(y)}" for x, y in self.set_points.items())
        if self.set_points:
            yield f"  of the set points {', '.join(names)}; with others or NaN it refuses"
        sent = (
            f"{name_of(x)} {'holds' if y is None else f'= {number_text(y)}'}"
            for x, y in self.fallback.items()
        )
        yield f"  after a state that it refuses: {', '.join(sent)}, until init"
        first = " nor is the first one, in which a memory has no value" * bool(self.untested)
        yield f"  a period with a measured value that is not a number is not tested{first}"
        equations = certificate.digests["plant"]
        yield f"  plant {certificate.claim.plant}, SHA-256 of its equations {equations}"
        files = self.checked.files.items() - certificate.fingerprints.items()
        yield from (f"  file {Path(path).name}, SHA-256 {digest}" for path, digest in files)

    # ── the program ──────────────────────────────────────────────────────────────────

    def add_to(self, program: Program, steps: Steps) -> None:
        """Give a program the test, with its members and the rows that test it."""
        remark = "a state was refused: the fallback, until init"
        program.state[LEFT_REGION] = Member("left", TRUTH, False, remark=remark, name="left")
        for drive, value in self.fallback.items():
            variable = steps.variables[drive]
            if value is None:
                program.state[f"{SENT} {drive}"] = Member(
                    f"{variable.name}_sent", steps.precision.outside, variable.start,
                    variable.axis, "last value of the drive", "held", f"{variable.name}_sent",
                )  # fmt: skip
        program.guard = self._function(steps)

    def _function(self, steps: Steps) -> Function:
        """Return the function of the test, which sets the member."""
        outer, wide = steps.precision.outside, steps.precision.wide
        read = [x.symbol for x in steps.of_sort("measured")]
        local: dict[str, Variable] = {}
        lines: list[Any] = []

        def local_of(name: str, stem: str, value: Node) -> Node:
            local[name] = Variable(stem, wide)
            lines.append(Assign(name, value))
            return symbol(name)

        offs: list[Node] = []
        for k, x in enumerate(self.known):
            kind = wide if x.symbol.startswith("state") else outer
            value: Node = cast(symbol(x.symbol), kind, wide)
            value = value - constant(x.rest) if x.rest else value
            if x.seed is not None:
                value = op.where(symbol(x.first), _sum(x.seed, offs), value)
            offs.append(local_of(f"off {k}", f"off_{x.label}", value))
        rows = [
            local_of(f"row {k}", "row", _sum(enumerate(row, k), offs))
            for k, row in enumerate(self.factor)
        ]
        value = reduce(add, [row * row for row in rows])
        lines.append(Assign(LEFT_REGION, ~(value <= constant(self.limit))))
        of_claim = [
            op.equal(cast(symbol(name), outer, wide), constant(float(outer(set_point))))
            for name, set_point in self.set_points.items()
        ]
        if of_claim:
            same = When(reduce(and_, of_claim), tuple(lines))
            lines = [Assign(LEFT_REGION, Truth(True)), same]
        numbers = [op.equal(symbol(name), symbol(name)) for name in read]
        later = [~symbol(name) for name in self.untested]
        body = [When(reduce(and_, [*later, *numbers], ~symbol(LEFT_REGION)), tuple(lines))]
        return Function("left", {}, TRUTH, body, local, wide)

    # ── the self-test ────────────────────────────────────────────────────────────────

    def value(self, numbers: Sequence[float], *, first: bool) -> Fraction:
        """Return W of the known numbers, exactly."""
        pairs = zip(numbers, self.known, strict=True)
        off = [Fraction(x) - Fraction(known.rest) for x, known in pairs]
        for k, known in enumerate(self.known):
            if first and known.seed is not None:
                off[k] = sum((Fraction(w) * off[j] for j, w in known.seed), Fraction(0))
        rows = (
            sum((Fraction(w) * off[k + j] for j, w in enumerate(row)), Fraction(0))
            for k, row in enumerate(self.factor)
        )
        return sum((x * x for x in rows), Fraction(0))

    def trials(self, steps: Steps, program: Program) -> Iterator[list[tuple[float, ...]]]:
        """Yield sequences of rows from `init` on: inside, NaN, at the border, beyond, after it."""
        controller, trial = EvaluatedController(program), _Trial(self, steps)
        yield list(trial.rows(controller))
        for name in () if self.untested else self.set_points:
            controller.start()
            moved = trial.row(controller, 0.25, {name: self.set_points[name] + 1.0})
            yield [(*moved, *trial.sent([x.start for x in steps.of_sort("drive")]))]

    def inside(self, steps: Steps, count: int) -> Iterator[list[float]]:
        """Yield values of the ports inside the region, as long as memory is near rest."""
        draw, trial = np.random.default_rng(1), _Trial(self, steps)
        for _ in range(count):
            offs = {x.symbol: float(draw.normal()) for x in trial.measured}
            numbers = [x.rest + offs.get(x.symbol, 0.0) for x in self.known]
            size = 0.9 / math.sqrt(float(self.value(numbers, first=False)))
            off = {x.symbol: x.rest + size * offs[x.symbol] for x in trial.measured}
            yield list(trial.ports_at(off))


class _Trial:
    """The rows of a self-test."""

    TARGETS = (0.25, math.nan, 0.5, -1.0, 1.0, 0.25, 0.5)
    """W of each row; -1 and 1: so little inside and outside of the border that rounding allows."""

    def __init__(self, guard: RegionGuard, steps: Steps) -> None:
        self.guard, self.steps = guard, steps
        self.outer = steps.precision.outside
        self.ports = [*steps.of_sort("reference"), *steps.of_sort("measured")]
        self.measured = [x for x in guard.known if x.symbol.startswith("measured")]

    def rows(self, controller: EvaluatedController) -> Iterator[tuple[float, ...]]:
        """Yield the rows of one sequence."""
        guard, left = self.guard, False
        sent = [drive.start for drive in self.steps.of_sort("drive")]
        for target in self.TARGETS:
            margin = 4.0 * guard.delta
            level = guard.limit + target * margin if abs(target) == 1.0 else target * guard.limit
            row = self.row(controller, level, {})
            untested = any(controller.value(x) for x in guard.untested)
            if not (left or untested or math.isnan(target)):
                found = self._value(controller, row)
                if abs(found - Fraction(guard.limit)) < Fraction(guard.delta):
                    continue  # rounding decides
                left = found > Fraction(guard.limit)
            sent = self.sent(sent) if left else list(controller.step(*row))
            yield (*row, *sent)

    def sent(self, before: Sequence[float]) -> list[float]:
        """Return the drives after a refused state."""
        values = (self.guard.fallback[drive.symbol] for drive in self.steps.of_sort("drive"))
        return [
            float(self.outer(last if value is None else value))
            for value, last in zip(values, before, strict=True)
        ]

    def row(
        self, controller: EvaluatedController, level: float, values: Mapping[str, float]
    ) -> tuple[float, ...]:
        """Return values of the ports at which W is a level, if any are."""
        size = 1.0
        if not math.isnan(level):
            # W is a quadratic of the size of the deviations.
            at = [float(self._value(controller, self._row(values, x))) for x in (-1, 0, 1)]
            a, b, c = (at[0] + at[2]) / 2 - at[1], (at[2] - at[0]) / 2, at[1]
            size = (-b + math.sqrt(max(b * b - 4.0 * a * (c - level), 0.0))) / (2.0 * a)
        row = self._row(values, size)
        lost = len(row) - 1 if math.isnan(level) and self.steps.of_sort("measured") else len(row)
        return tuple(math.nan if k == lost else x for k, x in enumerate(row))

    def _row(self, values: Mapping[str, float], size: float) -> tuple[float, ...]:
        off = {x.symbol: x.rest + size * self._far(x) for x in self.measured}
        return self.ports_at({**values, **off})

    def ports_at(self, values: Mapping[str, float]) -> tuple[float, ...]:
        """Return values of the ports, set points as they are proved."""
        given = {**self.guard.set_points, **values}
        return tuple(float(self.outer(given.get(port.symbol, 0.0))) for port in self.ports)

    def _far(self, known: Known) -> float:
        """Return a deviation from rest along a measured value alone, about to the border."""
        column = self.guard.known.index(known)
        weights = [row[column - k] for k, row in enumerate(self.guard.factor) if k <= column]
        return 1.0 / math.hypot(*weights) * (1.0 if column % 2 else -1.0)

    def _value(self, controller: EvaluatedController, row: Sequence[float]) -> Fraction:
        ports = dict(zip((port.symbol for port in self.ports), row, strict=True))
        numbers = [
            ports[x.symbol] if x.symbol in ports else controller.value(x.symbol)
            for x in self.guard.known
        ]
        first = any(x.first and controller.value(x.first) for x in self.guard.known)
        return self.guard.value(numbers, first=first)


def _sum(weights: Iterable[tuple[int, float]], values: Sequence[Node]) -> Node:
    """Return Σ weight · value."""
    products = [constant(weight) * values[k] for k, weight in weights if weight]
    return reduce(add, products) if products else constant(0.0)


def step_name(*, guarded: bool) -> str:
    """Return the name of the function to call in each period, after the prefix."""
    return GUARDED_STEP if guarded else "step"
