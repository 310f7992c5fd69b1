"""Write a rule base in Python, statement by statement, as short as the file.

A builder *is* the file that it writes: every method adds lines of the language, which the
language's own reader parses and checks. A bad argument is therefore a bad line, and the call with
the argument raises its finding.

    >>> import fuzzyarm
    >>> fan = fuzzyarm.RuleBaseBuilder("fan")
    >>> temp = fan.input("temp", 0, 40, "°C", terms=["cold", "warm", "hot"])
    >>> speed = fan.output("speed", 0, 100, "%", terms={"slow": (0, 0, 50), "fast": (50, 100, 100)})
    >>> fan.rule("if temp is hot then speed is fast")
    >>> fan.rule("if temp is cold or temp is warm then speed is slow")
    >>> fan(temp=30)
    {'speed': 50.0}
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypedDict, Unpack

from fuzzyarm.apps.builder.lines import (
    BuilderArgumentError,
    Corners,
    GridLines,
    LanguageLines,
    Levels,
    Terms,
    write_settings,
    write_shape,
    write_terms,
)
from fuzzyarm.base.diagnostic import Diagnostic, RuleBaseError, Span, split_lines
from fuzzyarm.base.keywords import demand_keywords
from fuzzyarm.base.names import shortened
from fuzzyarm.base.shown import Plotted, one_line
from fuzzyarm.exchange.files import Review, check_parsed
from fuzzyarm.language.controllers import CONTROLLER_STATEMENTS
from fuzzyarm.language.document import (
    Document,
    ParseMemory,
    Statement,
    parse_document,
    parse_statements,
    print_document,
)
from fuzzyarm.language.foreign_syntax import corrected_document
from fuzzyarm.language.meaning import elaborate, judge_statement
from fuzzyarm.language.model.rulebase import (
    AnyRuleBase,
    Defuzzifier,
    Input,
    Output,
    RuleBase,
    model_of,
    outline,
)
from fuzzyarm.language.reading import Parsed, parse
from fuzzyarm.language.rules import GridNode, RuleNode
from fuzzyarm.language.statements import (
    BlockNode,
    EvenTermsNode,
    ExpectNode,
    Heading,
    InferenceNode,
    LookupNode,
    ProveNode,
    TermNode,
    VariableNode,
)
from fuzzyarm.language.writer import write

if TYPE_CHECKING:
    from fuzzyarm.language.declarations import Scope
    from fuzzyarm.language.statements import StatementNode

# --- The builder ---

_OF_THE_WHOLE = ("missing-heading", "no-inputs", "no-outputs", "no-rules")
"""Findings about missing parts, for which no argument is to blame."""


class OutputSettings(TypedDict, total=False):
    """Settings of an output.

    Attributes
    ----------
    aggregation : str
        Combination of the cut sets of several rules: an S-norm. ``max`` by default.
    defuzzifier : str or Defuzzifier
        ``"centroid(101, midpoints)"``, ``"weighted-average"``, …; the exact centroid by
        default.
    no_rule : float or str
        The value for no rule, ``"hold"`` or, by default, ``"error"``.
    outside : str
        As of an input.
    """

    aggregation: str | None
    defuzzifier: str | Defuzzifier | None
    no_rule: float | str | None
    outside: str | None


class RuleBaseBuilder(AnyRuleBase):
    """A rule base under construction; its current value is :attr:`model`.

    Why two classes: a value with many holders (a cache, a table's origin, another process) must not
    change, a text under construction must. So a builder grows, and its `model`, the
    :class:`fuzzyarm.RuleBase` of a file with the same lines, never changes, compares and hashes.
    There is no other difference: either can be called, drawn, checked, compiled and written, and
    every function of fuzzyarm accepts both.

    Names are declared before use. Statements without a method go through :meth:`add`, so the whole
    language can be written. Controllers are text only.

    Parameters
    ----------
    name : str
        Name of the rule base.
    description : str, optional
        Its purpose.

    Examples
    --------
    >>> fan = RuleBaseBuilder("fan")
    >>> temp = fan.input("temp", 0, 40, "°C", terms=["cold", "warm", "hot"])
    >>> speed = fan.output("speed", 0, 100, "%", terms={"slow": 0, "fast": 100})
    >>> fan.grid("speed", ["slow", "slow", "fast"])
    >>> fan
    <RuleBaseBuilder fan: temp → speed, 3 rules>
    >>> fan.rule("if tmp is hot then speed is fast")
    Traceback (most recent call last):
    fuzzyarm.base.diagnostic.RuleBaseError: rule('if tmp is hot then speed is fast'): \
error[unknown-variable]: no variable is called 'tmp' (did you mean 'temp'?)
    >>> print(fan)
    rulebase fan
    <BLANKLINE>
    input  temp   0 .. 40   "°C"
    terms temp: triangles cold warm hot
    output speed  0 .. 100  "%"
    term speed slow:  singleton 0
    term speed fast:  singleton 100
    <BLANKLINE>
    rules speed
      temp   cold  warm  hot
      speed  slow  slow  fast
    """

    def __init__(self, name: str, description: str = "") -> None:
        self._start()
        lines = LanguageLines("RuleBaseBuilder(")
        lines.write("rulebase ").name(name, "name")
        if description:
            lines.write(" ").string(description, "description")
        self._add(lines)

    def _start(self) -> None:
        self._calls: list[tuple[int, LanguageLines]] = []  # each with the number of its first line
        self._line = 1
        self._statements: list[Statement] = []
        self._ending: tuple[str, ...] = ()
        self._allowed: dict[int, frozenset[str]] = {}
        self._memory = ParseMemory()
        self._scope: Scope | None = None
        self._model: RuleBase | None = None

    @classmethod
    def from_text(cls, text: str) -> RuleBaseBuilder:
        """Return a builder that continues a text.

        Parameters
        ----------
        text : str
            Text of a ``.frb`` file; its comments stay.

        Raises
        ------
        RuleBaseError
            If the text has mistakes.
        """
        builder = cls.__new__(cls)
        builder._start()
        builder.add(text)
        return builder

    @classmethod
    def of(cls, rulebase: AnyRuleBase) -> RuleBaseBuilder:
        """Return a builder that continues a rule base, which itself does not change.

        Parameters
        ----------
        rulebase : value or builder
            For instance the result of :func:`fuzzyarm.load`.
        """
        if isinstance(rulebase, RuleBaseBuilder):
            return cls.from_text(str(rulebase))
        return cls.from_text(write(model_of(rulebase)))

    # -- statements --

    def input(
        self,
        name: str,
        low: float,
        high: float,
        description: str = "",
        *,
        terms: Terms = (),
        outside: str | None = None,
    ) -> VariableBuilder:
        """Declare an input.

        Parameters
        ----------
        name : str
            Any text.
        low, high : float
            Its range, ``low < high``, in the unit of the description; may be infinite.
        description : str, optional
            Its meaning or unit.
        terms : sequence of str, mapping or str, optional
            A list of names: triangles, spread evenly over the range. A mapping from a name to
            corners (1 a singleton, 2 a rectangle, 3 a triangle, 4 a trapezoid; pairs x, y are
            points), to a :class:`~fuzzyarm.language.model.rulebase.Shape`, or to text as in a file,
            ``"gaussian 5 1"``. Text as in a file spreads another family: ``"gaussians S M L"``.
        outside : str, optional
            Treatment of values outside the range: ``clamp``, ``extend`` or ``error``.

        Returns
        -------
        VariableBuilder
            For further terms.

        Raises
        ------
        RuleBaseError
            For any mistake of the corresponding text; the finding names the argument.
        BuilderArgumentError
            For an argument of another type.
        """
        settings = {"outside": outside}
        return self._declare("input", name, low, high, description, terms, settings)

    def output(
        self,
        name: str,
        low: float,
        high: float,
        description: str = "",
        *,
        terms: Terms = (),
        **settings: Unpack[OutputSettings],
    ) -> VariableBuilder:
        """Declare an output.

        Parameters
        ----------
        name, low, high, description, terms
            As of :meth:`input`. Terms may be values too: ``"linear 2*e - 1"``.
        **settings
            ``aggregation``, ``defuzzifier``, ``no_rule``, ``outside``; see
            :class:`~fuzzyarm.apps.builder.rulebase.OutputSettings`.

        Returns
        -------
        VariableBuilder
            For further terms.

        Raises
        ------
        RuleBaseError, BuilderArgumentError
            As :meth:`input`.
        """
        demand_keywords("output", settings, OutputSettings)
        lines = {name: settings.get(name) for name in OutputSettings.__annotations__}
        return self._declare("output", name, low, high, description, terms, lines)

    def _declare(
        self,
        role: str,
        name: str,
        low: float,
        high: float,
        description: str,
        terms: Terms,
        settings: Mapping[str, object],
    ) -> VariableBuilder:
        lines = LanguageLines(f"{role}({shortened(repr(name))}")
        lines.write(f"{role} ").name(name, "name").write(" ")
        lines.number(low, "low").write(" .. ").number(high, "high")
        if description:
            lines.write(" ").string(description, "description")
        write_terms(lines, name, terms, self._names("input"))
        if any(value is not None for value in settings.values()):
            lines.next().write("inference ").name(name, "name")
            write_settings(lines.write(":"), settings)
        self._add(lines)
        return VariableBuilder(self, name)

    def term(self, variable: str | VariableBuilder, name: str, shape: Corners) -> None:
        """Add a term to a variable, or replace an evenly spaced one.

        Parameters
        ----------
        variable : str or VariableBuilder
            Whose.
        name : str
            Of the term.
        shape : float, sequence, Shape or str
            As in the mapping of :meth:`input`.

        Raises
        ------
        RuleBaseError, BuilderArgumentError
            As :meth:`input`.
        """
        lines = LanguageLines(
            f"term({shortened(repr(_name_of(variable)))}, {shortened(repr(name))}"
        )
        lines.write("term ").name(_name_of(variable), "variable").write(" ").name(name, "name")
        write_shape(lines.write(": "), shape, "shape", self._names("input"))
        self._add(lines)

    def rule(self, text: str, weight: float | None = None) -> None:
        """Add a rule.

        Parameters
        ----------
        text : str
            ``if … then …``, as in a file.
        weight : float, optional
            Factor on its firing strength, 0 to 1.

        Raises
        ------
        RuleBaseError, BuilderArgumentError
            As :meth:`input`.
        """
        lines = LanguageLines(f"rule({shortened(repr(text), 100)}")
        words = lines.words(text, "text").strip()
        lines.write("rule ").raw(words.removeprefix("rule "), "")
        if weight is not None:
            lines.write(" with ").number(weight, "weight")
        self._add(lines)

    def grid(
        self,
        output: str | VariableBuilder,
        cells: Any,
        *,
        rows: str | VariableBuilder | None = None,
        columns: str | VariableBuilder | None = None,
        when: str = "",
    ) -> None:
        r"""Add a grid of rules: the term of an output for each pair of terms of two inputs.

        Parameters
        ----------
        output : str or VariableBuilder
            Which.
        cells : list of lists, mapping of lists, or DataFrame
            Term names. None, NaN, an empty text or a dot is a cell without a rule, a tuple
            (term, weight) one with a weight. Plain lists have a row for each term of the
            variable that goes down and a cell for each term of the one that goes across, in the
            order in which the terms were declared. A mapping or a DataFrame names its rows, a
            DataFrame its columns too. Over one input it is one list.
        rows, columns : str or VariableBuilder, optional
            The inputs that go down and across. By default the names of the index and the
            columns of a DataFrame, else the first and the second input of the rule base.
        when : str, optional
            A condition added to every rule: ``"load is heavy"``.

        Raises
        ------
        RuleBaseError, BuilderArgumentError
            As :meth:`input`; the finding names the cell.
        """
        lines = LanguageLines(f"grid({shortened(repr(_name_of(output)))}")
        lines.write("rules ").name(_name_of(output), "output")
        if when:
            lines.write(" when ").raw(when, "when")
        grid = GridLines(lines, cells)
        down, across = self._sides(grid, rows, columns)
        lines.next().write("  ")
        if down is not None:
            lines.name(down, "rows").write(" \\ ")
        lines.name(across, "columns")
        for i, term in enumerate(grid.columns or self._terms_of(across)):
            lines.write("  ").name(term, f"cells.columns[{i}]" if grid.columns else "columns")
        for i, label in enumerate(self._labels(grid, down, _name_of(output))):
            grid.write_row(i, label, f"rows[{i}]" if grid.rows else "rows")
        self._add(lines)

    def _sides(
        self,
        grid: GridLines,
        rows: str | VariableBuilder | None,
        columns: str | VariableBuilder | None,
    ) -> tuple[str | None, str]:
        """Return the variables that go down and across; none goes down over one input."""
        down, across = _name_of(rows) or grid.names[0], _name_of(columns) or grid.names[1]
        inputs = self._names("input")
        if across is None and down is None and 0 < len(inputs) <= 2:
            return (None, inputs[0]) if len(inputs) == 1 else (inputs[0], inputs[1])
        others = [name for name in inputs if name not in (down, across)]
        if across is None and len(others) == 1:
            across = others[0]
        if across is None:
            present = ", ".join(inputs) or "none"
            message = f"say which inputs go down and across (there are {present})"
            raise BuilderArgumentError(grid.lines.named("rows, columns"), message)
        if down is None and len(grid.cells) > 1 and len(others) == 1:
            down = others[0]
        return down, across

    def _labels(self, grid: GridLines, down: str | None, output: str) -> list[str]:
        if down is None:
            return [output] * len(grid.cells)
        labels = grid.rows if grid.rows is not None else self._terms_of(down)
        if len(labels) != len(grid.cells):
            message = f"{len(grid.cells)} rows, but '{down}' has {len(labels)} terms"
            raise BuilderArgumentError(grid.lines.named("cells"), message)
        return labels

    def inference(
        self,
        *,
        conjunction: str | None = None,
        disjunction: str | None = None,
        implication: str | None = None,
        threshold: float | None = None,
        aggregation: str | None = None,
        defuzzifier: str | Defuzzifier | None = None,
        no_rule: float | str | None = None,
        outside: str | None = None,
    ) -> None:
        """Set the inference methods, and defaults of all variables.

        Parameters
        ----------
        conjunction, disjunction, implication : str, optional
            Norms of ``and``, ``or`` and the cut of a consequent: ``min``, ``product``, ….
        threshold : float, optional
            A rule fires only above this firing strength, 0 to 1.
        aggregation, defuzzifier, no_rule, outside
            As of :meth:`output`, for all outputs (`outside` for inputs too).

        Raises
        ------
        RuleBaseError, BuilderArgumentError
            As :meth:`input`.
        """
        settings = {
            "conjunction": conjunction,
            "disjunction": disjunction,
            "implication": implication,
            "threshold": threshold,
            "aggregation": aggregation,
            "defuzzifier": defuzzifier,
            "no_rule": no_rule,
            "outside": outside,
        }
        lines = LanguageLines("inference(").write("inference")
        write_settings(lines, settings)
        self._add(lines)

    def block(
        self,
        name: str,
        *,
        conjunction: str | None = None,
        disjunction: str | None = None,
        implication: str | None = None,
        threshold: float | None = None,
    ) -> None:
        """Begin a block: the following rules may use outputs of earlier ones.

        Parameters
        ----------
        name : str
            Name of the block.
        conjunction, disjunction, implication, threshold
            As of :meth:`inference`, for this block.

        Raises
        ------
        RuleBaseError, BuilderArgumentError
            As :meth:`input`.
        """
        settings = {
            "conjunction": conjunction,
            "disjunction": disjunction,
            "implication": implication,
            "threshold": threshold,
        }
        lines = LanguageLines(f"block({shortened(repr(name))}")
        lines.write("block ").name(name, "name")
        if any(value is not None for value in settings.values()):
            write_settings(lines.write(":"), settings)
        self._add(lines)

    def lookup(
        self,
        levels: Levels | Mapping[str, Levels],
        *,
        bins: Levels | Mapping[str, Levels] | None = None,
        rounding: float | None = None,
    ) -> None:
        """Set the levels, bins and rounding of the lookup table.

        Parameters
        ----------
        levels : str, sequence of float, or mapping of them
            For every input, or by input: increasing numbers, or text as in a file,
            ``"0 .. 40 step 5"``.
        bins : str, sequence of float, or mapping of them, optional
            Thresholds between neighbouring levels.
        rounding : float, optional
            The step that values are rounded to, above 0.

        Raises
        ------
        RuleBaseError, BuilderArgumentError
            As :meth:`input`.
        """
        lines = LanguageLines("lookup(").write("lookup")
        for key, setting in (("levels", levels), ("bins", bins)):
            for name, values in _by_input(setting):
                argument = key if name is None else f"{key}[{name!r}]"
                lines.next().write(f"  {key} ")
                if name is not None:
                    lines.name(name, argument).write(": ")
                if isinstance(values, str):
                    lines.raw(values, argument)
                    continue
                for i, value in enumerate(lines.several(values, argument, "a list of numbers")):
                    lines.write(" " if i else "").number(value, f"{argument}[{i}]")
        if rounding is not None:
            lines.next().write("  round ").number(rounding, "rounding")
        self._add(lines)

    def expect(self, text: str) -> None:
        """Demand a result at a point; :meth:`check` evaluates it.

        Parameters
        ----------
        text : str
            As in a file: ``"temp = 30 -> speed = 50 within 0.1"``.

        Raises
        ------
        RuleBaseError, BuilderArgumentError
            As :meth:`input`.
        """
        lines = LanguageLines("expect(").write("expect ")
        self._add(lines.raw(text, "text"))

    def add(self, text: str) -> None:
        """Add statements as written in a file, with their comments.

        Parameters
        ----------
        text : str
            One or more lines of the language.

        Raises
        ------
        RuleBaseError, BuilderArgumentError
            As :meth:`input`; nothing is added then.
        """
        lines = LanguageLines("add(")
        for i, line in enumerate(split_lines(lines.words(text, "text")), 1):
            (lines.next() if i > 1 else lines).write(line, f"line {i} of text")
        self._add(lines)

    # -- growth --

    def _add(self, lines: LanguageLines) -> None:
        """Read the lines of a call and add their statements, or raise their mistakes."""
        document = parse_statements(lines.text, self._line)
        scope = self._known()
        count = len(scope.diagnostics)
        diagnostics = list(document.diagnostics)
        if not diagnostics:
            for statement in document.statements:
                if _is_of_controller(statement.node):
                    message = "controllers are written as text: fuzzyarm.parse reads them"
                    diagnostics.append(Diagnostic("not-a-rule-base", message, statement.node.span))
                    break
                judge_statement(statement.node, scope)
            diagnostics += scope.diagnostics[count:]
        if any(finding.is_error for finding in diagnostics):
            self._scope = None  # it contains parts of the rejected lines
            raise RuleBaseError(self._in_call(lines, document, diagnostics))
        self._calls.append((self._line, lines))
        self._line += lines.count
        first, *rest = document.statements or (None,)
        if first is not None:
            before = (*self._ending, *first.trivia.before)
            last = self._statements[-1].node if self._statements else first.node
            if not before and lines.call != "add(" and _section(last) != _section(first.node):
                before = ("",)
            around = first.trivia._replace(before=before)
            self._statements += [first._replace(trivia=around), *rest]
            self._ending = ()
        self._ending += document.ending
        self._allowed |= document.allowed
        self._model = None

    def _known(self) -> Scope:
        """Return the declared names."""
        if self._scope is None:
            from fuzzyarm.language.declarations import Scope

            self._scope = Scope()
            for statement in self._statements:
                judge_statement(statement.node, self._scope)
        return self._scope

    def _in_call(
        self, lines: LanguageLines, document: Document, findings: Sequence[Diagnostic]
    ) -> list[Diagnostic]:
        """Return the mistakes in the lines of a call, by argument."""
        offset = 1 - self._line
        if document.diagnostics:
            # Notations of other programs are explained as in a file.
            repaired, _ = corrected_document(lines.text, parse_document(lines.text))
            findings, offset = repaired.diagnostics or findings, 0
        return [
            replace(diagnostic, argument=lines.argument_of(_moved(diagnostic.span, offset)))
            for diagnostic in findings
        ]

    def _names(self, role: str) -> list[str]:
        return self._known().names(role)

    def _terms_of(self, name: str) -> list[str]:
        draft = self._known().drafts.get(name)
        return [] if draft is None else list(draft.terms)

    # -- value --

    @property
    def name(self) -> str:
        """The name of the rule base."""
        for statement in self._statements:
            if isinstance(statement.node, Heading):
                return statement.node.name
        return "unnamed"

    @property
    def model(self) -> RuleBase:
        """The current rule base: the value of a file with the same text.

        Raises
        ------
        RuleBaseError
            If it is not complete (it has no rules, or no output).
        """
        if self._model is None:
            # Parsed from the text, so that a trace has the line numbers of `print`.
            parsed = parse(str(self), f"<{self.name}>", self._memory)
            if parsed.rulebase is None:
                raise RuleBaseError(self._review().diagnostics or parsed.diagnostics)
            self._model = parsed.rulebase
        return self._model

    def check(self) -> Review:
        """Return the findings of `fuzzyarm check`: mistakes, else doubts.

        Returns
        -------
        fuzzyarm.exchange.files.Review
            Each of its `diagnostics` names the call and the argument in question; ``print`` shows
            them. Never raises for mistakes.
        """
        return self._review()

    def _review(self) -> Review:
        document = Document(tuple(self._statements), self._ending, self._allowed)
        partial, findings = elaborate(document)
        text = "\n".join(lines.text for _, lines in self._calls) + "\n"
        review = check_parsed(Parsed(document, partial, tuple(findings)), text, f"<{self.name}>")
        return review._replace(diagnostics=tuple(map(self._with_argument, review.diagnostics)))

    def _with_argument(self, finding: Diagnostic) -> Diagnostic:
        if finding.name in _OF_THE_WHOLE:
            return replace(finding, argument=f"RuleBaseBuilder({shortened(repr(self.name))})")
        for first, lines in self._calls:
            if first <= finding.line < first + lines.count:
                return replace(finding, argument=lines.argument_of(_moved(finding.span, 1 - first)))
        return finding

    def __str__(self) -> str:
        """Return the current text of its file."""
        document = Document(tuple(self._statements), self._ending, self._allowed)
        return print_document(document)

    def __repr__(self) -> str:
        rules = any(isinstance(each.node, (RuleNode, GridNode)) for each in self._statements)
        if not rules or self._names("output") == []:
            count = len(self._statements)
            return one_line(self, f"{shortened(self.name)}: {count} statements, no rules yet")
        return one_line(self, outline(self.model))

    def __reduce__(self) -> tuple[Any, tuple[str]]:
        return type(self).from_text, (str(self),)


_SECTIONS = (
    (Heading,),
    (VariableNode, TermNode, EvenTermsNode),
    (InferenceNode,),
    (RuleNode, GridNode, BlockNode),
    (LookupNode,),
    (ExpectNode, ProveNode),
)
"""Statements of a group, which a file does not separate by blank lines."""


def _section(node: StatementNode) -> int:
    if isinstance(node, InferenceNode) and node.target is not None:
        return 1  # it goes with its variable
    return next((i for i, kinds in enumerate(_SECTIONS) if isinstance(node, kinds)), -1)


def _moved(span: Span, lines: int) -> Span:
    """Return a span moved down by some lines."""
    return span._replace(line=span.line + lines, end_line=span.end_line + lines)


def _is_of_controller(node: StatementNode) -> bool:
    return any(isinstance(node, record.node) for record in CONTROLLER_STATEMENTS.values())


def _by_input(
    levels: Levels | Mapping[str, Levels] | None,
) -> list[tuple[str | None, Levels]]:
    if levels is None:
        return []
    return list(levels.items()) if isinstance(levels, Mapping) else [(None, levels)]


class VariableBuilder(Plotted):
    """An input or output of a rule base under construction.

    Attributes
    ----------
    name : str
        Its name.
    """

    def __init__(self, rulebase: RuleBaseBuilder, name: str) -> None:
        self._rulebase = rulebase
        self.name = name

    def term(self, name: str, shape: Corners) -> None:
        """Add a term; as :meth:`RuleBaseBuilder.term`.

        Parameters
        ----------
        name : str
            Name of the term.
        shape : float, sequence, Shape or str
            As in the mapping of :meth:`RuleBaseBuilder.input`.
        """
        self._rulebase.term(self.name, name, shape)

    @property
    def model(self) -> Input | Output:
        """The current variable as a value."""
        document = Document(tuple(self._rulebase._statements))
        return elaborate(document)[0].variable(self.name)

    def __repr__(self) -> str:
        return repr(self.model)


def _name_of(variable: str | VariableBuilder | None) -> Any:
    """Return the name of a variable, given in any form."""
    return variable.name if isinstance(variable, VariableBuilder) else variable
