"""What could follow the words of one statement."""

from __future__ import annotations

from collections.abc import Callable

from fuzzyarm.rulebase.model import DEFUZZIFIERS, SAMPLINGS, RuleBase, Variable
from fuzzyarm.rulebase.queries.candidates import (
    Candidate,
    hedges,
    keywords,
    shapes,
    terms,
    values,
    variables,
)
from fuzzyarm.rulebase.shapes import EVEN_SHAPES
from fuzzyarm.rulebase.syntax.settings import CHOICES
from fuzzyarm.rulebase.syntax.tokens import Token
from fuzzyarm.rulebase.syntax.words import HEDGE_WORDS, SETTINGS

Tokens = tuple[Token, ...]


def complete_statement(model: RuleBase, keyword: str, tokens: Tokens) -> list[Candidate]:
    """Return what could stand behind `keyword` and `tokens`."""
    return _COMPLETERS[keyword](model, tokens) if keyword in _COMPLETERS else []


def _all(model: RuleBase) -> tuple[Variable, ...]:
    return (*model.inputs, *model.outputs)


def _find(model: RuleBase, name: str) -> Variable | None:
    return next((v for v in _all(model) if v.name == name), None)


def _range(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    if len(tokens) != 1:
        return []
    snippet = '${1:-1} .. ${2:1}  "${3:description}"'
    return [Candidate("range", "value", "-1 .. 1", "low .. high", snippet)]


def _even_terms(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    texts = [token.text for token in tokens]
    if ":" not in texts:
        if not texts or texts[-1] == ",":
            return variables(v for v in _all(model) if v.name not in texts)
        return keywords((":",))
    after = texts[texts.index(":") + 1 :]
    if not after:
        return [Candidate(name, "shape", name, what) for name, what in EVEN_SHAPES.items()]
    if len(after) == 1:
        sets = ("NB NM NS ZE PS PM PB", "NB NS ZE PS PB", "N ZE P", "LOW MIDDLE HIGH")
        return [Candidate(names, "row", names) for names in sets]
    return []


def _term(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    texts = [token.text for token in tokens]
    if not texts:
        return variables(_all(model))
    if ":" not in texts:
        return keywords((":",)) if len(texts) == 2 else []
    after = texts[texts.index(":") + 1 :]
    if not after:
        return shapes()
    if after[0] == "linear" and after[-1] in ("linear", "*", "+", "-"):
        return variables(model.inputs)
    if tokens[-1].kind in ("number", "string") or after[-1] in (")", "inf"):
        return keywords(("height",)) if "height" not in after else []
    return []


def _inference(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    if not tokens:
        return [*keywords(SETTINGS), *variables(_all(model), ":")]
    return _settings(tokens, SETTINGS)


def _block(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    texts = [token.text for token in tokens]
    if ":" not in texts:
        return keywords((":",)) if texts else []
    return _settings(tokens, ("and", "or", "implication"))


def _settings(tokens: Tokens, keys: tuple[str, ...]) -> list[Candidate]:
    last = tokens[-1].text
    texts = [token.text for token in tokens]
    if last == "," and _inside_parenthesis(texts):
        return values(SAMPLINGS)
    if last in (":", ","):
        return keywords(key for key in keys if key not in texts)
    if last in DEFUZZIFIERS:
        samples = Candidate("(101, endpoints)", "value", "(101, endpoints)", "a number of samples")
        return [*keywords(("exact",)), samples]
    return values(_VALUES.get(last, ()))


_VALUES = {**CHOICES, "defuzzifier": DEFUZZIFIERS, "no-rule": ("error", "hold", "0")}


def _inside_parenthesis(texts: list[str]) -> bool:
    return texts.count("(") > texts.count(")")


def _rules(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    texts = [token.text for token in tokens]
    if not texts:
        return variables(model.outputs)
    if "when" not in texts:
        return keywords(("when",)) if len(texts) == 1 else []
    return _expression(model, tokens[texts.index("when") + 1 :], ("and", "or"))


def _rule(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    texts = [token.text for token in tokens]
    if not texts:
        return keywords(("if",))
    if "then" not in texts:
        return _expression(model, tokens[1:], ("and", "or", "then"))
    after = tokens[texts.index("then") + 1 :]
    if not after or after[-1].text in ("and", ","):
        return variables(model.outputs, " is")
    if any(token.text == "with" for token in after):
        return []
    return _proposition(model, after, ("and", "with"))


def _expression(model: RuleBase, tokens: Tokens, follow: tuple[str, ...]) -> list[Candidate]:
    if not tokens or tokens[-1].text in ("and", "or", "("):
        return [*variables(_all(model), " is"), *hedges()]
    if _asked(tokens) is None and tokens[-1].text in HEDGE_WORDS:
        return [*keywords(("(",)), *hedges()]
    return _proposition(model, tokens, follow)


def _proposition(model: RuleBase, tokens: Tokens, follow: tuple[str, ...]) -> list[Candidate]:
    asked = _asked(tokens)
    if asked is not None:
        return [*terms(_find(model, asked)), *hedges()]
    starts = tokens[-1].text == ")" or _asked(tokens[:-1]) is not None
    return keywords(follow) if starts else keywords(("is",))


def _asked(tokens: Tokens) -> str | None:
    """Return the variable whose term comes next; None where no term does."""
    index = len(tokens) - 1
    while index >= 0:
        text = tokens[index].text
        if text == ")" and index >= 3 and tokens[index - 3].text == "power":
            index -= 4
        elif text in HEDGE_WORDS and tokens[index].kind == "name":
            index -= 1
        else:
            break
    if index < 1 or tokens[index].text != "is":
        return None
    return tokens[index - 1].text


def _expect(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    texts = [token.text for token in tokens]
    if "->" in texts:
        return _outcome(model, tokens[texts.index("->") + 1 :])
    if not texts or texts[-1] == ",":
        return variables((v for v in model.inputs if v.name not in texts), " =")
    if tokens[-1].kind == "number":
        named = all(v.name in texts for v in model.inputs)
        return keywords(("->",) if named else (",",))
    return keywords(("=",)) if texts[-1] not in ("=", "-") else []


def _outcome(model: RuleBase, tokens: Tokens) -> list[Candidate]:
    if not tokens or tokens[-1].text == ",":
        return variables(model.outputs)
    last = tokens[-1]
    if last.kind == "number":
        texts = [token.text for token in tokens]
        words = {"=": "within", "in": ".."}
        return keywords(word for relation, word in words.items() if relation in texts)
    if last.kind in ("name", "quoted") and last.text not in ("in", "within"):
        return keywords(("=", "<", "<=", ">", ">=", "in"))
    return []


_COMPLETERS: dict[str, Callable[[RuleBase, Tokens], list[Candidate]]] = {
    "input": _range,
    "output": _range,
    "terms": _even_terms,
    "term": _term,
    "inference": _inference,
    "block": _block,
    "rules": _rules,
    "rule": _rule,
    "expect": _expect,
}
