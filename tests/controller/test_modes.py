"""Choices by conditions, and integrals that follow: beside a simulation in plain Python."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st
from own_source import made

from fuzzyarm import load_controller
from fuzzyarm.control.controllers.floats import ReferenceRun
from fuzzyarm.control.controllers.on_plant import site_of
from fuzzyarm.control.controllers.own import find_controller
from fuzzyarm.control.controllers.period import PortValue
from fuzzyarm.control.controllers.reach import reaches_of
from fuzzyarm.control.loop.run import ClosedLoop, plant_motion
from fuzzyarm.language import format_text, parse
from fuzzyarm.language.signals import condition_text
from fuzzyarm.plant.own import find_plant
from fuzzyarm.proof.claim.text import read_claim
from fuzzyarm.proof.loop import prove_loop
from fuzzyarm.symbolic.sources import Condition

EXAMPLES = Path(__file__).parents[2] / "examples" / "controllers"
HEAD = 'controller station\nperiod 1 s\ngain K = 8 "%/K"\ngain limit = 3 "K"\naxis room\n'
LINES = """  auto = measured auto
  hand = measured hand
  e    = error of temperature
  p    = e * K
  ei   = e * 0.02
  back = hand - p
  i    = integral of ei, within -100 .. 100, follows back where auto < 0.5
  law  = p + i
  u    = law where auto >= 0.5 else hand
  j    = integral of e, follows law where (e >= limit or e <= -3) and not (auto < 0.5 or hand > 60)
  v    = u where auto < 0.5 and e > 0 or hand > 50 else 7
  drive power = u, within 0 .. 100
  drive other = j + v
