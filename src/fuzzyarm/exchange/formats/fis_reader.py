"""FIS, the files of MATLAB's Fuzzy Logic Toolbox, Octave's toolkit and fuzzylite: read."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

from fuzzyarm.base.diagnostic import MAX_TERMS, Span
from fuzzyarm.base.numbers import counted
from fuzzyarm.exchange.formats.dialects import FIS, Dialect
from fuzzyarm.exchange.formats.drafts import (
    VariableDraft,
    imported,
    note_rounding,
)
from fuzzyarm.exchange.formats.findings import (
    MAX_RULES,
    MAX_VARIABLES,
    FaultError,
    Findings,
    Imported,
    TextPiece,
    number,
    unique_name,
)
from fuzzyarm.exchange.formats.fis_text import (
    BRACKETED,
    Section,
    detect,
    hedges_of,
    is_open,
    membership_parts,
    read_shape,
    read_shapes,
    sections,
    unquoted,
)
from fuzzyarm.exchange.formats.fis_type2 import (
    LOWER_KEY,
    MEMBERSHIP_KEY,
    interval_shapes,
    is_of_toolbox,
    note_toolbox,
    reductions,
)
from fuzzyarm.exchange.formats.meaning import BlockDraft
from fuzzyarm.exchange.formats.sentences import NOT, RuleText
from fuzzyarm.exchange.formats.system_reader import SystemReader
from fuzzyarm.language.model.rulebase import (
    And,
    Consequent,
    Defuzzifier,
    Expression,
    Hedge,
    Is,
    Or,
    RuleBase,
    Term,
)
from fuzzyarm.language.model.shapes import first_above

# --- Rules: a term index for each variable, weight, and 1 for and or 2 for or ---

_RULE = re.compile(
    r"(?P<inputs>[^,:()]*),(?P<outputs>[^,:()]*)(?:\((?P<weight>[^()]*)\))?\s*"
    r"(?::\s*(?P<connective>\S*))?\s*\Z"
)
_WORD = re.compile(r"\S+")

# --- Read FIS ---

_KEYS = (
    "name", "type", "version", "numinputs", "numoutputs", "numrules", "andmethod", "ormethod",
    "impmethod", "aggmethod", "defuzzmethod", "nummfs", "typeredmethod", "typereductionmethod",
    "outputtype",
)  # fmt: skip
_ENDING = re.compile(r"\)\s*:\s*\d\s*\Z")
"""Weight and connective of a rule."""

_VARIABLE_KEYS = ("Name", "Range", "NumMFs")
_TYPES = (
    "mamdani", "sugeno", "larsen", "takagi-sugeno", "tsukamoto", "inverse tsukamoto", "hybrid",
    "unknown",
)  # fmt: skip
"""Words for ``Type=``, fuzzylite's included; terms and defuzzifier decide."""


def parse_fis(
    text: str,
    path: str = "<text>",
    *,
    producer: str | None = None,
    lossy: bool = False,
    strict: bool = False,
) -> Imported:
    """Read a fuzzy inference system: :func:`~fuzzyarm.exchange.formats.registry.parse` of ``.fis``.

    Parameters
    ----------
    text, path, producer, lossy, strict
        As there.

    Returns
    -------
    Imported
        The rule base, if there is no error, and every finding.
    """

    def read(plain: str, findings: Findings) -> tuple[RuleBase | None, Dialect]:
        dialect = FIS[producer or detect(plain)]
        try:
            return _Reader(plain, dialect, findings).read(), dialect
        except FaultError as fault:
            findings.fault(fault)
            return None, dialect

    return imported(text, path, read, lossy=lossy, strict=strict)


