"""The fuzzy laws: control by a lookup table, and by rules evaluated at every step."""

from __future__ import annotations

from fuzzyarm.controller.fuzzy_kernel import INPUTS, inference_address, rule_numbers
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
    cell_of,
    grid_length,
    interpolated,
    joint_tables,
    motor_torques,
    pack_grid,
    pack_values,
    pack_wires,
    scaled_errors,
)
from fuzzyarm.kernels import call, kernel
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.plant.setting import Moment, Pair
from fuzzyarm.table import LookupTable

# --- Fuzzy control by rules evaluated at every step: direct, self-tuning, coarse and fine ---
#
# One kernel serves all (sections 6.4 to 6.6): the control of a rule base, times a gain,
# times, if there is one, the factor α of a second rule base; where a zoom is set, errors
# inside its window are magnified first.

OUTPUT = Gain("G_u", (1.0,), "1", "control of the rules")
ZOOM = Gain("zoom", (2.0,), "1", "magnifies both inputs inside the window", positive=True)
WINDOW = Gain("window", (3.0,), "1", "both inputs have to be inside ± this to be magnified")
SMOOTH = Gain(
    "smooth", (0.0,), "1", "0: the magnification ends abruptly; 1: inputs wait at the edge", "own"
)

FINE = ERROR.with_value([1080.0], "printed")
"""The error gain of the controllers without a table."""

SIGNALS = {ROW: 0, COLUMN: 1, JOINT: 2}
"""What an input of a rule base may be called, and its number in the kernel."""

FRONT = WIRED + 6
"""Numbers in front of the rule bases."""


@kernel
def fuzzy_rules_torque(
    now: Moment, numbers: list[float], memory: list[float], links: list[int]
) -> Pair:
    """Return the motors' torque at the voltage that the rules conclude from e and ė.

    Constants: wires, output gain, zoom, window, smooth, where the first rule base begins and
    where the second does (0 for none), and each with the signals of its inputs in front of
    it. Memory: room to work. Link: the inference.
    """
    _, state, _, clock = now
    control = (
        concluded_control(0, now, numbers, memory, links),
        concluded_control(1, now, numbers, memory, links),
    )
    return motor_torques(control, state, numbers, clock.single)


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
    control = numbers[WIRED]
    for part in range(2):
        base = int(numbers[WIRED + 4 + part])
        if base > 0:
            inputs = int(numbers[base + INPUTS])
            for i in range(inputs):
                signal = int(numbers[base - inputs + i])
                if signal == 0:
                    memory[i] = zoom * e
                elif signal == 1:
                    memory[i] = zoom * ce
                else:
                    memory[i] = joint + 1.0
            call(links[0], numbers[base:], memory)
            control *= memory[0]
    return control


@kernel
def magnification(size: float, zoom: float, window: float, smooth: float) -> float:
    """Return by how much inputs are magnified, of which the larger has this size.

    Abruptly: `zoom` up to the edge of the window (section 6.6: "within [-3 3]"), else 1. Smoothly: inputs grow by `zoom` until the
    larger one comes to the edge of the window and wait there, so that nothing jumps.
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
    bases = [rule_numbers(rulebase), rule_numbers(alpha) if alpha is not None else None]
    signals = [_signals(rulebase), _signals(alpha) if alpha is not None else []]
    room = max(base.room for base in bases if base is not None)

    def pack(gains: Gains, arithmetic: Arithmetic) -> list[float]:
        front = pack_wires(gains, arithmetic)
        for gain, absent in ((OUTPUT, 1.0), (ZOOM, 1.0), (WINDOW, 0.0), (SMOOTH, 0.0)):
            front.append(gains[gain.name].value[0] if gain.name in gains else absent)
        places: list[float] = []
        bodies: list[float] = []
        for base, inputs in zip(bases, signals, strict=True):
            bodies += inputs
            places.append(FRONT + len(bodies) if base is not None else 0.0)
            bodies += base.numbers if base is not None else ()
        return [*front, *places, *bodies]

    def remember(_gains: Gains, _arithmetic: Arithmetic) -> list[float]:
        return [0.0] * room

    wires = (FINE, RATE, SUPPLY, FULL_SCALE)
    return Law(
        name,
        fuzzy_rules_torque,
        summary,
        (*wires, *gains),
        pack=pack,
        remember=remember,
        links=lambda compiled: [inference_address(compiled)],
    )


def _signals(rulebase: RuleBase) -> list[float]:
    for variable in rulebase.inputs:
        if variable.name not in SIGNALS:
            raise SourceError(
                f"'{rulebase.name}' asks for '{variable.name}', which a controller does not have",
                hint=f"its inputs may be called {', '.join(SIGNALS)}",
            )
    return [float(SIGNALS[variable.name]) for variable in rulebase.inputs]


# --- Fuzzy control by a lookup table (section 6.1) ---


@kernel
def fuzzy_table_torque(
    now: Moment, numbers: list[float], memory: list[float], links: list[int]
) -> Pair:
    """Return the motors' torque at the voltage that the tables name for e and ė.

    Constants: wires, grid, values of joint 1, values of joint 2.
    """
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
        return [*wires, *pack_grid(tables), *pack_values(tables, arithmetic)]

    summary = "fuzzy control by a lookup table, through motors with back-EMF"
    return Law("fuzzy-lut", fuzzy_table_torque, summary, WIRES, pack=pack)
