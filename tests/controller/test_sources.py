"""A source is one record: every walk knows each of them, and none takes one for another."""

from __future__ import annotations

import math
import runpy
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st
from own_source import WORD, controller, example, register, whole

import fuzzyarm
from fuzzyarm import simulate
from fuzzyarm.apps.cli import main
from fuzzyarm.apps.show.controller import definition_words
from fuzzyarm.apps.show.diagram import BLOCK_KINDS, block_diagram
from fuzzyarm.base.diagnostic import Severity
from fuzzyarm.control.controllers.on_plant import site_of
from fuzzyarm.control.controllers.reach import reaches_of
from fuzzyarm.control.controllers.text import with_files
from fuzzyarm.control.loop.analysis import AnalysisError, describing_function
from fuzzyarm.exchange.export.walk_of_steps import steps_of
from fuzzyarm.exchange.files import check_text
from fuzzyarm.language import format_text, parse
from fuzzyarm.language.edit import coloured, complete, hover, read
from fuzzyarm.language.model.controller import SignalLine, Source
from fuzzyarm.learning.tuning.linear import straightened
from fuzzyarm.plant.own import find_plant
from fuzzyarm.proof.map.controllers import prove_drives, sampled_drive
from fuzzyarm.symbolic.evaluation import evaluate
from fuzzyarm.symbolic.kernels import SWITCH, has_machine_code
from fuzzyarm.symbolic.operations import EVERYTHING, Interval
from fuzzyarm.symbolic.records import KindError
from fuzzyarm.symbolic.sources import SOURCES, OptionKind, SourceState, Surroundings, source
from fuzzyarm.table import Axis, LookupTable

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "controllers.md"
VALUES = st.lists(st.floats(-5, 5, width=32), min_size=1, max_size=40)
WIDTHS = st.floats(1e-3, 8.0)
SHARES = st.lists(
    st.tuples(st.sampled_from([0.0, 1.0]) | st.floats(0, 1), st.integers(1, 30)),
    min_size=1, max_size=5,
)  # fmt: skip
"""Targets as shares of a range, its ends among them, each with the periods towards it."""


def moved(shares, at, step):
    """Yield a signal that goes towards each target, by no more than a step in a period."""
    x = 0.0
    for share, periods in shares:
        wanted = at.low + share * (at.high - at.low)
        for _ in range(periods):
            x = min(max(x + min(max(wanted - x, -step), step), at.low), at.high)
            yield x


def made(text, sheets=None):
    """Return the controller in a text, with what its calls look up."""
    parsed = parse(text)
    assert parsed.controller is not None, parsed.diagnostics
    assert not parsed.diagnostics, parsed.diagnostics
    found, faults = with_files(parsed.controller, Path.cwd(), instead=sheets or {})
    assert faults == []
    return found


def sheets_of(word):
    """Return what the name R of an example stands for."""
    if word == "rules":
        text = "rulebase R\ninput p -5 .. 5\noutput k -1 .. 1\nterms p, k: triangles N Z P\n"
        rules = "".join(f"rule if p is {a} then k is {b}\n" for a, b in ("NP", "ZZ", "PN"))
        return {"R": (parse(text + rules).rulebase,)}
    axis = Axis("p", (-4.0, -1.0, 0.0, 2.0, 4.0))
    return {"R": (LookupTable((axis,), "k", np.array([4.0, 1.0, 0.0, -2.0, -3.0])),)}


def of(word):
    return made(whole(word), sheets_of(word))


def driven(text, values, compiled=True):
    """Return the drive for a run over errors."""
    run = text.run(compiled=compiled)
    return [run.step({"position": -value}, {"position": 0.0})["voltage"] for value in values]


def bits(values):
    return [struct.pack("d", value) for value in values]


@pytest.fixture(scope="module", autouse=True)
def _own():
    register()
    yield
    SOURCES.remove(WORD)


WORDS = [*SOURCES, WORD]
STEPS = np.random.default_rng(25).uniform(-0.6, 0.6, 200)  # as fast as the motor turns
COURSE = np.clip(np.cumsum(STEPS), -3.0, 3.0).tolist()
compiled = pytest.mark.skipif(not has_machine_code(), reason="no machine code was built")


