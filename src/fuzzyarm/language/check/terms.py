"""Checks of terms and variables: unused names, cores out of range, unsuitable defuzzifiers.

Each check is a function from a subject to its findings; :mod:`.registry` runs them all.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from fuzzyarm.base.diagnostic import Diagnostic, Severity, Span
from fuzzyarm.language.check.subject import Subject, plain_propositions
from fuzzyarm.language.model.arrangement import (
    cores,
    crossing,
    mirror_faults,
    mirror_pairs,
    partition_faults,
)
from fuzzyarm.language.model.rulebase import (
    POSITION,
    Input,
    Output,
    Rule,
    RuleBase,
    Term,
    Tuning,
    Variable,
    propositions,
)
from fuzzyarm.language.model.shapes import bends, centre, corner_points, membership_function
from fuzzyarm.language.statements import EvenTermsNode
from fuzzyarm.language.tokens import name_text
from fuzzyarm.symbolic.kinds import SHAPES

# --- Outputs with a defuzzifier unsuitable for their terms ---


def unfit_defuzzifiers(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``defuzzifier-does-not-fit``, ``mixed-output-terms`` and ``no-area``."""
    names = {v.name for v in (*subject.rulebase.inputs, *subject.rulebase.outputs)}
    for output in subject.rulebase.outputs:
        yield from _formulas(output, names)
        if not _averages_values(output):
            yield from _values(output)
            yield from _mixture(output)
            yield from _without_area(output)
        yield from _type_2(output, subject)
        if output.defuzzifier.record.inverts:
            yield from _monotonic(output)


def _averages_values(output: Output) -> bool:
    """Whether values, numbers and lines alike, are averaged by the ends of their weights."""
    others = [term for term in output.terms if term.shape.kind != "singleton"]
    return output.defuzzifier.record.type2 and bool(others) and all(map(_is_value, others))


def _is_value(term: Term) -> bool:
    return not (SHAPES[term.shape.kind].fuzzy or POSITION in _names_in(term))


def _values(output: Output) -> Iterator[Diagnostic]:
    values = list(filter(_is_value, output.terms))
    method, record = output.defuzzifier.method, output.defuzzifier.record
    if values and not record.weighs:
        yield Diagnostic(
            "defuzzifier-does-not-fit",
            f"'{values[0].name}' of '{output.name}' is a value, not a set; {method} needs sets",
            values[0].span,
            hint="use weighted-average or weighted-sum",
        )


def _type_2(output: Output, subject: Subject) -> Iterator[Diagnostic]:
    """Report interval type-2 terms that meet a defuzzifier of type 1."""
    if output.defuzzifier.record.type2:
        return
    antecedent_terms = (
        (part.variable, part.term)
        for _, rule in subject.rules_for(output)
        for part in propositions(rule.antecedent)
    )
    concluded = ((output.name, term.name) for term in output.terms)
    for name, term in (*concluded, *antecedent_terms):
        if subject.rulebase.variable(name).term(term).lower is not None:
            yield Diagnostic(
                "defuzzifier-does-not-fit",
                f"'{name} is {term}' is of interval type 2, and {output.defuzzifier.method} of"
                f" '{output.name}' takes sets of type 1",
                output.span,
                hint=f"write  inference {name_text(output.name)}: defuzzifier karnik-mendel exact"
                "  (or karnik-mendel(101), or nie-tan)",
            )
            return


def _formulas(output: Output, variables: set[str]) -> Iterator[Diagnostic]:
    """Report formulas in x, which are sets, in the wrong position."""
    for term in output.terms:
        names = _names_in(term)
        if POSITION not in names:
            continue
        others = sorted(names & (variables - {POSITION}))
        method, message, hint = output.defuzzifier.method, "", ""
        weighs = output.defuzzifier.record.weighs
        if weighs and POSITION in variables:
            continue  # a value that refers to a variable
        if weighs:
            message = f"which makes it a set; {method} needs a value"
        elif POSITION in variables:
            message = "which is also the name of a variable"
        elif others:
            message = f"but '{others[0]}' too; a set depends on its position only"
        if POSITION in variables:
            hint = f"give the variable '{POSITION}' another name"
        if message:
            yield Diagnostic(
                "defuzzifier-does-not-fit",
                f"the formula of '{term.name}' uses {POSITION}, the position in a set, {message}",
                term.span,
                hint=hint,
            )


