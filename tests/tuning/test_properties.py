"""What holds of every search: cost never rises, bounds hold, pauses and workers do not count."""

import math
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from budget import cases
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fuzzyarm import load, shipped
from fuzzyarm.control.loop import Signal, simulate
from fuzzyarm.inference import infer
from fuzzyarm.learning.data import as_samples
from fuzzyarm.learning.tuning import Journal, tune
from fuzzyarm.learning.tuning.design import Design, MovingNumber
from fuzzyarm.learning.tuning.linear import straightened
from fuzzyarm.learning.tuning.movement import significant
from fuzzyarm.learning.tuning.optimisers import OPTIMISERS
from fuzzyarm.learning.tuning.tune import read_tuning
from fuzzyarm.plant import reach_return

HEATER = load(shipped("heater.frb"))
ROOM = {"reference": {"temperature": Signal("step", (20.0,))}, "duration": 900.0}
PD7 = load(shipped("pd7.frb"))
DRAWN = np.random.default_rng(0).uniform(-6.0, 6.0, (40, 2))
SAMPLES = as_samples(DRAWN, infer(PD7, e=1.2 * DRAWN[:, 0], ce=DRAWN[:, 1])["u"], ("e", "ce"), "u")


@st.composite
def ranges(draw):
    """Return lines for gains of the heater: plain, in multiples, or of the logarithm."""
    lines = []
    for name, value in (("G_e", 0.2), ("G_ce", 100.0), ("G_du", 0.4)):
        below, above = draw(st.floats(0.01, 3.0)), draw(st.floats(1.001, 30.0))
        if draw(st.booleans()):
            lines.append(f"gain {name} {below!r} .. {below * above!r} times")
        else:
            low = value * below
            lines.append(
                f"gain {name} {low!r} .. {low * above!r}{draw(st.sampled_from(['', ' log']))}"
            )
    return lines


searches = st.fixed_dictionaries(
    {
        "method": st.sampled_from(sorted(OPTIMISERS)),
        "evals": st.integers(1, 30),
        "seed": st.integers(0, 2**40),
        "digits": st.integers(1, 8),
        "cost": st.sampled_from(["rms", "rms + overshoot", "variation", "-rms", "0*rms"]),
        "scenarios": st.integers(1, 3),
        "tune": ranges(),
    }
)


def searched(given, **more):
    return tune(HEATER, unseen=0, linear=False, **{"workers": 1, **ROOM, **given, **more})


@settings(max_examples=cases(8, 100))
@given(searches)
def test_cost_never_rises_and_bounds_hold(given):
    made = searched(given)
    costs = [trial.score.cost for trial in made.found.trials]
    assert len(costs) == given["evals"]
    assert made.found.curve == np.minimum.accumulate(costs).tolist()
    file, own = (row.scores["train"].cost for row in made.rows)
    assert costs[0] == file
    assert max(made.found.best.score.cost, own) <= file
    inside = [trial.point for trial in made.found.trials[1:]]
    assert all(0.0 <= share <= 1.0 for point in inside for share in point)
    if made.changes:
        for each in made.parameters:
            (value,) = made.candidate.gains[each.name]
            assert each.low <= value <= each.high
    else:
        assert own == file


@pytest.mark.slow
@settings(max_examples=cases(6, 60))
@given(searches, st.integers(0, 30), st.integers(1, 4), st.booleans())
def test_a_pause_and_workers_change_nothing(given, cut, workers, torn):
    whole = searched(given)
    with TemporaryDirectory() as folder:
        path = Path(folder, "trials")
        if 0 < cut <= given["evals"]:
            searched({**given, "evals": cut}, journal=Journal(path, given, resume=False))
        if torn and path.exists():
            path.write_bytes(path.read_bytes()[:-7])
        journal = Journal(path, given, resume=True)
        again = searched(given, journal=journal, workers=workers)
        known = Journal(path, given, resume=True).replay
    assert repr(again.found.trials) == repr(whole.found.trials) == repr(known)
    assert (again.candidate, again.text) == (whole.candidate, whole.text)


@pytest.mark.slow
@settings(max_examples=cases(6, 60))
@given(st.integers(0, 2**40), st.integers(2, 30), st.sampled_from(sorted(OPTIMISERS)))
def test_terms_keep_their_order_and_what_is_promised(seed, evals, method):
    given = {"seed": seed, "evals": evals, "method": method, "data": SAMPLES}
    made = tune(PD7, tune=["peaks e, u mirrored, keep order, partition"], workers=1, **given)
    file, own = (row.scores["train"].cost for row in made.rows[:2])
    assert own <= file
    for name in ("e", "u"):
        old, new = (each.variable(name) for each in (PD7, made.model))
        assert (new.low, new.high) == (old.low, old.high)
        peaks = [term.shape.parameters[1] for term in new.terms]
        assert peaks == sorted(peaks) == [-peak for peak in reversed(peaks)]
        assert new.low <= peaks[0] < peaks[-1] <= new.high
    together = tune(PD7, tune=["peaks e, u mirrored, keep order, partition"], workers=3, **given)
    assert together.text == made.text


