"""One inference, step by step: memberships, rules, clipped sets, value."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fuzzyarm.show.drawing import curve_blocks, marker
from fuzzyarm.show.rulebase import name_words, number_words, ruler
from fuzzyarm.text.numbers import number_text

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, Group, RenderableType
    from rich.text import Text

    from fuzzyarm.inference.trace import FuzzyValue, OutputTrace, Trace


_BAR = 20


def trace_view(trace: Trace, path: str = "", *, all_rules: bool = False) -> Group:
    """Return the whole way from the inputs to the outputs.

    Parameters
    ----------
    trace : Trace
        From :func:`fuzzyarm.inference.explain`.
    path : str
        The file, to name beside the lines of the rules.
    all_rules : bool
        List the rules that do not fire as well.
    """
    from rich.console import Group
    from rich.text import Text

    parts: list[RenderableType] = []
    for value in trace.inputs:
        parts += [membership_text(value), Text()]
    parts += [rules_text(trace, path, all_rules=all_rules), Text()]
    for k, output in enumerate(trace.outputs):
        parts += [OutputPlot(output), *([Text()] if k + 1 < len(trace.outputs) else [])]
    return Group(*parts)


def membership_text(value: FuzzyValue) -> Text:
    """Return a crisp value and the terms it belongs to, with bars."""
    from rich.text import Text

    text = Text(f"{name_words(value.name)} = {number_text(value.given)}", "bold")
    if value.value != value.given:
        text.append(f", taken as {number_text(value.value)}", "not bold")
    names = [name for name, _ in value.degrees]
    width = max(map(len, names), default=0)
    for name, degree in value.degrees:
        if degree > 0:
            text.append(f"\n  {name:<{width}}  {degree:.4f}  ", "not bold")
            text.append(_bar(degree), "cyan")
    if not any(degree > 0 for _, degree in value.degrees):
        text.append("\n  in no term", "not bold dim")
    return text


def rules_text(trace: Trace, path: str = "", *, all_rules: bool = False) -> Text:
    """Return the rules that fire, the strongest first, with their places in the file."""
    from rich.text import Text

    shown = trace.fired
    if all_rules:
        shown = (*shown, *(rule for rule in trace.rules if rule.strength <= 0))
    text = Text(f"{len(trace.fired)} of {len(trace.rules)} rules fire", "bold")
    places = [_place(rule.line, rule.column, rule.number, path) for rule in shown]
    width = max(map(len, places), default=0)
    for rule, place in zip(shown, places, strict=True):
        text.append(f"\n  {rule.strength:.4f}  {place:<{width}}  {rule.text}", "not bold")
    return text


def _place(line: int, column: int, rule_number: int, path: str) -> str:
    if (line, column) == (1, 1):  # a rule that came from no text of the language
        return f"rule {rule_number}"
    return f"{path}:{line}:{column}" if path else f"line {line}:{column}"


def _bar(degree: float) -> str:
    return "█" * round(degree * _BAR) or "▏"


@dataclass(frozen=True)
class OutputPlot:
    """The clipped sets of an output, their union, and the value below it."""

    output: OutputTrace

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        from rich.text import Text

        output = self.output
        yield Text(f"{name_words(output.name)} by {output.method}", "bold")
        if not output.fired:
            yield Text("  no rule fires: the value is the stated one", "yellow")
        names = [each.term for each in output.consequents]
        left = max(map(len, [*names, "all"]))
        width = min(61, options.max_width - left - 14)
        width -= 1 - width % 2
        for each in output.consequents:
            line = Text(f"  {each.term:<{left}}  {each.strength:.4f}  ", no_wrap=True)
            if each.curve:
                line.append(curve_blocks(each.curve, output.low, output.high, width), "cyan")
            elif each.value is not None:
                line.append(f"at {number_words(each.value)}")
            yield line
        if output.aggregate:
            indent = " " * (left + 12)
            union = curve_blocks(output.aggregate, output.low, output.high, width)
            yield Text.assemble(f"  {'all':<{left}}          ", (union, "magenta"), no_wrap=True)
            pointer = marker(output.value, output.low, output.high, width)
            yield Text(f"{indent}{pointer}".rstrip(), no_wrap=True)
            yield Text(f"{indent}{ruler(output.low, output.high, width)}", "dim", no_wrap=True)
        yield Text(f"{name_words(output.name)} = {number_text(output.value)}", "bold")
