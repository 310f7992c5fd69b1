"""Rule bases and loops a second time, in NumPy, from their definition in the pages of docs.

Nothing of the package is imported. A loop is drawn as these records; they print the files that the
package reads, and run many starts at once by themselves: rules in closed form, affine plants by
the matrix exponential, other plants by steps far below their fastest time constant.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

Vector = NDArray[np.float64]

NORMS = {
    "min": np.minimum,
    "product": np.multiply,
    "bounded": lambda a, b: np.maximum(0.0, a + b - 1.0),
    "hamacher": lambda a, b: np.where(
        (a + b) > 0.0, a * b / np.where(a + b - a * b > 0.0, a + b - a * b, 1.0), 0.0
    ),
    "einstein": lambda a, b: a * b / (2.0 - (a + b - a * b)),
}
DUALS = {
    "max": np.maximum,
    "probor": lambda a, b: a + b - a * b,
    "bounded": lambda a, b: np.minimum(1.0, a + b),
}

# ── rules ────────────────────────────────────────────────────────────────────────────


@dataclass(frozen=True)
class Term:
    """A straight term by its corners: ``trapezoid a b c d``, ``singleton a``, ``linear`` rows."""

    name: str
    kind: str
    numbers: tuple[float, ...]

    def degree(self, x: Vector) -> Vector:
        """Membership, 1 on a vertical edge."""
        a, b, c, d = self.corners
        with np.errstate(invalid="ignore"):
            up = (x - a) / (b - a) if a < b and math.isfinite(a) else np.where(x >= b, 1.0, 0.0)
            down = (d - x) / (d - c) if c < d and math.isfinite(d) else np.where(x <= c, 1.0, 0.0)
        return np.clip(np.minimum(up, down), 0.0, 1.0)

    @property
    def corners(self) -> tuple[float, float, float, float]:
        """As a trapezoid."""
        numbers = self.numbers
        if self.kind == "triangle":
            return (numbers[0], numbers[1], numbers[1], numbers[2])
        return numbers

    @property
    def text(self) -> str:
        """As a file has it, without the words ``term VARIABLE``."""
        return f"{self.name}: {self.kind} {' '.join(map(repr, self.numbers))}"


@dataclass(frozen=True)
class Variable:
    """An input or an output."""

    name: str
    low: float
    high: float
    terms: tuple[Term, ...]
    outside: str = "clamp"


@dataclass(frozen=True)
class Rule:
    """Terms of inputs by index, each perhaps negated; the term of the output; its weight."""

    parts: tuple[tuple[int, bool, int], ...]
    then: int
    joint: str = "and"
    weight: float = 1.0


@dataclass(frozen=True)
class Rules:
    """A rule base of one output."""

    name: str
    inputs: tuple[Variable, ...]
    output: Variable
    rules: tuple[Rule, ...]
    way: str = "weighted-average"
    aggregation: str = "max"
    both: str = "min"
    either: str = "max"
    no_rule: str = "error"

    @property
    def text(self) -> str:
        """The file."""
        lines = [f"rulebase {self.name}"]
        for variable, word in [*((v, "input") for v in self.inputs), (self.output, "output")]:
            lines.append(f"{word} {variable.name} {variable.low!r} .. {variable.high!r}")
            lines += [f"term {variable.name} {term.text}" for term in variable.terms]
            lines.append(f"inference {variable.name}: outside {variable.outside}")
        lines.append(f"inference and {self.both}, or {self.either}, implication min")
        way = self.way + (" exact" if self.way == "centroid" else "")
        lines.append(
            f"inference {self.output.name}: aggregation {self.aggregation}, defuzzifier {way},"
            f" no-rule {self.no_rule}"
        )
        for rule in self.rules:
            parts = [
                f"{self.inputs[k].name} is {'not ' * negated}{self.inputs[k].terms[t].name}"
                for k, negated, t in rule.parts
            ]
            weight = f" with {rule.weight!r}" if rule.weight != 1.0 else ""
            then = f"{self.output.name} is {self.output.terms[rule.then].name}"
            lines.append(f"rule if {f' {rule.joint} '.join(parts)} then {then}{weight}")
        return "\n".join(lines) + "\n"

    def values(self, *inputs: Vector) -> Vector:
        """The output; NaN where there is no value."""
        seen = []
        none = np.zeros(len(inputs[0]), dtype=bool)
        for variable, x in zip(self.inputs, inputs, strict=True):
            clipped = np.clip(x, variable.low, variable.high)
            if variable.outside == "error":
                none |= clipped != x
            seen.append(x if variable.outside == "extend" else clipped)
        strengths = [self._strength(rule, seen) for rule in self.rules]
        value = self._centroid(strengths) if self.way == "centroid" else self._average(strengths)
        low, high = self.output.low, self.output.high
        empty = np.isnan(value)
        if self.output.outside == "clamp":
            value = np.clip(value, low, high)
        elif self.output.outside == "error":
            value = np.where((value < low) | (value > high), np.nan, value)
        if self.no_rule not in ("error", "hold", "nan"):
            value = np.where(empty, float(self.no_rule), value)
        return np.where(none, np.nan, value)

    def _strength(self, rule: Rule, seen: Sequence[Vector]) -> Vector:
        total: Vector | None = None
        norm = NORMS[self.both] if rule.joint == "and" else DUALS[self.either]
        for k, negated, t in rule.parts:
            degree = self.inputs[k].terms[t].degree(seen[k])
            degree = 1.0 - degree if negated else degree
            total = degree if total is None else norm(total, degree)
        assert total is not None
        return total * rule.weight

    def _average(self, strengths: Sequence[Vector]) -> Vector:
        """Values of the terms, weighed; rules of one term first make one strength."""
        above, below = np.zeros(len(strengths[0])), np.zeros(len(strengths[0]))
        for k, strength in self._joined(strengths).items():
            above += strength * self.output.terms[k].numbers[0]
            below += strength
        if self.way == "weighted-sum":
            return np.where(below > 0.0, above, np.nan)
        return np.where(below > 0.0, above / np.where(below > 0.0, below, 1.0), np.nan)

    def _joined(self, strengths: Sequence[Vector]) -> dict[int, Vector]:
        found: dict[int, Vector] = {}
        for rule, strength in zip(self.rules, strengths, strict=True):
            if rule.then in found:
                join = np.maximum if self.aggregation == "max" else np.add
                found[rule.then] = join(found[rule.then], strength)
            else:
                found[rule.then] = strength
        return found

    def _centroid(self, strengths: Sequence[Vector]) -> Vector:
        """Of the sets cut at the strengths, by Gauss's rule between all of their bends."""
        low, high = self.output.low, self.output.high
        count, terms = len(strengths[0]), self.output.terms
        bends = [np.full(count, x) for x in (low, high)]
        edges = []
        for term in terms:
            a, b, c, d = term.corners
            bends += [np.full(count, x) for x in (a, b, c, d)]
            edges += [(a, b), (d, c)]
        for one, other in ((p, q) for i, p in enumerate(edges) for q in edges[:i]):
            crossing = _crossing(one, other)
            if crossing is not None:
                bends.append(np.full(count, crossing))
        for strength in strengths:
            bends += [foot + strength * (top - foot) for foot, top in edges]
        at = np.sort(np.clip(np.array(bends), low, high), axis=0)
        area, moment = np.zeros(count), np.zeros(count)
        for start, end in pairwise(at):
            middle, half = 0.5 * (start + end), 0.5 * (end - start)
            for side in (-1.0, 1.0):
                x = middle + side * half / math.sqrt(3.0)
                height = self._height(x, strengths)
                area += half * height
                moment += half * height * x
        return np.where(area > 0.0, moment / np.where(area > 0.0, area, 1.0), np.nan)

    def _height(self, x: Vector, strengths: Sequence[Vector]) -> Vector:
        join = np.maximum if self.aggregation == "max" else np.add
        height = np.zeros(len(x))
        for rule, strength in zip(self.rules, strengths, strict=True):
            cut = np.minimum(self.output.terms[rule.then].degree(x), strength)
            height = join(height, cut)
        return height


