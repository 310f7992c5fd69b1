"""A reader of SCL by what Siemens documents of external sources, back to Structured Text.

It refuses what the TIA Portal would: a local name without `#`, a block without quotation marks, a
function of several parameters without their names, an array that is a constant, an input of a
function that is written to, a variable of a function that would have to stay.
"""

from __future__ import annotations

import re

TYPES = {"Real": "REAL", "LReal": "LREAL", "Int": "INT", "SInt": "SINT", "DInt": "DINT",
         "Bool": "BOOL"}  # fmt: skip

KEYWORDS = {
    "AND", "BY", "DO", "ELSE", "END_FOR", "END_IF", "END_WHILE", "EXIT", "FALSE", "FOR", "IF",
    "MOD", "NOT", "OR", "RETURN", "THEN", "TO", "TRUE", "WHILE",
}  # fmt: skip
ONE_OPERAND = {"ABS", "SQRT", "SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN", "EXP", "LN", "TRUNC"}

_BLOCK = re.compile(
    r'(FUNCTION_BLOCK|FUNCTION) "(\w+)"(?: : (\w+))?\n'
    r"\{ S7_Optimized_Access := 'TRUE' \}\nVERSION : 0\.1\n"
    r"((?:VAR[ A-Z_]*\n.*?^END_VAR\n)*)BEGIN\n(.*?)^END_\1$",
    re.DOTALL | re.MULTILINE,
)
_SECTION = re.compile(r"^(VAR[ A-Z_]*)\n(.*?)^END_VAR\n", re.DOTALL | re.MULTILINE)
_DECLARATION = re.compile(
    r'^    ("?)(\w+)\1 : (?:Array\[0\.\.(\d+)\] of )?("?)(\w+)\4(?: := (\[.*?\]|[^;]*))?;$',
    re.DOTALL | re.MULTILINE,
)
_TOKEN = re.compile(
    r'\s+|#"?(?P<local>[A-Za-z]\w*)"?|"(?P<block>\w+)"|(?P<number>(?:LREAL#)?\d[\d.]*(?:E[+-]?\d+)?)'
    r"|(?P<word>[A-Za-z]\w*)|(?P<sign>:=|<>|<=|>=|\*\*|[-+*/<>=()\[\],.;])",
)


class Block:
    def __init__(self, sort, name, returned, sections, body):
        self.sort, self.name, self.returned, self.body = sort, name, returned, body
        self.sections = {}
        self.locals = {name} if sort == "FUNCTION" else set()
        for title, lines in _SECTION.findall(sections):
            assert title in {"VAR_INPUT", "VAR_OUTPUT", "VAR_IN_OUT", "VAR", "VAR RETAIN",
                             "VAR_TEMP"}, title  # fmt: skip
            assert title not in self.sections, "a section twice"
            assert not (sort == "FUNCTION" and title in {"VAR", "VAR RETAIN", "VAR_OUTPUT"})
            assert not (sort == "FUNCTION_BLOCK" and title == "VAR_TEMP")
            found = _DECLARATION.findall(lines)
            assert len(found) == len(re.findall(r";$", lines, re.MULTILINE)), lines
            for _, variable, last, quoted, kind, start in found:
                assert bool(quoted) == (kind not in TYPES), kind
                assert not (start and title in {"VAR_TEMP", "VAR_IN_OUT"})
                assert variable.lower() not in {each.lower() for each in self.locals}
                assert not last or not start or len(start.split(",")) == int(last) + 1
                self.locals.add(variable)
            self.sections[title] = [each[1:] for each in found]

    def names(self, *titles):
        return [each[0] for title in titles for each in self.sections.get(title, [])]


