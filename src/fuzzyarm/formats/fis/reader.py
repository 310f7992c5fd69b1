"""Read FIS: its sections, and its membership functions."""

from __future__ import annotations

import math
import re

from fuzzyarm.expression.kinds import SHAPES
from fuzzyarm.formats.findings import (
    MAX_RULES,
    MAX_TERMS,
    MAX_VARIABLES,
    Draft,
    Findings,
    Imported,
    Word,
    all_written,
    number,
    numbers,
    rounded,
    too_long,
    unique_name,
)
from fuzzyarm.formats.fis.meaning import (
    Section,
    System,
    bracketed,
    detect,
    finish_output,
    fis_sections,
    key_and_value,
    membership_parts,
    rules_in_model,
    unquoted,
)
from fuzzyarm.formats.fis.rules import RuleReader
from fuzzyarm.formats.fll.reader import FLL_SHAPES, formula_shape, fuzzylite_formula, linear_shape
from fuzzyarm.formats.shapes import make_shape
from fuzzyarm.model.rulebase import RuleBase, RuleBlock, Shape, Term
from fuzzyarm.text.diagnostic import NOWHERE, Span

# --- Membership functions of FIS: MATLAB's and Octave's, and fuzzylite's additions ---

# Kind of shape, and where each of its numbers stands in the list of the file.
_ORDER: dict[str, tuple[str, tuple[int, ...]]] = {
    "trimf": ("triangle", (0, 1, 2)),
    "trapmf": ("trapezoid", (0, 1, 2, 3)),
    "gaussmf": ("gaussian", (1, 0)),
    "gauss2mf": ("two-sided-gaussian", (1, 0, 3, 2)),
    "gbellmf": ("bell", (2, 0, 1)),
    "sigmf": ("sigmoid", (1, 0)),
    "dsigmf": ("sigmoid-difference", (1, 0, 3, 2)),
    "psigmf": ("sigmoid-product", (1, 0, 3, 2)),
    "zmf": ("z", (0, 1)),
    "smf": ("s", (0, 1)),
    "pimf": ("pi", (0, 1, 2, 3)),
    "linsmf": ("ramp", (0, 1)),
    "linzmf": ("ramp", (1, 0)),
    "rampmf": ("ramp", (0, 1)),
    "rectmf": ("rectangle", (0, 1)),
    "cosinemf": ("cosine", (0, 1)),
    "concavemf": ("concave", (0, 1)),
    "spikemf": ("spike", (0, 1)),
    "binarymf": ("binary", (0, 1)),
    "singletonmf": ("singleton", (0,)),
}
MATLAB_SHAPES = frozenset(
    [
        "trimf",
        "trapmf",
        "gaussmf",
        "gauss2mf",
        "gbellmf",
        "sigmf",
        "dsigmf",
        "psigmf",
        "zmf",
        "smf",
        "pimf",
        "linsmf",
        "linzmf",
        "constant",
        "linear",
    ]
)
"""What MATLAB reads; Octave's toolkit has these but for linsmf and linzmf."""

_WORDS = (*_ORDER, "discretemf", "constant", "linear", "function")

_NAMES = {kind: name for name, (kind, _) in reversed(_ORDER.items())} | {
    "arc": "Arc",
    "semi-ellipse": "SemiEllipse",
}
"""Kind of shape → name in the file; fuzzylite has no ``…mf`` for the last two."""


def fis_shape(kind: Word, rest: Word, inputs: int, findings: Findings) -> Shape | None:
    """Return the shape of ``'kind',[numbers]``."""
    name = kind.text.lower()
    if name == "function":
        text = rest.text.strip().removeprefix("[").removesuffix("]")
        return formula_shape(Word(text, rest.span), "fuzzylite", findings)
    if name not in _WORDS and kind.text not in FLL_SHAPES:
        _unknown(kind, findings)
        return None
    values = numbers(bracketed(rest), findings)
    return None if values is None else _of_numbers(kind, values, inputs, findings)


