"""What check finds between a controller, its files and its plant, and where it is silent."""

import re
import time
from pathlib import Path

import pytest
from crane import SLEDGE
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyarm.apps.cli import main
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.apps.watch import WatchedFile
from fuzzyarm.base.diagnostic import Severity
from fuzzyarm.base.shipped_files import shipped, shipped_names
from fuzzyarm.base.units import near_symbol, product, read_unit, unit_text, unlike
from fuzzyarm.control.controllers.findings import ports_in_words, shipped_sites
from fuzzyarm.control.controllers.on_plant import site_of
from fuzzyarm.control.controllers.reach import reaches_of
from fuzzyarm.control.controllers.text import with_files
from fuzzyarm.exchange.files import PlantOf, check_file, check_parsed, check_text
from fuzzyarm.language import parse
from fuzzyarm.language.check import CHECKS
from fuzzyarm.plant.own import PLANTS, find_plant
from fuzzyarm.plant.plant import interface_of

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "controllers.md"

SERVO = """controller servo
use pd7 from "pd7.frb"
period 1 ms
gain G_e = {G_e} "{unit}"
gain G_ce = 0.05 "s/rad"
gain G_u = {G_u} "V"
axis shaft
  e = error of position * G_e
  ce = error of velocity * G_ce
  u = rules pd7(e, ce) * G_u
  drive voltage = u{limits}
"""


def servo(G_e="100", G_u="4", limits="", unit="1/rad"):  # noqa: N803 - the names of the text
    return SERVO.format(G_e=G_e, G_u=G_u, limits=limits, unit=unit)


def text_of(*lines, axis="shaft", head=()):
    parts = ["controller c", "period 10 ms", *head, f"axis {axis}", *(f"  {x}" for x in lines)]
    return "\n".join(parts) + "\n"


def findings(text, on=None):
    return check_text(text, on=on).diagnostics


def names(text, on=None):
    return [each.name for each in findings(text, on)]


# --- Ranges ---


@pytest.mark.slow
def test_the_shipped_controllers_are_right():
    for name in shipped_names():
        if name.endswith(".frb"):
            assert check_file(shipped(name)).diagnostics == ()


@pytest.mark.parametrize(
    ("gain", "severity", "message"),
    [
        ("100", None, ""),
        ("0.2", None, ""),
        ("400", None, ""),
        ("573", Severity.INFO, "e reaches 7201 here, pd7 takes -6 .. 6: all but 0.083 % of it"),
        ("50000", Severity.WARNING, "everything saturates; at full speed it moves by 3e+03"),
    ],
)
def test_an_error_far_beyond_its_universe(gain, severity, message):
    found = [each for each in findings(servo(G_e=gain)) if each.name == "range-mismatch"]
    if severity is None:
        assert found == []
    else:
        (finding,) = found
        assert (finding.severity, finding.line) == (severity, 10)
        assert message in finding.message
        assert "multiply its gain by" in finding.hint
        assert finding.related[0].span.line == 8


def test_a_signal_that_hardly_uses_its_universe():
    (finding,) = findings(servo(G_e="0.04"))
    assert finding.message == (
        "e reaches 0.5027 here, pd7 takes -6 .. 6: it uses 8.4 % of the universe"
    )


def test_what_the_text_makes_may_be_ten_times_as_wide():
    rules = shipped("pd7.frb").read_text().partition("lookup")[0]
    for factor, found in ((50, []), (200, ["range-mismatch"])):
        text = rules + text_of(
            "e = error of position", "ce = rate of e", "i = integral of e, within -1 .. 1",
            f"j = i * {factor}", "u = rules pd7(j, ce) * 4", "drive voltage = u",
        )  # fmt: skip
        assert names(text) == found


