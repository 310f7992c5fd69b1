"""Certificates of claims for a bounded time: what they prove, and that damaged ones do not."""

import json
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from budget import cases

import fuzzyarm
from fuzzyarm.proof.claim.text import problem_of
from fuzzyarm.proof.loop import (
    CertificateError,
    certify_tube,
    check_certificate,
    read_certificate,
    read_claim,
    write_certificate,
)
from fuzzyarm.proof.loop.certificate import sealed
from fuzzyarm.proof.loop.runs import sampled_runs
from fuzzyarm.proof.loop.tube_checker import TubeLoop, TubeSet, _is_all, leads_into

CLAIM = (
    "on motor from position in 0.01 .. 0.02, velocity in -0.1 .. 0.1:"
    " position in 0 .. 0.03 during 0 .. 3 ms"
)


@pytest.fixture(scope="module")
def servo():
    return fuzzyarm.load(fuzzyarm.shipped("servo.frb"))


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


@pytest.mark.slow
def test_runs_stay_in_its_sets(servo, certificate):
    problem = problem_of(servo, certificate.claim)
    for run in sampled_runs(problem, 0.003, cases(20, 2000)):
        states = np.array([run.outputs[name] for name in problem.states]).T
        for k, z in enumerate(states[:3]):
            inside = [
                np.abs(rows @ (z - centre)).max() <= 1 + 1e-6
                for centre, rows in (
                    (np.array(own.centre, float), np.array(own.rows, float))
                    for own in (box.sets[k] for box in certificate.boxes)
                )
            ]
            assert any(inside)


def numbers_in(certificate):
    """Yield certificates in which one number is another one."""
    for b, box in enumerate(certificate.boxes[:1]):
        for k, own in enumerate(box.sets):
            for i in range(len(own.centre)):
                for changed in (
                    moved_centre(own, i, Fraction(11, 10)),
                    scaled_row(own, i, Fraction(11, 10)),
                ):
                    if k == 0 and i == 2 and changed.centre == own.centre:
                        continue  # the current begins at one number, which any set holds
                    sets = [*box.sets]
                    sets[k] = changed
                    boxes = [*certificate.boxes]
                    boxes[b] = box._replace(sets=tuple(sets))
                    yield (k, i), replace(certificate, boxes=tuple(boxes))


def moved_centre(own, i, share):
    """Return a set that is further away by a share of its width, and not larger."""
    turn = np.linalg.inv(np.array(own.rows, float))
    centre = list(own.centre)
    centre[i] += share * Fraction(float(np.abs(turn[i]).sum()))
    return own._replace(centre=tuple(centre))


def scaled_row(own, i, factor):
    rows = [tuple(x * (factor if k == i else 1) for x in row) for k, row in enumerate(own.rows)]
    return own._replace(rows=tuple(rows))


@pytest.mark.slow
def test_a_certificate_that_is_damaged_in_one_number_is_rejected(servo, certificate):
    for place, damaged in numbers_in(certificate):
        assert damaged.refutation(servo), place


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda c: replace(c, boxes=()), "not all of the starts"),
        (
            lambda c: replace(c, boxes=tuple(b._replace(path=((0, True),)) for b in c.boxes)),
            "not all of the starts",
        ),
        (
            lambda c: replace(c, boxes=tuple(b._replace(sets=b.sets[:1]) for b in c.boxes)),
            "before the claim",
        ),
        (lambda c: replace(c, claim=replace(c.claim, high=0.015)), "is not shown"),
        (lambda c: replace(c, claim=replace(c.claim, end=1.0)), "before the claim"),
    ],
)
def test_what_it_does_not_say_is_not_proved(servo, certificate, change, words):
    assert words in change(certificate).refutation(servo)


def test_a_damaged_file_is_refused(certificate, tmp_path):
    path = tmp_path / "tube.json"
    write_certificate(certificate, str(path))
    data = json.loads(path.read_text(encoding="utf-8"))
    data["boxes"][0]["sets"][0]["centre"][0] = "1/3"
    path.write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(CertificateError, match="seal"):
        read_certificate(str(path))
    data.pop("seal")
    data["boxes"][0]["sets"][0]["centre"][0] = "much"
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


def test_a_file_nested_without_end_is_refused_in_a_sentence(tmp_path):
    path = tmp_path / "deep.json"
    for depth in range(940, 1000):  # where first the seal, then already the reader gives up
        nested = f"{'[' * depth}{']' * depth}"
        path.write_text(f'{{"format": "fuzzyarm-tube 3", "deep": {nested}}}', encoding="utf-8")
        with pytest.raises(CertificateError, match=r"is damaged|is not JSON"):
            read_certificate(str(path))


def test_halvings_that_are_all_of_the_starts():
    assert _is_all(((),))
    assert _is_all((((0, False),), ((0, True), (1, False)), ((0, True), (1, True))))
    for paths in (
        (),
        (((0, False),),),
        (((0, False),), ((1, True),)),
        (((0, False),), ((0, True), (1, False))),
        ((), ((0, True),)),
    ):
        assert not _is_all(paths), paths


def test_a_set_that_is_too_small_is_not_led_into(servo):
    loop = TubeLoop(problem_of(servo, read_claim(CLAIM)))
    own = TubeSet(
        (Fraction(1, 100), Fraction(0), Fraction(0)),
        tuple(tuple(Fraction(1000 * (i == j)) for j in range(3)) for i in range(3)),
    )
    step = loop.period(own, first=False)
    centre = tuple(x.middle for x in step.centre)
    wide = [
        sum(x.size for x in row) + y.radius for row, y in zip(step.spread, step.centre, strict=True)
    ]
    for share, expected in ((Fraction(1001, 1000), True), (Fraction(99, 100), False)):
        rows = tuple(
            tuple(Fraction(i == j) / (share * w) for j in range(3)) for i, w in enumerate(wide)
        )
        assert leads_into(step, TubeSet(centre, rows)) == expected


def test_sets_for_a_time_prove_no_stability(servo, certificate):
    """An unstable loop may keep a claim for three periods."""
    forged = replace(certificate, claim=replace(certificate.claim, stable=True))
    verdict = check_certificate(forged, servo)
    assert not verdict.proved
    assert "do not show that the loop is stable" in verdict.reason
    with pytest.raises(ValueError, match="does not show that a loop is stable"):
        certify_tube(servo, forged.claim)