# --- Every walk knows every source ---


@pytest.mark.parametrize("word", WORDS)
def test_the_language_reads_writes_offers_and_explains_it(word):
    text = whole(word)
    faults = [each for each in parse(text).diagnostics if each.severity is Severity.ERROR]
    assert not faults
    assert example(word).replace("y = ", "= ") in format_text(text)
    line = text.splitlines().index(f"  {example(word)}") + 1
    reading = read(text)
    offered = {
        c.label: c.detail for c in complete(read(text.replace(example(word), "y = ")), line, 7)
    }
    assert offered[word] == SOURCES[word].doc
    assert f"**{word}**" in hover(reading, line, 8).markdown
    assert SOURCES[word].doc in hover(reading, line, 8).markdown
    at = [each for each in coloured(reading) if (each.line, each.column) == (line, 7)]
    assert [each.colour for each in at] == ["type" if word in ("error", "sum") else "keyword"]
    for option in SOURCES[word].options:
        start = example(word).split(",")[0]
        cut = text.replace(example(word), f"{start}, ")
        found = {c.label for c in complete(read(cut), line, len(start) + 5)}
        assert option in found


@pytest.mark.parametrize("word", WORDS)
def test_its_definition_in_words_is_read_again(word):
    text = of(word)
    line = next(x for _, x in text.model.lines() if isinstance(x, SignalLine) and x.names == ("y",))
    again = whole(word).replace(example(word), f"y = {definition_words(line)}")
    (axes,) = made(again, sheets_of(word)).model.axes
    assert axes.lines[1] == line


@compiled
@pytest.mark.parametrize("word", WORDS)
def test_machine_code_and_plain_python_give_the_same_bits(word):
    assert bits(driven(of(word), COURSE)) == bits(driven(of(word), COURSE, compiled=False))


@compiled
@pytest.mark.parametrize("word", WORDS)
def test_a_closed_loop_gives_the_same_bits(word, monkeypatch):
    motor = find_plant("motor")
    runs = []
    for switch in ("1", "0"):
        monkeypatch.setenv(SWITCH, switch)
        runs.append(simulate(of(word), motor, duration=0.3))
    one, other = (run.outputs["shaft.position"] if "shaft.position" in run.outputs
                  else run.outputs["position"] for run in runs)  # fmt: skip
    assert bits(one) == bits(other)


@pytest.mark.parametrize("word", WORDS)
@given(shares=SHARES)
@settings(max_examples=cases(8, 20), deadline=None)
def test_it_stays_where_it_is_said_to_reach(word, shares):
    text = of(word)
    signals = reaches_of(text, site_of(find_plant("motor"))).signals
    error, reach = signals["shaft", "e"].at, signals["shaft", "y"].at
    run = text.run(compiled=False)
    for x in moved(shares, error, 0.6):  # as fast as the motor turns
        run.step({"position": -0.5 * x}, {"position": 0.5 * x})
        value = run.signal("shaft", "y")
        assert reach.low - 1e-9 <= value <= reach.high + 1e-9


# --- What a record states beside its update ---

UPDATED = [kind.name for kind in SOURCES.values() if kind.function is not None]
NEAR = Surroundings(Interval(-2.0, 3.0), 40.0, 0.01, 10, {})
EXAMPLES = {"number": 0.5, "figure": 0.5, "time": 0.05, "range": (-0.5, 1.0), "words": True}


def settings_of(kind, *, every):
    """Return values for the options that it needs, or for every one that is a value."""
    return {
        word: EXAMPLES[option.accepts]
        for word, option in kind.options.items()
        if option.needed or (every and option.accepts in EXAMPLES)
    }


