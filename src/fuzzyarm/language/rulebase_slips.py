"""What is written in rule bases elsewhere: how it is written here, or what to do instead."""

from __future__ import annotations

import re

from fuzzyarm.base.names import near_hint
from fuzzyarm.language.notations import ANY_CASE, CAPITALS, NAME, NUMBER, Advice, Slip, small
from fuzzyarm.language.statements import STATEMENTS
from fuzzyarm.symbolic.kinds import SHAPES

_STARTERS = re.compile(rf"^(?:{'|'.join(STATEMENTS)})\b", ANY_CASE)
_JOINS = re.compile(r"\b(?:IF|THEN|IS|AND|OR|NOT|WITH|If|Then|Is|And|Or|Not|With)\b")
_IF = re.compile(r"^(\s*)(?:(?:rule\b\s*)?\w*\s*[:.)]?\s*)??if\b", ANY_CASE)
_RANGE = re.compile(rf"({NUMBER})\s*(?:-(?=\s)|\bto\b|[,:]|\s)\s*({NUMBER})")

_RULE = ("rule", "row", "header", "")
_LISTS = ("row", "header", "input", "output", "term", "lookup", "tune")
_NAMED = ("rulebase", "input", "output")
_NUMBERS = ("input", "output", "term")
_VARIABLES = ("input", "output")


def _shape(match: re.Match[str]) -> str:
    """Write the shape of another program by its name here, where its numbers stay as they are."""
    if match[2] in SHAPES:
        return match[0]
    ours = near_hint(match[2], SHAPES)[1]
    return match[1] + (ours or match[2])


ANYWHERE = (
    Slip("quotes are straight", re.compile("[“”„«»]"), '"', whole=True),
    Slip("quotes are straight", re.compile("[‘’‚‹›]"), "'", whole=True),
    Slip(
        "write a description in double quotes",
        re.compile(r"'([^']*)'\s*$"),
        r'"\1"',
        (*_NAMED, "controller"),
        whole=True,
    ),
    Slip("a comment starts with #", re.compile(r"(?:^|(?<=\s))(?://|%|--(?=\s|$))"), "#"),
    Slip("a minus is a hyphen", re.compile("[−–—]"), "-"),
    Slip("a range is written with two points", re.compile(r"\.{3,}|…"), ".."),
    Slip("a statement ends with its line, without a mark", re.compile(r"\s*[;,]\s*$"), ""),
)
"""In rule bases and controllers alike."""

