"""The kernel of controllers as text: one program for all of them, a controller is data to it.

Two arrays hold everything. The **cells** ``s`` are numbers:

=============  ============================================================================
signals        inputs from plant and clock, written by the loop; see `program`
numbers        gains and literal numbers
signals        of every axis, and intermediate values
frames         of sources (:mod:`fuzzyarm.control.controllers.updates`); states of limits, rings of
learners tables         grids and values; visits of tables that learn
rule bases     a block each, see :mod:`fuzzyarm.inference.block`
=============  ============================================================================

The **code** ``k`` is the number of instructions, then six integers for each: operation, target
cell, up to three operands (usually cells), and whether the result is rounded as a stored value.
Lists for instructions with more operands follow.

An instruction is one source, factor or limit of the text; the axes follow one another. The updates
of sources are called by address: a source is a record (:mod:`fuzzyarm.symbolic.sources`) without
an instruction of its own. So an edited text compiles nothing, and the C program is a walk over the
same instructions (:mod:`fuzzyarm.exchange.export`). A source's state is NaN before its first value.

The first list are the guards. Where a reference or measured value that an axis reads is not a
number, its instructions are passed over: memory, learned tables and drives stay as they were.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from fuzzyarm.plant.setting import PERIOD, SINGLE, stored
from fuzzyarm.symbolic.kernels import call, kernel
from fuzzyarm.table.lookup import VALUES, cell_index, looked_up

INSTRUCTION = 6
"""Whole numbers of an instruction."""

(
    COPY,  # of a
    ADD,  # a and b; and so on
    SUBTRACT,
    MULTIPLY,
    DIVIDE,
    MULTIPLY_BOTH,  # a by b, and that by c
    MULTIPLY_DIVIDE,
    SUBTRACT_MULTIPLY,
    LIMIT,  # of a; state
    SLEW,
    UPDATE,  # list, frame, x: the update of a source
    ZOOM,  # list of cells, their number
    LOOK_UP,  # list, grid
    LOOK_UP_CELL,  # the cell that holds the index, first value
    LEARN,  # list; receives the index of the cell in use
    INFER,  # list, address of the inference
    PARTNER,  # list
) = range(17)

# State of the limits of a drive, relative to its first cell.
LOW, HIGH, OVER = range(3)  # of LIMIT; OVER: limited minus unlimited value of the last period
LAST_DRIVE, STEEPEST = range(2)  # of SLEW


class Remembered(NamedTuple):
    """A state cell of an instruction: its offset, and its name."""

    offset: int
    suffix: str


REMEMBERED: dict[int, tuple[Remembered, ...]] = {
    LIMIT: (Remembered(OVER, "excess"),),
    SLEW: (Remembered(LAST_DRIVE, "before_slew"),),
}
"""State cells by instruction; all others after the first are constants."""

# The list of UPDATE: address of the update; number of results (value, then states); whether they
# are rounded; end of the frame; number of fetched arguments, then for each its target in the frame
# and its source cell. The other arguments are constants in the frame
# (fuzzyarm.control.controllers.updates).
UPDATES, FILLED, ROUNDED, FRAME_END, FETCHED, FETCHES = range(6)

# The list of ZOOM: factor, window, whether signals wait at its edge, then the signals. That of
# LOOK_UP is in fuzzyarm.table.lookup. Of LEARN: values, visits, the ring (its index first) and its
# length, rate, bound, grid of the table, grid and values of the performance table, whether both
# grids are equal, the indices of the inputs in the last period (in the one grid, then in the
# other), then the inputs.
BY, INSIDE, WAIT, ZOOMED = range(4)
VISITS, RING, DELAY, GAIN, BOUND, GRID, JUDGE_GRID, JUDGE, ALIKE = range(1, 10)
INDICES, JUDGE_INDICES, LEARN_INPUTS = range(10, 13)

# The list of INFER: begin and end of the block; offsets of the first input and the first result in
# it; their numbers; then their cells, and for each result whether it holds its value (1) or is NaN
# (0) where no rule fires.
BEGIN, END, FIRST_INPUT, FIRST_RESULT, COUNT_INPUTS, COUNT_RESULTS, INFER_CELLS = range(7)

# The list of PARTNER: its address, its numbers and memory (begin, end), its links (begin, end).
ADDRESS, NUMBERS, NUMBERS_END, MEMORY, MEMORY_END, LINKS, LINKS_END = range(7)

# The list of guards: the address of `step_guarded`; number of cells read by any axis, these cells;
# then for each axis a guard: begin and end of its instructions, the counter of skipped periods,
# numbers of its input cells and of drives with a value for skipped periods, the input cells, and
# for each of these drives its cell and the cell of that value. A 0 ends the list.
WITH_GUARDS, COUNT_ALL, ALL_READ = range(3)
GUARD_BEGIN, GUARD_END, SKIPPED, COUNT_READ, COUNT_SENT, GUARDED = range(6)


@kernel
def step(k: Any, s: Any) -> None:
    """Run a controller for one period.

    Parameters
    ----------
    k : ndarray of int64
        The code.
    s : ndarray of float64
        The cells: reference and measured values and the clock are read, drives are written.
    """
    guards = 1 + INSTRUCTION * k[0]
    # One sum tests all inputs at once: NaN and infinity survive addition.
    total = 0.0
    for i in range(guards + ALL_READ, guards + ALL_READ + k[guards + COUNT_ALL]):
        total += s[k[i]]
    if total - total != 0.0:  # NaN or infinity among the inputs: test each axis
        # By address: a rare way, compiled into every loop, would slow the other one down.
        call(k[guards + WITH_GUARDS], k[0 : len(k)], s[0 : len(s)])
        return
    run(k, s, 1, guards)


@kernel
def step_guarded(k: Any, s: Any) -> None:
    """Run the axes without NaN inputs."""
    at = 1
    end = 1 + INSTRUCTION * k[0]
    guard = end + ALL_READ + k[end + COUNT_ALL]
    # Instructions outside the guards (axes without ports, sums of shared drives) always run.
    while k[guard + GUARD_BEGIN] > 0:
        run(k, s, at, k[guard + GUARD_BEGIN])
        at = k[guard + GUARD_END]
        if not skips(k, s, guard):
            run(k, s, k[guard + GUARD_BEGIN], at)
        guard += GUARDED + k[guard + COUNT_READ] + 2 * k[guard + COUNT_SENT]
    run(k, s, at, end)


@kernel
def skips(k: Any, s: Any, guard: int) -> bool:
    """Whether an axis skips this period; then count it, and write its drives."""
    reads = guard + GUARDED
    if not lacks_number(k, s, reads, k[guard + COUNT_READ]):
        return False
    sends = reads + k[guard + COUNT_READ]
    # Pairs of drive and value; a drive without a pair keeps its last value.
    for i in range(sends, sends + 2 * k[guard + COUNT_SENT], 2):
        s[k[i]] = s[k[i + 1]]
    s[k[guard + SKIPPED]] += 1.0
    return True


@kernel
def run(k: Any, s: Any, begin: int, end: int) -> None:
    """Carry out the instructions from one index of the code to another."""
    at = begin
    single = s[SINGLE] != 0.0
    for _ in range((end - begin) // INSTRUCTION):
        what, into, a, b, c = k[at], k[at + 1], k[at + 2], k[at + 3], k[at + 4]
        # Arithmetic has the first codes: a value of cells. Everything else may access lists and
        # state.
        if what <= SUBTRACT_MULTIPLY:
            value = combined(what, s[a], s[b], s[c])
        else:
            value = consulted(k, s, what, a, b, c, single)
        s[into] = stored(value, single) if k[at + 5] != 0 else value
        at += INSTRUCTION


@kernel
def lacks_number(k: Any, s: Any, first: int, count: int) -> bool:
    """Whether one of so many cells, listed in the code, is not a number."""
    for i in range(first, first + count):  # noqa: SIM110 - a kernel has no generators
        if math.isnan(s[k[i]]):
            return True
    return False


@kernel
def combined(what: int, a: float, b: float, c: float) -> float:
    """Return the result of an arithmetic instruction."""
    value = a
    if what == SUBTRACT_MULTIPLY:
        value = (a - b) * c
    elif what == MULTIPLY:
        value = a * b
    elif what == MULTIPLY_DIVIDE:
        value = a * b / c
    elif what == MULTIPLY_BOTH:
        value = a * b * c
    elif what == ADD:
        value = a + b
    elif what == SUBTRACT:
        value = a - b
    elif what == DIVIDE:
        value = a / b
    return value


@kernel
def consulted(k: Any, s: Any, what: int, a: int, b: int, c: int, single: bool) -> float:
    """Return the value of a one-cell instruction, else 0."""
    value = 0.0
    if what == UPDATE:
        value = updated(k, s, a, b, c, single)
    elif what == LIMIT:
        value = limited(s, s[a], b)
    elif what == SLEW:
        value = slewed(s, s[a], b)
    elif what == LOOK_UP:
        value = looked_up(k, s, a, b)
    elif what == LOOK_UP_CELL:
        value = s[b + int(s[a])]
    elif what == LEARN:
        value = float(learn(k, s, a, single))
    elif what == INFER:
        infer(k, s, a, b)
    elif what == ZOOM:
        zoom(k, s, a, b)
    elif what == PARTNER:
        call(
            k[a + ADDRESS],
            s[0 : s.shape[0]],
            s[k[a + NUMBERS] : k[a + NUMBERS_END]],
            s[k[a + MEMORY] : k[a + MEMORY_END]],
            k[k[a + LINKS] : k[a + LINKS_END]],
        )
    return value


# --- Updates of sources ---


@kernel
def updated(k: Any, s: Any, at: int, frame: int, x: int, single: bool) -> float:
    """Return a source's output, followed by its new state."""
    # The frame: value and states, then operand, period and the other arguments. The update reads
    # the frame after its value and writes its begin: the slices overlap in the states, so it reads
    # all arguments before it writes.
    filled = frame + k[at + FILLED]
    s[filled] = s[x]
    s[filled + 1] = s[PERIOD]
    pair = at + FETCHES
    for _ in range(k[at + FETCHED]):
        s[k[pair]] = s[k[pair + 1]]
        pair += 2
    call(k[at + UPDATES], s[frame + 1 : k[at + FRAME_END]], s[frame:filled])
    if k[at + ROUNDED] != 0:
        for i in range(frame, filled):
            s[i] = stored(s[i], single)
    return float(s[frame])


