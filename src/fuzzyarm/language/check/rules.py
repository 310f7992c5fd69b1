"""Checks of rules: missing, contradictory, never firing, asymmetric, jumping.

Each check is a function from a subject to its findings; :mod:`.registry` runs them all.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterator
from itertools import combinations, islice, product
from math import prod

from fuzzyarm.expression.kinds import TNORMS
from fuzzyarm.language.check.terms import FAINT, Subject
from fuzzyarm.language.statements import CellNode, GridNode
from fuzzyarm.model.rulebase import (
    And,
    Consequent,
    Expression,
    Hedged,
    Input,
    Is,
    Or,
    Output,
    Rule,
    RuleBase,
    RuleBlock,
    propositions,
)
from fuzzyarm.model.shapes import centre, membership, probe_points, truth
from fuzzyarm.text.diagnostic import Diagnostic, Related, Severity

# --- Rules that are missing: combinations of terms for which an output has no rule ---

_MOST_COMBINATIONS = 50_000
_MOST_NAMED = 5


def missing_rules(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``missing-rule``: empty cells, absent rows and columns, uncovered combinations."""
    for grid in subject.grids:
        yield from _grid(grid, subject)
    with_grid = {grid.output.text for grid in subject.grids}
    for output in subject.rulebase.outputs:
        if output.name not in with_grid:
            yield from _combinations(output, subject)


def _grid(grid: GridNode, subject: Subject) -> Iterator[Diagnostic]:
    labels = [("column", grid.column, grid.columns)]
    if grid.row is not None:
        labels.append(("row", grid.row, tuple(row.label for row in grid.rows)))
    covered = _covered_elsewhere(grid, subject)
    for what, variable, words in labels:
        present = {word.text for word in words}
        terms = subject.rulebase.variable(variable.text).terms
        absent = [term.name for term in terms if term.name not in present]
        if absent and not covered:
            many = "s" if len(absent) > 1 else ""
            yield Diagnostic(
                "missing-rule",
                f"the grid for '{grid.output.text}' has no {what}{many}"
                f" for {variable.text} is {', '.join(absent)}",
                grid.header_span,
            )
    for row in grid.rows:
        for cell, column in zip(row.cells, grid.columns, strict=False):
            if cell.term is None and not covered:
                where = f"{grid.column.text} is {column.text}"
                if grid.row is not None:
                    where = f"{grid.row.text} is {row.label.text} and {where}"
                yield Diagnostic("missing-rule", f"no rule for {where}", cell.span)


def _covered_elsewhere(grid: GridNode, subject: Subject) -> bool:
    """Whether another grid or rule for the same output may fill the empty cells."""
    others = [g for g in subject.grids if g is not grid and g.output.text == grid.output.text]
    condition = _condition(grid)
    if any(_condition(other) == condition for other in others):
        return True
    return any(
        not rule.in_grid and any(c.variable == grid.output.text for c in rule.consequents)
        for rule in subject.rulebase.rules
    )


def _condition(grid: GridNode) -> str:
    return str(grid.condition) if grid.condition else ""


def _combinations(output: Output, subject: Subject) -> Iterator[Diagnostic]:
    """Report combinations of terms that no rule of plain propositions covers."""
    rules = [
        rule
        for rule in subject.rulebase.rules
        if any(c.variable == output.name for c in rule.consequents)
    ]
    if not rules or not all(map(_is_plain_rule, rules)):
        return  # hedges and alternatives are judged by no-rule-fires, with numbers
    used = {p.variable for rule in rules for p in _propositions(rule)}
    variables = [v for v in subject.rulebase.inputs if v.name in used]
    count = prod(len(v.terms) for v in variables)
    if len(used) != len(variables) or not 0 < count <= _MOST_COMBINATIONS:
        return
    wanted = {frozenset((p.variable, p.term) for p in _propositions(rule)) for rule in rules}
    sizes = {len(key) for key in wanted}
    choices = [[(v.name, term.name) for term in v.terms] for v in variables]
    missing = (
        combination for combination in product(*choices) if not _matches(combination, wanted, sizes)
    )
    named = list(islice(missing, _MOST_NAMED + 1))
    if not named:
        return
    shown = "; ".join(
        " and ".join(f"{variable} is {term}" for variable, term in combination)
        for combination in named[:_MOST_NAMED]
    )
    more = " and more" if len(named) > _MOST_NAMED else ""
    yield Diagnostic(
        "missing-rule", f"no rule for '{output.name}' covers {shown}{more}", rules[0].span
    )


