"""Controllers as text, one step at a time, against the same thing written in plain Python."""

import json
import math
from itertools import accumulate, pairwise
from pathlib import Path

import numpy as np
import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyarm import load, shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.control.controllers import GainError
from fuzzyarm.control.controllers.text import ControllerRun, PortError, with_files
from fuzzyarm.inference import infer
from fuzzyarm.language import RuleBaseError, format_text, parse, read_text
from fuzzyarm.symbolic.sources import SOURCES
from fuzzyarm.table import Axis, LookupTable

PERIOD = 0.01
VALUES = st.lists(st.floats(-5, 5, allow_nan=False, width=32), min_size=1, max_size=30)


def text_of(*lines, head=()):
    parts = ["controller c", "period 10 ms", *head, "axis a", *(f"  {line}" for line in lines)]
    return "\n".join(parts) + "\n"


def made(text, sheets=None):
    parsed = parse(text)
    assert parsed.controller is not None, parsed.diagnostics
    whole, faults = with_files(parsed.controller, Path.cwd(), instead=sheets or {})
    assert faults == []
    return whole


def outputs(text, values, compiled=False, sheets=None):
    """Return the drive u for a run over measured values of x, at a reference of 0."""
    run = made(text, sheets).run(compiled=compiled)
    return [run.step({"x": value}, {"x": 0.0})["u"] for value in values]


def filtered_rate(values, time):
    before, y = None, 0.0
    for value in values:
        slope = 0.0 if before is None else (value - before) / PERIOD
        before = value
        y += (slope - y) * PERIOD / (time + PERIOD)
        yield y


def lagged(values, time):
    y = None
    for value in values:
        y = value if y is None else y + (value - y) * PERIOD / (time + PERIOD)
        yield y


def integrated(values, low=-math.inf, high=math.inf, start=0.0):
    total = start
    for value in values:
        total = min(max(total + value * PERIOD, low), high)
        yield total


def held(values, limit, gain=100.0):
    """Integral that stops while its drive is at a limit and the error drives on."""
    total, excess = 0.0, 0.0
    for value in values:
        if excess / gain * value >= 0.0:
            total += value * PERIOD
        drive = min(max(gain * total, -limit), limit)
        excess = drive - gain * total
        yield drive


def drawn_back(values, limit, time, gain=100.0):
    """Integral that goes back by what of it the limit cut off, in a time of at least a period."""
    total, excess = 0.0, 0.0
    for value in values:
        total += value * PERIOD + excess / gain * PERIOD / max(time, PERIOD)
        drive = min(max(gain * total, -limit), limit)
        excess = drive - gain * total
        yield drive


def slewed(values, steepest):
    before = 0.0
    for value in values:
        before = min(max(value, before - steepest * PERIOD), before + steepest * PERIOD)
        yield before


def played(values, half):
    y = 0.0
    for value in values:
        if value - y > half:
            y = value - half
        elif y - value > half:
            y = value + half
        yield y


def delayed(values, periods):
    return [*[values[0]] * periods, *values][: len(values)]


def relayed(values, half, low, high):
    level = low
    for value in values:
        level = high if value > half else low if value < -half else level
        yield level


ORACLES = {
    "u = measured x": lambda x: x,
    "u = error of x": lambda x: [-v for v in x],
    "u = change of e": lambda x: [0.0, *(b - a for a, b in pairwise(x))],
    "u = rate of e": lambda x: filtered_rate(x, 0.0),
    "u = rate of e * 2 / 3, filter 50 ms": lambda x: [v * 2 / 3 for v in filtered_rate(x, 0.05)],
    "u = lag of e, time 0.2 s": lambda x: lagged(x, 0.2),
    "u = integral of e": integrated,
    "u = integral of e, within -0.1 .. 0.05, start 0.02": lambda x: integrated(x, -0.1, 0.05, 0.02),
    "u = deadband of e, width 3": lambda x: [max(v - 1.5, 0.0) + min(v + 1.5, 0.0) for v in x],
    "u = hysteresis of e, width 3": lambda x: played(x, 1.5),
    "u = delayed of e, time 30 ms": lambda x: delayed(x, 3),
    "u = relay of e, width 3, levels -2 .. 5": lambda x: relayed(x, 1.5, -2.0, 5.0),
    "u = sum of error of x": lambda x: accumulate(-v for v in x),
    "u = e * 2 - 3 * e / 4 + 1": lambda x: [v * 2 - 3 * v / 4 + 1 for v in x],
    "u = -e": lambda x: [-v for v in x],
    "u = e * -30 + e / -4": lambda x: [-30 * v - v / 4 for v in x],
    "u = lag of e * -3, time 0.2 s": lambda x: [-3 * v for v in lagged(x, 0.2)],
}