def values_of(kind, options, xs, period=NEAR.period):
    """Return the values that the update and the next states of a record give."""
    kind = kind.sized(options, period)
    names = [state.name for state in kind.states]
    states = dict(zip(names, kind.starts(options), strict=True))
    loop = {"period": period, "last": 0.0, "excess": 0.0, "gain": 1.0}
    for k, x in enumerate(xs):
        known = {**kind.settings(options), **loop, **states, "x": x}
        known["last"] = float(k % NEAR.every == NEAR.every - 1)
        known["value"] = evaluate(kind.expression, known)
        states = {name: evaluate(node, known) for name, node in zip(names, kind.nexts, strict=True)}
        yield known["value"]


@pytest.mark.parametrize("every", [False, True], ids=["needed", "every"])
@pytest.mark.parametrize("word", UPDATED)
@given(shares=SHARES)
@settings(max_examples=cases(20, 60), deadline=None)
def test_it_keeps_the_range_and_the_pace_of_its_record(word, every, shares):
    kind = SOURCES[word]
    options = settings_of(kind, every=every)
    near = NEAR._replace(options=options)
    within = kind.bounds(near) if kind.bounds is not None else EVERYTHING
    pace = kind.pace(near) if kind.pace is not None else math.inf
    before = None
    for value in values_of(kind, options, moved(shares, near.at, near.pace * near.period)):
        assert within.low - 1e-12 <= value <= within.high + 1e-12
        assert before is None or abs(value - before) <= pace * near.period + 1e-12
        before = value


@pytest.mark.parametrize("word", [word for word in UPDATED if SOURCES[word].linear])
@given(shares=SHARES)
@settings(max_examples=cases(20, 60), deadline=None)
def test_a_linear_one_doubles_with_its_operand(word, shares):
    kind, xs = SOURCES[word], list(moved(shares, NEAR.at, 0.4))
    options = settings_of(kind, every=False)
    twice = values_of(kind, options, [2.0 * x for x in xs])
    assert list(twice) == [2.0 * value for value in values_of(kind, options, xs)]


EIGHTHS = [0.125 * round(8.0 * x) for x in COURSE]  # exact, also with a constant added


@pytest.mark.parametrize("word", UPDATED)
def test_its_unit_has_the_seconds_of_its_record(word):
    kind = SOURCES[word]
    options = settings_of(kind, every=False)
    quarters = {k: 4.0 * v if kind.options[k].accepts == "time" else v for k, v in options.items()}
    found = list(values_of(kind, quarters, EIGHTHS, 4.0 * NEAR.period))  # quarters of a second
    assert found == [4.0**kind.seconds * value for value in values_of(kind, options, EIGHTHS)]
    assert any(found)


@pytest.mark.parametrize("word", [w for w in UPDATED if SOURCES[w].bounded_by == "signal"])
@given(xs=VALUES)
@settings(max_examples=cases(20, 60), deadline=None)
def test_one_that_its_signal_bounds_stays_between_it_and_0(word, xs):
    kind = SOURCES[word]
    values = list(values_of(kind, settings_of(kind, every=False), xs))
    assert min(0.0, *xs) - 1e-12 <= min(values) <= max(values) <= max(0.0, *xs) + 1e-12


@pytest.mark.parametrize("word", [word for word in UPDATED if SOURCES[word].of == "signal"])
def test_a_difference_alone_stays_where_its_operand_is_shifted(word):
    kind = SOURCES[word]
    options = settings_of(kind, every=False)
    shifted = values_of(kind, options, [x + 8.0 for x in EIGHTHS])
    assert (list(shifted) == list(values_of(kind, options, EIGHTHS))) == kind.difference


@pytest.mark.parametrize("word", WORDS)
def test_a_proof_holds_what_it_drives(word):
    text, kind = of(word), SOURCES[word]
    (drive,) = prove_drives(text, find_plant("motor"), budget=5.0)
    assert drive.low <= min(driven(text, COURSE)) <= max(driven(text, COURSE)) <= drive.high
    names = [gain.source for gain in drive.gains]
    if kind.states:
        assert any(name.startswith(f"{word}{kind.joined}") for name in names)
    for sector in drive.sectors:
        if sector.slack == 0.0 and all(map(math.isfinite, sum(sector.within.values(), ()))):
            sigma, values = sampled_drive(text, drive, sector, find_plant("motor"), points=400)
            low, high = (sigma * sector.low, sigma * sector.high)
            room = 1e-6 * (1.0 + np.abs(values))
            assert np.all(values >= np.minimum(low, high) - room)
            assert np.all(values <= np.maximum(low, high) + room)