def _crossing(one: tuple[float, float], other: tuple[float, float]) -> float | None:
    """Where two lines from 0 at the first number to 1 at the second one meet."""
    (a, b), (c, d) = one, other
    # (x - a) / (b - a) = (x - c) / (d - c)
    slope = (d - c) - (b - a)
    return None if slope == 0.0 else (a * (d - c) - c * (b - a)) / slope


# ── the controller ───────────────────────────────────────────────────────────────────


OPERATORS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge}


@dataclass(frozen=True)
class Line:
    """``name = kind of of, options * gain``; ``products`` and ``rules`` take several signals."""

    name: str
    kind: str
    of: tuple[str, ...]
    gain: float = 1.0
    options: Mapping[str, object] = field(default_factory=dict)

    def _of_several(self) -> str:
        options, gain = self.options, f" * {self.gain!r}"
        if self.kind == "sum":
            terms = [
                f"{'-' if s < 0 else '+'} {name} * {abs(s)!r}"
                for s, name in zip(options["signs"], self.of, strict=True)
            ]
            return " ".join(terms).removeprefix("+ ")
        if self.kind == "product":
            return " * ".join(self.of) + gain
        if self.kind == "choice":
            signal, less, number = options["where"]
            return f"{self.of[0]} where {signal} {less} {number!r} else {self.of[1]}"
        return f"rules {options['rules'].name}({', '.join(self.of)})" + gain

    @property
    def text(self) -> str:
        """As a file has it."""
        options = self.options
        if self.kind in ("sum", "product", "choice", "rules"):
            return f"{self.name} = {self._of_several()}"
        words = (
            f"{self.kind} of {self.of[0]}" if self.kind != "measured" else f"measured {self.of[0]}"
        )
        words += f" * {self.gain!r}"
        if "filter" in options:
            words += f", filter {options['filter'] * 1e3!r} ms"
        if "time" in options:
            words += f", time {options['time'] * 1e3!r} ms"
        if "width" in options:
            words += f", width {options['width']!r}"
        if "within" in options:
            words += ", within {!r} .. {!r}".format(*options["within"])
        if "hold" in options:
            words += ", anti-windup hold"
        if "back" in options:
            words += f", anti-windup back {options['back'] * 1e3!r} ms"
        if "start" in options:
            words += f", start {options['start']!r}"
        return f"{self.name} = {words}"