def test_every_source_has_an_oracle():
    updated = {word for word, kind in SOURCES.items() if kind.function is not None}
    assert updated - {line.split()[2] for line in ORACLES} == set()


@pytest.mark.parametrize("line", ORACLES)
@given(values=VALUES)
@settings(max_examples=cases(8, 25), deadline=None)
def test_each_source_is_what_the_page_says(line, values):
    text = text_of("e = measured x", line, "drive u = u")
    assert outputs(text, values) == pytest.approx(list(ORACLES[line](values)), abs=1e-12)


@pytest.mark.parametrize(
    ("lines", "oracle"),
    [
        (["i = integral of e, anti-windup hold", "drive u = i * 100, within -2 .. 2"],
         lambda x: held(x, 2.0)),
        (["i = integral of e, anti-windup back 0.5 s", "drive u = i * 100, within -2 .. 2"],
         lambda x: drawn_back(x, 2.0, 0.5)),
        (["i = integral of e * 4, anti-windup back 0.5 s", "j = i / 2 - 3 * i",
          "drive u = j * 40, within -2 .. 2"],
         lambda x: drawn_back(x, 2.0, 0.5, -400.0)),
        (["i = integral of e, anti-windup hold", "drive u = -i * 100, within -2 .. 2"],
         lambda x: held(x, 2.0, -100.0)),
        (["i = integral of e, anti-windup hold", "drive u = i * -100, within -2 .. 2"],
         lambda x: held(x, 2.0, -100.0)),
        (["i = integral of e, anti-windup back 1 ms", "drive u = i * 5, within -2 .. 2"],
         lambda x: drawn_back(x, 2.0, 0.001, 5.0)),
        (["drive u = e, slew 40"], lambda x: slewed(x, 40.0)),
        (["drive u = 3 * e, within -2 .. 1, slew 40"],
         lambda x: slewed([min(max(3 * v, -2.0), 1.0) for v in x], 40.0)),
        (["drive u = e", "drive u = 1"], lambda x: [v + 1 for v in x]),
    ],
)  # fmt: skip
@given(values=VALUES)
@settings(max_examples=cases(8, 25), deadline=None)
def test_limits_and_drives_that_add_up(lines, oracle, values):
    text = text_of("e = measured x", *lines)
    assert outputs(text, values) == pytest.approx(list(oracle(values)), abs=1e-12)


def test_a_sum_is_cleared_behind_the_last_period_of_a_set_point():
    head = ["set-point every 3"]
    cleared = text_of("s = sum of error of x, cleared each set-point", "drive u = s", head=head)
    whole = text_of("s = sum of error of x", "drive u = s", head=head)
    ones = [-1.0] * 7
    assert outputs(cleared, ones) == [1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 1.0]
    assert outputs(whole, ones) == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]


def test_the_weight_of_a_set_point_and_gains_by_name():
    text = text_of(
        "e = error of x, weight b", "drive u = e * K",
        head=['gain K = 3*pi/2 "V"', "gain b = 0.25"],
    )  # fmt: skip
    run = made(text).run(compiled=False)
    assert run.step({"x": 2.0}, {"x": 4.0})["u"] == (0.25 * 4.0 - 2.0) * (3 * math.pi / 2)
    run = made(text).run(compiled=False, gains={"K": 2.0, "b": 1.0})
    assert run.step({"x": 2.0}, {"x": 4.0})["u"] == 4.0
    with pytest.raises(GainError, match="no gain 'k'"):
        made(text).run(compiled=False, gains={"k": 2.0})


