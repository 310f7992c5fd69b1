"""Turn the statements of a controller into a ControllerModel, as far as they are sound."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

from fuzzyarm.base.diagnostic import Diagnostic, Figure, Related, Severity, Span, Word, span_of
from fuzzyarm.base.numbers import fraction_of_periods, is_whole, number_text, whole_periods
from fuzzyarm.language.controller_doubts import doubts_of_lines
from fuzzyarm.language.controller_names import ControllerNames
from fuzzyarm.language.controllers import PeriodNode, SetPointNode
from fuzzyarm.language.declarations import Scope
from fuzzyarm.language.document import Statement
from fuzzyarm.language.loop_claims import LoopClaimNode
from fuzzyarm.language.model.claims import LoopClaim, reference_fault
from fuzzyarm.language.model.controller import (
    Axes,
    ControllerModel,
    Drive,
    GainModel,
    Learn,
    Line,
    Partner,
    Product,
    SignalLine,
    Source,
    Time,
    Use,
    Zoom,
)
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.language.signals import amount_text, time_text
from fuzzyarm.language.statements import Broken, ControllerHeading, StatementNode
from fuzzyarm.language.tokens import name_text
from fuzzyarm.symbolic.sources import MOST_PERIODS, Setting

MAX_DELAY = 1000
MAX_EVERY = 100_000


def elaborate_controller(
    statements: Sequence[Statement], rulebase: RuleBase | None
) -> tuple[ControllerModel, list[Diagnostic]]:
    """Return the model of a controller from its statements, with the findings.

    Parameters
    ----------
    statements : sequence of Statement
        Statements of a file with a line ``controller``, including those of a rule base.
    rulebase : RuleBase or None
        The rule base in the same file.
    """
    return _Scope(statements, rulebase).controller()


class _Scope:
    """Names in scope, and the findings so far."""

    def __init__(self, statements: Sequence[Statement], rulebase: RuleBase | None) -> None:
        self.statements = statements
        self.nodes = nodes = [statement.node for statement in statements]
        self.rulebase = rulebase
        self.scope = Scope()
        self.broken = {node.keyword for node in nodes if isinstance(node, Broken)}
        # Whether unreadable lines may define the missing names.
        self.unread = any(map(_is_unread, nodes))
        self.turned: list[Drive] = []
        self.complete = True

    def controller(self) -> tuple[ControllerModel, list[Diagnostic]]:
        """Read everything."""
        heading = next(node for node in self.nodes if isinstance(node, ControllerHeading))
        self._report_repeated(ControllerHeading, "controller line")
        rulebases = () if self.rulebase is None else (self.rulebase,)
        uses = tuple(node for node in self.nodes if isinstance(node, Use))
        complete = not self.broken and not self.unread  # an unreadable line may use a name
        names = ControllerNames(self.statements, self.rulebase, self.scope, complete=complete)
        self.turned, self.complete = names.turned, names.complete
        axes = self._axes()
        count = max(1, sum(len(axis.names) for axis in axes))
        gains = [self._gain(node, count) for node in self.nodes if isinstance(node, GainModel)]
        partners = tuple(node for node in self.nodes if isinstance(node, Partner))
        self._judge_files(uses, count)
        model = ControllerModel(
            heading.name,
            self._period(heading),
            tuple(axes),
            tuple(gain for gain in gains if gain is not None),
            uses,
            partners,
            self._every(),
            heading.description or "",
            rulebases,
            self._claims(),
        )
        self._judge_whole(heading, model)
        if self.complete:
            self.scope.diagnostics += doubts_of_lines(model)
        return model, self.scope.diagnostics

    # --- Head ---

    def _report_repeated(self, kind: type, what: str) -> None:
        nodes = [node for node in self.nodes if isinstance(node, kind)]
        for extra in nodes[1:]:
            self.scope.report(
                "duplicate-statement",
                f"a controller has only one {what}",
                extra.span,
                related=(Related("first here", nodes[0].span),),
            )

    def _period(self, heading: ControllerHeading) -> float:
        self._report_repeated(PeriodNode, "period")
        node = next((node for node in self.nodes if isinstance(node, PeriodNode)), None)
        if node is None:
            if "period" not in self.broken:
                self.scope.report(
                    "missing-period",
                    "the controller has no control period",
                    heading.span,
                    hint="add a line like  period 1 ms",
                )
            return math.nan
        if not 0.0 < node.time <= 3600.0:
            self.scope.report(
                "bad-period",
                f"a period of {time_text(node.time)} is out of range",
                node.time.figure.span,
                hint="above 0 and at most 1 h",
            )
        return node.time

    def _every(self) -> int:
        self._report_repeated(SetPointNode, "set-point line")
        node = next((node for node in self.nodes if isinstance(node, SetPointNode)), None)
        if node is None:
            return 1
        return self._whole(node.every, "a set point must last")

    def _whole(self, every: float, what: str) -> int:
        """Return a number of periods; 1 after a report."""
        if float(every).is_integer() and 1 <= every <= MAX_EVERY:
            return int(every)
        message = f"{what} a whole number of periods, not {number_text(every)}"
        hint = f"from 1 to {MAX_EVERY:,}"
        self.scope.report("bad-set-point", message, span_of(every), hint=hint)
        return 1

    def _claims(self) -> tuple[LoopClaim, ...]:
        claims = []
        for node in self.nodes:
            if not isinstance(node, LoopClaimNode):
                continue
            for stretch in node.stretches:
                if stretch.low > stretch.high:
                    self._turned(f"the interval of '{stretch.name}'", stretch.low, stretch.high)
            self._judge_names_of(node)
            claim = node.claim
            message, hint = reference_fault(claim)
            if message:
                self.scope.report("bad-reference", message, node.span, hint=hint)
            if claim.begin > claim.end:
                message = f"the time ends at {claim.end:g} s, before it begins at {claim.begin:g} s"
                self.scope.report("bad-range", message, node.span)
            claims.append(claim)
        return tuple(claims)

    def _judge_names_of(self, node: LoopClaimNode) -> None:
        for group in (
            [stretch.name for stretch in node.parameters],
            [stretch.name for stretch in node.start],
            [port for port, _ in node.at],
        ):
            for k, word in enumerate(group):
                if word in group[:k]:
                    message = f"'{word}' appears twice in the claim"
                    self.scope.report("duplicate-name", message, word.span)

    def _gain(self, node: GainModel, count: int) -> GainModel | None:
        if not node.values:  # already reported
            return None
        values, tune = node.values, node.tune
        try:
            numbers = [value.value(math.pi) for value in values]
        except ZeroDivisionError:
            self.scope.report("bad-number", "a gain divided by zero", node.values[0].span)
            return None
        if len(values) not in (1, count):
            self.scope.report(
                "wrong-count",
                f"gain {node.name} has {len(values)} values, the controller {_axes(count)}",
                node.values[-1].span,
                hint=_values_hint(node),
            )
            return None
        if tune is not None:
            if not tune.low < tune.high:
                self._turned("the range of tune", tune.low, tune.high)
            elif tune.log and tune.low <= 0.0:
                message = "a logarithmic range must begin above 0"
                self.scope.report("bad-range", message, span_of(tune.low).to(span_of(tune.high)))
            elif not all(tune.low <= number <= tune.high for number in numbers):
                self.scope.report(
                    "outside-tune",
                    f"gain {node.name} = {numbers[0]:g} lies outside what tune allows,"
                    f" {tune.low:g} .. {tune.high:g}",
                    node.values[0].span,
                    severity=Severity.WARNING,
                )
        return node

    # --- Axes ---

    def _axes(self) -> list[Axes]:
        axes_read: list[Axes] = []
        lines: list[Line] = []
        current: Axes | None = None

        def close() -> None:
            if current is not None:
                every = self._whole(current.every, "from one run of an axis to the next it must be")
                axes_read.append(replace(current, lines=tuple(lines), every=every))
                self._judge_axis(axes_read[-1])

        for node in self.nodes:
            if isinstance(node, Axes):
                close()
                self._report_above_axes([] if current else lines)
                current, lines = node, []
            elif isinstance(node, SignalLine):
                self._judge_signal(node, 1 if current is None else current.every)
                lines.append(node)
            elif isinstance(node, Zoom):
                self._judge_zoom(node)
                lines.append(node)
            elif isinstance(node, Learn):
                lines.append(self._learn(node))
            elif isinstance(node, Drive):
                lines.append(self._drive(node))
        close()
        return axes_read

    def _judge_axis(self, axes: Axes) -> None:
        """Report sources that need a drive or a rate missing from the axis."""
        drives = axes.ports("drive")
        for line in axes.lines:
            source = line.source if isinstance(line, SignalLine) else None
            if source is None:
                continue
            if source.kind == "driven" and source.name not in drives and "drive" not in self.broken:
                what, span = "drive of this axis", span_of(source.name)
                self.scope.unknown("unknown-signal", what, source.name, span, drives)
            if axes.every > 1 and source.option("cleared"):
                message = f"a sum of an axis that runs every {axes.every} periods is not cleared"
                hint = "leave 'cleared each set-point' out, or move the sum to a faster axis"
                self.scope.report("bad-set-point", message, line.span, hint=hint)

    def _report_above_axes(self, lines: Sequence[Line]) -> None:
        for line in lines:
            self.scope.report(
                "line-above-axes",
                "this line of an axis is above the first axis",
                line.span,
                hint="move it below the line  axis NAME",
            )

    def _judge_signal(self, node: SignalLine, every: float) -> None:
        self._judge_sum(node.products)
        source = node.source
        if source is not None:
            for word, value in source.options:
                self._judge_option(word, value)
            self._judge_repeated(source.options)
            self._judge_source(source, node.span, every)
        if len(node.names) > 1 and (source is None or source.kind != "rules"):
            self.scope.report(
                "several-signals",
                "only rules give several signals at once",
                span_of(node.names[0]).to(span_of(node.names[-1])),
            )

    def _judge_sum(self, products: Sequence[Product]) -> None:
        for product in products:
            for factor in product.factors:
                if factor.divides and factor.value == 0.0:
                    span = span_of(factor.value)
                    self.scope.report("bad-number", "a division by zero", span)

    def _judge_option(self, word: str, value: Setting) -> None:
        if isinstance(value, tuple):
            low, high = value
            if not low < high:
                self._turned("limits", low, high)
        elif isinstance(value, Time) and not value > 0.0:
            span = value.figure.span
            self.scope.report("bad-time", f"the time of {word} must be above 0", span)

    def _turned(self, what: str, low: float, high: float) -> None:
        """Report an empty range; for reversed ends, with the ends exchanged."""
        verb = "must go from a lower to a higher number"
        right = f"{number_text(high)} .. {number_text(low)}" if high < low else None
        self.scope.report(
            "bad-range",
            f"{what} {verb}",
            span_of(low).to(span_of(high)),
            hint="" if right is None else f"write  {right}",
            replacement=right,
        )

    def _judge_repeated(self, options: Sequence[tuple[str, Setting]]) -> None:
        names: set[str] = set()
        for word, _ in options:
            if word in names:
                self.scope.report("duplicate-setting", f"'{word}' is set twice", span_of(word))
            names.add(word)

    def _judge_source(self, source: Source, span: Span, every: float) -> None:
        """Report missing options of a source, and invalid numbers."""
        options = dict(source.options)
        for word, option in source.record.options.items():
            if option.needed and word not in options:
                self.scope.report(
                    "incomplete-statement",
                    f"the {word} of {source.kind} is missing",
                    span,
                    hint=f"add  , {word} {option.example}",
                )
            value = options.get(word)
            if option.periods and isinstance(value, Time):
                self._judge_periods(source, word, value, every)
            if not option.positive or not isinstance(value, Figure | Word):
                continue
            for number in self._numbers_of(value):
                if not number > 0.0:
                    message = f"the {word} of {source.kind} must be above 0, not {number:g}"
                    self.scope.report("bad-number", message, value.span)

    def _judge_periods(self, source: Source, word: str, time: Time, every: float) -> None:
        """Report a time that is not a whole number of control periods, or too long."""
        node = next((node for node in self.nodes if isinstance(node, PeriodNode)), None)
        period = every * node.time if node is not None else 0.0
        if not period > 0.0:
            return
        count = whole_periods(time, period)
        if not is_whole(time, period):
            message = f"the {word} of {source.kind} {fraction_of_periods(time, period)}"
            hint = f"whole ones:  {number_text(count * period)} s"
            self.scope.report("bad-number", message, time.figure.span, hint=hint)
        elif count > MOST_PERIODS:
            message = f"the {word} of {source.kind} is {count:,} control periods"
            hint = f"at most {MOST_PERIODS}"
            self.scope.report("bad-number", message, time.figure.span, hint=hint)

    def _numbers_of(self, value: Figure | Word) -> list[float]:
        """Return a number, or the known values of a gain."""
        if isinstance(value, Figure):
            return [value]
        for node in self.nodes:
            if isinstance(node, GainModel) and node.name == value:
                with suppress(ZeroDivisionError):  # reported at the gain
                    return [amount.value(math.pi) for amount in node.values]
        return []

    def _judge_zoom(self, node: Zoom) -> None:
        for value in (node.by, node.inside):
            if isinstance(value, float) and not value > 0.0:
                self.scope.report("bad-number", "expected a number above 0", span_of(value))

    def _learn(self, node: Learn) -> Learn:
        """Judge a line; where its delay is out of range, it is the usual one."""
        self._judge_repeated(node.options)
        delay = dict(node.options).get("delay", 1.0)
        if isinstance(delay, float) and float(delay).is_integer() and 0 <= delay <= MAX_DELAY:
            return node
        self.scope.report(
            "bad-delay",
            f"a delay of {delay} periods is out of range",
            node.span,
            hint=f"a whole number from 0 to {MAX_DELAY}",
        )
        return replace(
            node, options=tuple(option for option in node.options if option[0] != "delay")
        )

    def _drive(self, node: Drive) -> Drive:
        """Check a line; one with reversed limits drives nothing."""
        if node.within is not None and not node.within[0] < node.within[1]:
            self._turned("limits", *node.within)
        if node.slew is not None and not node.slew > 0.0:
            self.scope.report("bad-number", "expected a number above 0", span_of(node.slew))
        self._judge_events(node)
        if any(node is turned for turned in self.turned):
            return Drive(node.port, (), node.within, span=node.span)
        self._judge_sum(node.products)
        return node

    def _judge_events(self, node: Drive) -> None:
        low, high = node.within or (-math.inf, math.inf)
        for event, value in node.events:
            if low < high and isinstance(value, float) and not low <= value <= high:
                nearest = min(max(value, low), high)
                self.scope.report(
                    "bad-number",
                    f"'on {event}' sends {number_text(value)}, outside the limits of the drive",
                    span_of(value),
                    hint=f"write  on {event} {number_text(nearest)}  or wider limits",
                )

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

    def _judge_whole(self, heading: ControllerHeading, model: ControllerModel) -> None:
        if not model.axes:
            if "axis" not in self.broken:
                self.scope.report(
                    "no-axes",
                    "the controller has no axis",
                    heading.span,
                    hint="add a line like  axis joint1, joint2  and signals below it",
                )
            return
        for axis in model.axes:
            serves = axis.ports("drive") or any(map(model.seen_elsewhere, axis.names))
            if not serves and self.complete:
                self.scope.report(
                    "no-drives",
                    f"axis {', '.join(axis.names)} drives nothing",
                    axis.span,
                    hint=f"add a line like  drive {_drive_for(axis)}",
                )


def _drive_for(axes: Axes) -> str:
    """Return the likely drive: the last signal, possibly named like its port."""
    signals = [line for line in axes.lines if isinstance(line, SignalLine)]
    if not signals:
        return "voltage = u"
    last = signals[-1]
    if last.source is None and len(last.products) == 1 and len(last.products[0].factors) == 1:
        value = last.products[0].factors[0].value
        if isinstance(value, str):
            return f"{name_text(last.names[0])} = {name_text(value)}"
    return f"voltage = {name_text(last.names[0])}"


def _is_unread(node: StatementNode) -> bool:
    """Whether of a statement only the name could be read."""
    if isinstance(node, SignalLine):
        return node.source is None and not node.products
    if isinstance(node, GainModel):
        return not node.values
    return isinstance(node, Use) and not node.files


def _axes(count: int) -> str:
    return "1 axis" if count == 1 else f"{count} axes"


def _values_hint(node: GainModel) -> str:
    """Describe the values of a gain; two numbers may be one with a decimal comma."""
    if len(node.values) == 2:
        first, second = map(amount_text, node.values)
        if first.lstrip("-").isdigit() and second.isdigit():
            return f"{_ONE_OR_EACH}; a decimal mark is a point: {first}.{second}"
    return _ONE_OR_EACH


_ONE_OR_EACH = "one value for all axes, or one for each"
