"""Rule blocks and membership functions of FCL, in both dialects."""

from __future__ import annotations

from dataclasses import dataclass, field

from fuzzyarm.expression.kinds import SHAPES
from fuzzyarm.formats.fcl.dialect import RULES
from fuzzyarm.formats.fcl.tokens import KEYWORDS, SECTIONS, Cursor, SyntaxFaultError
from fuzzyarm.formats.findings import MAX_RULES, Draft, Findings, Word, same_value
from fuzzyarm.formats.fll.reader import FLL_SHAPES, formula_shape, linear_shape
from fuzzyarm.formats.rules import (
    MACHINE_EPSILON,
    Norms,
    RuleBuilder,
    RuleFaultError,
    RuleParser,
    RuleText,
    concluded,
)
from fuzzyarm.formats.shapes import (
    FCL_CONJUNCTIONS,
    FCL_DISJUNCTIONS,
    JFUZZYLOGIC_PAIRS,
    make_shape,
)
from fuzzyarm.formats.writing import variables_in
from fuzzyarm.model.rulebase import Rule, RuleBlock, Shape

# --- Rule blocks of FCL ---

_END_OF_RULE = frozenset({";", "RULE", "END_RULEBLOCK", "END_FUNCTION_BLOCK", *SECTIONS})
_S_TO_T = {s: t for t, s in JFUZZYLOGIC_PAIRS.items()}


@dataclass(slots=True)
class BlockText:
    """A rule block as it was written.

    Attributes
    ----------
    word : Word
        Its name.
    norms : list
        (key, norm word) of AND, OR, ACT and ACCU, in the order of the text.
    rules : list of list of Word
        The words of each rule from IF on.
    enabled : bool
        False where the file switches it off.
    """

    word: Word
    norms: list[tuple[str, Word]] = field(default_factory=list)
    rules: list[list[Word]] = field(default_factory=list)
    enabled: bool = True


def read_block(cursor: Cursor, findings: Findings) -> BlockText:
    """Read from behind RULEBLOCK to behind END_RULEBLOCK."""
    unnamed = cursor.key() in ("AND", "OR", "ACT", "ACCU", "RULE", "ENABLED", "END_RULEBLOCK")
    block = BlockText(Word("", cursor.word.span) if unnamed or cursor.ended else cursor.take())
    while not cursor.skip("END_RULEBLOCK"):
        if cursor.ended or cursor.key() in SECTIONS or cursor.key() == "END_FUNCTION_BLOCK":
            raise SyntaxFaultError("'END_RULEBLOCK' is missing", cursor.word)
        try:
            _statement(cursor, block, findings)
        except SyntaxFaultError as fault:
            findings.error(fault.name, str(fault), fault.word)
            cursor.at += cursor.key() not in _END_OF_RULE
            cursor.to_next_statement()
    return block


def _statement(cursor: Cursor, block: BlockText, findings: Findings) -> None:
    key = cursor.key()
    if key in ("AND", "OR", "ACT", "ACCU"):
        cursor.take()
        cursor.skip(":", ":=", "=")
        block.norms.append((key, cursor.name("a norm")))
        cursor.skip(";")
    elif key == "ENABLED":
        cursor.take()
        cursor.skip(":", ":=", "=")
        block.enabled = cursor.take().text.upper() != "FALSE"
        cursor.skip(";")
    elif key == "RULE":
        start = cursor.take()
        words = _rule_words(cursor, start)
        if findings.room(len(block.rules), MAX_RULES, "rules", start):
            block.rules.append(words)
    else:
        message = f"RULE, AND and the like are expected here, not '{cursor.word.text[:40]}'"
        raise SyntaxFaultError(message, cursor.word)


def _rule_words(cursor: Cursor, start: Word) -> list[Word]:
    while not cursor.ended and cursor.key() not in ("IF", *_END_OF_RULE):
        cursor.take()
    words: list[Word] = []
    while not cursor.ended and cursor.key() not in _END_OF_RULE:
        words.append(cursor.take())
    cursor.skip(";")
    if not words:
        raise SyntaxFaultError("the rule has no IF", start)
    return _joined_numbers(words)


def _joined_numbers(words: list[Word]) -> list[Word]:
    """Put the sign of a weight back to its number."""
    if len(words) > 2 and words[-2].text in ("-", "+"):
        sign, value = words[-2], words[-1]
        words[-2:] = [Word(sign.text + value.text, sign.span.to(value.span))]
    return words


def blocks_in_model(
    texts: list[BlockText],
    variables: dict[str, Draft],
    accumulations: dict[str, str],
    dialect: str,
    findings: Findings,
) -> tuple[RuleBlock, ...]:
    """Return the blocks; set the aggregation of outputs from ACCU in a rule block."""
    builder = RuleBuilder(variables, findings)
    on = [text for text in texts if _is_on(text, findings)]
    rules = [_rules(text, variables, dialect, findings) for text in on]
    blocks = []
    for index, text in enumerate(on):
        norms, accumulation = _norms(text, dialect, findings)
        _accumulate(rules[index], accumulation, variables, accumulations, dialect, findings)
        name = text.word.text
        if dialect == "fuzzylite":
            later = frozenset[str]().union(*map(concluded, rules[index + 1 :]))
            blocks.append(builder.block(name, norms, rules[index], later))
        else:
            blocks.append(_plain_block(name, norms, rules[index], variables, findings))
    return tuple(blocks)


