"""Sectors, slopes at a point, and the static part of controllers, against what they compute."""

from __future__ import annotations

import dataclasses
import json
import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import fuzzyarm
from fuzzyarm.apps.cli.main import main
from fuzzyarm.apps.show.figures.panels import chart_figure
from fuzzyarm.apps.show.proofs import drive_lines
from fuzzyarm.apps.show.sector import controller_sectors, rulebase_sectors, sector_chart
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.plant import find_plant
from fuzzyarm.proof.map import NoSectorError, Prover, UnprovableError, sector, slopes_at
from fuzzyarm.proof.map.controllers import DriveProof, prove_drives
from fuzzyarm.proof.map.sector import form_text

RULES = """rulebase r
input e -1 .. 1
input ce -1 .. 1
output u -1 .. 1
terms e, ce: triangles N Z P
terms u: singletons NB NS Z PS PB
inference and product, aggregation sum, defuzzifier weighted-average, no-rule error
rules u
  e \\ ce  N   Z   P
  N       NB  NS  Z
  Z       {}  Z   {}
  P       Z   PS  PB
"""


@pytest.fixture(scope="module")
def pd7() -> RuleBase:
    return fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))


@pytest.fixture(scope="module")
def servo() -> ControllerText:
    return fuzzyarm.load(fuzzyarm.shipped("servo.frb"))


@pytest.fixture(scope="module")
def voltage(servo: ControllerText) -> DriveProof:
    (drive,) = prove_drives(servo)
    return drive


def controller(folder: Path, lines: str, head: str = "") -> ControllerText:
    """A controller of the shaft, with its rule base in the same file."""
    path = folder / "c.frb"
    body = "".join(f"  {line.strip()}\n" for line in lines.strip().splitlines())
    rules = RULES.format("NS", "PS")
    path.write_text(f"{rules}\ncontroller c\nperiod 1 ms\n{head}\naxis shaft\n{body}")
    found = fuzzyarm.load(path)
    assert isinstance(found, ControllerText)
    return found


# ── rule bases ───────────────────────────────────────────────────────────────────────


@pytest.mark.slow
def test_sectors_of_pd7(pd7: RuleBase) -> None:
    prover = Prover(pd7, "u")
    along = sector(prover, {"e": 1})
    assert (along.low, along.high) == pytest.approx((2 / 3, 3 / 2), abs=1e-7)
    joint = sector(prover, {"e": 1, "ce": 1})
    assert joint.high == pytest.approx(2, abs=1e-7)
    grid = np.linspace(-6, 6, 121)
    e, ce = (x.ravel() for x in np.meshgrid(grid, grid))
    away = np.abs(e + ce) > 1e-9
    gains = np.asarray(fuzzyarm.infer(pd7, {"e": e, "ce": ce})["u"])[away] / (e + ce)[away]
    assert joint.low <= gains.min() < joint.low + 1e-3
    assert joint.high - 0.25 < gains.max() <= joint.high


def test_no_gain_bounds_what_is_not_0_with_the_sum(pd7: RuleBase) -> None:
    with pytest.raises(NoSectorError, match=r"is -?2 at e = -?4"):
        sector(Prover(pd7, "u"), {"e": 1, "ce": 2})
    tilted = parse(RULES.format("NS", "PS").replace("Z       NS  Z", "Z       NS  PS")).rulebase
    assert tilted is not None
    with pytest.raises(NoSectorError, match="e = 0, ce = 0"):
        sector(Prover(tilted, "u"), {"e": 1})


