"""The fuzzy laws: control by a lookup table, and by rules evaluated at every step."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.controller.law import Arithmetic, Gain, Gains, Law
from fuzzyarm.controller.sources import (
    COLUMN,
    ERROR,
    FULL_SCALE,
    JOINT,
    RATE,
    ROW,
    SUPPLY,
    WIRED,
    WIRES,
    SourceError,
    joint_tables,
    motor_torques,
    pack_values,
    pack_wires,
    scaled_errors,
)
from fuzzyarm.inference.kernel import COLUMNS, RESULTS, evaluate
from fuzzyarm.inference.layout import NotCoveredError, lay_out, make_block
from fuzzyarm.inference.plan import plan
from fuzzyarm.kernels import address_of, call, kernel
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.plant.setting import Moment, Pair
from fuzzyarm.table import LookupTable
from fuzzyarm.table.lookup import cell_of, grid_length, interpolated

# --- Fuzzy control by rules evaluated at every step: direct, self-tuning, coarse and fine ---
#
# One kernel serves all (sections 6.4 to 6.6): the control of a rule base, times a gain,
# times, if there is one, the factor α of a second rule base; where a zoom is set, errors
# inside its window are magnified first.

OUTPUT = Gain("G_u", (1.0,), "1", "control of the rules")
ZOOM = Gain("zoom", (2.0,), "1", "magnifies both inputs inside the window", positive=True)
WINDOW = Gain("window", (3.0,), "1", "both inputs have to be within ± this to be magnified")
SMOOTH = Gain(
    "smooth", (0.0,), "1", "0: the magnification ends abruptly; 1: inputs wait at the edge", "own"
)

FINE = ERROR.with_value([1080.0], "printed")
"""The error gain of the controllers without a table."""

SIGNALS = {ROW: 0, COLUMN: 1, JOINT: 2}
"""What an input of a rule base may be called, and its number in the kernel."""

BEGIN, END, INPUT, RESULT, INPUTS = range(5)
BASE_HEAD = 5
"""Links of each rule base: where its block begins and ends in the memory, where in the block
its inputs and its result are, how many inputs; behind these the signal of each input."""


@kernel
def fuzzy_rules_torque(
    now: Moment, numbers: list[float], memory: list[float], links: list[int]
) -> Pair:
    """Return the motors' torque at the voltage that the rules conclude from e and ė.

    Constants: wires, output gain, zoom, window, smooth. Memory: a block of the inference for
    each rule base. Links: the inference, the number of rule bases, `BASE_HEAD` and more for
    each.
    """
    _, state, _, clock = now
    # Sections 6.4 to 6.6; both joints have the same rules, which may ask for the joint.
    first = second = 0.0
    for joint in range(2):  # called in one line: it is compiled once for both joints
        concluded = concluded_control(joint, now, numbers, memory, links)
        first, second = second, concluded
    return motor_torques((first, second), state, numbers, clock.single)


@kernel
def concluded_control(
    joint: int, now: Moment, numbers: list[float], memory: list[float], links: list[int]
) -> float:
    """Return the gain times what each rule base concludes for one joint."""
    reference, state, _, clock = now
    e, ce = scaled_errors(joint, reference, state, numbers, clock.single)
    zoom = magnification(
        max(abs(e), abs(ce)), numbers[WIRED + 1], numbers[WIRED + 2], numbers[WIRED + 3]
    )
    # u = G_u · pd(e, ė) · α(e, ė): the rule bases multiply in the order of the links. Only their
    # inputs are magnified; neither α nor the gain is made smaller for it (the study's CFAF).
    control = numbers[WIRED]
    base = 2
    for _ in range(links[1]):
        # A block is a rule base with room for one point: inputs in, evaluate, result out.
        block = memory[links[base + BEGIN] : links[base + END]]
        for i in range(links[base + INPUTS]):
            signal = links[base + BASE_HEAD + i]
            if signal == 0:
                block[links[base + INPUT] + i] = zoom * e
            elif signal == 1:
                block[links[base + INPUT] + i] = zoom * ce
            else:
                block[links[base + INPUT] + i] = joint + 1.0
        call(links[0], block)
        control *= block[links[base + RESULT]]
        base += BASE_HEAD + links[base + INPUTS]
    return control


def evaluate_view(block: Any) -> None:
    """Evaluate a rule base as plain Python, its block a view as the interpreted loop has it."""
    evaluate(np.asarray(block))


def inference_address(*, compiled: bool) -> int:
    """Return where laws find the inference kernel."""
    return address_of(evaluate if compiled else evaluate_view, 1, compiled=compiled)


class PointBlock(NamedTuple):
    """A rule base for the inference kernel at one point: numbers, where inputs and result are."""

    numbers: NDArray[np.float64]
    first_input: int
    result: int


def point_block(rulebase: RuleBase, *, compiled: bool) -> PointBlock:
    """Write down a rule base for :func:`inference_address`.

    Raises
    ------
    SourceError
        If the kernel cannot evaluate it; it says why.
    """
    if len(rulebase.outputs) != 1:
        raise _refuse(rulebase, f"it has {len(rulebase.outputs)} outputs, one is needed")
    try:
        numbers = make_block(lay_out(plan(rulebase), compiled=compiled), 1).numbers
    except NotCoveredError as error:
        raise _refuse(rulebase, str(error)) from None
    whole = numbers.view(np.int64)
    return PointBlock(numbers, int(whole[COLUMNS]), int(whole[RESULTS]))


def _refuse(rulebase: RuleBase, what: str) -> SourceError:
    return SourceError(
        f"a controller cannot evaluate '{rulebase.name}' at every step: {what}",
        hint="compile it to a table and run fuzzy-lut with that",
    )


@kernel
def magnification(size: float, zoom: float, window: float, smooth: float) -> float:
    """Return by how much inputs are magnified, of which the larger has this size.

    Abruptly: `zoom` up to the edge of the window (section 6.6: "within [-3 3]"), else 1.
    Smoothly: inputs grow by `zoom` until the larger one comes to the edge of the window and
    wait there, so that nothing jumps.
    """
    if size > window:
        return 1.0
    if smooth != 0.0 and size * zoom > window:
        return window / size
    return zoom


def direct_law(rulebase: RuleBase) -> Law:
    """Make the law of direct fuzzy control."""
    summary = "direct fuzzy control: the rules evaluated at every step"
    return _law("fuzzy-direct", summary, (OUTPUT,), rulebase, None)


def self_tuning_law(rulebase: RuleBase, alpha: RuleBase) -> Law:
    """Make the law of self-tuning control: a second rule base scales the first."""
    summary = "self-tuning fuzzy control: a second rule base scales the output"
    return _law("stfc", summary, (_tripled(),), rulebase, alpha)


def coarse_fine_law(rulebase: RuleBase, alpha: RuleBase) -> Law:
    """Make the law of coarse and fine control: self-tuning, magnified near zero."""
    summary = "coarse/fine fuzzy control: self-tuning, small errors magnified"
    return _law("cfaf", summary, (_tripled(), ZOOM, WINDOW, SMOOTH), rulebase, alpha)


def _tripled() -> Gain:
    return OUTPUT.with_value([3.0], "printed")


def _law(
    name: str, summary: str, gains: tuple[Gain, ...], rulebase: RuleBase, alpha: RuleBase | None
) -> Law:
    bases = [rulebase] if alpha is None else [rulebase, alpha]
    signals = [_signals(base) for base in bases]

    @cache
    def blocks(compiled: bool) -> list[PointBlock]:
        return [point_block(base, compiled=compiled) for base in bases]

    def pack(gains: Gains, arithmetic: Arithmetic) -> list[float]:
        front = pack_wires(gains, arithmetic)
        for gain, absent in ((OUTPUT, 1.0), (ZOOM, 1.0), (WINDOW, 0.0), (SMOOTH, 0.0)):
            front.append(gains[gain.name].value[0] if gain.name in gains else absent)
        return front

    def remember(_gains: Gains, arithmetic: Arithmetic) -> NDArray[np.float64]:
        return np.concatenate([block.numbers for block in blocks(arithmetic.compiled)])

    def links(arithmetic: Arithmetic) -> list[int]:
        words = [inference_address(compiled=arithmetic.compiled), len(bases)]
        begin = 0
        for block, inputs in zip(blocks(arithmetic.compiled), signals, strict=True):
            end = begin + len(block.numbers)
            words += [begin, end, block.first_input, block.result, len(inputs), *inputs]
            begin = end
        return words

    wires = (FINE, RATE, SUPPLY, FULL_SCALE)
    return Law(name, fuzzy_rules_torque, summary, (*wires, *gains), pack, remember, links, False)


def _signals(rulebase: RuleBase) -> list[int]:
    for variable in rulebase.inputs:
        if variable.name not in SIGNALS:
            raise SourceError(
                f"'{rulebase.name}' asks for '{variable.name}', which a controller does not have",
                hint=f"rules for the arm have the inputs {', '.join(SIGNALS)}, or some of them:"
                " 'fuzzyarm new' writes such a file",
            )
    return [SIGNALS[variable.name] for variable in rulebase.inputs]


# --- Fuzzy control by a lookup table (section 6.1) ---


@kernel
def fuzzy_table_torque(
    now: Moment, numbers: list[float], memory: list[float], links: list[int]
) -> Pair:
    """Return the motors' torque at the voltage that the tables name for e and ė.

    Constants: wires, grid, values of joint 1, values of joint 2.
    """
    # One grid serves both joints: thresholds and levels once, then the values of joint 1 and,
    # `cells` behind, those of joint 2; numbers[grid + 2] says whether it interpolates.
    reference, state, _, clock = now
    grid = WIRED
    values = grid + grid_length(numbers, grid)
    cells = int(numbers[grid]) * int(numbers[grid + 1])
    e_1, ce_1 = scaled_errors(0, reference, state, numbers, clock.single)
    e_2, ce_2 = scaled_errors(1, reference, state, numbers, clock.single)
    if numbers[grid + 2] != 0.0:
        control = (
            interpolated(numbers, grid, values, e_1, ce_1),
            interpolated(numbers, grid, values + cells, e_2, ce_2),
        )
    else:
        control = (
            numbers[values + cell_of(numbers, grid, e_1, ce_1)],
            numbers[values + cells + cell_of(numbers, grid, e_2, ce_2)],
        )
    return motor_torques(control, state, numbers, clock.single)


def fuzzy_table_law(table: LookupTable) -> Law:
    """Make the law of a table over e and ce, or of one for each joint."""
    tables = joint_tables(table)

    def pack(gains: Gains, arithmetic: Arithmetic) -> list[float]:
        wires = pack_wires(gains, arithmetic)
        return [*wires, *tables.grid(), *pack_values(tables, arithmetic)]

    summary = "fuzzy control by a lookup table, through motors with back-EMF"
    return Law("fuzzy-lut", fuzzy_table_torque, summary, WIRES, pack=pack)