def table_over(*names, mode=None):
    random = np.random.default_rng(5)
    axes = tuple(Axis(name, tuple(sorted(random.uniform(-4, 4, 4 + i)))) for i, name in
                 enumerate(names))  # fmt: skip
    values = random.uniform(-2, 2, [len(axis.levels) for axis in axes])
    return LookupTable(axes, "u", values, mode=mode)


@pytest.mark.parametrize("mode", ["nearest", "linear"])
@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_a_table_of_any_number_of_inputs(count, mode):
    names = ["p", "q", "r", "s"][:count]
    table = table_over(*names, mode=mode)
    signals = [f"{name} = measured x * {i + 1}" for i, name in enumerate(names)]
    text = text_of(
        *signals, f"v = table T({', '.join(names)})", "drive u = v", head=['use T from "t.lut"']
    )
    values = np.random.default_rng(2).uniform(-3, 3, 60).tolist()
    wanted = [table.lookup(*(v * (i + 1) for i in range(count)), mode=mode) for v in values]
    got = outputs(text, values, sheets={"T": (table,)})
    assert got == pytest.approx(wanted, abs=1e-13)
    if mode == "nearest":
        assert got == wanted


RULES = """rulebase both
input p -5 .. 5
output k 0 .. 10
output d -1 .. 1
terms p: gaussians N Z P
terms k, d: triangles LOW MID HIGH
rule if p is N then k is HIGH and d is LOW
rule if p is Z then k is LOW and d is MID
rule if p is P or p is N then k is MID and d is HIGH
"""


def test_a_rule_base_in_the_same_file_with_several_outputs():
    text = RULES + text_of("p = measured x", "k, d = rules both(p)", "drive u = p * k + d")
    assert parse(text).rulebase is not None
    values = [-4.0, -0.5, 0.0, 2.5]
    rulebase = parse(RULES).rulebase
    wanted = [v * out["k"] + out["d"] for v in values for out in (infer(rulebase, p=v),)]
    assert outputs(text, values) == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize("compiled", [False, True])
def test_an_output_that_holds_keeps_the_value_of_the_period_before(compiled):
    head = (
        "rulebase r\ninput e -10 .. 10\noutput u -1 .. 1\nterm e P: triangle 0 5 10\n"
        "term u P: triangle 0 1 1\ninference no-rule hold\nrule if e is P then u is P\n"
    )
    rules = parse(head).rulebase
    run = made(head + text_of("e = measured x", "v = rules r(e)", "drive u = v")).run(
        compiled=compiled
    )
    given = [-1.0, 2.0, -1.0, -3.0, 4.0, -2.0]
    found = [run.step({"x": x}, {"x": 0.0})["u"] for x in given]
    at = {x: infer(rules, e=x)["u"] for x in (2.0, 4.0)}
    assert found[0] == 0.0  # nothing to hold yet: the period is skipped
    assert found[1:] == [at[2.0], at[2.0], at[2.0], at[4.0], at[4.0]]
    run.start()
    assert run.step({"x": -1.0}, {"x": 0.0})["u"] == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("line", ORACLES)
def test_machine_code_has_the_same_bits(line):
    text = text_of("e = measured x", line, "drive u = u, within -3 .. 3, slew 100")
    values = np.random.default_rng(1).uniform(-5, 5, 200).tolist()
    assert outputs(text, values, compiled=True) == outputs(text, values)


def test_axes_have_their_own_gains_and_memory():
    text = (
        "controller c\nperiod 10 ms\ngain K = 2, 5\naxis a, b\n"
        "  e = error of x\n  i = integral of e\n  drive u = i * K\n"
    )
    run = made(text).run(compiled=False)
    assert run.inputs == ("a.x", "b.x")
    for _ in range(3):
        drives = run.step({"a.x": 1.0, "b.x": -1.0}, {"a.x": 0.0, "b.x": 0.0})
    assert drives == {"a.u": pytest.approx(-0.06), "b.u": pytest.approx(0.15)}
    run.start()
    assert run.step({"a.x": 1.0, "b.x": -1.0}, {"a.x": 0.0, "b.x": 0.0})["a.u"] == -0.02
    with pytest.raises(PortError, match=r"no measured value of 'b\.x'"):
        run.step({"a.x": 1.0}, {"a.x": 0.0, "b.x": 0.0})


