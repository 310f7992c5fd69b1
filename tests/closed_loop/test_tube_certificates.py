"""Certificates of claims for a bounded time: what they prove, and that damaged ones do not."""

import json
import re
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from budget import cases
from scipy.optimize import linprog

import fuzzyarm
from fuzzyarm.proof import check
from fuzzyarm.proof.check import check_certificate
from fuzzyarm.proof.check.certificate import TubeProof, sealed
from fuzzyarm.proof.check.numbers import precisely
from fuzzyarm.proof.check.tube import Follower, covered
from fuzzyarm.proof.claim.text import problem_of
from fuzzyarm.proof.loop import (
    CertificateError,
    certify_tube,
    read_certificate,
    read_claim,
    write_certificate,
)
from fuzzyarm.proof.loop.runs import run_of

CLAIM = (
    "on motor from position in 0.01 .. 0.02, velocity in -0.1 .. 0.1:"
    " position in 0 .. 0.03 during 0 .. 3 ms"
)


@pytest.fixture(scope="module")
def certificate(servo):
    return certify_tube(servo, read_claim(CLAIM))


@pytest.mark.slow
def test_a_certificate_is_what_was_written_and_proves_its_claim(certificate, tmp_path):
    path = str(tmp_path / "tube.json")
    write_certificate(certificate, path)
    assert read_certificate(path) == certificate
    verdict = check_certificate(path)
    assert verdict.proved
    assert verdict.certificate == certificate


@precisely
def sets_of(follower, box, count):
    """Return the sets of a box, sample by sample."""
    sets = [follower.start_forms([box])]
    for k in range(count - 1):
        after, _ = follower._period(sets[-1], k)
        sets.append(follower.numbers.fewer(after, 14))
    return sets


def is_within(forms, z):
    """Tell whether a point is in a set, by a linear program over its symbols."""
    symbols = max(len(form.weights) for form in forms)
    weights = np.array([form.over(symbols)[:, 0] for form in forms])
    centre = np.array([form.centre[0] for form in forms])
    scale = np.abs(weights).sum(axis=1) + 1e-12
    found = linprog(
        np.zeros(symbols),
        A_ub=np.vstack([weights, -weights]) / np.tile(scale, 2)[:, None],
        b_ub=np.concatenate([z - centre, centre - z]) / np.tile(scale, 2) + 1e-6,
        bounds=[(-1, 1)] * symbols,
    )
    return found.status == 0


def fine_runs(problem, seconds, count):
    """Yield states at the samples of runs from the starts, by steps that RK4 is good for."""
    generator = np.random.default_rng(2)
    for k in range(count):
        start = {
            name: float(generator.choice([x.low, x.high]) if k < 8 else generator.uniform(*x))
            for name, x in problem.start.items()
        }
        run = run_of(problem, start, {}, duration=seconds, steps=16)
        yield np.array([run.outputs[name] for name in problem.states]).T


@pytest.mark.slow
def test_runs_stay_in_the_sets_of_the_checker(servo, certificate):
    problem = problem_of(servo, certificate.claim)
    courses = [sets_of(Follower(problem), tube.box, 4) for tube in certificate.tubes]
    for states in fine_runs(problem, 0.003, cases(20, 2000)):
        for k, z in enumerate(states[:4]):
            assert any(is_within(course[k], z) for course in courses)


@pytest.mark.slow
def test_sets_hold_runs_and_are_not_much_larger(servo):
    """Of 200 runs over 60 periods through saturation, kinks and reductions of symbols."""
    claim = read_claim(
        "stable on motor from position in 0.9 .. 0.92, velocity in -1 .. 1, current in -1 .. 1"
    )
    problem = problem_of(servo, claim)
    box = tuple((Fraction(x.low), Fraction(x.high)) for x in problem.start.values())
    sets = sets_of(Follower(problem), box, 61)
    runs = np.array(list(fine_runs(problem, 0.06, cases(60, 500))))
    for k in (1, 10, 30, 59):
        for z in runs[:20, k]:
            assert is_within(sets[k], z), k
        assert 2 * sets[k][0].reach[0] < 2.2 * np.ptp(runs[:, k, 0])


RUN = """controller c
period {period}
axis a
  e = error of {port}
  {lines}
  drive {drive} = p, within {within}
"""

