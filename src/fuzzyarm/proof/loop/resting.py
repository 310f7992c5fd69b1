"""The rest of a loop in floats, by Newton's method: not trusted.

Its result is the midpoint of an interval in which the checker proves that a rest exists.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import compress

import numpy as np

from fuzzyarm.control.controllers.floats import Floats
from fuzzyarm.control.controllers.text import ports_of
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.plant.plant import Address
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.loop.enclosure import Vector
from fuzzyarm.proof.loop.period import LoopAlgebra, LoopPeriod
from fuzzyarm.symbolic.evaluation import evaluate

STEPS = 60
"""Most Newton steps."""


class _Unlimited(Floats, LoopAlgebra[float]):
    """Floats, with all limits ignored."""

    def __init__(self, conclusion: Callable[[RuleBase, str, Mapping[str, float]], float]) -> None:
        super().__init__()
        self.conclusion = conclusion

    def divide(self, a: float, b: float) -> float:
        """Return a quotient; NaN for a divisor of 0."""
        return a / b if b else math.nan

    def limit(self, x: float, low: float, high: float) -> float:
        """Return it unchanged."""
        return x

    def rate_limited(self, x: float, before: float, most: float) -> float:
        """Return it unchanged."""
        return x

    def error(self, x: float, size: float) -> float:
        """Return it unchanged."""
        return x

    def rules(self, rulebase: RuleBase, inputs: Mapping[str, float]) -> list[float]:
        """Return the outputs of a rule base."""
        return [self.conclusion(rulebase, output.name, inputs) for output in rulebase.outputs]


def rest_in_floats(
    problem: LoopProblem,
    memory: Sequence[str],
    conclusion: Callable[[RuleBase, str, Mapping[str, float]], float],
) -> dict[str, float]:
    """Return an approximate rest: states of the plant, then memory."""
    names = [*problem.states, *memory]
    period = LoopPeriod[float](problem, _Unlimited(conclusion))

    def motion(y: Vector) -> Vector:
        return np.array(_motion(problem, period, memory, dict(zip(names, y.tolist(), strict=True))))

    for states in _guesses(problem):
        guess = np.array([*states, *_still(period, memory, states)])
        y = _root(motion, guess, len(states))
        if y is not None:
            return dict(zip(names, y.tolist(), strict=True))
    raise unread_state(_still_states(problem, motion, guess)) or LoopProofError(
        "no rest of the loop was found",
        hint="--at PORT=X gives set points that it can hold; `check` finds gains that are too big",
    )


def _still_states(
    problem: LoopProblem, motion: Callable[[Vector], Vector], y: Vector
) -> Sequence[str]:
    """Return the states on which nothing depends."""
    pushes = np.diag(np.maximum(np.abs(y), 1.0))[: len(problem.states)]
    try:
        still = [bool((motion(y + push) == motion(y)).all()) for push in pushes]
    except (ArithmeticError, ValueError):  # the guess may be outside the domain
        return []
    return [*compress(problem.states, still)]


def unread_state(names: Sequence[str]) -> LoopProofError | None:
    """Return the error of a loop at rest for any value of a state, such as a speed loop."""
    if not names:
        return None
    message = f"the loop rests at any '{names[0]}', since nothing reads it"
    return LoopProofError(message, hint="a plant of your own without this state has one rest")


@np.errstate(all="ignore")  # a value that is not finite ends the search
def _root(
    motion: Callable[[Vector], Vector], y: Vector, states: int, *, squares: bool = False
) -> Vector | None:
    """Return a point of rest by Newton's method from a guess; None without convergence."""
    scale = np.maximum(np.abs(y), 1.0)
    last, damping = math.inf, 1.0
    for _ in range(STEPS):
        try:
            f = motion(y)
            slopes = np.array(
                [(motion(y + h) - motion(y - h)) / (2.0 * h.sum()) for h in np.diag(1e-6 * scale)]
            ).T
            if not (np.isfinite(f).all() and np.isfinite(slopes).all()):
                break
            if squares:
                step = np.asarray(np.linalg.lstsq(slopes, -f, rcond=None)[0], float)
            else:
                step = np.linalg.solve(slopes, -f)
        except (ArithmeticError, ValueError, np.linalg.LinAlgError):
            break
        if not np.isfinite(step).all():
            break
        is_rounding = bool((np.abs(f) <= 1e-14 * (np.abs(slopes) @ np.abs(y))).all())
        # At most half of the distance to the end of a domain, as of a root or a limit.
        first = np.abs(step[:states]) / np.maximum(np.abs(y[:states]), 0.01)
        part = min(1.0, 0.5 / max(float(first.max(initial=0.0)), 0.5))
        size = float(np.abs(step / np.maximum(np.abs(y + step * part), 1e-3)).max())
        # Next to an edge of a surface, steps from either side overshoot.
        damping *= 0.5 if last <= size and 1e-9 <= size <= 1e-2 else 1.0
        y = y + step * part * damping
        # Rounding errors of large values move small ones: then steps stop shrinking.
        if size < 1e-12 or (last <= size and (size < 1e-9 or is_rounding)):
            return y
        last = size
    return None


