"""What an engineer writes in a controller: one finding, with the line as it should be and a fix."""

import pytest

from fuzzyarm.base.shipped_files import shipped, shipped_names
from fuzzyarm.exchange.files import check_text
from fuzzyarm.language import format_text, parse
from fuzzyarm.language.edit import apply_edits, fixes
from fuzzyarm.symbolic.sources import SOURCES

PATH = str(shipped("servo.frb").with_name("tried.frb"))

TEXT = """\
controller servo "fuzzy PD control of a shaft"

use pd7 from "pd7.frb"

period 1 ms
set-point every 5

gain G_e  = 16 "1/rad", tune 2 .. 200 log
gain G_ce = 0.7 "s/rad"
gain G_u  = 4.5
gain K_I  = 10

axis shaft
  e   = error of position * G_e
  ve  = error of velocity
  ce  = rate of e * G_ce, filter 2 ms
  w   = reference position
  m   = measured velocity
  i   = integral of ve, within -5 .. 5
  j   = integral of ve, anti-windup hold
  l   = lag of w, time 20 ms
  d   = l - m
  q   = d * d
  c   = q where l >= 0.5 and m < 2 else 0
  zoom e, ce by 2 inside 3
  u   = rules pd7(e, ce) * G_u
  sum = u + i * K_I + j + c
  drive voltage = sum, within -24 .. 24
"""

SLIPS = [
    # Head
    ('controller servo "', 'CONTROLLER servo "'),
    ('"fuzzy PD control of a shaft"', "'fuzzy PD control of a shaft'"),
    ('use pd7 from "pd7.frb"', 'use "pd7.frb"'),
    ('use pd7 from "pd7.frb"', 'use "pd7.frb" as pd7'),
    ("period 1 ms", "period = 1 ms"),
    ("period 1 ms", "period: 1 ms"),
    ("period 1 ms", "Period 1 ms"),
    ("period 1 ms", "sample time 1 ms"),
    ("period 1 ms", "dt = 1 ms"),
    ("period 1 ms", "period 1 msec"),
    ("period 1 ms", "period 1 millisecond"),
    ("period 1 ms", "period 1000 Hz"),
    ("period 1 ms", "period 1 kHz"),
    ("set-point every 5", "setpoint every 5"),
    ("set-point every 5", "set-point every 5;"),
    # Gains
    ("gain G_e  = 16", "gain G_e 16"),
    ("gain G_e  = 16", "gain G_e: 16"),
    ("gain G_e  = 16", "gain G_e := 16"),
    ("gain G_e  = 16", "GAIN G_e = 16"),
    ("tune 2 .. 200 log", "tune 200 .. 2 log"),
    # Axes
    ("axis shaft", "AXIS shaft"),
    ("axis shaft", "axes shaft"),
    # Sources
    ("error of position * G_e", "G_e * error of position"),
    ("error of position * G_e", "Error of position * G_e"),
    ("error of position * G_e", "error position * G_e"),
    ("error of position * G_e", "error(position) * G_e"),
    ("error of position * G_e", "error in position * G_e"),
    ("error of position * G_e", "error of position * G_e;"),
    ("= error of position * G_e", ":= error of position * G_e"),
    ("= error of position * G_e", "== error of position * G_e"),
    ("= error of position * G_e", "<- error of position * G_e"),
    ("= error of velocity", "= reference velocity - measured velocity"),
    ("rate of e * G_ce", "rate(e) * G_ce"),
    ("rate of e * G_ce", "derivative of e * G_ce"),
    ("rate of e * G_ce", "derivative(e) * G_ce"),
    ("rate of e * G_ce", "der(e) * G_ce"),
    ("rate of e * G_ce", "diff(e) * G_ce"),
    ("rate of e * G_ce", "d/dt e * G_ce"),
    ("rate of e * G_ce", "G_ce * rate of e"),
    ("rate of e * G_ce, filter 2 ms", "rate of e * G_ce filter 2 ms"),
    ("filter 2 ms", "filter 2 msec"),
    ("reference position", "reference of position"),
    ("reference position", "setpoint position"),
    ("measured velocity", "measured of velocity"),
    ("measured velocity", "measurement of velocity"),
    ("integral of ve, within -5 .. 5", "integral(ve), within -5 .. 5"),
    ("integral of ve, within -5 .. 5", "integrate ve, within -5 .. 5"),
    ("integral of ve, within -5 .. 5", "integral ve, within -5 .. 5"),
    ("integral of ve, within -5 .. 5", "integral of ve, limits -5 .. 5"),
    ("integral of ve, within -5 .. 5", "integral of ve, within -5, 5"),
    ("integral of ve, within -5 .. 5", "integral of ve, within [-5, 5]"),
    ("integral of ve, within -5 .. 5", "integral of ve, within 5 .. -5"),
    ("lag of w, time 20 ms", "lowpass of w, time 20 ms"),
    ("q   = d * d", "q   = d^2"),
    ("q   = d * d", "q   = d ** 2"),
    ("q where l >= 0.5 and m < 2 else 0", "q if l >= 0.5 and m < 2 else 0"),
    ("q where l >= 0.5 and m < 2 else 0", "l >= 0.5 and m < 2 ? q : 0"),
    ("q where l >= 0.5 and m < 2 else 0", "l >= 0.5 && m < 2 ? q : 0;"),
    ("l >= 0.5 and m < 2", "l >= 0.5 && m < 2"),
    # Rule bases
    ("rules pd7(e, ce)", "pd7(e, ce)"),
    ("rules pd7(e, ce)", "evalfis(pd7, [e ce])"),
    ("rules pd7(e, ce)", "evalfis([e, ce], pd7)"),
    # Drives and the rest
    ("drive voltage = sum", "DRIVE voltage = sum"),
    ("drive voltage = sum", "drive sum = voltage"),
    ("drive voltage = sum", "output voltage = sum"),
    ("drive voltage = sum, within", "drive sum to voltage, within"),
    ("sum, within -24 .. 24", "sum within -24 .. 24"),
    ("within -24 .. 24", "within -24 to 24"),
    ("within -24 .. 24", "within [-24, 24]"),
    ("within -24 .. 24", "within -24, 24"),
    ("within -24 .. 24", "limit -24 .. 24"),
    ("within -24 .. 24", "within 24 .. -24"),
    ("  d   = l - m", "  d   = l − m"),
]


