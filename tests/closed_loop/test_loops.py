"""Claims about loops: what is proved, what must never be, and runs that try to refute it."""

import json
import math
import re
from dataclasses import replace
from fractions import Fraction
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest
from budget import cases, part

from fuzzyarm import load, prove, shipped, simulate
from fuzzyarm.control.controllers import ControllerText
from fuzzyarm.control.loop import Sensor
from fuzzyarm.language import parse
from fuzzyarm.language.model.controller import Amount
from fuzzyarm.plant import Parameter, Plant, Port, find_plant
from fuzzyarm.plant.own import starting_at
from fuzzyarm.plant.plant import with_actuators
from fuzzyarm.proof.check import check_certificate
from fuzzyarm.proof.check.certificate import sealed
from fuzzyarm.proof.check.loop import checked_loop
from fuzzyarm.proof.check.numbers import exact, is_positive_definite
from fuzzyarm.proof.check.region import port_within, refutation, start_vertices, verified
from fuzzyarm.proof.claim.text import problem_of
from fuzzyarm.proof.loop import (
    CertificateError,
    LoopProofError,
    prove_loop,
    read_certificate,
    read_claim,
    write_certificate,
)
from fuzzyarm.proof.loop.form import Form
from fuzzyarm.proof.loop.linear import candidate
from fuzzyarm.proof.loop.pictures import region_planes


@pytest.fixture(scope="module")
def heater():
    return load(shipped("heater.frb"))


@pytest.fixture(scope="module")
def heater_verdict(heater):
    return prove(heater, "stable at temperature = 21", plant="room")


class Double(Plant):
    """A mass without friction: force to position."""

    name = "mass"
    inputs = {"force": Port("N")}
    outputs = {"x": Port("m", -1.0, 1.0), "v": Port("m/s", -1.0, 1.0, rate_of="x")}
    states = {"x": "m", "v": "m/s"}
    parameters = {"m": Parameter(1.0, "kg")}

    def derivative(self, t, x, u, p):
        return [x[1], u[0] / p[0]]


def pd(gain, period="100 ms"):
    """A linear law, which has a limit that is known exactly."""
    return load_text(
        f"""controller pd
period {period}
gain K = {gain}
axis mass
  e = error of x
  d = error of v
  u = e * K + d * K
  drive force = u
"""
    )


def load_text(text):
    """Return a controller from its text."""
    parsed = parse(text)
    assert parsed.controller is not None, parsed.diagnostics
    return ControllerText(parsed.controller)


def gains(text, **values):
    """Return a controller with other gains."""
    model = text.model
    changed = tuple(
        replace(g, values=(Amount(((values[g.name], False),)),)) if g.name in values else g
        for g in model.gains
    )
    return replace(text, model=replace(model, gains=changed), source="")


# ── what is proved ───────────────────────────────────────────────────────────────────


@pytest.mark.slow
def test_the_servo_is_stable_from_a_large_region(servo_verdict):
    assert servo_verdict.proved
    assert not servo_verdict.continuous
    position, velocity, current = (high for _, high in servo_verdict.region.values())
    assert position > 0.3087
    assert velocity > 8.57
    assert current > 73.9


def test_along_one_state_alone_a_start_reaches_the_border(servo_verdict):
    certificate = servo_verdict.certificate.region
    for k, name in enumerate(certificate.states):  # V = pₖₖ x² there, around a rest of 0
        assert servo_verdict.start_region[name] ** 2 * certificate.p[k][k] == pytest.approx(1.0)
        assert servo_verdict.start_region[name] > 0.0


def test_the_servo_in_continuous_time(servo):
    verdict = prove(servo, "stable", plant="motor", continuous=True)
    assert verdict.proved
    assert verdict.continuous
    assert verdict.region["position"][1] > 0.3087