@pytest.mark.parametrize("word", WORDS)
def test_a_describing_function_is_had_of_what_remembers_nothing(word):
    if SOURCES[word].states or word == "driven":
        with pytest.raises(AnalysisError, match=f"it has '{word}"):
            describing_function(of(word), 1.0)
    else:
        assert np.isfinite(describing_function(of(word), 1.0)).all()


@pytest.mark.parametrize("word", WORDS)
def test_it_is_a_block_of_the_diagram(word):
    blocks = [block.kind for block in block_diagram(of(word)).blocks]
    kind = SOURCES[word]
    assert (word in blocks) == (kind.function is not None or kind.of == "call")
    assert word == WORD or all(block in BLOCK_KINDS for block in blocks)


@pytest.mark.parametrize("word", [word for word in WORDS if word != WORD])
def test_the_page_of_controllers_has_it(word):
    assert any(f"`{word}{SOURCES[word].joined} " in line for line in PAGE.read_text().splitlines())


def with_source(kind):
    """Return a controller whose second line has a source of another kind, that nothing read."""
    text = of("lag")
    (axes,) = text.model.axes
    line = replace(axes.lines[1], source=Source(kind, "e"))
    axes = replace(axes, lines=(axes.lines[0], line, *axes.lines[2:]))
    return replace(text, model=replace(text.model, axes=(axes,)))


@pytest.mark.parametrize(
    "walk",
    [
        lambda text: text.run(compiled=False),
        lambda text: reaches_of(text, None),
        prove_drives,
        block_diagram,
        lambda text: describing_function(text, 1.0),
        steps_of,
        lambda text: [definition_words(x) for _, x in text.model.lines()],
    ],
)
def test_what_is_no_source_is_an_error_by_name(walk):
    with pytest.raises(KindError, match="no source of signals is called 'median'"):
        walk(with_source("median"))


# --- A record that nothing else knows ---


def test_a_source_of_its_own_is_simulated_checked_and_written(tmp_path, capsys):
    path = tmp_path / "own.frb"
    path.write_text(whole(WORD).replace("share 0.5", "share 0.25, from 0.5"))
    assert main(["check", str(path)]) == 0
    assert main(["fmt", str(path)]) == 0
    assert main(["simulate", str(path), "--plant", "motor", "--for", "0.2s", "--json"]) == 0
    assert main(["show", str(path)]) == 0
    assert main(["prove", str(path), "--sector", "--plant", "motor"]) == 0
    said = capsys.readouterr()
    assert "half-mean of e, share 0.25, from 0.5" in said.out
    before, older, expected = math.nan, 0.5, []
    for x in COURSE:
        past = (before + older) / (2.0 + 0.01 * before * before)
        before = x if math.isnan(before) else 0.25 * x + 0.75 * past
        older = x
        expected.append(min(max(before + 0.001 * x, -24.0), 24.0))
    text = fuzzyarm.load(path)
    assert driven(text, COURSE, compiled=False) == expected
    if has_machine_code():
        assert driven(text, COURSE) == expected


def test_it_goes_on_from_a_state_that_was_kept():
    run, again = (of(WORD).run(compiled=False) for _ in range(2))
    for value in COURSE[:5]:
        run.step({"position": value}, {"position": 0.0})
    again.state = run.state
    # Periods, what it remembers, the excess of the limit, the drive, the skipped periods.
    assert len(run.state) == 1 + 2 + 1 + 1 + 1
    step = {"position": 1.0}, {"position": 0.0}
    assert run.step(*step) == again.step(*step)


@pytest.mark.parametrize(
    ("facts", "message"),
    [
        ({"update": lambda x, width: x - width}, "nothing gives the update .* 'width'"),
        ({"update": lambda x: x, "states": (SourceState("s", lambda z: z),)}, "its argument 'z'"),
        ({"update": None, "of": "call"}, "called with inputs"),
        ({"update": lambda x: x, "of": "port"}, "does not name its values"),
    ],
)
def test_a_record_that_cannot_work_is_refused(facts, message):
    with pytest.raises(KindError, match=message):
        source("wrong", **facts)
    assert "wrong" not in SOURCES