@dataclass(frozen=True)
class Driven:
    """``drive port = signal``, with limits and a slew."""

    port: str
    of: str
    sign: int = 1
    within: tuple[float, float] | None = None
    slew: float | None = None

    @property
    def text(self) -> str:
        """As a file has it."""
        text = f"drive {self.port} = {'-' * (self.sign < 0)}{self.of}"
        if self.within is not None:
            text += f", within {self.within[0]!r} .. {self.within[1]!r}"
        return text + (f", slew {self.slew!r}" if self.slew is not None else "")


@dataclass(frozen=True)
class Seen:
    """What a sensor makes of its port: delay in s, steps, a rate by differences."""

    delay: float = 0.0
    resolution: float = 0.0
    difference: float | None = None


@dataclass(frozen=True)
class Output:
    """A port that is measured; ``of`` is its expression, as the plant's file has it."""

    name: str
    of: str
    low: float = -math.inf
    high: float = math.inf
    rate_of: str = ""


@dataclass(frozen=True)
class OwnPlant:
    """A plant with one input: expressions in Python over x, u and p."""

    states: tuple[str, ...]
    rates: tuple[str, ...]
    outputs: tuple[Output, ...]
    low: float = -math.inf
    high: float = math.inf
    slew: float = math.inf
    parameters: Mapping[str, float] = field(default_factory=dict)
    start: tuple[str, ...] = ()
    bound: float = math.inf
    affine: bool = False
    fastest: float = 10.0
    duration: float = 1.0
    input: str = "u"
    dead: float = 0.0  # dead time of the actuator, s
    begin: float = 0.0  # of the actuator
    undriven: bool = False  # a second actuator, which nothing drives
    error_bound: float = math.inf  # of the first output

    @property
    def idle(self) -> float:
        """The drive before the first period."""
        return min(max(self.begin, self.low), self.high)

    @property
    def text(self) -> str:
        """The file; an object of its own name in each folder."""
        words = f"{self.low!r}, {self.high!r}, {self.slew!r}".replace("inf", "math.inf")
        delay = f", delay={self.dead!r}" if self.dead else ""
        begin = f", start={self.begin!r}" if self.begin else ""
        inputs = [f"{self.input!r}: Port('V', {words}{delay}{begin})"]
        inputs += ["'idle': Port('V', -3.0, 3.0, start=0.5)"] * self.undriven
        outputs = []
        for port in self.outputs:
            words = f"Port('m', {port.low!r}, {port.high!r}"
            words += f", rate_of={port.rate_of!r}" if port.rate_of else ""
            words += f", bound={self.bound!r}"
            words += f", error_bound={self.error_bound!r})" if port is self.outputs[0] else ")"
            outputs.append(f"{port.name!r}: {words.replace('inf', 'math.inf')}")
        lines = [
            "import math",
            "from fuzzyarm.plant import Plant, Port",
            "from fuzzyarm.plant.plant import parameter",
            "",
            "",
            "class Own(Plant):",
            f"    inputs = {{{', '.join(inputs)}}}",
            f"    outputs = {{{', '.join(outputs)}}}",
            f"    states = {dict.fromkeys(self.states, 'm')!r}",
            f"    parameters = {dict(self.parameters)!r}",
            f"    duration = {self.duration!r}",
            "",
        ]
        if self.start:
            lines += ["    def start(self, rng):", f"        return [{', '.join(self.start)}]", ""]
        if [port.of for port in self.outputs] != [f"x[{k}]" for k in range(len(self.outputs))]:
            lines += [
                "    def measure(self, t, x, u, p):",
                f"        return [{', '.join(port.of for port in self.outputs)}]",
                "",
            ]
        lines += [
            "    def derivative(self, t, x, u, p):",
            f"        return [{', '.join(self.rates)}]",
        ]
        return "\n".join(lines) + "\n"