def _of_numbers(kind: Word, values: list[float], inputs: int, findings: Findings) -> Shape | None:
    name = kind.text.lower()
    if name == "constant":
        return make_shape("singleton", values[-1:], kind, findings)
    if name == "linear":
        return linear_shape(values, inputs, kind, findings)
    if name == "discretemf":
        height = values.pop() if len(values) % 2 else 1.0
        return make_shape("points", values, kind, findings, height=height, ties="last")
    shape, order = _ORDER[name] if name in _ORDER else _class(kind.text)
    height = values.pop() if len(values) == len(order) + 1 else 1.0
    if len(values) == len(order):
        values = [values[index] for index in order]
    if name in ("smf", "zmf"):
        values = _crossed(values)
    return make_shape(shape, values, kind, findings, height=height)


def _unknown(kind: Word, findings: Findings) -> None:
    if not kind.text:
        findings.error("syntax", "the kind of the membership function is missing", kind)
        return
    if kind.text.lower().endswith("mf"):
        message = f"'{kind.text[:40]}' is a function of its author's own, which is not in the file"
        findings.error("unknown-shape", message, kind)
        return
    findings.unknown("unknown-shape", "the membership function", kind, _WORDS)


def _class(name: str) -> tuple[str, tuple[int, ...]]:
    shape = FLL_SHAPES[name]
    return shape, tuple(range(len(SHAPES[shape].parameters)))


def _crossed(values: list[float]) -> list[float]:
    """MATLAB makes a step half-way of an s or z whose numbers are the wrong way round."""
    if len(values) == 2 and values[0] > values[1]:
        middle = 0.5 * (values[0] + values[1])
        return [middle, middle]
    return values


def fis_term(shape: Shape, producer: str) -> tuple[str, str]:
    """Return kind and bracketed numbers of a shape, as `producer` calls it."""
    if shape.kind == "formula":
        return "function", f"[{fuzzylite_formula(shape.formula)}]"
    height = () if shape.height == 1.0 else (shape.height,)
    if shape.kind == "singleton":
        return "constant", f"[{all_written(shape.parameters)}]"
    if shape.kind == "linear":
        return "linear", f"[{all_written(shape.parameters)}]"
    if shape.kind == "points":
        return "discretemf", f"[{all_written((*shape.parameters, *height))}]"
    name = _NAMES[shape.kind]
    if shape.kind == "ramp":
        name = "linsmf" if shape.parameters[0] <= shape.parameters[1] else "linzmf"
        name = "rampmf" if producer == "fuzzylite" else name
    _, order = _ORDER[name] if name in _ORDER else _class(name)
    values = [0.0] * len(order)
    for position, index in enumerate(order):
        values[index] = shape.parameters[position]
    return name, f"[{all_written((*values, *height))}]"


# --- Read FIS ---

_MEMBERSHIP_KEY = re.compile(r"MF(\d{1,6})\Z", re.IGNORECASE)


def parse_fis(
    text: str, path: str = "<text>", *, producer: str | None = None, lossy: bool = False
) -> Imported:
    """Read a fuzzy inference system of MATLAB, Octave or fuzzylite; never raises.

    Parameters
    ----------
    text : str
        Any text at all.
    path : str
        Name of the file, for the diagnostics.
    producer : {"matlab", "octave", "fuzzylite"}, optional
        Whose meaning to take where they differ (sampling, hedges, what no rule gives).
        By default what the text looks like, else MATLAB.
    lossy : bool
        Whether a loss that changes numbers is a warning rather than an error.

    Returns
    -------
    Imported
        The rule base where there is no error, and every finding.
    """
    refused = too_long(text, path)
    if refused is not None:
        return refused
    plain = text.replace("\r\n", "\n").replace("\r", "\n")
    return _Reader(plain, path, producer or detect(plain), lossy).read()