@pytest.mark.parametrize(
    ("parts", "found"),
    [
        ("e * 50000 + ce", ["range-mismatch"]),
        ("e * 50000 - late * 50000", []),
        ("e * 50000 - r * 50000", []),
        ("e * 0.0001 - late * 0.0001", ["range-mismatch"]),  # too narrow, though they add up
    ],
)
def test_parts_that_may_cancel_are_not_too_wide(parts, found):
    text = text_of(
        "e = error of position", "ce = error of velocity", "late = lag of e, time 20 ms",
        "r = reference position", f"s = {parts}", "u = rules pd7(s, ce) * 4", "other = r + late",
        "drive voltage = u + other * 0, within -24 .. 24", head=['use pd7 from "pd7.frb"'],
    )  # fmt: skip
    assert names(text) == found


def test_one_wrong_gain_is_one_finding_and_can_be_allowed():
    text = shipped("stfc.frb").read_text().replace("1080/pi", "50000").replace("3000", "60000")
    (finding,) = findings(text)
    assert finding.name == "range-mismatch"
    lines = text.split("\n")
    lines[finding.line - 1] += "  # allow range-mismatch"
    assert findings("\n".join(lines)) == ()
    assert names(servo().replace("= u", "= u  # allow windup")) == ["useless-allow"]


def reach(text, signal, plant="motor"):
    controller, faults = with_files(parse(text).controller, Path.cwd())
    assert faults == []
    site = site_of(find_plant(plant))
    return {
        axis: tuple(found.at)
        for (axis, name), found in reaches_of(controller, site).signals.items()
        if name == signal
    }


@pytest.mark.parametrize(
    ("within", "inside", "ends"),
    [(3, 3, (-6, 6)), (2, 3, (-4, 4)), (10, 3, (-10, 10)), (10, 8, (-16, 16))],
)
def test_a_zoom_magnifies_what_lies_inside(within, inside, ends):
    text = text_of(
        "e = error of position", f"i = integral of e, within -{within} .. {within}",
        f"zoom i by 2 inside {inside}", "drive voltage = i",
    )  # fmt: skip
    assert reach(text, "i") == {"shaft": ends}


def test_a_table_that_learns_reaches_its_bound():
    text = shipped("soc-zero.frb").read_text()
    assert reach(text, "u", "arm") == {"joint1": (-6, 6), "joint2": (-6, 6)}
    text = text.replace("gain bound         = 6", "gain bound         = 2, 9")
    assert reach(text, "u", "arm") == {"joint1": (-2, 2), "joint2": (-9, 9)}


def test_what_nothing_bounds_reaches_everywhere():
    text = text_of("e = error of position", "i = integral of e", "w = e / i", "drive voltage = w")
    assert reach(text, "i") == reach(text, "w") == {"shaft": (-float("inf"), float("inf"))}
    assert reach(text.replace("position", "depth"), "e")["shaft"][1] == float("inf")


def test_two_wrong_gains_are_two_findings():
    text = servo(G_e="50000").replace("0.05", "0.0001")
    found = [each for each in findings(text) if each.name == "range-mismatch"]
    assert [each.message.split()[0] for each in found] == ["e", "ce"]


SOURCES = [
    "measured position", "error of position", "rate of {x}", "change of {x}",
    "lag of {x}, time 0.1 s", "deadband of {x}, width 0.5", "hysteresis of {x}, width 0.5",
    "sum of error of position, cleared each set-point", "integral of {x}, within -1 .. 2",
    "{x} * 3 - 2 * {x} + 1", "{x} * {x} / 4", "rules pd7({x}, {x}) * 5", "-{x} / 3",
]  # fmt: skip


