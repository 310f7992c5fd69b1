"""Structured Text, run by a small interpreter: functions, function blocks and their instances.

It knows what the standard says of the statements that are exported, no more; a variable holds
a value of its type, and a whole number that does not fit is a failure. It is as strict as the
strictest compiler: nothing is converted by itself, a literal of an LREAL says so, no name is a word
of the language or of every block, and what a function takes by reference has a type with a name. A
literal of an LREAL outside an array is within single precision, as for matiec.
"""

from __future__ import annotations

import math
import re

import numpy as np

WIDTHS = {"INT": 16, "SINT": 8, "DINT": 32}
REALS = {"REAL": np.float32, "LREAL": np.float64}

WORDS = frozenset(
    """
    abs acos action add adr and and_then any any_bit any_date any_int any_num any_real array
    asin at atan atan2 bit bool by byte case char class concat configuration constant
    continue cos ctd ctu ctud date date_and_time delete derivative dint div do dt dword else
    elsif en end_action end_case end_class end_configuration end_for end_function
    end_function_block end_if end_interface end_method end_namespace end_program
    end_property end_repeat end_resource end_step end_struct end_transition end_type
    end_union end_var end_while eno eq exit exp expt extends f_edge f_trig false final find
    for from function function_block ge gt hysteresis if implements initial_step insert int
    integral interface interval jmp jmpc jmpcn ld ldate ldn le left len limit lint ln log
    lreal lt ltime ltod lword max method mid min mod move mul mux namespace ne non_retain
    not null of on or or_else override persistent pid pointer priority private program
    property protected public r_edge r_trig ramp read_only read_write real ref ref_to
    reference repeat replace resource ret retain retc retcn return right rol ror rs rtc sel
    sema shl shr sin single sint sizeof sqrt sr st step stn string struct sub super tan task
    then this time time_of_day to tod tof ton tp transition true trunc type udint uint ulint
    union until using usint var var_access var_config var_external var_global var_in_out
    var_input var_output var_temp wchar while with word wstring xor
    """.split()  # noqa: SIM905
)
"""Words that no variable, block or type may have as its name."""

_TYPE = re.compile(r"^TYPE\n    (\w+) : (ARRAY \[0\.\.\d+\] OF \w+);\nEND_TYPE\n", re.MULTILINE)
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


def within_single(text):
    """Whether single precision has the number of a literal as a normal one."""
    single = np.finfo(np.float32)
    return float(text) == 0.0 or single.tiny <= abs(float(text)) <= single.max


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
    if kind == "BOOL":
        return {"TRUE": True, "FALSE": False}[text]
    text = text.replace(f"{kind}#", "")
    if kind in REALS:
        assert "." in text, text
        return REALS[kind](text)
    return stored(kind, int(text))


def _named(name):
    """Return a name in small letters, which is none of the language's and has no lone underline."""
    assert re.fullmatch(r"[A-Za-z](_?[A-Za-z0-9])*", name), name
    assert name.lower() not in WORDS, name
    assert not re.fullmatch(r"[a-z]+_to_(u?[sdl]?int|l?real|bool)", name.lower()), name
    return name.lower()


class Program:
    """All functions and function blocks of a file, each compiled to Python once."""

    def __init__(self, text):
        code = re.sub(r"\(\*.*?\*\)", "", text, flags=re.DOTALL)
        self.types = {_named(name): kind for name, kind in _TYPE.findall(code)}
        self.units = {}
        for sort, name, kind, body in _UNIT.findall(_TYPE.sub("", code)):
            assert _named(name) not in self.units.keys() | self.types.keys(), "two of one name"
            self.units[name.lower()] = _Unit(self, sort, name, kind, body)
        for unit in self.units.values():
            local = unit.declared.keys() - ({unit.name} if unit.sort == "FUNCTION" else set())
            assert not local & (self.units.keys() | self.types.keys()), "a name of the file"

    def instance(self, name):
        """Return a new instance of a function block."""
        return Instance(self.units[name.lower()])