@pytest.mark.slow
@pytest.mark.parametrize(
    ("statement", "expected"),
    [
        ("from position in -0.3 .. 0.3: position in -0.35 .. 0.35", "proved"),
        ("from position in -0.3 .. 0.3: position in -0.25 .. 0.25", "refuted"),
        ("from position in -0.3 .. 0.3: position in -0.01 .. 0.01 after 1 s", "proved"),
        ("from position in -0.3 .. 0.3: position in -0.01 .. 0.01 after 50 ms", "refuted"),
        ("at position = 0.1 from position in 0 .. 0.2: position in -0.05 .. 0.25", "proved"),
    ],
)
def test_where_a_start_goes(servo, statement, expected):
    verdict = prove(servo, statement, plant="motor")
    assert verdict.verdict == expected, str(verdict)
    assert bool(verdict.evidence) == (expected == "refuted")
    assert (verdict.certificate is not None) == (expected == "proved")


def test_the_corners_of_a_start_are_those_of_its_intervals():
    names = [f"x{i}" for i in range(14)]
    loop = SimpleNamespace(names=names, rest=dict.fromkeys(names, exact(1)), seeds={}, begin={})

    def corners(intervals):
        ends = [SimpleNamespace(low=0.5, high=0.5 + (i < intervals)) for i in range(14)]
        start = dict(zip(names, ends, strict=True))
        return start_vertices(SimpleNamespace(states=names, start=start), loop)

    point = (exact(-0.5),) * 14
    assert corners(0) == [list(point)]
    ends = [exact(-0.5), exact(0.5)]
    assert set(map(tuple, corners(2))) == {(x, y, *point[2:]) for x, y in product(ends, ends)}
    assert len(corners(12)) == 2**12
    with pytest.raises(LoopProofError, match="more than 12 intervals"):
        corners(13)


def test_a_drive_is_bounded_over_the_region(servo, servo_verdict):
    """Runs from its border come towards the bound, and none beyond it."""
    claim, certificate = servo_verdict.certificate.claim, servo_verdict.certificate.region
    problem = problem_of(servo, claim)
    against, _, loop = verified(problem, claim, certificate)
    assert not against
    for level in (exact(1), exact(1 / 64)):
        bound = port_within(problem, loop, certificate.p, level, "voltage")
        share, most = np.sqrt(float(level)), 0.0
        root = np.linalg.inv(np.linalg.cholesky(np.array(certificate.p, dtype=float))).T
        (row, *_) = loop.rows_of_drive(problem.site.interface.port("voltage"))
        ahead = np.array(row, dtype=float) @ root
        generator = np.random.default_rng(3)
        for way in (ahead, *generator.standard_normal((5, len(root)))):
            at = starting_at(find_plant("motor"), share * root @ way / np.linalg.norm(way) * 0.999)
            run = simulate(servo, at, reference={"position": 0.0}, duration=0.02)
            most = max(most, np.abs(run.drives["voltage"]).max())
        assert 0.3 * float(bound[1]) < most <= float(bound[1]) <= 24.0
        assert float(bound[0]) == pytest.approx(-float(bound[1]), rel=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("statement", "expected"),
    [
        ("stable on motor: voltage in -24 .. 24", "proved"),
        ("on motor from position in -0.01 .. 0.01: voltage in -3 .. 3", "proved"),
        ("on motor from position in -0.1 .. 0.1: voltage in -1 .. 1", "refuted"),
        ("stable on motor: voltage in 1 .. 2", "refuted"),
    ],
)
def test_a_claim_about_a_drive(servo, statement, expected):
    verdict = prove(servo, statement, plant="motor")
    assert verdict.verdict == expected, str(verdict)
    if verdict.certificate is not None:
        assert check_certificate(verdict.certificate).proved
        narrow = replace(verdict.certificate.claim, low=-1e-3, high=1e-3)
        widened = replace(narrow, start=(("position", -0.01, 0.01),))
        assert not check_certificate(replace(verdict.certificate, claim=widened)).proved


