"""Structured Text, run by a small interpreter: functions, function blocks and their instances.

It knows what the standard says of the statements that are exported, no more; a variable holds
a value of its type, and a whole number that does not fit is a failure.
"""

from __future__ import annotations

import math
import re

import numpy as np

WIDTHS = {"INT": 16, "SINT": 8, "DINT": 32}
REALS = {"REAL": np.float32, "LREAL": np.float64}

_UNIT = re.compile(r"(FUNCTION_BLOCK|FUNCTION) (\w+)(?: : (\w+))?\n(.*?)END_\1\b", re.DOTALL)
_SECTION = re.compile(
    r"^VAR(_INPUT|_OUTPUT|_IN_OUT| CONSTANT| RETAIN|)\n(.*?)^END_VAR$", re.DOTALL | re.MULTILINE
)
_DECLARATION = re.compile(
    r"(\w+) : ((?:ARRAY \[0\.\.\d+\] OF )?\w+)(?: := (\[.*?\]|[^;]*))?;", re.DOTALL
)


class Whole(int):
    """An integer of Structured Text: its division drops the remainder towards zero."""

    def _of(self, value):
        assert -(2**31) <= value < 2**31, "DINT overflows"
        return Whole(value)

    def __add__(self, other):
        return self._of(int(self) + int(other))

    __radd__ = __add__

    def __sub__(self, other):
        return self._of(int(self) - int(other))

    def __rsub__(self, other):
        return self._of(int(other) - int(self))

    def __mul__(self, other):
        return self._of(int(self) * int(other))

    def __truediv__(self, other):
        quotient = abs(int(self)) // abs(int(other))
        return self._of(quotient if (self >= 0) == (other >= 0) else -quotient)


def stored(kind, value):
    """Return a value as a variable of this type holds it."""
    if kind in REALS:
        return REALS[kind](value)
    if kind == "BOOL":
        return bool(value)
    width = WIDTHS[kind]
    assert -(2 ** (width - 1)) <= value < 2 ** (width - 1), f"{kind} overflows"
    return Whole(value)


def _literal(kind, text):
    return stored(kind, {"TRUE": True, "FALSE": False}.get(text) if kind == "BOOL" else float(text)
                  if kind in REALS else int(text))  # fmt: skip


class Program:
    """All functions and function blocks of a file, each compiled to Python once."""

    def __init__(self, text, real="LREAL"):
        code = re.sub(r"\(\*.*?\*\)", "", text, flags=re.DOTALL)
        self.real = REALS[real]
        self.units = {}
        for sort, name, kind, body in _UNIT.findall(code):
            assert name.lower() not in self.units, "two of one name"
            self.units[name.lower()] = _Unit(self, sort, name, kind, body)

    def instance(self, name):
        """Return a new instance of a function block."""
        return Instance(self.units[name.lower()])