FORMATTED = format_text(TEXT)


def changed(right, wrong):
    assert TEXT.count(right) >= 1, right
    text = TEXT.replace(right, wrong, 1)
    pairs = zip(text.split("\n"), TEXT.split("\n"), strict=True)
    return text, 1 + next(i for i, (before, after) in enumerate(pairs) if before != after)


def faults(text):
    return [each for each in check_text(text, PATH).diagnostics if each.is_error]


def test_the_text_itself_is_sound():
    assert faults(TEXT) == []
    assert parse(TEXT).diagnostics == ()


@pytest.mark.parametrize(("right", "wrong"), SLIPS, ids=[wrong for _, wrong in SLIPS])
def test_one_slip_is_one_finding_with_the_line_as_it_should_be(right, wrong):
    text, number = changed(right, wrong)
    (finding,) = [each for each in check_text(text, PATH).diagnostics if each.severity != "info"]
    assert (finding.line, finding.is_error) == (number, True)
    first = next(fix for fix in fixes(finding, text) if fix.preferred)
    mended = apply_edits(text, first.edits)
    assert faults(mended) == []
    assert format_text(mended) == FORMATTED
    assert finding.hint.startswith(("write  ", "did you mean"))


def test_a_signal_above_the_axes_is_one_finding():
    text = TEXT.replace("period 1 ms", "period 1 ms\nv = error of position")
    (finding,) = faults(text.replace("drive voltage = u", "drive voltage = u + v"))
    assert finding.name == "unknown-statement"
    assert "axis NAME" in finding.hint


@pytest.mark.parametrize("wrong", ["Ts = 0.001", "period = 0.001", "dt: 1e-3"])
def test_a_period_without_a_unit_is_in_seconds(wrong):
    (finding,) = faults(TEXT.replace("period 1 ms", wrong))
    assert finding.hint == f"write  period {wrong.split()[-1]} s"


COMMENTS = ("// the error", "% the error", "(* the error *)", "/* the error */", "-- the error")


@pytest.mark.parametrize("comment", COMMENTS)
def test_comments_of_elsewhere(comment):
    text, number = changed("position * G_e\n", f"position * G_e {comment}\n")
    (finding,) = faults(text)
    assert (finding.line, finding.message) == (number, "a comment starts with #")
    mended = apply_edits(text, fixes(finding, text)[0].edits)
    assert mended.splitlines()[number - 1].endswith("* G_e # the error")


