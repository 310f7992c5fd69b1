"""FCL function blocks: meaning of variables, norms, methods and rules by program."""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass, field, replace

from fuzzyarm.base.diagnostic import Span
from fuzzyarm.exchange.formats.dialects import JFUZZYLOGIC_PAIRS, Dialect
from fuzzyarm.exchange.formats.drafts import VALUES, VariableDraft
from fuzzyarm.exchange.formats.fcl_text import MEAN_OF_MAXIMUM
from fuzzyarm.exchange.formats.findings import Findings, TextPiece
from fuzzyarm.exchange.formats.meaning import BlockDraft
from fuzzyarm.exchange.formats.sentences import RuleText, read_sentences
from fuzzyarm.exchange.formats.system_reader import SystemReader
from fuzzyarm.language.model.rulebase import RuleBase, Shape, Term

_S_TO_T = {s: t for t, s in JFUZZYLOGIC_PAIRS.items()}


@dataclass(slots=True)
class BlockText:
    """A rule block as written: norms by AND, OR, ACT and ACCU, rules from IF on."""

    word: TextPiece
    norms: list[tuple[str, TextPiece]] = field(default_factory=list)
    rules: list[list[TextPiece]] = field(default_factory=list)
    enabled: bool = True
    named: dict[str, str] | None = None  # cache: the norms in the model


class FunctionBlock(SystemReader):
    """A function block; accumulations by the name of the output.

    Attributes
    ----------
    word : TextPiece
        Its name.
    texts : list of BlockText
        Its rule blocks.
    """

    def __init__(self, word: TextPiece, dialect: Dialect, findings: Findings) -> None:
        super().__init__(dialect, findings)
        self.word = word
        self.accumulations: dict[str, str] = {}
        self._own_accumulations: set[str] = set()  # of outputs with ACCU in DEFUZZIFY
        self._mixed: set[str] = set()
        self.texts: list[BlockText] = []

    @property
    def own(self) -> bool:
        """Whether fuzzylite's meaning applies."""
        return self.dialect.producer == "fuzzylite"

    def step(self, draft: VariableDraft, word: TextPiece, value: float) -> None:
        """Report the step of a range, which only fcl-for-scikit-fuzzy has."""
        message = f"the step of '{draft.name}' is left out: {self.dialect.program} has none"
        self.findings.warn("dropped-step", message, word)

    def note_default(self, draft: VariableDraft, word: TextPiece) -> None:
        """Report an ineffective default (a hook of the dialects)."""

    def accumulation(self, draft: VariableDraft, word: TextPiece) -> None:
        """Read the ACCU of an output."""
        norm = self.snorm(word, "the accumulation")
        if norm is not None:
            self.accumulations[draft.name] = norm
            self._own_accumulations.add(draft.name)

    # --- Rule blocks ---

    def _norms_of(self, text: BlockText) -> dict[str, str]:
        """Return the norms of a block, with their findings the first time."""
        if text.named is None:
            text.named = self._norms(text)
        return text.named

    def _norms(self, text: BlockText) -> dict[str, str]:
        """Return the norms of a block, by AND, OR, ACT and ACCU."""
        norms: dict[str, str] = {}
        for key, word in text.norms:
            reader = self.tnorm if key in ("AND", "ACT") else self.snorm
            norm = reader(word, f"the norm for {key}")
            if norm is None:
                continue
            if not self.own and key in ("AND", "OR"):
                self._pair(norms, key, norm, word)
            norms[key] = norm
        return norms

    def _pair(self, norms: dict[str, str], key: str, norm: str, word: TextPiece) -> None:
        """Set OR with AND and AND with OR, as jFuzzyLogic does."""
        other = "OR" if key == "AND" else "AND"
        table = JFUZZYLOGIC_PAIRS if key == "AND" else _S_TO_T
        partner = table.get(norm)
        if partner is None:
            return
        if other in norms and norms[other] != partner:
            message = f"to jFuzzyLogic this sets {other} to {partner} too, whatever stood there"
            self.findings.warn("paired-norms", message, word)
        norms[other] = partner

    def _accumulate(self, rules: list[RuleText], accumulation: str | None) -> None:
        """Set the aggregation of the rules' outputs from ACCU of their block."""
        if accumulation is None and self.own:
            return
        norm = accumulation or "sum"
        for rule in rules:
            for conclusion in rule.conclusions:
                draft = self.variables.get(conclusion.variable)
                if draft is None or not draft.is_output:
                    continue
                draft.aggregation = self.accumulations.setdefault(draft.name, norm)
                draft.aggregates = True
                if draft.aggregation != norm and not self.own and draft.name not in self._mixed:
                    self._mixed.add(draft.name)
                    self._note_mixed(draft.name, conclusion.span)

    def _note_mixed(self, name: str, at: Span) -> None:
        """Report an output with two accumulations."""
        message, hint = f"two blocks accumulate '{name}' by different norms", ""
        if name in self._own_accumulations:
            message = f"the ACCU of '{name}' is not that of its rules, which is SUM unless given"
            hint = "--from fuzzylite, whose files have ACCU inside DEFUZZIFY"
        self.findings.loss("mixed-accumulation", message, at, hint)

    # --- From the text to the model ---

    def read(self) -> RuleBase:
        """Return the rule base, after the last word."""
        for text in self.texts:
            self.blocks.append(self._block(text))
        self.settle()
        blocks = [block for block in self.blocks if self.is_on(block)]
        for block, text in zip(self.blocks, self.texts, strict=True):
            if block.enabled:
                block.rules = self.sentences(text.rules)
                self._accumulate(block.rules, self._norms_of(text).get("ACCU"))
        in_model = self.in_model(blocks)
        return self.rulebase(self.word.text, in_model)

    def _block(self, text: BlockText) -> BlockDraft:
        block = BlockDraft(text.word.text, text.word.span, text.enabled)
        if block.enabled:
            norms = self._norms_of(text)
            block.conjunction, block.disjunction = norms.get("AND"), norms.get("OR")
            block.implication, block.threshold = norms.get("ACT"), self.dialect.threshold
        return block

    def sentences(self, rules: list[list[TextPiece]]) -> list[RuleText]:
        """Return rules from their words."""
        return read_sentences(rules, self.variables, self.findings, self.dialect)

    def settle_variable(self, draft: VariableDraft) -> None:
        """Settle a variable, with vertical edges on jFuzzyLogic's side of a sample."""
        super().settle_variable(draft)
        if draft.is_output and not self.own:
            _settle_edges(draft, self.findings)

    def finish_output(self, draft: VariableDraft, name: str) -> None:
        """Set the aggregation, which rule blocks may change, and the defuzzifier."""
        norm = self.accumulations.get(draft.name)
        draft.aggregation, draft.aggregates = norm or "sum", norm is not None
        super().finish_output(draft, name)

    def method_name(self, draft: VariableDraft) -> str:
        """Return the method; a centre of gravity of values is their average."""
        name = super().method_name(draft)
        if name != "COG" or self.own or not draft.kinds or not draft.kinds <= VALUES:
            return name
        program, at = self.dialect.program, draft.method or draft.word
        message = f"the terms of '{draft.name}' are values; {program} refuses to integrate them"
        hint = "read as METHOD : COGS, which is for singletons"
        self.findings.warn("value-as-set", message, at, hint)
        return "COGS"

    def note_method(self, draft: VariableDraft, name: str, at: TextPiece) -> None:
        """Report where methods of jFuzzyLogic differ from the model's."""
        if self.own:
            super().note_method(draft, name, at)
        elif name == "COA":
            message = "jFuzzyLogic finds the middle of the area one sample coarser than the model"
            self.findings.loss("bisector-rule", message, at, slight=True)
        elif name == "MM":
            self.findings.loss("mean-of-maximum", MEAN_OF_MAXIMUM, at, slight=True)
        elif name in ("LM", "RM"):
            self.note_ties(draft, at)


