"""The lines of a rule block in FLL."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from fuzzyarm.formats.fll.lines import Line
from fuzzyarm.formats.imported import MAX_RULES, Findings, Word
from fuzzyarm.formats.norms import FLL_CONJUNCTIONS, FLL_DISJUNCTIONS
from fuzzyarm.formats.numerals import number
from fuzzyarm.rulebase.diagnostic import NOWHERE, Span

_FLAGS = {"true": True, "false": False}
_ACTIVATIONS = ("General", "First", "Last", "Highest", "Lowest", "Proportional", "Threshold")
_KEYS = (
    "description", "enabled", "conjunction", "disjunction", "implication", "activation", "rule",
)  # fmt: skip


@dataclass(slots=True)
class Block:
    """A rule block while its lines are read; None where it names no norm."""

    name: str
    enabled: bool = True
    conjunction: str | None = None
    disjunction: str | None = None
    implication: str | None = None
    threshold: float = 0.0
    rules: list[Line] = field(default_factory=list)
    span: Span = NOWHERE


def flag(line: Line, findings: Findings, *, default: bool = False) -> bool:
    """Return whether a line says true or false."""
    value = _FLAGS.get(line.value.text.lower())
    if value is None:
        message = f"'{line.value.text[:40]}' is neither true nor false"
        findings.error("not-a-flag", message, line.value)
        return default
    return value


def norm(word: Word, table: dict[str, str], what: str, findings: Findings) -> str | None:
    """Return the norm that a word names, None for ``none``."""
    if word.text in ("", "none"):
        return None
    if word.text not in table:
        findings.unknown("unknown-norm", f"the {what}", word, table)
        return None
    return table[word.text]


def block_setting(block: Block, line: Line, count: int, findings: Findings) -> None:
    """Apply one line to a block; `count` rules have been read so far."""
    match line.key.text:
        case "description":
            if line.value.text:
                message = "the description of a rule block has no place in the model"
                findings.info("dropped-description", message, line.key)
        case "enabled":
            block.enabled = flag(line, findings, default=True)
        case "conjunction":
            block.conjunction = norm(line.value, FLL_CONJUNCTIONS, "T-norm", findings)
        case "disjunction":
            block.disjunction = norm(line.value, FLL_DISJUNCTIONS, "S-norm", findings)
        case "implication":
            block.implication = norm(line.value, FLL_CONJUNCTIONS, "T-norm", findings)
        case "activation":
            _activation(block, line, findings)
        case "rule":
            if findings.room(count, MAX_RULES, "rules", line.key):
                block.rules.append(line)
        case _:
            findings.unknown("unknown-key", "the key", line.key, _KEYS)


def _activation(block: Block, line: Line, findings: Findings) -> None:
    words = line.words()
    method = words[0].text if words else "none"
    if method in FLL_CONJUNCTIONS:  # fuzzylite 5 said activation for implication
        block.implication = FLL_CONJUNCTIONS[method]
    elif method in _ACTIVATIONS:
        threshold = _threshold(words)
        if threshold is None:
            message = f"the activation method '{line.value.text[:60]}' cannot be carried"
            findings.loss("unsupported-activation", message, line.value)
        else:
            block.threshold = threshold
    elif method != "none":
        findings.unknown("unknown-activation", "the method", words[0], _ACTIVATIONS)


def _threshold(words: list[Word]) -> float | None:
    """Return the firing strength below which a rule is left out; None for other methods.

    ``Threshold >= t`` is the next number below t: strengths are numbers of the machine.
    """
    if words[0].text == "General":
        return 0.0
    values = [word.text for word in words[1:]]
    if words[0].text != "Threshold" or len(values) not in (0, 2):
        return None
    if not values:
        return 0.0  # greater than 0
    limit = number(values[1])
    if limit is None or not math.isfinite(limit) or values[0] not in (">", ">="):
        return None
    below = limit if values[0] == ">" else math.nextafter(limit, -math.inf)
    return max(below, 0.0)