def test_a_sector_holds_up_to_the_last_bit_of_terms_at_thirds() -> None:
    balance = fuzzyarm.load(fuzzyarm.shipped("balance.frb"))
    found = sector(Prover(balance, "push"), {"lean": 1, "fall": 1})
    assert 0 < found.slack <= 1e-8
    assert (found.low, found.high) == pytest.approx((0.5, 2 / 3), abs=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_random_sectors_hold_and_are_reached(seed: int) -> None:
    """Odd rules of random numbers: no sample outside, and the ends are those of the samples."""
    draw = np.random.default_rng(seed)
    a, b = np.sort(draw.uniform(0.05, 0.95, 2)).round(2)
    lines = [f"term x z: triangle {-a} 0 {a}", "term u zero: singleton 0"]
    rules = ["rule if x is z then u is zero"]
    for i, (low, top, high) in enumerate([(0, a, b), (a, b, 1), (b, 1, 2)]):
        value = round(draw.uniform(-1, 1), 2)
        lines.append(f"term x p{i}: triangle {low} {top} {high}")
        lines.append(f"term x n{i}: triangle {-high} {-top} {-low}")
        lines.append(f"term u a{i}: singleton {value}\nterm u b{i}: singleton {-value}")
        rules.append(f"rule if x is p{i} then u is a{i}\nrule if x is n{i} then u is b{i}")
    head = ["rulebase r", "input x -1 .. 1", "output u -2 .. 2"]
    way = "inference defuzzifier weighted-average"
    text = "\n".join([*head, *lines, way, *rules])
    rulebase = parse(f"{text}\n").rulebase
    assert rulebase is not None
    found = sector(Prover(rulebase, "u"), {"x": 2})
    x = np.concatenate([np.linspace(-1, 1, 4001), [1e-7, -1e-7]])
    x = x[np.abs(x) > 1e-9]
    gains = np.asarray(fuzzyarm.infer(rulebase, {"x": x})["u"]) / (2 * x)
    assert found.low - 1e-9 <= gains.min() < found.low + 1e-2
    assert found.high - 1e-2 < gains.max() <= found.high + 1e-9


@pytest.mark.parametrize("point", [(0, 0), (2, 0), (-6, -5), (1, 1.5), (2, -2)])
def test_slopes_at_a_point_are_those_of_small_steps(
    pd7: RuleBase, point: tuple[float, float]
) -> None:
    prover = Prover(pd7, "u")
    here = dict(zip(("e", "ce"), point, strict=True))
    slopes = slopes_at(prover, here)
    assert slopes.value == prover.exactly(here)
    step = Fraction(1, 2**30)
    tried = 0
    for way in ((1, 0), (-1, 0), (0, 1), (1, 1), (-1, 2), (3, -1)):
        ahead = {name: Fraction(here[name]) + w * step for name, w in zip(here, way, strict=True)}
        found = slopes.along({name: Fraction(w) for name, w in zip(here, way, strict=True)})
        if max(map(abs, ahead.values())) > 6:
            assert found is None
            continue
        value = prover.exactly(ahead)
        assert value is not None
        assert found is not None
        assert float((value - slopes.value) / step) == pytest.approx(float(found), abs=1e-6)
        tried += 1
    assert tried >= 3


def test_a_fixed_input_is_a_stretch_of_no_width(pd7: RuleBase) -> None:
    prover = Prover(pd7, "u")
    fixed = prover.with_fixed({"ce": Fraction(5, 4)})
    assert fixed.names == ("e",)
    thin, line = prover.value({"ce": (1.25, 1.25)}), fixed.value({})
    assert (line.low, line.high) == pytest.approx((thin.low, thin.high), abs=2e-7)
    assert line.at_high["ce"] == 1.25


# ── controllers ──────────────────────────────────────────────────────────────────────


def steps(text: ControllerText, names: dict[str, np.ndarray], drive: str = "voltage") -> np.ndarray:
    """What the kernel drives in the first period, for errors of ports (measured values at 0)."""
    run = text.run(compiled=False)
    found = []
    for values in zip(*names.values(), strict=True):
        run.start()
        reference = dict.fromkeys(run.references, 0.0) | dict(zip(names, values, strict=True))
        found.append(run.step(dict.fromkeys(run.inputs, 0.0), reference)[drive])
    return np.array(found)


@pytest.mark.slow
def test_the_kernel_stays_in_what_is_proved(servo: ControllerText, voltage: DriveProof) -> None:
    draw = np.random.default_rng(0)
    for each in voltage.sectors:
        ends = {name.removeprefix("error of "): at for name, at in each.within.items()}
        points = {"position": np.zeros(400), "velocity": np.zeros(400)}
        points |= {name: draw.uniform(*at, 400) for name, at in ends.items()}
        drive = steps(servo, points)
        form = sum(w * points[name.removeprefix("error of ")] for name, w in each.weights.items())
        assert voltage.low <= drive.min()
        assert drive.max() <= voltage.high
        slack = 1e-9 + each.slack
        assert (each.low * form * form <= drive * form + slack * np.abs(form)).all()
        assert (drive * form <= each.high * form * form + slack * np.abs(form)).all()
    for name, gain in zip(("position", "velocity"), voltage.gains, strict=True):
        small = {"position": np.zeros(2), "velocity": np.zeros(2), name: np.array([-1e-7, 1e-7])}
        assert steps(servo, small) / small[name] == pytest.approx(gain.low, rel=1e-5)


def test_limits_that_are_and_are_not_reached(tmp_path: Path) -> None:
    lines = "e = error of position\nce = error of velocity\nu = rules r(e, ce) * 10"
    (never,) = prove_drives(controller(tmp_path, f"{lines}\ndrive voltage = u, within -11 .. 11"))
    assert (never.reached, never.limits) == ("never", (-11, 11))
    assert never.high == pytest.approx(10, abs=1e-6)
    (reached,) = prove_drives(controller(tmp_path, f"{lines}\ndrive voltage = u, within -9 .. 9"))
    assert (reached.reached, reached.low, reached.high) == ("yes", -9, 9)
    assert abs(reached.at["error of position"]) == 1


def test_gains_of_an_integral_over_rules_are_those_of_a_pi_law() -> None:
    heater = fuzzyarm.load(fuzzyarm.shipped("heater.frb"))
    (drive,) = prove_drives(heater)
    found = {gain.source: (gain.low, gain.unit) for gain in drive.gains}
    assert found["error of temperature"][0] == pytest.approx(0.5 * 0.4 * 100)
    assert found["integral of error of temperature"][0] == pytest.approx(0.5 * 0.4 * 0.2)
    assert found["integral of error of temperature"][1] == "%/(K s)"


def test_products_of_signals_zooms_limits_and_signs(tmp_path: Path) -> None:
    """A drive with all of them: the kernel is nowhere outside the sector."""
    text = controller(
        tmp_path,
        """e = error of position * 2
        ce = error of velocity
        zoom e, ce by 1.5 inside 0.5
        a = rules r(ce, e)
        u = rules r(e, ce) * boost
        drive voltage = 0 - u * 8 - u * a * 2, within -5 .. 5""",
        'gain boost = 1.25 "1"',
    )
    (drive,) = prove_drives(text)
    assert drive.gains[0].low == pytest.approx(-8 * 1.25 * 0.5 * 2 * 1.5)
    (inner,) = [each for each in drive.sectors if list(each.weights) == ["error of position"]][:1]
    ends = inner.within["error of position"]
    error = np.linspace(max(-1.0, ends[0]), min(1.0, ends[1]), 301)
    error = error[np.abs(error) > 1e-6]
    found = steps(text, {"position": error, "velocity": np.zeros(len(error))})
    assert inner.low - 1e-9 <= (found / error).min()
    assert (found / error).max() <= inner.high + 1e-9
    assert inner.high < 2


def test_tables_along_one_input(tmp_path: Path) -> None:
    table = fuzzyarm.compile_table(parse(RULES.format("NS", "PS")).rulebase, levels=9)
    lines = "e = error of position\nce = error of velocity\nu = table t(e, ce)\ndrive voltage = u"
    for mode in ("linear", "nearest"):
        fuzzyarm.write_table(dataclasses.replace(table, mode=mode), tmp_path / "t.lut")
        found = controller(tmp_path, lines, 'use t from "t.lut"')
        used = found.sheets["t"][0].default_mode  # type: ignore[union-attr]
        assert used == mode
        (drive,) = prove_drives(found)
        along = drive.sectors[0]
        low, high = along.within["error of position"]
        error = np.linspace(low, high, 801)
        error = error[np.abs(error) > 1e-6]
        values = np.asarray(table.lookup(error, 0 * error, mode=used))
        assert along.low <= (values / error).min() < along.low + 1e-2
        assert along.high - 1e-2 < (values / error).max() <= along.high


@pytest.mark.slow
def test_what_is_not_proved_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fuzzyarm.proof.map.walk.BOXES_SECONDS", 0.1)
    words = {
        "stfc.frb": "sampled",
        "soc-zero.frb": "learns",
        "cdid+fuzzy.frb": "a law of its own",
        "tanks.frb": "at a limit at rest",
    }
    for name, word in words.items():
        drives = prove_drives(fuzzyarm.load(fuzzyarm.shipped(name)))
        assert any(word in reason for each in drives for reason in each.open), name
        assert not any(each.sectors for each in drives if each.open)


def test_without_time_the_range_of_the_output_is_left(servo: ControllerText) -> None:
    (drive,) = prove_drives(servo, budget=1e-9)
    assert (drive.low, drive.high) == (-24, 24)
    assert drive.free == pytest.approx((-27, 27))
    assert any("time ran out" in reason for reason in drive.open)
    assert drive.sectors == ()


@pytest.mark.slow
def test_pictures_show_what_is_proved(
    pd7: RuleBase, servo: ControllerText, voltage: DriveProof
) -> None:
    found = [sector(Prover(pd7, "u"), {"e": 1}), sector(Prover(pd7, "u"), {"e": 1, "ce": 1})]
    pictures = [
        *rulebase_sectors(pd7, "u", found),
        *controller_sectors(servo, [voltage], points=300),
    ]
    assert [each.one for each in pictures] == [True, False, True, True, False]
    for each in pictures:
        both = each.values * each.form
        assert (each.low * each.form**2 <= both + 1e-6).all()
        assert (both <= each.high * each.form**2 + 1e-6).all()
    assert len(chart_figure(sector_chart(pictures[:2])).axes) == 2


@pytest.mark.slow
def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rules = str(fuzzyarm.shipped("pd7.frb"))
    assert main(["prove", rules, "--sector", "--along", "e=1,ce=2", "--json"]) == 4
    data = json.loads(capsys.readouterr().out)
    assert data["sectors"] == []
    assert "u" not in data["open"][0].split()[1:2]
    path = str(fuzzyarm.shipped("heater.frb"))
    picture = tmp_path / "s.svg"
    assert main(["prove", path, "--sector", "--plot", str(picture), "--json"]) == 0
    (drive,) = json.loads(capsys.readouterr().out)
    assert drive["drive"] == "room.power"
    assert [each["low"] for each in drive["sectors"]] == [1.0]
    assert picture.read_text().startswith("<?xml")
    for words in (["--plot", "x.png"], ["--sector", "--plot", "x.gif"], ["--along", "e=1"]):
        assert main(["prove", rules, *words]) == 2
    assert main(["prove", path, "--sector", "--along", "e=1"]) == 2
    with pytest.raises(UnprovableError, match="weight"):
        sector(Prover(fuzzyarm.load(rules), "u"), {})


HOLE = """rulebase nr
input e -1 .. 1
output d -1 .. 1
term e N: triangle -1 -0.6 -0.2
term e P: triangle 0.2 0.6 1
terms d: singletons A B
inference d: defuzzifier weighted-average{silence}
rule if e is N then d is A
rule if e is P then d is B
prove d in -1 .. 1
"""
AROUND_HOLE = """controller nrc
use nr from "nr.frb"
period 1 s
axis shaft
  e = error of position
  d = rules nr(e)
  i = {source}
  drive voltage = {drive}, within -5 .. 5
"""


@pytest.mark.parametrize(
    ("silence", "line", "bounded"),
    [("", 1, 4), (", no-rule nan", 1, 4), (", no-rule hold", 4, 4), (", no-rule 0", 0, 0)],
)
def test_no_range_is_proved_over_a_hole(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], silence: str, line: int, bounded: int
) -> None:
    path = tmp_path / "nr.frb"
    path.write_text(HOLE.format(silence=silence))
    assert main(["prove", str(path)]) == line
    assert ("no rule fires at e = 0" in capsys.readouterr().out) == bool(line)
    assert main(["prove", str(path), "--range"]) == bounded
    text = capsys.readouterr().out
    assert ("(proved)" in text) != bool(bounded)
    assert ("not proved: no rule fires at e = 0" in text) == bool(bounded)
    assert main(["prove", str(path), "--range", "--json"]) == bounded
    assert bool(json.loads(capsys.readouterr().out)["hole"]) == bool(bounded)