@pytest.mark.slow
def test_integral_filter_slew_and_bounds_of_the_heater(heater_verdict):
    assert heater_verdict.proved
    assert heater_verdict.rest["room.power total"] == pytest.approx(44.5714285714)
    assert heater_verdict.region["temperature"][1] - 21.0 > 3.0
    assert check_certificate(heater_verdict.certificate).proved


THERMOSTAT = """
rulebase thermostat
input  T 15 .. 27
output power 0 .. 100
terms T, power: triangles A B C D E
inference power: aggregation sum, defuzzifier weighted-average
rule if T is A then power is E
rule if T is B then power is D
rule if T is C then power is C
rule if T is D then power is B
rule if T is E then power is A

controller heating
period 10 s
axis room
  T = measured temperature
  power = rules thermostat(T)
  drive power = power, within 0 .. 100
"""


@pytest.mark.slow
@pytest.mark.parametrize("sensors", [{}, {"temperature": Sensor(delay=20.0)}], ids=["", "late"])
def test_rules_of_a_measured_value_rest_where_it_is_not_0(tmp_path, sensors):
    path = tmp_path / "heating.frb"
    path.write_text(THERMOSTAT)
    verdict = prove(path, "stable", plant="room", sensors=sensors)
    assert verdict.proved, str(verdict)
    run = simulate(path, "room", duration=96 * 3600.0)
    assert verdict.rest["temperature"] == pytest.approx(run.outputs["temperature"][-1], abs=1e-3)
    assert check_certificate(verdict.certificate).proved


# ── what attacks it ──────────────────────────────────────────────────────────────────


def runs_from(verdict, text, plant, count, duration):
    """Yield V along runs that begin in the region of a loop without memory, in all samples."""
    p = np.array([[float(x) for x in row] for row in verdict.certificate.region.p])
    rest = np.array(list(verdict.rest.values()))
    names = list(verdict.region)
    root = np.linalg.inv(np.linalg.cholesky(p)).T
    generator = np.random.default_rng(1)
    for k in range(count):
        way = generator.standard_normal(len(p))
        # Most of them at the border of the region, where a mistake would show.
        way *= (1.0 if k % 4 else generator.uniform()) / np.linalg.norm(way)
        at = starting_at(find_plant(plant), rest + root @ way)
        zero = {next(iter(at.outputs)): 0.0}
        run = simulate(text, at, reference=zero, duration=duration)
        assert run.diverged is None
        z = np.array([run.outputs[name] for name in names]).T - rest
        yield np.einsum("ki,ij,kj->k", z, p, z)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "plant", "duration", "few"),
    part(
        [
            ("servo", "motor", 0.15, 20),
            pytest.param("cartpole", "cartpole", 4.0, 10, marks=pytest.mark.slow),
            pytest.param("ball-and-beam", "ball-and-beam", 4.0, 10, marks=pytest.mark.slow),
        ],
        2,
    ),
)
def test_no_run_leaves_a_proved_region(file, plant, duration, few):
    text = load(shipped(f"{file}.frb"))
    verdict = prove(text, "stable", plant=plant, budget=60)
    assert verdict.proved, str(verdict)
    for values in runs_from(verdict, text, plant, cases(few, 33_000), duration):
        assert values[0] <= 1.0 + 1e-9
        # It falls in every period; near rest rounding counts.
        assert (np.diff(values) <= 1e-12).all()
        assert values[-1] < 0.999 * values[0]


@pytest.mark.slow
def test_what_a_certificate_says_of_a_plant_that_is_not_linear_holds_all_over_its_box():
    text = load(shipped("cartpole.frb"))
    certificate = prove(text, "stable", plant="cartpole", budget=60).certificate
    problem, evidence = problem_of(text, certificate.claim), certificate.region.evidence
    states = certificate.region.states
    checked_loop(problem, states, evidence)
    assert len(evidence.spread) > 10
    for i, (k, j, low, high) in enumerate(evidence.spread):
        part = (high - low) / 4
        for ends in ((low + part, high), (low, high - part)):
            spread = (*evidence.spread[:i], (k, j, *ends), *evidence.spread[i + 1 :])
            with pytest.raises(LoopProofError, match="motion is not as it is claimed"):
                checked_loop(problem, states, replace(evidence, spread=spread))


