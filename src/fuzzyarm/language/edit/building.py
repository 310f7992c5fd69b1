"""Additions to and removals from a rule base: variables, settings, rules in words."""

from __future__ import annotations

from collections.abc import Sequence

from fuzzyarm.base.diagnostic import Word
from fuzzyarm.base.numbers import number_text
from fuzzyarm.language.edit.fixes import Edit
from fuzzyarm.language.edit.lines import (
    INCOMPLETE,
    ReshapeError,
    declaration_of,
    demand_sound,
    last_line,
    last_lines,
    lines_behind,
    nodes_of,
    without_line_ranges,
)
from fuzzyarm.language.edit.reading import Reading, read
from fuzzyarm.language.edit.references import rename
from fuzzyarm.language.edit.reshape import set_rule
from fuzzyarm.language.phrases import JunctionNode, NameKind, PropositionNode, SettingNode
from fuzzyarm.language.rows import columns_of, mentions, sentence, text_of
from fuzzyarm.language.rules import GridNode, RuleNode
from fuzzyarm.language.statements import (
    EvenTermsNode,
    Heading,
    InferenceNode,
    LookupNode,
    StatementNode,
    TermNode,
    VariableNode,
)
from fuzzyarm.language.tokens import name_text
from fuzzyarm.language.tune import TuneNode

# --- Variables ---


def add_variable(
    reading: Reading,
    role: str,
    variable: str,
    ends: tuple[float, float],
    terms: Sequence[str] = (),
) -> list[Edit]:
    """Return the edits that declare another variable, with evenly spaced triangles as its terms.

    Parameters
    ----------
    reading : Reading
        The text.
    role : str
        ``input`` or ``output``.
    variable : str
        Its name.
    ends : tuple of float
        Ends of its range.
    terms : sequence of str, optional
        Their names, from low to high.

    Raises
    ------
    ReshapeError
        If the variable exists, or the text would become invalid; with the fault.
    """
    if not variable.strip():
        raise ReshapeError("a variable needs a name")
    if any(isinstance(n, VariableNode) and n.name == variable for n in nodes_of(reading)):
        raise ReshapeError(f"there is a variable '{variable}' already")
    if not ends[0] < ends[1]:
        raise ReshapeError("the range must go from a lower to a higher number")
    if role not in ("input", "output"):
        raise ReshapeError(f"a variable is an input or an output, not '{role}'")
    name = name_text(variable)
    text = f"{role:<6} {name}  {number_text(ends[0])} .. {number_text(ends[1])}"
    family = [f"terms {name}: triangles {' '.join(map(name_text, terms))}"] if terms else []
    line, gap = _line_of_new(reading, role)
    last = max(line, last_line(reading, VariableNode))
    termed = last_line(reading, TermNode, EvenTermsNode)
    if termed > last:
        behind, space = termed, []
    else:
        behind, space = last, [""]
    if not family:
        edits = [lines_behind(reading, line, [*gap, text])]
    # One edit: two insertions at one position would come out in the wrong order.
    elif behind == line:
        edits = [lines_behind(reading, line, [*gap, text, *space, *family])]
    else:
        edits = [
            lines_behind(reading, line, [*gap, text]),
            lines_behind(reading, behind, [*space, *family]),
        ]
    return demand_sound(reading, edits)


def _line_of_new(reading: Reading, role: str) -> tuple[int, list[str]]:
    """Return after which line a variable is declared, and the blank line in between."""
    declarations = [
        (n, start, end) for n, start, end in reading.extents if isinstance(n, VariableNode)
    ]
    same = [end for node, _, end in declarations if node.role == role]
    if same:
        return same[-1], []
    if declarations and role == "output":
        return declarations[-1][2], []
    if declarations:  # the first input, in front of the outputs
        return declarations[0][1] - 1, []
    line = last_line(reading, Heading) or max(len(reading.raw_lines), 1)
    return line, [""] if reading.raw_line(line).strip() else []


def remove_variable(reading: Reading, variable: str) -> list[Edit]:
    """Return the edits that remove a variable with all that names it.

    Its terms go, the grids that it heads or that conclude it, sentences, expectations, properties
    and lines of other blocks that name it.

    Raises
    ------
    ReshapeError
        If the text declares no such variable, or the term of another one or a grid of several
        outputs names it.
    """
    declaration_of(reading, variable)
    ends = last_lines(reading)
    ranges: list[tuple[int, int]] = []
    edits: list[Edit] = []
    for node in nodes_of(reading):
        if not _names(node, variable):
            continue
        lines, changes = _without(node, variable)
        ranges += lines or ([] if changes else [(node.span.line, ends[node.span.line])])
        edits += changes
    return [*without_line_ranges(reading, ranges), *edits]


def _names(node: StatementNode, variable: str) -> bool:
    """Whether a statement declares a variable, or names it or a term of it."""
    return any(
        (mention.kind is NameKind.VARIABLE and mention.name == variable)
        or variable in mention.owners
        for mention in mentions(node)
    )