def test_a_shipped_controller_runs_in_a_loop_of_ones_own():
    run = load(shipped("stfc.frb")).run(compiled=False)
    assert isinstance(run, ControllerRun)
    still = dict.fromkeys(run.inputs, 0.0)
    drives = run.step(still, still | {"joint1.position": 0.01})
    assert drives["joint1.voltage"] > 0.0
    assert abs(drives["joint2.voltage"]) < 1e-9


@pytest.mark.parametrize("name", ["stfc", "cfaf", "hfie", "soc-zero", "cdid+fuzzy"])
def test_a_written_controller_reads_back(name):
    text = read_text(shipped(f"{name}.frb"))
    assert format_text(text) == text
    assert parse(format_text(text)).controller == parse(text).controller


FINDINGS = {
    "  u = error of x * K": ("unknown-signal", "no signal or gain is called 'K'"),
    "  u = rate of w\n  w = error of x": ("signal-before-made", "'w' is read here"),
    "  u = integral of 3": ("unexpected-token", "expected"),
    "  u = table T(e)": ("unknown-use", "no rule base or table is called 'T'"),
    "  u = error of x, weight": ("incomplete-statement", "expected the weight"),
    "  u = rate of e, filter 3": ("missing-unit", "expected a unit of time after 3"),
    "  u = rate of e, filtre 3 s": ("unknown-option", "expected one of filter"),
    "  u = integral of e, within 2 .. 1": ("bad-range", "from a lower to a higher number"),
    "  u = e / 0": ("bad-number", "a division by zero"),
    "  e = measured x\n  u = e": ("duplicate-name", "'e' is declared twice"),
    "  u, v = measured x": ("several-signals", "only rules give several signals"),
}


@pytest.mark.parametrize("lines", FINDINGS)
def test_one_finding_for_a_mistake(lines):
    text = "controller c\nperiod 1 s\naxis a\n  e = error of x\n" + lines + "\n  drive y = u + e\n"
    name, message = FINDINGS[lines]
    errors = [d for d in parse(text).diagnostics if d.is_error]
    assert [d.name for d in errors] == [name]
    assert message in errors[0].message


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("controller c\naxis a\n  e = error of x\n  drive u = e\n", "missing-period"),
        ("controller c\nperiod 0 s\naxis a\n  e = error of x\n  drive u = e\n", "bad-period"),
        ("controller c\nperiod 5\naxis a\n  e = error of x\n  drive u = e\n", "missing-unit"),
        ("controller c\nperiod 1 s\n", "no-axes"),
        ("controller c\nperiod 1 s\naxis a\n  e = error of x\n", "no-drives"),
        ("controller c\nperiod 1 s\nset-point every 0.5\naxis a\n  e = error of x\n  drive u = e\n",
         "bad-set-point"),
        ("controller c\nperiod 1 s\ngain K = 1, 2, 3\naxis a\n  drive u = K\n", "wrong-count"),
        ("controller c\nperiod 1 s\ngain K = 1/0\naxis a\n  drive u = K\n", "bad-number"),
        ("controller c\ncontroller d\nperiod 1 s\naxis a\n  drive u = 1\n", "duplicate-statement"),
        ("controller c\nperiod 1 s\naxis a\n  drive u = 1\n  zoom e by 2 inside 3\n",
         "unknown-signal"),
        ("controller c\nperiod 1 s\n  v = error of x\naxis a\n  drive u = 1\n", "line-above-axes"),
    ],
)  # fmt: skip
def test_mistakes_of_the_whole(text, name):
    assert name in [d.name for d in parse(text).diagnostics if d.is_error]


def test_doubts_do_not_keep_it_from_running():
    text = text_of(
        "e = error of x", "w = rate of e", "drive u = e",
        head=["gain K = 2", "gain G = 5, tune 1 .. 3"],
    )  # fmt: skip
    parsed = parse(text)
    assert parsed.controller is not None
    assert sorted(d.name for d in parsed.diagnostics) == [
        "outside-tune", "unused-name", "unused-name", "unused-signal",
    ]  # fmt: skip


