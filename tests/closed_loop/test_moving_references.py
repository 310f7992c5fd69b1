"""References that move: their enclosures, what is proved of loops along them, and attacks on it.

Judges are closed forms in rationals and balls of Arb, and runs of `simulate`.
"""

import json
import math
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from budget import cases
from flint import arb, ctx
from hypothesis import given, settings
from hypothesis import strategies as st

import fuzzyarm
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.numbers import decimal
from fuzzyarm.control.controllers.findings import doubts_of
from fuzzyarm.control.loop import Options, Sensor, simulate
from fuzzyarm.control.loop.reference import Signal
from fuzzyarm.language import format_text
from fuzzyarm.plant.own import find_plant, starting_at
from fuzzyarm.proof.check import check_certificate
from fuzzyarm.proof.check import references as of_checker
from fuzzyarm.proof.check.certificate import sealed
from fuzzyarm.proof.check.numbers import ends, precisely
from fuzzyarm.proof.claim.problem import LoopProblem, MovedReference
from fuzzyarm.proof.claim.text import claim_text, problem_of
from fuzzyarm.proof.loop import certify_tube, moving, prove_loop, read_claim, write_certificate
from fuzzyarm.proof.loop.timed import loop_tube

PLANT = """import math
from fuzzyarm.plant import Plant, Port
class Cart(Plant):
    name = "cart"
    inputs = {"u": Port("m/s2", -40.0, 40.0)}
    outputs = {"y": Port("m", -2.0, 2.0), "v": Port("m/s", -9.0, 9.0, rate_of="y")}
    states = {"y": "m", "v": "m/s"}
    longest_step = 0.001
    def derivative(self, t, x, u, p):
        return [x[1], u[0] - 2.0 * x[1]CURVE]
"""
RULES = """rulebase r
input i -1 .. 1
term i N: triangle -1.5 -1 -0.5
term i n: triangle -1 -0.5 0
term i Z: triangle -0.5 0 0.5
term i p: triangle 0 0.5 1
term i P: triangle 0.5 1 1.5
output k -1 .. 1
term k N: singleton -1
term k n: singleton -0.4
term k Z: singleton 0
term k p: singleton 0.4
term k P: singleton 1
inference k: defuzzifier weighted-average
rule if i is N then k is N
rule if i is n then k is n
rule if i is Z then k is Z
rule if i is p then k is p
rule if i is P then k is P
"""
LAWS = {
    "linear": "  u = e * 60 + d * 8\n",
    "fuzzy": "  s = e * 2 + d * 0.3\n  k = rules r(s)\n  u = k * 40\n",
    "feed forward": "  w = reference v\n  u = e * 60 + d * 8 + w * 2\n",
    "held": "  u = e * 60 + d * 8\n",
}


@pytest.fixture
def loop(tmp_path):
    """Return a loop of a kind: a controller, and the name of its plant."""

    def made(kind="linear", curve=""):
        (tmp_path / "r.frb").write_text(RULES)
        path = tmp_path / "c.frb"
        uses = 'use r from "r.frb"\n' * (kind == "fuzzy")
        held = "set-point every 4\n" * (kind == "held")
        path.write_text(
            f"controller c\n{uses}period 10 ms\n{held}axis a\n  e = error of y\n  d = error of v\n"
            f"{LAWS[kind]}  drive u = u\n"
        )
        (tmp_path / "cart.py").write_text(PLANT.replace("CURVE", curve))
        return fuzzyarm.load_controller(str(path)), str(tmp_path / "cart.py")

    return made


# ── enclosures of a reference ────────────────────────────────────────────────────────

number = st.integers(-2000, 2000).map(lambda k: k / 1000)
time = st.integers(1, 900).map(lambda k: k / 1000)