def _without(node: StatementNode, variable: str) -> tuple[list[tuple[int, int]], list[Edit]]:
    """Return lines to delete and edits that free a statement of a variable; neither: delete it."""
    if isinstance(node, EvenTermsNode):
        others = tuple(word for word in node.variables if word != variable)
        return [], [Edit(node.span, text_of(node._replace(variables=others)))] if others else []
    if isinstance(node, TermNode) and node.variable != variable:
        raise ReshapeError(
            f"the term '{node.name}' on line {node.span.line} names '{variable}'",
            hint="change that first",
        )
    if isinstance(node, RuleNode):
        return [], _other_consequents(node, variable)
    if isinstance(node, GridNode) and node.joined and _concludes(node, variable):
        raise ReshapeError(
            f"the grid on line {node.span.line} concludes '{variable}' and others",
            hint="change that first",
        )
    if isinstance(node, LookupNode):
        items = [item for item in node.items if item.variable == variable]
        lines = [(lookup_item.span.line, lookup_item.span.line) for lookup_item in items]
        return lines if len(lines) < len(node.items) else [], []
    if isinstance(node, TuneNode):
        return _without_tuning(node, variable)
    return [], []


def _concludes(grid: GridNode, variable: str) -> bool:
    return any(part.output == variable for part in grid.parts)


def _other_consequents(node: RuleNode, variable: str) -> list[Edit]:
    """Return the edit that keeps a rule's other conclusions, if only one names the variable."""
    others = tuple(consequent for consequent in node.consequents if consequent.variable != variable)
    asks = any(mention.name == variable for mention in node.antecedent.mentions())
    if asks or not others:
        return []
    return [Edit(node.span, text_of(node._replace(consequents=others)))]


def _without_tuning(node: TuneNode, variable: str) -> tuple[list[tuple[int, int]], list[Edit]]:
    lines, edits = [], []
    for item in node.items:
        names = tuple(word for word in item.names if word != variable)
        if item.key == "gain" or len(names) == len(item.names):
            continue
        if names:
            edits.append(Edit(item.span, "  ".join(columns_of(item._replace(names=names)))))
        else:
            lines.append((item.span.line, item.span.line))
    return ([] if len(lines) == len(node.items) else lines), edits


def rename_variable(reading: Reading, variable: str, name: str) -> list[Edit]:
    """Return the edits that give a variable another name wherever it is named; see :func:`rename`.

    Raises
    ------
    ReshapeError
        If the text declares no such variable.
    RenameError
        If the name cannot be given.
    """
    at = declaration_of(reading, variable).name.span
    return rename(reading, at.line, at.column, name)


# --- Settings ---


def set_setting(reading: Reading, key: str, value: str, target: str = "") -> list[Edit]:
    """Return the edits that set how the rules are evaluated, for all or for one variable.

    Parameters
    ----------
    reading : Reading
        The text.
    key, value : str
        As after ``inference``: ``and``, ``product``.
    target : str, optional
        A variable with a line of its own; by default the common setting.

    Raises
    ------
    ReshapeError
        If the text would become invalid; with the fault.
    """
    setting = _setting(key, value)
    lines = [
        node
        for node in nodes_of(reading)
        if isinstance(node, InferenceNode)
        and (node.target if node.target is not None else "") == target
    ]
    having = [
        node for node in lines if any(setting_node.key == key for setting_node in node.settings)
    ]
    if having:  # the last one counts
        settings = [
            setting if setting_node.key == key else setting_node
            for setting_node in having[-1].settings
        ]
        edits = [Edit(having[-1].span, text_of(having[-1]._replace(settings=tuple(settings))))]
    elif lines:
        settings = [*lines[0].settings, setting]
        edits = [Edit(lines[0].span, text_of(lines[0]._replace(settings=tuple(settings))))]
    else:
        node = InferenceNode(Word(target) if target else None, (setting,))
        line = last_line(reading, InferenceNode)
        gap = [] if line else [""]
        line = line or last_line(reading, Heading, VariableNode, TermNode, EvenTermsNode) or 1
        edits = [lines_behind(reading, line, [*gap, text_of(node)])]
    return demand_sound(reading, edits)


def _setting(key: str, value: str) -> SettingNode:
    """Read a setting as in a text."""
    reading = read(f"inference {' '.join(f'{key} {value}'.split())}\n")
    node = next(nodes_of(reading), None)
    if isinstance(node, InferenceNode) and len(node.settings) == 1:
        return node.settings[0]
    wrong = [e for e in reading.parsed.diagnostics if e.is_error and e.name not in INCOMPLETE]
    if wrong:
        raise ReshapeError(wrong[0].message, hint=wrong[0].hint)
    raise ReshapeError(f"'{key} {value}' is not a setting")


# --- Rules in words ---


def add_rule(
    reading: Reading,
    antecedent: Sequence[tuple[str, str]],
    consequents: Sequence[tuple[str, str]],
    join: str = "and",
) -> list[Edit]:
    """Return the edits that add a rule of propositions, each a variable and a term.

    Parameters
    ----------
    reading : Reading
        The text.
    antecedent, consequents : sequence of (str, str)
        After ``if`` and ``then``.
    join : str, optional
        ``and`` or ``or``, between the propositions of the antecedent.

    Raises
    ------
    ReshapeError
        If the text would become invalid; with the fault.
    """
    if not antecedent or not consequents:
        raise ReshapeError("a rule reads: if … then …")
    nodes, proposition_nodes = (
        tuple(PropositionNode(Word(name), (), Word(term)) for name, term in part)
        for part in (antecedent, consequents)
    )
    condition = (
        nodes[0] if len(nodes) == 1 else JunctionNode("or" if join == "or" else "and", nodes)
    )
    return set_rule(reading, None, sentence(RuleNode(condition, proposition_nodes, None)))
