"""Tables as IEC 61131-3 Structured Text: a function block for each, for PLCs.

The constants of a function block are set once; those of a function would be copied at every
call. The arithmetic is that of the C file.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fuzzyarm import __version__
from fuzzyarm.export.names import Names, identifier
from fuzzyarm.export.numbers import ExportError, st_number
from fuzzyarm.export.routine import Routine, comment, number_lines, routine_words
from fuzzyarm.export.table import Core, TableRoutine
from fuzzyarm.export.table_numbers import FixedTable

_FLOATS: dict[type[np.floating], str] = {np.float32: "REAL", np.float64: "LREAL"}
_WHOLES = {15: "INT", 7: "SINT"}


def structured_text(routines: Sequence[Routine], prefix: str) -> tuple[str, list[str]]:
    """Return a file with a function block for every routine, and the names of the blocks.

    Parameters
    ----------
    routines : sequence of Routine
        Tables.
    prefix : str
        Begins the names of the blocks.

    Raises
    ------
    ExportError
        If a routine is no table.
    """
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


class _Block:
    def __init__(self, routine: TableRoutine, name: str) -> None:
        self.routine = routine
        self.core: Core = routine.core
        self.name = name
        self.names = Names("st", {name})
        self.inputs = [self.names.new(axis.name) for axis in self.core.table.axes]
        self.output = self.names.new(self.core.table.output)
        if isinstance(self.core, FixedTable):
            self.outer = self.inner = _WHOLES[self.core.bits]
            self.wide = "DINT"
        else:
            self.outer = _FLOATS[self.core.precision.outside]
            self.inner = self.wide = _FLOATS[self.core.precision.inside]
        self.constants: list[str] = []
        self.variables: list[tuple[str, str]] = []
        self.index = "INT" if self.core.values.size <= 0x7FFF else "DINT"

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

    def _literal(self, value: float | int) -> str:
        if isinstance(self.core, FixedTable):
            return str(int(value))
        return st_number(value, self.core.precision.inside)

    def _array(self, wanted: str, values: Sequence[float], columns: int = 0) -> str:
        name = self.names.new(wanted)
        literals = [self._literal(x) for x in values]
        lines = number_lines(literals, columns, indent="        ")
        head = f"    {name} : ARRAY [0..{len(literals) - 1}] OF {self.inner} := ["
        self.constants.append("\n".join([head, *lines, "    ];"]))
        return name

    def _values(self) -> str:
        shape = self.core.table.shape
        return self._array(f"{self.output}_values", self.core.values.tolist(), shape[-1])

    def _widened(self, expression: str, kind: str) -> str:
        return expression if kind == self.wide else f"{kind}_TO_{self.wide}({expression})"

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
        place = f"{middle} + {first}" if first else middle
        return [
            f"{low} := 0;",
            f"{high} := {count};",
            f"WHILE {low} < {high} DO",
            f"    {middle} := ({low} + {high}) / 2;",
            f"    IF {points}[{place}] {comparison} {x} THEN",
            f"        {low} := {middle} + 1;",
            "    ELSE",
            f"        {high} := {middle};",
            "    END_IF;",
            "END_WHILE;",
        ], low

    def _pick(self) -> list[str]:
        lines: list[str] = []
        cell = self._variable("cell", self.index)
        what = "bins" if self.core.mode == "bins" else "middles"
        lines.append(f"{cell} := 0;")
        for k, size in enumerate(self.core.table.shape):
            if size == 1:
                continue
            edges = self._array(f"{self.inputs[k]}_{what}", self.core.points[k].tolist())
            search, low = self._search(edges, 0, size - 1, self.inputs[k], "<")
            lines += [*search, f"{cell} := {cell} * {size} + {low};"]
        return [*lines, f"{self.output} := {self._values()}[{cell}];"]

    def _interpolate(self) -> list[str]:
        lines: list[str] = []
        cell = self._variable("cell", self.index)
        lines.append(f"{cell} := 0;")
        shares, strides = [], []
        stride = self.core.values.size
        for k, size in enumerate(self.core.table.shape):
            stride //= size
            if size == 1:
                continue
            part, share = self._place(k, size, cell, stride)
            lines += part
            shares.append(share)
            strides.append(stride)
        return lines + self._corners(self._values(), cell, shares, strides)

    def _place(self, k: int, size: int, cell: str, stride: int) -> tuple[list[str], str]:
        """Clamp one input, find the level below it and the share of the way to the next."""
        name, points = self.inputs[k], self.core.points[k].tolist()
        levels = self._array(f"{name}_levels", points)
        x, share = self._variable(f"x_{name}", self.inner), self._variable(f"t_{name}", self.wide)
        given = name if self.inner == self.outer else f"{self.outer}_TO_{self.inner}({name})"
        first, last = self._literal(points[0]), self._literal(points[-1])
        search, low = self._search(levels, 1, size - 2, x, "<=")
        above = (
            f"({self._widened(x, self.inner)} - {self._widened(f'{levels}[{low}]', self.inner)})"
        )
        width = (
            f"({self._widened(f'{levels}[{low} + 1]', self.inner)}"
            f" - {self._widened(f'{levels}[{low}]', self.inner)})"
        )
        scale = " * 32768" if isinstance(self.core, FixedTable) else ""
        step = low if stride == 1 else f"{low} * {stride}"
        return [
            f"{x} := {first};",
            f"IF {given} > {x} THEN",
            f"    {x} := {given};",
            "END_IF;",
            f"IF {x} > {last} THEN",
            f"    {x} := {last};",
            "END_IF;",
            *search,
            f"{share} := {above}{scale} / {width};",
            f"{cell} := {cell} + {step};",
        ], share

    def _corners(self, values: str, cell: str, shares: list[str], strides: list[int]) -> list[str]:
        offsets = [0]
        for stride in strides:
            offsets = [base + more for base in offsets for more in (0, stride)]
        corners = [
            self._widened(f"{values}[{cell} + {o}]" if o else f"{values}[{cell}]", self.inner)
            for o in offsets
        ]
        lines: list[str] = []
        targets = [self._variable(f"v{i}", self.wide) for i in range(len(corners) // 2)]
        product = self._variable("product", "DINT") if isinstance(self.core, FixedTable) else ""
        for share in reversed(shares):
            blended = []
            for i, (near, far) in enumerate(zip(corners[0::2], corners[1::2], strict=True)):
                lines += self._blend(targets[i], near, far, share, product)
                blended.append(targets[i])
            corners = blended
        return [*lines, f"{self.output} := {self._narrowed(corners[0])};"]

    def _blend(self, target: str, near: str, far: str, share: str, product: str) -> list[str]:
        if not product:
            return [f"{target} := (1.0 - {share}) * {near} + {share} * {far};"]
        return [
            f"{product} := ({far} - {near}) * {share};",
            f"IF {product} >= 0 THEN",
            f"    {target} := {near} + ({product} + 16384) / 32768;",
            "ELSE",
            f"    {target} := {near} - (16384 - {product}) / 32768;",
            "END_IF;",
        ]