@pytest.mark.parametrize("ending", ["end", "END_CONTROLLER", "}", "endaxis"])
def test_nothing_ends_a_part(ending):
    (finding,) = faults(f"{TEXT}{ending}\n")
    assert (finding.line, finding.hint) == (TEXT.count("\n") + 1, "leave the line out")


# --- What a line alone cannot put right ---

NEITHER = "a controller has neither rules nor 'if'"
ONE_SOURCE = "a line has one source, first, of a signal"
INPUTS = "the inputs of a rule base are signals in its order"
FUNCTIONS = "a controller has no functions"

LIKE_EXAMPLES = {
    "  if e > 3 then u = 0": NEITHER,
    "  if e is PB then u is NB": NEITHER,
    "  rule if e is PB then u is NB": NEITHER,
    "  x = rate of error of position": ONE_SOURCE,
    "  x = integral of error of velocity": ONE_SOURCE,
    "  x = integral of (e * 2)": ONE_SOURCE,
    "  x = lag of measured velocity, time 1 s": ONE_SOURCE,
    "  x = e + error of velocity": ONE_SOURCE,
    "  x = -error of velocity": ONE_SOURCE,
    "  x = error of position * 2 + e": ONE_SOURCE,
    "  x = deadband of error of position, width 1": ONE_SOURCE,
    "  x = rules pd7(ce=ce, e=e)": INPUTS,
    "  x = evalfis(pd7, e)": INPUTS,
    "  x = rules pd7(e * 2, ce)": INPUTS,
    "  x = rules pd7 * 2": INPUTS,
    "  x = pd7.u * 2": "no axis above is called 'pd7'",
    "  x = (e + ce) * 2": "a sum has no parentheses",
    "  x = abs(e)": FUNCTIONS,
    "  x = saturate(u, -1, 1)": FUNCTIONS,
    "  x = max(-24, u)": FUNCTIONS,
    "  x = deadzone(e, 3)": FUNCTIONS,
    "  drive voltage = rules pd7(e, ce)": "a drive is a sum of signals",
    "gain X = 2 * G_e": "a gain is made of numbers and pi",
    "gain X = 2 * (3 + 4)": "a gain is made of numbers and pi",
    "gain X = 4.5 V": "a unit is written in double quotes",
}  # fmt: skip


@pytest.mark.parametrize("line", LIKE_EXAMPLES)
def test_a_line_like_an_example_gets_its_sentence(line):
    (finding,) = faults(f"{TEXT}{line}\n")
    assert (finding.line, finding.message) == (TEXT.count("\n") + 1, LIKE_EXAMPLES[line])
    assert 1 < finding.column <= len(line)
    assert finding.hint


def test_an_unknown_source_names_those_that_there_are():
    (finding,) = faults(f"{TEXT}  x = median of e\n")
    assert finding.name == "unknown-source"
    assert all(word in finding.message + finding.hint for word in SOURCES)


@pytest.mark.parametrize("line", ["  x = error", "  drive voltage = u, within 24"])
def test_a_line_that_stops_elsewhere_keeps_the_words_of_the_parser(line):
    (finding,) = faults(f"{TEXT}{line}\n")
    assert finding.message.startswith("expected '")


@pytest.mark.parametrize(
    ("wrong", "right"),
    [
        ("u / G_u^2", "u / G_u / G_u"),
        ("u / G_u ** 3 * K_I", "u / G_u / G_u / G_u * K_I"),
        ("u * G_u^2", "u * G_u * G_u"),
        ("u / G_u / K_I^2", "u / G_u / K_I / K_I"),
    ],
)
def test_a_power_behind_a_division_divides_as_often(wrong, right):
    (finding,) = faults(TEXT.replace("sum = u ", f"sum = {wrong} "))
    assert right in finding.hint


CUT_OFF = 1000 / (2 * 3.141592653589793 * 50)  # ms


@pytest.mark.parametrize(
    ("right", "wrong", "time"),
    [
        ("time 20 ms", "time 50 Hz", CUT_OFF),
        ("filter 2 ms", "filter 0.05 kHz", CUT_OFF),
        ("period 1 ms", "period 50 Hz", 20.0),
        ("anti-windup hold", "anti-windup back 50 Hz", None),
    ],
)
def test_a_frequency_is_a_period_or_a_cut_off(right, wrong, time):
    (finding,) = faults(TEXT.replace(right, wrong))
    assert "not a frequency" in finding.message
    if time is None:
        assert finding.replacement is None
    else:
        assert float(finding.replacement.removesuffix(" ms")) == pytest.approx(time, rel=1e-5)