REMEMBERED = {
    "rate": ("motor", "r = rate of e, filter 4 ms\n  p = e * 40 + r"),
    "lag": ("motor", "s = lag of e, time 5 ms\n  p = s * 40"),
    "change": ("motor", "d = change of e\n  p = e * 40 + d * 300"),
    "delayed": ("motor", "s = delayed of e, time 3 ms\n  p = s * 20"),
    "deadband": ("motor", "s = deadband of e, width 0.1\n  p = s * 60"),
    "hysteresis": ("motor", "s = hysteresis of e, width 0.1\n  p = s * 60"),
    "hold": ("motor", "i = integral of e, anti-windup hold\n  p = e * 20 + i * 500"),
    "back": ("motor", "i = integral of e, anti-windup back 20 ms\n  p = e * 20 + i * 500"),
    "bounded": ("motor", "i = integral of e, within -0.003 .. 0.002\n  p = e * 20 + i * 500"),
    "slew": ("motor", "p = e * 40\n  q = p"),
}
"""Controllers whose lines remember something, or turn at a corner."""


def remembering(kind, tmp_path):
    """Return a controller that remembers, the problem of starts on both sides of 0, and a box."""
    plant, lines = REMEMBERED[kind]
    within = "-3 .. 5, slew 400" if kind == "slew" else "-3 .. 5"
    path = tmp_path / "c.frb"
    path.write_text(
        RUN.format(period="1 ms", port="position", lines=lines, drive="voltage", within=within)
    )
    text = fuzzyarm.load_controller(path)
    claim = read_claim(
        f"stable on {plant} from position in -0.14 .. 0.1, velocity in -3 .. 9, current in 0 .. 1"
    )
    problem = problem_of(text, claim)
    return text, problem, tuple((Fraction(x.low), Fraction(x.high)) for x in problem.start.values())


@pytest.mark.slow
@pytest.mark.parametrize("kind", REMEMBERED)
def test_sets_hold_runs_of_loops_that_remember(kind, tmp_path):
    """Some starts drive the limits, others do not, and what is remembered differs."""
    _, problem, box = remembering(kind, tmp_path)
    sets = sets_of(Follower(problem), box, 40)
    for states in fine_runs(problem, 0.045, cases(24, 400)):
        for k in (1, 2, 3, 5, 8, 20, 39):
            assert is_within(sets[k][:3], states[k]), (kind, k)


@precisely
def followed_together(follower, boxes, periods):
    """Return where sets are at each sample, followed side by side: (samples, ends, forms, sets)."""
    follower.numbers.sets, follower.numbers.symbols = len(boxes), 0
    forms, ends = follower.start_forms(boxes), []
    for k in range(periods):
        forms, _ = follower._period(forms, k)
        forms = follower.numbers.fewer(forms, 14)
        spans = [form.span for form in forms]
        ends.append([[np.broadcast_to(x, len(boxes)) for x in side]
                     for side in ([s.low for s in spans], [s.high for s in spans])])  # fmt: skip
    return np.array(ends)


@pytest.mark.slow
@pytest.mark.parametrize("kind", [*REMEMBERED, "servo.frb", "cartpole.frb", "ball-and-beam.frb"])
def test_a_set_does_not_depend_on_those_beside_it(kind, tmp_path):
    """To the last bit; else a certificate might be refused where its boxes are grouped anew."""
    if kind in REMEMBERED:
        _, problem, box = remembering(kind, tmp_path)
    else:
        text = fuzzyarm.load_controller(fuzzyarm.shipped(kind))
        plant = "motor" if kind == "servo.frb" else kind.removesuffix(".frb")
        problem = problem_of(text, read_claim(f"stable on {plant}"))
        box = [(Fraction(-3, 100), Fraction(2, 100)) for _ in problem.states]
    generator = np.random.default_rng(7)
    boxes = []
    for size in (1.0, 0.1, 0.1, 0.1, 0.01, 0.01, 1e-3, 0.0, 0.1, 0.01):
        share = [float(generator.uniform(0, 1 - size)) for _ in box]
        boxes.append([
            tuple(low + (high - low) * Fraction(at) for at in (x, x + size))
            for x, (low, high) in zip(share, box, strict=True)
        ])  # fmt: skip
    boxes.append([(Fraction(0), Fraction(0)) for _ in box])
    follower = Follower(problem)
    together = followed_together(follower, boxes, 12)
    for k, one in enumerate(boxes):
        alone = followed_together(follower, [one], 12)
        assert np.array_equal(alone[..., 0], together[..., k], equal_nan=True), k
    some = followed_together(follower, boxes[2:5], 12)
    assert np.array_equal(some, together[..., 2:5], equal_nan=True)


