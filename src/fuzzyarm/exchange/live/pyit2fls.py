"""pyit2fls: from its type-1 and interval type-2 systems to rule bases.

A set there is one or two functions with parameters, without a name. The centroid of a type-2
Mamdani system is taken over the points of the sets' domain, both ends included, and is 0 where
nothing fires; that of type 1 is integrated by trapezoids. ``IT2FLS`` gets its norms at evaluation,
the functions of ``T1TSK`` their arguments. Objects are recognised by their attributes; pyit2fls
itself is not imported.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from operator import contains
from typing import Any, NamedTuple

from fuzzyarm.exchange.formats.dialects import words
from fuzzyarm.exchange.formats.findings import Findings, Imported, reading, unique_name
from fuzzyarm.exchange.formats.recovery import TOLERANCE, constant_beyond
from fuzzyarm.exchange.live.functions import output_of_values, shape_or_points
from fuzzyarm.exchange.live.python_formulas import function_shape
from fuzzyarm.language.model.rulebase import (
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
from fuzzyarm.language.model.shapes import membership_function
from fuzzyarm.symbolic.formulas import FormulaError
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS

KINDS = ("IT2Mamdani", "IT2TSK", "IT2FLS", "T1Mamdani", "T1TSK")
"""Names of the system classes."""

NAME = "_fuzzyarm_name"
"""Attribute of a set with its name in the script."""

_NOTHING = "nothing"
"""Term of an output that a rule of ``T1TSK`` leaves out; its strength still counts in the sum."""

CALL = "_fuzzyarm_call"
"""Attribute of a system with the arguments of its last evaluation; for functions, of the first
evaluation with a different value for each input."""


def pyit2fls_numbers(system: Any) -> Callable[[Mapping[str, float]], dict[str, float]]:
    """Return a function that evaluates a system in pyit2fls: the middle of both ends."""
    kind = _kind(system)
    order = _order(system).names if kind == "T1TSK" else ()
    settings = _evaluation(system) if kind == "IT2FLS" else {}

    def numbers(values: Mapping[str, float]) -> dict[str, float]:
        arguments = dict.fromkeys(system.inputs, 0.0) | dict(values)
        if kind == "T1TSK":
            result = system.evaluate(arguments, tuple(arguments[name] for name in order))
        else:
            result = system.evaluate(arguments, **settings)
        reduced = result[1] if isinstance(result, tuple) else result
        middles = {str(name): _middle(value) for name, value in reduced.items()}
        return {name: value for name, value in middles.items() if not math.isnan(value)}

    return numbers


def _middle(value: Any) -> float:
    return 0.5 * (float(value[0]) + float(value[1])) if isinstance(value, tuple) else float(value)


def from_pyit2fls(
    system: Any, name: str = "system", *, lossy: bool = False, strict: bool = False
) -> Imported:
    """Return the rule base of a system of pyit2fls."""
    findings = Findings(lossy=lossy, strict=strict)
    rulebase = _Reader(system, findings).rulebase(name)
    return findings.imported(rulebase, "pyit2fls")


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
# --- Class and recorded evaluation of an object ---


def _kind(system: Any) -> str:
    """Return the name of an object's system class."""
    return next((c.__name__ for c in type(system).__mro__ if c.__name__ in KINDS), KINDS[0])


_EVALUATION = (
    "inputs", "t_norm", "s_norm", "domain", "method", "method_params", "algorithm",
    "algorithm_params",
)  # fmt: skip
"""Parameters of ``IT2FLS.evaluate``, in order."""


def _evaluation(system: Any) -> dict[str, Any]:
    """Return the evaluation settings of an ``IT2FLS``; by default those of its examples."""
    positional, options = vars(system).get(CALL, ((), {}))
    settings = dict(zip(_EVALUATION, positional, strict=False)) | dict(options)
    settings.pop("inputs", None)
    if settings:
        return settings
    module = sys.modules[type(system).__module__]
    sets = [conclusion for _, conclusions in system.rules for _, conclusion in conclusions]
    return {
        "t_norm": module.min_t_norm,
        "s_norm": module.max_s_norm,
        "domain": sets[0].domain if sets else None,
    }


