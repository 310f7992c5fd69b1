"""Turn the statements of a controller into a ControllerModel, as far as they are sound."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from contextlib import suppress

from fuzzyarm.expression.sources import Setting, SourceKind
from fuzzyarm.language.controller_doubts import doubts_of_lines
from fuzzyarm.language.controllers import (
    AxisNode,
    ControllerHeading,
    DriveNode,
    GainNode,
    LearnNode,
    PartnerNode,
    PeriodNode,
    SetPointNode,
    SignalNode,
    UseNode,
    ZoomNode,
)
from fuzzyarm.language.declarations import Scope
from fuzzyarm.language.loop_claims import LoopClaimNode
from fuzzyarm.language.signals import AmountNode, OptionNode, ProductNode
from fuzzyarm.language.statements import Broken, StatementNode
from fuzzyarm.language.tokens import Figure, Word, name_text
from fuzzyarm.model.claims import LoopClaim
from fuzzyarm.model.controller import (
    SOURCES,
    Amount,
    Axes,
    ControllerModel,
    Drive,
    Factor,
    GainModel,
    Learn,
    Line,
    Partner,
    Product,
    Signal,
    Source,
    Tune,
    Use,
    Zoom,
)
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.text.diagnostic import Diagnostic, Related, Severity, Span
from fuzzyarm.text.names import near_hint

__all__ = ["elaborate_controller"]

MAX_DELAY = 1000
MAX_EVERY = 100_000


def elaborate_controller(
    nodes: Sequence[StatementNode], rulebase: RuleBase | None
) -> tuple[ControllerModel, list[Diagnostic]]:
    """Return the controller that statements mean, and what is wrong with it.

    Parameters
    ----------
    nodes : sequence of StatementNode
        Of a file with a line ``controller``, those of a rule base among them.
    rulebase : RuleBase or None
        The one that stands in the same file.
    """
    return _Reader(nodes, rulebase).controller()


class _Reader:
    """Names in scope, and the findings so far."""

    def __init__(self, nodes: Sequence[StatementNode], rulebase: RuleBase | None) -> None:
        self.nodes = nodes
        self.rulebase = rulebase
        self.scope = Scope()
        self.broken = {node.keyword for node in nodes if isinstance(node, Broken)}
        # What a line would have read that could not be read itself.
        self.unread = any(map(_is_unread, nodes))
        self.numbers: dict[str, Word] = {}  # gains and partners
        self.sheets: dict[str, Word] = {}
        self.used: set[str] = set()
        self.read: set[str] = set()  # signals, on the axis at hand
        self.axes: dict[str, Word] = {}

        self.later: dict[str, Span] = {}

    def controller(self) -> tuple[ControllerModel, list[Diagnostic]]:
        """Read everything."""
        heading = next(node for node in self.nodes if isinstance(node, ControllerHeading))
        self._report_repeated(ControllerHeading, "controller line")
        own = () if self.rulebase is None else (self.rulebase,)
        for each in own:
            self.sheets[each.name] = Word(each.name, heading.name.span)
            self.used.add(each.name)
        uses = tuple(self._use(node) for node in self.nodes if isinstance(node, UseNode))
        self._declare_gains()
        axes = self._axes()
        count = max(1, sum(len(each.names) for each in axes))
        gains = [self._gain(node, count) for node in self.nodes if isinstance(node, GainNode)]
        partners = [
            Partner(
                node.name.text,
                node.law.text,
                tuple((word.text, figure.value) for word, figure in node.gains),
                node.span,
            )
            for node in self.nodes
            if isinstance(node, PartnerNode)
        ]
        self._judge_files(uses, count)
        self._judge_unused()
        model = ControllerModel(
            heading.name.text,
            self._period(heading),
            tuple(axes),
            tuple(gain for gain in gains if gain is not None),
            uses,
            tuple(partners),
            self._every(),
            heading.description or "",
            own,
            self._claims(),
        )
        self._judge_whole(heading, axes)
        if (
            not self.broken and not self.unread
        ):  # a line that could not be read may be what is missed
            self.scope.diagnostics += doubts_of_lines(model)
        return model, self.scope.diagnostics

    # --- Head ---

    def _report_repeated(self, kind: type, what: str) -> None:
        found = [node for node in self.nodes if isinstance(node, kind)]
        for extra in found[1:]:
            self.scope.report(
                "duplicate-statement",
                f"a controller has only one {what}",
                extra.span,
                related=(Related("first here", found[0].span),),
            )

    def _period(self, heading: ControllerHeading) -> float:
        self._report_repeated(PeriodNode, "period")
        node = next((node for node in self.nodes if isinstance(node, PeriodNode)), None)
        if node is None:
            if "period" not in self.broken:
                self.scope.report(
                    "missing-period",
                    "the controller does not say how often it runs",
                    heading.span,
                    hint="add a line like  period 1 ms",
                )
            return math.nan
        if not 0.0 < node.time.seconds <= 3600.0:
            self.scope.report(
                "bad-period",
                f"a period of {node.time} is out of range",
                node.time.figure.span,
                hint="above 0 and at most 1 h",
            )
        return node.time.seconds

    def _every(self) -> int:
        self._report_repeated(SetPointNode, "set-point line")
        node = next((node for node in self.nodes if isinstance(node, SetPointNode)), None)
        if node is None:
            return 1
        value = node.every.value
        if value != int(value) or not 1 <= value <= MAX_EVERY:
            self.scope.report(
                "bad-set-point",
                f"a set point must last a whole number of periods, not {node.every}",
                node.every.span,
            )
            return 1
        return int(value)

    def _claims(self) -> tuple[LoopClaim, ...]:
        found = []
        for node in self.nodes:
            if not isinstance(node, LoopClaimNode):
                continue
            for stretch in node.stretches:
                if stretch.low.value > stretch.high.value:
                    self._turned(
                        f"the interval of '{stretch.name.text}'", stretch.low, stretch.high
                    )
            self._judge_names_of(node)
            claim = node.claim
            if claim.begin > claim.end:
                message = f"the time ends at {claim.end:g} s, before it begins at {claim.begin:g} s"
                self.scope.report("bad-range", message, node.span)
            found.append(claim)
        return tuple(found)

    def _judge_names_of(self, node: LoopClaimNode) -> None:
        for group in (
            [stretch.name for stretch in node.parameters],
            [stretch.name for stretch in node.start],
            [port for port, _ in node.at],
        ):
            for k, word in enumerate(group):
                if word.text in (each.text for each in group[:k]):
                    message = f"'{word.text}' stands twice in the claim"
                    self.scope.report("duplicate-name", message, word.span)

    def _use(self, node: UseNode) -> Use:
        self._declare(node.name, self.sheets)
        return Use(node.name.text, tuple(word.text for word in node.files), node.span)

    def _declare(self, word: Word, names: dict[str, Word]) -> None:
        if word.text in names:
            self.scope.report(
                "duplicate-name",
                f"'{word.text}' is declared twice",
                word.span,
                hint="a name means one thing: take another for this one",
                related=(Related("first here", names[word.text].span),),
            )
        names.setdefault(word.text, word)

    def _declare_gains(self) -> None:
        for node in self.nodes:
            if isinstance(node, GainNode | PartnerNode):
                self._declare(node.name, self.numbers)

    def _gain(self, node: GainNode, count: int) -> GainModel | None:
        if not node.values:  # the fault has been told
            return None
        values = tuple(map(_amount_of, node.values))
        try:
            numbers = [value.value(math.pi) for value in values]
        except ZeroDivisionError:
            self.scope.report("bad-number", "a gain divided by zero", node.values[0].span)
            return None
        if len(values) not in (1, count):
            self.scope.report(
                "wrong-count",
                f"gain {node.name.text} has {len(values)} values, the controller {_axes(count)}",
                node.values[-1].span,
                hint=_values_hint(node),
            )
            return None
        tune = None
        if node.low is not None and node.high is not None:
            tune = Tune(node.low.value, node.high.value, node.log)
            if not tune.low < tune.high:
                self._turned("the range of tune", node.low, node.high)
            elif tune.log and tune.low <= 0.0:
                message = "a logarithmic range must begin above 0"
                self.scope.report("bad-range", message, node.low.span.to(node.high.span))
            elif not all(tune.low <= number <= tune.high for number in numbers):
                self.scope.report(
                    "outside-tune",
                    f"gain {node.name.text} = {numbers[0]:g} lies outside what tune allows,"
                    f" {tune.low:g} .. {tune.high:g}",
                    node.values[0].span,
                    severity=Severity.WARNING,
                )
        return GainModel(node.name.text, values, node.unit or "", tune, node.span)

    # --- Axes ---

    def _axes(self) -> list[Axes]:
        found: list[Axes] = []
        lines: list[Line] = []
        signals: dict[str, Word] = {}
        current: AxisNode | None = None

        def close() -> None:
            if current is not None:
                names = tuple(word.text for word in current.names)
                found.append(Axes(names, tuple(lines), current.span))
                self._judge_signals(signals)

        for index, node in enumerate(self.nodes):
            if isinstance(node, AxisNode):
                close()
                current, lines, signals = node, [], {}
                self.read = set()
                for word in node.names:
                    self._declare(word, self.axes)
                self.later = _signals_behind(self.nodes[index + 1 :])
            elif isinstance(node, SignalNode):
                lines += self._signal(node, signals)
            elif isinstance(node, ZoomNode):
                lines.append(self._zoom(node, signals))
            elif isinstance(node, LearnNode):
                lines.append(self._learn(node, signals))
            elif isinstance(node, DriveNode):
                lines.append(self._drive(node, signals))
        close()
        return found

    def _signal(self, node: SignalNode, signals: dict[str, Word]) -> list[Line]:
        products = self._products(node.products, signals)
        source = None
        if node.source is not None:
            kind = node.source.kind.text
            of = SOURCES[kind].of
            name = node.source.name
            inputs: tuple[str, ...] = ()
            if of == "signal":
                self._need(name, signals)
            elif of == "call":
                self._need_sheet(name)
                inputs = self._inputs(node.source.call.inputs if node.source.call else (), signals)
            options = tuple(self._option(option) for option in node.options)
            self._judge_options(node.options)
            self._judge_source(SOURCES[kind], node)
            source = Source(kind, name.text, inputs, options)
        if len(node.names) > 1 and (source is None or source.kind != "rules"):
            self.scope.report(
                "several-signals",
                "only rules give several signals at once",
                node.names[0].span.to(node.names[-1].span),
            )
        for word in node.names:
            if word.text in self.numbers:
                self.scope.report(
                    "duplicate-name",
                    f"'{word.text}' is a gain or a partner already",
                    word.span,
                    related=(Related("declared here", self.numbers[word.text].span),),
                )
            self._declare(word, signals)
        return [Signal(tuple(word.text for word in node.names), source, products, node.span)]

    def _products(
        self, nodes: Sequence[ProductNode], signals: dict[str, Word]
    ) -> tuple[Product, ...]:
        products = []
        for node in nodes:
            factors = []
            for each in node.factors:
                if isinstance(each.value, Figure):
                    factors.append(Factor(each.value.value, each.divides))
                    if each.divides and each.value.value == 0.0:
                        self.scope.report("bad-number", "a division by zero", each.value.span)
                else:
                    self._need(each.value, signals)
                    factors.append(Factor(each.value.text, each.divides))
            products.append(Product(tuple(factors), node.negative))
        return tuple(products)

    def _need(self, word: Word, signals: dict[str, Word]) -> None:
        """Demand a signal that has been made, a gain or a partner."""
        self.read.add(word.text)
        self.used.add(word.text)
        if word.text in signals or word.text in self.numbers:
            return
        if word.text in self.later:
            self.scope.report(
                "signal-before-made",
                f"'{word.text}' is read here, but made below",
                word.span,
                hint="a signal is made above the lines that read it",
                related=(Related("made here", self.later[word.text]),),
            )
            return
        written = name_text(word.text)
        new = f"a number is  gain {written} = 1 , a value of the plant  measured {written}"
        self._unknown("unknown-signal", "signal or gain", word, [*signals, *self.numbers], new)

    def _unknown(
        self, name: str, what: str, word: Word, choices: Collection[str], new: str = ""
    ) -> None:
        """Report a name that nothing has; `new` says how it would be made."""
        hint, replacement = near_hint(word.text, choices)
        if not hint:
            there = "there are " + ", ".join(list(choices)[:10]) if choices else ""
            hint = "; ".join(filter(None, (there, new)))
        self.scope.report(
            name,
            f"no {what} is called '{word.text}'",
            word.span,
            hint=hint,
            replacement=None if replacement is None else name_text(replacement),
        )

    def _need_sheet(self, word: Word) -> None:
        self.used.add(word.text)
        if word.text not in self.sheets:
            written = name_text(word.text)
            new = f'a file is named by  use {written} from "{word.text}.frb"'
            self._unknown("unknown-use", "rule base or table", word, list(self.sheets), new)

    def _inputs(self, words: Sequence[Word], signals: dict[str, Word]) -> tuple[str, ...]:
        for word in words:
            self._need(word, signals)
        return tuple(word.text for word in words)

    def _option(self, node: OptionNode) -> tuple[str, Setting]:
        word = node.word.text
        if isinstance(node.value, Figure) and node.high is not None:
            low, high = node.value.value, node.high.value
            if not low < high:
                self._turned("limits", node.value, node.high)
            return word, (low, high)
        if isinstance(node.value, Figure):
            return word, node.value.value
        if isinstance(node.value, Word):
            self._need_gain(node.value)
            return word, node.value.text
        if node.value is not None:
            if not node.value.seconds > 0.0:
                span = node.value.figure.span
                self.scope.report("bad-time", f"the time of {word} must be above 0", span)
            return word, node.value.seconds
        return word, "hold" if node.rest == ("hold",) else True

    def _turned(self, what: str, low: Figure, high: Figure) -> None:
        """Report a range that does not go up; where it goes down, with both ends changed."""
        verb = "must go from a lower to a higher number"
        right = f"{high} .. {low}" if high.value < low.value else None
        self.scope.report(
            "bad-range",
            f"{what} {verb}",
            low.span.to(high.span),
            hint="" if right is None else f"write  {right}",
            replacement=right,
        )

    def _need_gain(self, word: Word) -> None:
        self.used.add(word.text)
        if word.text not in self.numbers:
            self._unknown("unknown-signal", "gain", word, list(self.numbers))

    def _judge_options(self, options: Sequence[OptionNode]) -> None:
        seen: dict[str, Span] = {}
        for option in options:
            if option.word.text in seen:
                self.scope.report(
                    "duplicate-setting", f"'{option.word.text}' is set twice", option.word.span
                )
            seen[option.word.text] = option.word.span

    def _judge_source(self, kind: SourceKind, node: SignalNode) -> None:
        """Report what a source needs, and numbers that it cannot have."""
        given = {option.word.text: option for option in node.options}
        for word, option in kind.options.items():
            if option.needed and word not in given:
                self.scope.report(
                    "incomplete-statement",
                    f"the {word} of {kind.name} is missing",
                    node.span,
                    hint=f"add  , {word} {option.example}",
                )
            value = given[word].value if word in given else None
            if not option.positive or not isinstance(value, Figure | Word):
                continue
            for number in self._numbers_of(value):
                if not number > 0.0:
                    message = f"the {word} of {kind.name} must be above 0, not {number:g}"
                    self.scope.report("bad-number", message, value.span)

    def _numbers_of(self, value: Figure | Word) -> list[float]:
        """Return a number, or those of a gain, as far as they are known."""
        if isinstance(value, Figure):
            return [value.value]
        for node in self.nodes:
            if isinstance(node, GainNode) and node.name.text == value.text:
                with suppress(ZeroDivisionError):  # which is reported where the gain stands
                    return [amount.value(math.pi) for amount in map(_amount_of, node.values)]
        return []

    def _amount(self, value: Figure | Word) -> str | float:
        if isinstance(value, Figure):
            return value.value
        self._need_gain(value)
        return value.text

    def _zoom(self, node: ZoomNode, signals: dict[str, Word]) -> Zoom:
        names = self._inputs(node.signals, signals)
        by, inside = self._amount(node.by), self._amount(node.inside)
        for value, span in ((by, node.by.span), (inside, node.inside.span)):
            if isinstance(value, float) and not value > 0.0:
                self.scope.report("bad-number", "expected a number above 0", span)
        return Zoom(names, by, inside, node.wait, node.span)

    def _learn(self, node: LearnNode, signals: dict[str, Word]) -> Learn:
        self._need_sheet(node.table)
        self._need_sheet(node.judge)
        self._judge_options(node.options)
        inputs = self._inputs(node.call.inputs, signals)
        given: dict[str, str | float] = {}
        for option in node.options:
            if isinstance(option.value, Figure | Word):
                given[option.word.text] = self._amount(option.value)
        delay = given.get("delay", 1.0)
        if isinstance(delay, str) or delay != int(delay) or not 0 <= delay <= MAX_DELAY:
            self.scope.report(
                "bad-delay",
                f"a delay of {delay} periods is out of range",
                node.span,
                hint=f"a whole number from 0 to {MAX_DELAY}",
            )
            delay = 1.0
        return Learn(
            node.table.text,
            node.judge.text,
            inputs,
            int(delay),
            given.get("rate", 1.0),
            given.get("bound", 6.0),
            node.span,
        )

    def _drive(self, node: DriveNode, signals: dict[str, Word]) -> Drive:
        within = None
        if node.low is not None and node.high is not None:
            within = (node.low.value, node.high.value)
            if not within[0] < within[1]:
                self._turned("limits", node.low, node.high)
        if node.slew is not None and not node.slew.value > 0.0:
            self.scope.report("bad-number", "expected a number above 0", node.slew.span)
        if node.port.text in signals and self._is_turned(node, signals):
            return Drive(node.port.text, (), within, None, node.span)
        slew = node.slew.value if node.slew is not None else None
        return Drive(
            node.port.text, self._products(node.products, signals), within, slew, node.span
        )

    def _is_turned(self, node: DriveNode, signals: dict[str, Word]) -> bool:
        """Report a drive that names its signal before its port."""
        factors = [factor.value for product in node.products for factor in product.factors]
        port = factors[0]
        if len(factors) > 1 or not isinstance(port, Word):
            return False
        if port.text in signals or port.text in self.numbers:
            return False
        self.read.add(node.port.text)
        span = node.port.span.to(port.span)
        right = f"{port} = {node.port}"
        self.scope.report(
            "unknown-signal",
            f"the port stands before '=', and no signal is called '{port.text}'",
            span,
            hint=f"write  drive {right}",
            replacement=right,
        )
        return True

    # --- The whole ---

    def _judge_files(self, uses: Sequence[Use], count: int) -> None:
        for use in uses:
            if use.files and len(use.files) not in (1, count):
                self.scope.report(
                    "wrong-count",
                    f"'{use.name}' names {len(use.files)} files, the controller has {_axes(count)}",
                    use.span,
                    hint="one file for all axes, or one for each",
                )

    def _judge_signals(self, signals: dict[str, Word]) -> None:
        for name, word in signals.items():
            if name not in self.read and not self.broken and not self.unread:
                self.scope.report(
                    "unused-signal",
                    f"nothing reads the signal '{name}'",
                    word.span,
                    severity=Severity.WARNING,
                )

    def _judge_unused(self) -> None:
        if self.broken or self.unread:
            return  # what reads it may be what could not be read
        for what, words in (("gain or partner", self.numbers), ("rule base or table", self.sheets)):
            for name, word in words.items():
                if name not in self.used:
                    self.scope.report(
                        "unused-name",
                        f"nothing reads the {what} '{name}'",
                        word.span,
                        severity=Severity.WARNING,
                    )

    def _judge_whole(self, heading: ControllerHeading, axes: Sequence[Axes]) -> None:
        if not axes:
            if "axis" not in self.broken:
                self.scope.report(
                    "no-axes",
                    "the controller has no axis",
                    heading.span,
                    hint="add a line like  axis joint1, joint2  and signals below it",
                )
            return
        for each in axes:
            driven = any(isinstance(line, Drive) for line in each.lines)
            if not driven and "drive" not in self.broken:
                self.scope.report(
                    "no-drives",
                    f"axis {', '.join(each.names)} drives nothing",
                    each.span,
                    hint=f"add a line like  drive {_drive_for(each)}",
                )


def _amount_of(node: AmountNode) -> Amount:
    return Amount(tuple((f.value if f else None, divides) for f, divides in node.factors))


def _drive_for(axes: Axes) -> str:
    """Return what would drive the plant: the last signal, which may have the name of its port."""
    made = [line for line in axes.lines if isinstance(line, Signal)]
    if not made:
        return "voltage = u"
    last = made[-1]
    if last.source is None and len(last.products) == 1 and len(last.products[0].factors) == 1:
        value = last.products[0].factors[0].value
        if isinstance(value, str):
            return f"{name_text(last.names[0])} = {name_text(value)}"
    return f"voltage = {name_text(last.names[0])}"


def _is_unread(node: StatementNode) -> bool:
    """Whether of a statement only the name could be read."""
    if isinstance(node, SignalNode):
        return node.source is None and not node.products
    if isinstance(node, GainNode):
        return not node.values
    return isinstance(node, UseNode) and not node.files


def _axes(count: int) -> str:
    return "1 axis" if count == 1 else f"{count} axes"


def _values_hint(node: GainNode) -> str:
    """Say what values a gain takes; of two numbers that may be one with a comma, that one."""
    if len(node.values) == 2:
        first, second = (str(value) for value in node.values)
        if first.lstrip("-").isdigit() and second.isdigit():
            return f"{_ONE_OR_EACH}; a decimal mark is a point: {first}.{second}"
    return _ONE_OR_EACH


_ONE_OR_EACH = "one value for all axes, or one for each"


def _signals_behind(nodes: Sequence[StatementNode]) -> dict[str, Span]:
    """Return the signals that are made before the next axis."""
    found: dict[str, Span] = {}
    for node in nodes:
        if isinstance(node, AxisNode):
            break
        if isinstance(node, SignalNode):
            for word in node.names:
                found.setdefault(word.text, word.span)
    return found