def test_a_hole_between_curved_terms_is_found_at_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Bounds of a curve stay above 0 there by their rounding; inference says that it is 0."""
    path = tmp_path / "curved.frb"
    terms = ("triangle -1 -0.6 -0.2", "triangle 0.2 0.6 1")
    text = HOLE.format(silence="")
    assert all(term in text for term in terms)
    for term, curve in zip(terms, ("pi -1 -0.8 -0.5 -0.2", "pi 0.2 0.5 0.8 1"), strict=True):
        text = text.replace(term, curve)
    path.write_text(text)
    assert main(["prove", str(path), "--range"]) == 4
    assert "not proved: no rule fires at e = 0" in capsys.readouterr().out


@pytest.mark.parametrize(("silence", "proved"), [("", False), (", no-rule 0", True)])
@pytest.mark.parametrize(
    ("source", "drive"),
    [
        ("d * 2", "d * 10 + e"),
        ("d * 2", "i"),
        ("d * e", "i"),
        ("lag of d, time 2 s", "i"),
        ("deadband of d, width 0.1", "e - i"),
    ],
)
def test_no_drive_is_proved_that_may_not_be_a_number(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    silence: str,
    proved: bool,
    source: str,
    drive: str,
) -> None:
    (tmp_path / "nr.frb").write_text(HOLE.format(silence=silence))
    path = tmp_path / "nrc.frb"
    path.write_text(AROUND_HOLE.format(source=source, drive=drive))
    (proof,) = prove_drives(fuzzyarm.load(path))
    assert ("no rule fires at e = 0" in proof.hole) != proved
    assert main(["prove", str(path), "--sector"]) == (0 if proved else 4)
    assert ("(proved)" in capsys.readouterr().out) == proved


OF_ANOTHER_AXIS = """controller c
use r from "r.frb"
period 50 ms
gain big = 1
axis outer
  e = error of y
  s = e * e
  m = s * -1
  z = s + m
  k = big where z > 5 else 0.1
