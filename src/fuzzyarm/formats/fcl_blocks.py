"""FCL, its function blocks: variables, terms, rules, and what they mean to each program."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from fuzzyarm.expression.kinds import SNORMS, TNORMS
from fuzzyarm.formats.dialects import JFUZZYLOGIC_PAIRS, Dialect, words
from fuzzyarm.formats.drafts import (
    VALUES,
    Draft,
    add_term,
    note_ties,
    rulebase_of,
    settle_maximum,
    settle_weighted,
)
from fuzzyarm.formats.fcl_samples import settle_edges
from fuzzyarm.formats.fcl_text import (
    MEAN_OF_MAXIMUM,
    SECTION_ENDS,
    SECTIONS,
    Cursor,
    fcl_words,
    read_shape,
)
from fuzzyarm.formats.findings import (
    MAX_RULES,
    MAX_VARIABLES,
    FaultError,
    Findings,
    Word,
    number,
)
from fuzzyarm.formats.meaning import Block, blocks_in_model, is_on
from fuzzyarm.formats.sentences import RuleText, read_sentences
from fuzzyarm.formats.shapes import estimated_range
from fuzzyarm.formats.values import formulas_of_input, values_as_sets
from fuzzyarm.model.rulebase import Defuzzifier, RuleBase

# --- A function block while it is read ---


@dataclass(slots=True)
class BlockText:
    """A rule block as it was written: norms by AND, OR, ACT and ACCU, rules from IF on."""

    word: Word
    norms: list[tuple[str, Word]] = field(default_factory=list)
    rules: list[list[Word]] = field(default_factory=list)
    enabled: bool = True
    named: dict[str, str] | None = None  # the norms in the model, once they are asked for


@dataclass(slots=True)
class FunctionBlock:
    """A function block; methods and accumulations by the name of the output."""

    word: Word
    variables: dict[str, Draft] = field(default_factory=dict)
    methods: dict[str, Word] = field(default_factory=dict)
    accumulations: dict[str, str] = field(default_factory=dict)
    blocks: list[BlockText] = field(default_factory=list)


def _joined_numbers(words: list[Word]) -> list[Word]:
    """Put the sign of a weight back to its number."""
    if len(words) > 2 and words[-2].text in ("-", "+"):
        sign, value = words[-2], words[-1]
        words[-2:] = [Word(sign.text + value.text, sign.span.to(value.span))]
    return words


# --- Words ---

_END_OF_RULE = frozenset({";", "RULE", "END_RULEBLOCK", "END_FUNCTION_BLOCK", *SECTIONS})
_END_OF_TITLE = frozenset({*SECTIONS, *SECTION_ENDS, "OPTIONS", "OPTION"})
_STATEMENTS = frozenset({"TERM", "RANGE", "METHOD", "ACCU", "DEFAULT", "ENABLED", "LOCK"})
_BLOCK_SETTINGS = frozenset({"AND", "OR", "ACT", "ACCU", "RULE", "ENABLED"})
_METHODS_OF_OTHERS = {"MOM": "MM", "SOM": "LM", "LOM": "RM"}
_S_TO_T = {s: t for t, s in JFUZZYLOGIC_PAIRS.items()}
_OPTIONS = {"OPTIONS": "END_OPTIONS", "OPTION": "END_OPTION"}


class Reader:
    """Reads function blocks as jFuzzyLogic or fuzzylite does, by its dialect."""

    def __init__(self, text: str, dialect: Dialect, findings: Findings) -> None:
        self.findings = findings
        self.dialect = dialect
        self.cursor = Cursor(fcl_words(text, findings))
        self.blocks: list[FunctionBlock] = []
        self.block = FunctionBlock(Word(""))  # the one that is read or settled

    @property
    def _own(self) -> bool:
        """Whether fuzzylite's meaning counts, else jFuzzyLogic's."""
        return self.dialect.producer == "fuzzylite"

    def read(self, wanted: str | None) -> RuleBase | None:
        """Return the rule base of one function block, the first where none is `wanted`."""
        while not self.cursor.ended:
            try:
                self._section()
            except FaultError as fault:
                self.findings.fault(fault)
                self._to_next_section()
        block = self._chosen(wanted)
        if block is None:
            return None
        self.block = block
        return self._rulebase()

    def _chosen(self, wanted: str | None) -> FunctionBlock | None:
        if not self.blocks:
            if not self.findings.failed:
                self.findings.error("no-engine", "there is no FUNCTION_BLOCK in this file")
            return None
        names = [block.word.text for block in self.blocks]
        if wanted is not None and wanted not in names:
            self.findings.unknown("unknown-block", "the function block", Word(wanted), names)
            return None
        chosen = self.blocks[names.index(wanted) if wanted is not None else 0]
        for other in self.blocks:
            if other is not chosen:
                message = f"the function block '{other.word.text}' is left out"
                self.findings.warn("several-blocks", message, other.word)
        return chosen

    def _section(self) -> None:
        cursor = self.cursor
        key = cursor.key()
        if key == "FUNCTION_BLOCK":
            cursor.take()
            self.blocks.append(FunctionBlock(cursor.title(_END_OF_TITLE)))
            cursor.skip(";")
        elif key == "END_FUNCTION_BLOCK":
            cursor.take()
            cursor.skip(";")
            self._between_blocks()
        elif key in SECTIONS:
            self._inner(key)
        elif key in _OPTIONS:
            word = cursor.take()
            while not cursor.ended and not cursor.skip(_OPTIONS[key]):
                cursor.take()
            self.findings.info("dropped-options", "the options are left out", word)
        elif key == "RULE" and not self.blocks:
            message = (
                "there are rules here but no variables: VAR_INPUT, VAR_OUTPUT, FUZZIFY and "
                "DEFUZZIFY, which say what the words of the rules mean, are not in this file"
            )
            self.findings.error("no-variables", message, cursor.word)
            cursor.at = len(cursor.words)
        else:
            found = cursor.word.text[:40]
            message = f"a section such as FUZZIFY or RULEBLOCK is expected here, not '{found}'"
            raise FaultError(message, cursor.word)

    def _between_blocks(self) -> None:
        """Leave out what stands behind a function block, up to the next one."""
        first = self.cursor.word
        if self.cursor.ended or self.cursor.key() == "FUNCTION_BLOCK":
            return
        while not self.cursor.ended and self.cursor.key() != "FUNCTION_BLOCK":
            self.cursor.take()
        message = "the text behind END_FUNCTION_BLOCK is left out"
        self.findings.warn("trailing-text", message, first)

    def _inner(self, key: str) -> None:
        if not self.blocks:
            self.blocks.append(FunctionBlock(Word("", self.cursor.word.span)))
        self.block = self.blocks[-1]
        self.cursor.take()
        if key in ("VAR_INPUT", "VAR_OUTPUT"):
            self._declarations(is_output=key == "VAR_OUTPUT")
        elif key in ("FUZZIFY", "DEFUZZIFY"):
            self._fuzzify(is_output=key == "DEFUZZIFY")
        else:
            text = self._rule_block()
            count = len(self.block.blocks)
            if self.findings.room(count, MAX_VARIABLES, "rule blocks", text.word):
                self.block.blocks.append(text)

    def _to_next_section(self) -> None:
        cursor = self.cursor
        cursor.at += not cursor.ended
        while not cursor.ended:
            if cursor.key() in SECTIONS or cursor.key() == "END_FUNCTION_BLOCK":
                return
            cursor.take()

    def _is_over(self, end: str) -> bool:
        """Whether a section ends here; say so where its end is missing and the next one begins."""
        cursor = self.cursor
        if cursor.skip(end):
            return True
        if cursor.ended:
            raise FaultError(f"'{end}' is missing: is the file cut off?", cursor.word)
        if cursor.key() not in (*SECTIONS, *SECTION_ENDS):
            return False
        word = cursor.word
        message = f"'{end}' is missing before '{word.text}'"
        if cursor.key() not in (*SECTIONS, "END_FUNCTION_BLOCK"):
            message = f"'{word.text}' is taken for '{end}', which is missing"
            cursor.take()
        self.findings.warn("missing-end", message, word)
        return True

    # --- Variables ---

    def _declarations(self, *, is_output: bool) -> None:
        """Read from behind VAR_INPUT or VAR_OUTPUT to behind END_VAR."""
        cursor = self.cursor
        last: Draft | None = None
        while not self._is_over("END_VAR"):
            if cursor.key() == "RANGE" and last is not None:
                self._range(last)
                continue
            word = cursor.name("a variable")
            if word.text in self.block.variables:
                message = f"there are two variables called '{word.text}'"
                self.findings.error("duplicate-variable", message, word)
            last = Draft(word, is_output)
            if self.findings.room(len(self.block.variables), MAX_VARIABLES, "variables", word):
                last = self.block.variables.setdefault(word.text, last)
            cursor.expect(":")
            while not cursor.ended and cursor.word.text != ";" and cursor.key() != "END_VAR":
                if cursor.word.span.line != word.span.line:
                    break
                cursor.take()
            cursor.skip(";")

    def _fuzzify(self, *, is_output: bool) -> None:
        """Read from behind FUZZIFY or DEFUZZIFY to behind its end."""
        cursor = self.cursor
        end = "END_DEFUZZIFY" if is_output else "END_FUZZIFY"
        draft = self._variable(is_output=is_output)
        while not self._is_over(end):
            start = cursor.at
            try:
                self._statement(draft)
            except FaultError as fault:
                self.findings.fault(fault)
                ends = cursor.key() in (end, *SECTIONS, *_STATEMENTS)
                cursor.at += not ends or cursor.at == start
                cursor.to_next_statement()

    def _variable(self, *, is_output: bool) -> Draft:
        word = self.cursor.name("a variable")
        draft = self.block.variables.get(word.text)
        if draft is None:
            kind = "VAR_OUTPUT" if is_output else "VAR_INPUT"
            message = f"'{word.text}' is not declared in {kind}"
            self.findings.warn("undeclared-variable", message, word)
            draft = Draft(word, is_output)
            if self.findings.room(len(self.block.variables), MAX_VARIABLES, "variables", word):
                self.block.variables[word.text] = draft
        if draft.is_output != is_output:
            kind = "output" if draft.is_output else "input"
            message = f"'{word.text}' is declared as an {kind}"
            self.findings.error("wrong-section", message, word)
        return draft

    def _statement(self, draft: Draft) -> None:
        cursor = self.cursor
        inputs = sum(not d.is_output for d in self.block.variables.values())
        match cursor.key():
            case "TERM":
                cursor.take()
                word = cursor.name("a term")
                cursor.skip(":=", "=", ":")
                draft.refused.add(word.text)  # unless what follows is a function
                shape = read_shape(cursor, self.dialect, inputs, self.findings)
                if shape is not None:
                    draft.refused.discard(word.text)
                    keep = "first" if self._own else "last"
                    add_term(draft, word, shape, self.findings, keep=keep)
            case "RANGE":
                self._note_range(draft)
                self._range(draft)
            case "ENABLED":
                cursor.end_key()
                draft.enabled = cursor.take().text.upper() != "FALSE"
            case "METHOD" if draft.is_output:
                cursor.end_key()
                self.block.methods[draft.name] = cursor.name("a method")
            case "ACCU" if draft.is_output:
                self._accumulation(draft)
            case "DEFAULT" if draft.is_output:
                self._default(draft)
            case "LOCK" if draft.is_output:
                self._lock(draft)
            case _:
                found = cursor.word.text[:40]
                message = f"TERM, RANGE and the like are expected here, not '{found}'"
                raise FaultError(message, cursor.word)
        if not cursor.skip(";") and cursor.word.text not in ("", ";"):
            self._after_statement()

    def _after_statement(self) -> None:
        """Complain where a statement goes on after its end."""
        cursor = self.cursor
        if cursor.at and cursor.word.span.line == cursor.words[cursor.at - 1].span.line:
            word = cursor.word
            if not cursor.key().startswith(("END_", "TERM", "RANGE", "METHOD")):
                raise FaultError(f"';' is expected before '{word.text[:40]}'", word)

    def _note_range(self, draft: Draft) -> None:
        """Say that jFuzzyLogic knows the range of an input behind its declaration only."""
        if draft.is_output or self._own:
            return
        message = f"{self.dialect.program} refuses a RANGE inside FUZZIFY; it is read all the same"
        hint = "--from fuzzylite or scikit-fuzzy, whose files have it there"
        self.findings.warn("misplaced-range", message, self.cursor.word, hint)

    def _range(self, draft: Draft) -> None:
        cursor = self.cursor
        cursor.end_key()
        cursor.expect("(")
        draft.low = cursor.number()
        cursor.expect("..", ",")
        draft.high = cursor.number()
        cursor.expect(")")
        draft.step = None
        if cursor.key() == "WITH":
            self._step(draft, cursor.take())
        cursor.skip(";")

    def _step(self, draft: Draft, word: Word) -> None:
        """Read the number behind WITH, which only fcl-for-scikit-fuzzy has."""
        self.cursor.number()
        message = f"the step of '{draft.name}' is left out: {self.dialect.program} has none"
        self.findings.warn("dropped-step", message, word)

    def _accumulation(self, draft: Draft) -> None:
        cursor = self.cursor
        cursor.end_key()
        word = cursor.name("a norm")
        if word.text.upper() == "NONE":
            return
        table = words(SNORMS, "fcl", "jfl")
        norm = self.findings.norm("the accumulation", word, table, word.text.upper())
        if norm is not None:
            self.block.accumulations[draft.name] = norm

    def _default(self, draft: Draft) -> None:
        cursor = self.cursor
        cursor.end_key()
        if cursor.skip("NC"):
            draft.no_rule = "hold"
            return
        if cursor.key() in ("NAN", "INF"):
            draft.no_rule = number(cursor.take().text) or math.nan
        else:
            draft.no_rule = cursor.number()
        if cursor.skip("|") and cursor.skip("NC"):
            message = "the value is held; the default counts only before the first value"
            self.findings.loss("default-with-hold", message, draft.word, slight=True)
            draft.no_rule = "hold"

    def _lock(self, draft: Draft) -> None:
        cursor = self.cursor
        cursor.end_key()
        while cursor.key() in ("PREVIOUS", "RANGE", "NONE", "|"):
            word = cursor.take().text.upper()
            if word == "PREVIOUS":
                draft.no_rule = "hold"
            elif word == "RANGE":
                draft.outside = "clamp"

    # --- Rule blocks ---

    def _rule_block(self) -> BlockText:
        """Read from behind RULEBLOCK to behind END_RULEBLOCK."""
        cursor = self.cursor
        end_of_title = _END_OF_TITLE | _BLOCK_SETTINGS
        block = BlockText(cursor.title(end_of_title, setting=True))
        cursor.skip(";")
        while not self._is_over("END_RULEBLOCK"):
            try:
                self._block_statement(block)
            except FaultError as fault:
                self.findings.fault(fault)
                cursor.at += cursor.key() not in _END_OF_RULE
                cursor.to_next_statement()
        return block

    def _block_statement(self, block: BlockText) -> None:
        cursor = self.cursor
        key = cursor.key()
        if key in ("AND", "OR", "ACT", "ACCU"):
            cursor.end_key()
            block.norms.append((key, cursor.name("a norm")))
            cursor.skip(";")
        elif key == "ENABLED":
            cursor.end_key()
            block.enabled = cursor.take().text.upper() != "FALSE"
            cursor.skip(";")
        elif key == "RULE":
            start = cursor.take()
            words = self._rule_words(start)
            if self.findings.room(len(block.rules), MAX_RULES, "rules", start):
                block.rules.append(words)
        else:
            message = f"RULE, AND and the like are expected here, not '{cursor.word.text[:40]}'"
            raise FaultError(message, cursor.word)

    def _rule_words(self, start: Word) -> list[Word]:
        cursor = self.cursor
        while not cursor.ended and cursor.key() not in ("IF", *_END_OF_RULE):
            cursor.take()
        words: list[Word] = []
        while not cursor.ended and cursor.key() not in _END_OF_RULE:
            words.append(cursor.take())
        cursor.skip(";")
        if not words:
            raise FaultError("the rule has no IF", start)
        return _joined_numbers(words)

    def _norms_of(self, text: BlockText) -> dict[str, str]:
        """Return the norms of a block, with their findings the first time."""
        if text.named is None:
            text.named = self._norms(text)
        return text.named

    def _norms(self, text: BlockText) -> dict[str, str]:
        """Return the norms that a block names, by AND, OR, ACT and ACCU."""
        found: dict[str, str] = {}
        for key, word in text.norms:
            table = words(TNORMS if key in ("AND", "ACT") else SNORMS, "fcl", "jfl")
            name = word.text.upper()
            if name == "NONE":
                continue
            norm = self.findings.norm(f"the norm for {key}", word, table, name)
            if norm is None:
                continue
            if not self._own and key in ("AND", "OR"):
                self._pair(found, key, norm, word)
            found[key] = norm
        return found

    def _pair(self, found: dict[str, str], key: str, norm: str, word: Word) -> None:
        """Set OR with AND and AND with OR, as jFuzzyLogic does."""
        other = "OR" if key == "AND" else "AND"
        table = JFUZZYLOGIC_PAIRS if key == "AND" else _S_TO_T
        partner = table.get(norm)
        if partner is None:
            return
        if other in found and found[other] != partner:
            message = f"to jFuzzyLogic this sets {other} to {partner} too, whatever stood there"
            self.findings.warn("paired-norms", message, word)
        found[other] = partner

    def _accumulate(self, rules: list[RuleText], accumulation: str | None) -> None:
        """Set the aggregation of the outputs that rules conclude from ACCU in their block."""
        if accumulation is None and self._own:
            return
        norm = accumulation or "sum"
        for rule in rules:
            for conclusion in rule.conclusions:
                draft = self.block.variables.get(conclusion.variable)
                if draft is None or not draft.is_output:
                    continue
                draft.aggregation = self.block.accumulations.setdefault(draft.name, norm)
                draft.aggregates = True
                if draft.aggregation != norm and not self._own:
                    message = f"two blocks accumulate '{draft.name}' by different norms"
                    self.findings.loss("mixed-accumulation", message, conclusion.span)

    # --- From the text to the model ---

    def _rulebase(self) -> RuleBase:
        block = self.block
        for draft in block.variables.values():
            self._settle(draft)
        blocks = [each for text in block.blocks if is_on(each := self._block(text), self.findings)]
        in_model = blocks_in_model(blocks, block.variables, self.dialect, self.findings)
        if not any(rule_block.rules for rule_block in in_model):
            self.findings.warn("no-rules", "the function block has no rules", block.word)
        return rulebase_of(block.word.text, block.variables.values(), in_model)

    def _block(self, text: BlockText) -> Block:
        block = Block(text.word.text, text.word.span, text.enabled)
        if not block.enabled:
            return block
        norms = self._norms_of(text)
        block.conjunction, block.disjunction = norms.get("AND"), norms.get("OR")
        block.implication, block.threshold = norms.get("ACT"), self.dialect.threshold
        block.rules = self._sentences(text.rules)
        self._accumulate(block.rules, norms.get("ACCU"))
        return block

    def _sentences(self, rules: list[list[Word]]) -> list[RuleText]:
        return read_sentences(rules, self.block.variables, self.findings, self.dialect)

    def _settle(self, draft: Draft) -> None:
        if draft.is_output:
            accumulation = self.block.accumulations.get(draft.name)
            draft.aggregation = accumulation or "sum"
            draft.aggregates = accumulation is not None
            self._finish_output(draft, self.block.methods.get(draft.name))
        if math.isinf(draft.low) and math.isinf(draft.high):
            self._estimate(draft)
        draft.settle_range(self.findings)
        at = self.block.methods.get(draft.name, draft.word)
        if not draft.is_output:
            formulas_of_input(draft, self.findings)
        elif self._own:
            settle_maximum(draft, at, self.findings)
            if draft.integrates:
                values_as_sets(draft, self._implication(), at, self.findings)
        else:
            settle_edges(draft, self.findings)

    def _implication(self) -> str | None:
        """Return the implication of all rule blocks that are on, if it is the same."""
        found = {self._norms_of(text).get("ACT") for text in self.block.blocks if text.enabled}
        return found.pop() if len(found) == 1 else None

    def _finish_output(self, draft: Draft, method: Word | None) -> None:
        """Set the defuzzifier of an output from its ``METHOD``."""
        dialect = self.dialect
        at = method if method is not None else draft.word
        name = self._method_name(draft, method.text.upper() if method is not None else "COG", at)
        if name in dialect.weighted:
            self._weighted(draft, name, at)
        elif name in dialect.integral:
            self._integrated(draft, name, at)
        else:
            methods = (*dialect.integral, *dialect.weighted)
            word = Word(name, at.span)
            self.findings.unknown("unknown-defuzzifier", "the method", word, methods)

    def _method_name(self, draft: Draft, name: str, at: Word) -> str:
        """Return the word for a method that the program has, with a warning for another one."""
        program, findings = self.dialect.program, self.findings
        if name in _METHODS_OF_OTHERS and name not in self.dialect.integral:
            message = f"{program} has no method {name}; it is read as {_METHODS_OF_OTHERS[name]}"
            findings.warn("guessed-defuzzifier", message, at)
            return _METHODS_OF_OTHERS[name]
        if name == "COG" and draft.kinds and draft.kinds <= VALUES and not self._own:
            message = f"the terms of '{draft.name}' are values; {program} refuses to integrate them"
            hint = "read as METHOD : COGS, which is for singletons"
            findings.warn("value-as-set", message, at, hint)
            return "COGS"
        return name

    def _weighted(self, draft: Draft, name: str, at: Word) -> None:
        method = self.dialect.weighted[name]
        if self._own:
            settle_weighted(draft, method, "Automatic", at, self.findings)
            return
        if not draft.kinds <= VALUES:
            message = f"'{draft.name}' has sets where {name} needs singletons or functions"
            self.findings.error("set-as-value", message, at)
        draft.defuzzifier = Defuzzifier(method)

    def _integrated(self, draft: Draft, name: str, at: Word) -> None:
        draft.defuzzifier = Defuzzifier(self.dialect.integral[name], *self.dialect.samples)
        self._note_habits(draft, name, at)
        if draft.kinds & VALUES and not self._own:
            message = f"'{draft.name}' has values for terms but integrates sets"
            self.findings.loss("value-as-set", message, at, "METHOD : COGS is for singletons")

    def _note_habits(self, draft: Draft, name: str, at: Word) -> None:
        """Say in what the methods of jFuzzyLogic differ from those of the model."""
        if self._own:
            return
        if name == "COA":
            message = "jFuzzyLogic finds the middle of the area one sample coarser than the model"
            self.findings.loss("bisector-rule", message, at, slight=True)
        elif name == "MM":
            self.findings.loss("mean-of-maximum", MEAN_OF_MAXIMUM, at, slight=True)
        elif name in ("LM", "RM"):
            note_ties(draft, at, self.findings)

    def _estimate(self, draft: Draft) -> None:
        integrated = draft.is_output and draft.defuzzifier.resolution is not None
        estimate = estimated_range([term.shape for term in draft.terms])
        if estimate is not None and all(map(math.isfinite, estimate)):
            draft.low, draft.high = estimate
            if integrated:
                message = (
                    f"'{draft.name}' has no RANGE; its terms reach from {estimate[0]} to "
                    f"{estimate[1]}"
                )
                self.findings.info("estimated-range", message, draft.word)
        elif integrated and draft.terms:
            message = f"the output '{draft.name}' needs a RANGE to be integrated over"
            self.findings.error("bad-range", message, draft.word)
        elif integrated:
            draft.low, draft.high = -0.5, 0.5