BY_AXIS = """rulebase by_axis
input e -1 .. 1
input joint -3 .. 3
output u -1 .. 1
terms e: triangles N Z P
term joint FIRST: trapezoid 0 0.5 inf inf
term joint OTHER: trapezoid -inf -inf -0.5 0
terms u: singletons N Z P
inference and min, defuzzifier weighted-average, aggregation sum
rule if e is Z then u is Z
rule if e is N and joint is FIRST then u is N
rule if e is P and joint is FIRST then u is P
rule if e is N and joint is OTHER then u is P
rule if e is P and joint is OTHER then u is N
"""


@pytest.mark.parametrize(("word", "proved"), [("FIRST", True), ("OTHER", False)])
def test_a_rule_base_that_reads_the_axis_is_that_of_its_axis(tmp_path, word, proved):
    swapped = {"FIRST": "OTHER", "OTHER": "FIRST"}
    text = re.sub(r"(joint is )(\w+)", lambda m: m[1] + swapped[m[2]], BY_AXIS)
    (tmp_path / "by_axis.frb").write_text(BY_AXIS if word == "FIRST" else text)
    (tmp_path / "c.frb").write_text(
        'controller c\nuse by_axis from "by_axis.frb"\nperiod 10 ms\naxis mass\n'
        "  e = error of x\n  d = error of v\n  s = e * 0.5 + d * 0.5\n"
        "  w = rules by_axis(s) * 2\n  drive force = w\n"
    )
    verdict = prove(load(tmp_path / "c.frb"), "stable", plant=Double(), budget=5)
    assert verdict.proved is proved


def far_gains(gain):
    return gains(load(shipped("servo.frb")), **gain)


def every(period):
    servo = load(shipped("servo.frb"))
    return replace(servo, model=replace(servo.model, period=period))


def late(delay):
    return dict.fromkeys(("position", "velocity"), Sensor(delay=delay))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "text", "options"),
    [
        ("no damping", lambda: far_gains({"G_e": 400.0, "G_ce": 0.0001}), {}),
        ("delay", lambda: every(0.005), {"sensors": late(0.05)}),
    ],
)
def test_an_unstable_loop_is_never_proved(name, text, options):
    verdict = prove(text(), "stable", plant="motor", budget=1, **options)
    assert not verdict.proved, name


@pytest.mark.parametrize(
    ("file", "plant", "claim"),
    [
        ("tanks", "tanks", "stable at level2 = 0.2"),  # rests where level1 is not 0
        ("heater", "room", "stable at temperature = 21"),  # its integral begins far from rest
    ],
)
def test_a_loop_that_is_not_next_to_its_rest_is_not_refuted(file, plant, claim):
    verdict = prove(load(shipped(f"{file}.frb")), claim, plant=plant, budget=1e-9)
    assert verdict.verdict == "undecided"
    assert verdict.reason


@pytest.mark.slow
@pytest.mark.parametrize("name", ["sign", "slow"])
def test_a_loop_that_leaves_its_rest_is_refuted(name):
    text = far_gains({"G_u": -4.5}) if name == "sign" else every(0.08)
    verdict = prove(text, "stable", plant="motor")
    assert verdict.verdict == "refuted", str(verdict)
    assert verdict.evidence[0].startswith("next to rest a deviation grows")


@pytest.mark.slow
def test_a_delay_that_the_loop_bears_is_proved(servo):
    verdict = prove(servo, "stable", plant="motor", sensors=late(0.001))
    assert verdict.proved
    assert "shaft.position late 1" in verdict.region


@pytest.mark.slow
def test_a_drive_that_is_pending_is_within_the_limits_of_its_actuator(servo):
    plant = with_actuators(find_plant("motor"), {}, {"voltage": 0.002})
    verdict = prove(servo, "stable", plant=plant)
    assert verdict.proved
    pending = [verdict.region[f"shaft.voltage pending {k}"] for k in (1, 2)]
    assert pending == [(-24.0, 24.0)] * 2


