"""Which arm moves in which segment."""

import numpy as np
import pytest

from fuzzyarm.control.loop.loop import final, rms, signed_maximum
from fuzzyarm.plant import (
    LOADED,
    PLAIN,
    STUDY_CONVENTIONAL,
    STUDY_DIRECT,
    UNLOADED,
    Arm,
    ArmError,
    carried,
    pick_and_place,
    reach,
    reach_return,
    with_load,
)
from fuzzyarm.plant.arm import RATIOS, RESISTANCE, TORQUE_CONSTANT, motor_torque
from fuzzyarm.plant.plant import with_parameters


def loads(*args, **kwargs):
    return [*carried(*args, **kwargs)]


def test_load_is_on_from_the_second_segment_and_in_the_hold():
    assert loads(reach_return(), payload=True) == [False, True, True]
    assert loads(reach_return(), payload=True, conventions=PLAIN) == [False, True, True]
    assert loads(reach_return(), payload=True, conventions=STUDY_CONVENTIONAL) == [
        False,
        True,
        True,
    ]
    assert loads(reach(), payload=True) == [False, True]


def test_hold_without_load_where_the_study_had_none():
    assert loads(reach_return(), payload=True, conventions=STUDY_DIRECT) == [False, True, False]


def test_pick_and_place_carries_in_the_second_and_fourth_segment():
    assert loads(pick_and_place(), payload=True) == [False, True, False, True]
    assert loads(pick_and_place()) == [False] * 4


def test_own_schedule_overrules():
    assert loads(reach_return(), segments=[1, 3]) == [True, False, True]


def test_the_load_is_that_of_the_study_but_for_what_is_set():
    assert with_load(Arm(), 1.0).arm == LOADED
    assert with_load(Arm(), 0.0).arm == UNLOADED
    heavier = UNLOADED.with_values(m_2=9.0)
    assert with_load(Arm(heavier), 1.0).arm == LOADED.with_values(m_2=9.0)
    # By value: what is set to what it was is set.
    assert with_load(with_parameters(Arm(), {"m_2": 2.0}), 1.0).arm == LOADED.with_values(m_2=2.0)
    between = with_load(with_parameters(Arm(), {"m_2": 9.0}), 0.3).arm
    assert (between.m_2, between.m_1) == (9.0, 0.7 * 2.0 + 0.3 * 3.0)


@pytest.mark.parametrize("segment", [0, 4, -1])
def test_schedule_that_does_not_fit_is_refused(segment):
    with pytest.raises(ArmError, match="3 segments") as caught:
        carried(reach_return(), segments=[segment])
    assert caught.value.value == segment


def test_norms_of_known_errors():
    errors = np.array([[1.0, -5.0], [-3.0, 2.0], [2.0, 4.0]])
    np.testing.assert_allclose(rms(errors), [np.sqrt(14 / 3), np.sqrt(45 / 3)])
    assert final(errors).tolist() == [2.0, 4.0]
    assert signed_maximum(errors).tolist() == [-3.0, -5.0]
    assert signed_maximum(errors, "positive").tolist() == [2.0, 4.0]


def test_norms_of_no_samples_are_not_numbers():
    nothing = np.zeros((0, 2))
    for norm in (rms, final, signed_maximum):
        assert np.isnan(norm(nothing)).all()


def test_motor_stalls_and_runs_free():
    ratio = RATIOS[0]
    stall = 20.0 * TORQUE_CONSTANT / RESISTANCE * ratio
    assert motor_torque(20.0, 0.0, ratio) == pytest.approx(stall)
    free = 20.0 / (TORQUE_CONSTANT * ratio)
    assert motor_torque(20.0, free, ratio) == pytest.approx(0.0, abs=1e-12)
