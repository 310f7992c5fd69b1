"""The differences between two rule bases or two tables, drawn in the terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar

from fuzzyarm.apps.show.drawing import number_words
from fuzzyarm.apps.show.rulebase import expression_words, norm_words
from fuzzyarm.apps.show.table import table_grids
from fuzzyarm.apps.show.terms import shape_words
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.numbers import number_text, outward_text
from fuzzyarm.inference.apart import SPREAD, Apart
from fuzzyarm.language.edit.hover import rule_sentence
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Expression,
    Input,
    Is,
    Or,
    Output,
    RuleBase,
    Term,
    Variable,
    with_propositions,
)
from fuzzyarm.language.rows import lines_below
from fuzzyarm.language.tokens import name_text
from fuzzyarm.language.writer import lookup_node

if TYPE_CHECKING:
    from rich.console import Group, RenderableType
    from rich.text import Text

    from fuzzyarm.table.diff import CellChange, TableDiff

_Variable = TypeVar("_Variable", Input, Output)
_Mention = TypeVar("_Mention", Is, Consequent)


# --- The differences between two rule bases: rule by rule, term by term, setting by setting ---


@dataclass(frozen=True, slots=True)
class Change:
    """One difference.

    Attributes
    ----------
    kind : str
        ``renamed``, ``changed``, ``added`` or ``removed``.
    what : str
        The part: the antecedent of a rule, the name of a term, a setting.
    before, after : str
        In words; empty if it was added or removed.
    """

    kind: str
    what: str
    before: str
    after: str

    def __str__(self) -> str:
        if self.before and self.after:
            return f"{self.what}: {self.before} -> {self.after}"
        return f"{self.what}: {self.before or self.after}"


@json_properties("same *")
@dataclass(frozen=True, slots=True)
class RuleBaseDiff:
    """All differences in meaning.

    The order of rules, comments, and shared conclusions or grids do not count.

    Attributes
    ----------
    rules, terms, settings : tuple of Change
        Changes of each kind.
    outputs : tuple of Apart
        The difference of each output; empty if not requested, or if inputs or outputs do not
        correspond.
    """

    rules: tuple[Change, ...]
    terms: tuple[Change, ...]
    settings: tuple[Change, ...]
    outputs: tuple[Apart, ...] = ()

    @property
    def same(self) -> bool:
        """Whether both have the same meaning: rules, terms, settings. Numbers are in `outputs`."""
        return not (self.rules or self.terms or self.settings)


def compare_rulebases(before: RuleBase, after: RuleBase) -> RuleBaseDiff:
    """Return the differences from `before` to `after`.

    Parameters
    ----------
    before, after : RuleBase
        Two versions.
    """
    before, names, terms = _with_names_of(before, after)
    return RuleBaseDiff(
        tuple(changes(_rules(before), _rules(after))),
        (*terms, *changes(_terms(before), _terms(after))),
        (*names, *changes(_settings(before), _settings(after))),
    )


def _with_names_of(
    before: RuleBase, after: RuleBase
) -> tuple[RuleBase, list[Change], list[Change]]:
    """Return a rule base with the names of a later version, and the renamings: all else equal."""
    names: dict[str, str] = {}
    found: list[Change] = []
    for role, old, new in (
        ("input", before.inputs, after.inputs), ("output", before.outputs, after.outputs),
    ):  # fmt: skip
        for one, other in _renamed(old, new, _same_variable):
            names[one] = other
            found.append(Change("renamed", role, name_text(one), name_text(other)))
    terms: dict[tuple[str, str], str] = {}
    found_terms: list[Change] = []
    later = {variable.name: variable for variable in (*after.inputs, *after.outputs)}
    for variable in (*before.inputs, *before.outputs):
        name = names.get(variable.name, variable.name)
        if name in later:
            for one, other in _renamed(variable.terms, later[name].terms, _same_term):
                terms[variable.name, one] = other
                kind = f"term of {name_text(name)}"
                found_terms.append(Change("renamed", kind, name_text(one), name_text(other)))
    return _with_names(before, names, terms), found, found_terms


def _renamed(
    old: Sequence[Variable | Term], new: Sequence[Variable | Term], alike: Callable[..., bool]
) -> Iterator[tuple[str, str]]:
    """Yield the names of removed items with those of their replacements."""
    known = {each.name for each in old}
    came = [each for each in new if each.name not in known]
    kept = {each.name for each in new}
    for gone in old:
        heir = next((each for each in came if alike(gone, each)), None)
        if gone.name not in kept and heir is not None:
            came.remove(heir)
            yield gone.name, heir.name


def _same_variable(one: Variable, other: Variable) -> bool:
    pairs = ((term.shape, term.lower) for term in one.terms)
    others = ((term.shape, term.lower) for term in other.terms)
    return (one.low, one.high) == (other.low, other.high) and list(pairs) == list(others)


def _same_term(one: Term, other: Term) -> bool:
    return (one.shape, one.lower) == (other.shape, other.lower)


def _with_names(
    rulebase: RuleBase, names: Mapping[str, str], terms: Mapping[tuple[str, str], str]
) -> RuleBase:
    """Return a rule base under new names of variables and terms; formulas are unchanged."""
    if not names and not terms:
        return rulebase

    def named(part: _Mention) -> _Mention:
        term = terms.get((part.variable, part.term), part.term)
        return replace(part, variable=names.get(part.variable, part.variable), term=term)

    def variable(each: _Variable) -> _Variable:
        own = tuple(replace(t, name=terms.get((each.name, t.name), t.name)) for t in each.terms)
        return replace(each, name=names.get(each.name, each.name), terms=own)

    blocks = [
        replace(block, rules=tuple(
            replace(
                rule,
                antecedent=with_propositions(rule.antecedent, named),
                consequents=tuple(map(named, rule.consequents)),
            )
            for rule in block.rules
        ))
        for block in rulebase.blocks
    ]  # fmt: skip
    lookup = rulebase.lookup and replace(rulebase.lookup, axes=tuple(
        replace(axis, variable=names.get(axis.variable, axis.variable))
        for axis in rulebase.lookup.axes
    ))  # fmt: skip
    return replace(
        rulebase,
        inputs=tuple(map(variable, rulebase.inputs)),
        outputs=tuple(map(variable, rulebase.outputs)),
        blocks=tuple(blocks),
        lookup=lookup,
        expectations=(),
        properties=(),
    )


_MARKS = {
    "renamed": ("~", "yellow"),
    "changed": ("~", "yellow"),
    "added": ("+", "green"),
    "removed": ("-", "red"),
}


def rulebase_diff_view(diff: RuleBaseDiff) -> Group:
    """Return the differences as a list prefixed by ``~``, ``+`` and ``-``.

    Parameters
    ----------
    diff : RuleBaseDiff
        From :func:`compare_rulebases`.
    """
    from rich.console import Group
    from rich.text import Text

    lines = [Text(apart_words(each)) for each in diff.outputs]
    if diff.same:
        return Group(Text("the rule bases mean the same"), *lines)
    for title in ("rules", "terms", "settings"):
        lines += change_lines(title, getattr(diff, title))
    return Group(*lines)


def apart_words(found: Apart) -> str:
    """Return the difference of an output, in a line."""
    name = name_text(found.output)
    at = ", ".join(f"{name_text(key)} = {value:.6g}" for key, value in found.at.items())
    words = f"{name}: no difference at {found.points:,} points"
    if found.worst:
        values = f"{found.before:.6g} -> {found.after:.6g}"
        words = (
            f"{name}: apart by {found.worst:.4g} at {at} ({values}), the worst of"
            f" {found.points:,} points; RMS {found.rms:.4g} over {SPREAD:,} spread evenly"
        )
    if found.proved is not None:
        most = outward_text(found.proved, up=True, digits=4)
        words += f"; {f'nowhere over {most}' if found.proved else 'the same everywhere'} (proved)"
    if found.missing is not None:
        # All digits: beside a corner the other one may have it, too.
        ends = [f"{name_text(key)} = {number_text(value)}" for key, value in found.missing.items()]
        at = ", ".join(ends)
        words += f"; at {at} only one has a value"
    return words


def change_lines(title: str, changes: Sequence[Change]) -> list[Text]:
    """Return changes marked by ``~``, ``+`` and ``-``, below their counts."""
    from rich.text import Text

    if not changes:
        return []
    counts = Counter(change.kind for change in changes)
    words = ", ".join(f"{counts[kind]} {kind}" for kind in _MARKS if counts[kind])
    lines = [Text(f"{title}: {words}", "bold")]
    for change in changes:
        mark, style = _MARKS[change.kind]
        lines.append(Text.assemble((f"  {mark} ", style), str(change)))
    return lines


def changes(before: dict[str, str], after: dict[str, str]) -> Iterator[Change]:
    """Yield the differences between texts by name."""
    for name, text in before.items():
        if name not in after:
            yield Change("removed", name, text, "")
        elif after[name] != text:
            yield Change("changed", name, text, after[name])
    for name, text in after.items():
        if name not in before:
            yield Change("added", name, "", text)


def _rules(rulebase: RuleBase) -> dict[str, str]:
    """Return antecedent → conclusions, one for each rule, without an order."""
    rules: dict[str, list[str]] = {}
    for block in rulebase.blocks:
        for rule in block.rules:
            home = f"{block.name}: " if block.name else ""
            key = f"{home}if {expression_words(_sorted(rule.antecedent, rulebase))}"
            # The antecedent may not end at the last `then`: a name may contain one.
            head = f"if {expression_words(rule.antecedent)} then "
            # A rule with several conclusions is equivalent to several rules.
            for consequent in rule.consequents:
                alone = replace(rule, consequents=(consequent,))
                rules.setdefault(key, []).append(rule_sentence(alone).removeprefix(head))
    return {key: ", ".join(sorted(results)) for key, results in rules.items()}


def _sorted(expression: Expression, rulebase: RuleBase) -> Expression:
    """Sort the propositions of a conjunction by input."""
    if not isinstance(expression, (And, Or)):
        return expression
    names = [variable.name for variable in rulebase.inputs]

    def position(operand: Expression) -> tuple[int, str]:
        is_ranked = isinstance(operand, Is) and operand.variable in names
        first = (
            names.index(operand.variable) if is_ranked and isinstance(operand, Is) else len(names)
        )
        return first, expression_words(operand)

    operands = sorted((_sorted(operand, rulebase) for operand in expression.operands), key=position)
    return type(expression)(tuple(operands))


def _terms(rulebase: RuleBase) -> dict[str, str]:
    variables: tuple[Variable, ...] = (*rulebase.inputs, *rulebase.outputs)
    return {
        f"{name_text(variable.name)} {name_text(term.name)}": " over ".join(
            shape_words(shape, rulebase) for shape in (term.shape, term.lower) if shape is not None
        )
        for variable in variables
        for term in variable.terms
    }


def _settings(rulebase: RuleBase) -> dict[str, str]:
    settings = {"name": rulebase.name}
    for role, variables in (("input", rulebase.inputs), ("output", rulebase.outputs)):
        for variable in variables:
            span = f"{number_text(variable.low)} .. {number_text(variable.high)}"
            settings[f"{role} {variable.name}"] = f"{span}, outside {variable.outside}"
    for output in rulebase.outputs:
        settings[f"defuzzifier {output.name}"] = str(output.defuzzifier)
        settings[f"aggregation {output.name}"] = output.aggregation
        settings[f"no-rule {output.name}"] = str(output.no_rule)
    for k, block in enumerate(rulebase.blocks):
        label = block.name or str(k + 1)
        settings[f"block {label}"] = norm_words(block)
    settings["lookup"] = "none" if rulebase.lookup is None else _lookup_words(rulebase)
    return settings


def _lookup_words(rulebase: RuleBase) -> str:
    assert rulebase.lookup is not None
    lines = lines_below(lookup_node(rulebase.lookup)) or []
    return "; ".join(" ".join(line.split()) for line, _ in lines)


# --- Tables: changed cells with old and new values ---

_MOST_LISTED = 400
"""Most changed cells in a list; more are counted."""


def table_diff_view(diff: TableDiff) -> Group:
    """Return a summary, the differences of the headers, a grid of the changes, and each cell.

    Parameters
    ----------
    diff : TableDiff
        From :func:`fuzzyarm.table.compare_tables`.
    """
    from rich.console import Group
    from rich.text import Text

    parts: list[RenderableType] = [Text(table_summary(diff), "bold")]
    if diff.transposed:
        order = ", ".join(map(name_text, diff.before.names))
        parts.append(Text(f"the second table has its inputs in another order than {order}"))
    parts += [Text(f"{setting}: {a} -> {b}") for setting, a, b in diff.header]
    if diff.changes:
        difference: Any = diff.after.values - diff.before.values
        grids = table_grids(diff.before, difference, text=_change_text)
        parts += [Text(), Text("after - before"), *grids, Text()]
        parts += [Text(table_change_words(diff, change)) for change in diff.changes[:_MOST_LISTED]]
        rest = len(diff.changes) - _MOST_LISTED
        if rest > 0:
            parts.append(Text(f"and {rest} more cells"))
    return Group(*parts)


def table_summary(diff: TableDiff) -> str:
    """Return the number of different cells, and the greatest difference."""
    if not diff.comparable:
        return "the tables cannot be compared cell by cell: their inputs or levels differ"
    count, size = len(diff.changes), diff.before.values.size
    if not count:
        return f"all {size} cells are equal"
    largest = max(diff.changes, key=lambda change: abs(change.after - change.before))
    return (
        f"{count} of {size} cells changed, by up to "
        f"{number_words(abs(largest.after - largest.before), 4)}"
    )


def table_change_words(diff: TableDiff, change: CellChange) -> str:
    """Return a changed cell in words: position, old and new value."""
    cell = ", ".join(
        f"{name_text(name)} = {number_words(level)}"
        for name, level in zip(diff.before.names, change.levels, strict=True)
    )
    return f"{cell}: {number_text(change.before)} -> {number_text(change.after)}"


def _change_text(x: float) -> str:
    """Return a change with its sign; an unchanged cell is a dot."""
    if x == 0:
        return "."
    text = number_words(x, 3)
    return text if x < 0 else f"+{text}"