@pytest.mark.parametrize("last", SOURCES)
@given(
    st.lists(st.sampled_from(SOURCES), max_size=2),
    st.lists(st.floats(-6.28, 6.28), min_size=6, max_size=12),
)
@settings(max_examples=8, deadline=None)
def test_signals_stay_where_they_are_said_to_reach(last, before, positions):
    lines = [*before, last]
    names = ["p", *(f"signal{index}" for index in range(len(lines)))]
    made = [
        f"{name} = {line.format(x=before)}"
        for before, name, line in zip(names, names[1:], lines, strict=False)
    ]
    head = ['use pd7 from "pd7.frb"', "set-point every 3"]
    text = text_of("p = measured position", *made, f"drive voltage = {names[-1]}", head=head)
    parsed = parse(text)
    assert parsed.controller is not None, parsed.diagnostics
    controller, _ = with_files(parsed.controller, Path.cwd())
    reaches = reaches_of(controller, site_of(find_plant("motor")))
    # The rate of an error is that of the plant: the jumps of a reference are none of it.
    jumps = "error" in text
    run = controller.run(compiled=False)
    position = positions[0]
    for wanted in positions:
        # As fast as the motor turns: 60 rad/s for 10 ms.
        position += min(max(wanted - position, -0.6), 0.6)
        run.step({"position": position}, {"position": -wanted})
        for (axis, name), reach in reaches.signals.items():
            if jumps and ("rate" in text or "change" in text):
                continue
            value = run.signal(axis, name)
            slack = 1e-9 * (1.0 + abs(value))
            assert reach.at.low - slack <= value <= reach.at.high + slack, (text, name)


# --- Drives ---


@pytest.mark.parametrize(
    ("limits", "gain", "found"),
    [
        ("", "4", []),  # 6 * 4 V is what the motor takes
        ("", "5", ["no-limits"]),
        (", within -24 .. 24", "5", []),
        (", within -30 .. 30", "5", ["wide-limits"]),
        (", within -2 .. 2", "5", ["weak-drive"]),
        ("", "0.3", ["weak-drive"]),
    ],
)
def test_limits_of_the_actuator(limits, gain, found):
    assert names(servo(G_u=gain, limits=limits)) == found


@pytest.mark.parametrize(
    ("integral", "limits", "found"),
    [
        ("i = integral of e * K, within 0 .. 100", "", ["limit-before-factor"]),  # the actuator's
        ("i = integral of e * K, within 0 .. 50", ", within 0 .. 50", ["limit-before-factor"]),
        ("i = integral of e * K, within 0 .. 25", ", within 0 .. 50", []),
        ("i = integral of e, within 0 .. 100", "", []),
        ("w = e * K\n  i = integral of w, within 0 .. 100", "", []),
    ],
)
def test_limits_that_hold_before_a_factor(integral, limits, found):
    lines = ["e = error of temperature", *integral.split("\n  "), f"drive power = i{limits}"]
    text = text_of(*lines, axis="room", head=["gain K = 2"])
    assert [name for name in names(text) if "limit-" in name] == found


def test_an_integral_behind_an_actuator_winds_up():
    heater = ["e = error of temperature", "i = integral of e", "drive power = i"]
    assert names(text_of(*heater, axis="room")) == ["windup"]
    assert names(text_of(*heater, axis="elsewhere")) == []
    heater[1] += ", within 0 .. 100"
    assert names(text_of(*heater, axis="room")) == []
    heater[1] = "i = integral of e, anti-windup hold"
    assert names(text_of(*heater, axis="room")) == ["no-limits", "no-limits"]
    heater[2] += ", within 0 .. 100"
    assert names(text_of(*heater, axis="room")) == []


def test_drives_of_one_port_add_up():
    drives = ["e = error of x", "drive u = e, within -1 .. 2", "drive u = 3 * e, within -1 .. 1"]
    (finding,) = findings(text_of(*drives, axis="a"))
    assert finding.name == "limits-add-up"
    assert "add up to -2 .. 3" in finding.message
    assert names(text_of(*drives[:2], "drive u = e", axis="a")) == []
    assert names(text_of(*drives[:2], "drive v = e, within 0 .. 1", axis="a")) == []


# --- Ports ---