def test_a_built_in_source_stays_what_it_is():
    with pytest.raises(KindError, match="'lag' is a built-in source"):
        source("lag", lambda x: x)


def test_a_division_by_zero_has_no_value_and_does_not_end_a_run():
    options = {"by": OptionKind("number", "what divides")}
    source("quotient", lambda x, by: x / by, options=options)
    try:
        text = made(controller("y = quotient of e, by 0", "drive voltage = y"))
        for how in {False, has_machine_code()}:
            assert driven(text, [1.0, -2.0], how) == [math.inf, -math.inf]
            # No value: the period is skipped, and the drive has no last value yet.
            assert driven(text, [0.0, 1.0, 0.0], how) == [0.0, math.inf, math.inf]
    finally:
        SOURCES.remove("quotient")


# --- What the dead band and the hysteresis do ---


def response(word, width, values, how=False):
    lines = (f"y = {word} of e, width {width!r}", "drive voltage = y")
    return driven(made(controller(*lines)), values, how)


@given(VALUES, WIDTHS)
@settings(max_examples=cases(20, 60), deadline=None)
def test_a_dead_band_is_what_leaves_the_zone(values, width):
    found = response("deadband", width, values)
    half = 0.5 * width
    for x, y in zip(values, found, strict=True):
        assert y == (0.0 if abs(x) <= half else math.copysign(abs(x) - half, x))
        assert abs(y) <= abs(x)
    if has_machine_code():
        assert bits(found) == bits(response("deadband", width, values, how=True))


@given(VALUES, WIDTHS)
@settings(max_examples=cases(20, 60), deadline=None)
def test_a_play_follows_only_what_leaves_its_band(values, width):
    found = response("hysteresis", width, values)
    half, before = 0.5 * width, 0.0
    for x, y in zip(values, found, strict=True):
        if x - half <= before <= x + half:
            assert y == before  # inside the band nothing moves
        else:
            assert y == (x - half if x > before else x + half)
        before = y
    assert max(map(abs, found)) <= max(0.0, max(map(abs, values)) - half)
    if has_machine_code():
        assert bits(found) == bits(response("hysteresis", width, values, how=True))


def test_a_play_goes_round_a_loop():
    assert response("hysteresis", 2.0, [0.5, 3.0, 2.5, 1.0, 0.5, -3.0, -1.5, 3.0]) == [
        0.0, 2.0, 2.0, 2.0, 1.5, -2.0, -2.0, 2.0,
    ]  # fmt: skip


def test_the_width_may_be_a_gain_that_moves():
    lines = ("y = deadband of e, width w", "drive voltage = y")
    text = made(controller(*lines, head=['gain w = 1 "rad", tune 0.1 .. 4']))
    step = {"position": -3.0}, {"position": 0.0}
    assert text.run(compiled=False).step(*step)["voltage"] == 2.5
    assert text.run(compiled=False, gains={"w": 4.0}).step(*step)["voltage"] == 1.0


@pytest.mark.parametrize("ratio", [1.5, 2.0, 7.0])
def test_the_describing_function_of_a_dead_band_is_the_known_one(ratio):
    """Slotine and Li, *Applied Nonlinear Control*, 1991, equation 5.16."""
    text = made(controller("y = deadband of e, width 2", "drive voltage = y"))
    share = 1.0 / ratio
    known = 1.0 - 2.0 / math.pi * (math.asin(share) + share * math.sqrt(1.0 - share**2))
    assert describing_function(text, ratio) == pytest.approx(known, rel=1e-4)


def test_the_gain_of_a_dead_band_is_zero_and_is_said_to_be():
    lines = ("y = deadband of e, width 0.2", "drive voltage = y * 3, within -24 .. 24")
    (drive,) = prove_drives(made(controller(*lines)), find_plant("motor"))
    assert drive.gains == ()
    assert "gains: deadband of e has the slope 0 around 0" in drive.open
    (sector,) = drive.sectors
    (reached,) = {abs(end) for end in sector.within["error of position"]}
    exact = 3.0 * (1.0 - 0.1 / reached)
    assert sector.low == 0.0
    assert exact <= sector.high <= 1.005 * exact