class _Unit:
    def __init__(self, program, sort, name, kind, body):
        self.program, self.sort, self.name, self.kind = program, sort, name.lower(), kind
        self.declared, self.inputs, self.outputs, self.constant = {}, [], [], set()
        self.references = set()  # what is given by reference
        for section, lines in _SECTION.findall(body):
            for variable, type_name, start in _DECLARATION.findall(lines):
                key = variable.lower()
                assert key not in self.declared, f"{variable}: the language ignores case"
                self.declared[key] = (type_name, start)
                if section in {"_INPUT", "_IN_OUT"}:
                    self.inputs.append(key)
                if section == "_IN_OUT":
                    self.references.add(key)
                elif section == "_OUTPUT":
                    self.outputs.append(key)
                elif section == " CONSTANT":
                    self.constant.add(key)
        if sort == "FUNCTION":
            self.declared[self.name] = (kind, "")
        statements = body.rpartition("END_VAR")[2]
        lines = [f"    {line}" for line in self._python(statements).split("\n")]
        self.code = compile("\n".join(["def body(v):", *lines, "    pass"]), self.name, "exec")

    def start(self):
        """Return the variables of a new instance."""
        values = {}
        for key, (type_name, start) in self.declared.items():
            if key in self.references:
                continue
            kind = type_name.split()[-1]
            if "ARRAY" in type_name:
                size = int(re.search(r"\.\.(\d+)", type_name)[1]) + 1
                cells = (
                    [_literal(kind, x.strip()) for x in start.strip("[]").split(",")]
                    if start
                    else [stored(kind, 0)] * size
                )
                assert len(cells) == size
                values[key] = cells
            elif kind in REALS or kind in WIDTHS or kind == "BOOL":
                values[key] = _literal(kind, start.strip()) if start else stored(kind, 0)
            else:
                values[key] = self.program.instance(kind)
        return values

    def _python(self, statements):
        lines, depth = [], 0
        for line in statements.split("\n"):
            words = line.strip()
            if not words:
                continue
            if words in {"END_IF;", "END_WHILE;", "END_FOR;"}:
                depth -= 1
                continue
            if words == "ELSE":
                lines.append("    " * (depth - 1) + "else:")
                continue
            indent = "    " * depth
            if match := re.fullmatch(r"(IF|WHILE) (.*) (THEN|DO)", words):
                lines.append(f"{indent}{match[1].lower()} {self._expression(match[2])}:")
                depth += 1
            elif match := re.fullmatch(r"FOR (\w+) := (.*) TO (.*?)(?: BY (-?\d+))? DO", words):
                index, step = match[1].lower(), int(match[4] or 1)
                start, end = (f"int({self._expression(match[i])})" for i in (2, 3))
                end += " + 1" if step > 0 else " - 1"
                ranged = f"map(Whole, range({start}, {end}, {step}))"
                lines.append(f"{indent}for v['{index}'] in {ranged}:")
                depth += 1
            elif words in {"RETURN;", "EXIT;"}:
                lines.append(indent + {"RETURN;": "return", "EXIT;": "break"}[words])
            elif (match := re.fullmatch(r"(\w+) := (\w+)\((.*)\);", words)) and self._changes(
                match[2].lower()
            ):
                unit = self.program.units[match[2].lower()]
                given = [part.strip() for part in _split(match[3])]
                pairs = list(zip(unit.inputs, given, strict=True))
                taken = ", ".join(
                    f"v['{text.lower()}']" if name in unit.references else self._expression(text)
                    for name, text in pairs
                )
                back = {name: text.lower() for name, text in pairs if name in unit.references
                        and "ARRAY" not in unit.declared[name][0]}  # fmt: skip
                assert set(back.values()) <= self.declared.keys() - self.constant, words
                kind = self.declared[match[1].lower()][0]
                called = f"changed('{unit.name}', v, {back}, ({taken},))"
                lines.append(f"{indent}v['{match[1].lower()}'] = stored('{kind}', {called})")
            elif match := re.fullmatch(r"(\w+)\((.*)\);", words):
                given = ", ".join(
                    f"'{name.strip().lower()}': {self._expression(value)}"
                    for name, value in (part.split(" := ") for part in _split(match[2]))
                )
                lines.append(f"{indent}v['{match[1].lower()}'].run(**{{{given}}})")
            else:
                match = re.fullmatch(r"(\w+)(\[.*?\])? := (.*);", words)
                assert match, words
                key = match[1].lower()
                assert key in self.declared.keys() - self.constant, words
                kind = self.declared[key][0].split()[-1]
                index = f"[{self._expression(match[2][1:-1])}]" if match[2] else ""
                value = f"stored('{kind}', {self._expression(match[3])})"
                lines.append(f"{indent}v['{key}']{index} = {value}")
        return "\n".join(lines)

    def _changes(self, name):
        """Whether a function changes single variables that it is given."""
        unit = self.program.units.get(name)
        return unit is not None and any(
            "ARRAY" not in unit.declared[key][0] for key in unit.references
        )

    def _expression(self, text):
        def word(match):
            token = match[0]
            if re.fullmatch(r"[A-Z]+_TO_[A-Z]+", token):
                return f"as_{token.rpartition('_')[2]}"
            if token[0].isdigit():
                return f"real({token})" if "." in token else token
            own = {"AND": "and", "OR": "or", "NOT": "not", "MOD": "%", "TRUE": "True",
                   "FALSE": "False"}.get(token)  # fmt: skip
            if own is not None or token in _FUNCTIONS:
                return own or token
            name, dot, member = token.lower().partition(".")
            if name in self.declared:
                return f"v['{name}']" + (f".values['{member}']" if dot else "")
            assert name in self.program.units, token
            return f"call_{name}"

        text = text.replace("<>", "!=")
        text = re.sub(r"(?<![<>:=!])=(?!=)", "==", text)
        return re.sub(r"\d[\d.]*(?:E[+-]?\d+)?|[A-Za-z_]\w*(?:\.\w+)?", word, text)