SLIPS = (
    # Lines that begin with a word of elsewhere
    Slip(
        "an input or an output is declared by its word",
        re.compile(r"^(?:var(?:iable)?|inp|in(?:put)?[ _-]?var(?:iable)?)\b(?=\s+\w)", ANY_CASE),
        "input",
        ("",),
    ),
    Slip(
        "an input or an output is declared by its word",
        re.compile(r"^(?:outp|out(?:put)?[ _-]?var(?:iable)?)\b(?=\s+\w)", ANY_CASE),
        "output",
        ("",),
    ),
    Slip(
        "a set of a variable is a term",
        re.compile(r"^(?:mf|set|fuzzy[ _-]?set|membership(?:[ _-]?function)?)\b", ANY_CASE),
        "term",
        ("",),
    ),
    Slip(
        "what must come out is an expect line",
        re.compile(r"^(?:assert|test|check)\b"),
        "expect",
        ("",),
    ),
    # Variables
    Slip(
        "write the range after the name",
        re.compile(
            rf"^(\s*(?:input|output)\s+{NAME})\s*(?::=|[:=]|\b(?:in|range|from|of)\b)[\s:=]*",
            ANY_CASE,
        ),
        r"\1 ",
        _VARIABLES,
    ),
    Slip(
        "write a description in double quotes",
        re.compile(rf"""({NUMBER}\s*\.\.\s*{NUMBER})\s+([^\W\d][^"'#,]*?)\s*(?=#|$)"""),
        r'\1 "\2"',
        _VARIABLES,
        whole=True,
    ),
    # Terms
    Slip(
        "a shape has its name of here",
        re.compile(rf"^(\s*term\s+{NAME}\s+{NAME}\s*[:=]?\s*)({NAME})(?=\s*[-+.\d\[(])"),
        _shape,
        ("term",),
    ),
    Slip(
        "write a colon after the name of a term",
        re.compile(rf"^(\s*term\s+{NAME}\s+{NAME})\s+(?={NAME}\s*[-+.\d\[(])"),
        r"\1: ",
        ("term",),
    ),
    # Rules
    Slip(
        "write a weight after with",
        re.compile(rf"\s*(?:\(\s*({NUMBER})\s*\)|\bweight\s*=?\s*({NUMBER}))\s*$"),
        lambda m: f" with {m[1] or m[2]}",
        ("rule",),
    ),
    Slip("write 'not' after 'is'", re.compile(r"\bis\s*n['’]?t\b"), "is not", _RULE, whole=True),
    Slip(
        "write 'not' after 'is'",
        re.compile(rf"\bnot\s+({NAME})\s+is\s+"),
        r"\1 is not ",
        ("rule",),
    ),
    Slip(
        "write the weight of a cell after '*'",
        re.compile(rf"({NAME})\s*\(\s*({NUMBER})\s*\)"),
        r"\1*\2",
        ("row",),
    ),
    Slip(
        "a cell without a rule is a dot",
        re.compile(r"(?<=\s)(?:-+|_+|\?)(?=\s|$)"),
        ".",
        ("row",),
    ),
    Slip(
        "write the output of a grid by itself",
        re.compile(r"^rules\s*(?::|=|\b(?:table|grid|matrix)\b)\s*(?:for\s+)?"),
        "rules ",
        ("rules",),
    ),
    Slip("a condition has 'is'", re.compile(r"(?<=\w)\s*==?\s*(?=\w)"), " is ", ("rules",)),
    # Settings, expectations, proofs
    Slip(
        "a setting is a word and its value",
        re.compile(r"\s*(?:=|:)\s*"),
        " ",
        ("inference", "block"),
    ),
    Slip(
        "how an output becomes a number is its defuzzifier",
        re.compile(r"\b(?:method|defuzz\w*)\b", ANY_CASE),
        "defuzzifier",
        ("inference",),
    ),
    Slip(CAPITALS, re.compile(r"\b[A-Z]+\b"), small, ("inference", "block")),
    Slip(
        "write '->' after the inputs",
        re.compile(r"\s*(?:=>|:|→|\bgives\b|\bthen\b)\s*"),
        " -> ",
        ("expect",),
    ),
    Slip(
        "an output rises or falls with an input",
        re.compile(r"\bincreas\w*(?:\s+(?:with|in|over))?\b|\brises\s+in\b"),
        "rises with",
        ("prove",),
    ),
    Slip(
        "an output rises or falls with an input",
        re.compile(r"\bdecreas\w*(?:\s+(?:with|in|over))?\b|\bfalls\s+in\b"),
        "falls with",
        ("prove",),
    ),
    Slip(
        "an interval is written  in LOW .. HIGH",
        re.compile(
            rf"\b(?:between|within|in)\s+[\[(]?\s*({NUMBER})\s*(?:\band\b|\bto\b|[,:]|\.\.)"
            rf"\s*({NUMBER})(?:\s*[\])])?"
        ),
        r"in \1 .. \2",
        ("prove", "expect"),
    ),
    Slip("a rule starts with 'rule if'", _IF, r"\1rule if", _RULE),
    Slip(CAPITALS, _STARTERS, small),
    Slip(CAPITALS, _JOINS, small, ("rules", *_RULE)),
    Slip("a proposition has 'is'", re.compile(r"\s*(?<![<>=])==?(?![>=])\s*"), " is ", _RULE),
    Slip("propositions are joined by 'and'", re.compile(r"\s*&&?\s*"), " and ", ("rule",)),
    Slip("propositions are joined by 'or'", re.compile(r"\s*\|\|?\s*"), " or ", ("rule",)),
    Slip("the consequent starts with 'then'", re.compile(r"\s*[-=]>\s*"), " then ", _RULE),
    Slip("the corner of a grid has a backslash", re.compile(r"\s*/\s*"), r" \\ ", ("header",)),
    Slip(
        "write the output of a grid by itself", re.compile(r"\bfor\b|\s*[:=]\s*$"), "", ("rules",)
    ),
    Slip("write numbers without brackets", re.compile(r"[\[\](){}]"), " ", _NUMBERS),
    Slip("write a colon after the names", re.compile(r"\s*=\s*"), ": ", ("term", "terms")),
)
"""Every other notation, in the order in which a line of a rule base is corrected."""

ADVICE = (
    Advice(
        re.compile(rf"^term\s+(?P<at>{NAME})\s*[:=]\s*(?P<rest>.*)$"),
        "a term belongs to a variable",
        lambda m: f"write  term VARIABLE {m['at']}: {m['rest']}".rstrip(),
        ("term",),
    ),
    Advice(
        re.compile(r"(?P<at>\belse\b.*)$", ANY_CASE),
        "a rule has no else",
        "write a second rule, for instance with not:  rule if x is not A then …",
        ("rule",),
    ),
    Advice(
        re.compile(rf"({NAME})\s*(?P<at>[<>]=?\s*{NUMBER})"),
        "a rule asks for terms, not for numbers",
        lambda m: f"a term that begins there is  term {m[1]} BEYOND: ramp LOW HIGH",
        ("rule",),
    ),
    Advice(
        re.compile(rf"=?\s*(?P<at>(?:~|≈|±)=?\s*{NUMBER}?)"),
        "write the tolerance after within",
        "as in  -> u = 5 within 0.1",
        ("expect",),
    ),
    Advice(
        re.compile(r"\b(?P<at>monoton\w*|smooth|bounded|symmetric\w*|antisymmetric)\b"),
        "a property is about an output and a number or an input",
        "as in  prove u rises with e ,  prove u in -1 .. 1 ,  prove u odd",
        ("prove",),
    ),
)  # fmt: skip
"""Advice on lines that no slip corrects; the first match counts."""

LAST = Slip("a range is written with two points", _RANGE, r"\1 .. \2", ("input", "output"))
"""Tried after commas have been corrected."""

_POINT = Slip("the decimal mark is a point", re.compile(r"(?<=\d),(?=\d)"), ".")
_SPACE = Slip("separate numbers and cells by spaces only", re.compile(r"\s*[,;|]\s*"), "  ", _LISTS)
ORDERS = ((), (_POINT,), (_SPACE,), (_POINT, _SPACE))
"""What a comma may have been meant for, as it is tried."""
