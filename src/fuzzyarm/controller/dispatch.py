"""The compiled control step: a sum of laws, each found by its number."""

from __future__ import annotations

from fuzzyarm.controller.adaptive import (
    adaptive_critically_damped_torque,
    decentralised_torque,
    model_reference_torque,
)
from fuzzyarm.controller.conventional import (
    computed_torque,
    critically_damped_torque,
    feed_forward_inverse_torque,
    integral_torque,
    pd_torque,
    pure_feed_forward_torque,
)
from fuzzyarm.controller.fuzzy import fuzzy_rules_torque, fuzzy_table_torque
from fuzzyarm.controller.law import (
    ADAPTIVE_CRITICALLY_DAMPED,
    COMPUTED_TORQUE,
    CRITICALLY_DAMPED,
    DECENTRALISED,
    FEED_FORWARD_INVERSE,
    FUZZY_RULES,
    FUZZY_TABLE,
    INTEGRAL,
    MODEL_REFERENCE,
    PD,
    PURE_FEED_FORWARD,
    SELF_ORGANIZING,
)
from fuzzyarm.controller.self_organizing import self_organizing_torque
from fuzzyarm.kernels import kernel
from fuzzyarm.plant.setting import Clock, Pair, Pose, Reference, State


@kernel
def summed_torque(
    reference: Reference,
    state: State,
    pose: Pose,
    clock: Clock,
    program: list[int],
    numbers: list[float],
    memory: list[float],
) -> Pair:
    """Return the sum of the torques of all laws of a program.

    `program` holds three integers for each law: its number, where its constants
    start in `numbers`, where its memory starts in `memory`.
    """
    first = 0.0
    second = 0.0
    for part in range(0, len(program), 3):
        torque = law_torque(
            program[part],
            reference,
            state,
            pose,
            clock,
            numbers,
            program[part + 1],
            memory,
            program[part + 2],
        )
        first += torque[0]
        second += torque[1]
    return first, second


@kernel
def law_torque(  # noqa: C901, PLR0911 - one branch for each law is the point
    kind: int,
    reference: Reference,
    state: State,
    pose: Pose,
    clock: Clock,
    numbers: list[float],
    at: int,
    memory: list[float],
    cell: int,
) -> Pair:
    """Return the torque of one law."""
    if kind == CRITICALLY_DAMPED:
        return critically_damped_torque(reference, state, pose, clock.single, numbers, at)
    if kind == PD:
        return pd_torque(reference, state, numbers, at)
    if kind == INTEGRAL:
        return integral_torque(reference, state, clock, numbers, at, memory, cell)
    if kind == COMPUTED_TORQUE:
        return computed_torque(reference, state, pose, numbers, at)
    if kind == FEED_FORWARD_INVERSE:
        return feed_forward_inverse_torque(reference, state, pose, numbers, at)
    if kind == PURE_FEED_FORWARD:
        return pure_feed_forward_torque(reference, state, numbers, at)
    if kind == ADAPTIVE_CRITICALLY_DAMPED:
        return adaptive_critically_damped_torque(
            reference, state, pose, clock, numbers, at, memory, cell
        )
    if kind == MODEL_REFERENCE:
        return model_reference_torque(reference, state, pose, clock, numbers, at, memory, cell)
    if kind == DECENTRALISED:
        return decentralised_torque(reference, state, clock, numbers, at, memory, cell)
    if kind == FUZZY_TABLE:
        return fuzzy_table_torque(reference, state, clock, numbers, at)
    if kind == SELF_ORGANIZING:
        return self_organizing_torque(reference, state, clock, numbers, at, memory, cell)
    if kind == FUZZY_RULES:
        return fuzzy_rules_torque(reference, state, clock, numbers, at, memory, cell)
    return 0.0, 0.0