class _Math:
    """Functions of math over arrays."""

    sin, cos, tanh, exp, sqrt, atan, fabs = (
        np.sin,
        np.cos,
        np.tanh,
        np.exp,
        np.sqrt,
        np.arctan,
        np.abs,
    )


def _least(*values: Vector) -> Vector:
    total = values[0]
    for value in values[1:]:
        total = np.minimum(total, value)
    return total


def _most(*values: Vector) -> Vector:
    total = values[0]
    for value in values[1:]:
        total = np.maximum(total, value)
    return total


SPACE = {"math": _Math, "min": _least, "max": _most, "abs": np.abs}


# ── the loop ─────────────────────────────────────────────────────────────────────────


@dataclass(frozen=True)
class Move:
    """A reference that moves: its words in a claim, value and rate by the pages."""

    text: str
    value: Callable[[float], float]
    rate: Callable[[float], float]


def step_move(before: float, after: float, at: float) -> Move:
    """From one value to another."""
    text = f"step {before!r} .. {after!r} at {at!r} s"
    return Move(text, lambda t: after if t >= at * (1 - 1e-12) else before, lambda t: 0.0)


def ramp_move(start: float, rate: float, at: float) -> Move:
    """A value that grows from a time on."""

    def moving(t: float) -> bool:
        return t >= at * (1 - 1e-12)

    return Move(
        f"ramp {start!r} by {rate!r} at {at!r} s",
        lambda t: start + rate * max(t - at, 0.0),
        lambda t: rate if moving(t) else 0.0,
    )


def sine_move(size: float, hertz: float, around: float) -> Move:
    """A wave."""
    w = 2.0 * math.pi * hertz
    return Move(
        f"sine {size!r} at {hertz!r} Hz around {around!r}",
        lambda t: around + size * math.sin(w * t),
        lambda t: size * w * math.cos(w * t),
    )


def quintic_move(values: Sequence[float], times: Sequence[float]) -> Move:
    """Moves from rest to rest, one after the other."""

    def share(s: float) -> tuple[float, float]:
        s = min(max(s, 0.0), 1.0)
        return s**3 * (10.0 - 15.0 * s + 6.0 * s * s), 30.0 * s * s * (1.0 - s) ** 2

    def value(t: float) -> float:
        total, begin = values[0], 0.0
        for a, b, time in zip(values, values[1:], times, strict=False):
            total += (b - a) * share((t - begin) / time)[0]
            begin += time
        return total

    def rate(t: float) -> float:
        total, begin = 0.0, 0.0
        for a, b, time in zip(values, values[1:], times, strict=False):
            if begin <= t <= begin + time:
                total += (b - a) / time * share((t - begin) / time)[1]
            begin += time
        return total

    ends = zip(values, values[1:], times, strict=False)
    return Move(
        "quintic " + ", ".join(f"{a!r} .. {b!r} in {time!r} s" for a, b, time in ends), value, rate
    )