class _InputOrder(NamedTuple):
    """The inputs of a ``T1TSK``'s functions in order, and objections to that order."""

    names: tuple[str, ...]
    is_guess: bool = False
    strange: str = ""  # an argument other than an input's value


def _order(system: Any) -> _InputOrder:
    """Return the inputs in the order of a ``T1TSK``'s function arguments.

    From an evaluation in which each argument is the value of an input; else by the names of the
    functions' parameters, or in the order in which the inputs were added.
    """
    names = tuple(str(name) for name in system.inputs)
    positional, options = vars(system).get(CALL, ((), {}))
    settings = dict(zip(("inputs", "params"), positional, strict=False)) | dict(options)
    values, arguments = settings.get("inputs"), settings.get("params")
    if not values or arguments is None:
        return _InputOrder(_as_called(system, names) or names, len(names) > 1)
    candidates = []
    for argument in arguments:
        here = [name for name in names if name in values]
        # Identity distinguishes inputs with equal values.
        same = [name for name in here if values[name] is argument]
        candidates.append(same or [name for name in here if _equal(values[name], argument)])
        if not candidates[-1]:
            return _InputOrder(names, strange=str(argument)[:40])
    if all(len(same) == 1 for same in candidates):
        return _InputOrder(tuple(same[0] for same in candidates))
    for order in (_as_called(system, names), names):
        # Fewer arguments than inputs: the first inputs.
        prefix = (order or ())[: len(candidates)]
        if len(prefix) == len(candidates) and all(map(contains, candidates, prefix)):
            return _InputOrder(prefix, is_guess=True)
    matches: list[str] = []
    for same in candidates:
        matches.append(next((name for name in same if name not in matches), same[0]))
    return _InputOrder(tuple(matches), is_guess=True)


def _equal(one: Any, other: Any) -> bool:
    """Whether two numbers, or all elements of two arrays, are equal."""
    if getattr(one, "shape", ()) != getattr(other, "shape", ()):
        return False
    same = one == other
    return bool(same.all() if hasattr(same, "all") else same)


def _as_called(system: Any, names: tuple[str, ...]) -> tuple[str, ...] | None:
    """Return the inputs in the order of the functions' parameters, if all use their names."""
    orders = set()
    for _, conclusions in system.rules:
        for _, function in conclusions:
            code = getattr(function, "__code__", None)
            orders.add(code.co_varnames[: code.co_argcount] if code else ())
    order = orders.pop() if len(orders) == 1 else ()
    return order if sorted(order) == sorted(names) else None