def test_a_hysteresis_is_not_scaled_by_what_stands_before_it():
    lines = ("s = e * 5", "y = {} of s, {}", "drive voltage = y * 2, within -24 .. 24")
    for word, option, name, gain in (
        ("lag", "time 1 s", "lag of error of position", 10.0),
        ("hysteresis", "width 1", "hysteresis of s", 2.0),
    ):
        text = controller(*(line.format(word, option) for line in lines))
        (drive,) = prove_drives(made(text), find_plant("motor"))
        assert [(each.source, each.low, each.high) for each in drive.gains] == [(name, gain, gain)]


def test_two_lags_of_one_signal_are_two_sources_of_a_proof():
    lines = ("a = lag of e, time 1 s", "b = lag of e, time 2 s", "drive voltage = a - b")
    text = made(controller(*lines))
    (drive,) = prove_drives(text, find_plant("motor"))
    assert {gain.source: gain.low for gain in drive.gains} == {
        "lag of error of position, time 1 s": 1.0,
        "lag of error of position, time 2 s": -1.0,
    }
    assert max(map(abs, driven(text, COURSE))) <= drive.high


def test_the_linear_opponent_keeps_the_dead_band():
    lines = (
        "y = deadband of e, width 0.2", "c = error of velocity", "u = rules pd7(y, c)",
        "drive voltage = u, within -24 .. 24",
    )  # fmt: skip
    text = made(controller(*lines, head=['use pd7 from "pd7.frb"']))
    opponent, _ = straightened(text)
    kinds = [
        x.source.kind for _, x in opponent.model.lines() if isinstance(x, SignalLine) and x.source
    ]
    assert "deadband" in kinds


# --- What the relay and the delay do ---


@given(VALUES, WIDTHS)
@settings(max_examples=cases(20, 60), deadline=None)
def test_a_relay_switches_at_the_edges_of_its_band(values, width):
    lines = (f"y = relay of e, width {width!r}, levels -3 .. 7", "drive voltage = y")
    found = driven(made(controller(*lines)), values, compiled=False)
    level = -3.0
    for x, y in zip(values, found, strict=True):
        if abs(x) > 0.5 * width:
            level = 7.0 if x > 0.0 else -3.0
        assert y == level
    if has_machine_code():
        assert bits(found) == bits(driven(made(controller(*lines)), values))


@pytest.mark.parametrize("periods", [1, 3, 40])
def test_a_delayed_signal_is_that_of_some_periods_ago(periods):
    lines = (f"y = delayed of e, time {10 * periods} ms", "drive voltage = y")
    text = made(controller(*lines))
    expected = [*[COURSE[0]] * periods, *COURSE][: len(COURSE)]
    for how in {False, has_machine_code()}:
        assert driven(text, COURSE, how) == expected
    (cells,) = {len(text.run(compiled=how).state) for how in {False, has_machine_code()}}
    assert cells == 1 + periods + 1 + 1  # periods, memory, the drive, the skipped periods


def test_a_period_without_a_number_leaves_a_delay_and_a_relay_as_they_were():
    lines = (
        "d = delayed of e, time 20 ms",
        "r = relay of e, width 2, levels 0 .. 1",
        "drive voltage = d + 100 * r",
    )
    text = made(controller(*lines))
    course = [1.5, 2.0, math.nan, 0.5, -0.5, 0.0]
    whole = driven(text, [x for x in course if not math.isnan(x)], compiled=False)
    for how in {False, has_machine_code()}:
        found = driven(text, course, how)
        assert found == [*whole[:2], whole[1], *whole[2:]]
        assert found == [101.5, 101.5, 101.5, 101.5, 102.0, 100.5]