def test_a_sensor_with_steps_is_not_proved_to_come_to_rest(servo):
    verdict = prove(servo, "stable", plant="motor", sensors={"position": Sensor(resolution=0.01)})
    assert verdict.verdict == "undecided"
    assert "steps" in verdict.reason


# ── results that are known ───────────────────────────────────────────────────────────


@pytest.mark.slow
def test_the_limit_of_a_linear_loop_is_found():
    # With the force held over h the mass under u = -K (x + v) has the characteristic polynomial
    # z² + (K h²/2 + K h - 2) z + 1 + K h²/2 - K h: Jury's condition at z = -1 gives K < 2 / h.
    h = 0.1
    limit = 2.0 / h
    for share, proved in ((0.05, True), (0.99, True), (1.01, False), (2.0, False)):
        text = pd(share * limit)
        assert prove(text, "stable", plant=Double()).proved == proved, share


def test_the_circle_criterion_of_a_lure_system():
    # 4 / ((s + 1)(s/2 + 1)(s/3 + 1)) with a gain in [0, k] is stable, says the circle criterion,
    # where the real part of its frequency response is above -1/k.
    a = [[0, 1, 0], [0, 0, 1], [-6, -11, -6]]
    b, c = [0, 0, 1], [24, 0, 0]
    s = 1j * np.geomspace(1e-3, 1e3, 200_001)
    least = float((24.0 / ((s + 1) * (s + 2) * (s + 3))).real.min())
    assert -1.0 / least == pytest.approx(1.166, abs=2e-3)
    for share, expected in ((0.99, True), (1.01, False)):
        half = Fraction(-0.5 * share / least)
        form = lure(a, b, c, half)
        found = candidate(form)
        assert (found is not None) == expected
        if found is not None:
            assert refutation(form.system, found.p, found.multipliers) == ""


def lure(a, b, c, half):
    """x' = A x - b w, w = k c x with k in 0 .. 2 half, as the middle of it and a block."""
    rows = [[Fraction(x) for x in row] for row in a]
    for i in range(3):
        for j in range(3):
            rows[i][j] -= half * b[i] * c[j]
    zero = tuple((Fraction(0),) * 4 for _ in range(3))
    names = ("x1", "x2", "x3")
    return Form(
        names, dict.fromkeys(names, Fraction(0)), tuple(map(tuple, rows)),
        tuple((Fraction(-x),) for x in b), zero,
        ((*(half * x for x in c), Fraction(0)),), ("a gain",), (), {}, {}, 0.0,
    )  # fmt: skip


def test_positive_definite_matrices():
    generator = np.random.default_rng(2)
    for _ in range(cases(30, 1000)):
        root = generator.integers(-5, 6, (4, 4))
        matrix = root @ root.T
        as_rationals = [[exact(int(x)) for x in row] for row in matrix]
        positive = round(np.linalg.det(matrix)) > 0
        assert is_positive_definite(as_rationals) == positive
    nearly = [[exact(1), exact(1)], [exact(1), exact(1 + Fraction(1, 10**30))]]
    assert is_positive_definite(nearly)
    nearly[1][1] = exact(1 - Fraction(1, 10**30))
    assert not is_positive_definite(nearly)


# ── plants that are refused ──────────────────────────────────────────────────────────


class Driven(Double):
    """It is pushed by something that depends on the time."""

    def derivative(self, t, x, u, p):
        return [x[1], u[0] / p[0] + 0.1 * t]


class Sticking(Double):
    """Dry friction: it jumps where the velocity changes its sign."""

    def derivative(self, t, x, u, p):
        from fuzzyarm import op

        return [x[1], u[0] - 0.1 * op.where(x[1] > 0, 1.0, -1.0)]