class _Unit:
    def __init__(self, program, sort, name, kind, body):
        self.program, self.sort, self.name, self.kind = program, sort, name.lower(), kind
        self.declared, self.inputs, self.outputs, self.constant = {}, [], [], set()
        self.references = set()  # what is given by reference
        self.types = {}  # of the variables, as they are declared
        for section, lines in _SECTION.findall(body):
            for variable, type_name, start in _DECLARATION.findall(lines):
                key = _named(variable)
                assert key not in self.declared, f"{variable}: the language ignores case"
                self.types[key] = type_name.lower() if type_name.lower() in program.types else (
                    type_name)  # fmt: skip
                self.declared[key] = (program.types.get(type_name.lower(), type_name), start)
                if section in {"_INPUT", "_IN_OUT"}:
                    self.inputs.append(key)
                if section == "_IN_OUT":
                    assert "ARRAY" not in type_name, f"{type_name} has no name"
                    self.references.add(key)
                elif section == "_OUTPUT":
                    self.outputs.append(key)
                elif section == " CONSTANT":
                    self.constant.add(key)
        if sort == "FUNCTION":
            self.declared[self.name] = (kind, "")
            self.types[self.name] = kind
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
                assert not start or kind not in REALS or within_single(start), start
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
                lines.append(f"{indent}{match[1].lower()} {self._of('BOOL', match[2])}:")
                depth += 1
            elif match := re.fullmatch(r"FOR (\w+) := (.*) TO (.*?)(?: BY (-?\d+))? DO", words):
                index, step = match[1].lower(), int(match[4] or 1)
                kind = self.types[index]
                assert kind in WIDTHS
                start, end = (f"int({self._of(kind, match[i])})" for i in (2, 3))
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
                taken = ", ".join(self._passed(unit, given))
                back = {name: text.lower() for name, text in zip(unit.inputs, given, strict=True)
                        if name in unit.references
                        and "ARRAY" not in unit.declared[name][0]}  # fmt: skip
                assert set(back.values()) <= self.declared.keys() - self.constant, words
                kind = self.types[match[1].lower()]
                assert kind == unit.kind, words
                called = f"changed('{unit.name}', v, {back}, ({taken},))"
                lines.append(f"{indent}v['{match[1].lower()}'] = stored('{kind}', {called})")
            elif match := re.fullmatch(r"(\w+)\((.*)\);", words):
                unit = self.program.units[self.types[match[1].lower()].lower()]
                given = ", ".join(
                    f"'{name.strip().lower()}': {self._of(unit.types[name.strip().lower()], value)}"
                    for name, value in (part.split(" := ") for part in _split(match[2]))
                )
                lines.append(f"{indent}v['{match[1].lower()}'].run(**{{{given}}})")
            else:
                match = re.fullmatch(r"(\w+)(\[.*?\])? := (.*);", words)
                assert match, words
                key = match[1].lower()
                assert key in self.declared.keys() - self.constant, words
                kind = self.declared[key][0].split()[-1]
                assert bool(match[2]) == ("ARRAY" in self.declared[key][0]), words
                index = f"[{self._index(match[2][1:-1])}]" if match[2] else ""
                lines.append(
                    f"{indent}v['{key}']{index} = stored('{kind}', {self._of(kind, match[3])})"
                )
        return "\n".join(lines)

    def _changes(self, name):
        """Whether a function changes single variables that it is given."""
        unit = self.program.units.get(name)
        return unit is not None and any(
            "ARRAY" not in unit.declared[key][0] for key in unit.references
        )

    def _of(self, kind, text):
        """Return an expression, which has to be of a type as it stands."""
        value, found = _Expression(self, text).parsed()
        assert _same(kind, found) == kind, (kind, found, text)
        return value

    def _index(self, text):
        value, found = _Expression(self, text).parsed()
        assert found in WIDTHS or found == "integer", text
        return value

    def _passed(self, unit, given):
        """Return the arguments of a function."""
        for name, text in zip(unit.inputs, given, strict=True):
            kind = unit.types[name]
            if name in unit.references:
                assert self.types[text.lower()] == kind, (text, kind)
                yield f"v['{text.lower()}']"
            else:
                yield f"stored('{kind}', {self._of(kind, text)})"


def _same(a, b):
    """Return the type of two operands: a literal of an LREAL has its type, others take one."""
    if a == b:
        return a
    for kind, literal in ((a, b), (b, a)):
        if (literal == "integer" and kind in WIDTHS) or (literal == "real" and kind == "REAL"):
            return kind
    raise AssertionError(f"{a} and {b} are of two types")