@example(5.0, 2.0, 2e-42, 1, "log", 0.0)  # the power of e of the logarithm of 5 is less than 5
@given(
    st.floats(1e-6, 1e6), st.floats(1.0, 1e3), st.floats(0.0, 1.0), st.integers(1, 8),
    st.sampled_from(["linear", "log"]), st.floats(0.0, 2.0),
)  # fmt: skip
def test_a_number_stays_in_its_range_however_it_is_rounded(low, factor, share, digits, scale, at):
    high = low * factor
    if not low < high:
        return
    each = MovingNumber("G", low, high, low * at * factor, scale)
    value = each.value(share)
    rounded = each.rounded(value, digits)
    assert low <= value <= high
    assert low <= rounded <= high
    assert rounded == value or significant(rounded, digits) == rounded
    assert abs(rounded - value) <= 1.01 * 10.0 ** (math.floor(math.log10(value)) + 2 - digits)
    assert (each.value(0.0), each.value(1.0)) == (low, high)


# --- The opponent has every freedom of the file ---


def line_for(text, gains):
    """Return the opponent's point that does what a file whose rules are a plane does."""
    line, moving = straightened(text)
    design = Design(line, moving)
    start = dict(
        zip([p.name for p in design.parameters], [p.start for p in design.parameters], strict=True)
    )
    own = {gain.name: gain.values[0].value(math.pi) for gain in text.model.gains}
    wanted = {
        "slope of du along en": start["slope of du along en"] * gains["G_e"] / own["G_e"],
        "slope of du along ce": start["slope of du along ce"] * gains["G_ce"] / own["G_ce"],
        "G_du": gains["G_du"],
    }
    assert set(wanted) == set(start)
    for each in design.parameters:
        assert each.low <= wanted[each.name] <= each.high
    return line, {name: (value,) for name, value in wanted.items()}


@settings(max_examples=cases(8, 100))
@given(st.floats(0.02, 2.0), st.floats(1.0, 500.0), st.floats(0.01, 5.0))
def test_whatever_the_gains_of_the_file_can_do_the_line_can_do(first, second, third):
    """The rules of the heater are a plane; as long as no input is cut off the two are one."""
    from fuzzyarm.learning.tuning.design import Candidate, controller_at

    gains = {"G_e": first, "G_ce": second, "G_du": third}
    line, wanted = line_for(HEATER, gains)
    file = controller_at(HEATER, Candidate({name: (value,) for name, value in gains.items()}))
    straight = controller_at(line, Candidate(wanted))
    small = {
        "reference": {"temperature": Signal("step", (15.0 + 0.2 / max(first, second / 60.0),))}
    }
    runs = [simulate(each, "room", duration=600.0, **small) for each in (file, straight)]
    assert runs[1].error_matrix == pytest.approx(runs[0].error_matrix, rel=1e-6, abs=1e-9)


def moving(text, *lines):
    tuning = read_tuning(lines) if lines else None
    return [name for each in straightened(text, tuning)[1].gains for name in each.names]


def test_gains_and_levels_that_rules_alone_have_are_the_lines_too():
    direct = load(shipped("fuzzy-direct.frb"))
    slopes = ["slope of u along e", "slope of u along ce"]
    assert moving(direct) == [*slopes, "G_u"]
    assert moving(direct, "gain G_e 0.1 .. 10 times") == slopes
    # Peaks of the output say how far it goes, where no gain does; unmirrored ones its middle.
    assert moving(direct, "peaks u mirrored") == [*slopes, "limit of u"]
    assert moving(direct, "peaks e keep order") == [*slopes, "offset of u"]
    assert moving(direct, "peaks u", "gain G_u 1 .. 2") == [*slopes, "offset of u", "G_u"]
    wide = straightened(direct, read_tuning(["gain G_e 0.001 .. 2000 times"]))[1].gains[0]
    assert (wide.low, wide.high) == (0.001, 2000.0)


def test_a_gain_that_stands_elsewhere_does_more_than_a_slope(tmp_path):
    text = shipped("fuzzy-direct.frb").read_text()
    assert "count = u * converter" in text
    (tmp_path / "x.frb").write_text(text.replace("u * converter", "u * converter * G_e / 344"))
    lines = ("gain G_e, G_ce 0.1 .. 10 times",)
    slopes = ["slope of u along e", "slope of u along ce"]
    assert moving(load(tmp_path / "x.frb"), *lines) == [*slopes, "G_e"]


def test_axes_with_lines_of_their_own_have_slopes_of_their_own(tmp_path):
    whole = shipped("fuzzy-direct.frb").read_text()
    head, _, body = whole.partition("axis joint1, joint2\n")
    split = tmp_path / "x.frb"
    split.write_text(f"{head}axis joint1\n{body}\naxis joint2\n{body}")
    straight = [straightened(load(each)) for each in (split, shipped("fuzzy-direct.frb"))]
    names = [each.name for each in Design(*straight[0]).parameters]
    slopes = [
        f"slope of u along {of} on {axis}" for axis in ("joint1", "joint2") for of in ("e", "ce")
    ]
    assert sorted(names) == sorted(["G_u", *slopes])
    runs = [simulate(text, reach_return(segment=0.1, hold=0.05)) for text, _ in straight]
    np.testing.assert_array_equal(runs[0].error_matrix, runs[1].error_matrix)
