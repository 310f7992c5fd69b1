"""Checks of gaps in the rules: combinations of terms, intervals of an input, points.

Each check is a function from a subject to its findings; :mod:`.registry` runs them all.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import chain, islice, product
from math import prod

from fuzzyarm.base.diagnostic import Diagnostic, Severity
from fuzzyarm.language.check.search import (
    Cells,
    GapSearch,
    GaveUpError,
    Literal,
    Need,
    VariableStretch,
    distinct,
    smallest,
)
from fuzzyarm.language.check.subject import Subject, plain_propositions, probe
from fuzzyarm.language.model.rulebase import (
    And,
    Expression,
    Hedged,
    Input,
    Is,
    Or,
    Output,
    Rule,
    RuleBlock,
    propositions,
)
from fuzzyarm.language.model.shapes import apply_hedges, corners, truth
from fuzzyarm.language.rules import GridNode
from fuzzyarm.symbolic.kinds import TNORMS

# --- Stretches of an input's range without a term ---


def coverage_gaps(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``coverage-gap`` once for each gap."""
    for variable in subject.rulebase.inputs:
        if variable.terms:
            yield from _gaps(variable, subject.probes(variable))


def gaps_of(variable: Input) -> Iterator[Diagnostic]:
    """Yield a ``coverage-gap`` for each stretch of `variable` that no term covers."""
    return _gaps(variable, probe(variable))


def _gaps(variable: Input, probes: list[VariableStretch]) -> Iterator[Diagnostic]:
    i = 0
    turns = set(corners(variable))
    while i < len(probes):
        if probes[i].degrees:
            i += 1
            continue
        start = i
        while i + 1 < len(probes) and not probes[i + 1].degrees:
            i += 1
        # A gap begins at a corner: at a bare one, or just after a covered one.
        low, high = probes[start].x, probes[i].x
        low = low if low in turns else probes[start - 1].x
        high = high if high in turns else probes[i + 1].x
        where = f"{low:g}" if low == high else f"{low:g} .. {high:g}"
        message = f"no term of '{variable.name}' covers {where}"
        yield Diagnostic("coverage-gap", message, variable.span)
        i += 1


# --- Missing rules: combinations of terms without a rule for an output ---

_MOST_NAMED = 5


