"""The kernel of controllers as text: one interpreter for all; a controller is its data.

Two arrays hold everything. The **cells** ``s`` are numbers:

=============  ============================================================================
observation    references and measured values, the clock: written by the loop, see `program`
numbers        gains and literal numbers
signals        of every axis, and intermediate values
frames         of sources (:mod:`fuzzyarm.control.controllers.updates`)
states         of the limits of drives; rings of the cells that learners used
tables         grids and values; visits of tables that learn
rule bases     a block each, see :mod:`fuzzyarm.inference.block`
=============  ============================================================================

The **code** ``k`` is the number of instructions, then six integers for each: operation, target
cell, up to three operands (usually cells), and whether the result is rounded as a stored value.
Lists for instructions with more operands follow.

An instruction is one source, factor or limit of the text; the axes follow one another. The updates
of sources are called by address: a source is a record (:mod:`fuzzyarm.symbolic.sources`) without
an instruction of its own. So an edited text compiles nothing, and the C program is a walk over the
same instructions (:mod:`fuzzyarm.exchange.export`). A source's state is NaN before its first value.

The first list are the guards. If a reference or measured value of an axis is NaN, its instructions
are skipped: memory, learned tables and drives keep their values. They are restored if a signal or a
drive turns out NaN (no rule fires, the difference of two infinities) or a memory infinite: each
state has a cell with its value before. The sum of all ``x - x``, formed on the way, is 0 unless one
of them is: only then are the axes inspected.
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
    LIMIT,  # of a; state; whether its excess is remembered
    SLEW,
    UPDATE,  # list, frame, x: the update of a source
    ZOOM,  # list of cells, their number
    LOOK_UP,  # list, grid
    LOOK_UP_CELL,  # the cell that holds the index, first value
    LEARN,  # list; receives the index of the cell in use
    INFER,  # list, address of the inference
    PARTNER,  # list
) = range(17)

# Memory of the limits of a drive, from their state on.
# BEFORE: its value in the period before, for a period that turns out to be skipped.
LOW, HIGH, OVER, OVER_BEFORE = range(4)  # of LIMIT; OVER: limited minus unlimited value
LAST_DRIVE, STEEPEST, DRIVE_BEFORE = range(3)  # of SLEW


class Remembered(NamedTuple):
    """A state cell of an instruction: its offset, and its name."""

    offset: int
    suffix: str


REMEMBERED: dict[int, tuple[Remembered, ...]] = {
    LIMIT: (Remembered(OVER, "excess"),),
    SLEW: (Remembered(LAST_DRIVE, "before_slew"),),
}
"""State cells by instruction; all others after the first are constants."""

# The list of UPDATE: its address, the number of results (value, then state), whether these are
# rounded as stored values, the end of its frame, the number of arguments fetched beside x and the
# period, then for each of these its target and source cells; the others are numbers in the frame
# (fuzzyarm.control.controllers.updates). After the frame comes its memory of the period before.
UPDATES, FILLED, ROUNDED, FRAME_END, FETCHED, FETCHES = range(6)

# The list of ZOOM: factor, window, whether signals wait at its edge, then the signals. That of
# LOOK_UP is in fuzzyarm.table.lookup. Of LEARN: values, visits, the ring (its index first) and its
# length, rate, bound, grid of the table, grid and values of the performance table, whether both
# grids are equal, the indices of the inputs in the period before (in the one grid, then in the
# other), the value replaced by the last lesson, then the inputs.
BY, INSIDE, WAIT, ZOOMED = range(4)
VISITS, RING, DELAY, GAIN, BOUND, GRID, JUDGE_GRID, JUDGE, ALIKE = range(1, 10)
INDICES, JUDGE_INDICES, REPLACED, LEARN_INPUTS = range(10, 14)

# Replaced by a lesson: the corrected cell (-1: none) and its value, the index of the ring and the
# entry there.
CORRECTED, VALUE_BEFORE, HEAD_BEFORE, ENTRY_BEFORE = range(4)

# The list of INFER: begin and end of the block; offsets of its first input and first result; their
# numbers; then their cells, and for each result whether it holds (1) or is NaN (0) if no rule
# fires. After the cell of one that holds comes its value before.
BEGIN, END, FIRST_INPUT, FIRST_RESULT, COUNT_INPUTS, COUNT_RESULTS, INFER_CELLS = range(7)

# The list of PARTNER: its address, its numbers and memory (begin, end), its links (begin, end).
ADDRESS, NUMBERS, NUMBERS_END, MEMORY, MEMORY_END, LINKS, LINKS_END = range(7)

# The list of guards: the addresses of `step_guarded` and `settle`; whether axes have rates of their
# own or read signals of each other; the numbers of cells read by any axis and of drives; these
# cells; for each drive its cell and that of its last value; and for each axis a guard: begin and
# end of its instructions, the counter of skipped periods, the periods between two runs and their
# counter, the numbers of its inputs and drives, the cells of the inputs, and for each drive its
# cell and that of its value in a skipped period. After the last guard comes a 0.
WITH_GUARDS, SETTLE, ONE_BY_ONE, COUNT_ALL, COUNT_DRIVES, ALL_READ = range(6)
GUARD_BEGIN, GUARD_END, SKIPPED, EVERY, TURN, COUNT_READ, COUNT_SENT, GUARDED = range(8)


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
    reads = 1 + INSTRUCTION * k[0] + ALL_READ
    total = 0.0
    for i in range(reads, reads + k[reads - ALL_READ + COUNT_ALL]):
        total += s[k[i]]
    step_read(k, s, total)


@kernel
def step_on(observation: Any, k: Any, s: Any) -> None:
    """Run a controller for one period on an observation."""
    # One sum over all, unread values included: the guards look closer.
    total = 0.0
    for i in range(observation.shape[0]):
        s[i] = observation[i]
        total += observation[i]
    step_read(k, s, total)


@kernel
def step_read(k: Any, s: Any, total: float) -> None:
    """Run a controller for one period; `total` is the sum of all inputs of its axes."""
    guards = 1 + INSTRUCTION * k[0]
    drives = guards + ALL_READ + k[guards + COUNT_ALL]
    for i in range(drives, drives + 2 * k[guards + COUNT_DRIVES], 2):
        s[k[i + 1]] = s[k[i]]
    # By address: rare code, inlined into every loop, would slow the common case down.
    # NaN, infinities or a cascade: the guards look closer.
    if total - total != 0.0 or k[guards + ONE_BY_ONE] != 0:
        call(k[guards + WITH_GUARDS], k[0 : len(k)], s[0 : len(s)])
        return
    total = run(k, s, 1, guards)
    if total - total != 0.0:
        call(k[guards + SETTLE], k[0 : len(k)], s[0 : len(s)])


@kernel
def step_guarded(k: Any, s: Any) -> None:
    """Run the axes without NaN inputs, each at its rate."""
    at = 1
    end = 1 + INSTRUCTION * k[0]
    guard = end + ALL_READ + k[end + COUNT_ALL] + 2 * k[end + COUNT_DRIVES]
    while k[guard + GUARD_BEGIN] > 0:
        run(k, s, at, k[guard + GUARD_BEGIN])
        at = k[guard + GUARD_END]
        # Between two runs the signals and drives of an axis stay.
        if k[guard + EVERY] <= 1 or is_due(k, s, guard):
            if lacks_number(k, s, guard + GUARDED, k[guard + COUNT_READ]):
                skip(k, s, guard)
            else:
                run(k, s, k[guard + GUARD_BEGIN], at)
                settle_one(k, s, guard)
        guard += GUARDED + k[guard + COUNT_READ] + 2 * k[guard + COUNT_SENT]
    run(k, s, at, end)


@kernel
def is_due(k: Any, s: Any, guard: int) -> bool:
    """Whether a slow axis runs in this period; count the period."""
    turn = k[guard + TURN]
    following = s[turn] + 1.0
    now: bool = s[turn] == 0.0
    s[turn] = following if following < k[guard + EVERY] else 0.0
    return now


@kernel
def settle(k: Any, s: Any) -> None:
    """Undo the period of each axis with a NaN result."""
    at = 1
    end = 1 + INSTRUCTION * k[0]
    guard = end + ALL_READ + k[end + COUNT_ALL] + 2 * k[end + COUNT_DRIVES]
    while k[guard + GUARD_BEGIN] > 0:
        at = k[guard + GUARD_END]
        settle_one(k, s, guard)
        guard += GUARDED + k[guard + COUNT_READ] + 2 * k[guard + COUNT_SENT]
    run(k, s, at, end)  # which adds up the drives of axes with an input in common


@kernel
def settle_one(k: Any, s: Any, guard: int) -> None:
    """Undo the period of an axis unless all its results are numbers, its memory finite."""
    drives = guard + GUARDED + k[guard + COUNT_READ]
    is_valid = True
    for i in range(drives, drives + 2 * k[guard + COUNT_SENT], 2):
        is_valid = is_valid and not math.isnan(s[k[i]])
    for at in range(k[guard + GUARD_BEGIN], k[guard + GUARD_END], INSTRUCTION):
        is_valid = is_valid and holds_numbers(k, s, at)
    if is_valid:
        return
    for at in range(k[guard + GUARD_BEGIN], k[guard + GUARD_END], INSTRUCTION):
        restore(k, s, at)
    skip(k, s, guard)


@kernel
def skip(k: Any, s: Any, guard: int) -> None:
    """Count a skipped period of an axis, and output the values for it."""
    sends = guard + GUARDED + k[guard + COUNT_READ]
    for i in range(sends, sends + 2 * k[guard + COUNT_SENT], 2):
        s[k[i]] = s[k[i + 1]]
    s[k[guard + SKIPPED]] += 1.0


@kernel
def holds_numbers(k: Any, s: Any, at: int) -> bool:
    """Whether the stored signal of an instruction is a number, and its memory finite."""
    operation, a, state = k[at], k[at + 2], k[at + 3]
    total = 0.0
    if operation == UPDATE:
        for i in range(state + 1, state + k[a + FILLED]):
            total += s[i] - s[i]
    elif operation == LIMIT and k[at + 4] != 0:
        total = s[state + OVER] - s[state + OVER]
    elif operation == SLEW:
        total = s[state + LAST_DRIVE] - s[state + LAST_DRIVE]
    return total == 0.0 and not (k[at + 5] != 0 and math.isnan(s[k[at + 1]]))


@kernel
def restore(k: Any, s: Any, at: int) -> None:
    """Restore the memory of an instruction to that of the period before."""
    operation, a, state = k[at], k[at + 2], k[at + 3]
    if operation == UPDATE:
        # The states of the period before lie after the frame, in the same order.
        before = k[a + FRAME_END] - 1 - state
        for i in range(state + 1, state + k[a + FILLED]):
            s[i] = s[i + before]
    elif operation == LIMIT:
        s[state + OVER] = s[state + OVER_BEFORE]
    elif operation == SLEW:
        s[state + LAST_DRIVE] = s[state + DRIVE_BEFORE]
    elif operation == INFER:
        results = k[a + COUNT_RESULTS]
        first = a + INFER_CELLS + k[a + COUNT_INPUTS]
        for i in range(first, first + results):
            if k[i + results] == 1:
                s[k[i]] = s[k[i] + 1]
    elif operation == LEARN:
        unlearn(k, s, a, int(s[k[at + 1]]))


@kernel
def unlearn(k: Any, s: Any, at: int, cell: int) -> None:
    """Restore a learning table to that of the period before."""
    replaced = k[at + REPLACED]
    if s[replaced + CORRECTED] >= 0.0:
        s[int(s[replaced + CORRECTED])] = s[replaced + VALUE_BEFORE]
    s[k[at + VISITS] + cell] -= 1.0
    if k[at + DELAY] > 0:
        head = k[at + RING]
        s[head] = s[replaced + HEAD_BEFORE]
        s[head + 1 + int(s[head])] = s[replaced + ENTRY_BEFORE]


@kernel
def run(k: Any, s: Any, begin: int, end: int) -> float:
    """Execute the instructions from one index of the code to another.

    Returns 0, or NaN where a value or a memory was an infinity or not a number; at times
    after an overflow of their sum alone.
    """
    total = 0.0
    value = 0.0
    before = -1
    single = s[SINGLE] != 0.0
    for at in range(begin, end, INSTRUCTION):
        operation, into, a, b, c = k[at], k[at + 1], k[at + 2], k[at + 3], k[at + 4]
        # Arithmetic has the first codes: values of cells only. Other operations access lists and
        # state.
        if operation <= SUBTRACT_MULTIPLY:
            # The value of the last instruction is in a register; its cell is not yet written.
            if a != before:
                value = s[a]
            value = combined(operation, value, s[b], s[c])
        else:
            value = computed(k, s, operation, a, b, c, single)
            if operation == LIMIT and c != 0:
                total += s[b + OVER]
        if k[at + 5] != 0:
            value = stored(value, single)
        total += value
        s[into] = value
        before = into
    return total - total


@kernel
def lacks_number(k: Any, s: Any, first: int, count: int) -> bool:
    """Whether one of `count` cells, listed in the code, is NaN."""
    for i in range(first, first + count):  # noqa: SIM110 - a kernel has no generators
        if math.isnan(s[k[i]]):
            return True
    return False


@kernel
def combined(operation: int, a: float, b: float, c: float) -> float:
    """Return the result of an arithmetic instruction."""
    value = a
    if operation == SUBTRACT_MULTIPLY:
        value = (a - b) * c
    elif operation == MULTIPLY:
        value = a * b
    elif operation == MULTIPLY_DIVIDE:
        value = a * b / c
    elif operation == MULTIPLY_BOTH:
        value = a * b * c
    elif operation == ADD:
        value = a + b
    elif operation == SUBTRACT:
        value = a - b
    elif operation == DIVIDE:
        value = a / b
    return value


@kernel
def computed(k: Any, s: Any, operation: int, a: int, b: int, c: int, single: bool) -> float:
    """Return the value of a one-cell instruction, else 0."""
    value = 0.0
    if operation == UPDATE:
        value = updated(k, s, a, b, c, single)
    elif operation == LIMIT:
        value = limited(s, s[a], b)
    elif operation == SLEW:
        value = slewed(s, s[a], b)
    elif operation == LOOK_UP:
        value = looked_up(k, s, a, b)
    elif operation == LOOK_UP_CELL:
        value = s[b + int(s[a])]
    elif operation == LEARN:
        value = float(learn(k, s, a, single))
    elif operation == INFER:
        infer(k, s, a, b)
    elif operation == ZOOM:
        zoom(k, s, a, b)
    elif operation == PARTNER:
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
    """Return a source's value in this period; store its new state after it."""
    filled, end = frame + k[at + FILLED], k[at + FRAME_END]
    for i in range(frame + 1, filled):
        s[i - frame - 1 + end] = s[i]
    s[filled] = s[x]
    s[filled + 1] = s[PERIOD]
    # Arguments from other cells: target and source by turns.
    pair = at + FETCHES
    for _ in range(k[at + FETCHED]):
        s[k[pair]] = s[k[pair + 1]]
        pair += 2
    call(k[at + UPDATES], s[frame + 1 : end], s[frame:filled])
    if k[at + ROUNDED] != 0:
        for i in range(frame, filled):
            s[i] = stored(s[i], single)
    return float(s[frame])


