"""A whole rule base in the terminal: variables, terms, rules, settings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.rulebase.model import Output, RuleBase, Variable
from fuzzyarm.show.rulegrid import rules_view
from fuzzyarm.show.terms import TermPlots
from fuzzyarm.show.words import name_words, number_words

if TYPE_CHECKING:
    from rich.console import Group, RenderableType
    from rich.text import Text


def rulebase_view(rulebase: RuleBase) -> Group:
    """Return everything about a rule base, top to bottom."""
    from rich.console import Group
    from rich.text import Text

    variables: tuple[Variable, ...] = (*rulebase.inputs, *rulebase.outputs)
    parts: list[RenderableType] = [heading(rulebase), Text()]
    for variable in variables:
        parts += [TermPlots(variable, rulebase), Text()]
    parts += [rules_view(rulebase), inference_text(rulebase)]
    return Group(*parts)


def heading(rulebase: RuleBase) -> Text:
    """Return the name, the description and the size of a rule base."""
    from rich.text import Text

    text = Text(rulebase.name, "bold")
    if rulebase.description:
        text.append(f"  {rulebase.description}", "not bold")
    counts = (len(rulebase.inputs), len(rulebase.outputs), len(rulebase.rules))
    words = zip(counts, ("input", "output", "rule"), strict=True)
    sizes = ", ".join(f"{count} {word}{'s' if count != 1 else ''}" for count, word in words)
    text.append(f"\n{sizes}", "dim")
    return text


def inference_text(rulebase: RuleBase) -> Text:
    """Return how the rules are evaluated, in words."""
    from rich.text import Text

    lines = []
    for block in rulebase.blocks:
        name = f"block {name_words(block.name)}: " if block.name else ""
        lines.append(
            f"{name}and {block.conjunction}, or {block.disjunction}, "
            f"implication {block.implication}"
        )
    lines += [f"{name_words(o.name)}: {output_words(o)}" for o in rulebase.outputs]
    return Text("\n".join(dict.fromkeys(lines)), "dim")


def output_words(output: Output) -> str:
    """Return the aggregation, the defuzzifier and the value without rules of an output."""
    way = output.defuzzifier
    samples = f"({way.resolution}, {way.sampling})" if way.resolution else ""
    exact = " exact" if way.resolution is None and way.method == "centroid" else ""
    default = output.no_rule if isinstance(output.no_rule, str) else number_words(output.no_rule)
    return f"aggregation {output.aggregation}, {way.method}{samples}{exact}, no-rule {default}"