def missing_rules(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``missing-rule``: empty cells, absent rows and columns, uncovered combinations."""
    # Another grid under the same condition, or a rule outside the grids, may fill a gap.
    grids = Counter((grid.output, str(grid.condition or "")) for grid in subject.grids)
    beside = {
        consequent.variable
        for rule in subject.rules
        if not rule.in_grid
        for consequent in rule.consequents
    }
    for grid in subject.grids:
        name = grid.output
        if grids[name, str(grid.condition or "")] == 1 and name not in beside:
            yield from _grid(grid, subject)
    with_grid = {name for name, _ in grids}
    for output in subject.rulebase.outputs:
        if output.name not in with_grid:
            yield from _combinations(output, subject)


def _grid(grid: GridNode, subject: Subject) -> Iterator[Diagnostic]:
    labels = [("column", grid.column, grid.columns)]
    if grid.row is not None:
        labels.append(("row", grid.row, tuple(row.label for row in grid.rows)))
    when = f" when {grid.condition}" if grid.condition else ""
    for what, variable, words in labels:
        present = set(words)
        terms = next(v for v in reversed(subject.families) if v.name == variable).terms
        absent = [term.name for term in terms if term.name not in present]
        if absent:
            many = "s" if len(absent) > 1 else ""
            yield Diagnostic(
                "missing-rule",
                f"the grid for '{grid.output}'{when} has no {what}{many}"
                f" for {variable} is {', '.join(absent)}",
                grid.header_span,
            )
    for row in grid.rows:
        for cell, column in zip(row.cells, grid.columns, strict=False):
            if cell.term is None:
                where = f"{grid.column} is {column}"
                if grid.row is not None:
                    where = f"{grid.row} is {row.label} and {where}"
                yield Diagnostic("missing-rule", f"no rule for {where}{when}", cell.span)


def _combinations(output: Output, subject: Subject) -> Iterator[Diagnostic]:
    """Report combinations of terms without a rule of plain propositions."""
    rules = [rule for _, rule in subject.rules_for(output)]
    plain = [plain_propositions(rule) for rule in rules]
    if not rules or not all(plain):
        return  # hedges and alternatives are judged by no-rule-fires, with numbers
    variable_names = {p.variable for parts in plain for p in parts}
    variables = [v for v in subject.rulebase.inputs if v.name in variable_names]
    if len(variable_names) != len(variables):
        return
    cells = {
        v.name: [VariableStretch(0.0, {(term.name, ()): 1.0}) for term in v.terms]
        for v in variables
    }
    search = GapSearch([Need(_literals(parts)) for parts in plain], cells, subject.on_step)
    examples: list[Cells] = []
    complete = True
    try:
        examples += islice(search.uncovered(), _MOST_NAMED + 1)
    except GaveUpError:
        complete = False
    if examples:
        order = {v.name: i for i, v in enumerate(variables)}
        listing = "; ".join(
            " and ".join(
                f"{name} is {next(iter(combination[name].degrees))[0]}"
                for name in sorted(combination, key=order.__getitem__)
            )
            for combination in examples[:_MOST_NAMED]
        )
        more = " and more" if len(examples) > _MOST_NAMED else "" if complete else " and maybe more"
        message = f"no rule for '{output.name}' covers {listing}{more}"
        yield Diagnostic("missing-rule", message, rules[0].span)
    elif not complete:
        yield _undecided(f"every combination of terms has a rule for '{output.name}'", output)


def _literals(propositions: Iterable[Is]) -> dict[str, frozenset[Literal]]:
    literals: dict[str, frozenset[Literal]] = {}
    for part in propositions:
        earlier = literals.get(part.variable, frozenset())
        literals[part.variable] = earlier | {(part.term, part.hedges)}
    return literals


def _undecided(what: str, output: Output) -> Diagnostic:
    return Diagnostic(
        "undecided",
        f"not decided whether {what}: there are too many combinations to look at",
        output.span,
        severity=Severity.INFO,
    )


# --- Inputs without a firing rule, with one such input as evidence ---


def points_without_rule(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``no-rule-fires`` for each output with a point of the inputs where no rule fires."""
    for output in subject.rulebase.outputs:
        try:
            evidence = uncovered_point(output, subject)
        except GaveUpError:
            yield _undecided(f"a rule for '{output.name}' fires at every input", output)
            continue
        if evidence is None:
            continue
        point = ", ".join(f"{name} = {value:g}" for name, value in evidence.items())
        has_answer = output.no_rule != "error"
        yield Diagnostic(
            "no-rule-fires",
            f"no rule for '{output.name}' fires at {point}",
            output.span,
            # A stated value for this case shows that the author has thought of it.
            severity=Severity.INFO if has_answer else Severity.WARNING,
            hint="" if has_answer else "add a rule, or define the value there: inference no-rule …",
        )


def uncovered_point(output: Output, subject: Subject) -> dict[str, float] | None:
    """Return a point of the inputs at which no rule for `output` fires; None without one.

    The corners of the terms and the midpoints between them represent the intervals of an input.
    """
    inputs = {v.name: v for v in subject.rulebase.inputs}
    rules = [(block, rule) for block, rule in subject.rules_for(output) if rule.weight > 0.0]
    names = {p.variable for _, rule in rules for p in propositions(rule.antecedent)}
    if not rules or not names <= inputs.keys():
        return None  # unused, or chained: the range is unknown here
    needs = [need for block, rule in rules for need in _needs(block, rule)]
    literals: dict[str, set[Literal]] = {name: set() for name in names}
    by_degree: set[str] = set()
    for need in needs:
        for name, literals_here in need.literals.items():
            literals[name] |= literals_here
        by_degree |= need.literals.keys() if need.fires else set()
    cells = {}
    for name in names:
        points = _holding(subject.probes(inputs[name], 0.0), literals[name], name in by_degree)
        # Conditions decided by degree may hold in a cell and not in a smaller one.
        cells[name] = distinct(points) if name in by_degree else smallest(points)
    gap = next(GapSearch(needs, cells, subject.on_step).uncovered(), None)
    if gap is None:
        return None
    return {
        name: gap[name].x if name in gap else subject.middle(variable)
        for name, variable in inputs.items()
    }


_MOST_ALTERNATIVES = 64


def _needs(block: RuleBlock, rule: Rule) -> list[Need]:
    """Return the conditions of a rule, each alternative separately."""
    alternatives = None if block.threshold > 0.0 else _alternatives(rule.antecedent, block)
    if alternatives is not None:
        return [Need(_literals(parts)) for parts in alternatives]
    antecedent = rule.antecedent
    literals: dict[str, frozenset[Literal]] = {
        p.variable: frozenset() for p in propositions(antecedent)
    }
    parts = antecedent.operands if isinstance(antecedent, And) else (antecedent,)
    # If one operand is 0 a conjunction is 0, whatever the norm.
    literals |= _literals(part for part in parts if isinstance(part, Is))

    def fires(cells: Cells) -> bool:
        def degree(variable: str, term: str) -> float:
            return cells[variable].degrees.get((term, ()), 0.0)

        return truth(antecedent, degree, block) * rule.weight > block.threshold

    return [Need(literals, fires)]


def _alternatives(expression: Expression, block: RuleBlock) -> list[tuple[Is, ...]] | None:
    """Return the conjunctions that make `expression` positive; None if it depends on degrees."""
    if isinstance(expression, Is):
        return [(expression,)]
    if isinstance(expression, Hedged):
        return None
    parts = [_alternatives(operand, block) for operand in expression.operands]
    alternatives = [part for part in parts if part is not None]
    if len(alternatives) < len(parts):
        return None
    if isinstance(expression, Or):
        return [literal for part in alternatives for literal in part]
    if not TNORMS[block.conjunction].positive or prod(map(len, alternatives)) > _MOST_ALTERNATIVES:
        return None
    return [tuple(chain(*literal)) for literal in product(*alternatives)]


def _holding(
    probes: list[VariableStretch], literals: set[Literal], by_degree: bool
) -> list[VariableStretch]:
    """Return the cells with those of the `literals` that hold, hedges included."""
    hedged = [literal for literal in literals if literal[1]]
    cells = []
    for x, terms in probes:
        degrees = {
            literal: degree for literal, degree in terms.items() if by_degree or literal in literals
        }
        for term, hedges in hedged:
            degree = apply_hedges(hedges, terms.get((term, ()), 0.0))
            if degree > 0.0:
                degrees[term, hedges] = degree
        cells.append(VariableStretch(x, degrees))
    return cells
