"""FCL as the reader for scikit-fuzzy takes it (James Power's fcl-for-scikit-fuzzy).

A RANGE stands inside FUZZIFY and may have a step: ``RANGE := (0 .. 10) WITH 0.5;``. It becomes
the points of a universe, without its upper end, and every term is straight between them. The
rest is what scikit-fuzzy makes of it: rules clip by the minimum and add up by the maximum.
"""

from __future__ import annotations

import math

from fuzzyarm.expression.kinds import SNORMS, TNORMS
from fuzzyarm.formats.dialects import words
from fuzzyarm.formats.drafts import Draft
from fuzzyarm.formats.fcl_blocks import BlockText, Reader
from fuzzyarm.formats.findings import Word
from fuzzyarm.formats.recovery import NEAR_LINES, beside_lines, is_joined, joined
from fuzzyarm.formats.sentences import RuleText
from fuzzyarm.model.rulebase import Defuzzifier, Shape, Term
from fuzzyarm.model.shapes import membership_function

__all__ = ["ScikitReader", "universe"]

MAX_POINTS = 1_000_000
"""Most points of a universe."""

_MINIMUM = "the reader for scikit-fuzzy clips by the minimum"

_NAMES = {
    "DRP": "drastic", "DMIN": "drastic", "NILMIN": "nilpotent", "NIPMIN": "nilpotent",
    "HAMACHER": "hamacher", "PROBOR": "probor", "DRS": "drastic", "DMAX": "drastic",
    "EINSTEIN": "einstein", "NILMAX": "nilpotent", "NIPMAX": "nilpotent",
}  # fmt: skip
"""Words of IEEE 1855 and of jFuzzyLogic for norms, beside those of fuzzylite."""


def universe(low: float, high: float, step: float | None) -> list[float]:
    """Return the points of a range; the upper end is not one of them.

    Without a step it is a power of ten that makes some thousand of them.

    Parameters
    ----------
    low, high : float
        The range; `low` below `high`.
    step : float or None
        A positive distance.
    """
    if not step:
        step = 10.0 ** round(math.log10((1.0 + (high - low)) / 1000.0))
    count = math.ceil(min((high - low) / step, MAX_POINTS))
    return [low + step * index for index in range(count)]


class ScikitReader(Reader):
    """Reads a function block as fcl-for-scikit-fuzzy does."""

    _steps: dict[str, float]

    def _note_range(self, draft: Draft) -> None:
        """Take the range of an input where it stands."""

    def _step(self, draft: Draft, word: Word) -> None:
        if not hasattr(self, "_steps"):
            self._steps = {}
        self._steps[draft.name] = self.cursor.number()
        if self._steps[draft.name] <= 0.0:
            self.findings.error("bad-range", "the step of a range must be positive", word)

    def _norms(self, text: BlockText) -> dict[str, str]:
        """Return the norms of a block; of a pair of which one is named the other is its dual."""
        named: dict[str, str] = {}
        for key, word in text.norms:
            kinds = TNORMS if key in ("AND", "ACT") else SNORMS
            table = words(kinds, "fcl") | {k: n for k, n in _NAMES.items() if n in kinds}
            norm = self.findings.norm(f"the norm for {key}", word, table, word.text.upper())
            if norm is None:
                continue
            if key == "ACT" and norm != "min":
                self.findings.warn("unsupported-norm", f"{_MINIMUM}, whatever ACT says", word)
            elif key == "ACCU" and norm != "max":
                message = "ACCU of a rule block is left out; that of an output counts"
                self.findings.warn("unsupported-norm", message, word)
            else:
                named[key] = norm
        if "AND" in named and "OR" not in named:
            named["OR"] = TNORMS[named["AND"]].dual
        elif "OR" in named and "AND" not in named:
            named["AND"] = SNORMS[named["OR"]].dual
        return {key: norm for key, norm in named.items() if key in ("AND", "OR")}

    def _accumulate(self, rules: list[RuleText], accumulation: str | None) -> None:
        """Leave the aggregation to the outputs."""

    def _default(self, draft: Draft) -> None:
        word = self.cursor.word
        super()._default(draft)
        message = f"the DEFAULT of '{draft.name}' is left out: no rule is an error to scikit-fuzzy"
        self.findings.info("dropped-options", message, word)

    def _method_name(self, draft: Draft, name: str, at: Word) -> str:
        return name

    def _settle(self, draft: Draft) -> None:
        if draft.is_output:
            draft.no_rule = "error"
            norm = self.block.accumulations.get(draft.name, "max")
            if norm != "max":
                message = f"'{draft.name}' accumulates by something else than the maximum"
                self.findings.loss("unsupported-norm", message, draft.word)
            draft.aggregation = "max"
        else:
            draft.outside = "clamp"
        if not draft.bounded or not draft.low < draft.high:
            message = f"'{draft.name}' needs a RANGE of two numbers that increase"
            self.findings.error("bad-range", message, draft.word)
            draft.low, draft.high = 0.0, 1.0
            return
        xs = universe(draft.low, draft.high, getattr(self, "_steps", {}).get(draft.name))
        if not (2 <= len(xs) < MAX_POINTS and xs[0] < xs[-1]):
            message = f"the RANGE of '{draft.name}' has {len(xs)} points"
            self.findings.error("bad-range", message, draft.word)
            return
        draft.low, draft.high = xs[0], xs[-1]
        for index, term in enumerate(draft.terms):
            shape = self._on_points(draft, term, xs)
            draft.put(index, Term(term.name, shape, term.span))
        if draft.is_output:
            self._finish_output(draft, self.block.methods.get(draft.name))
            method = draft.defuzzifier.method
            exact = "maximum" in method
            draft.defuzzifier = (
                Defuzzifier(method) if exact else Defuzzifier(method, len(xs), "joined")
            )

    def _on_points(self, draft: Draft, term: Term, xs: list[float]) -> Shape:
        """Return the set that has the degrees of a term at points and is straight between them."""
        shape = _extended(term.shape, xs)
        if shape.kind == "singleton":
            nearest = min(range(len(xs)), key=lambda i: abs(xs[i] - shape.parameters[0]))
            return joined(xs, [float(i == nearest) for i in range(len(xs))])
        if is_joined(shape, xs):
            return shape
        degree = membership_function(shape)
        if draft.is_output or beside_lines(shape, xs) > NEAR_LINES:
            # What defuzzifies an output takes its degrees at the points only.
            return shape if draft.is_output else joined(xs, [degree(x) for x in xs])
        message = (
            f"'{term.name}' of '{draft.name}' is straight between {len(xs)} points to "
            "scikit-fuzzy; here it is the whole shape"
        )
        self.findings.info("between-samples", message, term.span)
        return shape


def _extended(shape: Shape, xs: list[float]) -> Shape:
    """Return points with what scikit-fuzzy's reader puts before them: a line from 0."""
    if shape.kind != "points" or shape.parameters[0] <= xs[0]:
        return shape
    return Shape("points", (xs[0], 0.0, *shape.parameters), shape.height)