class _Reader:
    """Reader of one system; `sets` has the terms of each variable in the order of first use."""

    def __init__(self, system: Any, findings: Findings) -> None:
        self.system = system
        self.findings = findings
        self.kind = _kind(system)
        self.sets: dict[str, list[Any]] = {str(name): [] for name in system.inputs}
        self.results: dict[str, list[Any]] = {str(name): [] for name in system.outputs}
        self.partly: list[str] = []  # outputs of functions with rules that leave them out

    @property
    def _is_type1(self) -> bool:
        return self.kind in ("T1Mamdani", "T1TSK")

    @property
    def _has_values(self) -> bool:
        """Whether the conclusions are values, not sets."""
        return self.kind in ("IT2TSK", "T1TSK")

    def rulebase(self, name: str) -> RuleBase | None:
        if not self.system.rules:
            self.findings.error("no-rules", "the system has no rules")
            return None
        if not self._gather() or not self._check_order():
            return None
        self._note_silence()
        if self._is_type1:
            conjunction, aggregation = self._engine(), "max"
        else:
            conjunction = self._norm("t_norm", _T_NORMS)
            aggregation = self._norm("s_norm", _S_NORMS)
        inputs = self._inputs()
        names = {variable.name: [term.name for term in variable.terms] for variable in inputs}
        outputs = tuple(self._output(result, inputs, aggregation) for result in self.results)
        if self.findings.failed:
            return None
        names |= {output.name: [term.name for term in output.terms] for output in outputs}
        rules = [
            rule
            for when, then in self.system.rules
            for rule in self._rules(self._rule(when, then, names), then)
        ]
        # pyit2fls has one T-norm, for *and* and for the implication.
        block = RuleBlock(tuple(rules), conjunction=conjunction, implication=conjunction)
        return RuleBase(name, inputs, outputs, (block,))

    def _output(self, name: str, inputs: tuple[Input, ...], aggregation: str) -> Output:
        if self.kind == "T1TSK":
            return self._functions(name, inputs)
        if self.kind == "IT2TSK":
            return self._values(name, inputs)
        if self.kind == "T1Mamdani":
            return self._centres(name) if self._by_centres else self._plain_sets(name)
        return self._sets(name, aggregation)

    # --- Settings ---

    def _setting(self, name: str) -> Any:
        if self.kind == "IT2FLS":
            return _evaluation(self.system).get(name, {"method": "Centroid"}.get(name))
        return getattr(self.system, f"_{self.kind}__{name}", None)

    def _norm(self, name: str, names: Mapping[str, str]) -> str:
        if self.kind == "IT2FLS" and CALL not in vars(self.system) and name == "t_norm":
            message = (
                "the system was never evaluated, which is when it is told its norms: the minimum, "
                "the maximum and the centroid are assumed"
            )
            self.findings.warn("assumed-norms", message)
        function = self._setting(name)
        norm = names.get(str(getattr(function, "__name__", "")))
        if norm is None:
            self.findings.error("unknown-norm", f"the norm '{_called(function)}' is not supported")
        return norm or "min"

    def _engine(self) -> str:
        """Return the T-norm of a type-1 system, for *and* and for the implication."""
        if self.kind == "T1TSK":
            return "product"
        engine = str(self.system.engine)
        norm = {"Product": "product", "Minimum": "min"}.get(engine)
        if norm is None:
            message = f"the engine '{engine}' is not supported; Product and Minimum are"
            self.findings.error("unknown-norm", message)
        return norm or "min"

    @property
    def _by_centres(self) -> bool:
        return str(getattr(self.system, "defuzzification", "CoG")) == "CoA"

    # --- Rules ---

    def _gather(self) -> bool:
        """List the sets and values of each variable; return whether every rule can be converted."""
        for number, (conditions, conclusions) in enumerate(self.system.rules, 1):
            if not conditions or not conclusions:
                missing = "conclusion" if conditions else "condition"
                self.findings.error("empty-rule", f"rule {number} has no {missing}")
            for uses, parts in ((self.sets, conditions), (self.results, conclusions)):
                for variable, fuzzy_set in parts:
                    if variable not in uses:
                        message = f"rule {number} uses '{variable}', which is not declared"
                        self.findings.error("undefined-variable", message)
                    elif not any(_same(fuzzy_set, other) for other in uses[variable]):
                        uses[variable].append(fuzzy_set)
        for name in [key for key, fuzzy_set in self.sets.items() if not fuzzy_set]:
            if not self._has_values:
                self.findings.info("unused-variable", f"no rule uses '{name}'; it is left out")
                del self.sets[name]
        for name in [key for key, fuzzy_set in self.results.items() if not fuzzy_set]:
            self.findings.error("no-rules", f"no rule concludes '{name}'")
        self.partly = self._left_out()
        return not self.findings.failed

    def _left_out(self) -> list[str]:
        """Return the outputs with rules that leave them out but count in their denominators."""
        if self.kind != "T1TSK":
            return []
        ends = [{str(name) for name, _ in then} for _, then in self.system.rules]
        return [name for name in self.results if not all(name in end for end in ends)]

    def _check_order(self) -> bool:
        """Report doubts about the functions' arguments; return whether they can be converted."""
        if self.kind != "T1TSK":
            return True
        order = _order(self.system)
        if order.strange:
            message = (
                f"an argument of the functions ({order.strange}) is not the value of an input; "
                "only inputs themselves can be passed on as params"
            )
            self.findings.error("bad-formula", message)
        elif order.is_guess:
            hint = "evaluate it once with a different value for each input"
            message = (
                "no evaluation shows the order in which the functions get the inputs: "
                f"{', '.join(order.names)} is assumed, in the comparison of numbers too"
            )
            self.findings.warn("assumed-order", message, hint=hint)
        return not order.strange

    def _note_silence(self) -> None:
        """Report that pyit2fls has no value by centres if one of several rules does not fire."""
        if self.kind == "T1Mamdani" and self._by_centres:
            message = (
                "pyit2fls has no value by centres (CoA) where a single rule does not fire; here "
                "the rules that do fire give one"
            )
            self.findings.warn("no-rule", message)

    def _rule(self, conditions: Any, conclusions: Any, names: Mapping[str, Sequence[str]]) -> Rule:
        def term(variable: str, used: Any) -> str:
            sets = self.sets[variable] if variable in self.sets else self.results[variable]
            return names[variable][next(i for i, s in enumerate(sets) if _same(used, s))]

        parts = tuple(Is(str(name), term(name, used)) for name, used in conditions)
        ends = tuple(Consequent(str(name), term(name, used)) for name, used in conclusions)
        concluded = {end.variable for end in ends}
        ends += tuple(Consequent(name, _NOTHING) for name in self.partly if name not in concluded)
        return Rule(And(parts) if len(parts) > 1 else parts[0], ends)

    def _rules(self, rule: Rule, conclusions: Any) -> list[Rule]:
        """Return a rule, or one for each conclusion if their weights differ."""
        if self.kind != "T1Mamdani" or not self._by_centres:
            return [rule]
        return [
            replace(rule, consequents=(consequent,), weight=_height(conclusion))
            for consequent, (_, conclusion) in zip(rule.consequents, conclusions, strict=True)
        ]

    # --- Variables ---

    def _inputs(self) -> tuple[Input, ...]:
        inputs = []
        for name, sets in self.sets.items():
            low, high = _range(sets)
            terms = self._terms(name, sets, low, high)
            shapes = [curve for term in terms for curve in (term.shape, term.lower) if curve]
            inside = not self._has_values and all(
                constant_beyond(shape, low, high) for shape in shapes
            )
            outside = "clamp" if inside else "extend"
            inputs.append(Input(name, low, high, terms, outside=outside))
        return tuple(inputs)

    def _terms(
        self, variable: str, sets: Sequence[Any], low: float, high: float
    ) -> tuple[Term, ...]:
        names: set[str] = set()
        terms = []
        for number, fuzzy_set in enumerate(sets, 1):
            name = unique_name(str(getattr(fuzzy_set, NAME, f"set{number}")), names)
            names.add(name)
            with reading(f"'{name}' of '{variable}'"):
                terms.append(self._term(fuzzy_set, name, variable, low, high))
        return tuple(terms)

    def _term(self, fuzzy_set: Any, name: str, variable: str, low: float, high: float) -> Term:
        quoted = f"'{name}' of '{variable}'"
        if self._is_type1:
            return Term(name, self._shape(fuzzy_set.mf, fuzzy_set.params, low, high, quoted))
        upper = self._shape(fuzzy_set.umf, fuzzy_set.umf_params, low, high, quoted)
        lower = self._shape(fuzzy_set.lmf, fuzzy_set.lmf_params, low, high, quoted)
        return Term(name, upper, lower=None if lower == upper else lower)

    def _shape(
        self, function: Any, parameters: Sequence[Any], low: float, high: float, quoted: str
    ) -> Shape:
        """Return the shape of a function: by its name, if the degrees agree, or by its degrees."""

        def degree(x: float) -> float:
            return min(1.0, max(0.0, float(function(x, parameters))))

        xs = [low + (high - low) * i / 1000 for i in range(1001)]
        # Half a range beyond either end too, where a function of a known name may differ.
        wide = [low + (high - low) * (i - 50) / 100 for i in range(201)]
        maker = _KNOWN.get(str(getattr(function, "__name__", "")))
        shape = maker(*map(float, parameters)) if maker else None
        if shape is not None and _fits(shape, degree, [*xs, *wide]):
            return shape
        words = f"a function of {quoted} ({_called(function)}) is"
        return shape_or_points(degree, low, high, words, self.findings)

    # --- Sets of Mamdani ---

    def _points(self, name: str) -> tuple[float, float, int]:
        """Return the range of an output and the number of its points, which must be even."""
        sets = self.results[name]
        low, high = _range(sets)
        points = [float(x) for x in sets[0].domain]
        if any([*map(float, fuzzy_set.domain)] != points for fuzzy_set in sets):
            self.findings.error("bad-range", f"the sets of '{name}' have different domains")
        step = (high - low) / max(1, len(points) - 1)
        if any(abs(low + step * i - x) > 1e-9 * (high - low) for i, x in enumerate(points)):
            self.findings.error("bad-range", f"the points of '{name}' are not even")
        return low, high, len(points)

    def _sets(self, name: str, aggregation: str) -> Output:
        low, high, count = self._points(name)
        way = self._setting("method")
        if way != "Centroid":
            message = f"the type reduction '{way}' is not supported; Centroid is"
            self.findings.error("unknown-defuzzifier", message)
        return Output(
            name,
            low,
            high,
            self._terms(name, self.results[name], low, high),
            outside="extend",
            aggregation=aggregation,
            defuzzifier=Defuzzifier(self._algorithm("algorithm"), count, "endpoints"),
            no_rule=0.0,
        )

    def _plain_sets(self, name: str) -> Output:
        """Return a type-1 output, with the centroid of trapezoids."""
        low, high, count = self._points(name)
        way = str(getattr(self.system, "defuzzification", "CoG"))
        if way != "CoG":
            message = f"the defuzzification '{way}' is not supported; CoG and CoA are"
            self.findings.error("unknown-defuzzifier", message)
        return Output(
            name,
            low,
            high,
            self._terms(name, self.results[name], low, high),
            outside="extend",
            aggregation="max",
            defuzzifier=Defuzzifier("centroid", count, "trapezoid"),
            no_rule=math.nan,
        )

    def _centres(self, name: str) -> Output:
        """Return an output with the average of its sets' centres, weighted by their degrees there.

        A set scaled by a product keeps its centre.
        """
        low, high, _ = self._points(name)
        if self._engine() != "product":
            message = "the centres (CoA) of sets that are cut move; only Product carries them"
            self.findings.error("unknown-defuzzifier", message)
        terms = self._terms(name, self.results[name], low, high)
        centres = [float(result.defuzzify()) for result in self.results[name]]
        values = tuple(
            Term(term.name, Shape("singleton", (centre,)))
            for term, centre in zip(terms, centres, strict=True)
        )
        return Output(
            name,
            low,
            high,
            values,
            outside="extend",
            aggregation="sum",
            defuzzifier=Defuzzifier("weighted-average"),
            no_rule=math.nan,
        )

    def _algorithm(self, name: str) -> str:
        function = self._setting(name) or getattr(self.system, name, None)
        if self.kind == "IT2FLS":
            word = f"{function or 'EIASC'}_algorithm"
        else:
            word = str(getattr(function, "__name__", ""))
        method = words(DEFUZZIFIERS, "pyit2fls").get(word)
        if method is None:
            message = f"the algorithm '{word or _called(function)}' is not supported"
            self.findings.error("unknown-defuzzifier", message)
        return method or "karnik-mendel"

    # --- Values of Takagi and Sugeno ---

    def _values(self, name: str, inputs: tuple[Input, ...]) -> Output:
        shapes = [_value(result, inputs) for result in self.results[name]]
        terms = tuple(Term(f"value{i}", shape) for i, shape in enumerate(shapes, 1))
        way = Defuzzifier(self._algorithm("algorithm"))
        return output_of_values(name, terms, inputs, self.findings, way)

    def _functions(self, name: str, inputs: tuple[Input, ...]) -> Output:
        """Return the values of functions of the inputs, in the order of an evaluation."""
        order = list(_order(self.system).names)
        terms = []
        for number, function in enumerate(self.results[name], 1):
            with reading(f"value{number} of '{name}'"):
                shape = self._function(function, order, inputs, f"value{number} of '{name}'")
                terms.append(Term(f"value{number}", shape))
        if name in self.partly:
            terms.append(Term(_NOTHING, Shape("singleton", (0.0,))))
        default = float(getattr(self.system, "default", 0.0))
        return output_of_values(name, tuple(terms), inputs, self.findings, no_rule=default)

    def _function(
        self, function: Any, order: list[str], inputs: tuple[Input, ...], quoted: str
    ) -> Shape:
        try:
            ends = {
                variable.name: (variable.low, variable.high)
                for variable in inputs
                if self.sets[variable.name]
            }
            ranges = [ends.get(name, (-100.0, 100.0)) for name in order]
            shape = function_shape(function, order, ranges)
        except (SyntaxError, ValueError, FormulaError, OSError, TypeError) as error:
            message = f"{quoted} is a function that is not arithmetic of the inputs: {error}"
            self.findings.error("bad-formula", message[:300])
            return Shape("singleton", (0.0,))
        if shape.kind != "linear":
            return shape
        factors = dict(zip(order, shape.parameters, strict=False))
        ordered = (factors.get(variable.name, 0.0) for variable in inputs)
        return Shape("linear", (*ordered, shape.parameters[-1]))