# --- Limits of a drive ---


@kernel
def limited(s: Any, x: float, state: int) -> float:
    """Return x within its limits; store the difference for anti-windup."""
    y: float = min(max(x, s[state + LOW]), s[state + HIGH])
    s[state + OVER] = y - x
    return y


@kernel
def slewed(s: Any, x: float, state: int) -> float:
    """Return x, or as near to it as the rate of change allows; a drive begins at 0."""
    before = s[state + LAST_DRIVE]
    most = s[state + STEEPEST] * s[PERIOD]
    y: float = min(max(x, before - most), before + most)
    s[state + LAST_DRIVE] = y
    return y


# --- Coarse and fine control ---


@kernel
def zoom(k: Any, s: Any, at: int, count: int) -> None:
    """Magnify signals while all lie inside the window (section 6.6: "within [-3 3]").

    Abruptly, or waiting at the edge of the window until the unmagnified signals arrive.
    """
    first = at + ZOOMED
    size = 0.0
    for i in range(first, first + count):
        size = max(size, abs(s[k[i]]))
    inside = s[k[at + INSIDE]]
    if size <= inside:
        factor = s[k[at + BY]]
        if k[at + WAIT] != 0 and size * factor > inside:
            factor = inside / size
        for i in range(first, first + count):
            s[k[i]] = factor * s[k[i]]