@pytest.mark.slow
def test_a_loop_with_a_delayed_signal_is_proved_stable_until_it_is_too_late():
    claims = []
    for time in (10, 20, 500):
        lines = (
            f"d = delayed of e, time {time} ms",
            "drive voltage = 12 * d",
        )
        text = made(controller(*lines))
        claims.append(fuzzyarm.prove(text, "stable", plant="motor").verdict)
    assert claims == ["proved", "proved", "refuted"]


def test_a_delay_and_a_relay_are_exported_without_another_line_for_them(tmp_path, capsys):
    lines = (
        "d = delayed of e, time 40 ms",
        "r = relay of d, width 0.5, levels -1 .. 1",
        "drive voltage = r + d",
    )
    text = controller(*lines)
    (tmp_path / "late.frb").write_text(text)
    assert main(["compile", str(tmp_path / "late.frb"), "-o", str(tmp_path / "late.py")]) == 0
    assert "worst difference to the controller in double precision: 0 (" in capsys.readouterr().out
    exported = runpy.run_path(str(tmp_path / "late.py"))["Controller"]()
    course = [*COURSE[:9], math.nan, *COURSE[9:]]
    found = [exported.step(reference_position=0.0, measured_position=-x) for x in course]
    assert bits(found) == bits(driven(made(text), course, compiled=False))


# --- What is said of mistakes ---


@pytest.mark.parametrize(
    ("line", "name", "message", "hint"),
    [
        ("y = deadband of e", "incomplete-statement", "the width of deadband is missing", "width"),
        ("y = hysteresis of e", "incomplete-statement", "the width of hysteresis is", "width 0.5"),
        ("y = lag of e", "incomplete-statement", "the time of lag is missing", "time 10 ms"),
        ("y = deadband of e, width", "incomplete-statement", "expected the width, or a gain", ""),
        ("y = deadband of e, width -2", "bad-number", "must be above 0, not -2", ""),
        ("y = deadband of e, width 0", "bad-number", "must be above 0, not 0", ""),
        ("y = hysteresis of e, width n", "bad-number", "must be above 0, not -1", ""),
        ("y = deadband of e, width 2 deg", "trailing-text", "found 'deg' after", '= 2 "deg"'),
        ("y = deadband of e, width 2 ms", "trailing-text", "in the unit of its", "gain NAME"),
        ("y = deadband of e, wdth 2", "unknown-option", "one of width, found 'wdth'", "'width'"),
        ("y = deadzone of e, width 2", "unknown-source", "found 'deadzone'", "'deadband'"),
        ("y = backlash of e, width 2", "unknown-source", "WORD of NAME", "hysteresis of e, width"),
        ("y = deadband of e, width 2, width 3", "duplicate-setting", "'width' is set twice", ""),
        ("y = integral of e, start n", "unexpected-token", "a number after start, found 'n'", ""),
        ("y = relay of e, width 2", "incomplete-statement", "the levels of relay is missing", ""),
        ("y = delayed of e, time 25 ms", "bad-number", "is 2.5 control periods", "0.03 s"),
        ("y = delayed of e, time 1 h", "bad-number", "is 360,000 control periods", "at most 250"),
        ("y = deadband of f, width 2", "unknown-signal", "called 'f'", ""),
    ],
)  # fmt: skip
def test_mistakes_are_said_by_name(line, name, message, hint):
    text = controller(line, "drive voltage = e * n, within -24 .. 24", head=["gain n = -1"])
    found = [each for each in parse(text).diagnostics if each.name == name]
    assert [each for each in found if message in each.message and hint in each.hint], found


@pytest.mark.parametrize(
    ("unit", "message"),
    [("deg", "the width of deadband is in deg, its signal in rad"),
     ("V", "is in V, its signal"), ("rad", ""), ("turns per rad", "")],
)  # fmt: skip
def test_a_width_in_another_unit_is_found(unit, message):
    lines = ("y = deadband of e, width w", "drive voltage = y, within -24 .. 24")
    text = controller(*lines, head=[f'gain w = 2 "{unit}"'])
    found = [each.message for each in check_text(text, Path("c.frb")).diagnostics]
    assert [message in each for each in found] == ([True] if message else []), found