def test_a_port_that_the_plant_does_not_have():
    text = servo().replace("velocity", "speed")
    (finding,) = findings(text)
    assert (finding.name, finding.severity, finding.line) == ("unknown-port", Severity.WARNING, 9)
    assert "--connect speed=velocity" in finding.hint
    (finding,) = findings(text, PlantOf(find_plant("motor")))
    assert finding.severity is Severity.ERROR
    assert names(text, PlantOf(find_plant("motor"), {"speed": "velocity"})) == []


def test_a_plant_of_the_user_counts_where_more_of_the_ports_are_its_own(tmp_path):
    (tmp_path / "own.py").write_text(SLEDGE)
    sledge = find_plant(str(tmp_path / "own.py"))

    def found(text):
        review = check_parsed(parse(text), text, own=[sledge])
        return [each.message for each in review.diagnostics]

    lines = ["e = error of x", "drive force = 2 * e, within -30 .. 30"]
    of_sledge = text_of(*lines, axis="cart")
    assert names(of_sledge) == ["unknown-port"]
    assert found(of_sledge) == []
    lines += ["a = error of theta", "drive f = 2 * a, within -10 .. 10"]
    assert found(text_of(*lines, axis="cart")) == ["the cartpole has no drive 'force'"]
    cartpole = shipped("cartpole.frb")
    text = cartpole.read_text()
    review = check_parsed(parse(text), text, str(cartpole), own=[sledge])
    assert review == check_text(text, str(cartpole))


def test_an_axis_that_the_plant_does_not_have_is_one_finding():
    text = shipped("stfc.frb").read_text()
    (finding,) = findings(text, PlantOf(find_plant("motor")))
    assert finding.message == "the motor has no axis 'joint1'"
    assert names(text.replace("joint1, joint2", "joint2")) == []
    hybrid = shipped("cdid+fuzzy.frb").read_text()
    assert "arm-only" in names(hybrid, PlantOf(find_plant("motor")))


def test_a_plant_of_which_nothing_fits_is_another_one():
    lines = ["e = error of depth", "drive valve = e"]
    assert names(text_of(*lines, axis="tanks")) == []
    on = PlantOf(find_plant("tanks"))
    assert names(text_of(*lines, axis="tanks"), on) == ["unknown-port", "unknown-port"]


@pytest.mark.slow
@pytest.mark.parametrize(
    "text",
    [
        "\n".join(
            f"axis a{i}\n  e{i} = error of position\n  drive u{i} = e{i} * 2" for i in range(4000)
        ),
        "axis room\n"
        + "\n".join(f"  e{i} = error of p{i}\n  drive u{i} = e{i} * 2" for i in range(1000)),
    ],
    ids=["axes", "ports"],
)
def test_axes_and_ports_take_a_time_in_proportion(text):
    begin = time.process_time()
    assert names(f"controller c\nperiod 1 ms\n{text}\n") == []
    # Of a walk over all axes, or a search of near names, for each port: 15 to 20 s.
    assert time.process_time() - begin < 6


def test_check_on_a_plant_by_the_command(tmp_path, capsys):
    file = tmp_path / "servo.frb"
    file.write_text(servo().replace("velocity", "speed"))
    assert main(["check", str(file)]) == 0
    assert main(["check", str(file), "--plant", "motor"]) == 1
    assert main(["check", str(file), "--plant", "motor", "--connect", "speed=velocity"]) == 0
    own = tmp_path / "wheel.py"
    own.write_text(
        "from fuzzyarm.plant import Plant, Port\n"
        "class Wheel(Plant):\n"
        "    inputs = {'voltage': Port('V', -2, 2)}\n"
        "    outputs = {'position': Port('rad'), 'speed': Port('rad/s')}\n"
        "    states = {'a': 'rad', 'b': 'rad/s'}\n"
        "    def derivative(self, t, x, u, p):\n        return [x[1], u[0]]\n"
    )
    capsys.readouterr()
    assert main(["check", str(file), "--plant", f"{own}:Wheel"]) == 0
    assert "no-limits" in capsys.readouterr().out
    assert main(["check", str(file), "--plant", "moter"]) == 1
    assert main(["check", str(file), "--connect", "speed=velocity"]) == 2
    assert "did you mean 'motor'" in capsys.readouterr().err