def _is_on(text: BlockText, findings: Findings) -> bool:
    if not text.enabled:
        message = f"the block '{text.word.text}' is switched off; its rules are left out"
        findings.warn("disabled-block", message, text.word)
    return text.enabled


def _rules(
    block: BlockText, variables: dict[str, Draft], dialect: str, findings: Findings
) -> list[RuleText]:
    rules = []
    for words in block.rules:
        try:
            rules.append(RuleParser(words, variables, findings, RULES[dialect]).rule())
        except RuleFaultError as fault:
            findings.error(fault.name, str(fault), fault.word)
    return rules


def _norms(block: BlockText, dialect: str, findings: Findings) -> tuple[Norms, str | None]:
    found: dict[str, str] = {}
    for key, word in block.norms:
        table = FCL_CONJUNCTIONS if key in ("AND", "ACT") else FCL_DISJUNCTIONS
        name = word.text.upper()
        if name == "NONE":
            continue
        if name not in table:
            findings.unknown("unknown-norm", f"the norm for {key}", word, table)
            continue
        norm = table[name]
        if dialect == "jfuzzylogic" and key in ("AND", "OR"):
            _pair(found, key, norm, word, findings)
        found[key] = norm
    threshold = MACHINE_EPSILON if dialect == "fuzzylite" else 0.0
    norms = Norms(found.get("AND"), found.get("OR"), found.get("ACT"), threshold)
    if dialect == "jfuzzylogic":
        norms = Norms(norms.conjunction or "min", norms.disjunction or "max", norms.implication)
    return norms, found.get("ACCU")


def _pair(found: dict[str, str], key: str, norm: str, word: Word, findings: Findings) -> None:
    """Set OR with AND and AND with OR, as jFuzzyLogic does."""
    other = "OR" if key == "AND" else "AND"
    table = JFUZZYLOGIC_PAIRS if key == "AND" else _S_TO_T
    partner = table.get(norm)
    if partner is None:
        return
    if other in found and found[other] != partner:
        message = f"to jFuzzyLogic this sets {other} to {partner} too, whatever stood there"
        findings.warn("paired-norms", message, word)
    found[other] = partner


def _accumulate(
    rules: list[RuleText],
    accumulation: str | None,
    variables: dict[str, Draft],
    accumulations: dict[str, str],
    dialect: str,
    findings: Findings,
) -> None:
    if accumulation is None and dialect == "fuzzylite":
        return
    norm = accumulation or "sum"
    for rule in rules:
        for conclusion in rule.conclusions:
            draft = variables.get(conclusion.variable)
            if draft is None or not draft.is_output:
                continue
            earlier = accumulations.setdefault(draft.name, norm)
            draft.aggregation = earlier
            if earlier != norm and dialect == "jfuzzylogic":
                message = f"two blocks accumulate '{draft.name}' by different norms"
                findings.loss("mixed-accumulation", message, conclusion.span)


def _plain_block(
    name: str,
    norms: Norms,
    texts: list[RuleText],
    variables: dict[str, Draft],
    findings: Findings,
) -> RuleBlock:
    rules = []
    for text in texts:
        for used in sorted(variables_in(text.antecedent)):
            if used in variables and variables[used].is_output:
                message = (
                    f"'{used}' is an output; jFuzzyLogic takes the value it had before the "
                    "rules, which cannot be carried"
                )
                findings.loss("chained-output", message, text.span)
        conclusions = tuple(same_value(c, variables) for c in text.conclusions)
        rules.append(Rule(text.antecedent, conclusions, text.weight, text.span))
    return RuleBlock(
        tuple(rules),
        name,
        norms.conjunction or "min",
        norms.disjunction or "max",
        norms.implication or "min",
    )


# --- Membership functions of FCL, under the names of both dialects ---

# jFuzzyLogic: kind of shape and where each number stands in the text.
_JFUZZYLOGIC: dict[str, tuple[str, tuple[int, ...]]] = {
    "TRIAN": ("triangle", (0, 1, 2)),
    "TRAPE": ("trapezoid", (0, 1, 2, 3)),
    "GAUSS": ("gaussian", (0, 1)),
    "GAUSS2": ("two-sided-gaussian", (0, 1, 2, 3)),
    "GBELL": ("bell", (2, 0, 1)),
    "SIGM": ("sigmoid", (1, 0)),
    "DSIGM": ("sigmoid-difference", (1, 0, 3, 2)),
}
_ALIASES = {"TRIANGULAR": "Triangle", "TRAPEZOIDAL": "Trapezoid"}
_GUESSED = {"GENERALIZEDBELL": ("bell", (2, 0, 1))}
_FUZZYLITE = {name.upper(): name for name in FLL_SHAPES}
_WORDS = (*_JFUZZYLOGIC, "COSINE", "SINGLETONS", "FUNCTION", *_FUZZYLITE, "LINEAR", "DISCRETE")