def _matches(
    combination: tuple[tuple[str, str], ...],
    wanted: set[frozenset[tuple[str, str]]],
    sizes: set[int],
) -> bool:
    return any(
        frozenset(part) in wanted for size in sizes for part in combinations(combination, size)
    )


def _is_plain_rule(rule: Rule) -> bool:
    parts = _operands(rule)
    return all(isinstance(part, Is) and not part.hedges for part in parts)


def _operands(rule: Rule) -> tuple[object, ...]:
    return rule.antecedent.operands if isinstance(rule.antecedent, And) else (rule.antecedent,)


def _propositions(rule: Rule) -> list[Is]:
    return [part for part in _operands(rule) if isinstance(part, Is)]


# --- Rules with the same antecedent: contradictory, or said twice ---


def conflicting_rules(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``contradictory-rules`` and ``duplicate-rule``."""
    for block in subject.rulebase.blocks:
        first: dict[Hashable, dict[str, tuple[Rule, Consequent]]] = {}
        for rule in block.rules:
            known = first.setdefault(_key(rule.antecedent), {})
            for consequent in rule.consequents:
                if consequent.variable not in known:
                    known[consequent.variable] = (rule, consequent)
                    continue
                yield _conflict(rule, consequent, *known[consequent.variable])


def _conflict(rule: Rule, consequent: Consequent, other: Rule, earlier: Consequent) -> Diagnostic:
    related = (Related(f"the other rule, on line {other.span.line}", other.span),)
    if (consequent.term, consequent.hedges) == (earlier.term, earlier.hedges):
        return Diagnostic(
            "duplicate-rule",
            f"the rule {_words(rule)} already stands on line {other.span.line}",
            rule.span,
            related=related,
        )
    return Diagnostic(
        "contradictory-rules",
        f"the rule {_words(rule)} says {consequent.variable} is {consequent.term}, but line"
        f" {other.span.line} says {earlier.term}",
        rule.span,
        related=related,
    )


def _words(rule: Rule) -> str:
    if _is_plain_rule(rule):
        pairs = (f"{p.variable} is {p.term}" for p in _propositions(rule))
        return f"'{' and '.join(pairs)}'"
    return "with this antecedent"


def _key(expression: Expression) -> Hashable:
    """Return what is equal for antecedents that differ in the order of operands only."""
    if isinstance(expression, Is):
        return (expression.variable, expression.term, expression.hedges)
    if isinstance(expression, Hedged):
        return ("hedged", expression.hedges, _key(expression.operand))
    word = "or" if isinstance(expression, Or) else "and"
    return (word, frozenset(map(_key, expression.operands)))


# --- Inputs for which no rule fires, with one such input as evidence ---

_MOST_POINTS = 40_000


def points_without_rule(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``no-rule-fires`` for each output with a point of the inputs that fires nothing."""
    rulebase = subject.rulebase
    for output in rulebase.outputs:
        evidence = silent_point(rulebase, output)
        if evidence is None:
            continue
        point = ", ".join(f"{name} = {value:g}" for name, value in evidence.items())
        stated = output.no_rule != "error"
        yield Diagnostic(
            "no-rule-fires",
            f"no rule for '{output.name}' fires at {point}",
            output.span,
            # Where the file says what happens then, the author has thought of it.
            severity=Severity.INFO if stated else Severity.WARNING,
            hint="" if stated else "add a rule, or say what happens then: inference no-rule …",
        )


def silent_point(rulebase: RuleBase, output: Output) -> dict[str, float] | None:
    """Return a point of the inputs at which no rule for `output` fires; None if none is found.

    Every combination of stretches between corners of the terms is tried, up to a limit; beyond
    that the stretches are thinned evenly.
    """
    rules = [
        (block, rule)
        for block in rulebase.blocks
        for rule in block.rules
        if rule.weight > 0.0 and any(c.variable == output.name for c in rule.consequents)
    ]
    names = {v.name for v in rulebase.inputs}
    used = {p.variable for _, rule in rules for p in propositions(rule.antecedent)}
    if not rules or not used <= names:
        return None  # unused, or a chained output decides: its range is not known here
    variables = [v for v in rulebase.inputs if v.name in used and v.terms]
    grids = _thinned([_active_terms(variable) for variable in variables])
    index = _plain_index([(b, r) for b, r in rules if _is_plain_in_block(b, r)])
    others = [(b, r) for b, r in rules if not _is_plain_in_block(b, r)]
    if not others and _fires_everywhere(index, [v.name for v in variables], grids):
        return None
    for cell in product(*grids):
        active = {v.name: terms for v, (_, terms) in zip(variables, cell, strict=True)}
        if _plain_fires(index, active) or _other_fires(others, active):
            continue
        point = {v.name: x for v, (x, _) in zip(variables, cell, strict=True)}
        rest = {v.name: 0.5 * (v.low + v.high) for v in rulebase.inputs if v.name not in point}
        return {v.name: {**point, **rest}[v.name] for v in rulebase.inputs}
    return None


_Active = tuple[float, dict[str, float]]


def _active_terms(variable: Input) -> list[_Active]:
    """Return each probe point with the degrees of the terms that hold there."""
    found = []
    for x in probe_points(variable):
        degrees = {term.name: membership(term.shape, x) for term in variable.terms}
        found.append((x, {name: d for name, d in degrees.items() if d >= FAINT}))
    return found


def _thinned(grids: list[list[_Active]]) -> list[list[_Active]]:
    """Return the grids with every other point of the longest left out until few enough remain."""
    while prod(map(len, grids)) > _MOST_POINTS:
        longest = max(range(len(grids)), key=lambda i: len(grids[i]))
        if len(grids[longest]) == 1:
            break
        grids[longest] = grids[longest][1::2]
    return grids


def _is_plain_in_block(block: RuleBlock, rule: Rule) -> bool:
    positive = len(_operands(rule)) == 1 or TNORMS[block.conjunction].positive
    return positive and _is_plain_rule(rule)


_Index = dict[tuple[str, ...], set[tuple[str, ...]]]


def _plain_index(rules: list[tuple[RuleBlock, Rule]]) -> _Index:
    """Return the term combinations of plain rules by the variables they ask for."""
    index: _Index = {}
    for _, rule in rules:
        pairs = [(p.variable, p.term) for p in propositions(rule.antecedent)]
        key = tuple(variable for variable, _ in pairs)
        index.setdefault(key, set()).add(tuple(term for _, term in pairs))
    return index


def _plain_fires(index: _Index, active: dict[str, dict[str, float]]) -> bool:
    return any(
        any(terms in wanted for terms in product(*(active[name] for name in names)))
        for names, wanted in index.items()
    )


def _fires_everywhere(index: _Index, names: list[str], grids: list[list[_Active]]) -> bool:
    """Whether plain rules fire at every point: to ask where the fewest terms hold is enough."""
    fewest = [[(0.0, dict.fromkeys(terms, 1.0)) for terms in _smallest(grid)] for grid in grids]
    return all(
        _plain_fires(index, {n: terms for n, (_, terms) in zip(names, cell, strict=True)})
        for cell in product(*fewest)
    )


def _smallest(grid: list[_Active]) -> list[frozenset[str]]:
    """Return the sets of terms in `grid` of which no other one is a part."""
    smallest: list[frozenset[str]] = []
    for terms in sorted({frozenset(terms) for _, terms in grid}, key=len):
        if not any(known <= terms for known in smallest):
            smallest.append(terms)
    return smallest


def _other_fires(rules: list[tuple[RuleBlock, Rule]], active: dict[str, dict[str, float]]) -> bool:
    def degree(variable: str, term: str) -> float:
        return active[variable].get(term, 0.0)

    return any(truth(rule.antecedent, degree, block) >= FAINT for block, rule in rules)


# --- The order of an output's terms along its range, which the shape of a grid is judged by ---


def ranks(rulebase: RuleBase, name: str) -> dict[str, int] | None:
    """Return the rank of each term of the variable `name` by its middle; None for values."""
    variable = rulebase.variable(name)
    middles = {}
    for term in variable.terms:
        middle = centre(term.shape, variable.low, variable.high)
        if middle is None:
            return None
        middles[term.name] = middle
    return {term: i for i, term in enumerate(sorted(middles, key=lambda t: middles[t]))}


def cells_by_rank(grid: GridNode, rulebase: RuleBase) -> dict[tuple[int, int], CellNode] | None:
    """Return the filled cells of a two-input grid by the ranks of row and column terms."""
    if grid.row is None:
        return None
    rows, columns = ranks(rulebase, grid.row.text), ranks(rulebase, grid.column.text)
    if rows is None or columns is None:
        return None
    return {
        (rows[row.label.text], columns[column.text]): cell
        for row in grid.rows
        for cell, column in zip(row.cells, grid.columns, strict=False)
        if cell.term is not None
    }


# --- Grids that are antisymmetric (or symmetric) but for a few cells ---

ALMOST = 0.75
"""So large a part of the pairs must mirror for the others to look like slips."""

_Pair = tuple[CellNode, CellNode]


def broken_symmetries(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``broken-antisymmetry`` or ``broken-symmetry`` for each pair that does not fit."""
    for grid in subject.grids:
        order = _ranks_of_used(grid, subject)
        pairs = _telling(_mirror_pairs(grid, subject), grid)
        if order is None or len(pairs) < 4:
            continue
        top = len(order) - 1
        by_rank = {rank: term for term, rank in order.items()}
        odd = [p for p in pairs if _rank(p[0], order) + _rank(p[1], order) != top]
        even = [p for p in pairs if _rank(p[0], order) != _rank(p[1], order)]
        if 0 < len(odd) <= (1.0 - ALMOST) * len(pairs) and len(odd) <= len(even):
            for pair in odd:
                wanted = by_rank[top - _rank(pair[0], order)]
                yield _asymmetry("broken-antisymmetry", "antisymmetric", pair, wanted)
        elif 0 < len(even) <= (1.0 - ALMOST) * len(pairs):
            for pair in even:
                wanted = by_rank[_rank(pair[0], order)]
                yield _asymmetry("broken-symmetry", "symmetric", pair, wanted)


def _ranks_of_used(grid: GridNode, subject: Subject) -> dict[str, int] | None:
    """Return the order of the terms that the grid uses; others would shift its middle."""
    order = ranks(subject.rulebase, grid.output.text)
    if order is None:
        return None
    used = {cell.term.text for row in grid.rows for cell in row.cells if cell.term}
    return {term: i for i, term in enumerate(sorted(used, key=lambda term: order[term]))}


def _telling(pairs: list[_Pair], grid: GridNode) -> list[_Pair]:
    """Leave out pairs of the term that most cells have: they mirror whatever the grid is like."""
    terms = [cell.term.text for row in grid.rows for cell in row.cells if cell.term]
    counts = Counter(terms)
    common = max(terms, key=counts.__getitem__, default="")
    if 2 * counts[common] <= len(terms):
        return pairs
    return [p for p in pairs if not all(c.term and c.term.text == common for c in p)]


def _mirror_pairs(grid: GridNode, subject: Subject) -> list[_Pair]:
    cells = cells_by_rank(grid, subject.rulebase)
    if not cells or grid.row is None:
        return []
    last_row = len(subject.rulebase.variable(grid.row.text).terms) - 1
    last_column = len(subject.rulebase.variable(grid.column.text).terms) - 1
    pairs = []
    for (row, column), cell in cells.items():
        mirror = (last_row - row, last_column - column)
        if (row, column) <= mirror and mirror in cells:
            pairs.append((cell, cells[mirror]))
    return pairs


def _rank(cell: CellNode, order: dict[str, int]) -> int:
    return order[cell.term.text] if cell.term else -1


def _asymmetry(name: str, what: str, pair: _Pair, wanted: str) -> Diagnostic:
    earlier, later = sorted(pair, key=lambda cell: cell.span)
    first = pair[0].term.text if pair[0].term else "."
    second = pair[1].term.text if pair[1].term else "."
    if earlier is later:
        return Diagnostic(
            name,
            f"the grid is otherwise {what}, but the middle cell '{first}' is not its own mirror",
            later.span,
        )
    return Diagnostic(
        name,
        f"the grid is otherwise {what}, but '{second}' does not mirror '{first}'",
        pair[1].span,
        hint=f"the mirror of '{first}' is '{wanted}'; one of the two cells is a slip",
        related=(Related("the cell it mirrors", pair[0].span),),
    )


# --- Neighbouring grid cells whose terms lie far apart ---

MOST = 2
"""A control surface may step by so many terms from one cell to the next."""


def jumps(subject: Subject) -> Iterator[Diagnostic]:
    """Yield ``jump`` where a cell and its left or upper neighbour are too far apart."""
    for grid in subject.grids:
        cells = cells_by_rank(grid, subject.rulebase)
        order = ranks(subject.rulebase, grid.output.text)
        if cells is None or order is None:
            continue
        for (row, column), cell in cells.items():
            for neighbour in ((row, column - 1), (row - 1, column)):
                if neighbour in cells:
                    yield from _pair(cell, cells[neighbour], order)


def _pair(cell: CellNode, other: CellNode, order: dict[str, int]) -> Iterator[Diagnostic]:
    if cell.term is None or other.term is None:
        return
    distance = abs(order[cell.term.text] - order[other.term.text])
    if distance > MOST:
        # The finding stands where the later of the two is written.
        later, earlier = sorted((cell, other), key=lambda c: c.span, reverse=True)
        assert later.term is not None
        assert earlier.term is not None
        yield Diagnostic(
            "jump",
            f"'{later.term.text}' lies {distance} terms from its neighbour '{earlier.term.text}'",
            later.span,
            related=(Related("the neighbour", earlier.span),),
        )