@st.composite
def followed(draw):
    """Return a reference that moves, its kind and its numbers."""
    kind = draw(st.sampled_from(["step", "ramp", "sine", "quintic"]))
    if kind == "sine":
        return kind, (draw(number), abs(draw(number)), draw(number))
    if kind == "quintic":
        moves = draw(st.lists(st.tuples(number, time), max_size=3))
        return kind, (draw(number), draw(time), draw(number), *(x for pair in moves for x in pair))
    return kind, (draw(number), draw(time), draw(number))


def exactly(kind, numbers, t, order):
    """Return a reference at a rational time, by itself: a rational, or a ball of a sine."""
    if kind == "sine":
        amplitude, hertz, middle = (arb(x) for x in numbers)
        w = arb(2.0 * math.pi) * hertz
        phase = w * arb(t.numerator) / arb(t.denominator)
        value = amplitude * phase.sin()
        return (middle + value, amplitude * w * phase.cos(), -w * w * value)[order]
    to, seconds, start, *more = numbers
    since = t - decimal(seconds)
    if kind == "step":
        return (Fraction(to if since >= 0 else start), 0, 0)[order]
    if kind == "ramp":
        rate = Fraction(to)
        return (Fraction(start) + max(since, 0) * rate, rate * (since >= 0), 0)[order]
    last, begin = Fraction(start), Fraction(0)
    found = [last, Fraction(0), Fraction(0)]
    for end, lasts in zip((to, *more[::2]), map(decimal, (seconds, *more[1::2])), strict=True):
        s = min(max((t - begin) / lasts, Fraction(0)), Fraction(1))
        way = Fraction(end) - last
        found[0] += way * (6 * s**5 - 15 * s**4 + 10 * s**3)
        found[1] += way / lasts * (30 * s**4 - 60 * s**3 + 30 * s**2)
        found[2] += way / lasts**2 * (120 * s**3 - 180 * s**2 + 60 * s)
        begin, last = begin + lasts, Fraction(end)
    return found[order]


class Sampled:
    """What the enclosures of a reference read of a loop."""

    def __init__(self, kind, numbers, order, period, every=1):
        self.period, self.every = period, every
        self.moved = {("a", "y"): MovedReference(Signal(kind, numbers), order)}
        self.text = SimpleNamespace(model=SimpleNamespace(every=every))

    time_of = LoopProblem.time_of
    held_since = LoopProblem.held_since
    simulated = LoopProblem.simulated


@precisely
def both(problem, k):
    """Return a reference at a sample and until the next one, of the search and of the checker."""
    address = ("a", "y")
    search = moving.sampled_references(problem, k)[address]
    checker = of_checker.sampled_references(problem, k)[address]
    times = problem.time_of(k), problem.time_of(k + 1)
    between = moving.reference_between(problem, address, *times)
    later = of_checker.reference_between(problem, address, k)
    pairs = [(Fraction(float(x.low)), Fraction(float(x.high))) for x in (search, between)]
    return pairs[0], ends(checker), pairs[1], ends(later)


