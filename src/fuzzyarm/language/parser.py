"""From text to syntax tree. Never raises: what cannot be read becomes a diagnostic.

From the parts of a statement (expressions, shapes, settings, grids) to the statements and
the whole text; a memory of the last reading keeps an editor quick.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable

from fuzzyarm.expression.kinds import SHAPES, SNORMS, TNORMS
from fuzzyarm.language.nodes import (
    BlockNode,
    Broken,
    CellNode,
    Document,
    EvenTermsNode,
    ExpectNode,
    ExpressionNode,
    Figure,
    GridNode,
    Heading,
    HedgedNode,
    HedgeNode,
    InferenceNode,
    JunctionNode,
    LinearPart,
    LookupItem,
    LookupNode,
    OutcomeNode,
    PropositionNode,
    RowNode,
    RuleNode,
    SettingNode,
    ShapeNode,
    Statement,
    StatementNode,
    TermNode,
    Trivia,
    VariableNode,
    Word,
)
from fuzzyarm.language.tokens import (
    HEDGE_WORDS,
    LOOKUP_ITEMS,
    SETTINGS,
    BlockLine,
    Cursor,
    Fault,
    Group,
    Line,
    Token,
    allowances,
    group_lines,
    tokenize_line,
)
from fuzzyarm.model.rulebase import DEFUZZIFIERS, SAMPLINGS, Rule
from fuzzyarm.model.shapes import EVEN_SHAPES
from fuzzyarm.text.diagnostic import (
    MAX_CHARACTERS,
    MAX_DIAGNOSTICS,
    MAX_LINE,
    MAX_LINES,
    MAX_NESTING,
    Diagnostic,
    Span,
    split_lines,
)

# --- Settings: `key value` pairs of `inference` and `block` ---

OUTSIDE = ("clamp", "extend", "error")
CHOICES: dict[str, tuple[str, ...]] = {
    "and": tuple(TNORMS),
    "or": tuple(name for name, norm in SNORMS.items() if not norm.aggregates),
    "implication": tuple(TNORMS),
    "aggregation": tuple(SNORMS),
    "outside": OUTSIDE,
}
"""The words that each setting takes; ``defuzzifier`` and ``no-rule`` are read apart."""


def read_settings(cursor: Cursor) -> tuple[SettingNode, ...]:
    """Read one or more settings with commas between them."""
    settings = [_read_setting(cursor)]
    while cursor.accept(","):
        settings.append(_read_setting(cursor))
    return tuple(settings)


def _read_setting(cursor: Cursor) -> SettingNode:
    key = cursor.word(f"one of {', '.join(SETTINGS)}", SETTINGS, "unknown-setting")
    if key.text == "defuzzifier":
        return _read_defuzzifier(cursor, key)
    if key.text == "no-rule":
        token = cursor.peek()
        if token is not None and token.kind == "name" and token.text in ("error", "hold"):
            cursor.take()
            return SettingNode(key, value=Word(token.text, token.span))
        what = "error, hold or a number for the case that no rule fires"
        return SettingNode(key, figure=cursor.figure(what, finite=False))
    if key.text == "threshold":
        return SettingNode(key, figure=cursor.figure("the threshold of firing strengths"))
    choices = CHOICES[key.text]
    value = cursor.word(f"one of {', '.join(choices)}", choices, "unknown-choice")
    return SettingNode(key, value=value)


def _read_defuzzifier(cursor: Cursor, key: Word) -> SettingNode:
    method = cursor.word(
        f"a defuzzifier: {', '.join(DEFUZZIFIERS)}", DEFUZZIFIERS, "unknown-defuzzifier"
    )
    if cursor.accept("exact"):
        return SettingNode(key, value=method, exact=True)
    if not cursor.accept("("):
        return SettingNode(key, value=method)
    resolution = cursor.figure("the number of samples")
    sampling: Word | None = None
    if cursor.accept(","):
        sampling = cursor.word(f"one of {', '.join(SAMPLINGS)}", SAMPLINGS, "unknown-choice")
    cursor.expect(")", "after the sampling")
    return SettingNode(key, value=method, resolution=resolution, sampling=sampling)


# --- Shapes: a word and its numbers, pairs, summands or a formula ---


def read_shape(cursor: Cursor) -> ShapeNode:
    """Read a shape up to the end of the line."""
    kind = cursor.word("the shape of the term", tuple(SHAPES), "unknown-shape")
    figures: tuple[Figure, ...] = ()
    parts: tuple[LinearPart, ...] = ()
    formula, formula_span = "", cursor.span
    if kind.text == "points":
        figures = _read_pairs(cursor)
    elif kind.text == "linear":
        parts = _read_sum(cursor)
    elif kind.text == "formula":
        text = cursor.string()
        if text is None:
            cursor.fail("the formula in double quotes")
        formula = text or ""
    else:
        figures = _read_parameters(cursor, kind.text)
    height = cursor.figure("the height") if cursor.accept("height") else None
    return ShapeNode(kind, figures, parts, formula, formula_span, height)


def _read_parameters(cursor: Cursor, kind: str) -> tuple[Figure, ...]:
    wanted = SHAPES[kind].parameters
    start = cursor.span
    figures = []
    while cursor.at_figure:
        figures.append(cursor.figure("a number", finite=False))
    if len(figures) == len(wanted):
        return tuple(figures)
    if not figures and not cursor.at_end:
        cursor.fail(f"the numbers of {kind}: {' '.join(wanted)}")
    if len(figures) > len(wanted):
        start = figures[len(wanted)].span
    raise Fault(
        Diagnostic(
            "wrong-parameter-count",
            f"{kind} takes {len(wanted)} numbers ({', '.join(wanted)}), found {len(figures)}",
            start.to(figures[-1].span) if figures else start,
        )
    )


def _read_pairs(cursor: Cursor) -> tuple[Figure, ...]:
    figures: list[Figure] = []
    while cursor.accept("("):
        figures.append(cursor.figure("the x of a point"))
        cursor.expect(",", "between x and y of a point")
        figures.append(cursor.figure("the y of a point"))
        cursor.expect(")", "after a point")
    if not figures:
        cursor.fail("points like (0, 0) (1, 1)")
    return tuple(figures)


def _read_sum(cursor: Cursor) -> tuple[LinearPart, ...]:
    parts = [_read_summand(cursor, 1.0)]
    while cursor.next_is("+") or cursor.next_is("-"):
        sign = -1.0 if cursor.take().text == "-" else 1.0
        parts.append(_read_summand(cursor, sign))
    return tuple(parts)


def _read_summand(cursor: Cursor, sign: float) -> LinearPart:
    start = cursor.span
    while not cursor.at_figure and cursor.accept("-"):
        sign = -sign
    if not cursor.at_figure:
        variable = cursor.name("a number or an input")
        return LinearPart(sign, variable, variable.span)
    figure = cursor.figure("a number")
    if not cursor.accept("*"):
        return LinearPart(sign * figure.value, None, start.to(figure.span))
    variable = cursor.name("an input")
    return LinearPart(sign * figure.value, variable, start.to(variable.span))


# --- Antecedents and consequents (`and` binds tighter than `or`) ---


def read_expression(cursor: Cursor, depth: int = 0) -> ExpressionNode:
    """Read a disjunction of conjunctions of propositions."""
    if depth > MAX_NESTING:
        raise Fault(
            Diagnostic(
                "too-deep", f"parentheses nest deeper than {MAX_NESTING} levels", cursor.span
            )
        )
    operands = [_conjunction(cursor, depth)]
    while cursor.accept("or"):
        operands.append(_conjunction(cursor, depth))
    return operands[0] if len(operands) == 1 else JunctionNode("or", tuple(operands))


def _conjunction(cursor: Cursor, depth: int) -> ExpressionNode:
    operands = [_operand(cursor, depth)]
    while cursor.accept("and"):
        operands.append(_operand(cursor, depth))
    return operands[0] if len(operands) == 1 else JunctionNode("and", tuple(operands))


def _operand(cursor: Cursor, depth: int) -> ExpressionNode:
    hedges = read_hedges(cursor)
    if cursor.accept("("):
        inner = read_expression(cursor, depth + 1)
        cursor.expect(")", "to close the parenthesis")
        return HedgedNode(hedges, inner) if hedges else inner
    if hedges:
        cursor.fail("'(' after the hedge (or write the hedge behind 'is')")
    return read_proposition(cursor, "the name of a variable")


def read_proposition(cursor: Cursor, what: str) -> PropositionNode:
    """Read ``variable is [hedges] term``."""
    variable = cursor.name(what)
    cursor.expect("is", f"after the variable '{variable.text}'")
    hedges = read_hedges(cursor)
    term = cursor.name(f"a term of '{variable.text}'")
    following = cursor.peek()
    if following is not None and following.kind == "name" and _is_misspelt_hedge(cursor):
        from fuzzyarm.text.names import near_hint

        hint, replacement = near_hint(term.text, HEDGE_WORDS)
        raise Fault(
            Diagnostic(
                "unknown-hedge",
                f"'{term.text}' is no hedge",
                term.span,
                hint=hint or f"hedges are {', '.join(HEDGE_WORDS)}",
                replacement=replacement,
            )
        )
    return PropositionNode(variable, hedges, term)


def _is_misspelt_hedge(cursor: Cursor) -> bool:
    token = cursor.peek()
    return token is not None and token.text not in ("and", "or", "then", "with")


def read_hedges(cursor: Cursor) -> tuple[HedgeNode, ...]:
    """Read hedge words, none or several."""
    hedges: list[HedgeNode] = []
    while True:
        token = cursor.peek()
        if token is None or token.kind != "name" or token.text not in HEDGE_WORDS:
            return tuple(hedges)
        if token.text == "power" and not _opens(cursor.peek(1)):
            return tuple(hedges)
        cursor.take()
        exponent = None
        if token.text == "power":
            cursor.expect("(", "after power")
            exponent = cursor.figure("the exponent")
            cursor.expect(")", "after the exponent")
        hedges.append(HedgeNode(Word(HEDGE_WORDS[token.text], token.span), exponent))


def _opens(token: Token | None) -> bool:
    return token is not None and token.kind == "mark" and token.text == "("


def read_consequents(cursor: Cursor) -> tuple[PropositionNode, ...]:
    """Read one or more consequents, joined by ``and`` or commas."""
    consequents = [read_proposition(cursor, "the name of an output")]
    while cursor.accept("and") or cursor.accept(","):
        consequents.append(read_proposition(cursor, "the name of an output"))
    return tuple(consequents)


# --- Grids: `rules u`, a header and one line per row ---


def read_grid(cursor: Cursor, lines: list[BlockLine], diagnostics: list[Diagnostic]) -> GridNode:
    """Read the grid whose first line `cursor` holds and whose other lines are `lines`."""
    cursor.take()
    output = cursor.name("the output that the rules are for")
    condition: ExpressionNode | None = None
    if cursor.accept("when"):
        condition = read_expression(cursor)
    cursor.finish()
    span = cursor.whole
    if not lines:
        raise Fault(
            Diagnostic(
                "missing-header",
                f"the grid for '{output.text}' has no lines",
                span,
                hint="below it stands a header like  e \\ ce  NB ZE PB  and one line per row",
            )
        )
    header = lines[0]
    row, column, columns = _read_header(Cursor(header.tokens))
    rows = []
    for line in lines[1:]:
        try:
            rows.append(_read_row(Cursor(line.tokens), line, len(columns), diagnostics))
        except Fault as fault:
            diagnostics.append(fault.diagnostic)
    if len(lines) == 1:
        diagnostics.append(
            Diagnostic("empty-grid", f"the grid for '{output.text}' has no rows", span)
        )
    return GridNode(
        output,
        condition,
        row,
        column,
        columns,
        tuple(rows),
        header.trivia,
        Cursor(header.tokens).whole,
        span,
    )


def _read_header(cursor: Cursor) -> tuple[Word | None, Word, tuple[Word, ...]]:
    first = cursor.name("the name of the row variable")
    row: Word | None = None
    column = first
    if cursor.accept("\\"):
        row, column = first, cursor.name("the name of the column variable")
    columns: list[Word] = []
    while not cursor.at_end:
        columns.append(cursor.name(f"a term of '{column.text}'"))
    if not columns:
        cursor.fail(f"the terms of '{column.text}' that head the columns", (), "missing-header")
    return row, column, tuple(columns)


def _read_row(
    cursor: Cursor, line: BlockLine, count: int, diagnostics: list[Diagnostic]
) -> RowNode:
    label = cursor.name("the term that labels the row")
    cells: list[CellNode] = []
    while not cursor.at_end:
        cells.append(_read_cell(cursor, diagnostics))
    if len(cells) != count:
        where = cells[count].span.to(cells[-1].span) if len(cells) > count else cursor.span
        diagnostics.append(
            Diagnostic(
                "wrong-cell-count",
                f"row '{label.text}' has {_cells(len(cells))}, the header names {count} columns",
                where,
                hint="a cell without a rule is written as a dot" if len(cells) < count else "",
            )
        )
    return RowNode(label, tuple(cells[:count]), line.trivia)


def _cells(count: int) -> str:
    return "1 cell" if count == 1 else f"{count} cells"


def _read_cell(cursor: Cursor, diagnostics: list[Diagnostic]) -> CellNode:
    start = cursor.span
    try:
        if cursor.accept("."):
            return CellNode(None, None, start)
        term = cursor.name("a term or a dot")
        if not cursor.accept("*"):
            return CellNode(term, None, start)
        weight = cursor.figure("the weight of the rule")
        return CellNode(term, weight, start.to(weight.span))
    except Fault as fault:
        # One bad cell must not hide the mistakes behind it: note it and go on.
        diagnostics.append(fault.diagnostic)
        if not cursor.at_end and fault.diagnostic.span == cursor.span:
            cursor.take()
        return CellNode(None, None, start)


# --- Statements ---


def read_statement(group: Group, diagnostics: list[Diagnostic]) -> StatementNode:
    """Read one statement; raise a Fault where it cannot be understood."""
    cursor = Cursor(group.tokens)
    if group.keyword == "rules":
        return read_grid(cursor, group.lines, diagnostics)
    if group.keyword == "lookup":
        return _lookup(cursor, group.lines, diagnostics)
    node = _READERS[group.keyword](cursor)
    diagnostics += cursor.forgiven
    cursor.finish()
    return node


def _heading(cursor: Cursor) -> Heading:
    cursor.take()
    return Heading(cursor.name("the name of the rule base"), cursor.string(), cursor.whole)


def _variable(cursor: Cursor) -> VariableNode:
    role = cursor.take().text
    name = cursor.name(f"the name of the {role}")
    try:
        low = cursor.figure("the lower end of the range", finite=False)
        cursor.expect("..", "between the ends of the range")
        high = cursor.figure("the upper end of the range", finite=False)
    except Fault as fault:
        cursor.forgive(fault)
        return VariableNode(role, name, None, None, None, cursor.whole)
    return VariableNode(role, name, low, high, cursor.string(), cursor.whole)


def _even_terms(cursor: Cursor) -> EvenTermsNode:
    cursor.take()
    variables = [cursor.name("the name of a variable")]
    while cursor.accept(","):
        variables.append(cursor.name("the name of a variable"))
    cursor.expect(":", "after the variables")
    family = _family(cursor)
    names = []
    while not cursor.at_end:
        names.append(cursor.name("the name of a term"))
    if not names:
        cursor.fail("the names of the terms, from low to high")
    return EvenTermsNode(tuple(variables), family, tuple(names), cursor.whole)


def _family(cursor: Cursor) -> Word:
    token = cursor.peek()
    try:
        return cursor.word("how the terms are shaped", tuple(EVEN_SHAPES), "unknown-shape")
    except Fault as fault:
        if token is None or token.kind != "name":
            raise
        cursor.forgiven.append(fault.diagnostic)
        cursor.take()
        return Word("triangles", token.span)


def _term(cursor: Cursor) -> TermNode:
    cursor.take()
    variable = cursor.name("the name of a variable")
    name = cursor.name("the name of the term")
    try:
        cursor.expect(":", "after the name of the term")
        shape = read_shape(cursor)
        cursor.finish()
    except Fault as fault:
        cursor.forgive(fault)
        shape = None
    return TermNode(variable, name, shape, cursor.whole)


def _inference(cursor: Cursor) -> InferenceNode:
    cursor.take()
    target: Word | None = None
    second = cursor.peek(1)
    if second is not None and second.kind == "mark" and second.text == ":":
        target = cursor.name("the name of a variable")
        cursor.take()
    return InferenceNode(target, read_settings(cursor), cursor.whole)


def _block(cursor: Cursor) -> BlockNode:
    cursor.take()
    name = cursor.name("the name of the block")
    settings = read_settings(cursor) if cursor.accept(":") else ()
    return BlockNode(name, settings, cursor.whole)


def _rule(cursor: Cursor) -> RuleNode:
    cursor.take()
    cursor.expect("if", "after 'rule'")
    antecedent = read_expression(cursor)
    cursor.expect("then", "after the antecedent")
    consequents = read_consequents(cursor)
    weight = cursor.figure("the weight of the rule") if cursor.accept("with") else None
    return RuleNode(antecedent, consequents, weight, cursor.whole)


def _expect(cursor: Cursor) -> ExpectNode:
    cursor.take()
    inputs = [_assignment(cursor)]
    while cursor.accept(","):
        inputs.append(_assignment(cursor))
    cursor.expect("->", "after the inputs")
    outcomes = [_outcome(cursor)]
    while cursor.accept(","):
        outcomes.append(_outcome(cursor))
    return ExpectNode(tuple(inputs), tuple(outcomes), cursor.whole)


def _assignment(cursor: Cursor) -> tuple[Word, Figure]:
    name = cursor.name("the name of an input")
    cursor.expect("=", f"after '{name.text}'")
    return name, cursor.figure("a number")


def _outcome(cursor: Cursor) -> OutcomeNode:
    name = cursor.name("the name of an output")
    other: Figure | None = None
    for relation in ("=", "<=", ">=", "<", ">", "in"):
        if cursor.accept(relation):
            break
    else:
        cursor.fail("one of = < <= > >= in")
    value = cursor.figure("a number")
    if relation == "in":
        cursor.expect("..", "between the ends of the interval")
        other = cursor.figure("a number")
    elif relation == "=" and cursor.accept("within"):
        other = cursor.figure("the tolerance")
    return OutcomeNode(name, relation, value, other)


def _lookup(cursor: Cursor, lines: list[BlockLine], diagnostics: list[Diagnostic]) -> LookupNode:
    cursor.take()
    cursor.finish()
    items = []
    for line in lines:
        try:
            items.append(_lookup_item(Cursor(line.tokens), line))
        except Fault as fault:
            diagnostics.append(fault.diagnostic)
    return LookupNode(tuple(items), cursor.whole)


def _lookup_item(cursor: Cursor, line: BlockLine) -> LookupItem:
    key = cursor.word("levels, bins or round", LOOKUP_ITEMS, "unknown-setting")
    variable: Word | None = None
    second = cursor.peek(1)
    if second is not None and second.kind == "mark" and second.text == ":":
        variable = cursor.name("the name of an input")
        cursor.take()
    form = "list"
    figures = [cursor.figure("a number")]
    if key.text == "levels" and cursor.accept(".."):
        figures.append(cursor.figure("the last level"))
        form = cursor.word("'step' or 'count'", ("step", "count"), "unexpected-token").text
        figures.append(cursor.figure(f"the {form}"))
    while form == "list" and key.text != "round" and cursor.at_figure:
        figures.append(cursor.figure("a number"))
    if key.text == "bins" and cursor.accept("mirrored"):
        form = "mirrored"
    cursor.finish()
    return LookupItem(key, variable, form, tuple(figures), line.trivia, cursor.whole)


_READERS: dict[str, Callable[[Cursor], StatementNode]] = {
    "rulebase": _heading,
    "input": _variable,
    "output": _variable,
    "terms": _even_terms,
    "term": _term,
    "inference": _inference,
    "block": _block,
    "rule": _rule,
    "expect": _expect,
}


# --- The memory of the last reading ---
#
# An editor reads the same file again after every key stroke. Lines and statements that stand
# where they stood are taken over; the result is the same with a memory and without.

Found = tuple[Diagnostic, ...]


class ParseMemory:
    """The lines, statements and rules of one text as they were read last."""

    def __init__(self) -> None:
        self._lines: list[tuple[str, Line, Found]] = []
        self._statements: dict[int, tuple[Group, StatementNode, Found]] = {}
        self._fresh: dict[int, tuple[Group, StatementNode, Found]] = {}
        self._scope: Hashable = None
        self._rules: dict[int, tuple[StatementNode, list[Rule], Found]] = {}
        self._fresh_rules: dict[int, tuple[StatementNode, list[Rule], Found]] = {}

    @property
    def lines(self) -> list[Line]:
        """The lines of the last text as tokens."""
        return [line for _, line, _ in self._lines]

    def tokenize(self, text: str, diagnostics: list[Diagnostic]) -> list[Line]:
        """Return what :func:`fuzzyarm.language.tokens.tokenize` returns."""
        before = self._lines
        self._lines = []
        for index, line in enumerate(split_lines(text)):
            entry = before[index] if index < len(before) else None
            if entry is None or entry[0] != line:
                found: list[Diagnostic] = []
                entry = (line, tokenize_line(index + 1, line, found), tuple(found))
            diagnostics += entry[2]
            self._lines.append(entry)
            if len(diagnostics) > MAX_DIAGNOSTICS:
                break  # this is no rule base; reading all of it would take for ever
        return self.lines

    def recall(self, group: Group) -> tuple[StatementNode, Found] | None:
        """Return the statement of `group` and its diagnostics if it was read here before."""
        known = self._statements.get(group.tokens[0].line)
        if known is None or known[0].tokens != group.tokens or known[0].lines != group.lines:
            return None
        self._fresh[group.tokens[0].line] = known
        return known[1], known[2]

    def keep(self, group: Group, node: StatementNode, found: list[Diagnostic]) -> None:
        """Remember the statement that `group` was read as."""
        self._fresh[group.tokens[0].line] = (group, node, tuple(found))

    def finish(self) -> None:
        """Forget what the text that has just been read does not have."""
        self._statements, self._fresh = self._fresh, {}

    def enter_scope(self, scope: Hashable) -> None:
        """Start to give rules their meaning under these variables and terms."""
        kept = self._fresh_rules if scope == self._scope else {}
        self._scope, self._rules, self._fresh_rules = scope, kept, {}

    def recall_rules(self, node: StatementNode) -> tuple[list[Rule], Found] | None:
        """Return the rules of a statement that was met last time under the same scope."""
        known = self._rules.get(id(node))
        if known is None or known[0] is not node:
            return None
        self._fresh_rules[id(node)] = known
        return known[1], known[2]

    def keep_rules(self, node: StatementNode, rules: list[Rule], found: list[Diagnostic]) -> None:
        """Remember what a statement means."""
        self._fresh_rules[id(node)] = (node, rules, tuple(found))


# --- The whole text ---


def parse_document(text: str, memory: ParseMemory | None = None) -> Document:
    """Return the syntax tree of `text` with every lexical and syntactic mistake.

    A statement that cannot be read is kept as :class:`Broken`, and reading goes on with
    the next one. With a `memory`, what has not changed since the last text is not read again.
    """
    too_large = _size_fault(text)
    if too_large is not None:
        return Document((), diagnostics=(too_large,))
    diagnostics: list[Diagnostic] = []
    memory = memory or ParseMemory()
    lines = memory.tokenize(text, diagnostics)
    groups, ending = group_lines(lines, diagnostics)
    statements = tuple(_read_group(group, diagnostics, memory) for group in groups)
    memory.finish()
    return Document(statements, ending, allowances(lines), _first_at_each_place(diagnostics))


def _first_at_each_place(diagnostics: list[Diagnostic]) -> tuple[Diagnostic, ...]:
    # The lexer's complaint of a token comes before the parser's of the same one.
    first: dict[tuple[int, int], Diagnostic] = {}
    for diagnostic in diagnostics:
        first.setdefault((diagnostic.line, diagnostic.column), diagnostic)
    return tuple(sorted(first.values(), key=lambda diagnostic: diagnostic.span))


def _read_group(group: Group, diagnostics: list[Diagnostic], memory: ParseMemory) -> Statement:
    trivia = Trivia(group.before, group.behind)
    if len(diagnostics) > MAX_DIAGNOSTICS:
        return Statement(Broken(group.keyword, group.tokens[0].span), trivia)
    known = memory.recall(group)
    if known is None:
        found: list[Diagnostic] = []
        node = _read_node(group, found)
        memory.keep(group, node, found)
        known = node, tuple(found)
    diagnostics += known[1]
    return Statement(known[0], trivia)


def _read_node(group: Group, diagnostics: list[Diagnostic]) -> StatementNode:
    # A token that the lexer has already complained of needs no second complaint.
    if any(token.kind == "bad" for token in group.tokens):
        return Broken(group.keyword, Cursor(group.tokens).whole)
    try:
        return read_statement(group, diagnostics)
    except Fault as fault:
        diagnostics.append(fault.diagnostic)
        return Broken(group.keyword, Cursor(group.tokens).whole)


def _size_fault(text: str) -> Diagnostic | None:
    if len(text) > MAX_CHARACTERS:
        return Diagnostic(
            "file-too-large",
            f"the text has {len(text):,} characters; the limit is {MAX_CHARACTERS:,}",
        )
    if text.count("\n") + text.count("\r") > MAX_LINES and len(split_lines(text)) > MAX_LINES:
        return Diagnostic(
            "file-too-large",
            f"the text has more than {MAX_LINES:,} lines",
            Span(MAX_LINES + 1, 1, MAX_LINES + 1, 2),
        )
    if len(text) > MAX_LINE:
        for number, line in enumerate(split_lines(text), start=1):
            if len(line) > MAX_LINE:
                return Diagnostic(
                    "line-too-long",
                    f"the line has {len(line):,} characters; the limit is {MAX_LINE:,}",
                    Span(number, MAX_LINE + 1, number, MAX_LINE + 2),
                )
    return None