axis inner
  d = MORE
  drive u = d, within -0.5 .. 0.5
"""


@pytest.mark.parametrize(
    ("more", "reached"),
    [("outer.k * 1", "open"), ("outer.k + 2", "yes"), ("rules r(outer.k, outer.e)", "open")],
)
def test_a_drive_of_signals_of_another_axis_has_a_report(tmp_path, more, reached):
    """The first is 0.1 always: the middle of what is known of it was taken for a value."""
    (tmp_path / "r.frb").write_text(RULES.format("NS", "PS"))
    (tmp_path / "c.frb").write_text(OF_ANOTHER_AXIS.replace("MORE", more))
    (tmp_path / "p.py").write_text(
        "from fuzzyarm.plant import Plant, Port\nclass P(Plant):\n    axis = 'inner'\n"
        "    inputs = {'u': Port('V')}\n    outputs = {'y': Port('m', -2, 2)}\n"
        "    states = {'y': 'm'}\n    def derivative(self, t, x, u, p):\n        return [u[0]]\n"
    )
    controller = fuzzyarm.load_controller(tmp_path / "c.frb")
    (drive,) = prove_drives(controller, find_plant(f"{tmp_path / 'p.py'}:P"))
    assert drive.reached == reached


@pytest.mark.parametrize("weight", [1, -1, 0.1, 1 / 3, 1.5, Fraction(4, 3), Fraction(-22, 7)])
def test_the_weights_of_a_sum_read_back(weight: float | Fraction) -> None:
    """At seven digits u is not 0 where the sum is: no gain would bound it."""
    text = form_text({"e": 1, "ce": weight})
    sign, *number = text.removeprefix("e ").removesuffix("ce").split()
    size = number[0] if number else "1"
    read = Fraction(size) if "/" in size else Fraction(float(size))
    assert (read if sign == "+" else -read) == Fraction(weight)


@pytest.mark.slow
def test_a_sector_of_a_drive_is_told_of_no_more_than_it_holds_on() -> None:
    (drive,) = prove_drives(fuzzyarm.load_controller(fuzzyarm.shipped("servo.frb")))
    told = "\n".join(drive_lines("servo.frb", drive, ["voltage"], sectors_only=True))
    for along in drive.sectors:
        for name, (low, high) in along.within.items():
            words = re.findall(rf"{name} in (\S+) \.\. ([^:\s]+)", told)
            assert any(low <= float(a) < float(b) <= high for a, b in words), (name, words)
            assert not any(high < float(b) < 1.001 * high for _, b in words)