@pytest.mark.slow
@pytest.mark.parametrize("kind", [k for k in REMEMBERED if k not in ("hysteresis", "hold")])
def test_a_tube_of_what_is_remembered_has_a_certificate(kind, tmp_path):
    text, _, _ = remembering(kind, tmp_path)
    starts = "from position in 0.1 .. 0.11"
    claim = read_claim(f"on motor {starts}: position in -1 .. 1 during 0 .. 20 ms")
    assert check_certificate(certify_tube(text, claim), text).proved


def test_a_value_that_is_not_followed_is_named(tmp_path):
    (tmp_path / "edged.frb").write_text(EDGED.replace("triangle -2 0 2", "gaussian 0 1"))
    (tmp_path / "c.frb").write_text(
        'controller c\nuse edged from "edged.frb"\nperiod 1 ms\naxis shaft\n'
        "  e = error of position\n  u = rules edged(e)\n  drive voltage = u\n"
    )
    text = fuzzyarm.load_controller(tmp_path / "c.frb")
    claim = read_claim("on motor: position in -1 .. 1 during 0 .. 3 ms")
    with pytest.raises(ValueError, match="'u': 'e is Z' is not made of straight pieces"):
        certify_tube(text, claim, budget=5.0)


BOX = ((0.0, 1.0), (-1.0, 1.0))


@pytest.mark.parametrize(
    ("boxes", "expected"),
    [
        ([BOX], True),
        ([((0, 1), (-1, 0)), ((0, 1), (0, 1))], True),
        ([((0, 0.5), (-1, 1)), ((0.5, 1), (-1, 0.25)), ((0.25, 1), (0.25, 1))], True),
        ([((0, 0.5), (-1, 1)), ((0.5, 1), (-1, 0.25)), ((0.75, 1), (0.25, 1))], False),
        ([((0, 1), (-1, 0.999))], False),
        ([], False),
    ],
)
def test_boxes_that_are_all_of_a_box(boxes, expected):
    lows, highs = np.moveaxis(np.array(boxes, float).reshape(-1, 2, 2), 2, 0)
    assert covered(BOX, lows, highs) == expected


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda c: replace(c, tubes=()), "no region"),
        (lambda c: replace(c, tubes=c.tubes[1:]), "not all of the starts|no region"),
        (
            lambda c: replace(c, tubes=(c.tubes[0]._replace(box=c.tubes[0].box[:2]),)),
            "not a box",
        ),
        (
            lambda c: replace(c, tubes=tuple(t._replace(into=("tubes", 1)) for t in c.tubes)),
            "not known to arrive",
        ),
        (
            lambda c: replace(c, tubes=tuple(t._replace(into=("regions", 0)) for t in c.tubes)),
            "no region 0",
        ),
        (lambda c: replace(c, claim=replace(c.claim, high=0.015)), "is not shown"),
        (lambda c: replace(c, claim=replace(c.claim, end=30.0)), "box 1"),
    ],
)
def test_what_it_does_not_say_is_not_proved(servo, certificate, change, words):
    checked = check_certificate(change(certificate), servo, budget=20.0)
    assert not checked.proved
    assert re.search(words, checked.reason), checked.reason


