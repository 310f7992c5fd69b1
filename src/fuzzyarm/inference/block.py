"""The block: the numbers of a rule base in the memory from which the kernel reads them.

Everything is in one array of floats, the only argument of a kernel; parts of it are read as whole
numbers. In the order of memory:

====================  =======================================================================
whole numbers ``k``   head (below), inputs, outputs, programs; row functions by address
floats ``f``          ranges, edges of cells, lines, weights, layers, samples, consequents
rows ``scratch``      work rows, a number for each point: ones, zeros, degrees, heights of
                      sets, strength, total, moment; behind them one row of samples
columns               the inputs, one row each
results               the outputs, one row each
ordered               the inputs once more, points of one program together
order                 for each point its program, and its index before the sort
ends                  the end of each program's points
====================  =======================================================================

A program is a stretch of whole numbers::

    for each input:   where its lines begin in f, and how many there are
    number of expressions in parentheses, inner ones first
                      for each: its row, norm, hedges by address (or 0), operands: how many, rows
    for each output:  number of sets that may fire (groups)
                      for each group: rules, where its consequent begins
                          for each rule: norm, where its weight and threshold are, operands
                      then the tables of its defuzzifier

The names below are the indices. :mod:`fuzzyarm.inference.layout` writes the whole
numbers and the floats, :mod:`fuzzyarm.inference.kernel` reads them; the tables of a defuzzifier are
described in its own module.
"""

from __future__ import annotations

from array import array
from itertools import accumulate
from typing import Any, NamedTuple

from fuzzyarm.symbolic.kernels import kernel, whole_numbers

# ── indices by name ─────────────────────────────────────────────────────────────────

# Head of the whole numbers: counts; first rows; begin of the programs and of the outputs;
INPUTS, OUTPUTS, OPERANDS, HEIGHTS, WORK, PROGRAMS_AT, OUTPUTS_AT, PROGRAMS, SAMPLES = range(9)
# points and length of a row; begin of each part of the block, and its end;
POINTS, WIDTH, FLOATS, SCRATCH, COLUMNS, RESULTS, ORDERED, ORDER, ENDS, SIZE = range(9, 19)
# address of `run`, then its arguments and those of the defuzzifiers: index of the inputs in the
# block, index of the program, first point and number of points (in `order`), number of NaN
# outputs; index of an output's groups, index of the rest of the program, head of the output.
RUN, INPUT_ROWS, PROGRAM, FIRST, COUNT, MISSING, GROUPS, NEXT, OUTPUT = range(19, 28)
HEAD = 28

# For each input, from HEAD on: whether it is clamped; its buckets, their cells and the edges of
# cells; its stride in the number of a program; its first row of degrees and the most lines of a
# cell; the number of its curved terms and their index (for each an address, the index of its
# numbers and their count); the cell of the last point.
CLAMPED, BUCKETS, STARTS_AT, EDGES_AT, STRIDE, SLOT, MOST_LINES, CURVES, CURVES_AT = range(9)
LAST_CELL = 9
INPUT_HEAD = 10
CURVE = 3

# For each output, from OUTPUTS_AT on: its defuzzifier by address, its floats, how strengths
# and sets are folded, the treatment outside its range, a number for the defuzzifier, whether
# its value is a mean, whether the defuzzifier is `closed_centroid`, and whether all rules are
# ``a and b …`` under min, of weight 1, united by max; by address, the function applied to the
# result of the defuzzifier, and the one that combines several results (0: none, the first counts).
DEFUZZIFIER, FLOATS_AT, AGGREGATION, OUT_MODE, DETAIL, IS_MEAN, IS_CLOSED, IS_MAX_MIN = range(8)
FINISH, CHOICE = 8, 9
OUTPUT_HEAD = 10
CLAMP, EXTEND, ERROR = range(3)

RANGE = 4
"""Floats of an input: low, high, first bucket, buckets per unit."""

OUTPUT_RANGE = 4
"""Floats of an output: low, high, value for no rule, centre of the moments. For a defuzzifier that
computes the value itself, the last selects the number: of :mod:`.positions` one of its names; of
:mod:`.type_reduction_kernel` -1 for the left end of a centroid, 1 for the right one, 0 for both.
"""

LINE = 3
"""Floats of a straight line: y0, x0, slope."""

LAYER = 7
"""Floats of a layer of the closed form."""

GROUP_HEAD = 2
"""Whole numbers before the rules of a group: number of rules, index of the consequent."""

