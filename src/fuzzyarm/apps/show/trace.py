"""One inference, step by step: memberships, rules, clipped sets, value."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fuzzyarm.apps.show.drawing import curve_blocks, marker, number_words, ruler
from fuzzyarm.base.numbers import number_text
from fuzzyarm.language.tokens import name_text

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, Group, RenderableType
    from rich.text import Text

    from fuzzyarm.inference.trace import FuzzyValue, OutputTrace, RuleTrace, Silence, Trace

OVER = "over"
"""Before the lower of two sets, as in the language."""


def trace_view(trace: Trace, path: str = "", *, all_rules: bool = False) -> Group:
    """Return all steps from the inputs to the outputs.

    Parameters
    ----------
    trace : Trace
        From :func:`fuzzyarm.inference.explain`.
    path : str
        File name beside the lines of the rules.
    all_rules : bool
        Include the rules that do not fire.
    """
    from rich.console import Group
    from rich.text import Text

    parts: list[RenderableType] = []
    for value in trace.inputs:
        parts += [_memberships(value), Text()]
    parts += [_rules(trace, path, all_rules=all_rules), Text()]
    for k, output in enumerate(trace.outputs):
        parts += [OutputPlot(output), *([Text()] if k + 1 < len(trace.outputs) else [])]
    return Group(*parts)


def silence_view(silence: Silence) -> Group:
    """Return the memberships of the inputs and the rules nearest to firing, if none fires."""
    from rich.console import Group
    from rich.text import Text

    parts: list[RenderableType] = []
    for value in silence.inputs:
        parts += [_memberships(value), Text()]
    text = Text(f"no rule for {name_text(silence.output)} fires; nearest come", "bold")
    for rule, degrees in ((near.rule, near.propositions) for near in silence.nearest):
        text.append(f"\n  {_position(rule, '')}  {rule.text}", "not bold")
        for words, degree in degrees:
            text.append(
                f"\n    {degree:.4f}  {words}", "not bold" if degree > 0 else "not bold red"
            )
    return Group(*parts, text)


def firing_view(trace: Trace) -> Group:
    """Return a short form for narrow columns: only fired rules, without lines and columns.

    Parameters
    ----------
    trace : Trace
        From :func:`fuzzyarm.inference.explain`.
    """
    from rich.console import Group
    from rich.text import Text

    parts: list[RenderableType] = []
    for value in trace.inputs:
        line = Text(f"{name_text(value.name)} {number_words(value.value, 4)}", "bold")
        for name, degree in value.degrees:
            if degree > 0:
                line.append(f"  {name_text(name)} ", "not bold")
                line.append(f"{degree:.3g}", "not bold cyan")
        parts.append(line)
    parts.append(Text(f"{len(trace.fired)} of {len(trace.rules)} rules fire", "bold"))
    for rule in trace.fired:
        bar = "█" * max(1, round(rule.strength * 5))
        antecedent, _, consequent = rule.text.removeprefix("if ").rpartition(" then ")
        # The conclusion first: a narrow pane cuts off the end of a line.
        line = Text(no_wrap=True, overflow="ellipsis")
        line.append(f" {rule.strength:.3f} ")
        line.append(f"{bar:<5} ", "cyan")
        line.append(consequent, "bold")
        line.append(f" if {antecedent}", "not bold")
        parts.append(line)
    for output in trace.outputs:
        parts += [Text(), OutputPlot(output)]
    return Group(*parts)


def _memberships(value: FuzzyValue) -> Text:
    from rich.text import Text

    text = Text(f"{name_text(value.name)} = {number_text(value.given)}", "bold")
    if value.value != value.given:
        text.append(f", taken as {number_text(value.value)}", "not bold")
    width = max((len(name) for name, _ in value.degrees), default=0)
    lower = dict(value.lower)
    for name, degree in value.degrees:
        if degree > 0:
            span = _span(degree, lower.get(name))
            text.append(f"\n  {name:<{width}}  {span}  ", "not bold")
            sure = round(lower.get(name, degree) * 20)
            text.append("█" * sure or ("▏" if not lower else ""), "cyan")
            text.append("░" * (round(degree * 20) - sure), "cyan")
    if not any(degree > 0 for _, degree in value.degrees):
        text.append("\n  in no term", "not bold dim")
    return text


def _span(upper: float, lower: float | None) -> str:
    """Return a degree, or the two ends of an interval."""
    return f"{upper:.4f}" if lower is None else f"{lower:.4f} .. {upper:.4f}"


def _rules(trace: Trace, path: str = "", *, all_rules: bool = False) -> Text:
    from rich.text import Text

    traces = trace.fired
    if all_rules:
        traces = (*traces, *(rule for rule in trace.rules if rule.strength <= 0))
    text = Text(f"{len(trace.fired)} of {len(trace.rules)} rules fire", "bold")
    positions = [_position(rule, path) for rule in traces]
    width = max(map(len, positions), default=0)
    for rule, position in zip(traces, positions, strict=True):
        span = _span(rule.strength, rule.lower)
        text.append(f"\n  {span}  {position:<{width}}  {rule.text}", "not bold")
    return text


def _position(rule: RuleTrace, path: str) -> str:
    return rule.place.replace("line ", f"{path}:", 1) if path else rule.place


@dataclass(frozen=True)
class OutputPlot:
    """The clipped sets of an output, their union, and the value below it."""

    output: OutputTrace

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        from rich.text import Text

        output = self.output
        yield Text(f"{name_text(output.name)} by {output.method}", "bold")
        if not output.fired:
            asserted = any(consequent.strength for consequent in output.consequents)
            why = "no set has an area" if asserted else "no rule fires"
            yield Text(f"  {why}: the value is the stated one", "yellow")
        names = [consequent.term for consequent in output.consequents]
        left = max(map(len, [*names, "all"]))
        width = min(61, options.max_width - left - 14)
        width -= 1 - width % 2
        for consequent in output.consequents:
            line = Text(f"  {consequent.term:<{left}}  {consequent.strength:.4f}  ", no_wrap=True)
            style = "cyan" if consequent.lower is None else "dim cyan"
            if consequent.curve:
                line.append(curve_blocks(consequent.curve, output.low, output.high, width), style)
            elif consequent.value is not None:
                line.append(f"at {_between(consequent.value, consequent.lower_value)}")
            yield line
            if consequent.lower is not None:
                line = Text(f"  {OVER:>{left}}  {consequent.lower:.4f}  ", no_wrap=True)
                lower = curve_blocks(consequent.lower_curve, output.low, output.high, width)
                yield line.append(lower if consequent.curve else "", "cyan")
        if output.aggregate:
            indent = " " * (left + 12)
            union = curve_blocks(output.aggregate, output.low, output.high, width)
            style = "dim magenta" if output.lower_aggregate else "magenta"
            yield Text.assemble(f"  {'all':<{left}}          ", (union, style), no_wrap=True)
            if output.lower_aggregate:
                union = curve_blocks(output.lower_aggregate, output.low, output.high, width)
                yield Text.assemble(f"  {OVER:>{left}}          ", (union, "magenta"), no_wrap=True)
            pointer = marker(output.value, output.low, output.high, width)
            yield Text(f"{indent}{pointer}".rstrip(), no_wrap=True)
            yield Text(f"{indent}{ruler(output.low, output.high, width)}", "dim", no_wrap=True)
        if output.left is not None and output.right is not None:
            ends = f"{number_text(output.left)} .. {number_text(output.right)}"
            yield Text(f"  between {ends}", no_wrap=True)
            if output.aggregate:
                yield Text("  the left end is the centroid of the upper set left of it and the")
                yield Text("  lower one right of it, the right end the other way round")
        yield Text(f"{name_text(output.name)} = {number_text(output.value)}", "bold")


def _between(value: float, other: float | None) -> str:
    if other is None or other == value:
        return number_words(value)
    return f"{number_words(min(value, other))} .. {number_words(max(value, other))}"
