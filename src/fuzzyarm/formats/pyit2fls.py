"""pyit2fls: ``IT2Mamdani`` and ``IT2TSK`` systems of interval type 2 to rule bases.

A set there is two functions with their parameters, and has no name. The centroid of a Mamdani
system is that of the points of the sets' domain, with both ends; where nothing fires, 0. The
objects are known by their attributes; pyit2fls itself is not imported.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any

from fuzzyarm.formats.findings import Findings, Imported, unique_name
from fuzzyarm.formats.recovery import TOLERANCE, constant_beyond, joined, shape_of
from fuzzyarm.model.rulebase import (
    And,
    Consequent,
    Defuzzifier,
    Input,
    Is,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
)
from fuzzyarm.model.shapes import membership_function

__all__ = ["NAME", "from_pyit2fls", "pyit2fls_numbers"]

NAME = "_fuzzyarm_name"
"""Attribute of a set that says what the script calls it."""


def pyit2fls_numbers(system: Any) -> Callable[[Mapping[str, float]], dict[str, float]]:
    """Return what asks a system for its own numbers: the middle of both ends."""

    def numbers(values: Mapping[str, float]) -> dict[str, float]:
        given = dict.fromkeys(system.inputs, 0.0) | dict(values)
        found = system.evaluate(given)
        reduced = found[1] if isinstance(found, tuple) else found
        middles = {str(name): _middle(value) for name, value in reduced.items()}
        return {name: value for name, value in middles.items() if not math.isnan(value)}

    return numbers


def _middle(value: Any) -> float:
    return 0.5 * (float(value[0]) + float(value[1])) if isinstance(value, tuple) else float(value)


def from_pyit2fls(
    system: Any, name: str = "system", *, lossy: bool = False, strict: bool = False
) -> Imported:
    """Return the rule base that a system of pyit2fls is.

    Parameters
    ----------
    system : pyit2fls.IT2Mamdani or pyit2fls.IT2TSK
        With its rules.
    name : str
        What the rule base is called.
    lossy, strict : bool
        As for :func:`fuzzyarm.formats.read`.

    Returns
    -------
    Imported
        The rule base where there is no error, and every finding, without positions.
    """
    findings = Findings(lossy=lossy, strict=strict)
    rulebase = _Reader(system, findings).rulebase(name)
    return Imported(None if findings.failed else rulebase, findings.all(), "pyit2fls")


_T_NORMS = {
    "min_t_norm": "min",
    "product_t_norm": "product",
    "lukasiewicz_t_norm": "bounded",
    "drastic_t_norm": "drastic",
    "nilpotent_minimum_t_norm": "nilpotent",
    "hamacher_product_t_norm": "hamacher",
}
_S_NORMS = {
    "max_s_norm": "max",
    "probabilistic_sum_s_norm": "probor",
    "bounded_sum_s_norm": "bounded",
    "drastic_s_norm": "drastic",
    "nilpotent_maximum_s_norm": "nilpotent",
    "einstein_sum_s_norm": "einstein",
}
_ALGORITHMS = {
    "KM_algorithm": "karnik-mendel",
    "EKM_algorithm": "karnik-mendel",
    "EIASC_algorithm": "karnik-mendel",
    "NT_algorithm": "nie-tan",
}


class _Reader:
    """One system; `sets` has the terms of each variable in the order of their first use."""

    def __init__(self, system: Any, findings: Findings) -> None:
        self.system = system
        self.findings = findings
        self.kind = next(
            (c.__name__ for c in type(system).__mro__ if c.__name__ in ("IT2Mamdani", "IT2TSK")),
            "IT2Mamdani",
        )
        self.sets: dict[str, list[Any]] = {str(name): [] for name in system.inputs}
        self.results: dict[str, list[Any]] = {str(name): [] for name in system.outputs}

    def rulebase(self, name: str) -> RuleBase | None:
        if not self.system.rules:
            self.findings.error("no-rules", "the system has no rules")
            return None
        if not self._gather():
            return None
        conjunction = self._norm("t_norm", _T_NORMS)
        aggregation = self._norm("s_norm", _S_NORMS)
        inputs = self._inputs()
        names = {each.name: [term.name for term in each.terms] for each in inputs}
        if self.kind == "IT2TSK":
            outputs = tuple(self._values(each, inputs) for each in self.results)
        else:
            outputs = tuple(self._output(each, aggregation) for each in self.results)
        if self.findings.failed:
            return None
        names |= {each.name: [term.name for term in each.terms] for each in outputs}
        rules = tuple(self._rule(when, then, names) for when, then in self.system.rules)
        block = RuleBlock(rules, conjunction=conjunction, implication=conjunction)
        return RuleBase(name, inputs, outputs, (block,))

    def _setting(self, name: str) -> Any:
        return getattr(self.system, f"_{self.kind}__{name}", None)

    def _norm(self, name: str, known: Mapping[str, str]) -> str:
        function = self._setting(name)
        found = known.get(str(getattr(function, "__name__", "")))
        if found is None:
            self.findings.error("unknown-norm", f"the norm '{_called(function)}' is not supported")
        return found or "min"

    # --- Rules ---

    def _gather(self) -> bool:
        """List the sets and values of each variable; whether every rule can be carried."""
        for number, (conditions, conclusions) in enumerate(self.system.rules, 1):
            if not conditions or not conclusions:
                what = "conclusion" if conditions else "condition"
                self.findings.error("empty-rule", f"rule {number} has no {what}")
            for known, parts in ((self.sets, conditions), (self.results, conclusions)):
                for variable, used in parts:
                    if variable not in known:
                        message = f"rule {number} uses '{variable}', which is not declared"
                        self.findings.error("undefined-variable", message)
                    elif not any(_same(used, other) for other in known[variable]):
                        known[variable].append(used)
        for name in [each for each, used in self.sets.items() if not used]:
            if self.kind == "IT2Mamdani":
                self.findings.info("unused-variable", f"no rule uses '{name}'; it is left out")
                del self.sets[name]
        for name in [each for each, used in self.results.items() if not used]:
            self.findings.error("no-rules", f"no rule concludes '{name}'")
        return not self.findings.failed

    def _rule(self, conditions: Any, conclusions: Any, names: Mapping[str, Sequence[str]]) -> Rule:
        def term(variable: str, used: Any) -> str:
            known = self.sets[variable] if variable in self.sets else self.results[variable]
            return names[variable][next(i for i, s in enumerate(known) if _same(used, s))]

        parts = tuple(Is(str(name), term(name, used)) for name, used in conditions)
        ends = tuple(Consequent(str(name), term(name, used)) for name, used in conclusions)
        return Rule(And(parts) if len(parts) > 1 else parts[0], ends)

    # --- Variables ---

    def _inputs(self) -> tuple[Input, ...]:
        found = []
        for name, sets in self.sets.items():
            low, high = _range(sets)
            terms = self._terms(name, sets, low, high)
            shapes = [each for term in terms for each in (term.shape, term.lower) if each]
            inside = self.kind == "IT2Mamdani" and all(
                constant_beyond(each, low, high) for each in shapes
            )
            outside = "clamp" if inside else "extend"
            found.append(Input(name, low, high, terms, outside=outside))
        return tuple(found)

    def _terms(
        self, variable: str, sets: Sequence[Any], low: float, high: float
    ) -> tuple[Term, ...]:
        taken: set[str] = set()
        made = []
        for number, each in enumerate(sets, 1):
            name = unique_name(str(getattr(each, NAME, f"set{number}")), taken)
            taken.add(name)
            what = f"'{name}' of '{variable}'"
            upper = self._shape(each.umf, each.umf_params, low, high, what)
            lower = self._shape(each.lmf, each.lmf_params, low, high, what)
            made.append(Term(name, upper, lower=None if lower == upper else lower))
        return tuple(made)

    def _shape(
        self, function: Any, parameters: Sequence[Any], low: float, high: float, what: str
    ) -> Shape:
        """Return the shape of a function: by its name, where it says true, or by its degrees."""

        def degree(x: float) -> float:
            return min(1.0, max(0.0, float(function(x, parameters))))

        xs = [low + (high - low) * i / 1000 for i in range(1001)]
        wide = [low + (high - low) * (i - 50) / 100 for i in range(201)]
        known = _KNOWN.get(str(getattr(function, "__name__", "")))
        shape = known(*map(float, parameters)) if known else None
        if shape is None or not _fits(shape, degree, [*xs, *wide]):
            shape = shape_of(degree, low, high)
        if shape is None:
            message = f"a function of {what} ({_called(function)}) is taken at 1001 points"
            self.findings.loss("unsupported-shape", message, slight=True)
            shape = joined(xs, [degree(x) for x in xs])
        return shape

    def _output(self, name: str, aggregation: str) -> Output:
        sets = self.results[name]
        low, high = _range(sets)
        points = [float(x) for x in sets[0].domain]
        if any([*map(float, each.domain)] != points for each in sets):
            self.findings.error("bad-range", f"the sets of '{name}' have different domains")
        step = (high - low) / max(1, len(points) - 1)
        if any(abs(low + step * i - x) > 1e-9 * (high - low) for i, x in enumerate(points)):
            self.findings.error("bad-range", f"the points of '{name}' are not even")
        way = self._setting("method")
        if way != "Centroid":
            message = f"the type reduction '{way}' is not supported; Centroid is"
            self.findings.error("unknown-defuzzifier", message)
        return Output(
            name,
            low,
            high,
            self._terms(name, sets, low, high),
            outside="extend",
            aggregation=aggregation,
            defuzzifier=Defuzzifier(self._algorithm("algorithm"), len(points), "endpoints"),
            no_rule=0.0,
        )

    def _algorithm(self, name: str) -> str:
        function = self._setting(name) or getattr(self.system, name, None)
        found = _ALGORITHMS.get(str(getattr(function, "__name__", "")))
        if found is None:
            message = f"the algorithm '{_called(function)}' is not supported"
            self.findings.error("unknown-defuzzifier", message)
        return found or "karnik-mendel"

    # --- Values of Takagi and Sugeno ---

    def _values(self, name: str, inputs: tuple[Input, ...]) -> Output:
        shapes = [_value(each, inputs) for each in self.results[name]]
        numbers = [x for shape in shapes for x in _extremes(shape, inputs)]
        low, high = min(numbers), max(numbers)
        if not -math.inf < low < high < math.inf:
            low, high = (low - 0.5, low + 0.5) if math.isfinite(low) else (0.0, 1.0)
        message = f"'{name}' has no universe of discourse; {low:g} to {high:g} by its values"
        self.findings.info("estimated-range", message)
        return Output(
            name,
            low,
            high,
            tuple(Term(f"value{i}", shape) for i, shape in enumerate(shapes, 1)),
            outside="extend",
            aggregation="sum",
            defuzzifier=Defuzzifier(self._algorithm("algorithm")),
            no_rule=0.0,
        )


def _called(function: Any) -> str:
    return str(getattr(function, "__name__", None) or type(function).__name__)


def _same(one: Any, other: Any) -> bool:
    """Whether two sets, or two sums of inputs, are the same."""
    if one is other or isinstance(one, dict):
        return one is other or bool(one == other)
    return _definition(one) == _definition(other)


def _definition(each: Any) -> tuple[Any, ...]:
    return (
        each.umf,
        [*map(float, each.umf_params)],
        each.lmf,
        [*map(float, each.lmf_params)],
        [*map(float, each.domain)],
    )


def _range(sets: Sequence[Any]) -> tuple[float, float]:
    """Return the range that the domains of sets span."""
    ends = [float(x) for each in sets for x in (min(each.domain), max(each.domain))]
    return (min(ends), max(ends)) if ends else (0.0, 1.0)


def _fits(shape: Shape, degree: Callable[[float], float], xs: Sequence[float]) -> bool:
    ours = membership_function(shape)
    return all(abs(ours(x) - degree(x)) <= TOLERANCE for x in xs)


def _value(factors: Mapping[str, Any], inputs: tuple[Input, ...]) -> Shape:
    numbers = tuple(float(factors[each.name]) for each in inputs)
    constant = float(factors["const"])
    if not any(numbers):
        return Shape("singleton", (constant,))
    return Shape("linear", (*numbers, constant))


def _extremes(shape: Shape, inputs: tuple[Input, ...]) -> list[float]:
    """Return the least and the largest value of a sum of inputs over their ranges."""
    *factors, constant = shape.parameters
    if not factors:
        return [constant]
    parts = [(f * i.low, f * i.high) for f, i in zip(factors, inputs, strict=True)]
    return [constant + sum(map(end, parts)) for end in (min, max)]


def _ordered(kind: str, *numbers: float, height: float) -> Shape | None:
    """Return a shape whose corners must not decrease, or None where they do."""
    rising = all(a <= b for a, b in pairwise(numbers))
    return Shape(kind, numbers, height) if rising and 0.0 < height <= 1.0 else None


def _plain(kind: str, *numbers: float, height: float) -> Shape | None:
    return Shape(kind, numbers, height) if 0.0 < height <= 1.0 else None


_KNOWN: dict[str, Callable[..., Shape | None]] = {
    "tri_mf": lambda a, b, c, h: _ordered("triangle", a, b, c, height=h),
    "trapezoid_mf": lambda a, b, c, d, h: _ordered("trapezoid", a, b, c, d, height=h),
    "ltri_mf": lambda a, b, h: _plain("ramp", a, b, height=h),
    "rtri_mf": lambda a, b, h: _plain("ramp", a, b, height=h),
    "gaussian_mf": lambda m, s, h: _plain("gaussian", m, s, height=h),
    "gauss_uncert_std_umf": lambda m, _, s, h: _plain("gaussian", m, s, height=h),
    "gauss_uncert_std_lmf": lambda m, s, _, h: _plain("gaussian", m, s, height=h),
    "gauss_uncert_mean_umf": lambda a, b, s, h: _plain("two-sided-gaussian", a, s, b, s, height=h),
    "gbell_mf": lambda a, b, c, h: _plain("bell", c, a, b, height=h),
    "singleton_mf": lambda x, h: _plain("singleton", x, height=h),
}
"""The shapes of functions by their names; heights of 0 and other functions are asked."""