# --- Units ---


@pytest.mark.parametrize(
    ("unit", "left", "pair"),
    [
        ("1/rad", "1", None),
        ("1/deg", "rad/deg", ("rad", "deg")),
        ("N m/rad", "N m", None),
        ("°C/rad", "°C", None),
        ("1", "rad", None),
        ("°/rad", "°", None),
        ("1/°", "rad/°", ("rad", "°")),
    ],
)
def test_products_of_units(unit, left, pair):
    whole = product({"rad": 1}, read_unit(unit))
    assert unit_text(whole) == left
    assert unlike(whole) == pair


@pytest.mark.parametrize(
    ("unit", "text", "near"),
    [
        ("Nm", "N m", None),
        ("mNm/rad", "mN m/rad", None),
        ("N/(m s)", "N/(m s)", None),
        ("1/(rad s)", "1/(rad s)", None),
        ("rads", "rads", ("rads", "rad")),
        ("Volts/sec", "Volts/sec", ("Volts", "V")),
        ("lm", "lm", None),  # lumen
        ("T", "T", None),  # tesla
    ],
)
def test_a_unit_is_printed_as_it_is_read_again(unit, text, near):
    read = read_unit(unit)
    assert unit_text(read) == text
    assert read_unit(unit_text(read)) == read
    assert near_symbol(read) == near


def test_a_unit_spelled_otherwise_is_a_finding():
    (finding,) = findings(servo(unit="1/Rad"))
    assert (finding.name, finding.message, finding.hint) == (
        "unknown-unit", "unknown unit 'Rad'", "did you mean 'rad'?",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("unit", "pair"),
    [
        ("K/mK", ("K", "mK")),
        ("°C/°F", ("°C", "°F")),
        ("°C/K", None),  # of a difference of temperatures nothing is wrong with it
        ("bar/kPa", ("bar", "kPa")),
        ("rpm/Hz", ("rpm", "Hz")),
        ("kW/%", None),
    ],
)
def test_scales_of_one_kind(unit, pair):
    assert unlike(read_unit(unit)) == pair


@pytest.mark.parametrize("words", ["steps per unit of control", "", "1/s/s", "a-b", "2 V"])
def test_units_that_are_not_certain(words):
    assert read_unit(words) is None


def test_units_of_one_kind_that_do_not_cancel():
    (finding,) = findings(servo(unit="1/deg"))
    assert (finding.name, finding.line) == ("unlike-units", 8)
    assert findings(servo(unit="rad/rad")) == ()
    straight = ["e = error of position * G", "drive voltage = e * K"]
    head = ['gain G = 1 "1/rad"', 'gain K = 1 "mV"']
    (finding,) = findings(text_of(*straight, head=head))
    assert (finding.line, finding.message) == (7, "drive voltage is in mV, the port in V")


@pytest.mark.parametrize(
    ("gain", "unit", "message"),
    [
        ("G_u", "rad", "drive voltage is in rad, the port in V"),
        ("G_ce", "m", "ce is in rad m/s, pd7 takes a plain number"),
        ("G_e", "V", "e is in rad V, pd7 takes a plain number"),
        ("G_e", "1", ""),  # an angle is a plain number
        ("G_u", "steps", ""),
    ],
)
def test_gains_of_another_dimension(gain, unit, message, tmp_path):
    for name in ("servo.frb", "pd7.frb"):
        (tmp_path / name).write_text(shipped(name).read_text("utf-8"), "utf-8")
    servo = tmp_path / "servo.frb"
    servo.write_text(re.sub(rf'(gain {gain} .*?)"[^"]*"', rf'\1"{unit}"', servo.read_text("utf-8")))
    found = [each.message for each in check_text(servo.read_text("utf-8"), servo).diagnostics]
    assert found == ([message] if message else [])


# --- What the lines alone tell ---