# --- Limits of a drive ---


@kernel
def limited(s: Any, x: float, state: int) -> float:
    """Return x within its limits; store the difference for anti-windup."""
    y: float = min(max(x, s[state + LOW]), s[state + HIGH])
    s[state + OVER_BEFORE] = s[state + OVER]
    s[state + OVER] = y - x
    return y


@kernel
def slewed(s: Any, x: float, state: int) -> float:
    """Return x within the rate of change from the last value; a drive begins at 0."""
    before = s[state + LAST_DRIVE]
    most = s[state + STEEPEST] * s[PERIOD]
    y: float = min(max(x, before - most), before + most)
    s[state + DRIVE_BEFORE] = before
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
        into = k[cell + inputs + i]
        if k[cell + inputs + results + i] == 1:
            s[into + 1] = s[into]
            if math.isnan(value):
                value = s[into]
        s[into] = value


# --- Learning tables; look-up is defined in table/lookup.py ---


@kernel
def learn(k: Any, s: Any, at: int, single: bool) -> int:
    """Correct the cell of a table used some periods ago; return the present one.

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
    replaced = k[at + REPLACED]
    s[replaced + CORRECTED] = -1.0
    if responsible >= 0.0 and gain != 0.0:  # none before the first delay is over
        corrected = k[at + VALUES] + int(responsible)
        s[replaced + CORRECTED] = float(corrected)
        s[replaced + VALUE_BEFORE] = s[corrected]
        value = stored(s[corrected] + gain * s[k[at + JUDGE] + judged], single)
        s[corrected] = min(max(value, -bound), bound)
    s[k[at + VISITS] + cell] += 1.0
    if delay > 0:
        s[replaced + HEAD_BEFORE] = s[head]
        s[replaced + ENTRY_BEFORE] = s[oldest]
        s[oldest] = float(cell)
        following = s[head] + 1.0  # a modulo would cost as much as all the rest
        s[head] = following if following < delay else 0.0
    return cell