@pytest.mark.slow
def test_a_tube_into_a_region_has_a_certificate(servo, servo_verdict, tmp_path):
    claim = read_claim("stable on motor from position in 0.5 .. 0.55")
    region = servo_verdict.certificate.region
    certificate = certify_tube(servo, claim, regions=(region,))
    path = str(tmp_path / "far.json")
    write_certificate(certificate, path)
    assert check_certificate(path).proved
    first = certificate.tubes[0]
    assert 1 < first.periods < 500
    for damaged in (
        replace(certificate, tubes=(first._replace(periods=first.periods // 2),)),
        replace(certificate, regions=(replace(region, p=((1, 0, 0), (0, 1, 0), (0, 0, 1))),)),
        replace(certificate, claim=replace(claim, start=(("position", 0.5, 0.6),))),
    ):
        assert not check_certificate(damaged, servo).proved


@pytest.mark.slow
def test_a_map_is_proved_box_by_box_and_in_order(servo, servo_verdict):
    plain = servo_verdict.certificate
    far = tuple((Fraction(a), Fraction(b)) for a, b in ((0.45, 0.47), (-0.1, 0.1), (-0.5, 0.5)))
    near = tuple((Fraction(a), Fraction(b)) for a, b in ((0.2, 0.25), (-0.5, 0.5), (-0.5, 0.5)))
    tubes = (TubeProof(near, 400, ("regions", 0)), TubeProof(far, 400, ("regions", 0)))
    window = tuple((name, -1.0, 1.0) for name in ("position", "velocity", "current"))
    whole = replace(plain, regions=(plain.region,), tubes=tubes, window=window)
    checked = check.check_certificate(whole, servo)
    assert checked.proved, checked.reason
    assert "2 boxes" in checked.statement
    assert [words.split(":")[0] for words in checked.words if "theorem" in words] == ["theorem"] * 3
    circle = replace(whole, tubes=(tubes[0]._replace(into=("tubes", 1)), tubes[1]))
    assert not check.check_certificate(circle, servo).proved


def test_a_damaged_file_is_refused(certificate, tmp_path):
    path = tmp_path / "tube.json"
    write_certificate(certificate, str(path))
    data = json.loads(path.read_text(encoding="utf-8"))
    data["tubes"][0]["box"][0][0] = "1/3"
    path.write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(CertificateError, match="seal"):
        read_certificate(str(path))
    data.pop("seal")
    data["tubes"][0]["box"][0][0] = "much"
    path.write_text(json.dumps(sealed(data)), encoding="utf-8")
    with pytest.raises(CertificateError, match="not a certificate"):
        read_certificate(str(path))


def test_a_text_that_no_file_can_hold_is_refused(certificate, tmp_path):
    """A seal is of bytes, and half a pair of UTF-16 has none."""
    path = tmp_path / "tube.json"
    data = {**certificate.as_data(), "controller": "\ud800"}
    path.write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(CertificateError, match="is not a certificate: it is not JSON"):
        read_certificate(str(path))


def test_periods_beyond_any_run_are_refused_in_a_sentence(certificate, tmp_path):
    """Arrays of periods overflowed."""
    path = tmp_path / "tube.json"
    data = certificate.as_data()
    data.pop("seal")
    data["tubes"][0]["periods"] = 1 << 63
    path.write_text(json.dumps(sealed(data)), encoding="utf-8")
    with pytest.raises(CertificateError, match=r"'tubes\[0\].periods' is too large"):
        read_certificate(str(path))


def test_a_file_nested_without_end_is_refused_in_a_sentence(tmp_path):
    path = tmp_path / "deep.json"
    for depth in range(940, 1000):  # where first the seal, then already the reader gives up
        nested = f"{'[' * depth}{']' * depth}"
        path.write_text(f'{{"format": "fuzzyarm-proof 2", "deep": {nested}}}', encoding="utf-8")
        with pytest.raises(CertificateError, match=r"is damaged|is not JSON"):
            read_certificate(str(path))


def test_sets_for_a_time_prove_no_stability(servo, certificate):
    """An unstable loop may keep a claim for three periods."""
    forged = replace(certificate, claim=replace(certificate.claim, stable=True))
    verdict = check_certificate(forged, servo)
    assert not verdict.proved
    assert "it ends before the claim does" in verdict.reason
    with pytest.raises(ValueError, match="does not show that a loop is stable"):
        certify_tube(servo, forged.claim)


EDGED = """rulebase edged
input e -1 .. 1
output u -1 .. 1
term e N: trapezoid -1 -1 -0.2 -0.2
term e Z: triangle -2 0 2
term u N: singleton -1
term u P: singleton 1
inference u: defuzzifier weighted-average
rule if e is N then u is N
rule if e is Z then u is P
"""


@pytest.mark.parametrize(("start", "fits"), [("0.19 .. 0.21", False), ("0.4 .. 0.41", True)])
def test_a_set_over_a_vertical_edge_is_refused_by_name(tmp_path, start, fits):
    """At position 0.2, which is an error of -0.2, the output jumps from 1 to about 0."""
    (tmp_path / "edged.frb").write_text(EDGED)
    (tmp_path / "c.frb").write_text(
        'controller c\nuse edged from "edged.frb"\nperiod 1 ms\naxis shaft\n'
        "  e = error of position\n  u = rules edged(e)\n  drive voltage = u\n"
    )
    text = fuzzyarm.load_controller(tmp_path / "c.frb")
    claim = read_claim(f"on motor from position in {start}: position in -1 .. 1 during 0 .. 3 ms")
    if fits:
        assert check_certificate(certify_tube(text, claim), text).proved
    else:
        with pytest.raises(ValueError, match="'edged' has a vertical edge"):
            certify_tube(text, claim, budget=5.0)