class _Reader:
    def __init__(self, text: str, path: str, producer: str, lossy: bool) -> None:
        self.text = text
        self.producer = producer
        self.findings = Findings(path, lossy=lossy)
        self.system = System()
        self.inputs: list[Draft] = []
        self.outputs: list[Draft] = []
        self.terms: dict[str, dict[int, str]] = {}
        self.rules: list[Word] = []
        self.seen: dict[tuple[str, int], Span] = {}

    def read(self) -> Imported:
        sections = fis_sections(self.text, self.findings)
        if not sections and not self.findings.failed:
            self.findings.error("no-engine", "there is no section like [System] in this file")
        inputs = sum(section.kind == "input" for section in sections)
        # [Input2] may stand before [Input1]; the rules go by number.
        for section in sorted(sections, key=lambda section: section.number):
            self._section(section, inputs)
        for draft in (*self.inputs, *self.outputs):
            draft.settle_range(self.findings)
        for draft in self.outputs:
            finish_output(draft, self.system, self.producer, self.findings)
        block = self._block()
        self._check_counts()
        self._notes()
        rulebase = None if self.findings.failed else self._rulebase(block)
        return Imported(rulebase, self.findings.all(), self.producer)

    def _rulebase(self, block: RuleBlock) -> RuleBase:
        return RuleBase(
            self.system.text("name"),
            tuple(draft.input() for draft in self.inputs),
            tuple(draft.output() for draft in self.outputs),
            (block,),
        )

    def _section(self, section: Section, inputs: int) -> None:
        key = (section.kind, section.number)
        if key in self.seen:
            message = (
                f"the section [{section.kind.capitalize()}{section.number or ''}] stands twice"
            )
            self.findings.error("duplicate-section", message, section.span)
            return
        self.seen[key] = section.span
        if section.kind == "system":
            self.system.read(section, self.findings)
        elif section.kind == "rules":
            self.rules = section.lines
        else:
            self._variable(section, inputs)

    def _variable(self, section: Section, inputs: int) -> None:
        count = len(self.inputs) + len(self.outputs)
        if not self.findings.room(count, MAX_VARIABLES, "variables", section.span):
            return
        is_output = section.kind == "output"
        draft = Draft(Word("", section.span), is_output)
        if is_output:
            draft.no_rule = math.nan
        taken: dict[int, str] = {}
        memberships: list[tuple[int, Word]] = []
        for line in section.lines:
            parts = key_and_value(line)
            if parts is None:
                message = f"'{line.text[:40]}' is no 'key=value'"
                self.findings.error("syntax", message, line)
                continue
            self._variable_setting(draft, *parts, memberships)
        self._name(draft, section)
        for index, value in memberships:
            self._term(draft, index, value, taken, inputs)
        self.terms[draft.name] = taken
        (self.outputs if is_output else self.inputs).append(draft)

    def _name(self, draft: Draft, section: Section) -> None:
        name = draft.name or f"{section.kind}{section.number or ''}"
        used = {d.name for d in (*self.inputs, *self.outputs)}
        unique = unique_name(name, used)
        if unique != draft.name:
            what = "has no name" if not draft.name else f"shares the name '{name}'"
            message = f"the {section.kind} {what}; it is called '{unique}'"
            name_ = "duplicate-variable" if draft.name else "missing-name"
            self.findings.warn(name_, message, draft.word)
        draft.word = Word(unique, draft.word.span)

    def _variable_setting(
        self, draft: Draft, key: Word, value: Word, memberships: list[tuple[int, Word]]
    ) -> None:
        membership = _MEMBERSHIP_KEY.match(key.text)
        match key.text.lower():
            case "name":
                draft.word = Word(unquoted(value).text, value.span)
            case "range":
                self._range(draft, value)
            case "nummfs":
                pass
            case "enabled":
                draft.enabled = number(value.text) == 1.0
            case "default" if draft.is_output:
                self._default(draft, value)
            case "lockprevious" if draft.is_output:
                if number(value.text) == 1.0:
                    draft.no_rule = "hold"
            case "lockrange":
                draft.outside = "clamp" if number(value.text) == 1.0 else "extend"
            case _ if membership:
                memberships.append((int(membership.group(1)), value))
            case _:
                self.findings.unknown("unknown-key", "the key", key, ("Name", "Range", "NumMFs"))

    def _default(self, draft: Draft, value: Word) -> None:
        default = number(value.text)
        if default is None:
            self.findings.error("not-a-number", f"'{value.text[:40]}' is not a number", value)
        elif draft.no_rule != "hold":
            draft.no_rule = default

    def _range(self, draft: Draft, value: Word) -> None:
        values = [number(word.text) for word in bracketed(value)]
        if len(values) != 2 or values[0] is None or values[1] is None:
            message = f"a range is two numbers in brackets, not '{value.text[:40]}'"
            self.findings.error("bad-range", message, value)
            return
        draft.low, draft.high = values[0], values[1]

    def _term(
        self, draft: Draft, index: int, value: Word, taken: dict[int, str], inputs: int
    ) -> None:
        parts = membership_parts(value)
        if parts is None:
            message = "a membership function is 'name':'kind',[numbers]"
            self.findings.error("syntax", message, value)
            return
        name, kind, rest = parts
        if index in taken:
            message = f"'{draft.name}' has two functions with the number {index}"
            self.findings.error("duplicate-index", message, value)
            return
        if not self.findings.room(len(taken), MAX_TERMS, "terms of a variable", value):
            return
        unique = unique_name(name.text or f"mf{index}", set(taken.values()))
        taken[index] = unique
        if name.text and unique != name.text:
            message = (
                f"'{draft.name}' has two terms called '{name.text}'; the rules tell them apart "
                f"by number, so this one is called '{unique}'"
            )
            self.findings.warn("duplicate-term-name", message, name)
        shape = fis_shape(kind, rest, inputs, self.findings)
        if shape is not None:
            draft.add(Term(unique, shape, name.span))

    def _block(self) -> RuleBlock:
        reader = RuleReader(
            tuple(self.inputs), tuple(self.outputs), self.terms, self.producer, self.findings
        )
        if len(self.rules) > MAX_RULES:
            self.findings.room(len(self.rules), MAX_RULES, "rules", self.rules[MAX_RULES])
        rules = self.rules[:MAX_RULES]
        texts = [text for line in rules if (text := reader.read(line)) is not None]
        drafts = {draft.name: draft for draft in (*self.inputs, *self.outputs)}
        return rules_in_model(texts, drafts, self.system, self.producer, self.findings)

    def _check_counts(self) -> None:
        for key, counted in (
            ("numinputs", len(self.inputs)),
            ("numoutputs", len(self.outputs)),
            ("numrules", len(self.rules)),
        ):
            word = self.system.values.get(key)
            if word is not None and number(word.text) != counted:
                message = f"the file says {word.text[:20]}, but there are {counted}"
                self.findings.warn("wrong-count", message, word)

    def _notes(self) -> None:
        if ("rules", 0) not in self.seen:
            self.findings.warn("no-rules", "the file has no [Rules]")
        match = rounded(self.text) if self.producer == "fuzzylite" else None
        if match is not None:
            line = self.text.count("\n", 0, match.start()) + 1
            column = match.start() - self.text.rfind("\n", 0, match.start())
            span = Span(line, column, line, column + len(match.group()))
            message = "every number of this file has three decimals, so some may be rounded"
            self.findings.info("rounded-number", message, span)
        message = {
            "fuzzylite": "read with the defaults of fuzzylite: 1000 midpoints, nan where no rule "
            "fires",
            "octave": "read with the defaults of Octave's toolkit: sums over 101 points, nan "
            "where no rule fires",
            "matlab": "read with the defaults of MATLAB: sums over 101 points, the middle of the "
            "range where no rule fires",
        }[self.producer]
        self.findings.info("assumed-producer", message, NOWHERE)