def test_a_gain_with_the_name_of_a_rule_base_is_not_read_by_its_look_up():
    text = text_of(
        "e = error of x", "u = table T(e)", "drive u = u", head=['use T from "t.lut"', "gain T = 2"]
    )
    (finding,) = parse(text).diagnostics
    assert (finding.name, finding.message) == (
        "unused-name",
        "nothing reads the gain or partner 'T'",
    )


def test_a_controller_is_not_a_rule_base():
    from fuzzyarm.language import load_rulebase

    with pytest.raises(RuleBaseError, match="this is a controller, not a rule base"):
        load_rulebase(shipped("stfc.frb"))


def test_an_integral_behind_a_limit_is_doubted_until_something_holds_it():
    for option, names in (
        ("", ["windup"]),
        (", anti-windup hold", []),
        (", anti-windup back 1 s", []),
        (", within -1 .. 1", []),
    ):
        text = text_of(
            "e = error of x",
            f"i = integral of e{option}",
            "u = i * 2 + e",
            "drive u = u, within -1 .. 1",
        )
        assert [d.name for d in parse(text).diagnostics] == names


@pytest.mark.parametrize("gain", [0.1, 1.0, 50.0, 4000.0, -50.0])
def test_an_integral_goes_back_alike_whatever_gain_stands_behind_it(gain):
    """The drive of a loop depends on the product of both gains alone."""
    sign, size = "-" * (gain < 0), abs(gain)
    lines = (
        f"s = {sign}e * {1 / size!r}",
        "i = integral of s, anti-windup back 50 ms",
        f"drive u = {sign}i * {size!r}, within -2 .. 2",
    )
    values = [*[30.0] * 50, *[-30.0] * 50, *[1.0] * 50]
    found = outputs(text_of("e = error of x", *lines), values)
    assert found == pytest.approx(list(drawn_back([-v for v in values], 2.0, 0.05, 1.0)), abs=1e-9)


@pytest.mark.parametrize("gain", [7.0, -3.0, 0.0])
def test_a_gain_that_is_set_is_the_one_that_the_anti_windup_counts_with(gain):
    text = text_of(
        "e = measured x", "i = integral of e, anti-windup back 0.5 s",
        "drive u = i * K, within -2 .. 2", head=["gain K = 100"],
    )  # fmt: skip
    values = [30.0] * 40 + [-5.0] * 40
    run = made(text).run(gains={"K": gain}, compiled=False)
    found = [run.step({"x": value}, {"x": 0.0})["u"] for value in values]
    expected = drawn_back(values, 2.0, 0.5, gain) if gain else [0.0] * 80
    assert found == pytest.approx(list(expected), abs=1e-9)


def test_a_gain_that_is_not_constant_is_found_where_it_matters():
    for option, names in (("back 1 s", ["windup-gain"]), ("hold", [])):
        text = text_of(
            "e = error of x", f"i = integral of e, anti-windup {option}", "k = i * e",
            "drive u = k, within -1 .. 1",
        )  # fmt: skip
        assert [d.name for d in parse(text).diagnostics] == names


def test_a_file_runs_by_the_command_like_its_name(capsys, tmp_path):
    words = ["--trajectory", "pick-and-place", "--segment", "0.2", "--json"]
    file = tmp_path / "mine.frb"
    file.write_text(read_text(shipped("cdid+fuzzy.frb")))
    told = []
    for name in ("cdid+fuzzy", str(file), f"{file}+ie"):
        assert main(["simulate", name, *words]) == 0
        told.append(json.loads(capsys.readouterr().out)["rms"])
    assert told[0] == told[1]
    assert told[2] != told[1]


