"""A project as SCL, the Structured Text of Siemens' TIA Portal (an external source).

The text is that of a ``.st`` in another dialect: local names have ``#`` before them and blocks
are in quotation marks; a function of several parameters is called with their names; arrays are
not constants; a function has no state; and there is no program, so that the self-test is a block
as well.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from fuzzyarm.exchange.export.numbers import ExportError
from fuzzyarm.exchange.export.structured_text import Declaration, Project, Unit

_TYPES = {
    "REAL": "Real", "LREAL": "LReal", "SINT": "SInt", "INT": "Int", "DINT": "DInt", "BOOL": "Bool",
}  # fmt: skip

LONGEST = 125
"""Letters of a name in the TIA Portal."""

_BY_NAME = {"MIN": ("IN1", "IN2"), "MAX": ("IN1", "IN2")}
_ONE_OPERAND = frozenset(
    ["ABS", "SQRT", "SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN", "EXP", "LN", "TRUNC"]
)
_WORDS = frozenset(
    """
    AND BY DO ELSE END_FOR END_IF END_WHILE EXIT FALSE FOR IF MOD NOT OR RETURN THEN TO TRUE WHILE
    """.split()  # noqa: SIM905
)
"""Tokens of statements."""

_QUOTED = frozenset(
    """
    authors begin block_db block_fb block_fc block_sdb char continue counter data_block
    date_and_time eno family goto known_how_to_protect label name nil ok organization_block region
    s5time timer title variant version void wchar
    """.split()  # noqa: SIM905
)
"""Words of SCL that the standard does not have; such a name is quoted."""

_TOKEN = re.compile(
    r"(?P<space>\s+)|(?P<remark>\(\*.*?\*\))|(?P<number>(?:LREAL#)?\d[\d.]*(?:E[+-]?\d+)?)"
    r"|(?P<word>[A-Za-z_]\w*)|(?P<sign><>|<=|>=|:=|.)",
    re.DOTALL,
)


def scl_source(project: Project) -> str:
    """Return the text of a file; ExportError for a function of mathematics that SCL lacks."""
    units = {unit.name: unit for unit in project.units}
    return "\n".join(_SclUnit(unit, units).text() for unit in project.units)


@dataclass
class _SclUnit:
    """One unit in the dialect."""

    unit: Unit
    units: dict[str, Unit]
    types: dict[str, str] = field(default_factory=dict)  # of the variables

    def __post_init__(self) -> None:
        for declarations in self.unit.sections.values():
            self.types |= {declaration.name: declaration.type for declaration in declarations}
        if self.unit.sort == "FUNCTION":
            self.types[self.unit.name] = self.unit.returned

    def text(self) -> str:
        """Return the block."""
        is_function = self.unit.sort == "FUNCTION"
        sort = "FUNCTION" if is_function else "FUNCTION_BLOCK"
        returned = f" : {_TYPES[self.unit.returned]}" if is_function else ""
        lines = [
            f'{sort} "{self.unit.name}"{returned}',
            "{ S7_Optimized_Access := 'TRUE' }",
            "VERSION : 0.1",
            *self._head(),
            *self._declared(),
            "BEGIN",
            *(f"    {line}" if line else "" for line in self._statements().split("\n")),
            f"END_{sort}",
            "",
        ]
        return "\n".join(lines)

    def _head(self) -> list[str]:
        lines = self.unit.head.split("\n") if self.unit.head else []
        return ["(*", *(f" {line}".rstrip() for line in lines), "*)"] if lines else []

    def _declared(self) -> list[str]:
        is_function = self.unit.sort == "FUNCTION"
        # No array is a constant, and a function has no variables that stay.
        titles = {"VAR CONSTANT": "VAR", "VAR": "VAR_TEMP" if is_function else "VAR"}
        groups: dict[str, list[str]] = {}
        for title, declarations in self.unit.sections.items():
            group = groups.setdefault(titles.get(title, title), [])
            group += map(self._declaration, declarations)
        return [line for title, lines in groups.items() for line in (f"{title}", *lines, "END_VAR")]

    def _declaration(self, declaration: Declaration) -> str:
        name = declaration.name
        kind = _TYPES.get(declaration.type, f'"{declaration.type}"')
        if declaration.last is not None:
            kind = f"Array[0..{declaration.last}] of {kind}"
        start = f" := {declaration.start}" if declaration.start else ""
        remark = f" // {declaration.remark}" if declaration.remark else ""
        return f"    {_local(name)} : {kind}{start};{remark}"

    # --- Statements ---

    def _statements(self) -> str:
        return self._translated(_tokens(self.unit.statements)).rstrip("\n")

    def _translated(self, tokens: Sequence[tuple[str, str]]) -> str:
        """Return some tokens in the dialect."""
        parts: list[str] = []
        i = 0
        while i < len(tokens):
            sort, text = tokens[i]
            before = parts[-1] if parts else ""
            if sort == "word" and before != ".":
                if i + 1 < len(tokens) and tokens[i + 1][1] == "(" and text not in _WORDS:
                    end = _closing(tokens, i + 1)
                    parts.append(self._called(text, tokens[i + 2 : end]))
                    i = end + 1
                    continue
                parts.append(self._word(text))
            else:
                parts.append(_local(text) if sort == "word" else text)
            i += 1
        return "".join(parts)

    def _word(self, text: str) -> str:
        if text in self.types:
            return f"#{_local(text)}"
        assert text in _WORDS, text
        return text

    def _called(self, name: str, tokens: Sequence[tuple[str, str]]) -> str:
        """Return a call: of an instance, of a function of the file, of one of the language."""
        arguments = _split(tokens)
        if name in self.types:  # an instance, whose arguments have their names
            passed = ", ".join(self._named(argument) for argument in arguments)
            return f"#{_local(name)}({passed})"
        texts = [self._translated(argument).strip() for argument in arguments]
        if name == "EXPT":
            return f"(({texts[0]}) ** ({texts[1]}))"
        if name in _ONE_OPERAND or "_TO_" in name:
            return f"{name}({', '.join(texts)})"
        if name in _BY_NAME:
            parameters: Sequence[str] = _BY_NAME[name]
        elif name in self.units:
            unit = self.units[name]
            parameters = [
                _local(port) for title in ("VAR_INPUT", "VAR_IN_OUT") for port in unit.ports(title)
            ]
            name = f'"{name}"'
        else:
            raise ExportError(f"SCL has no function for '{name}'", hint="export C, or a table")
        pairs = zip(parameters, texts, strict=True)
        return f"{name}({', '.join(f'{parameter} := {text}' for parameter, text in pairs)})"

    def _named(self, tokens: Sequence[tuple[str, str]]) -> str:
        """Return an argument after its name."""
        words = [token for token in tokens if token[0] != "space"]
        (_, name), (_, sign), *_ = words
        assert sign == ":="
        at = next(i for i, token in enumerate(tokens) if token[1] == ":=")
        return f"{_local(name)} := {self._translated(tokens[at + 1 :]).strip()}"


def _local(name: str) -> str:
    """Return a name, in quotation marks if it is a word of SCL."""
    if len(name) > LONGEST:
        raise ExportError(
            f"'{name[:20]}…' has {len(name)} letters, and the TIA Portal takes {LONGEST}",
            hint="give it a shorter name",
        )
    return f'"{name}"' if name.lower() in _QUOTED else name


def _tokens(text: str) -> list[tuple[str, str]]:
    """Return the tokens of statements, and the sort of each."""
    return [(match.lastgroup or "", match[0]) for match in _TOKEN.finditer(text)]


def _closing(tokens: Sequence[tuple[str, str]], opening: int) -> int:
    """Return the index of the parenthesis that closes a token."""
    depth = 0
    for i in range(opening, len(tokens)):
        depth += (tokens[i][1] == "(") - (tokens[i][1] == ")")
        if not depth:
            return i
    raise AssertionError("a parenthesis is open")


def _split(tokens: Sequence[tuple[str, str]]) -> list[list[tuple[str, str]]]:
    """Split at commas outside parentheses."""
    parts: list[list[tuple[str, str]]] = [[]]
    depth = 0
    for token in tokens:
        depth += (token[1] in "([") - (token[1] in ")]")
        if token[1] == "," and not depth:
            parts.append([])
        else:
            parts[-1].append(token)
    return parts