RULE_HEAD = 2
"""Whole numbers before the operands of a rule: norm, index of the weight."""

TRUTH_HEAD = 4
"""Whole numbers before the operands of an expression in parentheses."""

BUILT_IN = MIN, PRODUCT, MAX, SUM = range(4)
"""Norms built into the kernel; any other number is an address."""

ONES = 0
"""Row of ones; the next one is zeros."""

STRENGTH, TOTAL, MOMENT = range(3)
"""Rows from WORK on: strength of a rule, area (or weight), moment about the centre."""

WORK_ROWS = 3

CHOICE_ROOM = 4
"""Floats at the end of the heap for the parts of a value."""

FAILED = -1
"""The program of a point whose inputs are not numbers, or out of range."""


# ── making and reading one ───────────────────────────────────────────────────────────


class NotCoveredError(Exception):
    """A feature that the kernel does not cover; the message names it."""


class Layout(NamedTuple):
    """The numbers of a rule base."""

    # Input of the kernel.
    whole: list[int]
    floats: list[float]
    programs: int  # number of combinations of the inputs' cells
    # Number of work rows, and length of the row of samples.
    rows: int
    samples: int
    marks: tuple[TermNumbers, ...] = ()  # of an editable layout: positions of each term's numbers
    # Of the interpreted kernel: the plain Python that it calls, kept alive by the layout.
    searches: tuple[object, ...] = ()


class TermNumbers(NamedTuple):
    """Positions of a term's numbers in an editable layout."""

    # ``curve`` (the numbers of its row function), ``pieces`` (four floats each), ``samples`` (a
    # degree for each position) or ``value``.
    sort: str
    variable: str
    term: str
    # Of a curve the row of its degrees; of pieces the index of their count in the whole numbers.
    row: int
    # Index of its first number, and the room there.
    floats: int
    capacity: int
    scaled: bool = False  # of a set: whether its rules scale it instead of clipping it


class PointBlock(NamedTuple):
    """A block with room for some points, in memory that needs no array library."""

    numbers: memoryview[float]  # input of the kernel
    whole: memoryview[int]  # the same memory as whole numbers
    # First index of inputs and outputs: a row for each, of ``whole[WIDTH]`` numbers.
    columns: int
    results: int
    # Those of the layout: the numbers name them, so they live as long as the block.
    searches: tuple[object, ...]


GAP = 24
"""Floats between two long rows. Rows a power of two apart would compete for the same cache sets,
and a program works in more rows at once than a set has ways."""


def make_block(layout: Layout, points: int) -> PointBlock:
    """Give the numbers of a rule base room for `points` points."""
    inputs, outputs = layout.whole[INPUTS], layout.whole[OUTPUTS]
    width = points if points == 1 else points + GAP
    # In the order of memory: each name is the first index of the next part.
    lengths = {
        FLOATS: len(layout.whole),
        SCRATCH: len(layout.floats),
        COLUMNS: layout.rows * width + 2 * layout.samples,
        RESULTS: inputs * width,
        ORDERED: outputs * width,
        ORDER: inputs * width,
        ENDS: 2 * width,
        SIZE: layout.programs + 2,
    }
    ends = dict(zip(lengths, accumulate(lengths.values()), strict=True))
    numbers = memoryview(bytearray(8 * ends[SIZE])).cast("d")
    whole = whole_numbers(numbers)
    whole[: len(layout.whole)] = memoryview(array("q", layout.whole))
    whole[POINTS], whole[WIDTH] = points, width
    for name, end in ends.items():
        whole[name] = end
    numbers[ends[FLOATS] : ends[SCRATCH]] = memoryview(array("d", layout.floats))
    ones = ends[SCRATCH] + ONES * width
    numbers[ones : ones + points] = memoryview(array("d", [1.0] * points))
    return PointBlock(numbers, whole, ends[COLUMNS], ends[RESULTS], layout.searches)


@kernel
def parts_of(block: Any) -> Any:
    """Return whole numbers, floats and rows of a block, and of its rows TOTAL and MOMENT."""
    k = whole_numbers(block)
    scratch = block[k[SCRATCH] : k[COLUMNS]]
    begin = (k[WORK] + TOTAL) * k[WIDTH]
    total = scratch[begin : begin + k[COUNT]]
    begin = (k[WORK] + MOMENT) * k[WIDTH]
    return k, block[k[FLOATS] : k[SCRATCH]], scratch, total, scratch[begin : begin + k[COUNT]]