def test_a_table_that_learns_for_nothing():
    text = shipped("soc-zero.frb").read_text()
    assert names(text) == []
    unread = text.replace("u     = table F(e, ce)", "u     = table P(e, ce)")
    (finding,) = findings(unread)
    assert (finding.name, finding.hint) == (
        "unread-table",
        "add a line like  u = table F(e, ce)",
    )


def test_a_sum_that_is_cleared_in_every_period():
    text = shipped("hfie.frb").read_text()
    assert names(text.replace("set-point every 5\n", "")) == ["always-cleared"]
    whole = text.replace("set-point every 5\n", "").replace(", cleared each set-point", "")
    assert names(whole) == []


def test_a_signal_is_unused_on_its_own_axis():
    text = text_of("e = error of x", "drive u = e", axis="a")
    text += "axis b\n  e = error of x\n  drive u = 1\n"
    (finding,) = findings(text)
    assert (finding.name, finding.line) == ("unused-signal", 7)


def test_a_broken_line_brings_no_doubts_about_what_it_may_have_read():
    text = servo().replace("drive voltage = u", "drive voltage = u *")
    assert [each.name for each in findings(text)] == ["incomplete-statement"]


# --- For a reader ---


def test_the_page_shows_what_check_prints(tmp_path, capsys, monkeypatch):
    part = PAGE.read_text().partition("## What check finds")[2]
    text, shown = re.search(r"```frb\n(.*?)```\n\n```text\n(.*?)```", part, re.DOTALL).groups()
    (tmp_path / "servo.frb").write_text(text)
    monkeypatch.chdir(tmp_path)
    assert main(["check", "servo.frb"]) == 0
    assert capsys.readouterr().out == shown
    told = set(re.findall(r"`([a-z]+-[a-z-]+)`", part))
    assert told & set(CHECKS) >= {"range-mismatch", "no-limits", "unlike-units", "unknown-port"}


def test_an_editor_shows_ports_ranges_and_the_findings_of_files(tmp_path):
    file = tmp_path / "servo.frb"
    text = servo(G_e="50000").replace("pd7.frb", "missing.frb")
    file.write_text(text)
    found = [each.name for each in Session(str(file), text).review().diagnostics]
    assert found == ["missing-file"]
    assert [each.name for each in WatchedFile(file).findings] == found
    file.write_text(servo(G_e="50000"))
    assert [each.name for each in WatchedFile(file).findings] == ["range-mismatch"]
    session = Session(str(file), servo())
    assert "reaches -1257 .. 1257" in session.kind.hover(session.reading, 8, 3).markdown
    assert "reaches -24 .. 24" in session.kind.hover(session.reading, 11, 19).markdown
    assert "motor, rad, -6.283" in session.kind.hover(session.reading, 8, 18).markdown
    heater = text_of("e = error of temperature", "drive power = e * 5", axis="room")
    session = Session(str(file), heater)
    assert session.kind.hover(session.reading, 4, 3).markdown.endswith("reaches -80 .. 80 K")
    broken = servo().replace("drive voltage = u", "drive ")
    session = Session(str(file), broken)
    offered = session.kind.complete(session.reading, 11, 9)
    assert {each.label: each.detail for each in offered}["voltage"] == "motor, V, -24 .. 24"


def test_ports_are_those_of_the_plants():
    for site, kind in zip(shipped_sites(), PLANTS.values(), strict=True):
        interface = interface_of(kind())
        told = ports_in_words(interface.axes)
        assert {name for _, name in (*interface.outputs, *interface.inputs)} <= set(told)
        assert all(words.startswith(site.name) for words in told.values())
    every = ports_in_words(["nowhere"])
    assert {"temperature", "voltage", "f", "pump", "angle_rate"} <= set(every)