def move_of(kind: str, numbers: Sequence[float]) -> Move:
    """A reference by the numbers that a certificate has of it."""
    last, time, first, *rest = (*numbers, 0.0) if len(numbers) < 3 else numbers
    if kind == "quintic":
        return quintic_move([first, last, *rest[::2]], [time, *rest[1::2]])
    plain = {"step": step_move, "ramp": ramp_move}
    return sine_move(last, time, first) if kind == "sine" else plain[kind](first, last, time)


@dataclass(frozen=True)
class Loop:
    """A controller on a plant."""

    plant: OwnPlant
    period: float
    lines: tuple[Line, ...]
    drives: tuple[Driven, ...]
    sensors: Mapping[str, Seen] = field(default_factory=dict)
    set_point: Mapping[str, float] = field(default_factory=dict)
    connect: Mapping[str, str] = field(default_factory=dict)
    axis: str = "a"
    moves: Mapping[str, Move] = field(default_factory=dict)

    def reference(self, port: str, time: float) -> float:
        """The reference of a port; that of a rate is the rate of the other's."""
        of = next((each.rate_of for each in self.plant.outputs if each.name == port), "")
        if port in self.moves:
            return self.moves[port].value(time)
        return self.moves[of].rate(time) if of in self.moves else self.set_point.get(port, 0.0)

    @property
    def rule_bases(self) -> tuple[Rules, ...]:
        """Those of its lines."""
        return tuple(line.options["rules"] for line in self.lines if line.kind == "rules")

    @property
    def text(self) -> str:
        """The file of the controller."""
        lines = ["controller own", *(f'use {r.name} from "{r.name}.frb"' for r in self.rule_bases)]
        lines += [f"period {self.period * 1e3!r} ms", f"axis {self.axis}"]
        lines += [f"  {line.text}" for line in (*self.lines, *self.drives)]
        return "\n".join(lines) + "\n"


@dataclass
class Course:
    """Runs of a loop.

    Attributes
    ----------
    times : array, shape (n,)
        s; samples, and moments between.
    outputs : dict of str to array, shape (n, runs)
        Of each port.
    drives : array, shape (periods, runs)
        Held from each sample on.
    states : array, shape (periods + 1, n, runs)
        At samples.
    memory : list of dict
        Before each period.
    lost : array of bool
        Where the controller had no value.
    """

    times: Vector
    outputs: dict[str, Vector]
    drives: Vector
    states: Vector
    memory: list[dict[str, Vector]]
    lost: NDArray[np.bool_]