def _guesses(problem: LoopProblem) -> Iterator[list[float]]:
    """Yield guesses of the states."""
    yield _guess(problem, True)
    # At the middle of a wide range rules may be flat: then from the set points alone.
    states = _guess(problem, False)
    yield states
    # Rules are flat far from set points that are not states by name.
    y = _balance(problem, states)
    if y is not None:
        yield y[: len(states)].tolist()


def _balance(problem: LoopProblem, states: Sequence[float]) -> Vector | None:
    """Return states and inputs of a plant at rest with its outputs at their set points."""
    site, equations, model = problem.site, problem.equations, problem.text.model
    read = {site.find(model, "reference", port) for port in ports_of(model, "reference")}

    def motion(y: Vector) -> Vector:
        states, inputs = y[: len(problem.states)].tolist(), y[len(problem.states) :].tolist()
        values, outputs = _outputs_of(problem, dict(zip(problem.states, states, strict=True)))
        values |= dict(zip(equations.inputs, inputs, strict=True))
        rates = [evaluate(root, values) for root in equations.rates]
        return np.array(
            [*rates, *(outputs[a] - problem.set_point[a] for a in outputs if a in read)]
        )

    idle = [port.idle for port in site.interface.inputs.values()]
    # With more equations than unknowns, as for a tracked rate, the equations agree.
    return _root(motion, np.array([*states, *idle]), len(states), squares=True)


def _guess(problem: LoopProblem, middles: bool) -> list[float]:
    """Return a guess of the states: the set point, else the middle of the sensor's range or 0."""
    interface = problem.site.interface
    guess = dict.fromkeys(problem.states, 0.0)
    for address, port in interface.outputs.items():
        if address[1] in guess:
            middle = 0.5 * (port.low + port.high)
            guess[address[1]] = middle if middles and math.isfinite(middle) else 0.0
            set_point = problem.set_point.get(address, 0.0)
            if set_point:
                guess[address[1]] = set_point
    return list(guess.values())


def _still(
    period: LoopPeriod[float], memory: Sequence[str], states: Sequence[float]
) -> list[float]:
    """Return a guess of the memory: the first reading where it starts as that, else 0."""
    begun = [name for name in memory if math.isnan(period.memory[name])]
    if not begun:
        return [0.0] * len(memory)
    problem = period.problem
    _, outputs = _outputs_of(problem, dict(zip(problem.states, states, strict=True)))
    _, after = period.run(outputs, {}, first=True)
    return [after[name] if name in begun else 0.0 for name in memory]


def _outputs_of(
    problem: LoopProblem, states: Mapping[str, float]
) -> tuple[dict[str, float], dict[Address, float]]:
    """Return the values of all symbols but the inputs, and the outputs of the plant."""
    equations, interface = problem.equations, problem.site.interface
    values = problem.constants
    values |= {k: states[n] for k, n in zip(equations.states, problem.states, strict=True)}
    outputs = {
        address: evaluate(root, values)
        for address, root in zip(interface.outputs, equations.outputs, strict=True)
    }
    return values, outputs


def _motion(
    problem: LoopProblem,
    period: LoopPeriod[float],
    memory: Sequence[str],
    states: Mapping[str, float],
) -> list[float]:
    """Return the rates of the plant and the steps of the memory."""
    values, outputs = _outputs_of(problem, states)
    equations = problem.equations
    before = {name: states.get(name, start) for name, start in period.memory.items()}
    inputs, after = period.run(outputs, before)
    values |= dict(zip(equations.inputs, inputs.values(), strict=True))
    rates = [evaluate(root, values) for root in equations.rates]
    return [*rates, *(after[name] - states[name] for name in memory)]
