"""What is written in controllers elsewhere: how it is written here, or what to do instead.

Slips are lines that can be corrected automatically (:mod:`fuzzyarm.language.slips`). An advice is
for a line that needs more than itself: another line above it, a rule base, a number.
"""

from __future__ import annotations

import re

from fuzzyarm.base.names import near_hint
from fuzzyarm.language.controllers import CONTROLLER_STATEMENTS, SIGNAL
from fuzzyarm.language.model.controller import SOURCES
from fuzzyarm.language.notations import ANY_CASE, CAPITALS, NAME, NUMBER, Advice, Slip, small
from fuzzyarm.symbolic.sources import SourceKind

# --- Sources by the words that others have for them ---

ELSEWHERE = {word: kind.elsewhere for word, kind in SOURCES.items() if kind.elsewhere}
"""The sources of a controller, and what they are called elsewhere."""

_SOURCE_OF = {word: word for word in SOURCES if SOURCES[word].of in ("port", "signal")} | {
    word: source for source, words in ELSEWHERE.items() for word in words.split()
}

_TAKEN = "|".join(sorted(_SOURCE_OF, key=len, reverse=True))
_OF_ONE = re.compile(
    rf"\b({_TAKEN})\b(?:\s+(?:of|in|on|at|for)\b)?\s*(?:\(\s*({NAME})\s*\)|\s({NAME}))"
    r"(?!\s*[(\w])",
    ANY_CASE,
)


def _pattern(kind: SourceKind) -> str:
    """Return what a source looks like where it is written."""
    if kind.of == "call":
        return rf"{kind.name}\s+{NAME}\s*\([^()]*\)"
    return r"\s+".join([kind.name, *kind.joined.split(), NAME])


_SOURCE = rf"(?:{'|'.join(map(_pattern, SOURCES.values()))})"
_OF_SIGNALS = "|".join(kind.name for kind in SOURCES.of("signal"))


def _source(match: re.Match[str]) -> str:
    """Write a source as it is here."""
    word, name = _SOURCE_OF[match[1].lower()], match[2] or match[3]
    return f"{word}{SOURCES[word].joined} {name}"


def _comma_list(text: str) -> str:
    return ", ".join(re.split(r"[\s,;]+", text.strip()))


_STARTERS = "|".join(word for word in CONTROLLER_STATEMENTS if word != SIGNAL)
_VOCABULARY = "|".join({word for source in SOURCES.values() for word in source.options})

_LIMITING = ("saturate", "sat", "saturation", "limit", "clip", "clamp", "max", "min")
_ZONES = ("deadband", "deadzone")
_FUNCTIONS = (
    *_LIMITING, *_ZONES, "abs", "sign", "sgn", "sqrt", "exp", "log", "ln", "sin", "cos", "tan",
    "tanh", "atan", "atan2", "floor", "round", "mod", "pow", "power",
)  # fmt: skip
_NO_CALL = "|".join(("rules", "table", "evalfis", *_FUNCTIONS, *_SOURCE_OF))

_LINE = (SIGNAL, "drive")