class Stepped(Double):
    """It has a step of its own."""

    derivative = None

    def step(self, t, x, u, p, dt):
        return [x[0] + dt * x[1], x[1] + dt * u[0]]


@pytest.mark.parametrize(
    ("plant", "words"), [(Driven, "depend on the time"), (Sticking, ""), (Stepped, "traced")]
)
def test_a_plant_of_which_nothing_is_known_is_refused(plant, words):
    verdict = prove(pd(1.0), "stable", plant=plant())
    assert verdict.verdict != "proved"
    assert words in verdict.reason or verdict.evidence


# ── certificates ─────────────────────────────────────────────────────────────────────


@pytest.fixture
def written(servo_verdict, tmp_path):
    path = str(tmp_path / "servo.json")
    write_certificate(servo_verdict.certificate, path)
    return path


def test_a_certificate_is_what_was_written(servo_verdict, written):
    assert read_certificate(written) == servo_verdict.certificate
    assert check_certificate(written).proved


def test_a_certificate_keeps_the_sensors_and_connections_of_its_loop(servo_verdict, tmp_path):
    sensors = {
        "shaft.position": Sensor(delay=0.001), "shaft.velocity": Sensor(difference=0.02),
    }  # fmt: skip
    certificate = replace(
        servo_verdict.certificate, sensors=sensors, connect={"position": "shaft.position"}
    )
    path = str(tmp_path / "other.json")
    write_certificate(certificate, path)
    assert read_certificate(path) == certificate


def numbers_in(data, path=()):
    """Yield where in a certificate numbers of the proof stand."""
    for key, value in data.items() if isinstance(data, dict) else enumerate(data):
        if isinstance(value, dict | list):
            yield from numbers_in(value, (*path, key))
        elif isinstance(value, str) and path[2:3] in (("p",), ("multipliers",), ("loop",)):
            yield (*path, key)


@pytest.mark.slow
def test_a_certificate_that_is_damaged_in_one_number_is_rejected(servo, servo_verdict, written):
    with open(written, encoding="utf-8") as file:
        whole = file.read()
    problem = problem_of(servo, servo_verdict.certificate.claim)
    places = list(numbers_in(json.loads(whole)))
    assert len(places) > 10
    for place in part(places, 3):
        data = json.loads(whole)
        inner = data
        for key in place[:-1]:
            inner = inner[key]
        inner[place[-1]] = str(Fraction(inner[place[-1]]) * Fraction(13, 10) + 1)
        with open(written, "w", encoding="utf-8") as file:
            json.dump(data, file)
        with pytest.raises(CertificateError, match="seal"):  # as it stands
            read_certificate(written)
        if place[2:] == ("multipliers", 1):
            continue  # any large enough number will do for a limit that is hardly touched
        data.pop("seal")
        with open(written, "w", encoding="utf-8") as file:
            json.dump(sealed(data), file)  # by somebody who knows how
        try:
            damaged = read_certificate(written)
            against, *_ = verified(problem, damaged.claim, damaged.region)
        except CertificateError as error:
            against = str(error)
        assert against, place


def places_in(data, path=()):
    """Yield where anything stands in a certificate, without its seal."""
    for key, value in data.items() if isinstance(data, dict) else enumerate(data):
        yield (*path, key)
        if isinstance(value, dict | list):
            yield from places_in(value, (*path, key))