class Runner:
    """Runs of a loop, all starts of a batch at once."""

    def __init__(self, loop: Loop, between: int = 4) -> None:
        self.loop, self.between = loop, between
        plant = loop.plant
        self.rates = [compile(text, "rate", "eval") for text in plant.rates]
        self.measures = [compile(port.of, "output", "eval") for port in plant.outputs]
        # Far below the fastest time constant: errors of fourth order in 1/40.
        self.steps = max(1, math.ceil(loop.period / between * plant.fastest * 40.0))
        self._exact: dict[bytes, Vector] = {}

    def run(
        self,
        states: Vector,
        parameters: Vector,
        periods: int,
        memory: Mapping[str, Vector] | None = None,
    ) -> Course:
        """Run from states (n, runs) with parameters (k, runs), the memory as it begins or given."""
        loop, count = self.loop, states.shape[1]
        x, u = states.copy(), np.full(count, loop.plant.idle)
        remembered: dict[str, Vector] = dict(memory or {})
        lost = np.zeros(count, dtype=bool)
        times, drives, all_states, memories = [], [], [x.copy()], []
        outputs: dict[str, list[Vector]] = {port.name: [] for port in loop.plant.outputs}
        for k in range(periods):
            memories.append(remembered)
            first = k == 0 and memory is None
            self._time = k * loop.period
            u, remembered = self._controlled(x, u, parameters, remembered, first)
            lost |= np.isnan(u)
            u = np.where(np.isnan(u), 0.0, u)
            drives.append(u)
            self._note(times, outputs, k * loop.period, x, u, parameters)
            for j in range(self.between):
                x = self._moved(x, u, parameters, loop.period / self.between)
                moment = (k + (j + 1) / self.between) * loop.period
                self._note(times, outputs, moment, x, u, parameters)
            all_states.append(x.copy())
        columns = {name: np.array(rows) for name, rows in outputs.items()}
        for port in loop.moves:
            wanted = np.array([loop.reference(port, time) for time in times])
            columns[f"error of {port}"] = wanted[:, None] - columns[port]
        return Course(
            np.array(times),
            columns,
            np.array(drives),
            np.array(all_states),
            memories,
            lost,
        )

    def _note(
        self, times: list, outputs: dict, moment: float, x: Vector, u: Vector, p: Vector
    ) -> None:
        times.append(moment)
        for name, value in self.measured(x, u, p).items():
            outputs[name].append(value)

    def measured(self, x: Vector, u: Vector, p: Vector) -> dict[str, Vector]:
        """Outputs of the plant."""
        space = {**SPACE, "x": x, "u": [u, 0.0], "p": p}
        return {
            port.name: np.broadcast_to(eval(code, space), x.shape[1:])
            for port, code in zip(self.loop.plant.outputs, self.measures, strict=True)
        }

    # --- the plant ---

    def _rates(self, x: Vector, u: Vector, p: Vector) -> Vector:
        space = {**SPACE, "x": x, "u": [u, 0.0], "p": p}
        rows = [np.broadcast_to(eval(code, space), x.shape[1:]) for code in self.rates]
        return np.array(rows)

    def _moved(self, x: Vector, u: Vector, p: Vector, time: float) -> Vector:
        if self.loop.plant.affine:
            return self._by_exponential(x, u, p, time)
        h = time / self.steps
        with np.errstate(all="ignore"):
            for _ in range(self.steps):
                a = self._rates(x, u, p)
                b = self._rates(x + 0.5 * h * a, u, p)
                c = self._rates(x + 0.5 * h * b, u, p)
                d = self._rates(x + h * c, u, p)
                x = x + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
        return np.where(np.isfinite(x), x, 1e300)

    def _by_exponential(self, x: Vector, u: Vector, p: Vector, time: float) -> Vector:
        """The motion of x' = A x + B u + c, by the exponential of [[A, B, c], 0]."""
        size = len(x)
        if p.size and (p != p[:, :1]).any():
            parts = [
                self._by_exponential(x[:, i : i + 1], u[i : i + 1], p[:, i : i + 1], time)
                for i in range(x.shape[1])
            ]
            return np.concatenate(parts, axis=1)
        key = p[:, 0].tobytes() + np.float64(time).tobytes()
        if key not in self._exact:
            one = p[:, :1]
            zero = self._rates(np.zeros((size, 1)), np.zeros(1), one)[:, 0]
            whole = np.zeros((size + 2, size + 2))
            for k in range(size):
                unit = np.zeros((size, 1))
                unit[k] = 1.0
                whole[:size, k] = self._rates(unit, np.zeros(1), one)[:, 0] - zero
            whole[:size, size] = self._rates(np.zeros((size, 1)), np.ones(1), one)[:, 0] - zero
            whole[:size, size + 1] = zero
            self._exact[key] = expm(whole * time)[:size]
        move = self._exact[key]
        with np.errstate(all="ignore"):
            x = move[:, :size] @ x + move[:, size : size + 1] * u + move[:, size + 1 :]
        return np.where(np.isfinite(x), x, 1e300)

    # --- sensors, controller, actuator ---

    def _controlled(
        self, x: Vector, u: Vector, p: Vector, before: Mapping[str, Vector], first: bool
    ) -> tuple[Vector, dict[str, Vector]]:
        loop = self.loop
        after: dict[str, Vector] = {}
        seen: dict[str, Vector] = {}
        for name, value in self.measured(x, u, p).items():
            seen[name] = self._sensed(name, value, seen, before, after, first)
        signals: dict[str, Vector] = {}
        for line in loop.lines:
            signals[line.name] = self._signal(line, signals, seen, before, after, first)
        total = np.zeros(x.shape[1])
        for number, drive in enumerate(loop.drives):
            value = drive.sign * signals[drive.of]
            demand = value
            if drive.within is not None:
                value = np.clip(value, *drive.within)
                after["excess"] = value - demand
            if drive.slew is not None:
                held = before.get(f"slew {number}", np.zeros(len(value)))
                value = np.clip(
                    value, held - drive.slew * loop.period, held + drive.slew * loop.period
                )
                after[f"slew {number}"] = value
            total = total + value
        plant = loop.plant
        total = np.clip(total, plant.low, plant.high)
        idle = plant.idle
        if plant.slew < math.inf:
            held = before.get("driven", np.full(len(total), idle))
            total = np.clip(total, held - plant.slew * loop.period, held + plant.slew * loop.period)
            after["driven"] = total
        for k in range(round(plant.dead / loop.period)):
            key = f"pending {k + 1}"
            after[key], total = total, before.get(key, np.full(len(total), idle))
        return total, after

    def _sensed(
        self,
        name: str,
        value: Vector,
        seen: Mapping[str, Vector],
        before: Mapping[str, Vector],
        after: dict[str, Vector],
        first: bool,
    ) -> Vector:
        sensor = self.loop.sensors.get(name)
        if sensor is None:
            return value
        port = next(each for each in self.loop.plant.outputs if each.name == name)
        period = self.loop.period
        if sensor.difference is not None:
            source = seen[port.rate_of]
            old = source if first else before[f"{name} sensed before"]
            slope = before.get(f"{name} sensed slope", np.zeros(len(source)))
            value = (
                np.zeros(len(source))
                if first
                else (
                    slope
                    + ((source - old) / period - slope) * period / (sensor.difference + period)
                )
            )
            after[f"{name} sensed before"], after[f"{name} sensed slope"] = source, value
        if sensor.resolution:
            value = np.round(value / sensor.resolution) * sensor.resolution
            value = np.clip(value, port.low, port.high)
        for k in range(math.floor(sensor.delay / period + 0.5)):
            key = f"{name} late {k + 1}"
            older = value if first else before[key]
            after[key], value = value, older
        return value

    def _signal(
        self,
        line: Line,
        signals: Mapping[str, Vector],
        seen: Mapping[str, Vector],
        before: Mapping[str, Vector],
        after: dict[str, Vector],
        first: bool,
    ) -> Vector:
        loop, options = self.loop, line.options
        own = {port: loop.connect.get(port, port) for port in line.of}
        if line.kind in ("error", "measured"):
            port = own[line.of[0]]
            wanted = loop.reference(port, self._time)
            return (wanted - seen[port] if line.kind == "error" else seen[port]) * line.gain
        x = signals[line.of[0]]
        if line.kind == "product":
            value = x
            for name in line.of[1:]:
                value = value * signals[name]
            return value * line.gain
        if line.kind == "sum":
            return sum(s * signals[n] for s, n in zip(options["signs"], line.of, strict=True))
        if line.kind == "choice":
            signal, less, number = options["where"]
            chosen = OPERATORS[less](signals[signal], number)
            return np.where(chosen, x, signals[line.of[1]])
        if line.kind == "rules":
            return options["rules"].values(*(signals[n] for n in line.of)) * line.gain
        return self._remembering(line, x, before, after, first) * line.gain

    def _remembering(
        self,
        line: Line,
        x: Vector,
        before: Mapping[str, Vector],
        after: dict[str, Vector],
        first: bool,
    ) -> Vector:
        period, options = self.loop.period, line.options
        key, zero = f"{line.name} ", np.zeros(len(x))
        if line.kind in ("rate", "change"):
            rise = zero if first else x - before[key + "before"]
            after[key + "before"] = x
            if line.kind == "change":
                return rise
            filter_time = float(options.get("filter", 0.0))
            slope = before.get(key + "slope", zero)
            value = slope + (rise / period - slope) * period / (filter_time + period)
            after[key + "slope"] = value
        elif line.kind == "lag":
            time = float(options["time"])
            old = x if first else before[key + "lagged"]
            value = after[key + "lagged"] = old + (x - old) * period / (time + period)
        elif line.kind == "deadband":
            half = 0.5 * float(options["width"])
            value = np.where(x > half, x - half, np.where(x < -half, x + half, 0.0))
        elif line.kind == "hysteresis":
            half = 0.5 * float(options["width"])
            held = before.get(key + "held", zero)
            value = after[key + "held"] = np.minimum(np.maximum(held, x - half), x + half)
        else:  # integral
            value = before.get(key + "total", np.full(len(x), float(options.get("start", 0.0))))
            step = x * period
            if "hold" in options:
                # One gain leads from the integral to the drive; its sign is that of the gain.
                excess = before.get("excess", zero) * float(options["hold"])
                step = np.where(excess * x < 0.0, 0.0, step)
            if "back" in options:
                way = line.gain * self.loop.drives[0].sign
                step = step + before.get("excess", zero) / way * period / max(
                    float(options["back"]), period
                )
            value = value + step
            if "within" in options:
                value = np.clip(value, *options["within"])
            after[key + "total"] = value
        return value