SLIPS = (
    Slip(
        "a comment starts with #",
        re.compile(r"(?:\(\*|/\*)\s*(.*?)\s*(?:\*\)|\*/)\s*$"),
        r"# \1",
    ),
    Slip(CAPITALS, re.compile(rf"^\s*(?:{_STARTERS})\b(?!\s*:?=)", ANY_CASE), small),
    Slip(
        CAPITALS,
        re.compile(rf"\b(?:{'|'.join(SOURCES)}|{_VOCABULARY}|of)\b(?=\s+[\w'.+-])", ANY_CASE),
        small,
        _LINE,
    ),
    Slip(CAPITALS, re.compile(r"\b(?:TUNE|LOG|PI|Tune|Log|Pi)\b"), small, ("gain",)),
    Slip("a quotient of π is written with pi", re.compile("[πΠ]"), "pi", ("gain",)),
    Slip(
        "how often it runs is its period, a number with its unit",
        re.compile(
            r"^\s*(?:period\s*[:=]|(?:dt|Ts|T_s|sampl(?:e|ing)[ _-]?time)\s*[:=]?)"
            rf"\s*({NUMBER})\s*$",
            ANY_CASE,
        ),
        r"period \1 s",
        ("", "period"),
    ),
    Slip(
        "how often it runs is its period",
        re.compile(
            r"^\s*(?:sampl(?:e|ing)(?:[ _-]?(?:time|period|interval))?|cycle(?:[ _-]?time)?"
            r"|control[ _-]period|dt|Ts|T_s|tick|interval|every)\b\s*[:=]?\s*(?=[.\d])",
            ANY_CASE,
        ),
        "period ",
        ("",),
    ),
    Slip(
        "a number by name is a gain",
        re.compile(r"^\s*(?:param(?:eter)?|const(?:ant)?|var|let|real|float)\b", ANY_CASE),
        "gain",
        ("",),
    ),
    Slip("a file is named by use", re.compile(r"^\s*(?:import|include|load|uses)\b"), "use", ("",)),
    Slip(
        "the lines of an axis come below  axis NAME",
        re.compile(r"^\s*(?:axes|joints?|channels?)\b", ANY_CASE),
        "axis",
        ("",),
    ),
    Slip(
        "a set point lasts some periods",
        re.compile(r"^\s*set[ _-]?point\s*[:=]?\s*(?:every\s*)?[:=]?\s*(?=\d)", ANY_CASE),
        "set-point every ",
        ("", "set-point"),
    ),
    Slip(
        "a definition has '='",
        re.compile(r"\s*(?::=|==|<-|←|≔)\s*"),
        " = ",
        ("gain", "partner", *_LINE),
    ),
    Slip(
        "no punctuation after the keyword",
        re.compile(r"^(\s*(?:period|axis|controller|set-point|use|drive|zoom|learn)\b)\s*[:=]\s*"),
        r"\1 ",
        ("period", "axis", "controller", "set-point", "use", "drive", "zoom", "learn"),
    ),
    Slip(
        "a time is a number with its unit",
        re.compile(r"\b(?:T|TIME)#(?=\d)", ANY_CASE),
        "",
        ("period", SIGNAL),
        whole=True,
    ),
    # Headings, axes, files
    Slip("no punctuation after an axis", re.compile(r"\s*[:{]\s*$"), "", ("axis", "controller")),
    Slip(
        "an axis is a name, without double quotes",
        re.compile(r'"([^\W\d]\w*)"'),
        r"\1",
        ("axis", "drive"),
        whole=True,
    ),
    Slip(
        "axes are separated by commas",
        re.compile(rf"^(\s*axis\s+)({NAME}(?:(?:\s+and\s+|\s*&\s*|\s+)(?!and\b){NAME})+)\s*$"),
        lambda m: m[1] + ", ".join(re.findall(NAME, re.sub(r"\band\b|&", " ", m[2]))),
        ("axis",),
    ),
    Slip(
        "a file is used under a name",
        re.compile(rf'^\s*use\s+"([^"]+)"\s+as\s+({NAME})'),
        r'use \2 from "\1"',
        ("use", ""),
        whole=True,
    ),
    Slip(
        "a file is used under a name",
        re.compile(r'^\s*use\s+"((?:[^"/\\]*[/\\])*([^\W\d]\w*)[^"/\\]*)"\s*$'),
        r'use \2 from "\1"',
        ("use", ""),
        whole=True,
    ),
    Slip(
        "write the file in double quotes after from",
        re.compile(rf"""^(\s*use\s+{NAME})\s*(?:from\b|=|:|\s)\s*(?:"([^"]*)"|'([^']*)'|([^\s"',#]+))"""),
        lambda m: f'{m[1]} from "{m[2] or m[3] or m[4]}"',
        ("use", ""),
        whole=True,
    ),
    # Gains
    Slip(
        "write '=' between a name and its value",
        re.compile(rf"^(\s*(?:gain|partner)\s+{NAME})(?:\s*:\s*=?\s*|\s+(?=[^=:\s]))"),
        r"\1 = ",
        ("gain", "partner"),
    ),
    Slip(
        "one value for each axis, with commas between them",
        re.compile(r"[\[({]\s*([^\])}]*?)\s*[\])}]"),
        lambda m: _comma_list(m[1]),
        ("gain",),
    ),
    Slip(
        "write a unit in double quotes",
        re.compile(rf"""(=\s*{NUMBER}(?:\s*[*/]\s*(?:{NUMBER}|pi))*)\s+['\[]?([^\W\d][^,"'#\]]*?|1/[^,"'#\]]+?)['\]]?\s*(?=,|#|$)"""),
        r'\1 "\2"',
        ("gain",),
        whole=True,
    ),
    Slip(
        "a range is written with two points",
        re.compile(rf"(\btune\s+)\[?\s*({NUMBER})\s*(?:\bto\b|[,;:]|\s)\s*({NUMBER})(?:\s*\])?"),
        r"\1\2 .. \3",
        ("gain",),
    ),
    Slip(
        "write a comma before tune",
        re.compile(r"(?<![,\s])\s+(?=tune\b)"),
        ", ",
        ("gain",),
    ),
    # Options
    Slip(
        "limits are called within",
        re.compile(
            r"(,?)\s*\b(?:limits?|limited to|saturat\w*|clamp\w*|bounds?|between|range)\b"
            r"(?=\s*[\[(+±\d.-])"
        ),
        r"\1 within",
        _LINE,
    ),
    Slip(
        "write a comma before an option",
        re.compile(rf"(?<=[\w')])\s+(?=(?:{_VOCABULARY}|slew)\b)"),
        ", ",
        _LINE,
    ),
    Slip(
        "a range is written with two points",
        re.compile(
            rf"(\bwithin\s+)[\[(]?\s*({NUMBER})\s*(?:[^\W\d]\w*)?\s*(?:\.\.|\bto\b|[,;:]|\s)"
            rf"\s*({NUMBER})(?:\s*(?!slew|within)[^\W\d]\w*)?(?:\s*[\])])?"
        ),
        r"\1\2 .. \3",
        _LINE,
    ),
    Slip(
        "both limits are written",
        re.compile(r"(\bwithin\s+)(?:±|\+/-|\+-)\s*([\d.]+)"),
        r"\1-\2 .. \2",
        _LINE,
    ),
    Slip(
        "a low-pass has a time",
        re.compile(
            rf"\b((lag|rate) of {NAME}[^,]*),"
            r"\s*(?:tau|T|constant|tc|filter|time)?\s*=?\s*(?=[\d.])"
        ),
        lambda m: f"{m[1]}, {'time' if m[2] == 'lag' else 'filter'} ",
        (SIGNAL,),
    ),
    Slip(
        "anti-windup says how: hold, or back in a time",
        re.compile(r"\banti[- _]?windup\b(?:\s+(?:on|yes|true))?(?!\s*(?:hold|back))", ANY_CASE),
        "anti-windup hold",
        (SIGNAL,),
    ),
    # Sources
    Slip(
        "an error is named by its port",
        re.compile(rf"\breference\s+({NAME})\s*-\s*measured\s+\1(?![\w-])"),
        r"error of \1",
        _LINE,
    ),
    Slip(
        "the change per second is a rate",
        re.compile(rf"\bd\s*/\s*dt\s*(?:\(\s*({NAME})\s*\)|({NAME}))|\bd([^\W\d]\w*)\s*/\s*dt\b"),
        lambda m: f"rate of {m[1] or m[2] or m[3]}",
        _LINE,
    ),
    Slip(
        "write the port after 'error of'",
        re.compile(rf"(?<=[=*+(])\s*({NAME})\s+error\b(?!\s+of)"),
        r" error of \1",
        _LINE,
    ),
    Slip(
        "evaluate a rule base by  rules",
        re.compile(
            rf"\bevalfis\s*\(\s*(?:({NAME})\s*,\s*\[([^\])]*)\]|\[([^\])]*)\]\s*,\s*({NAME}))\s*\)"
        ),
        lambda m: f"rules {m[1] or m[4]}({_comma_list(m[2] or m[3])})",
        _LINE,
    ),
    Slip(
        "write the inputs in parentheses",
        re.compile(rf"\b({NAME})\s*\[([^\]]*)\]"),
        lambda m: f"{m[1]}({_comma_list(m[2])})",
        _LINE,
    ),
    Slip(
        "write the inputs in the order of the rule base, without their names",
        re.compile(rf"(\(\s*){NAME}\s*=\s*({NAME}\s*\))"),  # of several the order is not known
        r"\1\2",
        _LINE,
    ),
    Slip(
        "evaluate a rule base by  rules",
        re.compile(
            r"\b(?:rule|rulebase|fuzzy|infer|evaluate|eval|fis)\s+(?=[\w']+\s*\()", ANY_CASE
        ),
        "rules ",
        _LINE,
    ),
    Slip(
        "evaluate a rule base by  rules, a table by  table",
        re.compile(rf"(=\s*)(?!(?:{_NO_CALL})\b)({NAME})\s*\((?=[^()]*\))", ANY_CASE),
        r"\1rules \2(",
        _LINE,
    ),
    Slip(
        "write the inputs in parentheses",
        re.compile(rf"\b(rules|table)\s+({NAME})\s+({NAME}(?:(?:\s*,\s*|\s+){NAME})*)\s*$"),
        lambda m: f"{m[1]} {m[2]}({_comma_list(m[3])})",
        _LINE,
    ),
    Slip("a source is written  WORD of NAME", _OF_ONE, _source, _LINE),
    Slip(
        "write a factor after '*'",
        re.compile(rf"(=\s*)({NAME})\s+({_SOURCE})(?=\s*(?:,|$))"),
        r"\1\3 * \2",
        (SIGNAL,),
    ),
    Slip(
        "write the source first, then its factors",
        re.compile(rf"(=\s*)([^=,]*?)\s*\*\s*({_SOURCE})((?:\s*[*/][^,+-]*)?)(?=,|$|\s*$)"),
        r"\1\3\4 * \2",
        _LINE,
    ),
    Slip(
        "a power is written as a product",
        re.compile(rf"(/\s*)?({NAME})\s*(?:\^|\*\*)\s*([23])\b"),
        lambda m: (m[1] or "") + (" / " if m[1] else " * ").join([m[2]] * int(m[3])),
        _LINE,
    ),
    # Drives, zooms, learners
    Slip(
        "write the port of a drive first",
        re.compile(rf"^(\s*)drive\s+([^=]+?)\s+(?:to|into|on)\s+({NAME})\s*(?=,|$)"),
        r"\1drive \3 = \2",
        ("drive",),
    ),
    Slip(
        "write '=' after the port",
        re.compile(rf"^(\s*drive\s+)\(?\s*({NAME})\s*\)?\s*[:=]?\s*(?=[\w'.-])"),
        r"\1\2 = ",
        ("drive",),
    ),
    Slip(
        "signals to the plant are drives",
        re.compile(
            rf"^(\s*)(?:output|out|actuator|actuate|send|write|put)\s+(?={NAME}\s*=)", ANY_CASE
        ),
        r"\1drive ",
        (SIGNAL,),
    ),
    Slip("signals are separated by commas", re.compile(r"\s+(?:and|&)\s+"), ", ", ("zoom",)),
    Slip(
        "write the performance table after by",
        re.compile(r"\b(?:with|from|using|to)\b"),
        "by",
        ("learn",),
    ),
)  # fmt: skip
"""Every other notation, in the order in which a line of a controller is corrected."""