def _height(fuzzy_set: Any) -> float:
    """Return the degree of a set at its own centre."""
    return float(fuzzy_set(fuzzy_set.defuzzify()))


def _called(function: Any) -> str:
    return str(getattr(function, "__name__", None) or type(function).__name__)


def _same(one: Any, other: Any) -> bool:
    """Whether two sets, or two sums of inputs, are the same."""
    if one is other or isinstance(one, dict) or not hasattr(one, "domain"):
        return one is other or bool(one == other)
    return _definition(one) == _definition(other)


def _definition(fuzzy_set: Any) -> tuple[Any, ...]:
    if hasattr(fuzzy_set, "mf"):
        return (fuzzy_set.mf, [*map(float, fuzzy_set.params)], [*map(float, fuzzy_set.domain)])
    return (
        fuzzy_set.umf,
        [*map(float, fuzzy_set.umf_params)],
        fuzzy_set.lmf,
        [*map(float, fuzzy_set.lmf_params)],
        [*map(float, fuzzy_set.domain)],
    )


def _range(sets: Sequence[Any]) -> tuple[float, float]:
    """Return the range spanned by the sets' domains."""
    ends = [float(x) for fuzzy_set in sets for x in (min(fuzzy_set.domain), max(fuzzy_set.domain))]
    return (min(ends), max(ends)) if ends else (0.0, 1.0)


def _fits(shape: Shape, degree: Callable[[float], float], xs: Sequence[float]) -> bool:
    ours = membership_function(shape)
    return all(abs(ours(x) - degree(x)) <= TOLERANCE for x in xs)


def _value(factors: Mapping[str, Any], inputs: tuple[Input, ...]) -> Shape:
    numbers = tuple(float(factors[variable.name]) for variable in inputs)
    constant = float(factors["const"])
    if not any(numbers):
        return Shape("singleton", (constant,))
    return Shape("linear", (*numbers, constant))


def _ordered(kind: str, *numbers: float, height: float) -> Shape | None:
    """Return a shape, or None if its corners decrease."""
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
"""Shapes by function name; functions of other names, and of height 0, are sampled."""
