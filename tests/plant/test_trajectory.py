"""Set points: counts, shapes, ends, precision, and what is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm.plant import (
    PLAIN,
    STUDY_CONVENTIONAL,
    STUDY_DIRECT,
    ArmError,
    Segment,
    Trajectory,
    pick_and_place,
    reach,
    reach_return,
    through,
)
from fuzzyarm.plant.setting import STUDY_TIMING, Timing
from fuzzyarm.plant.trajectory import sample


def full(points):
    return int((points.iterations == 5).sum())


@pytest.mark.parametrize("conventions", [STUDY_CONVENTIONAL, STUDY_DIRECT])
def test_study_counts_666_samples_in_two_seconds_and_1666_in_five(conventions):
    points = sample(pick_and_place(), conventions)
    assert full(points) == 4 * 666
    assert (points.iterations == 1).sum() == 4
    points = sample(reach_return(), conventions)
    assert full(points) == 3 * 1666
    # The set point with one iteration is the last of its segment.
    assert points.iterations[[1666, 3333, 5000]].tolist() == [1, 1, 1]


def test_plain_gives_every_set_point_its_five_iterations():
    assert (
        full(sample(reach_return(), PLAIN)) == 3 * 1667 == len(sample(reach_return(), PLAIN).time)
    )
    assert full(sample(pick_and_place(), PLAIN)) == 4 * 667


@given(st.floats(0.01, 6.0), st.booleans())
def test_time_accumulates_while_it_does_not_exceed_the_duration(duration, single):
    conventions = replace(PLAIN, precision="float32" if single else "float64")
    number = np.float32 if single else np.float64
    count, t = 0, number(0.0)
    while t <= number(duration):
        t = number(t + number(0.003))
        count += 1
    points = sample(reach(segment=duration, hold=0.01), conventions)
    assert (points.segment == 0).sum() == count


@pytest.mark.slow
def test_long_single_precision_segments_are_not_cut_short():
    points = sample(reach(segment=600.0, hold=0.01), STUDY_CONVENTIONAL)
    first = points.segment == 0
    assert points.time[first][-1] + 0.0031 > 600.0
    assert points.position[first][-1, 0] == pytest.approx(points.position[-1, 0], abs=1e-5)


def test_quintic_agrees_with_the_interpolating_polynomial():
    # The one polynomial of degree five with these ends: solved, not written down.
    duration, end = 1.7, math.radians(63.0)
    rows = []
    for t in (0.0, duration):
        rows += [
            [t**k for k in range(6)],
            [k * t ** (k - 1) if k else 0.0 for k in range(6)],
            [k * (k - 1) * t ** (k - 2) if k > 1 else 0.0 for k in range(6)],
        ]
    polynomial = np.polynomial.Polynomial(np.linalg.solve(rows, [0, 0, 0, end, 0, 0]))
    points = sample(reach((63.0, -20.0), duration), PLAIN)
    moving = points.segment == 0
    t = points.time[moving]
    np.testing.assert_allclose(points.position[moving, 0], polynomial(t), atol=1e-12)
    np.testing.assert_allclose(points.velocity[moving, 0], polynomial.deriv()(t), atol=1e-11)
    np.testing.assert_allclose(points.acceleration[moving, 0], polynomial.deriv(2)(t), atol=1e-10)


def test_way_back_is_the_mirror_and_a_hold_does_not_move():
    points = sample(reach_return((50.0, -70.0), 1.2, 0.6), PLAIN)
    there, back = (points.position[points.segment == index] for index in (0, 1))
    ends = np.radians([50.0, -70.0])
    np.testing.assert_allclose(there + back, np.broadcast_to(ends, there.shape), atol=1e-12)
    held = points.segment == 2
    assert not points.position[held].any()
    assert not points.velocity[held].any()
    assert not points.acceleration[held].any()
    assert (np.diff(points.time) > 0).all()


def test_study_pi_scales_angles():
    plain, study = (sample(reach(), each) for each in (PLAIN, STUDY_CONVENTIONAL))
    assert plain.position[-1, 0] == pytest.approx(math.pi / 2, abs=1e-15)
    assert study.position[-1, 0] == np.float32(90 * 3.142857 / 180)


def test_single_precision_set_points_are_single():
    points = sample(pick_and_place(), STUDY_CONVENTIONAL)
    for array in (points.position, points.velocity, points.acceleration):
        assert (array == array.astype(np.float32)).all()


def test_way_points():
    path = through([(10.0, 20.0), (30.0, -40.0)], 0.5, hold=0.3)
    assert [segment.hold for segment in path.segments] == [False, False, True]
    assert path.duration == pytest.approx(1.3)
    points = sample(path, PLAIN)
    np.testing.assert_allclose(np.degrees(points.position[-1]), [30.0, -40.0], atol=1e-12)
    with pytest.raises(ArmError, match="at least one"):
        through([])


@pytest.mark.parametrize("angle", [math.nan, math.inf, 3601.0, -1e9])
def test_angles_out_of_sense_are_refused(angle):
    with pytest.raises(ArmError, match="angle") as caught:
        sample(reach((angle, 0.0)), PLAIN)
    assert caught.value.name == "angle"
    if math.isfinite(angle):  # of what is no angle any number will do
        assert sample(reach((angle, 0.0)), PLAIN, STUDY_TIMING, (False, False)).position.any()


@pytest.mark.parametrize("duration", [0.0, -1.0, math.nan, math.inf, 0.003, 601.0])
def test_durations_out_of_sense_are_refused(duration):
    with pytest.raises(ArmError, match="segment of"):
        sample(reach(segment=duration), PLAIN)


def test_a_segment_has_a_set_point_and_may_be_long_at_other_periods():
    slow = Timing(10.0, 1)
    assert len(sample(reach(segment=3600.0, hold=10.0), PLAIN, slow).time) == 361 + 2
    with pytest.raises(ArmError, match="at least a set point, 10 s"):
        sample(reach(segment=9.0), PLAIN, slow)


def test_trajectories_of_other_numbers_of_outputs():
    one = through([(0.5,), (-1.0,)], 2.0, start=(0.25,))
    points = sample(one, PLAIN, Timing(0.1, 1), (False,))
    assert points.position.shape == (42, 1)
    assert points.position[[0, 20, -1], 0] == pytest.approx([0.25, 0.5, -1.0])
    twice = one.scaled(2.0)
    assert [segment.end for segment in twice.segments] == [(0.75,), (-2.25,)]
    assert twice.words == "(0.75), (-2.25) in 2 s each"
    # Lists will do; what does not fit together is refused.
    assert Segment([0], [1], 2).end == (1.0,)
    assert hash(Trajectory("x", [Segment([0], [1], 2)]))
    with pytest.raises(ArmError, match="2 numbers at its start and 1 at its end"):
        Segment((0.0, 0.0), (1.0,), 1.0)
    with pytest.raises(ArmError, match="segments of 1 and 2 numbers"):
        Trajectory("x", (*one.segments, *reach().segments))
    with pytest.raises(ArmError, match="2 values for 1 segments"):
        Trajectory("x", one.segments[:1], (True, False))
    with pytest.raises(ArmError, match="no segments"):
        Trajectory("x", ())


def test_shared_set_points_cannot_be_written():
    with pytest.raises(ValueError, match="read-only"):
        sample(reach(), PLAIN).position[0, 0] = 1.0