ENDINGS = re.compile(r"^\s*(?:end\w*(?:[ _-]\w+)?|begin|[{}]+)\s*[;.]?\s*$", ANY_CASE)
"""Lines that end a part elsewhere; here nothing does."""


# --- Lines that need more than themselves ---


def _above(match: re.Match[str]) -> str:
    return f"write  x = {' '.join(match['at'].split())}  above, and x here"


def _no_function(match: re.Match[str]) -> str:
    return f"unknown function '{match['at']}'"


def _in_place_of(match: re.Match[str]) -> str:
    if match["at"].lower() in _LIMITING:
        return "limits follow a drive or an integral:  drive PORT = u, within -1 .. 1"
    if match["at"].lower() in _ZONES:
        return "it is a source:  y = deadband of x, width 0.5"
    return "a curve of one signal is a rule base:  y = rules NAME(x)"


ADVICE = (
    Advice(
        re.compile(rf"\((?P<at>\s*{NAME}\s*=[^=()]*,[^()]*)\)"),
        "write the inputs in the order of the rule base, without their names",
        "write the signals alone, in the order in which that file declares its inputs",
        _LINE,
    ),
    Advice(
        re.compile(rf"\b(?P<at>evalfis)\s*\(\s*({NAME})\s*,\s*({NAME})\s*\)"),
        "evaluate a rule base by  rules",
        "write  rules NAME(x)  with the rule base first and its inputs in parentheses",
        _LINE,
    ),
    Advice(
        re.compile(r"^\s*(?P<at>(?:rule\s+)?(?:if|when|case)\b.*)", ANY_CASE),
        "a controller has neither rules nor 'if': they belong in a rule base",
        "write them into a rule base, in this file or another, and  u = rules NAME(e, ce)  here",
    ),
    Advice(
        re.compile(rf"\b(?:{_OF_SIGNALS})\s+of\s+(?P<at>{_SOURCE})"),
        "a source is taken of a signal",
        _above,
        _LINE,
    ),
    Advice(
        re.compile(rf"\b(?:{_OF_SIGNALS})\s+of\s+\((?P<at>[^()]*)\)"),
        "a source is taken of a signal",
        _above,
        _LINE,
    ),
    Advice(
        re.compile(rf"\b(?:rules|table)\s+{NAME}\s*\((?:[^,()]*,)*\s*(?P<at>[^,()]*[*/+][^,()]*)"),
        "the inputs of a rule base are signals",
        _above,
        _LINE,
    ),
    Advice(
        re.compile(rf"\b(?P<at>{'|'.join(_FUNCTIONS)})\s*\(", ANY_CASE),
        _no_function,
        _in_place_of,
        _LINE,
    ),
    Advice(
        re.compile(rf"=\s*(?:\S.*?[-+*/]|-)\s*(?P<at>{_SOURCE})"),
        "a line has one source, at its start",
        lambda m: f"write  x = {' '.join(m['at'].split())}  above, and x here",
        (SIGNAL,),
    ),
    Advice(
        re.compile(rf"(?P<at>{_SOURCE})"),
        "a drive is a sum of signals",
        _above,
        ("drive",),
    ),
    Advice(
        re.compile(rf"(?P<at>{_SOURCE})\s*(?:[*/][^-+,]*)?[-+]"),
        "a line has only one source, with factors",
        _above,
        (SIGNAL,),
    ),
    Advice(
        re.compile(r"\((?P<at>[^()]*[-+*/][^()]*)\)"),
        "sums have no parentheses",
        _above,
        _LINE,
    ),
    Advice(
        re.compile(rf"=\s*(?P<at>{'|'.join(SOURCES)})\s*$"),
        lambda m: f"'{m['at']}' is a source: its signal is missing",
        lambda m: f"as in  error of position ; a signal of that name is  '{m['at']}'",
        (SIGNAL,),
    ),
    Advice(
        re.compile(rf"\b(?P<at>(?:rules|table)\s+({NAME}))(?!\s*\()"),
        "the inputs are missing",
        lambda m: f"write them in parentheses:  {' '.join(m['at'].split())}(e, ce)",
        _LINE,
    ),
    Advice(
        re.compile(rf"(?P<at>({NAME})\.(?:{NAME}))"),
        "a line with rules names the outputs, all at once",
        lambda m: f"write  u = rules {m[2]}(e, ce)",
        _LINE,
    ),
    Advice(
        re.compile(rf"=\s*(?P<at>(?!(?:partner|{'|'.join(SOURCES)})\b){NAME})\s+of\b"),
        lambda m: f"unknown source '{m['at']}'",
        lambda m: near_hint(m["at"], SOURCES)[0] or f"there are {', '.join(SOURCES)}",
        (SIGNAL,),
    ),
    Advice(
        re.compile(rf"\bwithin\s+(?P<at>{NUMBER})\s*(?=,|$)"),
        "limits are two numbers",
        lambda m: f"as in  within {_mirrored(m['at'])}",
        _LINE,
    ),
    Advice(
        re.compile(r"\bwithin\b[^,]*(?P<at>[-+]?\binf\b)"),
        "a limit is a number",
        "a drive without limits has no  within",
        ("drive",),
    ),
    Advice(
        re.compile(r"\btune\s*(?P<at>(?:log)?)\s*$"),
        "its range is missing",
        "as in  tune 2 .. 200 log",
        ("gain",),
    ),
    Advice(
        re.compile(r"=\s*(?P<at>[^,\"]*(?:[^\W\d]\w*|\().*)"),
        "a gain is a number, or numbers and pi between * and /",
        "compute it from other gains or signals on a line of an axis",
        ("gain",),
    ),
    Advice(
        re.compile(r'^\s*controller\s+(?P<at>"[^"]*")'),
        "a controller has a name",
        lambda m: f"write  controller NAME {m['at']}",
        ("controller",),
    ),
)
"""Advice on lines that no slip corrects; the first match counts."""


def _mirrored(number: str) -> str:
    return f"-{number} .. {number}" if number[0] not in "-+" else f"{number} .. {number[1:]}"