def _split(text):
    """Split at commas that stand in no parentheses."""
    parts, depth, last = [], 0, 0
    for i, letter in enumerate(text):
        depth += (letter == "(") - (letter == ")")
        if letter == "," and depth == 0:
            parts.append(text[last:i])
            last = i + 1
    return [*parts, text[last:]]


_FUNCTIONS = {
    "MIN": min, "MAX": max, "ABS": abs, "TRUNC": lambda x: Whole(math.trunc(float(x))),
    "SQRT": np.sqrt, "EXP": np.exp, "COS": np.cos, "SIN": np.sin,
    "EXPT": np.power, "LN": np.log, "TAN": np.tan, "ATAN": np.arctan,
}  # fmt: skip


class Instance:
    """An instance of a function block: its variables stay from call to call."""

    def __init__(self, unit):
        self.unit = unit
        self.values = unit.start()
        casts = {f"as_{k}": (lambda x, k=k: stored(k, x)) for k in [*WIDTHS, *REALS]}
        functions = {
            f"call_{name}": (lambda *given, each=each: _called(each, given))
            for name, each in unit.program.units.items()
            if each.sort == "FUNCTION"
        }
        own = {"stored": stored, "real": unit.program.real, "Whole": Whole,
               "changed": lambda *given: _changed(unit.program, *given)}  # fmt: skip
        self.names = {**own, **casts, **functions, **_FUNCTIONS}
        exec(unit.code, self.names)
        self.body = self.names["body"]

    def run(self, /, **given):
        """Set inputs and run the statements."""
        for name, value in given.items():
            assert name in self.unit.inputs, name
            kind = self.unit.declared[name][0]
            if "ARRAY" in kind:  # by reference
                assert name in self.unit.references
                size = int(re.search(r"\.\.(\d+)", kind)[1]) + 1
                assert isinstance(value, list)
                assert len(value) == size, (name, kind)
                self.values[name] = value
            else:
                self.values[name] = stored(kind, value)
        self.body(self.values)

    def outputs(self):
        """Return the outputs by name."""
        return {name: self.values[name] for name in self.unit.outputs}


_bodies = {}
"""An instance of each function that was called: its variables begin anew at every call."""


def _called(unit, given):
    return _run(unit, given)[unit.name]


def _run(unit, given):
    if unit not in _bodies:
        _bodies[unit] = Instance(unit)
    instance = _bodies[unit]
    outer, instance.values = instance.values, unit.start()  # for one that is inside itself
    instance.run(**dict(zip(unit.inputs, given, strict=True)))
    values, instance.values = instance.values, outer
    return values


def _changed(program, name, values, back, given):
    """Call a function and write back what it changed."""
    unit = program.units[name]
    after = _run(unit, given)
    for key, own in back.items():
        values[own] = after[key]
    return after[unit.name]
