"""The kernel: a rule base as numbers, evaluated at one point or at many.

It reads and writes one array of floats, the **block**, whose picture is in
:mod:`fuzzyarm.inference.block`. Every input finds its cell between the corners of its terms; the
cells together name a **program**, which lists the rules that can fire there and the integrals. No
search: the cost grows with the rules that fire, not with all rules. Points are sorted by program,
whose steps run over rows of points as vector instructions.

A program has min, max, product and sum of rows built in; other norms, curved terms and the
defuzzifiers are called by address.

A closed loop evaluates single points, millions of times. Two thirds of the work would be the
handling of rows of length one, so :func:`evaluate` walks a program number by number. The order of
sums and products is in functions that both walks share (`bucket_of`, `on_line` and `settled` here,
`weighed` of :mod:`.firing_strengths`, `layer_area` and `layer_moment` of :mod:`.closed_form`), and
the bits are the same; other norms, curved terms, expressions in parentheses and the other
defuzzifiers are called with rows of length one.

Neither walk replaces the other. With 49 rules (pd7) and random points, each called from C: a
point takes 54 ns by `evaluate` and 149 by `sweep` with room for one; of 100,000 points one takes 10
ns by `sweep` and 54 by `evaluate`. With the Gaussian terms of a weighted average it is 161 and 244,
46 and 162; where integrals or Karnik and Mendel's steps are nearly all of the work the two differ
by a quarter.

An output without an ordinary value (an input that is not a number or outside a range that forbids
it; no rule fires and no value is stated) is NaN; the caller then finds the cause.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from fuzzyarm.inference.block import (
    AGGREGATION,
    BUCKETS,
    CHOICE,
    CHOICE_ROOM,
    CLAMP,
    CLAMPED,
    COLUMNS,
    COUNT,
    CURVE,
    CURVES,
    CURVES_AT,
    DEFUZZIFIER,
    EDGES_AT,
    ENDS,
    ERROR,
    FAILED,
    FINISH,
    FIRST,
    FLOATS,
    FLOATS_AT,
    GROUPS,
    HEAD,
    HEIGHTS,
    INPUT_HEAD,
    INPUT_ROWS,
    INPUTS,
    IS_CLOSED,
    IS_MAX_MIN,
    IS_MEAN,
    LAST_CELL,
    LINE,
    MISSING,
    MOMENT,
    MOST_LINES,
    NEXT,
    OPERANDS,
    ORDER,
    ORDERED,
    OUT_MODE,
    OUTPUT,
    OUTPUT_HEAD,
    OUTPUT_RANGE,
    OUTPUTS,
    OUTPUTS_AT,
    POINTS,
    PROGRAM,
    PROGRAMS,
    PROGRAMS_AT,
    RANGE,
    RESULTS,
    RUN,
    SCRATCH,
    SLOT,
    STARTS_AT,
    STRIDE,
    TOTAL,
    WIDTH,
    WORK,
    WORK_ROWS,
    parts_of,
)
from fuzzyarm.inference.closed_form import closed_centroid_of_point
from fuzzyarm.inference.firing_strengths import (
    fold_heights,
    fold_heights_of_point,
    join_expressions,
    unite_rules,
    unite_rules_of_point,
)
from fuzzyarm.symbolic.kernels import call, kernel, short, whole_numbers

# ── points ───────────────────────────────────────────────────────────────────────────


class KernelForm(NamedTuple):
    """The composition of a rule base."""

    # Their numbers; operands of each rule.
    inputs: int
    outputs: int
    operands: int
    # Whether it has the usual form: straight terms, rules ``a and b`` under min, of weight 1,
    # united by max, no expressions in parentheses, and the centroid in closed form. Otherwise the
    # block has the form of each output.
    grid: bool


@kernel
def form_of(k: Any) -> KernelForm:
    """Read the composition of a rule base from its block."""
    return KernelForm(k[INPUTS], k[OUTPUTS], k[OPERANDS], False)


@kernel
def form_of_grid(k: Any) -> KernelForm:
    """Return the form of a grid of two inputs and one output; see :func:`bindings_for`."""
    return KernelForm(2, 1, 2, True)


GRID: dict[str, Callable[..., Any]] = {"form_of": form_of_grid}
"""Bindings of :func:`evaluate` for such a rule base: constants, which the compiler propagates."""


def bindings_for(block: Any) -> dict[str, Callable[..., Any]]:
    """Return the bindings of :func:`evaluate` for the rule base in a block."""
    return GRID if _is_grid(block) else {}


def _is_grid(block: Any) -> bool:
    """Whether the rule base in a block has the form of :func:`form_of_grid`."""
    k = whole_numbers(block)
    if tuple(form_of(k))[:3] != tuple(form_of_grid(k))[:3]:
        return False
    output, inputs = k[OUTPUTS_AT], range(HEAD, HEAD + 2 * INPUT_HEAD, INPUT_HEAD)
    programs = (k[k[PROGRAMS_AT] + program] for program in range(k[PROGRAMS]))
    return bool(
        k[output + IS_MAX_MIN] and k[output + IS_CLOSED] and k[output + IS_MEAN]
        and not k[output + FINISH]
        and not any(k[head + CURVES] for head in inputs)
        and not any(k[at + 2 * 2] for at in programs)  # after two numbers for each input
    )  # fmt: skip


@kernel
def evaluate(block: Any) -> None:
    """Evaluate the one point in a block that has room for one; ``k[MISSING]`` outputs are NaN then.

    Its rows have length one: the number of a row is its index.
    """
    k = whole_numbers(block)
    f = block[k[FLOATS] :]
    # Read once: the compiler does not know that a store to a row changes none of them.
    form = form_of(k)
    inputs, outputs, columns, results = form.inputs, form.outputs, k[COLUMNS], k[RESULTS]
    program = _program_of_point(block, k, f, inputs, columns)
    k[MISSING] = 0
    if program < 0:
        for o in range(outputs):
            block[results + o] = math.nan
        k[MISSING] = outputs
        return
    scratch = block[k[SCRATCH] :]
    operands, heights = form.operands, k[HEIGHTS]
    at = k[k[PROGRAMS_AT] + program]
    head = HEAD
    for column in range(columns, columns + inputs):
        _fuzzify_point(block, k, f, scratch, head, column, k[at], k[at + 1])
        if not form.grid and k[head + CURVES] > 0:
            _fuzzify_curves(k, f, scratch, head, block[column : column + 1])
        head += INPUT_HEAD
        at += 2
    at = at + 1 if form.grid or k[at] == 0 else join_expressions(k, f, scratch, at, 1)
    head = k[OUTPUTS_AT]
    for o in range(outputs):
        groups = at
        if form.grid or k[head + IS_MAX_MIN] != 0:
            at = unite_rules_of_point(k, scratch, at, heights, operands)
        else:
            at = fold_heights_of_point(k, f, scratch, at, k[head + AGGREGATION], heights, operands)
        bounds = k[head + FLOATS_AT]
        if form.grid or k[head + IS_CLOSED] != 0:
            total, moment, at = closed_centroid_of_point(k, f, scratch[heights:], k[groups], at)
        else:
            total, moment, at = _defuzzified_point(block, k, scratch, head, groups, at)
        value = _value_of_output(k, f, scratch, head, total, moment, form.grid)
        low, high, no_rule = f[bounds], f[bounds + 1], f[bounds + 2]
        value = settled(k[head + OUT_MODE], low, high, no_rule, total, value)
        block[results + o] = value
        if math.isnan(value):
            k[MISSING] += 1
        head += OUTPUT_HEAD


@kernel
def sweep(block: Any) -> None:
    """Evaluate the points in a block; ``k[MISSING]`` outputs are NaN then.

    Parameters
    ----------
    block : ndarray of float64
        With inputs in its columns (clamped here); its results are filled.
    """
    k = whole_numbers(block)
    f = block[k[FLOATS] : k[SCRATCH]]
    points = k[POINTS]
    width = k[WIDTH]
    begin = k[ORDER]
    programs = k[begin : begin + points]
    begin = k[ORDER] + width
    origin = k[begin : begin + points]
    begin = k[ENDS]
    ends = k[begin : begin + k[PROGRAMS] + 2]
    for point in range(points):
        programs[point] = 0
    some_failed = False
    for i in range(k[INPUTS]):
        begin = k[COLUMNS] + i * width
        if _locate(k, f, i, block[begin : begin + points], origin, programs):
            some_failed = True
    if some_failed:  # whatever other inputs added
        for point in range(points):
            programs[point] = max(programs[point], FAILED)
    sort(block, k, programs, origin, ends)
    k[MISSING] = ends[0] * k[OUTPUTS]
    # The sorted points of program p are [ends[p], ends[p + 1]): one call for all of them, so that
    # its lines, rules and layers are looked up once and rows stay in the cache.
    for point in range(ends[0]):  # these have no program
        for o in range(k[OUTPUTS]):
            block[k[RESULTS] + o * width + origin[point]] = math.nan
    begin = ends[0]
    for program in range(k[PROGRAMS]):
        end = ends[program + 1]
        if end > begin:
            k[INPUT_ROWS] = k[ORDERED] + begin
            k[PROGRAM] = k[k[PROGRAMS_AT] + program]
            k[FIRST], k[COUNT] = begin, end - begin
            call(k[RUN], block)  # one body of code for `evaluate` and `sweep`
            begin = end


@kernel
def sort(block: Any, k: Any, programs: Any, origin: Any, ends: Any) -> None:
    """Group points by program; those without a program go to the front.

    A counting sort. Afterwards the points of program p end before ``ends[p + 1]``,
    behind those of the program before.
    """
    width = k[WIDTH]
    for program in range(ends.shape[0]):
        ends[program] = 0
    for point in range(programs.shape[0]):  # a point without a program has -1: slot 1
        ends[programs[point] + 2] += 1
    for program in range(1, ends.shape[0]):
        ends[program] += ends[program - 1]
    # Now slot p + 1 is the first index of program p; filling moves it to the end. Two inputs are
    # sorted along; the others follow one by one.
    first, last = k[COLUMNS], k[COLUMNS] + width * min(k[INPUTS] - 1, 1)
    one, other = block[first : first + programs.shape[0]], block[last : last + programs.shape[0]]
    first, last = k[ORDERED], k[ORDERED] + width * min(k[INPUTS] - 1, 1)
    into, beside = block[first : first + programs.shape[0]], block[last : last + programs.shape[0]]
    for point in range(programs.shape[0]):
        index = ends[programs[point] + 1]
        ends[programs[point] + 1] = index + 1
        origin[index] = point
        into[index] = one[point]
        beside[index] = other[point]
    for i in range(2, k[INPUTS]):
        begin = k[COLUMNS] + i * width
        column = block[begin : begin + programs.shape[0]]
        begin = k[ORDERED] + i * width
        ordered = block[begin : begin + programs.shape[0]]
        for point in range(programs.shape[0]):
            ordered[point] = column[origin[point]]


@kernel
def _locate(k: Any, f: Any, i: int, x: Any, buckets: Any, programs: Any) -> bool:
    """Clamp an input to its range; add its share to the program numbers.

    Return whether some point may have failed: its number is then below zero.
    """
    head = HEAD + INPUT_HEAD * i
    at = RANGE * i
    low, high, first, scale = f[at], f[at + 1], f[at + 2], f[at + 3]
    last = k[head + BUCKETS] - 1.0
    starts, edges, stride = k[head + STARTS_AT], k[head + EDGES_AT], k[head + STRIDE]
    count = programs.shape[0]
    # Input by input, not point by point: its numbers stay in registers. Separate loops, since all
    # but the last vectorise.
    if k[head + CLAMPED] != 0:
        for point in range(count):
            x[point] = min(max(x[point], low), high)
    for point in range(count):
        buckets[point] = short(bucket_of(x[point], first, scale, last))
    failed = False
    for point in range(count):
        value = x[point]
        cell = k[starts + buckets[point]]
        if not f[edges + cell] <= value < f[edges + cell + 1]:
            cell = next_cell(f, edges, value, cell)
            failed = failed or cell < 0
        programs[point] += cell * stride
    if k[head + CLAMPED] == 0:
        failed = True
    if failed:
        for point in range(count):
            # Less than the number of programs is the sum of the other inputs. NaN is in no range.
            if not low <= x[point] <= high or not abs(x[point]) < math.inf:
                programs[point] = -k[PROGRAMS]
    return failed


@kernel
def bucket_of(value: float, first: float, scale: float, last: float) -> float:
    """Return the bucket number of a value, before truncation; 0 for NaN."""
    return min(max(0.0, (value - first) * scale), last)


@kernel
def next_cell(f: Any, edges: int, value: float, cell: int) -> int:
    """Return the cell of a value, searching from a cell near it; FAILED if there is none."""
    if not abs(value) < math.inf:
        return FAILED
    while value < f[edges + cell]:
        cell -= 1
    while value >= f[edges + cell + 1]:
        cell += 1
    return cell


@kernel
def _program_of_point(block: Any, k: Any, f: Any, inputs: int, columns: int) -> int:
    """Clamp the inputs of a point; return its program, or FAILED."""
    program = 0
    head = HEAD
    at = 0
    for column in range(columns, columns + inputs):
        value = block[column]
        if k[head + CLAMPED] != 0:
            value = min(max(value, f[at]), f[at + 1])
            block[column] = value
        elif not f[at] <= value <= f[at + 1]:
            return FAILED
        # A loop stays in a cell for many periods. If the cell of the last point still holds, the
        # rest depends on one well-predicted branch only.
        edges, cell = k[head + EDGES_AT], k[head + LAST_CELL]
        if not f[edges + cell] <= value < f[edges + cell + 1]:
            last = k[head + BUCKETS] - 1.0
            bucket = int(bucket_of(value, f[at + 2], f[at + 3], last))
            cell = next_cell(f, edges, value, k[k[head + STARTS_AT] + bucket])
            if cell < 0:
                return FAILED
            k[head + LAST_CELL] = cell
        program += cell * k[head + STRIDE]
        head += INPUT_HEAD
        at += RANGE
    return program


# ── programs ─────────────────────────────────────────────────────────────────────────


@kernel
def run(block: Any) -> None:
    """Run the program at ``k[PROGRAM]`` for the points from ``k[FIRST]`` on that share it."""
    k = whole_numbers(block)
    f = block[k[FLOATS] : k[SCRATCH]]
    scratch = block[k[SCRATCH] : k[COLUMNS]]
    count = k[COUNT]
    width = k[WIDTH]
    at = k[PROGRAM]  # walks through the program: every part returns the index of the next
    for i in range(k[INPUTS]):
        begin = k[INPUT_ROWS] + i * width
        fuzzify(k, f, scratch, i, k[at], k[at + 1], block[begin : begin + count])
        at += 2
    at = join_expressions(k, f, scratch, at, count)
    begin = (k[WORK] + TOTAL) * width
    total = scratch[begin : begin + count]
    begin = (k[WORK] + MOMENT) * width
    moment = scratch[begin : begin + count]
    begin = k[ORDER] + width + k[FIRST]
    origin = k[begin : begin + count]
    head = k[OUTPUTS_AT]
    for o in range(k[OUTPUTS]):
        for point in range(count):
            total[point] = 0.0
            moment[point] = 0.0
        k[GROUPS] = at
        k[OUTPUT] = head
        if k[head + IS_MAX_MIN] != 0 and k[OPERANDS] == 2:
            k[NEXT] = unite_rules(k, scratch, at, count)
        else:
            k[NEXT] = fold_heights(k, f, scratch, at, k[head + AGGREGATION], count)
        call(k[head + DEFUZZIFIER], block)  # fills total and moment; moves k[NEXT]
        at = k[NEXT]
        begin = k[head + FLOATS_AT]
        bounds = f[begin : begin + OUTPUT_RANGE]
        # 0 / 0 where no rule fires; `settle` tests the total, not the NaN.
        if k[head + IS_MEAN] != 0:
            for point in range(count):
                moment[point] = mean_of(bounds[3], moment[point], total[point])
        if k[head + FINISH] != 0:
            call(k[head + FINISH], moment, f[0:0], moment)
        begin = k[RESULTS] + o * width
        results = block[begin : begin + k[POINTS]]
        k[MISSING] += settle(k[head + OUT_MODE], bounds, total, moment, results, origin)
        head += OUTPUT_HEAD


@kernel
def fuzzify(k: Any, f: Any, scratch: Any, i: int, line: int, lines: int, x: Any) -> None:
    """Compute the degrees of an input: on straight lines, and of its curved terms."""
    width = k[WIDTH]
    count = x.shape[0]
    head = HEAD + INPUT_HEAD * i
    # In a cell every straight term is one line. Rows are numbered per cell: elsewhere a row is
    # another term, and `record` in the layout wrote these numbers into the rules.
    row = k[head + SLOT]
    for _ in range(lines):
        begin = row * width
        degrees = scratch[begin : begin + count]
        height, x_0, slope = f[line], f[line + 1], f[line + 2]
        for point in range(count):
            degrees[point] = on_line(height, x_0, slope, x[point])
        line += LINE
        row += 1
    _fuzzify_curves(k, f, scratch, head, x)


@kernel
def _fuzzify_curves(k: Any, f: Any, scratch: Any, head: int, x: Any) -> None:
    """Compute the degrees of the curved terms of an input."""
    width = k[WIDTH]
    # Their rows, after the most lines of any cell, are the same in all cells.
    row = k[head + SLOT] + k[head + MOST_LINES]
    curve = k[head + CURVES_AT]
    for _ in range(k[head + CURVES]):
        begin = k[curve + 1]
        numbers = f[begin : begin + k[curve + 2]]
        begin = row * width
        call(k[curve], x, numbers, scratch[begin : begin + x.shape[0]])
        curve += CURVE
        row += 1


@kernel
def on_line(height: float, x_0: float, slope: float, x: float) -> float:
    """Return the degree on a straight line of a term."""
    # Rounding may give less than 0 next to a foot; a line starts at its foot, else its top.
    return max(0.0, height + (x - x_0) * slope)


@kernel
def _fuzzify_point(
    block: Any, k: Any, f: Any, scratch: Any, head: int, column: int, line: int, lines: int
) -> None:
    """Compute the degrees of an input on straight lines at a point; see :func:`fuzzify`."""
    value = block[column]
    first = k[head + SLOT]
    for row in range(first, first + lines):
        scratch[row] = on_line(f[line], f[line + 1], f[line + 2], value)
        line += LINE


@kernel
def settle(mode: int, bounds: Any, total: Any, value: Any, result: Any, origin: Any) -> int:
    """Clamp values to the range, substitute the value for no rule; count the NaN."""
    low, high, no_rule = bounds[0], bounds[1], bounds[2]
    count = total.shape[0]
    for point in range(count):
        value[point] = settled(mode, low, high, no_rule, total[point], value[point])
    missing = 0
    for point in range(count):
        if math.isnan(value[point]):
            missing += 1
    for point in range(count):
        result[origin[point]] = value[point]
    return missing


@kernel
def settled(
    mode: int, low: float, high: float, no_rule: float, total: float, value: float
) -> float:
    """Return a value clamped to the range, or the one for points where no rule fires."""
    result = no_rule
    if total > 0.0:
        result = value
        if mode == CLAMP:
            result = min(max(result, low), high)
        elif mode == ERROR and not low <= result <= high:
            result = math.nan
        if not abs(result) < math.inf:  # NaN too: the caller finds the error
            result = math.nan
    return result


@kernel
def mean_of(centre: float, moment: float, total: float) -> float:
    """Return the mean from a moment about a centre; 0 / 0 where no rule fires."""
    return centre + moment / total


# ── defuzzifiers by address ──────────────────────────────────────────────────────────
#
# Each adds up, for the points of a program, the area (or the weight) of the output in the
# row TOTAL and the moment about the centre in the row MOMENT. The heights of the groups
# are in the rows from HEIGHTS on.


@kernel
def at_point(k: Any, f: Any, scratch: Any, heap: Any, point: int) -> tuple[float, float]:
    """Return total, and moment or value, of a point; a placeholder, bound per defuzzifier."""
    raise NotImplementedError


@kernel
def point_by_point(block: Any) -> None:
    """Call the bound `at_point` at each point, see :mod:`fuzzyarm.inference.programs`.

    After the work rows lies a heap for the numbers of one point, small enough for the level 1
    cache.
    """
    k, f, scratch, total, moment = parts_of(block)
    heap = scratch[(k[WORK] + WORK_ROWS) * k[WIDTH] :]
    for point in range(total.shape[0]):
        total[point], moment[point] = at_point(k, f, scratch, heap, point)


@kernel
def made_of(k: Any, heap: Any, first: float, second: float, third: float, fourth: float) -> float:
    """Return the value of an output computed from several numbers."""
    at = heap.shape[0] - CHOICE_ROOM
    heap[at], heap[at + 1], heap[at + 2], heap[at + 3] = first, second, third, fourth
    one = heap[at : at + 1]
    call(k[k[OUTPUT] + CHOICE], one, heap[at + 1 : at + 4], one)
    value: float = heap[at]
    return value


@kernel
def _defuzzified_point(
    block: Any, k: Any, scratch: Any, head: int, groups: int, at: int
) -> tuple[float, float, int]:
    """Return total and moment of a point by the output's defuzzifier, and the next index."""
    # Nothing was sorted: it reads the columns, in `sweep` their sorted copy.
    k[INPUT_ROWS], k[FIRST], k[COUNT] = k[COLUMNS], 0, 1
    k[GROUPS], k[OUTPUT], k[NEXT] = groups, head, at
    total = k[WORK] + TOTAL
    moment = k[WORK] + MOMENT
    scratch[total] = 0.0
    scratch[moment] = 0.0
    call(k[head + DEFUZZIFIER], block)  # moves k[NEXT]
    return scratch[total], scratch[moment], k[NEXT]


@kernel
def _value_of_output(
    k: Any, f: Any, scratch: Any, head: int, total: float, moment: float, grid: bool
) -> float:
    """Return the value of an output at a point, not yet clamped."""
    value = moment
    if (grid or k[head + IS_MEAN] != 0) and total > 0.0:
        value = mean_of(f[k[head + FLOATS_AT] + 3], moment, total)
    if not grid and k[head + FINISH] != 0:
        at = (k[WORK] + MOMENT) * k[WIDTH]
        scratch[at] = value
        call(k[head + FINISH], scratch[at : at + 1], f[0:0], scratch[at : at + 1])
        value = scratch[at]
    return value