@settings(max_examples=cases(60, 3000), deadline=None)
@given(
    followed(),
    st.integers(0, 1000),
    st.sampled_from([0.001, 0.009, 0.01, 0.03]),
    st.sampled_from([0, 1, 2]),
    st.sampled_from([1, 5]),
)
def test_a_reference_is_enclosed_at_samples_and_between_them(signal, k, period, order, every):
    kind, numbers = signal
    problem = Sampled(kind, numbers, order, period, every)
    sampled, checked, between, later = both(problem, k)
    held = k - k % every
    with ctx.workprec(200):
        value = exactly(kind, numbers, held * decimal(period), order)
        simulated = Signal(kind, numbers).at(np.array([held // every]) * (period * every))
        for low, high in (sampled, checked):
            assert _between(low, value, high)
            assert low <= Fraction(float(simulated[order][0])) <= high
            size = 1 + max(map(abs, numbers)) * (1 + 1000 * (order > 0)) ** 2
            assert high - low <= 1e-11 * size  # a few roundings wide
        h = decimal(period)
        for part in range(12):
            inside = exactly(kind, numbers, (k + Fraction(part, 11)) * h, order)
            for low, high in (between, later):
                assert _between(low, inside, high)
        assert _between(later[0], value, later[1])  # held since before it counts, too


def _between(low, x, high):
    if isinstance(x, arb):
        first, last = ends(x)
        return low <= last and first <= high
    return low <= x <= high


def test_a_step_at_a_sample_has_both_values_there_and_one_elsewhere():
    problem = Sampled("step", (1.0, 0.027, 0.25), 0, 0.009)  # floats: 3 · 0.009 < 0.027
    for k, expected in ((1, 0.25), (2, 0.25), (3, 1.0), (4, 1.0)):
        for low, high in both(problem, k):
            assert low == high == expected
    at = problem.time_of(3)
    there = moving.reference_between(problem, ("a", "y"), at, at)
    assert (there.low, there.high) == (0.25, 1.0)


@pytest.mark.parametrize("kind", ["step", "ramp"])
def test_simulate_jumps_at_the_sample_that_the_decimals_say(kind):
    for period in (0.001, 0.003, 0.006, 0.009, 0.011, 0.07):
        for k in range(1, 400):
            at = float(decimal(period) * k)
            value, rate, _ = Signal(kind, (1.0, at, 0.5)).at(np.arange(k + 2) * period)
            moved = value > 0.5 if kind == "step" else rate > 0.0
            assert moved.argmax() == k, (period, k)


# ── what is proved ───────────────────────────────────────────────────────────────────


def random_reference(draw):
    """Return a reference as a claim says it."""
    a, b, c = (f"{x:.3g}" for x in draw.uniform(-0.6, 0.6, 3))
    t, u = (f"{10 * k} ms" for k in draw.integers(3, 30, 2))
    at = f"{draw.integers(0, 400) / 1000:g} s"
    return draw.choice(
        [
            f"step {a} .. {b} at {at}",
            f"ramp {a} by {b} at {at}",
            f"sine {a} at {draw.uniform(0.2, 3.0):.2g} Hz around {b}",
            f"quintic {a} .. {b} in {t}",
            f"quintic {a} .. {b} in {t}, {b} .. {b} in {u}, {b} .. {c} in {t}",
        ]
    )


def values_at_samples(text, problem, start, seconds, sensors=None):
    """Return time, outputs, errors and drives of a run."""
    plant = starting_at(problem.plant, start)
    options = Options(sensors=sensors or {})
    run = simulate(
        text, plant, reference=problem.signals_by_name, duration=seconds, options=options
    )
    (signal,) = problem.signals.values()
    wanted = signal.at(np.asarray(run.time))[0]
    errors = {"error of y": wanted - run.outputs["y"]}
    return run.time, {**run.outputs, **errors}, run.drives


@pytest.mark.slow(seconds=15)
@pytest.mark.parametrize("kind", LAWS)
def test_a_tube_holds_all_runs_along_a_reference(loop, kind):
    text, plant = loop(kind, " - 0.3 * math.sin(x[0])" if kind == "fuzzy" else "")
    draw, seconds = np.random.default_rng(7), 0.5
    for _ in range(cases(5, 60)):
        sensors = {"y": Sensor(delay=0.02)} if draw.random() < 0.3 else None
        words = random_reference(draw)
        start = float(draw.uniform(-0.3, 0.3))
        claim = read_claim(
            f"from y in {start - 0.02:.3f} .. {start + 0.02:.3f} while y follows {words}:"
            " error of y in -9 .. 9 during 0 .. 1 s",
            plant,
        )
        way, open_ = loop_tube(text, claim, seconds, plant=find_plant(plant), sensors=sensors)
        assert way.complete
        assert not open_
        y = way.problem.start["y"]
        for number in range(cases(16, 100)):
            begin = [y.low, y.high][number] if number < 2 else draw.uniform(*y)
            time, values, drives = values_at_samples(
                text, way.problem, [float(begin), 0.0], seconds, sensors
            )
            rows = np.rint(time / 0.01).astype(int)
            rows = rows[rows < len(way.low)]
            # At samples outputs and errors; drives from each sample on.
            bounds = {**dict.fromkeys(values, (way.low_at, way.high_at)), "u": (way.low, way.high)}
            for name, found in {**values, "u": drives["u"]}.items():
                low, high = (x[rows, way.ports.index(name)] for x in bounds[name])
                assert (low - 1e-9 <= found[: len(rows)]).all(), (words, name)
                assert (found[: len(rows)] <= high + 1e-9).all(), (words, name)


def test_an_error_is_that_of_a_held_reference_as_well(loop):
    text, plant = loop("held")
    claim = "while y follows ramp 0 by 4 at 0 s: error of y in -9 .. 9 during 0 .. 1 s"
    way, _ = loop_tube(text, read_claim(claim, plant), 0.2, plant=find_plant(plant))
    y, error = way.ports.index("y"), way.ports.index("error of y")
    for k in range(1, 20):
        held = 0.04 * (k - k % 4)
        assert way.low_at[k, error] <= held - way.high_at[k, y]
        assert way.high_at[k, error] >= held - way.low_at[k, y]


@pytest.mark.slow(seconds=20)
@pytest.mark.parametrize("kind", ["linear", "fuzzy"])
def test_a_false_claim_is_never_proved(loop, kind):
    """Bounds are what runs attain, made narrower by a millionth; wider by 5 % they are proved."""
    text, plant = loop(kind)
    draw, told = np.random.default_rng(11), dict.fromkeys(("proved", "refuted", "undecided"), 0)
    for _ in range(cases(6, 100)):
        words = random_reference(draw)
        whole = (
            f"from y in -0.02 .. 0.02 while y follows {words}:"
            " PORT in LOW .. HIGH during 0.1 .. 0.4 s"
        )
        trivial = read_claim(whole.replace("PORT in LOW .. HIGH", "y in -9 .. 9"), plant)
        problem = problem_of(text, trivial, plant=find_plant(plant))
        runs = [values_at_samples(text, problem, [y, 0.0], 0.5) for y in (-0.02, 0.0, 0.02)]
        port = str(draw.choice(["y", "error of y"]))
        late = [(time >= 0.1 - 1e-9) & (time <= 0.4 + 1e-9) for time, *_ in runs]
        attained = np.concatenate([x[port][k] for (_, x, _), k in zip(runs, late, strict=True)])
        low, high = float(attained.min()), float(attained.max())
        narrow, room = 1e-6 * (high - low) + 1e-9, 0.05 * (high - low) + 0.1
        for way, ends_ in (
            ("false", (low + narrow, high + room)),
            ("false", (low - room, high - narrow)),
            ("true", (low - room, high + room)),
        ):
            claim = read_claim(
                whole.replace("PORT", port)
                .replace("LOW", repr(ends_[0]))
                .replace("HIGH", repr(ends_[1])),
                plant,
            )
            budget = 60.0 if way == "true" else 5.0  # what is proved takes as long as it takes
            verdict = prove_loop(text, claim, plant=find_plant(plant), budget=budget)
            assert verdict.proved is (way == "true"), (str(verdict), words)
            told[verdict.verdict] += 1
    assert told["refuted"]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["linear", "fuzzy"])
def test_for_all_time_a_tube_leads_into_the_region_where_the_move_ends(loop, kind):
    text, plant = loop(kind)
    move = "from y in -0.01 .. 0.01 while y follows quintic 0 .. 0.5 in 0.3 s, 0.5 .. 0.2 in 0.2 s"
    for claim, expected in (
        ("error of y in -0.4 .. 0.4", "proved"),
        ("error of y in -0.03 .. 0.03 after 1 s", "proved"),
        ("y in 0.17 .. 0.23 after 1 s", "proved"),
        ("y in 0.23 .. 0.3 after 1 s", "refuted"),
        ("y in -0.1 .. 0.25", "refuted"),
    ):
        verdict = prove_loop(
            text, read_claim(f"{move}: {claim}", plant), plant=find_plant(plant), budget=30.0
        )
        assert verdict.verdict == expected, str(verdict)
        if verdict.proved:
            assert verdict.tube.arrival >= 0.5
            assert verdict.rest["y"] == pytest.approx(0.2)


@pytest.mark.slow
def test_bounds_of_an_error_at_rest_need_no_tube(loop):
    text, plant = loop()
    claim = "at y = 0.1 from y in 0.09 .. 0.11: error of y in -0.02 .. 0.02"
    verdict = prove_loop(text, read_claim(claim, plant), plant=find_plant(plant))
    assert verdict.proved
    assert verdict.certificate is not None
    narrow = claim.replace("-0.02 .. 0.02", "-0.02 .. 0.005")
    assert prove_loop(text, read_claim(narrow, plant), plant=find_plant(plant)).verdict == "refuted"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("bounds", "expected"),
    [
        ("-0.1 .. 1.1 during 0 .. 100 ms", "proved"),
        ("-0.1 .. 0.5 during 0 .. 99 ms", "proved"),  # before the jump
        ("-0.1 .. 0.5 during 0 .. 100 ms", "undecided"),  # at the jump: both values count
        ("0.5 .. 1.1 during 100 .. 110 ms", "refuted"),
        ("0.5 .. 1.1 during 101 .. 110 ms", "proved"),
        ("-0.1 .. 0.5 during 0 .. 120 ms", "refuted"),
    ],
)
def test_an_error_has_both_values_where_a_step_jumps(loop, bounds, expected):
    text, plant = loop()
    claim = f"from y in 0 .. 0.01 while y follows step 0 .. 1 at 0.1 s: error of y in {bounds}"
    found = prove_loop(text, read_claim(claim, plant), plant=find_plant(plant), budget=3.0)
    assert found.verdict in (expected, "undecided" if expected == "refuted" else expected)
    assert found.proved is (expected == "proved")


# ── certificates ─────────────────────────────────────────────────────────────────────

CLAIM = (
    "from y in -0.01 .. 0.01 while y follows quintic 0 .. 0.4 in 160 ms, 0.4 .. 0.1 in 80 ms:"
    " error of y in -0.3 .. 0.33 during 0 .. 250 ms"
)


def written(text, plant, claim, folder, **how):
    """Return the file of a certificate."""
    path = str(folder / "proof.json")
    write_certificate(
        certify_tube(text, read_claim(claim, plant), plant=find_plant(plant), **how), path
    )
    return path


@pytest.mark.slow
def test_a_certificate_says_the_reference_and_is_in_the_header_of_c(loop, tmp_path, capsys):
    text, plant = loop()
    path = written(text, plant, CLAIM, tmp_path)
    checked = check_certificate(path, trust=True)
    assert checked.proved, checked.reason
    assert "while y follows quintic 0 .. 0.4 in 0.16 s, 0.4 .. 0.1 in 0.08 s" in checked.statement
    from fuzzyarm.apps.cli.main import main

    header = tmp_path / "c.h"
    assert main(["compile", text.path, "-o", str(header), "--certificate", path, "--trust"]) == 0
    words = " ".join(header.read_text().replace("*", " ").split())
    assert "while y follows quintic 0 .. 0.4 in 0.16 s, 0.4 .. 0.1 in 0.08 s" in words


CHANGES = {
    "to": lambda row: row[2].__setitem__(0, "3/5"),
    "shorter": lambda row: row[2].__setitem__(1, "1/50"),
    "from": lambda row: row[2].__setitem__(2, "1/2"),
    "second to": lambda row: row[2].__setitem__(3, "-1/2"),
    "second shorter": lambda row: row[2].__setitem__(4, "1/100"),
    "a step": lambda row: row.__setitem__(slice(1, 3), ["step", ["2/5", "0", "0"]]),
    "a ramp": lambda row: row.__setitem__(slice(1, 3), ["ramp", ["40", "0", "0"]]),
    "a sine": lambda row: row.__setitem__(slice(1, 3), ["sine", ["1", "4"]]),
}
WRONG = {
    "no such kind": lambda row: row.__setitem__(1, "spline"),
    "a file": lambda row: row.__setitem__(slice(1, 3), ["file", []]),
    "a number too few": lambda row: row[2].pop(),
    "no number": lambda row: row.__setitem__(2, []),
    "a number as such": lambda row: row[2].__setitem__(0, 0.4),
    "not finite": lambda row: row[2].__setitem__(0, "inf"),
    "no time": lambda row: row[2].__setitem__(1, "0"),
    "before the start": lambda row: row.__setitem__(slice(1, 3), ["step", ["1", "-1", "0"]]),
    "another port": lambda row: row.__setitem__(0, "v"),
    "an input": lambda row: row.__setitem__(0, "u"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", [*CHANGES, *WRONG, "none", "two", "stable", "of the output"])
def test_a_certificate_of_another_reference_is_refused(loop, tmp_path, name):
    text, plant = loop()
    path = written(text, plant, CLAIM, tmp_path)
    data = json.loads((tmp_path / "proof.json").read_text())
    del data["seal"]
    rows = data["claim"]["while"]
    if name in CHANGES or name in WRONG:
        (CHANGES | WRONG)[name](rows[0])
    elif name == "none":
        del data["claim"]["while"]
    elif name == "two":
        rows.append(rows[0])
    elif name == "stable":
        data["claim"]["stable"] = True
    else:  # then it claims of the output what is true of the error only
        del data["claim"]["error"]
        data["claim"]["between"][1] = "1/5"
    (tmp_path / "proof.json").write_text(json.dumps(sealed(data)))
    try:
        checked = check_certificate(path, trust=True)
    except FuzzyarmError:
        return
    if checked.proved:  # as it now reads
        assert name in ("none", "second shorter")
        assert CLAIM not in checked.statement
        problem = problem_of(text, checked.claim, plant=find_plant(plant))
        if problem.moved:
            _, values, _ = values_at_samples(text, problem, [0.01, 0.0], 0.25)
            assert (values["error of y"] >= -0.3).all()
            assert (values["error of y"] <= 0.33).all()


@pytest.mark.slow
def test_a_certificate_of_a_loop_with_a_late_sensor(loop, tmp_path):
    text, plant = loop("fuzzy")
    how = {"sensors": {"y": Sensor(delay=0.02)}}
    claim = CLAIM.replace("0.33", "0.37")
    checked = check_certificate(written(text, plant, claim, tmp_path, **how), trust=True)
    assert checked.proved
    assert "delay 0.02 s" in checked.statement


@pytest.mark.slow
def test_a_certificate_for_all_time_needs_the_end_of_the_move(loop, tmp_path):
    text, plant = loop()
    claim = read_claim(
        "from y in -0.01 .. 0.01 while y follows quintic 0 .. 0.3 in 0.2 s:"
        " error of y in -0.2 .. 0.2",
        plant,
    )
    verdict = prove_loop(text, claim, plant=find_plant(plant))
    assert verdict.proved, str(verdict)
    certificate = certify_tube(text, claim, plant=find_plant(plant), regions=[verdict.haven])
    assert certificate.tubes[0].periods >= 20
    path = str(tmp_path / "proof.json")
    write_certificate(certificate, path)
    assert check_certificate(path, trust=True).proved
    # The region alone is one around the last value: it says nothing of the way there.
    write_certificate(replace(certificate, tubes=()), path)
    assert not check_certificate(path, trust=True).proved
    early = certificate.tubes[0]._replace(periods=19)
    write_certificate(replace(certificate, tubes=(early,)), path)
    assert not check_certificate(path, trust=True).proved


# ── refused by name ──────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("claim", "words"),
    [
        ("stable while y follows step 0 .. 1 at 0.1 s", "a loop is stable at rest"),
        ("while y follows sine 1 at 2 Hz: y in -2 .. 2", "a sine never comes to rest"),
        (
            "while y follows ramp 1 by 1 at 0 s: y in -2 .. 2 after 1 s",
            "a ramp never comes to rest",
        ),
        ("at y = 1 while y follows step 0 .. 1 at 1 s: y in 0 .. 1", "'y' has two references"),
        ("while v follows step 0 .. 1 at 1 s: y in 0 .. 1", "'v' has no reference of its own"),
        ("while u follows step 0 .. 1 at 1 s: y in 0 .. 1", "'u' has no reference of its own"),
        ("from y in 0 .. 1: error of u in 0 .. 1", "'u' is an input, which has no error"),
    ],
)
def test_a_claim_without_sense_is_refused_by_name(loop, claim, words):
    text, plant = loop()
    with pytest.raises(FuzzyarmError, match=words):
        prove_loop(text, read_claim(claim, plant), plant=find_plant(plant))


def test_a_map_takes_no_moving_reference(loop):
    text, plant = loop()
    with pytest.raises(FuzzyarmError, match="a loop is stable at rest"):
        fuzzyarm.prove(
            text.path, "stable while y follows step 0 .. 1 at 1 s", plant=plant, map=True
        )


# ── the language ─────────────────────────────────────────────────────────────────────

SERVO = fuzzyarm.shipped("servo.frb").read_text(encoding="utf-8")


def test_references_are_printed_as_they_were_written():
    lines = [
        "prove on motor from position in 0 .. 1 while position follows step -1 .. 1 at 100 ms:"
        " position in -2 .. 2",
        "prove on motor while position follows ramp 0 by -0.5 at 0.1 s:"
        " error of position in -2 .. 2 during 0 .. 1 s",
        "prove on motor while position follows sine 0.3 at 0.5 Hz around 1:"
        " voltage in -2 .. 2 during 0 .. 1 s",
        "prove on motor while position follows quintic 0 .. 1 in 500 ms, 1 .. -1 in 1 s,"
        " velocity follows sine 1 at 2 Hz: position in 0 .. 1 during 0 .. 1 s",
    ]
    text = format_text("\n".join([SERVO, *lines, ""]))
    assert text.splitlines()[-len(lines) :] == lines
    for line in lines:
        claim = read_claim(line)
        assert read_claim(claim_text(claim)) == claim


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("position follow step 0 .. 1 at 1 s", "'follows' after 'position'"),
        ("position follows jump 0 .. 1 at 1 s", "step, ramp, sine, quintic"),
        ("position follows step 0 .. 1 at 1", "a unit of time"),
        ("position follows step 1 at 1 s", "'..' between"),
        ("position follows quintic 0 .. 1 in 1 s, 2 .. 1 in 1 s", "goes on from 1"),
        ("position follows quintic 0 .. 1 in 0 s", "takes some time"),
        ("position follows sine 1 at 2 s", "'Hz' after 2"),
    ],
)
def test_a_slip_in_a_reference_is_found(words, message):
    with pytest.raises(FuzzyarmError) as found:
        read_claim(f"on motor while {words}: position in 0 .. 1 during 0 .. 1 s")
    assert message in str(found.value)


def test_a_port_that_a_shipped_plant_does_not_have_is_found(tmp_path):
    for name in ("servo.frb", "pd7.frb"):
        (tmp_path / name).write_text(fuzzyarm.shipped(name).read_text(encoding="utf-8"))
    path = tmp_path / "servo.frb"
    claims = "while psition follows step 0 .. 1 at 1 s: position in 0 .. 1"
    path.write_text(f"{SERVO}\nprove on motor {claims}\n", encoding="utf-8")
    found = [each.message for each in doubts_of(fuzzyarm.load(path)) if each.name == "unknown-port"]
    assert found == ["motor has no port 'psition'"]