class _Reader(SystemReader):
    """Reads the sections in the order of their numbers."""

    def __init__(self, text: str, dialect: Dialect, findings: Findings) -> None:
        super().__init__(dialect, findings)
        self.text = text
        self.settings: dict[str, TextPiece] = {}  # of [System], by keys in small letters
        self.terms: dict[str, dict[int, str]] = {}
        self.rules: list[TextPiece] = []
        self.spans: dict[tuple[str, int], Span] = {}
        self.unequal: list[TextPiece] = []  # rules with too many or too few numbers
        self.aggregation: str | None = None  # of all outputs
        self.is_type2 = False
        self.is_toolbox = is_of_toolbox(text)

    def read(self) -> RuleBase | None:
        fis_sections = sections(self.text, self.findings)
        systems = [section for section in fis_sections if section.kind == "system"]
        for section in systems:
            self._section(section, 0)
        if not self._has_known_type():
            return None
        inputs = sum(section.kind == "input" for section in fis_sections)
        # [Input2] may precede [Input1]; the rules use the numbers.
        for section in sorted(fis_sections, key=lambda section: section.number):
            if section.kind != "system":
                self._section(section, inputs)
        self._check_whole(systems)
        block = self._block()
        self.settle()
        self._read_rules(block)
        blocks = self.in_model([block])
        if self.dialect.producer == "fuzzylite":
            note_rounding(self.text, self.findings)
        return self.rulebase(self.text_of("name"), blocks)

    def _section(self, section: Section, inputs: int) -> None:
        key = (section.kind, section.number)
        if key in self.spans:
            message = (
                f"the section [{section.kind.capitalize()}{section.number or ''}] appears twice"
            )
            self.findings.error("duplicate-section", message, section.span)
            return
        self.spans[key] = section.span
        if section.kind == "system":
            self._system(section)
        elif section.kind == "rules":
            self.rules = section.lines
        elif section.kind in ("input", "output"):
            self._variable(section, inputs)

    def _settings(self, section: Section) -> Iterator[tuple[TextPiece, TextPiece]]:
        for line in section.lines:
            parts = line.around("=")
            if parts is None:
                message = f"'{line.text[:40]}' is not of the form 'key=value'"
                self.findings.error("syntax", message, line)
            elif is_open(parts[1].text):
                self.findings.error("syntax", "a quote or bracket is not closed", parts[1])
            else:
                yield parts

    # --- [System], and its consequences for the outputs ---

    def _system(self, section: Section) -> None:
        for key, value in self._settings(section):
            if key.text.lower() in _KEYS:
                self.settings[key.text.lower()] = unquoted(value)
            else:
                self.findings.ignored_key(key, _KEYS)

    def _has_known_type(self) -> bool:
        """Refuse an unknown type of system first, before findings about its parts."""
        word = self.settings.get("type")
        name = self.text_of("type").lower()
        if word is None or not name or name in _TYPES:
            return True
        if name.endswith("type2") and name[:3] in ("mam", "sug"):
            self.is_type2 = True
            message = (
                "the format of MATLAB's type-2 systems is not published; this reading is a guess"
            )
            self.findings.warn("guessed-type-2", message, word)
            return True
        self.findings.unknown("unknown-type", "the type of system", word, _TYPES)
        return False

    def text_of(self, key: str) -> str:
        word = self.settings.get(key)
        return word.text.strip() if word is not None else ""

    def _norm_of(
        self, key: str, norm: Callable[[TextPiece, str], str | None], usual: str
    ) -> str | None:
        """Return the norm of a setting; None if the file names none."""
        word = self.settings.get(key)
        if word is None or not word.text.strip():
            return None
        return norm(word, f"the {key}") or usual  # usual: misspelt

    def implication(self) -> str:
        """Return the implication, the minimum by default."""
        return super().implication() or "min"

    def method_name(self, draft: VariableDraft) -> str:
        """Return the defuzzifier of the whole file, optional in a Sugeno system."""
        draft.method = self.settings.get("defuzzmethod")
        name = self.text_of("defuzzmethod").lower()
        if not name:
            return "wtaver" if self.text_of("type").lower() == "sugeno" else self.dialect.method
        return name

    def finish_output(self, draft: VariableDraft, name: str) -> None:
        draft.aggregation, draft.aggregates = self.aggregation or "max", bool(self.aggregation)
        if self.is_type2:
            self._reduce_output(draft)
            return
        super().finish_output(draft, name)

    def _reduce_output(self, draft: VariableDraft) -> None:
        """Set the type reduction of an output, over 101 samples if it has sets."""
        is_sugeno = self.text_of("type").lower().startswith("sug")
        is_weighted = is_sugeno or self.text_of("defuzzmethod").lower() in self.dialect.weighted
        keys = ("typeredmethod", "typereductionmethod")
        word = next((self.settings[key] for key in keys if key in self.settings), draft.word)
        is_said = any(key in self.settings for key in keys)
        name = word.text.strip().lower() if is_said else ""
        methods = reductions()
        method = methods.get(name)
        if method is None:
            self.findings.unknown("unknown-defuzzifier", "the type reduction", word, methods)
            return
        if self.is_toolbox:
            # The toolbox starts from 0 where nothing fires; Nie and Tan divide by 0.
            draft.no_rule = 0.0 if method == "karnik-mendel" else math.nan
        elif _is_nan(draft.no_rule) and draft.bounded:
            draft.no_rule = 0.5 * (draft.low + draft.high)
        if is_weighted:
            draft.aggregation = "sum"
            draft.defuzzifier = Defuzzifier(method)
        else:
            draft.defuzzifier = Defuzzifier(method, *self.dialect.samples)

    # --- Variables and terms ---

    def _variable(self, section: Section, inputs: int) -> None:
        if not self.findings.room(len(self.variables), MAX_VARIABLES, "variables", section.span):
            return
        is_output = section.kind == "output"
        draft = VariableDraft(TextPiece("", section.span), is_output)
        if not is_output:
            draft.outside = self.dialect.outside
        names_by_index: dict[int, str] = {}
        memberships: list[tuple[int, TextPiece]] = []
        lower: dict[int, TextPiece] = {}
        counts: list[TextPiece] = []
        for key, value in self._settings(section):
            below = LOWER_KEY.match(key.text)
            if key.text.lower() == "nummfs":
                counts.append(value)
            elif below:
                lower[int(below.group(1))] = value
            else:
                self._variable_setting(draft, key, value, memberships)
        self._name(draft, section)
        memberships = self._numbered(draft, memberships, lower)
        names: set[str] = set()
        for index, value in memberships:
            # The numbers of an upper and a lower function may be followed by a height.
            dialect = FIS["fuzzylite"] if index in lower else self.dialect
            self._term(draft, index, value, names_by_index, names, inputs, dialect)
            if index in lower:
                self._lower(draft, lower.pop(index), inputs)
        for word in lower.values():
            message = "a lower membership function needs an upper one of the same number"
            self.findings.error("syntax", message, word)
        for word in counts[-1:]:
            self._check_count(word, len(memberships), "terms")
        self.terms[draft.name] = names_by_index
        self.variables[draft.name] = draft

    def _numbered(
        self,
        draft: VariableDraft,
        memberships: list[tuple[int, TextPiece]],
        lower: Mapping[int, TextPiece],
    ) -> list[tuple[int, TextPiece]]:
        """Renumber terms in their order if a number appears twice, as the programs do."""
        numbers = [number for number, _ in memberships]
        twice = next((n for i, n in enumerate(numbers) if n in numbers[:i]), None)
        if twice is None or lower:
            return memberships
        at = memberships[numbers.index(twice, numbers.index(twice) + 1)][1]
        message = (
            f"'{draft.name}' has two functions with the number {twice}; its terms are "
            f"numbered in their order, 1 to {len(numbers)}"
        )
        self.findings.warn("duplicate-index", message, at)
        return [(index, value) for index, (_, value) in enumerate(memberships, 1)]

    def _name(self, draft: VariableDraft, section: Section) -> None:
        name = draft.name or f"{section.kind}{section.number or ''}"
        unique = unique_name(name, set(self.variables))
        if unique != draft.name:
            fault = "has no name" if not draft.name else f"shares the name '{name}'"
            message = f"the {section.kind} {fault}; it is called '{unique}'"
            code = "duplicate-variable" if draft.name else "missing-name"
            self.findings.warn(code, message, draft.word)
        draft.word = TextPiece(unique, draft.word.span)

    def _variable_setting(
        self,
        draft: VariableDraft,
        key: TextPiece,
        value: TextPiece,
        memberships: list[tuple[int, TextPiece]],
    ) -> None:
        membership = MEMBERSHIP_KEY.match(key.text)
        match key.text.lower():
            case "name":
                draft.word = TextPiece(unquoted(value).text, value.span)
            case "range":
                draft.set_range(
                    value.parts(BRACKETED), value, self.findings, "two numbers in brackets"
                )
            case "enabled":
                draft.enabled = number(value.text) == 1.0
            case "default" if draft.is_output:
                self.default(draft, value)
            case "lockprevious" if draft.is_output:
                if number(value.text) == 1.0:
                    draft.no_rule = "hold"
            case "crispinterval" if draft.is_output and self.is_toolbox:
                pass  # the value is the middle of the ends, as in the model
            case "lockrange":
                draft.outside = "clamp" if number(value.text) == 1.0 else "extend"
            case _ if membership:
                memberships.append((int(membership.group(1)), value))
            case _:
                self.findings.ignored_key(key, _VARIABLE_KEYS)

    def _term(
        self,
        draft: VariableDraft,
        index: int,
        value: TextPiece,
        names_by_index: dict[int, str],
        names: set[str],
        inputs: int,
        dialect: Dialect,
    ) -> None:
        parts = membership_parts(value)
        if parts is None:
            message = "a membership function is 'name':'kind',[numbers]"
            self.findings.error("syntax", message, value)
            return
        name, kind, rest = parts
        if index in names_by_index:
            message = f"'{draft.name}' has two functions with the number {index}"
            self.findings.error("duplicate-index", message, value)
            return
        unique = unique_name(name.text or f"mf{index}", names)
        names.add(unique)
        names_by_index[index] = unique  # rules may also refer to a refused term
        if not self.findings.room(len(names_by_index) - 1, MAX_TERMS, "terms of a variable", value):
            return
        if name.text and unique != name.text:
            message = (
                f"'{draft.name}' has two terms called '{name.text}'; the rules tell them apart "
                f"by number, so this one is called '{unique}'"
            )
            self.findings.warn("duplicate-term-name", message, name)
        shapes = None
        if self.is_toolbox and draft.is_output:
            shapes = interval_shapes(kind, rest, inputs, self.findings)
        shapes = shapes or read_shapes(kind, rest, inputs, dialect, self.findings)
        if shapes is not None:
            self.is_type2 = self.is_type2 or shapes[1] is not None
            draft.add(Term(unique, shapes[0], name.span, shapes[1]))

    def _lower(self, draft: VariableDraft, value: TextPiece, inputs: int) -> None:
        """Set the lower function of the last term: numbers, perhaps a height."""
        parts = membership_parts(value)
        if parts is None or not draft.terms:
            message = "a membership function is 'name':'kind',[numbers]"
            self.findings.error("syntax", message, value)
            return
        _, kind, rest = parts
        shape = read_shape(kind, rest, inputs, FIS["fuzzylite"], self.findings)
        term = draft.terms[-1]
        if shape is None:
            return
        self.is_type2 = True
        position = first_above(shape, term.shape, draft.low, draft.high)
        if position is not None:
            message = (
                f"the lower function of '{term.name}' is above the upper one at {position:.6g}"
            )
            self.findings.error("lower-above-upper", message, value)
        draft.put(len(draft.terms) - 1, replace(term, lower=shape))

    # --- Rules ---

    def _block(self) -> BlockDraft:
        """Return the one block of the file, with its norms."""
        block = BlockDraft("", threshold=self.dialect.threshold)
        block.conjunction = self._norm_of("andmethod", self.tnorm, "min")
        block.disjunction = self._norm_of("ormethod", self.snorm, "max")
        block.implication = self._norm_of("impmethod", self.tnorm, "min")
        self.aggregation = self._norm_of("aggmethod", self.snorm, "max")
        self.blocks = [block]
        return block

    def _read_rules(self, block: BlockDraft) -> None:
        if len(self.rules) > MAX_RULES:
            self.findings.room(len(self.rules), MAX_RULES, "rules", self.rules[MAX_RULES])
        rules = self.rules[:MAX_RULES]
        block.rules = [text for line in rules if (text := self._rule(line)) is not None]
        if self.unequal and not self.findings.is_damaged:
            inputs, outputs = len(self.inputs), len(self.outputs)
            counts = f"{counted(inputs, 'input')} and {counted(outputs, 'output')}"
            more = f" (and {len(self.unequal) - 1} other rules)" if len(self.unequal) > 1 else ""
            message = f"the rule does not have a number for each of {counts}{more}"
            self.findings.error("wrong-count", message, self.unequal[0])
        if self.is_toolbox and self.is_type2:
            note_toolbox(block, self.settings, self.findings)

    def _rule(self, line: TextPiece) -> RuleText | None:
        match = _RULE.match(line.text)
        if match is None:
            message = "a rule is 'inputs, outputs (weight) : connective'"
            self.findings.error("syntax", message, line)
            return None
        inputs = line.part(*match.span("inputs")).parts(_WORD)
        outputs = line.part(*match.span("outputs")).parts(_WORD)
        if len(inputs) != len(self.inputs) or len(outputs) != len(self.outputs):
            self.unequal.append(line)
            return None
        weight, is_or = self._weight(match, line), self._is_or(match, line)
        conditions = [Is(*proposition) for proposition in self._propositions(self.inputs, inputs)]
        conclusions = [
            Consequent(*proposition) for proposition in self._propositions(self.outputs, outputs)
        ]
        if not conditions or not conclusions:
            side, codes = ("condition", inputs) if not conditions else ("conclusion", outputs)
            if all(number(code.text) == 0.0 for code in codes):  # else a code has its own finding
                message = f"the rule has no {side} and never does anything; it is left out"
                self.findings.warn("empty-rule", message, line)
            return None
        antecedent: Expression = conditions[0]
        if len(conditions) > 1:
            antecedent = Or(tuple(conditions)) if is_or else And(tuple(conditions))
        return RuleText(antecedent, tuple(conclusions), weight, line.span)

    def _propositions(
        self, drafts: list[VariableDraft], codes: list[TextPiece]
    ) -> Iterator[tuple[str, str, tuple[Hedge, ...], Span]]:
        """Yield variable, term, hedges and span of each valid index other than 0."""
        for draft, word in zip(drafts, codes, strict=True):
            term = self._indexed(draft, word)
            if term is not None:
                yield draft.name, *term, word.span

    def _indexed(
        self, draft: VariableDraft, word: TextPiece
    ) -> tuple[str, tuple[Hedge, ...]] | None:
        """Return term and hedges of an index; None for 0 or an invalid one."""
        value = number(word.text)
        if value is None or math.isnan(value) or abs(value) > 1e6:
            self.findings.error("not-a-number", f"'{word.text[:40]}' is not a term index", word)
            return None
        index = int(abs(value))
        fraction = round(abs(value) - index, 6)
        if value == 0.0:
            return None
        hedges = hedges_of(fraction, self.dialect)
        if hedges is None:
            message = f"no hedge is known for the fraction {fraction}"
            self.findings.error("unknown-hedge", message, word)
            return None
        table = self.terms.get(draft.name, {})
        if hedges and hedges[0].name == "any" and index == 0 and table:
            index = min(table)
        if index not in table:
            count = counted(len(table), "term")
            message = f"'{draft.name}' has {count}, so none has the number {index}"
            if not self.findings.is_damaged:
                self.findings.error("undefined-term", message, word)
            return None
        return table[index], ((NOT, *hedges) if value < 0.0 else hedges)

    def _weight(self, match: re.Match[str], line: TextPiece) -> float:
        text = match.group("weight")
        value = number(text.strip()) if text is not None else 1.0
        if text is None:
            message = "the rule has no weight in parentheses; 1 is taken"
            self.findings.warn("missing-weight", message, line)
        elif value is None or math.isnan(value):
            message = f"'{text[:40]}' is not a weight"
            self.findings.error("not-a-number", message, line)
        return 1.0 if value is None or math.isnan(value) else value

    def _is_or(self, match: re.Match[str], line: TextPiece) -> bool:
        text = match.group("connective")
        value = number(text) if text else None
        if value not in (1.0, 2.0):
            if text:
                message = f"the connective must be 1 (and) or 2 (or), not '{text[:40]}'"
                self.findings.error("bad-connective", message, line)
            else:
                message = "the rule has no connective; 1 (and) is taken"
                self.findings.warn("bad-connective", message, line)
        return value == 2.0

    # --- Consistency of the file ---

    def _check_whole(self, systems: Sequence[Section]) -> None:
        """Report a truncated file once: it has fewer items than announced."""
        counts = (
            ("numinputs", len(self.inputs), "inputs"),
            ("numoutputs", len(self.outputs), "outputs"),
            ("numrules", len(self.rules), "rules"),
        )
        if not systems:
            self.findings.error("no-engine", "this file has no section [System]")
            return
        for key, found, items in counts:
            word = self.settings.get(key)
            if word is not None and not self._check_count(word, found, items):
                return
        system = systems[0].span  # [System1] is one, too
        ends = [bool(_ENDING.search(self.rules[index].text)) for index in (0, -1) if self.rules]
        if not self.inputs or not self.outputs:
            missing = "input" if not self.inputs else "output"
            self.findings.error("no-engine", f"there is no {missing} in this file", system)
        elif ("rules", 0) not in self.spans:
            self.findings.error("no-rules", "this file has no section [Rules]", system)
        elif ends == [True, False]:
            message = "the last rule lacks the ending of the others: the file is cut off"
            self.findings.error("syntax", message, self.rules.pop())

    def _check_count(self, word: TextPiece, found: int, items: str) -> bool:
        """Compare an announced count with the file; return whether nothing is missing."""
        count = number(word.text)
        if count == found:
            return True
        message = f"the file says {word.text[:20]} {items}, but there are {found}"
        if count is not None and count < found:
            self.findings.warn("wrong-count", f"{message}, which are all read", word)
            return True
        # All rules up to the last are complete; a larger count alone proves nothing.
        if items == "rules" and self.rules and _ENDING.search(self.rules[-1].text):
            self.findings.warn("wrong-count", message, word, "is the file cut off?")
            return True
        if not self.findings.has("syntax"):  # else the unreadable parts are the missing ones
            self.findings.error("wrong-count", message, word, "is the file cut off?")
        return False


def _is_nan(value: float | str) -> bool:
    return isinstance(value, float) and math.isnan(value)