@pytest.mark.parametrize(
    ("before", "after", "finding"),
    [
        ('"pd7-study.frb"', '"nothing.frb"', "missing-file"),
        ("rules pd7(e, ce)", "rules pd7(e)", "wrong-count"),
        ("rules pd7(e, ce)", "table pd7(e, ce)", "wrong-source"),
        ("period 0.6 ms", "", "missing-period"),
        ("G_u * alpha", "G_u * alfa", "unknown-signal"),
    ],
)
def test_check_finds_what_does_not_fit_beside_the_file(capsys, tmp_path, before, after, finding):
    file = tmp_path / "mine.frb"
    text = read_text(shipped("stfc.frb"))
    file.write_text(text.replace(before, after))
    assert main(["check", str(file)]) == 1
    assert f"[{finding}]" in capsys.readouterr().err
    assert main(["simulate", str(file)]) == 1
    assert f"[{finding}]" in capsys.readouterr().err
    file.write_text(text)
    assert main(["check", str(file)]) == 0


def test_files_of_other_formats_are_used(tmp_path):
    rules, table = tmp_path / "pd7-study.fll", tmp_path / "thesis-6.1.csv"
    assert main(["convert", str(shipped("pd7-study.frb")), str(rules), "--lossy"]) == 0
    assert main(["compile", str(shipped("thesis-6.1.lut")), "-o", str(table)]) == 0
    text = read_text(shipped("fuzzy-direct.frb"))
    (tmp_path / "direct.frb").write_text(text.replace("pd7-study.frb", "pd7-study.fll"))
    text = read_text(shipped("fuzzy-lut.frb"))
    (tmp_path / "lut.frb").write_text(text.replace("thesis-6.1.lut", "thesis-6.1.csv"))
    for own, name in (("direct.frb", "fuzzy-direct.frb"), ("lut.frb", "fuzzy-lut.frb")):
        runs = [load(path).run(compiled=False) for path in (tmp_path / own, shipped(name))]
        still = dict.fromkeys(runs[0].inputs, 0.0)
        moved = still | {"joint1.position": 0.004}
        drives = [run.step(still, moved)["joint1.voltage"] for run in runs]
        assert drives[0] == pytest.approx(drives[1], rel=1e-3)
        assert drives[0] != 0.0


@pytest.mark.parametrize("words", [["prove", "--range"], ["eval"], ["compile", "-o", "x.lut"]])
def test_commands_for_rule_bases_say_that_it_is_a_controller(capsys, words):
    command, *options = words
    assert main([command, str(shipped("stfc.frb")), *options]) == 1
    assert "is a controller, not a rule base or a table" in capsys.readouterr().err


def test_a_linked_controller_runs_its_own_files(tmp_path):
    """The designer opens the file itself; the command takes the files beside it, too."""
    from fuzzyarm.apps.designer.folder import Workspace
    from fuzzyarm.control.controllers.text import home_of, read_controller

    own, here = tmp_path / "own", tmp_path / "here"
    for folder in (own, here):
        folder.mkdir()
        (folder / "pd7.frb").write_text(shipped("pd7.frb").read_text())
    changed = (own / "pd7.frb").read_text().replace('-6 .. 6  "control', '-4 .. 4  "control')
    (own / "pd7.frb").write_text(changed)
    (own / "servo.frb").write_text(shipped("servo.frb").read_text())
    (here / "servo.frb").symlink_to(own / "servo.frb")
    (tmp_path / "folder").symlink_to(here)  # a link to a folder is that folder

    for path in (own / "servo.frb", here / "servo.frb", tmp_path / "folder" / "servo.frb"):
        (rules,) = read_controller(path).sheets["pd7"]
        assert rules.outputs[0].high == 4.0, path
    assert Workspace(here / "servo.frb").folder == own.resolve()
    assert home_of(here / "servo.frb") == own.resolve()
    assert home_of(tmp_path / "folder" / "pd7.frb") == tmp_path / "folder"


def test_a_rate_without_a_filter_is_the_last_slope_alone():
    """No state of a filter keeps a rounding of an earlier spike."""
    run = made(text_of("e = measured y", "d = rate of e", "drive u = d")).run()
    values = [0.1, -1e6, 0.3, 0.3 + 1e-10]
    steps = [run.step({"y": y}, {})["u"] for y in values]
    assert steps == [0.0, *((y - x) / PERIOD for x, y in pairwise(values))]
