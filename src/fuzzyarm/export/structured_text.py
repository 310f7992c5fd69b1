"""Tables as IEC 61131-3 Structured Text: a function block for each, for PLCs.

The constants of a function block are set once; those of a function would be copied at every
call. The arithmetic is that of the C file.
"""

from __future__ import annotations

from collections.abc import Sequence

from fuzzyarm.export.names import Names, identifier
from fuzzyarm.export.numbers import ST_TYPES, ExportError, st_number
from fuzzyarm.export.routine import Routine, comment, number_lines, routine_words
from fuzzyarm.export.table import Side, TableCode, TableRoutine
from fuzzyarm.expression.printing import STRUCTURED_TEXT
from fuzzyarm.version import __version__


def structured_text(routines: Sequence[Routine], prefix: str) -> tuple[str, list[str]]:
    """Return a file with a function block for every table, and the names of the blocks."""
    names = Names("st")
    blocks, called = [], []
    for routine in routines:
        if not isinstance(routine, TableRoutine):
            raise ExportError(
                "Structured Text is written for tables, not for direct inference",
                hint="leave out --direct",
            )
        name = names.new(f"{prefix}_{identifier(routine.output.name)}")
        called.append(name)
        blocks.append(_Block(routine, name).text())
    return "\n".join(blocks), called


class _Block(TableCode):
    """A function block: its variables are declared apart from the statements."""

    language = STRUCTURED_TEXT
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
        self.constants: list[str] = []
        self.variables: list[tuple[str, str]] = []
        self.index = "INT" if core.values.size <= 0x7FFF else "DINT"

    def text(self) -> str:
        statements = self._interpolate() if self.core.linear else self._pick()
        constants = ["VAR CONSTANT", *self.constants, "END_VAR"] if self.constants else []
        variables = [f"    {name} : {kind};" for name, kind in self.variables]
        lines = [
            *self._head(),
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

    def _head(self) -> list[str]:
        words = [
            f"made by fuzzyarm {__version__}; do not edit: make it again from its source",
            "",
            *routine_words(self.routine),
        ]
        return comment(words, "(*", " *", " *)")

    # ── parts ────────────────────────────────────────────────────────────────────────

    def _variable(self, wanted: str, kind: str) -> str:
        name = self.names.new(wanted)
        self.variables.append((name, kind))
        return name

    def _array(self, wanted: str, literals: Sequence[str], columns: int = 0) -> str:
        name = self.names.new(wanted)
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
            self.bounds = [self._variable(each, self.index) for each in ("low", "high", "middle")]
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
        cell = self._variable("cell", self.index)
        what = "bins" if self.core.mode == "bins" else "middles"
        lines = [f"{cell} := 0;"]
        for side in self.sides:
            edges = self._array(f"{side.name}_{what}", self.points(side))
            search, low = self._search(edges, 0, side.size - 1, side.name, "<")
            lines += [*search, f"{cell} := {cell} * {side.size} + {low};"]
        return [*lines, f"{self.output} := {self._values()}[{cell}];"]

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
        given = name if self.inner == self.outer else f"{self.outer}_TO_{self.inner}({name})"
        search, low = self._search(levels, 1, side.size - 2, x, "<=")
        way = [self._widened(text) for text in (x, f"{levels}[{low}]", f"{levels}[{low} + 1]")]
        value = self.share(*way)
        if self.fixed:
            value = f"({way[0]} - {way[1]}) * 32768 / ({way[2]} - {way[1]})"
        step = low if side.stride == 1 else f"{low} * {side.stride}"
        return [
            f"{x} := {points[0]};",
            f"IF {given} > {x} THEN",
            f"    {x} := {given};",
            "END_IF;",
            f"IF {x} > {points[-1]} THEN",
            f"    {x} := {points[-1]};",
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