"""


def by_hand(rows):
    """Return both drives of `LINES`, line by line."""
    i = j = 0.0
    for temperature, wanted, auto, hand in rows:
        e = wanted - temperature
        p = e * 8.0
        i = hand - p if auto < 0.5 else i + e * 0.02
        i = min(max(i, -100.0), 100.0)
        law = p + i
        u = law if auto >= 0.5 else hand
        far = e >= 3.0 or e <= -3.0
        j = law if far and not (auto < 0.5 or hand > 60.0) else j + e
        v = u if (auto < 0.5 and e > 0.0) or hand > 50.0 else 7.0
        yield min(max(u, 0.0), 100.0), j + v


def rows_of(seed, count=300):
    random = np.random.default_rng(seed)
    return [
        (
            20 + 3 * random.standard_normal(),
            22.0,
            float(random.random() > 0.5),
            100 * random.random(),
        )
        for _ in range(count)
    ]


@pytest.mark.parametrize("compiled", [True, False])
def test_a_run_has_the_bits_of_plain_python(compiled):
    run, rows = made(HEAD + LINES).run(compiled=compiled), rows_of(1)
    for (temperature, wanted, auto, hand), expected in zip(rows, by_hand(rows), strict=True):
        measured = {"temperature": temperature, "auto": auto, "hand": hand}
        drives = run.step(measured, {"temperature": wanted})
        assert (drives["power"], drives["other"]) == expected


@pytest.mark.slow
def test_the_walk_has_them_too():
    run, rows = ReferenceRun(made(HEAD + LINES)), rows_of(2)
    for (temperature, wanted, auto, hand), expected in zip(rows, by_hand(rows), strict=True):
        given_ = {"temperature": temperature, "auto": auto, "hand": hand}
        values = {PortValue("measured", "room", name): x for name, x in given_.items()}
        drives = run.step(values | {PortValue("reference", "room", "temperature"): wanted})
        assert (drives["room", "power"], drives["room", "other"]) == expected


def test_a_period_whose_condition_is_not_a_number_is_skipped():
    run = made(HEAD + LINES).run()
    good = {"temperature": 20.0, "auto": 1.0, "hand": 40.0}
    first = run.step(good, {"temperature": 22.0})
    assert run.step(good | {"auto": math.nan}, {"temperature": 22.0}) == first
    assert run.skipped == {"room": 1}
    i = 0.04 + 0.04
    assert run.step(good, {"temperature": 22.0})["power"] == pytest.approx(16.0 + i)


def test_the_heater_changes_its_mode_without_a_bump_either_way():
    text = load_controller(EXAMPLES / "manual-heater.frb")
    runs = {auto: text.run(gains={"auto": auto, "raise": 0.05}) for auto in (0.0, 1.0)}
    u, before, power = 0.0, math.nan, []
    for k in range(300):
        temperature, wanted = 18.0 + 0.01 * k, 22.0 if k < 200 else 5.0
        auto = 1.0 if 40 <= k < 120 or k >= 180 else 0.0
        e = wanted - temperature
        slope = 0.0 if math.isnan(before) else (e * 8.0 - before) / 10.0
        before = e * 8.0
        u = min(max(u + 10.0 * (e * 0.02 + slope if auto else 0.05), 0.0), 100.0)
        run = runs[auto]
        run.state = runs[1.0 - auto].state if k in (40, 120, 180) else run.state
        found = run.step({"temperature": temperature}, {"temperature": wanted})["power"]
        assert found == pytest.approx(u, abs=1e-12)
        power.append(found)
    changes = [abs(power[k] - power[k - 1]) for k in (40, 120, 180)]
    assert max(changes) < 1.0
    assert min(power[201:]) == 0.0  # and back from the limit it goes on at once


def room_by_hand(turns):
    """Return temperature and power of the heater in a room, without fuzzyarm.

    `turns` are mode, rate by hand and number of periods, one after the other.
    """
    air = wall = 15.0
    u, before, found = 0.0, None, []
    for auto, hand, count in turns:
        for _ in range(count):
            e = 21.0 - air
            slope = 0.0 if before is None else (e * 8.0 - before) / 10.0
            before = e * 8.0
            u = min(max(u + (e * 0.02 + slope if auto else hand) * 10.0, 0.0), 100.0)
            found.append((air, u))
            air, wall = rk4(lambda x, u=u: heat(*x, u), (air, wall), 10.0)
    return np.array(found)


def heat(air, wall, power):
    to_wall = (air - wall) / 0.008
    lost = (air - 5.0) / 0.05
    return (0.01 * 2000.0 * power - to_wall - lost) / 2.5e5, (to_wall - (wall - 5.0) / 0.02) / 4e6


def rk4(rate, x, h):
    """Return the state after one step."""

    def beyond(slope, step):
        return tuple(a + step * b for a, b in zip(x, slope, strict=True))

    a = rate(x)
    b = rate(beyond(a, 0.5 * h))
    c = rate(beyond(b, 0.5 * h))
    d = rate(beyond(c, h))
    whole = zip(x, a, b, c, d, strict=True)
    return tuple(y + h / 6.0 * (p + 2.0 * q + 2.0 * r + s) for y, p, q, r, s in whole)


def test_in_a_room_it_is_that_of_an_independent_simulation_through_its_modes():
    text, room = find_controller(str(EXAMPLES / "manual-heater.frb")), find_plant("room")
    motion = plant_motion(text, room, {"temperature": "step:21"}, 7200.0)
    loop = ClosedLoop(text, motion)
    turns = [(1, 0.0, 200), (0, 0.05, 120), (0, -0.5, 60), (1, 0.0, 340)]
    run, done = loop.open(), 0
    for auto, hand, count in turns:
        run.take_over(text.with_gains({"auto": [auto], "raise": [hand]}))
        done += count
        run.advance(done)
    answer, found = loop.answer(run), room_by_hand(turns)
    assert np.abs(answer.outputs["temperature"] - found[:, 0]).max() < 1e-12
    assert np.abs(answer.drives["power"] - found[:, 1]).max() < 1e-12
    assert found[379, 1] == 0.0  # the hand went to the limit


LEAVES = st.one_of(
    st.sampled_from(["e", "K", "limit"]), st.floats(-9, 9).map(lambda x: round(x, 2))
)
COMPARISONS = st.builds(
    lambda sign, a, b: Condition(sign, (a, b)),
    st.sampled_from(["<", "<=", ">", ">="]),
    LEAVES,
    LEAVES,
)
TREES = st.recursive(
    COMPARISONS,
    lambda inner: st.one_of(
        inner.map(lambda a: Condition("not", (a,))),
        st.builds(
            lambda w, a, b: Condition(w, (a, b)), st.sampled_from(["and", "or"]), inner, inner
        ),
    ),
    max_leaves=6,
)


def holds(tree, values):
    parts = [holds(p, values) if isinstance(p, Condition) else values.get(p, p) for p in tree.parts]
    return {
        "<": lambda a, b: a < b, "<=": lambda a, b: a <= b, ">": lambda a, b: a > b,
        ">=": lambda a, b: a >= b, "and": lambda a, b: a and b, "or": lambda a, b: a or b,
        "not": lambda a: not a,
    }[tree.word](*parts)  # fmt: skip


@settings(max_examples=cases(25, 200), deadline=None)
@given(TREES, st.floats(-9, 9).map(lambda x: round(x, 2)))
def test_a_condition_means_what_it_says(tree, error):
    text = (
        f"{HEAD}  e = error of temperature\n  y = e where {condition_text(tree)} else 99\n"
        "  drive power = y + 0 * K + 0 * limit\n"
    )
    source = made(text).model.axes[0].lines[1].source
    assert dict(source.options)["otherwise"].condition == tree
    assert format_text(format_text(text)) == format_text(text)
    drives = made(text).run().step({"temperature": 0.0}, {"temperature": error})
    assert drives["power"] == (error if holds(tree, {"e": error, "K": 8.0, "limit": 3.0}) else 99.0)


@pytest.mark.parametrize(
    ("line", "name", "words"),
    [
        ("u = p + hand where auto < 1 else hand", "unexpected-token", "chosen by 'where'"),
        ("u = 3 where auto < 1 else hand", "unexpected-token", "chosen by 'where'"),
        ("u = p where auto < 1", "incomplete-statement", "'else' after the condition"),
        ("u = p where auto else hand", "unexpected-token", "<, <=, >, >= after 'auto'"),
        ("u = p where auto = 1 else hand", "unexpected-token", "<, <=, >, >= after 'auto'"),
        ("u = p where (auto < 1 else hand", "unexpected-token", "')' after the condition"),
        ("u = p where auto < 1 else hand * 2", "trailing-text", ""),
        ("u = p where autp < 1 else hand", "unknown-signal", "autp"),
        ("u = p where auto < 1 else hnad", "unknown-signal", "hnad"),
        ("u = integral of p, follows hand", "incomplete-statement", "'where' after 'hand'"),
        ("u = integral of p, follows u where auto < 1", "signal-before-made", ""),
    ],
)
def test_what_is_wrong_is_said(line, name, words):
    text = (
        f"{HEAD}  auto = measured auto\n  hand = measured hand\n  p = hand * K\n  {line}\n"
        "  drive power = u + limit * 0 + auto * 0 + p * 0\n"
    )
    found = parse(text).diagnostics
    assert [each.name for each in found if each.severity == "error"] == [name]
    assert words in found[0].message


def test_a_choice_has_the_range_and_the_unit_of_both():
    text = made(
        f"{HEAD}  e = error of temperature\n  w = e * K\n  hand = limit\n"
        "  c = w where e > limit else 200\n  drive power = c + hand * 0\n"
    )
    reach = reaches_of(text, site_of(find_plant("room"))).signals["room", "c"]
    assert (reach.at.low, reach.at.high) == (-640.0, 640.0)
    assert reach.unit == {"%": 1}


@pytest.mark.slow
def test_a_proof_goes_on_where_bounds_decide_and_is_refused_where_they_do_not():
    text = load_controller(EXAMPLES / "manual-heater.frb")
    claim = read_claim("stable on room at temperature = 21", "room")
    assert prove_loop(text, claim).verdict == "proved"
    near = (EXAMPLES / "manual-heater.frb").read_text().replace("auto >= 0.5", "e < auto")
    verdict = prove_loop(made(near), claim)
    assert verdict.verdict == "proved"
    # The condition stays as it is at rest: e = 21 - temperature below 1.
    assert verdict.region["temperature"][0] == pytest.approx(20.0, abs=1e-3)
    far = (EXAMPLES / "manual-heater.frb").read_text().replace("auto >= 0.5", "e >= auto")
    assert prove_loop(made(far), claim).verdict == "undecided"