def fcl_shape(cursor: Cursor, dialect: str, inputs: int, findings: Findings) -> Shape | None:
    """Read the function of a term, up to its end.

    Raises
    ------
    SyntaxFaultError
        Where it is none.
    """
    word = cursor.word
    key = cursor.key()
    if key == "(":
        return _points(cursor, dialect, findings)
    if cursor.at_number():
        return make_shape("singleton", [cursor.number()], word, findings)
    if cursor.ended or not word.text[0].isalpha():
        raise SyntaxFaultError("a membership function is expected here", word)
    cursor.take()
    if key == "FUNCTION":
        return _function(cursor, dialect, findings)
    if key == "SINGLETONS":
        return _singletons(cursor, word, findings)
    if key not in _WORDS and key not in _ALIASES and key not in _GUESSED:
        findings.unknown("unknown-shape", "the membership function", word, _WORDS)
        cursor.to_next_statement()
        return None
    values = _numbers(cursor, findings)
    return None if values is None else _shape(word, values, dialect, inputs, findings)


def _shape(
    word: Word, values: list[float], dialect: str, inputs: int, findings: Findings
) -> Shape | None:
    key = word.text.upper()
    if key == "CONSTANT":
        return make_shape("singleton", values, word, findings)
    if key == "LINEAR":
        return linear_shape(values, inputs, word, findings)
    if key == "DISCRETE":
        height = values.pop() if len(values) % 2 else 1.0
        return make_shape("points", values, word, findings, height=height, ties="last")
    if key == "COSINE" and dialect == "jfuzzylogic":  # half width, then centre
        values = [values[1], 2.0 * values[0]] if len(values) == 2 else values
        return make_shape("cosine", values, word, findings)
    if key in _GUESSED:
        message = f"'{word.text}' is taken for a bell with width, slope and centre"
        findings.warn("guessed-shape", message, word)
    if key in _JFUZZYLOGIC or key in _GUESSED:
        kind, order = (_JFUZZYLOGIC | _GUESSED)[key]
    else:
        kind = FLL_SHAPES[_FUZZYLITE.get(key) or _ALIASES[key]]
        order = tuple(range(len(SHAPES[kind].parameters)))
        if kind in ("sigmoid-difference", "sigmoid-product"):
            order = (0, 1, 3, 2)
    height = values.pop() if len(values) == len(order) + 1 else 1.0
    if len(values) == len(order):
        values = [values[index] for index in order]
    if key == "DSIGM":
        _check_difference(values, word, findings)
    return make_shape(kind, values, word, findings, height=height)


def _check_difference(values: list[float], word: Word, findings: Findings) -> None:
    if len(values) != 4:
        return
    first, slope, second, other = values
    if slope <= 0.0 or slope != other or first > second:
        message = (
            "jFuzzyLogic takes 0 where the difference of the sigmoids is negative, the model "
            "its magnitude"
        )
        findings.warn("negative-difference", message, word)


def _numbers(cursor: Cursor, findings: Findings) -> list[float] | None:
    values: list[float] = []
    while not cursor.ended and cursor.word.text != ";" and cursor.key() not in KEYWORDS:
        if cursor.at_number():
            values.append(cursor.number())
        elif cursor.word.text in (",", "(", ")"):
            cursor.take()
        else:
            _moving(cursor.word, findings)
            cursor.to_next_statement()
            return None
    return values


def _moving(word: Word, findings: Findings) -> None:
    message = (
        f"the corner '{word.text[:40]}' is a variable; a term whose shape moves cannot be carried"
    )
    findings.error("moving-corner", message, word)


def _points(cursor: Cursor, dialect: str, findings: Findings) -> Shape | None:
    first = cursor.word
    values: list[float] = []
    while cursor.skip("("):
        for closing in (",", ")"):
            if not cursor.at_number() and cursor.word.text[:1].isalpha():
                _moving(cursor.word, findings)
                cursor.to_next_statement()
                return None
            values.append(cursor.number())
            cursor.expect(closing)
        cursor.skip(",")
    ties = "first" if dialect == "jfuzzylogic" else "last"
    return make_shape("points", values, first, findings, ties=ties)


def _singletons(cursor: Cursor, word: Word, findings: Findings) -> Shape | None:
    pairs: list[float] = []
    while cursor.skip("("):
        pairs.append(cursor.number())
        cursor.expect(",")
        pairs.append(cursor.number())
        cursor.expect(")")
    if len(pairs) == 2 and pairs[1] == 1.0:
        return make_shape("singleton", pairs[:1], word, findings)
    message = "a term of several singletons, or of one lower than 1, cannot be carried"
    findings.error("several-singletons", message, word)
    return None


def _function(cursor: Cursor, dialect: str, findings: Findings) -> Shape | None:
    first = cursor.word
    parts: list[str] = []
    last = first
    while not cursor.ended and cursor.word.text != ";":
        if cursor.key() in KEYWORDS and cursor.key() not in ("AND", "OR"):
            break
        last = cursor.take()
        parts.append(last.text)
    formula = Word(" ".join(parts), first.span.to(last.span))
    return formula_shape(formula, dialect, findings)
