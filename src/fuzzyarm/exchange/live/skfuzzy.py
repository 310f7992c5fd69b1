"""scikit-fuzzy: from a ``ControlSystem`` to a rule base and back.

scikit-fuzzy keeps a term as degrees at the points of its universe, joined by straight lines. A term
is imported as the shape behind these degrees, or, on request or if there is none, as ``points``,
which is exactly the same function. Its centroid is the exact one of the clipped terms, but joins
their union between the points
of the universe (and of the cuts) by straight lines: where two terms cross between two
points, it differs from the integral by a triangle of that width.
docs/howto/from-scikit-fuzzy.md has the sizes.

This is the one part of the package that needs array libraries, inside its functions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import reduce
from itertools import chain, pairwise, product
from types import SimpleNamespace
from typing import Any

from fuzzyarm.base.diagnostic import Diagnostic
from fuzzyarm.exchange.formats.dialects import words
from fuzzyarm.exchange.formats.drafts import VALUES, blocks_by_norms
from fuzzyarm.exchange.formats.fcl_scikit import MEAN_OF_POINTS
from fuzzyarm.exchange.formats.findings import Findings, Imported, reading
from fuzzyarm.exchange.formats.recovery import (
    NEAR_LINES,
    beside_lines,
    even_family,
    is_joined,
    joined,
    recovered,
)
from fuzzyarm.exchange.formats.sentences import NOT, hedged
from fuzzyarm.exchange.formats.system_writer import (
    note_chaining,
    note_left_out,
    note_threshold,
    refuse_type_2,
    word_of_method,
)
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Defuzzifier,
    Expression,
    Hedged,
    Input,
    Is,
    Or,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    Shape,
    Term,
)
from fuzzyarm.language.model.shapes import membership_function
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, SHAPES, SNORMS, TNORMS

# --- From a control system of scikit-fuzzy to a rule base ---


_TNORMS, _SNORMS = ("min", "product"), ("max", "probor")
"""Norms of a rule there; it clips by the minimum and joins terms by the maximum."""

_ACCUMULATIONS = (*_SNORMS, "sum", "bounded")
"""Norms by which the rules of one term add up there, before it is clipped."""


def from_skfuzzy(
    system: Any,
    name: str = "system",
    *,
    points: bool = False,
    lossy: bool = False,
    strict: bool = False,
) -> Imported:
    """Return the rule base of a control system of scikit-fuzzy.

    Parameters
    ----------
    system : skfuzzy.control.ControlSystem or ControlSystemSimulation
        Complete: every variable with its terms, every rule.
    name : str
        Name of the rule base.
    points : bool
        Whether terms stay straight lines between the points of their universe, instead of the
        triangle, gaussian and so on with the same degrees there.
    lossy : bool
        Whether a loss that changes numbers is a warning instead of an error.
    strict : bool
        Whether a slight loss is an error instead of a warning.

    Returns
    -------
    Imported
        The rule base if there is no error, and every finding (without positions: there is no text).
    """
    findings = Findings(lossy=lossy, strict=strict)
    clips = getattr(system, "clip_to_bounds", True)
    system = getattr(system, "ctrl", system)  # of a simulation
    variables = [*system.antecedents, *system.consequents]
    labels = [str(variable.label) for variable in variables]
    for label in sorted({other for other in labels if labels.count(other) > 1}):
        findings.error("duplicate-variable", f"two variables are called '{label}'")
    terms = {id(variable): _terms(variable, findings, points=points) for variable in variables}
    inputs = tuple(
        Input(
            str(antecedent.label), *_range(antecedent), terms[id(antecedent)],
            outside="clamp" if clips else "error",
        )
        for antecedent in system.antecedents
    )  # fmt: skip
    outputs = tuple(
        _output(consequent, terms[id(consequent)], findings) for consequent in system.consequents
    )
    accumulations = {str(v.label): _norm_name(v.accumulation_method) for v in system.consequents}
    blocks = _blocks(list(system.rules), accumulations, findings)
    if not blocks and not findings.failed:
        findings.error("no-rules", "the control system has no rules")
    return findings.imported(RuleBase(name, inputs, outputs, blocks), "scikit-fuzzy")


def skfuzzy_numbers(system: Any) -> Callable[[Mapping[str, float]], dict[str, float]]:
    """Return a function that evaluates a control system or simulation in scikit-fuzzy.

    Orders the rules once: scikit-fuzzy orders them at each computation, which takes longer than all
    the rest.
    """
    from skfuzzy.control import ControlSystemSimulation

    clips = getattr(system, "clip_to_bounds", True)
    system = getattr(system, "ctrl", system)
    simulation = ControlSystemSimulation(system, clip_to_bounds=clips, cache=False)
    simulation.ctrl = SimpleNamespace(
        graph=system.graph,
        rules=list(system.rules),
        antecedents=list(system.antecedents),
        consequents=list(system.consequents),
    )

    def numbers(values: Mapping[str, float]) -> dict[str, float]:
        simulation.inputs(dict(values))
        simulation.compute()
        return {str(name): float(value) for name, value in simulation.output.items()}

    return numbers


def _output(variable: Any, terms: tuple[Term, ...], findings: Findings) -> Output:
    low, high = _range(variable)
    method = words(DEFUZZIFIERS, "skfuzzy").get(variable.defuzzify_method)
    if method is None:
        message = f"'{variable.label}' has the defuzzifier '{variable.defuzzify_method}'"
        findings.error("unknown-defuzzifier", message)
    return Output(
        str(variable.label),
        low,
        high,
        terms,
        outside="extend",
        defuzzifier=_defuzzifier(variable, method or "centroid", findings),
    )


def _defuzzifier(variable: Any, method: str, findings: Findings) -> Defuzzifier:
    """Return the joined samples of an even universe, the exact integral of any other."""
    xs = [float(x) for x in variable.universe]
    if method == "mean-of-maximum":
        findings.info("mean-of-maximum", f"'{variable.label}': {MEAN_OF_POINTS}")
    if len(xs) < 2 or not DEFUZZIFIERS[method].joins:
        return Defuzzifier(method)
    if _are_even(xs):
        return Defuzzifier(method, len(xs), "joined")
    message = (
        f"the points of '{variable.label}' are not even: its {method} is exact here, while "
        "scikit-fuzzy joins its sets by straight lines between them"
    )
    findings.info("between-samples", message)
    return Defuzzifier(method)


def _are_even(xs: list[float]) -> bool:
    step = (xs[-1] - xs[0]) / (len(xs) - 1)
    near = 1e-12 * (xs[-1] - xs[0])
    return all(abs(x - (xs[0] + step * i)) <= near for i, x in enumerate(xs))


def _is_output(variable: Any) -> bool:
    return hasattr(variable, "accumulation_method")


def _range(variable: Any) -> tuple[float, float]:
    return float(variable.universe.min()), float(variable.universe.max())


def _terms(variable: Any, findings: Findings, *, points: bool) -> tuple[Term, ...]:
    """Return the terms of a variable; report one that differs between the points."""
    name = variable.label
    with reading(f"the universe of '{name}'"):
        xs = [float(x) for x in variable.universe]
    if len(xs) < 2 or any(not a < b for a, b in pairwise(xs)):
        message = f"the universe of '{name}' must be two and more numbers that increase"
        findings.error("unordered-points", message)
        return ()
    degrees = {}
    for label, term in variable.terms.items():
        with reading(f"the term '{label}' of '{name}'"):
            degrees[str(label)] = _degrees(term, len(xs))
    if not all(map(math.isfinite, chain(xs, *degrees.values()))):
        findings.error("not-finite", f"the universe or a term of '{name}' has a nan or inf")
        return ()
    shapes_read = [recovered(xs, ys) or joined(xs, ys) for ys in degrees.values()]
    shapes = dict(
        zip(degrees, even_family(shapes_read, xs[0], xs[-1], xs) or shapes_read, strict=True)
    )
    curved = [label for label, shape in shapes.items() if not is_joined(shape, xs)]
    # An output is joined by its defuzzifier, which ignores a shape between the points.
    anyway = _is_output(variable) and _are_even(xs)
    lines = curved if points else [
        label for label in curved if not anyway and beside_lines(shapes[label], xs) > NEAR_LINES
    ]  # fmt: skip
    if not anyway:
        _note_between(variable, [label for label in curved if label not in lines], findings)
    if lines and not points:
        message = (
            f"{', '.join(lines)} of '{name}' would differ by more than {NEAR_LINES:.0%} between "
            f"its {len(xs)} points, which scikit-fuzzy joins by straight lines; these are kept"
        )
        findings.info("between-samples", message)
    return tuple(
        Term(label, joined(xs, degrees[label]) if label in lines else shape)
        for label, shape in shapes.items()
    )


def _degrees(term: Any, count: int) -> list[float]:
    """Return the degrees of a term, one for each point of the universe."""
    values = [float(y) for y in term.mf]
    if len(values) != count:
        raise ValueError(f"it has {len(values)} degrees for {count} points")
    return values


def _note_between(variable: Any, labels: list[str], findings: Findings) -> None:
    if not labels:
        return
    message = (
        f"{', '.join(labels)} of '{variable.label}' between its {len(variable.universe)} points: "
        "the whole shape here, straight lines to scikit-fuzzy"
    )
    findings.info("between-samples", message, hint="--points keeps the straight lines")


def _blocks(
    rules: list[Any], accumulations: Mapping[str, str], findings: Findings
) -> tuple[RuleBlock, ...]:
    """Return a block for each run of rules with the same norms."""
    readings: list[tuple[tuple[str, str], Rule]] = []
    for rule in rules:
        with reading(f"the rule '{rule.label}'"):
            _note_intermediates(rule, findings)
            norms = (_norm_name(rule.and_func), _norm_name(rule.or_func))
        if norms[0] not in _TNORMS or norms[1] not in _SNORMS:
            message = f"the rule '{rule.label}' joins conditions by a user-defined function"
            findings.error("unknown-norm", message)
            continue
        with reading(f"the rule '{rule.label}'"):
            readings += [(norms, rule_read) for rule_read in _rules(rule)]
    return blocks_by_norms(_accumulated(readings, accumulations, findings))


def _accumulated(
    readings: list[tuple[tuple[str, str], Rule]],
    accumulations: Mapping[str, str],
    findings: Findings,
) -> list[tuple[tuple[str, str], Rule]]:
    """Join the rules of a term into one by the norm of its output, if that is not the maximum."""
    groups: dict[tuple[str, str], list[tuple[tuple[str, str], Rule]]] = {}
    for norms, rule in readings:
        for end in rule.consequents:
            groups.setdefault((end.variable, end.term), []).append((norms, rule))
    joined_terms: dict[tuple[str, str], list[tuple[tuple[str, str], Rule]]] = {}
    for (variable, term), group in groups.items():
        norm = accumulations[variable]
        if len(group) == 1 or norm == "max":
            continue
        if _can_join(group, norm):
            joined_terms[variable, term] = group
        else:
            message = f"'{variable}' accumulates the rules of '{term}' by another norm than maximum"
            findings.loss("unsupported-norm", message)
    kept = [
        (norms, replace(rule, consequents=ends))
        for norms, rule in readings
        if (ends := tuple(c for c in rule.consequents if (c.variable, c.term) not in joined_terms))
    ]
    for (variable, term), group in joined_terms.items():
        (conjunction, _), first = group[0]
        antecedent = Or(tuple(rule.antecedent for _, rule in group))
        ends = (Consequent(variable, term),)
        # Above 1 a sum clips nothing more, as no degree is above 1.
        norm = accumulations[variable]
        norms = (conjunction, "bounded" if norm == "sum" else norm)
        kept.append((norms, replace(first, antecedent=antecedent, consequents=ends)))
    return kept


def _can_join(group: list[tuple[tuple[str, str], Rule]], norm: str) -> bool:
    """Whether one disjunction can replace rules: of one conjunction, unweighted, without *or*."""
    return (
        bool(norm)
        and len({norms[0] for norms, _ in group}) == 1
        and all(rule.weight == 1.0 and not _has_or(rule.antecedent) for _, rule in group)
    )


def _has_or(expression: Expression) -> bool:
    match expression:
        case Or():
            return True
        case And(operands=operands):
            return any(map(_has_or, operands))
        case Hedged(operand=operand):
            return _has_or(operand)
    return False


def _note_intermediates(rule: Any, findings: Findings) -> None:
    for term in rule.antecedent_terms:
        if _is_output(term.parent):
            message = (
                f"'{term.parent.label}' is an output; scikit-fuzzy takes the activation of its "
                f"term '{term.label}' in the conditions of '{rule.label}', not its value"
            )
            findings.loss("chained-output", message)


def _norm_name(function: Callable[..., Any]) -> str:
    """Return the norm that a function computes at three points; empty for any other."""
    points = ((0.25, 0.5), (0.75, 0.25), (0.5, 1.0))
    values = [float(function(a, b)) for a, b in points]
    for kind in (*map(TNORMS.get, _TNORMS), *map(SNORMS.get, _ACCUMULATIONS)):
        if kind is not None and values == [kind.scalar(a, b) for a, b in points]:
            return kind.name
    return ""


def _rules(rule: Any) -> tuple[Rule, ...]:
    """Return a rule of the model for each weight among the conclusions."""
    antecedent = _expression(rule.antecedent)
    weights: dict[float, list[Consequent]] = {}
    for weighted in rule.consequent:
        term = weighted.term
        consequent = Consequent(term.parent.label, str(term.label))
        weights.setdefault(float(weighted.weight), []).append(consequent)
    return tuple(Rule(antecedent, tuple(group), weight) for weight, group in weights.items())


def _expression(part: Any) -> Expression:
    kind = getattr(part, "kind", None)
    if kind is None:
        return Is(part.parent.label, str(part.label))
    first = _expression(part.term1)
    if kind == "not":
        return hedged((NOT,), first)
    connective = And if kind == "and" else Or
    # ``a & b & c`` is one conjunction; it is taken from the left here and there.
    left = first.operands if isinstance(first, connective) else (first,)
    return connective((*left, _expression(part.term2)))


# --- From a rule base to a control system of scikit-fuzzy ---


def to_skfuzzy(
    rulebase: RuleBase, *, samples: int = 101, lossy: bool = False
) -> tuple[Any, tuple[Diagnostic, ...]]:
    """Return a control system of scikit-fuzzy for a rule base.

    Parameters
    ----------
    rulebase : RuleBase
        Mamdani with min (or product) and max, clipped by min.
    samples : int
        Even points of every universe; the corners of straight terms are added to them. An
        output with joined samples has these.
    lossy : bool
        Whether to continue if scikit-fuzzy computes other numbers.

    Returns
    -------
    skfuzzy.control.ControlSystem or None
        None if a diagnostic is an error.
    tuple of Diagnostic
        What scikit-fuzzy cannot express.
    """
    findings = Findings(lossy=lossy)
    _check(rulebase, findings)
    if findings.failed:
        return None, findings.all()
    return _system(rulebase, samples), findings.all()


def _check(rulebase: RuleBase, findings: Findings) -> None:
    if refuse_type_2(rulebase, findings, "scikit-fuzzy"):
        return
    note_left_out(rulebase, findings, descriptions=False)
    note_chaining(rulebase, findings, "scikit-fuzzy", only_across_blocks=False)
    note_threshold(rulebase, findings, "scikit-fuzzy", 0.0)
    variables: tuple[Input | Output, ...] = (*rulebase.inputs, *rulebase.outputs)
    for item in variables:
        _check_terms(item, findings)
    for variable in rulebase.inputs:
        if variable.outside == "extend":
            message = f"'{variable.name}' is not clamped to its range, as scikit-fuzzy does"
            findings.loss("outside-range", message)
    for output in rulebase.outputs:
        _check_output(output, findings)
    for block in rulebase.blocks:
        norms = (block.conjunction, block.disjunction, block.implication)
        if norms not in product(_TNORMS, _SNORMS, ("min",)):
            message = (
                "scikit-fuzzy clips by the minimum and is given min or product, max or probor, "
                f"not {', '.join(norms)}"
            )
            findings.loss("unsupported-norm", message)
        for rule in block.rules:
            _check_hedges(rule, findings)


def _check_terms(variable: Input | Output, findings: Findings) -> None:
    if not (math.isfinite(variable.low) and math.isfinite(variable.high)):
        findings.error("bad-range", f"the universe of '{variable.name}' must be finite")
    for term in variable.terms:
        if term.shape.kind in VALUES:
            message = f"scikit-fuzzy has nothing like the value '{term.name}' of '{variable.name}'"
            findings.error("unsupported-shape", message)


def _check_output(output: Output, findings: Findings) -> None:
    word_of_method(output, "skfuzzy", "scikit-fuzzy", findings)
    if output.defuzzifier.resolution is not None and not output.defuzzifier.joined:
        message = f"'{output.name}' is sampled; scikit-fuzzy integrates between its points"
        findings.loss("sampling", message)
    if output.aggregation != "max":
        needed = f"the terms of '{output.name}' by the maximum, not {output.aggregation}"
        message = f"scikit-fuzzy joins {needed}"
        findings.loss("unsupported-norm", message)
    if output.no_rule != "error":
        message = f"'{output.name}' is left out of the result where no rule fires"
        findings.warn("no-rule", message)


def _check_hedges(rule: Rule, findings: Findings) -> None:
    hedges = [h for h in _hedges(rule.antecedent) if h != NOT]
    hedges += [hedge for consequent in rule.consequents for hedge in consequent.hedges]
    for hedge in hedges:
        message = f"scikit-fuzzy has no hedge '{hedge.name}' there"
        findings.loss("unsupported-hedge", message, rule.span)


def _hedges(expression: Expression) -> list[Any]:
    if isinstance(expression, Is):
        return list(expression.hedges)
    if isinstance(expression, Hedged):
        return [*expression.hedges, *_hedges(expression.operand)]
    return [hedge for operand in expression.operands for hedge in _hedges(operand)]


def _system(rulebase: RuleBase, samples: int) -> Any:
    from skfuzzy import control

    variables: dict[str, Any] = {}
    for variable in rulebase.inputs:
        live_variable = control.Antecedent(_universe(variable, samples), variable.name)
        variables[variable.name] = _with_terms(live_variable, variable)
    for output in rulebase.outputs:
        live_variable = control.Consequent(
            _universe(output, samples),
            output.name,
            # `_check` has reported on the method.
            word_of_method(output, "skfuzzy", "scikit-fuzzy", Findings(lossy=True)),
        )
        variables[output.name] = _with_terms(live_variable, output)
    rules = [
        _rule(rule, block, variables, number)
        for number, (rule, block) in enumerate(
            (rule, block) for block in rulebase.blocks for rule in block.rules
        )
    ]
    return control.ControlSystem(rules)


def _universe(variable: Input | Output, samples: int) -> Any:
    import numpy as np

    if isinstance(variable, Output) and variable.defuzzifier.joined:
        return np.linspace(variable.low, variable.high, variable.defuzzifier.resolution or 2)
    corners = [c for term in variable.terms for c in _corners(term.shape)]
    inside = [c for c in corners if variable.low <= c <= variable.high]
    return np.union1d(np.linspace(variable.low, variable.high, samples), inside)


def _corners(shape: Shape) -> list[float]:
    """Return the bends of a function, and both sides of its jumps."""
    corners_of = SHAPES[shape.kind].corners
    corners = corners_of(*shape.parameters) if corners_of is not None else ()
    xs = [x for x, _ in corners]
    if shape.kind == "points":
        return xs
    jumps = [x for (x, y), (right, z) in pairwise(corners) if x == right and y != z]
    return [*xs, *(math.nextafter(x, side) for x in jumps for side in (-math.inf, math.inf))]


def _with_terms(live_variable: Any, variable: Input | Output) -> Any:
    import numpy as np

    for term in variable.terms:
        degree = membership_function(term.shape)
        live_variable[term.name] = np.array([degree(float(x)) for x in live_variable.universe])
    return live_variable


def _rule(rule: Rule, block: RuleBlock, variables: dict[str, Any], number: int) -> Any:
    import numpy as np
    from skfuzzy import control

    # `%` is scikit-fuzzy's operator for the weight of a conclusion, `~` below that for `not`.
    conclusions = [variables[c.variable][c.term] % float(rule.weight) for c in rule.consequents]
    return control.Rule(
        _antecedent(rule.antecedent, variables),
        conclusions,
        label=f"rule {number + 1}",
        and_func=np.multiply if block.conjunction == "product" else np.fmin,
        or_func=SNORMS["probor"].array if block.disjunction == "probor" else np.fmax,
    )


def _antecedent(expression: Expression, variables: dict[str, Any]) -> Any:
    if isinstance(expression, Is):
        term = variables[expression.variable][expression.term]
        return reduce(lambda part, _: ~part, [h for h in expression.hedges if h == NOT], term)
    if isinstance(expression, Hedged):
        inner = _antecedent(expression.operand, variables)
        return reduce(lambda part, _: ~part, [h for h in expression.hedges if h == NOT], inner)
    parts = [_antecedent(operand, variables) for operand in expression.operands]
    if isinstance(expression, And):
        return reduce(lambda a, b: a & b, parts)
    return reduce(lambda a, b: a | b, parts)
