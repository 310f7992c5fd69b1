"""Tables and rule bases as IEC 61131-3 Structured Text: a function block for each, for PLCs.

The constants of a function block are set once; those of a function would be copied at every
call. The arithmetic is that of the C file.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from fuzzyarm.export.listing import WALKED, Loop, Walked, element, function_body
from fuzzyarm.export.names import Names, identifier
from fuzzyarm.export.numbers import ST_TYPES, ExportError, Kind, rounded, st_literal, st_number
from fuzzyarm.export.program import Call
from fuzzyarm.export.routine import Routine, comment, number_lines, routine_words
from fuzzyarm.export.rulebase import DirectRoutine
from fuzzyarm.export.table import Side, TableCode, TableRoutine
from fuzzyarm.export.walk_st import walk_in_st
from fuzzyarm.expression.nodes import Constant, Node, symbols
from fuzzyarm.expression.printing import (
    STRUCTURED_TEXT,
    Assign,
    Choose,
    Language,
    NotPrintableError,
    Statement,
    setting,
    statements,
    variables,
)
from fuzzyarm.version import __version__


def structured_text(routines: Sequence[Routine], prefix: str) -> tuple[str, list[str]]:
    """Return a file with a function block for every routine, and the names of the blocks."""
    names = Names("st")
    blocks, block_names = [], []
    for routine in routines:
        name = names.new(f"{prefix}_{identifier(routine.output.name)}")
        block_names.append(name)
        with printable_only():
            blocks.append(block_of(routine, name, names).text())
    return "\n".join(blocks), block_names


@contextmanager
def printable_only() -> Iterator[None]:
    """Say so of a function that the language does not have."""
    try:
        yield
    except NotPrintableError as error:
        raise ExportError(str(error), hint="export C, or a table") from None


def block_of(routine: Routine, name: str, names: Names) -> TableBlock | RulesBlock:
    """Return the function block of a routine; `names` are those of the file."""
    if isinstance(routine, TableRoutine):
        return TableBlock(routine, name)
    assert isinstance(routine, DirectRoutine)
    return RulesBlock(routine, name, names)


def head_comment(words: Sequence[str]) -> list[str]:
    """Return lines as a comment."""
    return comment(words, "(*", " *", " *)")


def st_numbers(real: Kind) -> Language:
    """Return Structured Text with its own functions for the smaller and the greater of two."""
    spellings = {"minimum": "MIN({0}, {1})", "maximum": "MAX({0}, {1})"}

    def number(value: float) -> str:
        if not math.isfinite(value):
            raise ExportError("Structured Text has no infinite number", hint="export C")
        return st_literal(value, real)

    return STRUCTURED_TEXT._replace(
        text=lambda operation: spellings.get(operation.name, operation.st), number=number, rename={}
    )


class TableBlock(TableCode):
    """The function block of a table: its variables are declared apart from the statements."""

    types = ST_TYPES
    number = staticmethod(st_number)

    def __init__(self, routine: TableRoutine, name: str) -> None:
        self.routine = routine
        self.name = name
        self.names = Names("st", {name})
        core, table = routine.core, routine.core.table
        self.inputs = [self.names.new(axis.name) for axis in table.axes]
        self.output = self.names.new(table.output)
        super().__init__(core, self.inputs)
        self.language = st_numbers(core.precision[2])
        self.constants: list[str] = []
        self.variables: list[tuple[str, str]] = []
        self.index = "INT" if core.values.size <= 0x7FFF else "DINT"

    def text(self) -> str:
        """Return the block."""
        statements = self._interpolate() if self.core.linear else self._pick()
        constants = ["VAR CONSTANT", *self.constants, "END_VAR"] if self.constants else []
        variables = [f"    {name} : {kind};" for name, kind in self.variables]
        lines = [
            *head_comment(
                [
                    f"made by fuzzyarm {__version__}; do not edit: make it again from its source",
                    "",
                    *routine_words(self.routine),
                ]
            ),
            f"FUNCTION_BLOCK {self.name}",
            "VAR_INPUT",
            *(f"    {name} : {self.outer};" for name in self.inputs),
            "END_VAR",
            "VAR_OUTPUT",
            f"    {self.output} : {self.outer};",
            "END_VAR",
            *constants,
            *(["VAR", *variables, "END_VAR"] if variables else []),
            "",
            *statements,
            "END_FUNCTION_BLOCK",
            "",
        ]
        return "\n".join(lines)

    # ── parts ────────────────────────────────────────────────────────────────────────

    def _variable(self, stem: str, kind: str) -> str:
        name = self.names.new(stem)
        self.variables.append((name, kind))
        return name

    def _array(self, stem: str, literals: Sequence[str], columns: int = 0) -> str:
        name = self.names.new(stem)
        lines = number_lines(literals, columns, indent="        ")
        head = f"    {name} : ARRAY [0..{len(literals) - 1}] OF {self.inner} := ["
        self.constants.append("\n".join([head, *lines, "    ];"]))
        return name

    def _values(self) -> str:
        literals = self.literals(self.core.values)
        return self._array(f"{self.output}_values", literals, self.core.table.shape[-1])

    def _widened(self, expression: str) -> str:
        same = self.inner == self.wide
        return expression if same else f"{self.inner}_TO_{self.wide}({expression})"

    def _narrowed(self, expression: str) -> str:
        if self.wide == self.outer:
            return expression
        return f"{self.wide}_TO_{self.outer}({expression})"

    def _search(
        self, points: str, first: int, count: int, x: str, comparison: str
    ) -> tuple[list[str], str]:
        """Return a bisection; afterwards the variable `low` counts the points from `first`."""
        if not hasattr(self, "bounds"):
            self.bounds = [self._variable(role, self.index) for role in ("low", "high", "middle")]
        low, high, middle = self.bounds
        index = f"{middle} + {first}" if first else middle
        return [
            f"{low} := 0;",
            f"{high} := {count};",
            f"WHILE {low} < {high} DO",
            f"    {middle} := ({low} + {high}) / 2;",
            f"    IF {points}[{index}] {comparison} {x} THEN",
            f"        {low} := {middle} + 1;",
            "    ELSE",
            f"        {high} := {middle};",
            "    END_IF;",
            "END_WHILE;",
        ], low

    def _pick(self) -> list[str]:
        lines, cell = self._found_cell()
        return [*lines, f"{self.output} := {self._values()}[{cell}];"]

    def _found_cell(self) -> tuple[list[str], str]:
        """Return how the number of the cell is found, and its variable."""
        cell = self._variable("cell", self.index)
        what = "bins" if self.core.mode == "bins" else "middles"
        lines = [f"{cell} := 0;"]
        for side in self.sides:
            edges = self._array(f"{side.name}_{what}", self.points(side))
            search, low = self._search(edges, 0, side.size - 1, side.name, "<")
            lines += [*search, f"{cell} := {cell} * {side.size} + {low};"]
        return lines, cell

    def _interpolate(self) -> list[str]:
        cell = self._variable("cell", self.index)
        lines = [f"{cell} := 0;"]
        shares = []
        for side in self.sides:
            part, share = self._neighbour(side, cell)
            lines += part
            shares.append(share)
        values = self._values()
        corners = [
            self._widened(f"{values}[{cell} + {offset}]" if offset else f"{values}[{cell}]")
            for offset in self.offsets
        ]
        targets = [self._variable(f"v{k}", self.wide) for k in range(len(corners) // 2)]
        product = self._variable("product", "DINT") if self.fixed else ""

        def assign(side: int, pair: int, near: str, far: str) -> str:
            nonlocal lines
            lines += self._blend(targets[pair], near, far, shares[side], product)
            return targets[pair]

        value = self.blended(corners, shares, assign)
        return [*lines, f"{self.output} := {self._narrowed(value)};"]

    def _neighbour(self, side: Side, cell: str) -> tuple[list[str], str]:
        """Clamp one input, find its lower neighbour and the share of the way to the upper."""
        name, points = side.name, self.points(side)
        levels = self._array(f"{name}_levels", points)
        x, share = self._variable(f"x_{name}", self.inner), self._variable(f"t_{name}", self.wide)
        argument = name if self.inner == self.outer else f"{self.outer}_TO_{self.inner}({name})"
        search, low = self._search(levels, 1, side.size - 2, x, "<=")
        way = [self._widened(text) for text in (x, f"{levels}[{low}]", f"{levels}[{low} + 1]")]
        value = self.share(*way)
        if self.fixed:
            value = f"({way[0]} - {way[1]}) * 32768 / ({way[2]} - {way[1]})"
        step = low if side.stride == 1 else f"{low} * {side.stride}"
        first, last = (
            st_literal(float(text), self.core.precision[1]) for text in (points[0], points[-1])
        )
        return [
            f"{x} := {first};",
            f"IF {argument} > {x} THEN",
            f"    {x} := {argument};",
            "END_IF;",
            f"IF {x} > {last} THEN",
            f"    {x} := {last};",
            "END_IF;",
            *search,
            f"{share} := {value};",
            f"{cell} := {cell} + {step};",
        ], share

    def _blend(self, target: str, near: str, far: str, share: str, product: str) -> list[str]:
        if not self.fixed:
            return [f"{target} := {self.blend(near, far, share)};"]
        # Rounded to the nearest, ties away from zero; DINT / DINT drops the remainder.
        return [
            f"{product} := ({far} - {near}) * {share};",
            f"IF {product} >= 0 THEN",
            f"    {target} := {near} + ({product} + 16384) / 32768;",
            "ELSE",
            f"    {target} := {near} - (16384 - {product}) / 32768;",
            "END_IF;",
        ]


class CellBlock(TableBlock):
    """A block whose result is the number of the cell that the inputs fall into, a DINT."""

    def __init__(self, routine: TableRoutine, name: str) -> None:
        super().__init__(routine, name)
        self.index = "DINT"

    def text(self) -> str:
        """Return the block, without the values of the table."""
        lines, cell = self._found_cell()
        self.output = cell
        self.variables = [variable for variable in self.variables if variable[0] != cell]
        return "\n".join(
            [
                f"FUNCTION_BLOCK {self.name}",
                "VAR_INPUT",
                *(f"    {name} : {self.outer};" for name in self.inputs),
                "END_VAR",
                "VAR_OUTPUT",
                f"    {cell} : {self.index};",
                "END_VAR",
                *(["VAR CONSTANT", *self.constants, "END_VAR"] if self.constants else []),
                "VAR",
                *(f"    {name} : {kind};" for name, kind in self.variables),
                "END_VAR",
                "",
                *lines,
                "END_FUNCTION_BLOCK",
                "",
            ]
        )


# --- Direct inference ---


class RulesBlock:
    """The function block of a rule base that is inferred directly.

    The language has no number for "none": where no rule fires and the rule base calls that an
    error, the output keeps its value and `fired` is false.
    """

    def __init__(self, routine: DirectRoutine, name: str, names: Names) -> None:
        self.routine, self.name, self.file_names = routine, name, names
        inside = routine.precision.inside
        self.outer, self.inner = ST_TYPES[routine.precision.outside], ST_TYPES[inside]
        self.language = st_numbers(inside)
        self.names = Names("st", {name})
        self.inputs = [self.names.new(argument.name) for argument in routine.arguments]
        self.output = self.names.new(routine.output.name)
        self.fired = self.names.new("fired")
        self.kind = inside
        self.constants: list[str] = []
        self.variables: dict[str, str] = {}
        self.functions: list[str] = []
        self.function_names: dict[str, str] = {}  # functions by their text
        # No part of an expression is called as a variable of the listing is.
        self.part_names: set[str] = set(routine.listing.names)

    def text(self) -> str:
        """Return the block, after the functions that it calls."""
        statements = self._statements()
        constants = ["VAR CONSTANT", *self.constants, "END_VAR"] if self.constants else []
        variables = [f"    {name} : {kind};" for name, kind in self.variables.items()]
        words = [
            f"made by fuzzyarm {__version__}; do not edit: make it again from its source",
            "",
            *(line for line in routine_words(self.routine) if line != self.routine.silence),
            f"where no rule fires {self.output} keeps its value, and {self.fired} is FALSE",
        ]
        lines = [
            *self.functions,
            *head_comment(words),
            f"FUNCTION_BLOCK {self.name}",
            "VAR_INPUT",
            *(f"    {name} : {self.outer};" for name in self.inputs),
            "END_VAR",
            "VAR_OUTPUT",
            f"    {self.output} : {self.outer};",
            f"    {self.fired} : BOOL;",
            "END_VAR",
            *constants,
            "VAR",
            *variables,
            "END_VAR",
            "",
            *statements,
            "END_FUNCTION_BLOCK",
            "",
        ]
        return "\n".join(lines)

    def _statements(self) -> list[str]:
        listing, same = self.routine.listing, self.outer == self.inner
        lines = [f"{self.fired} := TRUE;"]
        for symbol, parameter in zip(self.routine.program.symbols, self.inputs, strict=True):
            if symbol in listing.reads:
                text = parameter if same else f"{self.outer}_TO_{self.inner}({parameter})"
                lines.append(f"{self._declared(symbol)} := {text};")
        for step in listing.body:
            lines += self._lines_of(step)
        result = "result value"  # no variable of the listing has a space in it
        lines += self._lines_of(Assign(result, listing.result))
        back = self._declared(result)
        value = back if same else f"{self.inner}_TO_{self.outer}({back})"
        return [*lines, f"IF {self.fired} THEN", f"    {self.output} := {value};", "END_IF;"]

    def _declared(self, name: str) -> str:
        """Return what a variable is called here; letters alone do not tell two apart."""
        if name not in self.language.rename:
            identifier = self.names.new(name)
            self.language.rename[name] = identifier
            self.variables[identifier] = self.inner
        return self.language.rename[name]

    def _lines_of(self, statement: Statement | Loop | Walked) -> list[str]:
        if isinstance(statement, Walked):
            return self._walk(statement)
        if isinstance(statement, Loop):
            return self._loop(statement)
        if isinstance(statement, Choose):
            condition = self._expression(statement.condition)
            then = [line for part in statement.then for line in self._lines_of(part)]
            otherwise = [line for part in statement.otherwise for line in self._lines_of(part)]
            inner = [*(f"    {line}" for line in then), "ELSE", *(f"    {x}" for x in otherwise)]
            return [f"IF {condition} THEN", *inner, "END_IF;"]
        if isinstance(statement.value, Constant) and math.isnan(statement.value.value):
            zero = self.language.number(0.0)
            return [f"{self._declared(statement.name)} := {zero};", f"{self.fired} := FALSE;"]
        body, value = statements(statement.value, prefix="part_", reserved=self.part_names)
        self.part_names |= set(variables(body))
        if body:  # choices, which the language has no expression for
            parts = setting(statement.name, body, value, statement.remark)
            return [line for part in parts for line in self._lines_of(part)]
        target = self._declared(statement.name)
        remark = self.language.remark.format(statement.remark) if statement.remark else ""
        return [f"{target} := {self._expression(value)};{remark}"]

    def _expression(self, node: Node) -> str:
        for name in symbols(node):
            if name in self.routine.listing.calls and name not in self.language.rename:
                call, argument = self.routine.listing.calls[name]
                function = self._function(call)
                self.language.rename[name] = f"{function}({self._expression(argument)})"
        return self.language.expression(node)

    def _function(self, call: Call) -> str:
        """Return the name of a function of the file."""
        language = st_numbers(self.kind)
        body = function_body(call)
        *inner, last = body
        local_names = [name for name in variables(inner) if name]
        lines = [*language.lines(inner)]
        assert isinstance(last, Assign)
        text = "\n".join([*lines, language.expression(last.value)])
        if text not in self.function_names:
            name = self.file_names.new(f"{self.name}_{call.stem}")
            self.function_names[text] = name
            declarations = [
                "VAR",
                *(f"    {local} : {self.inner};" for local in local_names),
                "END_VAR",
            ]
            self.functions += [
                f"FUNCTION {name} : {self.inner}",
                "VAR_INPUT",
                f"    h : {self.inner};",
                "END_VAR",
                *(declarations if local_names else []),
                "",
                *lines,
                f"{name} := {language.expression(last.value)};",
                "END_FUNCTION",
                "",
            ]
        return self.function_names[text]

    def _walk(self, statement: Walked) -> list[str]:
        """Return the call of the functions of a walk; its tables are variables of the block."""
        walk = statement.walk
        text = walk_in_st(walk, self.file_names, f"{self.name}_{walk.output}_{WALKED}")
        self.functions += [*text.types, *text.functions]
        arrays = {}
        # Not constants: a function takes by reference what may be written to.
        for array, literals in text.tables.items():
            arrays[array] = self.names.new(f"{walk.output}_{array}")
            body = "\n".join(number_lines(literals, indent="        "))
            self.variables[arrays[array]] = f"{text.type_names[array]} := [\n{body}\n    ]"
        arrays["room"] = self.names.new(f"{walk.output}_room")
        self.variables[arrays["room"]] = text.type_names["room"]
        flag = self.names.new("done")
        self.variables[flag] = "BOOL"
        lines = []
        for index, part in enumerate(statement.parts):
            body_of_part, value = statements(part, prefix="part_", reserved=self.part_names)
            self.part_names |= set(variables(body_of_part))
            lines += [line for inner in body_of_part for line in self._lines_of(inner)]
            lines.append(f"{arrays['room']}[{index}] := {self._expression(value)};")
        total, result = self._declared(walk.total), self._declared(walk.value)
        return [*lines, text.call.format(**arrays, total=total, value=result, done=flag)]

    def _loop(self, loop: Loop) -> list[str]:
        sums = loop.sums
        index = self._declared(sums.index)
        self.variables[index] = "DINT"
        for name, column in sums.columns.items():
            literals = [st_number(value, self.kind) for value in rounded(column, self.kind, name)]
            array = self.names.new(sums.stems[name])
            head = f"    {array} : ARRAY [0..{len(literals) - 1}] OF {self.inner} := ["
            body = number_lines(literals, indent="        ")
            self.constants.append("\n".join([head, *body, "    ];"]))
            self.language.rename[element(sums, name)] = f"{array}[{index}]"
        zero = self.language.number(0.0)
        lines = [f"{self._declared(name)} := {zero};" for name in (sums.area, sums.moment)]
        inner = [line for part in loop.body for line in self._lines_of(part)]
        return [
            *lines,
            f"FOR {index} := 0 TO {sums.count - 1} DO",
            *(f"    {line}" for line in inner),
            "END_FOR;",
        ]