@pytest.mark.parametrize(
    ("silence", "found"),
    [("", ["no-rule-fires"]), (", no-rule nan", ["no-rule-fires"]), (", no-rule 0", [])],
)
def test_a_signal_that_may_not_be_a_number_is_named(tmp_path, silence, found):
    (tmp_path / "hole.frb").write_text(
        "rulebase hole\ninput e -6 .. 6\noutput d -1 .. 1\nterm e N: triangle -6 -4 -2\n"
        "term e P: triangle 2 4 6\nterms d: singletons A B\n"
        f"inference d: defuzzifier weighted-average{silence}\n"
        "rule if e is N then d is A\nrule if e is P then d is B\n"
    )
    path = tmp_path / "around.frb"
    path.write_text(
        'controller around\nuse hole from "hole.frb"\nperiod 1 s\naxis room\n'
        "  e = error of temperature\n  d = rules hole(e)\n"
        "  drive power = d * 50, within 0 .. 100\n"
    )
    doubts = [doubt for doubt in check_file(path).diagnostics if doubt.name == "no-rule-fires"]
    assert [doubt.name for doubt in doubts] == found
    ends = ": drives stay as before"
    assert all("fires at e = -6: d is not a number" in doubt.message for doubt in doubts)
    assert all(doubt.message.endswith(ends) for doubt in doubts)
    text = path.read_text().replace("  drive", "  sum = integral of d, within 0 .. 9\n  drive")
    path.write_text(text)
    named = [d.message for d in check_file(path).diagnostics if d.name == "no-rule-fires"]
    assert all(message.endswith(": drives and integral sum stay as before") for message in named)
    assert len(named) == len(found)


MANY = """controller servo "a DC motor"
use pd7 from "pd7.frb"
use nothing from "gone.frb"
period 1 ms
gain G_e  = 5000 "1/rad"
gain G_ce = 0.5  "ms/rad"
gain G_e = 3
axis shaft
  e  = error of position * G_e
  ex = error of position * G_x
  ce = error of speed * G_ce
  f  = foo of e
  g = = 3
  l  = lag of e
  u  = rules pd7(e, ce)
  u2 = rules pd7(e)
  u3, u4 = rules pd7(e, ce)
  w = integral of q, within 5 .. 1
  of = u3 * 2 + ex
  drive voltage = u * 0.3 + of
"""


def test_independent_mistakes_are_found_at_once(tmp_path):
    path = tmp_path / "many.frb"
    path.write_text(MANY)
    found = [(d.line, d.name) for d in check_file(path).diagnostics]
    assert found == [
        (3, "missing-file"), (7, "duplicate-name"), (10, "unknown-signal"), (11, "unknown-port"),
        (12, "unknown-source"), (13, "unexpected-token"), (14, "incomplete-statement"),
        (15, "range-mismatch"), (16, "wrong-count"), (17, "wrong-count"), (18, "unknown-signal"),
        (18, "bad-range"),
    ]  # fmt: skip


@pytest.mark.parametrize("name", ["servo", "stfc", "heater", "soc-table", "cfaf", "hfie", "tanks"])
def test_nothing_is_found_that_follows_from_a_mistake(tmp_path, name):
    source = shipped(f"{name}.frb")
    lines = source.read_text().splitlines()
    before = {(d.line, d.name) for d in check_file(source).diagnostics}
    begun = next(k for k, line in enumerate(lines) if line.startswith("axis"))
    for k in range(begun + 1, len(lines)):
        if " = " in lines[k] and not lines[k].lstrip().startswith("#"):
            head, comment, rest = lines[k].partition("#")
            body, comma, options = head.rstrip().partition(",")
            if "(" in body and ")" not in body:  # a comma of a call
                body, comma, options = head.rstrip(), "", ""
            wrong = f"{body} * no_such_gain{comma}{options} {comment}{rest}"
            path = tmp_path / f"{name}.frb"
            path.write_text("\n".join([*lines[:k], wrong, *lines[k + 1 :], ""]))
            found = {(d.line, d.name) for d in check_file(path).diagnostics}
            assert (k + 1, "unknown-signal") in found
            assert found - {(k + 1, "unknown-signal")} <= before


