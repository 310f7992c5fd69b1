"""Findings about the names of a controller, in one walk over the mentions of its lines.

A row says which words declare a name and which refer to one (`mentions`); declared twice, unknown,
read too early, and unused follow from that for any statement.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile

from fuzzyarm.base.diagnostic import Related, Severity, Span, Word, span_of
from fuzzyarm.language.declarations import Scope
from fuzzyarm.language.document import Statement
from fuzzyarm.language.model.controller import (
    Axes,
    Drive,
    GainModel,
    Line,
    Partner,
    SignalLine,
    Use,
)
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.language.phrases import NameKind, Occurrence
from fuzzyarm.language.rows import mentions
from fuzzyarm.language.statements import Broken, ControllerHeading, StatementNode
from fuzzyarm.language.tokens import name_text

Names = dict[str, Span]
"""Names of one sort, with the position of their first declaration."""

_SHEETS, _NUMBERS = "rule base or table", "gain or partner"


class ControllerNames:
    """The names of a controller, judged; unused ones only if all lines are `complete`.

    `sheet` is the rule base in the same file; `turned` has the drives that name their signal before
    their port.
    """

    def __init__(
        self,
        statements: Sequence[Statement],
        sheet: RuleBase | None,
        scope: Scope,
        *,
        complete: bool,
    ) -> None:
        self.scope, self.complete = scope, complete
        self.turned: list[Drive] = []
        self.sheets: Names = {}
        self.numbers: Names = {}
        self.axes: Names = {}
        self.signals: Names = {}  # of the axes at hand
        self.later: Names = {}  # signals defined further below
        self.above: dict[str, Names] = {}  # signals of the axes above
        self.read: set[tuple[str, str]] = set()
        self.read_elsewhere: set[tuple[str, str]] = set()  # of axes and signals
        nodes = [statement.node for statement in statements]
        if sheet is not None:
            heading = next(node for node in nodes if isinstance(node, ControllerHeading))
            self.sheets[sheet.name] = heading.name.span
            self.read.add((_SHEETS, sheet.name))
        self._walk(statements, nodes)

    def _walk(self, statements: Sequence[Statement], nodes: Sequence[StatementNode]) -> None:
        for node in nodes:
            names = self.numbers if isinstance(node, GainModel | Partner) else self.sheets
            for name in mentions(node) if isinstance(node, GainModel | Partner | Use) else ():
                self._declare(name, names)
        over: list[tuple[list[str], Names]] = []  # axes with their unused names
        axes: list[str] = []

        def close() -> None:
            unread = {name: span for name, span in self.signals.items()
                      if ("signal", name) not in self.read}  # fmt: skip
            over.append((axes, unread))
            self.above |= dict.fromkeys(axes, self.signals)
            self.read = {(sort, name) for sort, name in self.read if sort != "signal"}

        for index, (node, _, in_hole) in enumerate(statements):
            if isinstance(node, Axes):
                close()
                # Lines above the first axis are reported as such: their names belong to it.
                self.signals = {} if axes else self.signals
                self.later = _signals_behind(nodes[index + 1 :])
                axes = list(node.names)
                for name in mentions(node):
                    self._declare(name, self.axes)
            elif isinstance(node, Line | Broken):
                self._judge_line(node, in_hole)
        close()
        for axes, unread in over[1:]:
            elsewhere = {name for axis, name in self.read_elsewhere if axis in axes}
            unused = {name: span for name, span in unread.items() if name not in elsewhere}
            self._judge_unused("signal", unused, "unused-signal")
        self._judge_unused(_NUMBERS, self.numbers, "unused-name")
        self._judge_unused(_SHEETS, self.sheets, "unused-name")

    def _judge_line(self, node: StatementNode, in_hole: Sequence[Occurrence]) -> None:
        if isinstance(node, Drive) and self._is_turned(node):
            self.turned.append(node)
            return
        names = [
            name
            for name in (*mentions(node), *in_hole)
            if name.kind in (NameKind.SIGNAL, NameKind.USE)
        ]
        for name in names:
            if name.owners:
                self._need_of(name.owners[0], name)
            elif not name.is_definition:
                self._need(name)
        for name in names:
            if name.is_definition and name.kind is NameKind.SIGNAL:
                if name.name in self.numbers:
                    self.scope.report(
                        "duplicate-name",
                        f"'{name.name}' is a gain or a partner already",
                        name.span,
                        related=(Related("declared here", self.numbers[name.name]),),
                    )
                self._declare(name, self.signals)

    def _declare(self, name: Occurrence, names: Names) -> None:
        if name.name in names:
            self.scope.report(
                "duplicate-name",
                f"'{name.name}' is declared twice",
                name.span,
                hint="a name means one thing: take another for this one",
                related=(Related("first here", names[name.name]),),
            )
        names.setdefault(name.name, name.span)

    def _need(self, name: Occurrence) -> None:
        """Demand the name of a rule base, of a gain, or of a signal made above or a gain."""
        word, quoted = name.name, name_text(name.name)
        if name.kind is NameKind.USE:
            self.read.add((_SHEETS, word))
            new = f'a file is named by  use {quoted} from "{word}.frb"'
            if word not in self.sheets:
                self.scope.unknown("unknown-use", _SHEETS, word, name.span, self.sheets, new)
            return
        self.read |= {(_NUMBERS, word)} if name.is_gain else {(_NUMBERS, word), ("signal", word)}
        if word in self.numbers or (word in self.signals and not name.is_gain):
            return
        if name.is_gain:
            self.scope.unknown("unknown-signal", "gain", word, name.span, self.numbers)
        elif word in self.later:
            self.scope.report(
                "signal-before-made",
                f"'{word}' is read here, but made below",
                name.span,
                hint="a signal is made above the lines that read it",
                related=(Related("made here", self.later[word]),),
            )
        else:
            new = f"a number is  gain {quoted} = 1 , a value of the plant  measured {quoted}"
            known = [*self.signals, *self.numbers]
            self.scope.unknown("unknown-signal", "signal or gain", word, name.span, known, new)

    def _need_of(self, axis: str, name: Occurrence) -> None:
        """Demand a signal of an axis further up."""
        word = name.name
        self.read_elsewhere.add((axis, word))
        if axis in self.above:
            if word not in self.above[axis]:
                what, known = f"signal of the axis '{axis}'", self.above[axis]
                self.scope.unknown("unknown-signal", what, word, name.span, known)
                self.complete = False  # the intended signal has a reader
        elif axis in self.axes:
            message = f"the axis '{axis}' is not above this line"
            hint = "a signal of the axis at hand is written without its axis"
            self.scope.report("signal-before-made", message, name.span, hint=hint)
        else:
            new = f"an outer axis comes first:  axis {name_text(axis)}"
            self.scope.unknown("unknown-signal", "axis above", axis, name.span, self.above, new)
            self.complete = False

    def _is_turned(self, node: Drive) -> bool:
        """Report a drive that names its signal before its port."""
        factors = [factor.value for product in node.products for factor in product.factors]
        port = factors[0] if factors else None
        if node.port not in self.signals or len(factors) != 1 or not isinstance(port, Word):
            return False
        if port in self.signals or port in self.numbers:
            return False
        self.read.add(("signal", node.port))
        right = f"{name_text(port)} = {name_text(node.port)}"
        self.scope.report(
            "unknown-signal",
            f"write the port before '='; no signal is called '{port}'",
            span_of(node.port).to(span_of(port)),
            hint=f"write  drive {right}",
            replacement=right,
        )
        return True

    def _judge_unused(self, sort: str, names: Names, finding: str) -> None:
        for name, span in names.items() if self.complete else ():
            if (sort, name) not in self.read:
                words = f"nothing reads the {sort} '{name}'"
                self.scope.report(finding, words, span, severity=Severity.WARNING)


def _signals_behind(nodes: Sequence[StatementNode]) -> Names:
    """Return the signals defined before the next axis."""
    spans: Names = {}
    for node in takewhile(lambda node: not isinstance(node, Axes), nodes):
        for word in node.names if isinstance(node, SignalLine) else ():
            spans.setdefault(word, span_of(word))
    return spans