@pytest.mark.parametrize(
    "line",
    [
        "axis " + " and ".join("abcdefghij" * 6) + " !",
        "axis " + (" " * 10).join("abcdefg") + " 1",
        "axis " + (" " * 10).join("abcdefghijkl") + " !",
        "gain g = " + "*".join(["1234"] * 40) + " !",
    ],
)
def test_a_line_of_many_words_is_read_at_once(line):
    """Each took time that doubles with every word."""
    assert parse(f"controller c\nperiod 1 ms\n{line}\n  u = error of p\n").diagnostics


def test_the_unit_of_a_period_is_said():
    (finding,) = faults(TEXT.replace("period 1 ms", "period 0.001"))
    assert "unit of time" in finding.message
    assert "as in  0.001 s" in finding.hint


# --- Names, numbers, the whole ---


def test_a_controller_without_a_name_is_not_a_rule_base():
    (finding,) = faults(TEXT.replace("controller servo", "controller"))
    assert finding.hint == "write  controller NAME"


def test_a_controller_without_an_axis_is_one_finding():
    (finding,) = faults(TEXT.replace("axis shaft\n", ""))
    assert finding.name == "no-axes"


def test_a_comma_in_a_gain_may_be_a_decimal_mark():
    (finding,) = faults(TEXT.replace('= 16 "', '= 16,5 "'))
    assert "the controller 1 axis" in finding.message
    assert finding.hint.endswith("a decimal mark is a point: 16.5")


def test_an_unknown_name_says_how_it_would_be_made():
    (finding,) = faults(TEXT.replace("m   = measured velocity", "m   = velocity"))
    assert "measured velocity" in finding.hint
    (finding,) = faults(TEXT.replace("position * G_e", "position * Q"))
    assert "gain Q = 1" in finding.hint
    (finding,) = faults(TEXT.replace('use pd7 from "pd7.frb"\n', ""))
    assert 'use pd7 from "pd7.frb"' in finding.hint


def test_a_signal_with_the_name_of_a_port_is_meant_as_a_drive():
    found = faults(TEXT.replace("drive voltage = sum, within -24 .. 24", "voltage = u"))
    assert [each.hint for each in found] == ["add a line like  drive voltage = u"]


def test_a_missing_file_names_one_that_is_there():
    (finding,) = faults(TEXT.replace('"pd7.frb"', '"pd8.frb"'))
    assert "did you mean 'pd7.frb'?" in finding.hint


@pytest.mark.parametrize("time", ["1ms", "500us", "2s", "0.5min", "1h", "1.5e1ms"])
def test_a_unit_may_stand_close_to_its_number(time):
    text = TEXT.replace("1 ms", time)
    assert parse(text).diagnostics == ()
    number = time.rstrip("umsinh")
    assert f"period {float(number):g} {time[len(number) :]}\n" in format_text(text)


def test_everywhere_a_time_stands_its_unit_may_stand_close():
    text = TEXT.replace("2 ms", "2ms").replace("20 ms", "20ms")
    text = text.replace("anti-windup hold", "anti-windup back 3ms")
    assert parse(text).diagnostics == ()


def test_lines_of_a_controller_below_a_grid_are_no_rows_of_it():
    head, rest = TEXT.split("\nperiod ", 1)
    rules = "rulebase lev\ninput e 0 .. 1\noutput u 0 .. 1\nterms e, u: triangles N P\n"
    found = faults(f"{head}\n{rules}rules u\n  e  N P\n  u  N P\n\nperiod {rest}")
    assert all("controller NAME , above the next heading" in f.hint for f in found[3:])
    assert {f.name for f in found} == {"unknown-statement", "missing-period", "no-axes"}


def test_a_name_that_starts_with_a_digit_stands_in_quotes():
    (finding,) = faults(TEXT.replace("axis shaft", "axis 1s"))
    assert finding.replacement == "'1s'"
    assert "starts with a digit" in finding.message


@pytest.mark.parametrize("name", [n for n in shipped_names() if n.endswith(".frb")])
def test_what_is_sound_means_what_it_meant(name):
    assert parse(shipped(name).read_text(encoding="utf-8")).diagnostics == ()
