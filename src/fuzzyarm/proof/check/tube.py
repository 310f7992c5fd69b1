"""Boxes of starts that are followed, sample by sample, by sets that hold all of their runs.

A set is a zonotope: affine forms of the plant's states and of what the controller remembers, over
the same symbols (:mod:`.forms`). The controller's program is walked with such forms. Of an affine
plant the motion over a period is its matrix exponential; of others it is a series of second order
with a bounded remainder from the middle of the set, and slopes all over a box that no motion leaves
(mean value theorem). Symbols that count least become the sides of a box when there are many.

Sources: R. E. Moore, R. B. Kearfott and M. J. Cloud, *Introduction to Interval Analysis*, SIAM
2009; A. Girard, "Reachability of uncertain linear systems using zonotopes", *Hybrid Systems:
Computation and Control*, 2005.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from flint import arb, fmpq
from numpy.typing import NDArray

from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.proof.check.certificate import Pair, RegionProof
from fuzzyarm.proof.check.forms import Form, FormNumbers, combined
from fuzzyarm.proof.check.loop import CheckedLoop
from fuzzyarm.proof.check.motion import (
    around_motion,
    flow_over,
    is_affine,
    jacobian_of,
    parameters_of,
)
from fuzzyarm.proof.check.numbers import (
    ONE,
    ZERO,
    Matrix,
    Number,
    exact,
    greatest,
    is_zero,
    least,
    magnitude,
    middle,
    precisely,
    product,
    radius,
    square,
    transposed,
)
from fuzzyarm.proof.check.rules import RuleSurfaces
from fuzzyarm.proof.check.slopes import Slope, slopes_of
from fuzzyarm.proof.check.walk import ProgramWalk
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.claim.text import claimed_in, claimed_port
from fuzzyarm.proof.stop import check_time
from fuzzyarm.symbolic.nodes import symbols

__all__ = ["Arrival", "Follower", "Haven", "covered"]

MOST_SYMBOLS = 16
"""Symbols for each state above which a set is made simpler."""

STEPS = 4
"""Steps of second order in a period, of what begins in the middle of a set."""

Box = Sequence[Pair]


class Haven(NamedTuple):
    """A proved region, as somewhere to arrive."""

    loop: CheckedLoop
    proof: RegionProof


class Arrival(NamedTuple):
    """When a box has arrived: after some periods, in a region (with V at most) or in boxes."""

    periods: int
    region: int | None = None
    level: Number = ONE


class Follower:
    """A loop, followed set by set.

    Parameters
    ----------
    problem : LoopProblem
        The loop.
    havens : sequence of Haven
        Regions in which its runs may arrive.
    surfaces : RuleSurfaces, optional
        Of its rule bases, where they have been cut already.

    Attributes
    ----------
    memory : list of str
        Symbols of what is remembered and read.
    """

    @precisely
    def __init__(
        self, problem: LoopProblem, havens: Sequence[Haven] = (),
        surfaces: RuleSurfaces | None = None,
    ) -> None:  # fmt: skip
        self.problem, self.havens = problem, havens
        self.walk = ProgramWalk(problem)
        self.numbers = FormNumbers(surfaces or RuleSurfaces())
        equations = problem.equations
        if any("t" in symbols(root) for root in (*equations.rates, *equations.outputs)):
            raise LoopProofError("the plant's equations depend on the time")
        self.parameters = parameters_of(problem)
        self._fixed = {key: Slope(x, {}) for key, x in self.parameters.items()}
        start = [self.numbers.number(span.low) for span in problem.start.values()]
        self.memory = list(self.walk.states)
        self._controlled(start, [self.numbers.number(x) for x in self.walk.states.values()])
        self.memory = [name for name in self.walk.states if name in self.walk.states_read]
        self._goals = list(map(self._goal, havens))

    @cached_property
    def _flow(self) -> tuple[Matrix, Matrix] | None:
        """Of an affine plant: its matrix over a period, and Σ hᵏ⁺¹ Jᵏ/(k+1)!; else nothing."""
        equations = self.problem.equations
        rest = dict.fromkeys((*equations.states, *equations.inputs), ZERO)
        try:
            jacobian = jacobian_of(self.problem, self.parameters | rest)
        except LoopProofError:  # it has no slopes there
            return None
        if not is_affine(self.problem, jacobian):
            return None
        count, h = len(equations.states), exact(self.problem.period)
        flow = flow_over(jacobian, h)
        # The same of the rates as inputs that are held: x' = J x + r.
        units = [[*row[:count], *(fmpq(int(i == j)) for j in range(count))]
                 for i, row in enumerate(jacobian)]  # fmt: skip
        return flow, [row[count:] for row in flow_over(units, h)]

    # --- one period ---

    def _controlled(
        self, states: Sequence[Form], memory: Sequence[Form], *, first: bool = True
    ) -> tuple[list[Form], list[Form]]:
        """Return the inputs of the plant, and the memory afterwards."""
        problem, interface = self.problem, self.problem.site.interface
        outputs = self._outputs(states)
        for output, port in zip(outputs, interface.outputs.values(), strict=True):
            if not magnitude(output.span) <= arb(port.bound):
                raise LoopProofError("an output may be beyond its bound")
        inputs, after = self.walk.period(
            self.numbers,
            dict(zip(problem.site.interface.outputs, outputs, strict=True)),
            dict(zip(self.memory, memory, strict=True)),
            first=first,
        )
        return [inputs[a] for a in interface.inputs], [after[name] for name in self.memory]

    def _outputs(self, states: Sequence[Form]) -> list[Form]:
        """Return the outputs of the plant, by their slopes at a set of its states."""
        equations = self.problem.equations
        by_name = dict(zip(equations.states, states, strict=True))
        outputs = []
        for root in equations.outputs:
            if getattr(root, "name", "") in by_name:
                outputs.append(by_name[getattr(root, "name", "")])
                continue
            over, at = (
                slopes_of([root], self._fixed | {
                    key: Slope(x.span if wide else x.centre, {key: ONE} if wide else {})
                    for key, x in by_name.items()
                })[0]
                for wide in (True, False)
            )  # fmt: skip
            row = [over.along.get(key, ZERO) for key in equations.states]
            outputs.append(self._moved([row], states, [at.value])[0])
        return outputs

    def _moved(self, matrix: Matrix, forms: Sequence[Form], ends: Sequence[Number]) -> list[Form]:
        """Return ends and slopes times deviations; what slopes may be off is a symbol."""
        moved = []
        for row, end in zip(matrix, ends, strict=True):
            off = sum((arb(radius(x)) * form.reach for x, form in zip(row, forms, strict=True)),
                      arb(0))  # fmt: skip
            terms = [(Form(arb(0), form.weights), middle(x))
                     for x, form in zip(row, forms, strict=True)]  # fmt: skip
            moved.append(combined((Form(end, {}), ONE), *terms,
                                  (self.numbers.symbol(off + radius(end)), ONE)))  # fmt: skip
            moved[-1] = moved[-1]._replace(centre=arb(middle(moved[-1].centre)))
        return moved

    def _period(
        self, now: Sequence[Form], *, first: bool, port: str
    ) -> tuple[list[Form], tuple[Number, Number]]:
        """Return the set a period later, and where a port is within the period."""
        problem, count = self.problem, len(self.problem.states)
        states = list(now[:count])
        drives, after = self._controlled(states, now[count:], first=first)
        if not self.walk.states_read <= set(self.memory):
            raise LoopProofError("the program reads a value that is not followed")
        span = self._within(states, drives, port) if port else (ZERO, ZERO)
        x, u = [s.centre for s in states], [s.centre for s in drives]
        if self._flow is not None:
            flow, ends = self._flow[0], self._ahead(x, u)
        else:
            moving = self._around([s.span for s in states], [s.span for s in drives])
            flow = flow_over(jacobian_of(problem, moving), exact(problem.period))
            ends = self._followed(x, u)
        return [*self._moved(flow, [*states, *drives], ends), *after], span

    def _symbols(self, states: Sequence[Number], inputs: Sequence[Number]) -> dict[str, Number]:
        equations = self.problem.equations
        return {
            **self.parameters,
            **dict(zip(equations.states, states, strict=True)),
            **dict(zip(equations.inputs, inputs, strict=True)),
        }

    def _around(self, states: Sequence[Number], inputs: Sequence[Number]) -> dict[str, Number]:
        return around_motion(self.problem, self._symbols(states, inputs))

    def _ahead(self, x: Sequence[Number], u: Sequence[Number]) -> list[Number]:
        """Return where an affine plant is a period later, from one point."""
        assert self._flow is not None
        values = {k: Slope(value, {}) for k, value in self._symbols(x, u).items()}
        rates = [[rate.value] for rate in slopes_of(self.problem.equations.rates, values)]
        return [a + b[0] for a, b in zip(x, product(self._flow[1], rates), strict=True)]

    def _followed(self, x: Sequence[Number], u: Sequence[Number]) -> list[Number]:
        """Return where the plant is a period later, from one point: x + h f + ½ h² f' f."""
        equations, problem = self.problem.equations, self.problem
        h = exact(problem.period) / STEPS
        at = list(x)
        for _ in range(STEPS):
            box = around_motion(problem, self._symbols(at, u), h)
            over = slopes_of(equations.rates, {
                k: Slope(s, {k: ONE} if k in equations.states else {}) for k, s in box.items()
            })  # fmt: skip
            begin = slopes_of(
                equations.rates, {k: Slope(s, {}) for k, s in self._symbols(at, u).items()}
            )
            # x'' = f'(x) f(x), over the box: the remainder of second order in Lagrange's form.
            bends = product([[s.along.get(k, ZERO) for k in equations.states] for s in over],
                            [[s.value] for s in over])  # fmt: skip
            at = [
                a + rate.value * h + bend[0] * (h * h / 2)
                for a, rate, bend in zip(at, begin, bends, strict=True)
            ]
        return at

    def _within(
        self, states: Sequence[Form], drives: Sequence[Form], port: str
    ) -> tuple[Number, Number]:
        """Return where an output or a drive is from this sample to the next."""
        equations, interface = self.problem.equations, self.problem.site.interface
        for address, drive in zip(interface.inputs, drives, strict=True):
            if interface.label(address) == port:
                low, high = (arb(end) for end in drive.ends)
                return arb(least(drive.span)).max(low), arb(greatest(drive.span)).min(high)
        moving = self._around([s.span for s in states], [s.span for s in drives])
        index = [interface.label(address) for address in interface.outputs].index(port)
        values = {key: Slope(span, {}) for key, span in moving.items()}
        span = slopes_of([equations.outputs[index]], values)[0].value
        return least(span), greatest(span)

    def _fewer(self, forms: Sequence[Form]) -> list[Form]:
        """Return a set of few symbols that holds one: those that count least become a box."""
        size = len(forms)
        symbols = sorted({symbol for form in forms for symbol in form.weights})
        if len(symbols) <= MOST_SYMBOLS * size:
            return list(forms)
        plain = np.array([[float(middle(form.weights.get(s, ZERO))) for s in symbols]
                          for form in forms])  # fmt: skip
        lengths = np.abs(plain).sum(axis=1)
        lengths[lengths == 0.0] = 1.0
        scaled = np.abs(plain) / lengths[:, None]
        order = np.argsort(-(scaled.sum(axis=0) - scaled.max(axis=0)))
        kept = {symbols[k] for k in order[: MOST_SYMBOLS * size // 2]}
        fewer = []
        for form in forms:
            off = sum((magnitude(x) for s, x in form.weights.items() if s not in kept), arb(0))
            weights = {s: x for s, x in form.weights.items() if s in kept}
            side = self.numbers.symbol(off + radius(form.centre))
            fewer.append(Form(arb(middle(form.centre)), {**weights, **side.weights}))
        return fewer

    # --- a box ---

    @precisely
    def arrival(
        self, box: Box, periods: int, *, claim: LoopClaim | None = None,
        into: Sequence[int] | None = None, boxes: Sequence[Box] = (),
        arrived: Callable[[int, Number], bool] | None = None,
    ) -> Arrival:  # fmt: skip
        """Follow a box of starts until all of its runs have arrived.

        Parameters
        ----------
        box : sequence of (Fraction, Fraction)
            Of each state of the plant; memory is as it begins.
        periods : int
            For how long at most.
        claim : LoopClaim, optional
            What has to hold of an output on the way.
        into : sequence of int, optional
            Numbers of regions that count; all by default.
        boxes : sequence of boxes
            Whose runs are known to arrive; only of a loop that remembers nothing.
        arrived : callable, optional
            Whether a number of periods and a bound of V are enough.

        Raises
        ------
        LoopProofError
            If that is not shown.
        """
        port, first, last = "", 0, None
        if claim is not None and claim.output:
            port = claimed_port(self.problem, claim)
            first, last = claimed_in(self.problem, claim)
        now = self._begin(box)
        allowed = range(len(self.havens)) if into is None else into
        for k in range(periods + 1):
            check_time()
            for number in allowed if k or not self.walk.begun else ():
                level = self._level(number, now)
                if level is not None and (arrived is None or arrived(k, level)):
                    return Arrival(k, number, level)
            if boxes and k and self._is_in(now, boxes):
                return Arrival(k)
            if k == periods:
                break
            counts = port and k >= first and (last is None or k <= last)
            after, (low, high) = self._period(now, first=k == 0, port=port if counts else "")
            if counts and claim is not None:
                if not (exact(claim.low) <= low and high <= exact(claim.high)):
                    raise LoopProofError(f"in period {k + 1} the claim is not shown")
                if k == last and not allowed:
                    return Arrival(k + 1)
            now = self._fewer(after)
        raise LoopProofError(f"it has not arrived after {periods} periods")

    def _begin(self, box: Box) -> list[Form]:
        spans = [(exact(low), exact(high)) for low, high in box]
        if len(spans) != len(self.problem.states) or any(low > high for low, high in spans):
            raise LoopProofError("it is not a box of the plant's states")
        forms = [
            self.numbers.symbol((high - low) / 2)._replace(centre=arb((low + high) / 2))
            for low, high in spans
        ]
        return [*forms, *(self.numbers.number(self.walk.states[name]) for name in self.memory)]

    def _goal(self, haven: Haven) -> tuple[list[int], list[int], NDArray[Any]]:
        """Return the coordinates of a region's z, of memory that stays, and F: near P = Fᵀ F."""
        places = {name: k for k, name in enumerate((*self.problem.states, *self.memory))}
        memory = haven.proof.evidence.memory
        known = [places.get(memory.get(name, name)) for name in haven.proof.states]
        if any(k is None for k in known):
            raise LoopProofError("a region of memory that is not read")
        order = [k for k in known if k is not None]
        plain = np.array([[float(x) for x in row] for row in haven.proof.p])
        scale = np.sqrt(np.diag(plain))  # states differ in unit by orders of magnitude
        factor = np.linalg.cholesky(plain / scale[:, None] / scale[None, :]).T * scale[None, :]
        return order, [k for k in range(len(places)) if k not in order], factor

    def _level(self, number: int, now: Sequence[Form]) -> Number | None:
        """Return V at most in a set that is in a region; None: it is not shown to be."""
        (loop, proof), (order, still, factor) = self.havens[number], self._goals[number]
        z = [
            combined((now[k], ONE), (Form(loop.rest[name], {}), -ONE))
            for k, name in zip(order, proof.states, strict=True)
        ]
        plain = factor @ np.array([float(middle(x.centre)) for x in z])
        if plain @ plain > 1.0:  # in floats: no more than a hint that it is worth while
            return None
        for k in still:
            begun = exact(self.walk.states[self.memory[k - len(self.problem.states)]])
            if now[k].weights or not is_zero(now[k].centre - begun):
                return None
        # V = |F z|² + zᵀ (P − Fᵀ F) z, where the second is next to nothing.
        rows = [[exact(float(x)) for x in row] for row in factor]
        entries = [combined(*zip(z, row, strict=True)).span for row in rows]
        level = sum((square(arb(x)) for x in entries), arb(0))
        square_of = product(transposed(rows), rows)
        spans = [x.span for x in z]
        for i, row in enumerate(proof.p):
            for j, weight in enumerate(row):
                level += spans[i] * spans[j] * (exact(weight) - square_of[i][j])
        level = greatest(level)
        return level if level <= 1 else None

    def _is_in(self, now: Sequence[Form], boxes: Sequence[Box]) -> bool:
        if self.memory:
            return False
        spans = [(least(x.span), greatest(x.span)) for x in now]
        return covered(spans, [[(exact(low), exact(high)) for low, high in box] for box in boxes])


def covered(
    box: Sequence[tuple[Number, Number]], boxes: Sequence[Sequence[tuple[Number, Number]]]
) -> bool:
    """Tell whether all of a box is in the union of some: cut at their sides until each part is."""
    near = [other for other in boxes if not _is_apart(box, other)]
    if not near:
        return False
    return all(covered(outside, near[1:]) for outside in _parts_outside(box, near[0]))


def _is_apart(box: Sequence[tuple[Number, Number]], other: Sequence[tuple[Number, Number]]) -> bool:
    return any(a[1] < b[0] or b[1] < a[0] for a, b in zip(box, other, strict=True))


def _parts_outside(
    box: Sequence[tuple[Number, Number]], other: Sequence[tuple[Number, Number]]
) -> Iterator[list[tuple[Number, Number]]]:
    """Yield boxes that hold all of a box that is outside another one."""
    rest = list(box)
    for k, (low, high) in enumerate(other):
        if not rest[k][0] >= low:
            yield [*rest[:k], (rest[k][0], low), *rest[k + 1 :]]
            rest[k] = (low, rest[k][1])
        if not rest[k][1] <= high:
            yield [*rest[:k], (high, rest[k][1]), *rest[k + 1 :]]
            rest[k] = (rest[k][0], high)