class _Expression:
    """One expression, read by the precedence of the standard; values are Python and a type."""

    LEVELS = (("OR",), ("XOR",), ("AND",), ("=", "<>"), ("<", ">", "<=", ">="), ("+", "-"),
              ("*", "/", "MOD"))  # fmt: skip
    PYTHON = {"OR": "or", "XOR": "^", "AND": "and", "=": "==", "<>": "!=", "MOD": "%"}
    TOKEN = re.compile(
        r"\s*((?:LREAL#)?\d[\d.]*(?:E[+-]?\d+)?|[A-Za-z_]\w*(?:\.\w+)?|<>|<=|>=|[-+*/<>=()\[\],])"
    )

    def __init__(self, unit, text):
        self.unit, self.text = unit, text
        assert not self.TOKEN.sub("", text).strip(), text
        self.tokens = [*self.TOKEN.findall(text), ""]

    def parsed(self):
        value = self._level(0)
        assert self.tokens == [""], (self.text, self.tokens)
        return value

    def _next(self, wanted=None):
        token = self.tokens.pop(0)
        assert wanted in (None, token), (self.text, token)
        return token

    def _level(self, level):
        if level == len(self.LEVELS):
            return self._unary()
        value, kind = self._level(level + 1)
        while self.tokens[0] in self.LEVELS[level]:
            sign = self._next()
            other, other_kind = self._level(level + 1)
            kind = _same(kind, other_kind)
            assert (kind == "BOOL") == (level < 3) or (kind == "BOOL" and level == 3), self.text
            assert sign != "MOD" or kind in WIDTHS, self.text
            value = f"({value} {self.PYTHON.get(sign, sign)} {other})"
            if sign == "MOD":
                value = f"Whole({value})"
            kind = "BOOL" if level in (3, 4) else kind
        return value, kind

    def _unary(self):
        if self.tokens[0] in ("-", "NOT"):
            sign = self._next()
            value, kind = self._unary()
            assert (kind == "BOOL") == (sign == "NOT"), self.text
            negative = f"(not {value})" if sign == "NOT" else f"(-{value})"
            return (f"Whole({negative})" if kind in WIDTHS else negative), kind
        return self._primary()

    def _primary(self):
        token = self._next()
        if token == "(":
            value = self._level(0)
            self._next(")")
            return value
        if token.startswith("LREAL#"):
            assert within_single(token[6:]), self.text
            return f"float64({token[6:]})", "LREAL"
        if token[0].isdigit():
            return (f"float32({token})", "real") if "." in token else (f"Whole({token})", "integer")
        if token in ("TRUE", "FALSE"):
            return token.title(), "BOOL"
        if self.tokens[0] == "(":
            return self._called(token)
        return self._variable(token)

    def _variable(self, token):
        name, dot, member = token.lower().partition(".")
        kind = self.unit.types[name]
        if dot:
            inner = self.unit.program.units[kind.lower()]
            assert member in inner.outputs, token
            return f"v['{name}'].values['{member}']", inner.types[member]
        if self.tokens[0] != "[":
            return f"v['{name}']", kind
        self._next("[")
        index, index_kind = self._level(0)
        assert index_kind in WIDTHS or index_kind == "integer", self.text
        self._next("]")
        declared = self.unit.declared[name][0]
        assert "ARRAY" in declared, self.text
        return f"v['{name}'][{index}]", declared.split()[-1]

    def _called(self, name):
        self._next("(")
        texts, given = [], []
        while True:
            before = list(self.tokens)
            given.append(self._level(0))
            texts.append(" ".join(before[: len(before) - len(self.tokens)]))
            if self._next() == ")":
                break
        if name in _FUNCTIONS:
            kind = given[0][1]
            for _, other in given[1:]:
                kind = _same(kind, other)
            if name not in ("MIN", "MAX", "ABS"):
                assert kind in REALS, self.text
            kind = "DINT" if name == "TRUNC" else kind
            return f"{name}({', '.join(value for value, _ in given)})", kind
        if match := re.fullmatch(r"([A-Z]+)_TO_([A-Z]+)", name):
            ((value, kind),) = given
            assert _same(match[1], kind) == match[1], self.text
            return f"as_{match[2]}({value})", match[2]
        unit = self.unit.program.units[name.lower()]
        assert unit.sort == "FUNCTION", name
        return f"call_{unit.name}({', '.join(self.unit._passed(unit, texts))})", unit.kind


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
        own = {"stored": stored, "Whole": Whole, "float32": np.float32, "float64": np.float64,
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


def demand_own_test(program: Program) -> None:
    """Run the test of a program: it passes, and fails where a number is another one."""
    test, wrong = (program.instance("made_test") for _ in range(2))
    test.run()
    assert test.values["passed"]
    points = wrong.values["points_0"]
    points[-1] = type(points[-1])(points[-1] + 1)
    wrong.run()
    assert not wrong.values["passed"], "a test that cannot fail"
