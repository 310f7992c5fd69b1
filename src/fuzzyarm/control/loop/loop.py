"""The closed-loop kernel: references, sensors, control laws, actuators and plant; error norms.

Loop, laws and plant share one array, the **board**:

=============  =====================================================================
0 … 2          the clock: control period, s; 1 in the last period of a set point;
               1 if values are stored in single precision
references     set points, see :class:`fuzzyarm.plant.plant.Interface`
seen           outputs as measured, in the order of the plant
commands       scratch for the drives of one law
true           outputs of the plant (unused where all sensors are ideal)
drives         drives, after actuators and loads
=============  =====================================================================

The cells up to `seen` are the observation of a law. Laws and plant are called by address and
access their own part only.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.control.controllers.law import summed_drives
from fuzzyarm.control.controllers.on_plant import drives_of_text
from fuzzyarm.plant.actuators import (
    advance,
    ask_plant,
    handed_on,
    limit,
    postpone,
)
from fuzzyarm.plant.plant import (
    ACTUATE,
    CLOCK_SIZE,
    DERIVE,
    IN_SINGLE,
    MEASURE,
    TASK,
    TIME,
    Dynamics,
)
from fuzzyarm.plant.setting import CLOCK, stored, stored_double, stored_single
from fuzzyarm.symbolic.kernels import kernel, letters_of_parts


class LoopConstants(NamedTuple):
    """Constants of a run; the kernel takes them as an array in this order.

    Attributes
    ----------
    step : float
        Control period, s.
    single : bool
        Whether stored values are rounded to single precision.
    every : int
        Control periods of a set point; sampled in the last of them.
    interpolated : bool
        Whether the reference is interpolated linearly between set points.
    disturbance : float
        Largest relative disturbance of each state at each step; 0 for none.
    seed : int
        Seed of the disturbance, below 2³¹.
    states : int
        Number of disturbed states, from the first on.
    """

    step: float
    single: bool
    every: int
    interpolated: bool
    disturbance: float
    seed: int
    states: int


class LoopBlock(NamedTuple):
    """All arrays of a run: the only argument of :func:`run_loop`.

    The arrays do not overlap. Their shapes, with `n` set points, `m` control periods, `R`
    references, `D` drives, `k` tracked outputs:

    ==============  ==================  ======================================================
    the experiment, read only, the same arrays for all its runs
    ------------------------------------------------------------------------------------------
    references      R n                 set points
    iterations      n, whole            control periods of each
    plant_of        n, whole            index of its plant, for each set point
    plants          blocks, flat        parameters of the plant
    setting         7                   a :class:`LoopConstants`
    links           4, whole            :data:`ADDRESS` of the plant and its abilities
    noise           columns m, or 0     added to outputs before they are quantised
    pushes          D m, or 0           loads added to drives after their limits
    checks          2 each, whole       cells of the board: a reference (-1: none), an output
    bounds          1 each              largest error, or magnitude, without divergence
    path            k m, or 0           reference between held set points
    the controller, read only
    ------------------------------------------------------------------------------------------
    laws            whole               see :func:`fuzzyarm.control.controllers.law.summed_drives`
    numbers                             their constants: gains, terms, rules, tables
    the run, read and written
    ------------------------------------------------------------------------------------------
    sensors         10 each, or 0       see :data:`SENSOR`; behind them the rings of delays
    limits          4 D                 lowest, highest, largest change in a period, last value
    dead_times      5 D, or 0           see :data:`ACTUATOR`; behind them the rings of dead times
    memory                              state of the laws
    taps            whole               recorded cells of the board: tracked outputs,
                                        their references, others
    board                               see the head of this module
    state                               states of the plant, scratch of its integrator
    clock           see below           for the plant; then sums of changes and of errors
    record          taps n              a row for each tap, an entry for each sampled set point
    progress        7, whole            state of the run: :data:`SAMPLES` and following
    ==============  ==================  ======================================================

    All threads share the read-only arrays: no run copies them.
    """

    references: list[float]
    iterations: list[int]
    plant_of: list[int]
    plants: list[float]
    setting: list[float]
    links: list[int]
    noise: list[float]
    pushes: list[float]
    checks: list[int]
    bounds: list[float]
    path: list[float]
    laws: list[int]
    numbers: list[float]
    sensors: list[float]
    limits: list[float]
    dead_times: list[float]
    memory: list[float]
    taps: list[int]
    board: list[float]
    state: list[float]
    clock: list[float]
    record: list[float]
    progress: list[int]


ADDRESS, BLOCK, ACTUATES, DERIVES = range(4)
"""Of `links`: address of the plant's kernel; size of one parameter block; 1 if the plant computes
its drives from commands itself; 1 if it derives further measurements from its outputs."""

SAMPLES, LOST, LOST_AT, TICK, NEXT, UNTIL, RANDOM = range(7)
"""Of `progress`: number of samples; set point and period of divergence (-1: none); control periods
since the start; next set point, and the one before which to stop; state of the generator of
disturbances."""


@kernel
def run_loop(block: LoopBlock) -> None:
    """Step a sampled closed loop from the next set point up to, not including, the stop.

    A fixed-step loop at the control period T: the controller is a difference equation, the plant
    is integrated over T by its own kernel with all drives held. In each period `i`, in this order:

    1. the references of the period, held or on the straight line to the next set point;
    2. sensors: outputs of time i T with noise, resolution and delay, and values that the plant
       derives of them; exact sensors pass the outputs on;
    3. the laws, their drives added up; state of the laws advances;
    4. actuators: range, then slew, from the drive of the period before, then dead time;
    5. sums of drive changes and of squared errors; in the last period of a set point the sample:
       outputs of i T and the drives computed from them;
    6. loads, behind the actuators;
    7. the plant from i T to (i + 1) T, in parts if the dead time of an actuator ends inside;
       its time is that product, not a running sum;
    8. random disturbance of the states, if any, then outputs of (i + 1) T;
    9. the test for divergence, which ends the run: an output or error beyond its bound.

    NaN in an output comes from the plant or its equations, NaN in a drive from a law; both pass
    sensors and actuators unchanged. A NaN output ends the run unless states and drives are all
    finite: then it is a lost sample, and the law decides. A plant without states cannot tell, and
    ends.

    The whole state of a run is in `block`: a run in parts has the bits of a whole one.
    """
    # Local names: scalars of a tuple stay in registers, and the interpreter finds them faster.
    setting = constants_of(block.setting)
    references, iterations, pushes = block.references, block.iterations, block.pushes
    plants, links, sensors, noise = block.plants, block.links, block.sensors, block.noise
    limits, dead_times, checks, bounds = block.limits, block.dead_times, block.checks, block.bounds
    laws, numbers, memory, taps = block.laws, block.numbers, block.memory, block.taps
    board, state, clock, progress = block.board, block.state, block.clock, block.progress
    frame = frame_of(len(references) // len(iterations), len(limits) // 4, len(board))
    # With ideal sensors the plant writes its outputs straight into the observation.
    drives, outputs = board[frame.driven :], board[frame.true : frame.driven]
    if len(sensors) == 0:
        outputs = board[frame.seen : frame.observation_end]
    errors = clock[CLOCK_SIZE + CHANGES * frame.drives :]
    size, tracked = links[BLOCK], len(errors) // ERRORS
    random = setting.seed if progress[TICK] == 0 else progress[RANDOM]
    samples, tick = progress[SAMPLES], progress[TICK]
    progress[LOST] = progress[LOST_AT] = -1
    board[0] = setting.step
    board[2] = 1.0 if setting.single else 0.0
    first = block.plant_of[0] * size
    ask_plant(MEASURE, links, state, outputs, drives, plants[first : first + size], clock)
    for point in range(progress[NEXT], progress[UNTIL]):
        first = block.plant_of[point] * size
        constants = plants[first : first + size]
        # A set point is held for its periods. A segment may end after one period only (by the
        # study's clock): then the last one is not reached, and there is no sample.
        for iteration in range(iterations[point]):
            last = iteration == setting.every - 1
            board[1] = 1.0 if last else 0.0
            if iteration == 0 or setting.interpolated:
                refer(board, frame, references, point, iteration, setting)
            # Sensors, then control, then the plant: a law never sees the state that it causes.
            if len(sensors) > 0:
                sense(board, frame, sensors, noise, tick)
                derive(
                    links,
                    state,
                    board[frame.seen : frame.observation_end],
                    drives,
                    constants,
                    clock,
                )
            control(board, frame.observation_end, frame.drives, laws, numbers, memory, drives)
            actuate(links, state, outputs, drives, constants, clock, limits, dead_times, tick)
            note_changes(drives, frame.drives, clock, tick)
            note_errors(board, taps, block.path, tick, errors, tracked)
            if last:  # before the plant moves: the error behind these drives
                tap(board, taps, block.record, samples)
                samples += 1
            push(drives, frame.drives, pushes, tick)  # loads act behind the actuators
            advance(links, state, outputs, drives, constants, clock, dead_times, pushes, tick)
            tick += 1
            clock[TIME] = tick * setting.step
            if setting.disturbance > 0.0:
                random = disturbed(state, setting, random)
            ask_plant(MEASURE, links, state, outputs, drives, constants, clock)
            # Tested after every step: an unstable plant reaches infinity within a few set points.
            if not within(board, checks, bounds, state[: setting.states], drives):
                progress[LOST], progress[LOST_AT] = point, iteration
                break
        progress[NEXT] = point + 1
        if progress[LOST] >= 0:
            break
    progress[SAMPLES], progress[TICK], progress[RANDOM] = samples, tick, random


LOOP_ARRAYS = letters_of_parts(LoopBlock)
"""Signature in letters, floats and integers; see :func:`fuzzyarm.symbolic.kernels.routine`."""


def loop_bindings(
    dynamics: Dynamics | None, *, single: bool, of_text: bool
) -> dict[str, Callable[..., Any]]:
    """Return the functions bound to names of the kernel before compilation.

    Parameters
    ----------
    dynamics : Dynamics or None
        The plant's kernel, to be compiled into the loop; None for a call by address.
    single : bool
        Whether values are stored in single precision: a constant, so the test vanishes.
    of_text : bool
        Whether the only law is one controller as text, compiled into the loop, too.
    """
    bindings: dict[str, Callable[..., Any]] = {}
    if dynamics is not None and dynamics.kernel is not None:
        bindings |= dynamics.bindings
        bindings |= {"ask_plant": ask_plant_inside, "plant_kernel": dynamics.kernel}
        bindings["frame_of"] = known_frame(*dynamics.ports)
    if of_text:
        bindings["summed_drives"] = drives_of_text
    bindings["stored"] = stored_single if single else stored_double
    return bindings


class Frame(NamedTuple):
    """The layout of the board, see the head of this module.

    Attributes
    ----------
    references : int
        Number of references.
    seen, observation_end, true, driven : int
        First cells of these parts; the cells before `observation_end` are a law's observation.
    drives : int
        Number of drives.
    """

    references: int
    seen: int
    observation_end: int
    true: int
    driven: int
    drives: int


@kernel
def frame_of(count: int, size: int, cells: int) -> Frame:
    """Divide a board of `cells` cells by the numbers of references and drives."""
    outputs = (cells - CLOCK - count - 2 * size) // 2
    seen = CLOCK + count
    observation_end = seen + outputs
    return Frame(
        count, seen, observation_end, observation_end + size, observation_end + size + outputs, size
    )


@cache
def known_frame(references: int, outputs: int, drives: int) -> Callable[[int, int, int], Frame]:
    """Return a kernel with the constant frame of a plant.

    Loops over ports then have constant lengths, and the compiler unrolls them.
    """
    frame = frame_of(references, drives, CLOCK + references + 2 * (outputs + drives))
    name = f"frame_of_{references}_{outputs}_{drives}"
    source = f"def {name}(count, size, cells):\n    return Frame{tuple(frame)}\n"
    space: dict[str, Any] = {"Frame": Frame, "__name__": __name__}
    exec(source, space)
    function: Any = kernel(space[name])
    function.__source__ = source
    return function  # type: ignore[no-any-return]


@kernel
def constants_of(s: list[float]) -> LoopConstants:
    """Read the constants of a run."""
    return LoopConstants(s[0], s[1] != 0.0, int(s[2]), s[3] != 0.0, s[4], int(s[5]), int(s[6]))


@kernel
def refer(
    board: list[float],
    frame: Frame,
    references: list[float],
    point: int,
    iteration: int,
    setting: LoopConstants,
) -> None:
    """Write the references of a period: those of the set point, or interpolated to the next."""
    at = point * frame.references
    for i in range(frame.references):
        board[CLOCK + i] = references[at + i]
    if setting.interpolated and at + frame.references < len(references):
        share = iteration / setting.every
        for i in range(frame.references):
            change = references[at + frame.references + i] - references[at + i]
            board[CLOCK + i] = references[at + i] + change * share


@kernel
def tap(board: list[float], taps: list[int], record: list[float], samples: int) -> None:
    """Record a sample."""
    length = len(record) // max(len(taps), 1)  # of a row: all sampled set points
    # One row for each tap: readers go along rows.
    for i in range(len(taps)):
        record[length * i + samples] = board[taps[i]]


# Calls of plant and laws; plain Python is bound to these names.


@kernel
def plant_kernel(
    x: list[float], y: list[float], u: list[float], p: list[float], clock: list[float]
) -> None:
    """Stand in for the kernel of a plant, bound to this name."""


@kernel
def ask_plant_inside(
    task: int,
    links: list[int],
    x: list[float],
    y: list[float],
    u: list[float],
    p: list[float],
    clock: list[float],
) -> None:
    """As :func:`ask_plant`, for a plant compiled into the loop."""
    clock[TASK] = task
    plant_kernel(x, y, u, p, clock)


@kernel
def actuate(
    links: list[int],
    x: list[float],
    y: list[float],
    u: list[float],
    p: list[float],
    clock: list[float],
    limits: list[float],
    dead_times: list[float],
    tick: int,
) -> None:
    """Turn commands into actuator values: the plant or the limits do it, then dead times."""
    if links[ACTUATES] != 0:
        ask_plant(ACTUATE, links, x, y, u, p, clock)
    else:
        limit(u, limits, clock[IN_SINGLE] != 0.0)
    postpone(u, dead_times, tick)


@kernel
def derive(
    links: list[int],
    x: list[float],
    y: list[float],
    u: list[float],
    p: list[float],
    clock: list[float],
) -> None:
    """Derive further measurements from measured outputs, for plants that define some."""
    if links[DERIVES] != 0:
        ask_plant(DERIVE, links, x, y, u, p, clock)


@kernel
def control(
    board: list[float],
    observation_end: int,
    size: int,
    laws: list[int],
    numbers: list[float],
    memory: list[float],
    drives: list[float],
) -> None:
    """Sum the drives of all control laws."""
    summed_drives(board, observation_end, size, laws, numbers, memory, drives)


# --- Chatter ---
#
# After the clock, for each drive: its value in the last control period, the sum of the magnitudes
# and the sum of the squares of its changes. The first drive of a run is not a change.

LAST, MAGNITUDES, SQUARES = range(3)
"""Rows of these sums, in order."""

CHANGES = 3
"""Rows of these sums."""


@kernel
def note_changes(drives: list[float], size: int, clock: list[float], tick: int) -> None:
    """Add up the changes of the drives from one control period to the next."""
    for i in range(size):
        drive = drives[i]
        if tick > 0:
            change = abs(drive - clock[CLOCK_SIZE + i])
            clock[CLOCK_SIZE + MAGNITUDES * size + i] += change
            clock[CLOCK_SIZE + SQUARES * size + i] += change * change
        clock[CLOCK_SIZE + i] = drive


# --- Errors over all control periods ---
#
# After the changes, for each tracked output: the sums of squared errors from the law's reference
# and from the path between set points, and the number of periods with a NaN error, left out of
# both.

HELD, ALONG_PATH, UNKNOWN = range(3)
"""Rows of these sums, in order."""

ERRORS = 3
"""Rows of these sums."""


@kernel
def note_errors(
    board: list[float],
    taps: list[int],
    path: list[float],
    tick: int,
    errors: list[float],
    count: int,
) -> None:
    """Add up the squared errors of a control period, for `count` outputs."""
    has_path = len(path) > 0
    for i in range(count):
        value = board[taps[i]]
        error = board[taps[count + i]] - value
        if math.isnan(error):
            errors[UNKNOWN * count + i] += 1.0
        else:
            errors[HELD * count + i] += error * error
            # Without a path both sums have the held set point.
            if has_path:
                error = path[tick * count + i] - value
            errors[ALONG_PATH * count + i] += error * error


# --- Actuators ---


@kernel
def push(drives: list[float], size: int, pushes: list[float], tick: int) -> None:
    """Add the loads of a control period, if any."""
    if len(pushes) > 0:
        for i in range(size):
            drives[i] += pushes[tick * size + i]


# --- Sensors ---
#
# Ten numbers for each output, followed by the ring buffers of delayed values. A sensor may form the
# rate of another output from its measured value.

QUANTUM, LOWEST, HIGHEST, DELAY, RING, RATE_OF, FILTER, BEFORE, FILTERED, NOISY = range(10)
SENSOR = 10
"""Of a sensor: resolution (0: none) and the range of its steps; delay in periods and the index of
its ring; the output whose rate it forms (-1: none), the time constant of its filter, s, the last
value and the filtered rate; its column of the noise (-1: none)."""


@kernel
def sense(
    board: list[float], frame: Frame, sensors: list[float], noise: list[float], tick: int
) -> None:
    """Write the measured outputs: rate, noise, resolution, then delay.

    `noise` has one row for each control period, drawn beforehand, so that a run depends on its seed
    alone.
    """
    columns = 0
    for i in range(frame.observation_end - frame.seen):
        if sensors[SENSOR * i + NOISY] >= 0.0:
            columns += 1
    for i in range(frame.observation_end - frame.seen):
        at = SENSOR * i
        value = board[frame.true + i]
        source = int(sensors[at + RATE_OF])
        if source >= 0:
            value = differentiated(sensors, at, board[frame.seen + source], board[0])
        if sensors[at + NOISY] >= 0.0:
            value += noise[tick * columns + int(sensors[at + NOISY])]
        board[frame.seen + i] = delayed(sensors, at, quantised(sensors, at, value), tick)


@kernel
def quantised(sensors: list[float], at: int, value: float) -> float:
    """Round to the nearest step of a sensor, a multiple of its resolution within its range."""
    quantum = sensors[at + QUANTUM]
    if quantum > 0.0 and not math.isnan(value):
        step = math.floor(value / quantum + 0.5) * quantum
        return min(max(step, sensors[at + LOWEST]), sensors[at + HIGHEST])
    return value


@kernel
def delayed(sensors: list[float], at: int, value: float, tick: int) -> float:
    """Delay a sensor by n periods; at first it repeats its first value."""
    count, ring = int(sensors[at + DELAY]), int(sensors[at + RING])
    if tick == 0:
        for k in range(count):
            sensors[ring + k] = value
    return handed_on(sensors, ring, count, value, tick)


@kernel
def differentiated(sensors: list[float], at: int, value: float, step: float) -> float:
    """Form the rate of a value by a filtered difference (first-order lag, implicit Euler)."""
    if math.isnan(value):  # a lost sample changes no state
        return value
    before = sensors[at + BEFORE]
    sensors[at + BEFORE] = value
    if math.isnan(before):  # first value
        return 0.0
    slope = (value - before) / step
    sensors[at + FILTERED] += (
        (slope - sensors[at + FILTERED]) * step / (sensors[at + FILTER] + step)
    )
    return sensors[at + FILTERED]


# --- Divergence, and disturbances of the states ---


@kernel
def within(
    board: list[float],
    checks: list[int],
    bounds: list[float],
    state: list[float],
    drives: list[float],
) -> bool:
    """Whether all outputs and errors are within their bounds.

    A NaN output counts as a failed sensor while all states and drives are finite; a plant without
    states cannot tell, so there it counts as divergence.
    """
    for i in range(len(bounds)):
        value = board[checks[2 * i + 1]]
        if checks[2 * i] >= 0:
            value = board[checks[2 * i]] - value
        if not abs(value) <= bounds[i]:  # true of NaN, too
            lost = math.isnan(value) and len(state) > 0
            if not (lost and all_finite(state) and all_finite(drives)):
                return False
    return True


@kernel
def all_finite(values: list[float]) -> bool:
    """Whether all values are finite."""
    for i in range(len(values)):  # noqa: SIM110  (a kernel has no generators)
        if values[i] - values[i] != 0.0:  # true of NaN and of infinity: inf - inf is NaN
            return False
    return True


@kernel
def drawn(random: int) -> int:
    """Advance a 31-bit linear congruential generator; no product overflows 64 bits."""
    # Factor and summand of the example in the C standard: all 2³¹ numbers in turn.
    return (random * 1103515245 + 12345) % 2147483648


@kernel
def disturbed(state: list[float], setting: LoopConstants, random: int) -> int:
    """Multiply each state by 1 + size times a random number in [-1, 1)."""
    # One draw for each state in turn: a run depends on its seed alone, on any machine and with any
    # number of threads. 2³⁰ is the middle of the generator's range.
    scale = setting.disturbance / 1073741824.0
    for i in range(setting.states):
        random = drawn(random)
        state[i] = stored(state[i] * (1.0 + scale * (random - 1073741824)), setting.single)
    return random


# --- Error norms of a run (section 3.4) ---

Vector = NDArray[np.float64]


def rms(errors: Vector) -> Vector:
    """Return the root of the mean square of each column.

    Parameters
    ----------
    errors : ndarray, shape (n, k) or (n,)
        Samples of the tracking error; lost samples (NaN) do not count, none gives NaN.
    """
    if not len(errors):
        return _all_nan(errors)
    # The last running sum equals np.mean's sum, in a third of the time.
    squares = np.add.accumulate(np.square(errors), axis=0)[-1]
    if np.isnan(squares).any():
        return by_column(errors, lambda known: math.sqrt(np.mean(np.square(known))))
    return np.asarray(np.sqrt(squares / len(errors)))


def final(errors: Vector) -> Vector:
    """Return the last error of each column, NaN ignored."""
    return by_column(errors, lambda known: known[-1])


def by_column(errors: Vector, figure: Callable[[Vector], float]) -> Vector:
    """Apply a function to the errors of each column without NaN; NaN if none is left."""
    columns = [column[~np.isnan(column)] for column in np.atleast_2d(errors.T)]
    figures = np.array([figure(known) if len(known) else math.nan for known in columns])
    return figures.reshape(errors.shape[1:])


def signed_maximum(errors: Vector, kind: Literal["magnitude", "positive"] = "magnitude") -> Vector:
    """Return the largest error of each column.

    Parameters
    ----------
    errors : ndarray, shape (n, 2)
        Samples of the tracking error; lost samples (NaN) do not count, none gives NaN.
    kind : {"magnitude", "positive"}
        The error of largest magnitude with its sign, or the most positive one.
    """
    if kind == "positive":
        return by_column(errors, np.max)
    return by_column(errors, lambda known: known[np.abs(known).argmax()])


def _all_nan(errors: Vector) -> Vector:
    return np.full(errors.shape[1], np.nan)