# --- jFuzzyLogic's sample positions, to the last bit ---
#
# It accumulates the step along the range; the model multiplies it. The two differ by some 1e-16,
# which shows at a vertical edge on a sample only: one side sees 1, the other 0.


def _settle_edges(draft: VariableDraft, findings: Findings) -> None:
    """Move vertical edges by one ulp if the two samples disagree."""
    count = draft.defuzzifier.resolution
    if count is None:
        return
    samples: list[tuple[float, float]] = []
    for index, term in enumerate(draft.terms):
        if not any(_edges(term.shape)):
            continue
        samples = samples or _samples(draft.low, draft.high, count)
        shape = _moved(term.shape, samples, draft.low, draft.high)
        if shape != term.shape:
            message = (
                f"an edge of '{term.name}' is on a sample that jFuzzyLogic takes right beside "
                "it; it is moved by the smallest possible step"
            )
            findings.info("edge-on-sample", message, term.span)
            draft.put(index, Term(term.name, shape, term.span))


def _samples(low: float, high: float, count: int) -> list[tuple[float, float]]:
    """Return pairs of samples: the model's and jFuzzyLogic's."""
    step = (high - low) / count
    pairs = []
    x = low
    for index in range(count):
        pairs.append((low + index * step, x))
        x += step
    return pairs


def _edges(shape: Shape) -> tuple[bool, bool]:
    """Return whether the left and the right flank are vertical."""
    p = shape.parameters
    match shape.kind:
        case "triangle":
            return p[0] == p[1], p[1] == p[2]
        case "trapezoid":
            return p[0] == p[1], p[2] == p[3]
        case "rectangle" | "singleton":
            return True, True
    return False, False


def _moved(shape: Shape, samples: list[tuple[float, float]], low: float, high: float) -> Shape:
    left, right = _edges(shape)
    first, last = shape.parameters[0], shape.parameters[-1]
    model, walked = _nearest(first, samples)
    if shape.kind == "singleton" and model != first:
        return shape  # on no sample of either
    p = list(shape.parameters)
    if left and (model < first <= walked or walked < first <= model):
        edge = model if walked >= first else math.nextafter(model, high)
        p = [edge if value == first else value for value in p]
    model, walked = _nearest(last, samples)
    if right and (model <= last < walked or walked <= last < model):
        edge = model if walked <= last else math.nextafter(model, low)
        p = [edge if value == last else value for value in p]
    return replace(shape, parameters=tuple(p))


def _nearest(edge: float, samples: list[tuple[float, float]]) -> tuple[float, float]:
    """Return the model's sample nearest to an edge, and jFuzzyLogic's."""
    index = bisect_left(samples, (edge, -math.inf))
    return min(samples[max(index - 1, 0) : index + 1], key=lambda pair: abs(pair[0] - edge))