UNTUNED = """controller servo "a DC motor"
use pd7 from "pd7.frb"
period 1 ms
gain K = 2 "1/rad"{}
axis shaft
  e = error of position * K
  v = measured speed
  d = rate of e, filter 5 ms
  u = rules pd7(e, d)
  drive volts = u
  drive voltage = u * 10, within -99 .. 99
"""


@pytest.mark.parametrize(
    "wrong",
    [
        ", tune 5 .. 1",
        ", tune 0 .. 5 log",
        ", tune 1 .. x",
        ", tun x",
        ", tune 1 5 .. 6",
        "\ntune K 1 .. 5",
        "\ntune\n  gain K 1 .. 5",
        "\nexpect e = 1 -> u = 2",
    ],
)
def test_a_wrong_range_of_tuning_hides_nothing(tmp_path, wrong):
    path = tmp_path / "untuned.frb"
    more = wrong.count("\n")
    path.write_text(UNTUNED.format(""))
    right = [(d.line, d.name) for d in check_file(path).diagnostics]
    assert {(7, "unknown-port"), (10, "unknown-port"), (11, "wide-limits")} <= set(right)
    path.write_text(UNTUNED.format(wrong))
    found = [(d.line - more, d.name) for d in check_file(path).diagnostics if d.line > 4 + more]
    assert found == [(line, name) for line, name in right if line > 4]


@pytest.mark.parametrize(
    ("gain", "sum_of", "words"),
    [
        ('6 "V"', "11.772 + c * G_T", "drive thrust is in V, the port in N"),
        ('6 "V"', "11.772 + c * G_T + trim * K_i", "a sum of V and N"),
        ('6 "V"', "trim * K_i - 2 * 3 - c * G_T", "a sum of N and V"),
        ('6 "N"', "e * K_e + c * G_T", "a sum of a plain number and N"),
        ('6 "mN"', "trim * K_i + c * G_T", "a sum of N and mN"),
        ('6 "N"', "11.772 + c * G_T + trim * K_i", ""),
        ('6 "N"', "G_T * c - 11.772", ""),
        ("6", "11.772 + c * G_T + trim * K_i", ""),
        ('6 "N/m"', "e * G_T + trim * K_i + 2 * G_T * e", ""),
        ('6 "N/m"', "c * G_T + trim * K_i", ""),  # the rules may be in m
    ],
)
def test_terms_of_a_sum_have_one_unit(tmp_path, gain, sum_of, words):
    (tmp_path / "quad.py").write_text(
        "from fuzzyarm.plant import Plant, Port\n\n\nclass Quad(Plant):\n"
        '    axis = "quad"\n    inputs = {"thrust": Port("N", 0, 20)}\n'
        '    outputs = {"height": Port("m", -5, 5)}\n    states = {"h": "m", "v": "m/s"}\n\n'
        "    def derivative(self, t, x, u, p):\n        return [x[1], u[0] / 1.2 - 9.81]\n"
    )
    text = (
        "rulebase lift\ninput h -1 .. 1\noutput c -1 .. 1\nterm h low: triangle -2 -1 1\n"
        "term h high: triangle -1 1 2\nterm c up: singleton 1\nterm c down: singleton -1\n"
        "inference defuzzifier weighted-average\nrule if h is low then c is up\n"
        "rule if h is high then c is down\n\ncontroller quad\nperiod 1 ms\n"
        f'gain G_T = {gain}\ngain K_i = 2 "N/(m s)"\ngain K_e = 0.5 "1/m"\naxis quad\n'
        "  e = error of height\n  x = e * K_e\n  c = rules lift(x)\n"
        f"  trim = integral of e, within -5 .. 5\n  drive thrust = {sum_of}, within 0 .. 20\n"
    )
    plant = PlantOf(find_plant(str(tmp_path / "quad.py")))
    found = [each.message for each in findings(text, plant) if each.name == "unlike-units"]
    assert found == ([words] if words else [])