class Reader:
    def __init__(self, text):
        text = re.sub(r"^ *\(\*.*?\*\)\n", "", text, flags=re.DOTALL | re.MULTILINE)
        text = re.sub(r"\(\*.*?\*\)", "", text, flags=re.DOTALL)
        text = re.sub(r" *//.*", "", text)
        text = re.sub(r" +$", "", text, flags=re.MULTILINE)
        found = _BLOCK.findall(text)
        assert not _BLOCK.sub("", text).strip(), _BLOCK.sub("", text)[:300]
        self.blocks = {}
        self.types = {}  # names for the types of arrays, which SCL tells apart by what they hold
        for parts in found:
            assert parts[1].lower() not in {name.lower() for name in self.blocks}
            self.blocks[parts[1]] = Block(*parts)

    def text(self):
        """Return everything as Structured Text."""
        units = "\n".join(map(self.unit, self.blocks.values()))
        return "".join(self.types.values()) + units

    def unit(self, block):
        lines = [f"{block.sort} {block.name}"
                 + (f" : {TYPES[block.returned]}" if block.returned else "")]  # fmt: skip
        for title, variables in block.sections.items():
            lines.append({"VAR_TEMP": "VAR"}.get(title, title))
            for name, last, _, kind, start in variables:
                array = f"ARRAY [0..{last}] OF {TYPES[kind]}" if last else ""
                if array and (title == "VAR_IN_OUT" or block.sort == "FUNCTION_BLOCK"):
                    type_name = f"array_{last}_{kind.lower()}_t"
                    self.types[type_name] = f"TYPE\n    {type_name} : {array};\nEND_TYPE\n\n"
                    array = type_name
                begins = f" := {start}" if start else ""
                lines.append(f"    {name} : {array or TYPES.get(kind, kind)}{begins};")
            lines.append("END_VAR")
        body = [self.line(line, block) for line in block.body.split("\n")]
        return "\n".join([*lines, "", *body, f"END_{block.sort}", ""])

    def line(self, line, block):
        tokens, end = [], 0
        for match in _TOKEN.finditer(line):
            assert match.start() == end, line
            end = match.end()
            if match.lastgroup:
                tokens.append((match.lastgroup, match[match.lastgroup]))
        assert end == len(line), line
        if not tokens:
            return ""
        if len(tokens) > 1 and tokens[0][0] == "local":
            assert not (block.sort == "FUNCTION" and tokens[0][1] in block.names("VAR_INPUT")), (
                f"an input is written to: {line}"
            )
        return self.translated(tokens, block)

    def translated(self, tokens, block):
        parts, i = [], 0
        while i < len(tokens):
            sort, text = tokens[i]
            following = tokens[i + 1][1] if i + 1 < len(tokens) else ""
            if parts and parts[-1] == ".":
                assert sort in {"word", "block"}
                parts.append(text)
            elif sort == "local":
                assert text in block.locals, text
                if following == "(":
                    end, given = self.arguments(tokens, i + 1)
                    kind = next(e[3] for e in block.sections["VAR"] if e[0] == text)
                    own = self.blocks[kind].names("VAR_INPUT")
                    assert {name for name, _ in given} <= set(own)
                    inner = ", ".join(f"{n} := {self.translated(v, block)}" for n, v in given)
                    parts.append(f"{text}({inner})")
                    i = end
                else:
                    parts.append(text)
            elif following == "(" and text not in KEYWORDS and sort in {"word", "block"}:
                end, given = self.arguments(tokens, i + 1)
                if sort == "block":
                    own = self.blocks[text].names("VAR_INPUT", "VAR_IN_OUT")
                elif text in {"MIN", "MAX"}:
                    own = ["IN1", "IN2"]
                else:
                    assert text in ONE_OPERAND or re.fullmatch("[A-Z]+_TO_[A-Z]+", text), text
                    own = [""]
                assert [name for name, _ in given] == own, (text, given)
                inner = ", ".join(self.translated(value, block) for _, value in given)
                parts.append(f"{text}({inner})")
                i = end
            else:
                assert sort in {"number", "sign"} or text in KEYWORDS, text
                parts.append(text)
            i += 1
        text = ""
        for part in parts:
            tight = part in {".", ",", ";", ")", "]", "["} or text[-1:] in {"", ".", "(", "["}
            minus = text[-2:] in {"(-", "[-"} or text.endswith(" BY -")
            text += part if tight or minus else f" {part}"
        return re.sub(r"\[ ", "[", text)

    def arguments(self, tokens, opening):
        """Return the index of the closing parenthesis, and pairs of a name and tokens."""
        depth, parts = 0, [[]]
        for i in range(opening, len(tokens)):
            _, text = tokens[i]
            depth += (text in {"(", "["}) - (text in {")", "]"})
            if not depth:
                break
            if text == "," and depth == 1:
                parts.append([])
            elif i > opening:
                parts[-1].append(tokens[i])
        pairs = []
        for part in parts:
            named = len(part) > 1 and part[1][1] == ":="
            pairs.append((part[0][1], part[2:]) if named else ("", part))
        return i, pairs