# --- Rule bases ---


@kernel
def infer(k: Any, s: Any, at: int, address: int) -> None:
    """Evaluate a rule base: inputs into its block, results out of it."""
    block = s[k[at + BEGIN] : k[at + END]]
    inputs = k[at + COUNT_INPUTS]
    cell = at + INFER_CELLS
    for i in range(inputs):
        block[k[at + FIRST_INPUT] + i] = s[k[cell + i]]
    call(address, block)
    results = k[at + COUNT_RESULTS]
    for i in range(results):
        value = block[k[at + FIRST_RESULT] + i]
        # NaN means that no rule fires: an output with hold keeps its last value.
        if not (math.isnan(value) and k[cell + inputs + results + i] == 1):
            s[k[cell + inputs + i]] = value


# --- Learning tables; look-up is defined in table/lookup.py ---


@kernel
def learn(k: Any, s: Any, at: int, single: bool) -> int:
    """Correct the cell of a table that was in use some periods ago; return the one of now.

    Section 6.3: the whole performance value, times a rate, is added, and the cell bounded.
    """
    cell = cell_index(k, s, at + LEARN_INPUTS, k[at + GRID], k[at + INDICES])
    judged = cell
    if k[at + ALIKE] == 0:
        judged = cell_index(k, s, at + LEARN_INPUTS, k[at + JUDGE_GRID], k[at + JUDGE_INDICES])
    delay = k[at + DELAY]
    head = k[at + RING]
    oldest = head + 1 + int(s[head])
    # The ring holds the cells of the last `delay` periods; its oldest entry is overwritten below.
    responsible = float(cell) if delay == 0 else s[oldest]
    gain, bound = s[k[at + GAIN]], s[k[at + BOUND]]
    if responsible >= 0.0 and gain != 0.0:  # none is, before the first delay is over
        corrected = k[at + VALUES] + int(responsible)
        value = stored(s[corrected] + gain * s[k[at + JUDGE] + judged], single)
        s[corrected] = min(max(value, -bound), bound)
    s[k[at + VISITS] + cell] += 1.0
    if delay > 0:
        s[oldest] = float(cell)
        following = s[head] + 1.0  # a division by the delay would cost as much as all the rest
        s[head] = following if following < delay else 0.0
    return cell