def _names_in(term: Term) -> set[str]:
    """Return the names in a formula; none for another shape or an unreadable one."""
    if term.shape.kind != "formula":
        return set()
    from fuzzyarm.symbolic.formulas import FormulaError, read_formula

    try:
        return set(read_formula(term.shape.formula).names)
    except FormulaError:
        return set()


_POSITIONS = 257
"""At which the degree of a formula is looked at."""


def formula_degrees(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``formula-degrees`` for each set whose formula is undefined, or leaves 0 .. 1."""
    for variable in (*subject.rulebase.inputs, *subject.rulebase.outputs):
        if isinstance(variable, Output) and variable.defuzzifier.record.weighs:
            continue
        if not math.isfinite(variable.high - variable.low):
            continue
        for term in variable.terms:
            if _names_in(term) == {POSITION}:
                yield from _degrees_of(term, variable)


def _degrees_of(term: Term, variable: Variable) -> Iterator[Diagnostic]:
    from fuzzyarm.symbolic.formulas import read_formula

    degree = read_formula(term.shape.formula).function((POSITION,))
    step = (variable.high - variable.low) / (_POSITIONS - 1)
    positions = [variable.low + i * step for i in range(_POSITIONS)]
    degrees = {x: degree(x) for x in positions}
    nowhere = [x for x, y in degrees.items() if math.isnan(y)]
    outside = [x for x, y in degrees.items() if not math.isnan(y) and not -1e-9 <= y <= 1.0 + 1e-9]
    message = hint = ""
    if nowhere:
        message = f"has no value at {POSITION} = {nowhere[0]:.4g}, where its degree counts as 0"
        hint = "define it there, as in  sqrt(max(0, x))"
    elif outside:
        worst = max(outside, key=lambda x: abs(degrees[x] - 0.5))
        message = f"is {degrees[worst]:.4g} at {POSITION} = {worst:.4g}; a degree lies in 0 .. 1"
        hint = "keep it there, as in  min(1, max(0, x))"
    if message:
        text = f"the formula of '{term.name}' of '{variable.name}' {message}"
        yield Diagnostic("formula-degrees", text, term.span, hint=hint)


def _mixture(output: Output) -> Iterator[Diagnostic]:
    if output.defuzzifier.record.weighs:
        return
    spikes = [term for term in output.terms if term.shape.kind == "singleton"]
    if spikes and len(spikes) < len(output.terms):
        yield Diagnostic(
            "mixed-output-terms",
            f"'{output.name}' mixes singletons with sets that have an area;"
            f" '{spikes[0].name}' would carry no weight in the {output.defuzzifier.method}",
            spikes[0].span,
        )


def _without_area(output: Output) -> Iterator[Diagnostic]:
    spikes = list(filter(_is_spike, output.terms))
    if spikes and output.defuzzifier.record.aspect.integrates:
        method = output.defuzzifier.method
        yield Diagnostic(
            "no-area",
            f"'{spikes[0].name}' of '{output.name}' has no area: the {method} does not count it",
            spikes[0].span,
            severity=Severity.WARNING,
            hint="widen it, or use singletons and weighted-average",
        )


def _is_spike(term: Term) -> bool:
    """Whether a set is above 0 at one point alone."""
    shape, corners = term.shape, set(corner_points(term.shape))
    if shape.kind == "singleton" or not SHAPES[shape.kind].fuzzy or len(corners) != 1:
        return False
    (at,), degree = corners, membership_function(shape)
    return not any(degree(math.nextafter(at, way)) for way in (-math.inf, math.inf))


def _monotonic(output: Output) -> Iterator[Diagnostic]:
    for term in output.terms:
        record = SHAPES[term.shape.kind]
        if record.fuzzy and record.inverse is None and term.shape.kind != "singleton":
            yield Diagnostic(
                "defuzzifier-does-not-fit",
                f"{output.defuzzifier.method} needs monotonic terms; '{term.name}' of"
                f" '{output.name}' is a {term.shape.kind}",
                term.span,
            )
            return


# --- Terms outside the range, and values clipped to it ---


def cores_outside(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``core-outside-range`` for each term whose core is outside the range."""
    rulebase = subject.rulebase
    for variable in (*rulebase.inputs, *rulebase.outputs):
        by_value = isinstance(variable, Output) and variable.defuzzifier.record.weighs
        if variable.outside == "extend" and (by_value or isinstance(variable, Input)):
            continue  # a value outside the range is not clipped
        for term in variable.terms:
            if SHAPES[term.shape.kind].fuzzy and not _core_within(term, variable):
                yield _core_outside(term, variable)


def _core_within(term: Term, variable: Variable) -> bool:
    """Whether `term` reaches its greatest degree in the range; half, if it only approaches it."""
    low, high = variable.low, variable.high
    kind, degree = SHAPES[term.shape.kind], membership_function(term.shape)
    positions = {x for x in (*corner_points(term.shape), low, high) if math.isfinite(x)}
    if not kind.straight:
        positions |= {x for x in bends(term.shape) if math.isfinite(x)}
    degrees = {x: degree(x) for x in positions}
    top = max(degrees.values(), default=0.0)
    share = 1.0 if top >= term.shape.height else 0.5
    # Between two corners a line may cross the end of the range, not more.
    inside = [y for x, y in degrees.items() if low <= x <= high]
    return max(inside, default=top) >= share * top * (1.0 - 1e-9)


def _core_outside(term: Term, variable: Variable) -> Diagnostic:
    span = f"the range {variable.low:g} .. {variable.high:g} of '{variable.name}'"
    if term.shape.kind != "singleton":
        message = f"the core of '{term.name}' lies outside {span}"
    else:
        value = term.shape.parameters[0]
        end = variable.low if value < variable.low else variable.high
        message = f"'{term.name}' is {value:g}, outside {span}"
        if isinstance(variable, Output) and variable.outside == "clamp":
            message += f": the output is cut to {end:g}"
    return Diagnostic(
        "core-outside-range",
        message,
        term.span,
        hint="widen the range, or move the term",
    )


def clamped_values(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``clamped-output`` where a linear consequent leaves the range of its output."""
    for output in subject.rulebase.outputs:
        record = output.defuzzifier.record
        if output.outside == "clamp" and record.weighs and not record.inverts:
            linear = {t.name: t for t in output.terms if t.shape.kind == "linear"}
            for term, low, high in _values_where_fired(output, linear, subject):
                yield Diagnostic(
                    "clamped-output",
                    f"'{term.name}' is {low:g} .. {high:g} where its rules fire: '{output.name}'"
                    f" is cut to {output.low:g} .. {output.high:g}",
                    term.span,
                    severity=Severity.INFO,
                )


def _values_where_fired(
    output: Output, linear: dict[str, Term], subject: Subject
) -> Iterator[tuple[Term, float, float]]:
    """Yield the linear terms whose values leave the range of `output`, each with its values."""
    reach: dict[str, tuple[float, float]] = {}
    for _, rule in subject.rules_for(output) if linear else ():
        supports = _supports(rule, subject)
        for consequent in rule.consequents:
            if consequent.variable == output.name and consequent.term in linear:
                *factors, constant = linear[consequent.term].shape.parameters
                ends = [
                    sorted((factor * low, factor * high))
                    for factor, (low, high) in zip(factors, supports, strict=True)
                    if factor != 0.0
                ]
                low = constant + sum(low for low, _ in ends)
                high = constant + sum(high for _, high in ends)
                earlier = reach.get(consequent.term, (low, high))
                reach[consequent.term] = min(earlier[0], low), max(earlier[1], high)
    for name, (low, high) in reach.items():
        slack = 1e-9 * (output.high - output.low)
        if low < output.low - slack or high > output.high + slack:
            yield linear[name], low, high


def _supports(rule: Rule, subject: Subject) -> list[tuple[float, float]]:
    """Return the stretch of each input in which the propositions of a plain rule hold."""
    terms_by_variable: dict[str, set[str]] = {}
    for part in plain_propositions(rule):
        terms_by_variable.setdefault(part.variable, set()).add(part.term)
    supports = []
    for variable in subject.rulebase.inputs:
        low, high = variable.low, variable.high
        for term in terms_by_variable.get(variable.name, ()):
            left, right = subject.support(variable, term)
            low, high = max(low, left), min(high, right)
        supports.append((low, high))
    return supports


# --- Terms that lie unlike all others: crossed, off a partition, not a mirror image ---


def crossed_terms(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``crossed-terms`` for a term whose position contradicts its rank in the list."""
    for variable in subject.families:
        neighbourhood = crossing(variable)
        if neighbourhood is None:
            continue
        name, *neighbours = neighbourhood
        places = cores(variable) or {}
        beside = " and ".join(
            f"'{neighbour}' ({places[neighbour].middle:g})" for neighbour in neighbours if neighbour
        )
        between = "between" if all(neighbours) else "beside"
        yield Diagnostic(
            "crossed-terms",
            f"'{name}' of '{variable.name}' is listed {between} {beside}, but lies at"
            f" {places[name].middle:g}",
            variable.term(name).span,
            hint="have its numbers lost a sign, or crossed those of a neighbour?",
        )


def uneven_terms(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``broken-partition`` and ``uneven-mirror``."""
    tuning = subject.rulebase.tuning or Tuning()
    for variable in subject.families:
        if crossing(variable) is not None:  # one slip, one finding
            continue
        tunings = [peaks for peaks in tuning.peaks if variable.name in peaks.variables]
        yield from _broken_partition(variable, always=any(peaks.partition for peaks in tunings))
        yield from _uneven_mirror(variable, always=any(peaks.mirrored for peaks in tunings))


def _broken_partition(variable: Variable, *, always: bool) -> Iterator[Diagnostic]:
    faults = partition_faults(variable) or []
    if not always and 3 * len(faults) > len(variable.terms) - 1:
        return
    for fault in faults:
        yield Diagnostic(
            "broken-partition",
            f"between '{fault.left}' and '{fault.right}' the memberships of '{variable.name}' add"
            f" up to {fault.total:.4g} (at {fault.position:.4g}), not to 1",
            variable.term(fault.right).span,
            hint="each foot is under the peak of the neighbour",
        )


def _uneven_mirror(variable: Variable, *, always: bool) -> Iterator[Diagnostic]:
    pairs = mirror_pairs(variable) or []
    faults = list(mirror_faults(variable))
    if not always and not (len(faults) == 1 and len(pairs) >= 3):
        return
    middle = 0.5 * (variable.low + variable.high)
    for first, second in faults:
        alone = f"'{first}' is not symmetric" if first == second else ""
        yield Diagnostic(
            "uneven-mirror",
            (alone or f"'{first}' and '{second}' are not mirror images")
            + f" about {middle:g}, the middle of '{variable.name}'",
            variable.term(second).span,
        )


# --- Outputs that never approach the ends of their range ---

_NEAR = 0.125
"""The outermost values of an output lie within this part of its range from the ends."""

_SAMPLES = 2_000


def short_reaches(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``short-reach`` for each centroid that cannot approach both ends of its range."""
    for output in subject.rulebase.outputs:
        order = subject.ranks(output.name)
        record = output.defuzzifier.record
        if record.figure != "centroid" or record.type2 or not order:
            continue
        consequent_terms = {
            consequent.term
            for _, rule in subject.rules_for(output)
            for consequent in rule.consequents
            if consequent.variable == output.name
        }
        ranked = [output.term(name) for name in order if name in consequent_terms]
        if not ranked or any(_is_spike(t) or not SHAPES[t.shape.kind].fuzzy for t in ranked):
            continue
        # The centroid lies between those of the outermost sets, whatever the strengths.
        low, high = (_centre_of_area(term, output) for term in (ranked[0], ranked[-1]))
        width = output.high - output.low
        if math.isfinite(width) and max(low - output.low, output.high - high) > _NEAR * width:
            yield Diagnostic(
                "short-reach",
                f"'{output.name}' reaches at most {low:.4g} .. {high:.4g}, of"
                f" {output.low:g} .. {output.high:g}: the centroid of its outermost sets",
                output.span,
                severity=Severity.INFO,
                hint="widen the range until the outermost sets are symmetric about the values"
                " they stand for, or use singletons and weighted-average",
            )


def _centre_of_area(term: Term, output: Output) -> float:
    degree, step = membership_function(term.shape), (output.high - output.low) / _SAMPLES
    points = [output.low + step * (i + 0.5) for i in range(_SAMPLES)]
    degrees = list(map(degree, points))
    area = sum(degrees)
    if area <= 0.0:
        middle = centre(term.shape, output.low, output.high)
        return output.low if middle is None else middle
    return sum(x * y for x, y in zip(points, degrees, strict=True)) / area


# --- Unused terms and variables ---


def unused_names(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``unused-variable`` and, for used variables, ``unused-term``."""
    rulebase = subject.rulebase
    terms_in_rules = _used_terms(rulebase)
    in_values = _used_in_values(rulebase)
    shared = _shared_spans(subject)
    reported: set[Span] = set()
    for variable in (*rulebase.inputs, *rulebase.outputs):
        terms = terms_in_rules.get(variable.name, set())
        if not terms and variable.name not in in_values:
            yield Diagnostic("unused-variable", f"no rule uses '{variable.name}'", variable.span)
            continue
        for term in variable.terms:
            # A name in a shared `terms` line is unused only if no variable uses it.
            owners = shared.get(term.span, (variable.name,))
            if any(term.name in terms_in_rules.get(owner, ()) for owner in owners) or not terms:
                continue
            if term.span not in reported:
                reported.add(term.span)
                yield _unused_term(variable, term.name, term.span)


def _unused_term(variable: Variable, name: str, span: Span) -> Diagnostic:
    return Diagnostic("unused-term", f"no rule uses the term '{name}' of '{variable.name}'", span)


def _used_terms(rulebase: RuleBase) -> dict[str, set[str]]:
    terms: dict[str, set[str]] = {}
    for rule in rulebase.rules:
        for proposition in propositions(rule.antecedent):
            terms.setdefault(proposition.variable, set()).add(proposition.term)
        for consequent in rule.consequents:
            terms.setdefault(consequent.variable, set()).add(consequent.term)
    return terms


def _used_in_values(rulebase: RuleBase) -> set[str]:
    """Return the inputs in linear consequents and formulas."""
    names: set[str] = set()
    for output in rulebase.outputs:
        for term in output.terms:
            shape = term.shape
            if shape.kind == "linear":
                pairs = zip(rulebase.inputs, shape.parameters, strict=False)
                names |= {variable.name for variable, factor in pairs if factor != 0.0}
            names |= _names_in(term)
    return names


def _shared_spans(subject: Subject) -> dict[Span, tuple[str, ...]]:
    shared: dict[Span, tuple[str, ...]] = {}
    for statement in subject.document.statements:
        node = statement.node
        if isinstance(node, EvenTermsNode):
            owners = tuple(word for word in node.variables)
            shared.update((name.span, owners) for name in node.names)
    return shared