@pytest.mark.slow
def test_each_field_of_another_kind_is_refused_in_a_sentence(servo_verdict, tmp_path):
    data = servo_verdict.certificate.as_data()
    del data["seal"]
    whole, path = json.dumps(data), tmp_path / "c.json"
    wrong = (None, True, 7, 0.5, math.inf, "x", "1/0", "1e9", "9" * 400, [], [None], {}, {"a": 1})
    refused = 0
    for place in places_in(data):
        for value in (*wrong, ...):  # the last one: it is not there
            part = damaged = json.loads(whole)
            for key in place[:-1]:
                part = part[key]
            if value is ...:
                del part[place[-1]]
            else:
                part[place[-1]] = value
            path.write_text(json.dumps(sealed(damaged)), encoding="utf-8")
            try:
                read_certificate(str(path))
            except CertificateError as error:
                refused += 1
                said = str(error)
                another = f"{path} is of another version"
                assert said.startswith((f"{path} is not a certificate: '{place[0]}", another)), said
    assert refused > 900


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[]", "it is not an object"),
        ("3", "it is not an object"),
        ('{"a": 1', "it is not JSON at line 1"),
        ("[" * 100_000, "it is not JSON"),
        ("{}", "'format' is missing"),
        ('{"format": 3}', "'format' is not a text"),
        ('{"format": "plan 1"}', "'format' is not \"fuzzyarm-proof 2\""),
    ],
)
def test_what_is_not_a_certificate_is_refused_in_a_sentence(tmp_path, text, said):
    path = tmp_path / "c.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(CertificateError) as error:
        check_certificate(str(path))
    assert str(error.value) == f"{path} is not a certificate: {said}"


def test_a_certificate_of_another_file_is_rejected(servo_verdict, tmp_path):
    for name in ("servo.frb", "pd7.frb"):
        text = shipped(name).read_text(encoding="utf-8")
        (tmp_path / name).write_text(text.replace("G_u  = 4.5", "G_u  = 4.4"), encoding="utf-8")
    path = str(tmp_path / "servo.json")
    write_certificate(servo_verdict.certificate, path)
    with pytest.raises(CertificateError, match="not the file that was proved"):
        check_certificate(path, load(tmp_path / "servo.frb"))


@pytest.mark.slow
def test_a_certificate_of_another_controller_says_whose_it_is(servo_verdict):
    with pytest.raises(CertificateError, match=r"is of servo\.frb, not of tanks\.frb"):
        check_certificate(servo_verdict.certificate, load(shipped("tanks.frb")))


def test_a_loop_without_an_equilibrium_at_its_set_points_says_so():
    verdict = prove(load(shipped("heater.frb")), "stable", plant="room", budget=5.0)
    assert verdict.verdict == "undecided"
    assert verdict.reason.startswith("there is no equilibrium at temperature = 0: ")
    assert "`at PORT = X`" in verdict.reason


@pytest.mark.slow
def test_a_claim_without_starts_is_of_the_whole_region(servo, servo_verdict):
    """What the verdict says of the region holds from everywhere in it."""
    verdict = prove_loop(servo, read_claim("stable on motor: position in -0.1 .. 0.1"), budget=60.0)
    assert verdict.proved
    assert -0.1 <= verdict.region["position"][0] < verdict.region["position"][1] <= 0.1
    whole = servo_verdict.certificate
    for ends in (("after", 0.01), ("always", 0.0)):
        narrow = replace(
            whole.claim, output="position", low=-0.1, high=0.1, when=ends[0], begin=ends[1]
        )
        against = check_certificate(replace(whole, claim=narrow), servo)
        assert not against.proved
        assert "position stays in" in against.reason


@pytest.mark.slow
def test_a_tube_without_starts_says_from_where_it_is(servo):
    claim = read_claim("stable on motor: position in -0.001 .. 0.001 after 10 ms")
    verdict = prove_loop(servo, claim, budget=60.0)
    assert verdict.proved
    assert "position = 0, velocity = 0, current = 0" in str(verdict)


@pytest.mark.slow
def test_parameters_as_intervals_are_proved_and_checked(servo):
    verdict = prove_loop(servo, read_claim("stable on motor with J in 0.009 .. 0.011"), budget=60.0)
    assert verdict.proved
    assert verdict.region["position"][1] > 0.31


@pytest.mark.slow
def test_the_picture_of_a_loop_whose_memory_starts_alone_claims_no_starts(heater, heater_verdict):
    assert not heater_verdict.start_region
    (plane,) = region_planes(heater, heater_verdict)
    assert plane.covered is None
    assert not len(plane.start)
    assert not plane.runs
    assert len(plane.shadow)
