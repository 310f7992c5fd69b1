"""Margins of loops: against python-control, and against runs a little before and beyond them."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from fuzzyarm import load, shipped, simulate
from fuzzyarm.apps.cli.main import main
from fuzzyarm.apps.show.margins import margins_chart
from fuzzyarm.base.picture import Line
from fuzzyarm.control.controllers import ControllerText
from fuzzyarm.control.loop import Sensor
from fuzzyarm.language import parse
from fuzzyarm.plant import Plant, Port, find_plant
from fuzzyarm.plant.own import starting_at
from fuzzyarm.proof.claim.problem import loop_problem
from fuzzyarm.proof.loop import LoopProofError, margins
from fuzzyarm.proof.loop.linearised import linearised
from fuzzyarm.proof.loop.margins import changed, drive_margins, margins_of, rule_gains

EXAMPLES = Path(__file__).parents[2] / "examples" / "controllers"

H = 0.02


def late_radius(loop, delay):
    """Return the spectral radius of the closed loop whose actuator has a dead time, s."""
    h, m, n = loop.period, len(loop.ahead), len(loop.a)
    whole, part = divmod(loop.part + delay, h)
    whole = int(whole)
    # Over a period the plant sees the drive of `whole + 1` periods ago for `part`, then the next.
    both = np.zeros((m + 1, m + 1))
    both[:m] = loop.ahead
    late = expm(both * (h - part))[:m, m]
    early = expm(both * h)[:m, m] - late
    size = n + whole + 1
    drives = np.eye(size)[n - 1 :]  # of now, and of 1, 2 … periods ago
    drives[0] = np.concatenate([-loop.c, np.zeros(whole + 1)])
    a = np.zeros((size, size))
    a[:n, :n] = loop.a
    if loop.part:
        a[:m, loop.before] = 0.0  # its own part of a period is one of the whole delay
    a[:m] += np.outer(early, drives[whole + 1]) + np.outer(late, drives[whole])
    a[n:] = drives[:-1]
    return float(np.abs(np.linalg.eigvals(a)).max(initial=0.0))


def plant_of(a, b):
    """Return a plant x' = A x + b u that shows its first two states, x2 being the rate of x1."""

    class Linear(Plant):
        name = "linear"
        inputs = {"u": Port("V")}
        outputs = {"x1": Port("m", -9.0, 9.0)} | (
            {"x2": Port("m/s", -9.0, 9.0)} if len(a) > 1 else {}
        )
        states = {f"x{k + 1}": "m" for k in range(len(a))}

        def derivative(self, t, x, u, p):
            return [sum(a[i][j] * x[j] for j in range(len(a))) + b[i] * u[0] for i in range(len(a))]

        def output(self, t, x, p):
            return list(x[:2])

    return Linear()


def controller_of(lines):
    text = "controller law\nperiod 20 ms\naxis linear\n  e = error of x1\n"
    return load_text(text + "".join(f"  {line}\n" for line in lines))


def load_text(text):
    """Return a controller from its text."""
    parsed = parse(text)
    assert parsed.controller is not None, parsed.diagnostics
    return ControllerText(parsed.controller)


def law(kind, z, p):
    """Return -u / x1 of a law, and -u / x2."""
    integral = H / (1.0 - 1.0 / z)
    share = H / (0.1 + H)
    slope = (1.0 - 1.0 / z) / H * share / (1.0 - (1.0 - share) / z)
    lag = share / (1.0 - (1.0 - share) / z)
    return {
        "p": (p, 0.0),
        "pd": (p, 0.3 * p),
        "pi": (p + 0.5 * p * integral, 0.0),
        "pid": (p + 0.5 * p * integral + 0.2 * p * slope, 0.0),
        "lag": (p * lag, 0.0),
    }[kind]


LAWS = {
    "p": ("drive u = e * 2",),
    "pd": ("d = error of x2", "drive u = e * 2 + d * 0.6"),
    "pi": ("i = integral of e", "drive u = e * 2 + i * 1"),
    "pid": (
        "i = integral of e",
        "d = rate of e, filter 100 ms",
        "drive u = e * 2 + i * 1 + d * 0.4",
    ),
    "lag": ("f = lag of e, time 100 ms", "drive u = f * 2"),
}

PLANTS = {
    "first order": ([[-1.0]], [2.0]),
    "unstable": ([[0.7]], [1.0]),
    "motor": ([[0.0, 1.0], [0.0, -2.0]], [0.0, 1.5]),
    "oscillator": ([[0.0, 1.0], [-9.0, -1.2]], [0.0, 4.0]),
    "third order": ([[0.0, 1.0, 0.0], [0.0, -3.0, 2.0], [0.0, -0.5, -8.0]], [0.0, 0.0, 6.0]),
}

LOOPS = [
    ("first order", "p", 0),
    ("first order", "pi", 0),
    ("unstable", "p", 2),
    ("unstable", "lag", 0),
    ("motor", "p", 0),
    ("motor", "pd", 3),
    ("motor", "pid", 0),
    ("oscillator", "pd", 0),
    ("oscillator", "pi", 0),
    ("third order", "p", 1),
    ("third order", "pd", 0),
    ("third order", "pid", 2),
]
"""Plant, law, and periods by which the sensor of x1 is late."""


def loop_of(plant, kind, late):
    sensors = {"x1": Sensor(delay=late * H)} if late else {}
    problem = loop_problem(controller_of(LAWS[kind]), plant_of(*PLANTS[plant]), sensors=sensors)
    return linearised(problem)


@pytest.mark.slow
@pytest.mark.parametrize(("plant", "kind", "late"), LOOPS)
def test_margins_of_linear_loops_are_those_of_python_control(plant, kind, late):
    control = pytest.importorskip("control")
    a, b = (np.array(part) for part in PLANTS[plant])
    shown = np.eye(len(a))[: 2 if len(a) > 1 else 1]
    sampled = control.c2d(control.ss(a, b[:, None], shown, np.zeros((len(shown), 1))), H, "zoh")

    def theirs(omega):
        z = np.exp(1j * omega * H)
        of_first, of_second = law(kind, z, 2.0)
        x = np.ravel(sampled(z))
        return complex(of_first * x[0] / z**late + (of_second * x[1] if kind == "pd" else 0.0))

    loop = loop_of(plant, kind, late)
    ours = margins_of(loop.opened(loop.drives[0]))
    assert ours.stable
    # At our frequencies their transfer function is -1 / gain, and exp(jφ) with φ = phase - 180°.
    if math.isfinite(ours.gain):
        assert theirs(ours.gain_at) == pytest.approx(-1.0 / ours.gain, rel=1e-9)
    if math.isfinite(ours.phase):
        angle = math.radians(ours.phase - 180.0)
        at = complex(math.cos(angle), math.sin(angle))
        assert theirs(ours.phase_at) == pytest.approx(at, rel=1e-9)
    # And none of the crossings that they find is nearer than ours.
    omega = np.geomspace(1e-3, math.pi / H, 600)
    response = control.frd(np.array([theirs(w) for w in omega]), omega, smooth=True)
    gains, phases, *_ = control.stability_margins(response, returnall=True)
    assert all(x >= ours.gain * (1.0 - 1e-3) for x in gains if x > 1.0)
    assert all(x % 360.0 >= ours.phase - 1e-2 for x in phases)
    assert math.isinf(ours.phase) is (len(phases) == 0)


def unstable_in(loop, changes):
    """Whether matrices of a loop with changed gain or dead time have a radius above 1."""
    return np.abs(np.linalg.eigvals(loop.a - changes * np.outer(loop.b, loop.c))).max() > 1.0


@pytest.mark.parametrize(("plant", "kind", "late"), LOOPS)
def test_gain_and_dead_time_at_their_margins_are_at_the_limit(plant, kind, late):
    loop = loop_of(plant, kind, late)
    opened = loop.opened(loop.drives[0])
    found = margins_of(opened)
    for factor in (found.gain, found.gain_down):
        if 0.0 < factor < math.inf:
            outward = 1.0001 if factor > 1.0 else 1.0 / 1.0001
            assert unstable_in(opened, factor * outward)
            assert not unstable_in(opened, factor / outward)
    if math.isfinite(found.delay):
        assert (
            late_radius(opened, 1.001 * found.delay)
            > 1.0
            > late_radius(opened, 0.999 * found.delay)
        )


def late_run(plant, gains, dead_time, periods=6000):
    """Return |x| at the middle and at the end: own steps of a loop u = -gains x, late."""
    from scipy.linalg import expm

    a, b = (np.array(part) for part in PLANTS[plant])
    whole, part = divmod(dead_time, H)
    both = np.zeros((len(a) + 1, len(a) + 1))
    both[:-1, :-1], both[:-1, -1] = a, b
    first, second = expm(both * part), expm(both * (H - part))
    x = np.zeros(len(a))
    x[0] = 1.0
    sent = [0.0] * (int(whole) + 2)
    sizes = []
    for _ in range(periods):
        sent = [-float(gains @ x), *sent[:-1]]
        x = (first @ [*x, sent[int(whole) + 1]])[:-1]
        x = (second @ [*x, sent[int(whole)]])[:-1]
        sizes.append(np.abs(x).max())
    return max(sizes[periods // 2 - 500 : periods // 2]), max(sizes[-500:])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("plant", "kind", "gains"),
    [
        ("motor", "p", [2.0, 0.0]),
        ("motor", "pd", [2.0, 0.6]),
        ("oscillator", "pd", [2.0, 0.6]),
        ("third order", "p", [2.0, 0.0, 0.0]),
    ],
)
def test_a_run_decays_just_before_the_delay_margin_and_grows_just_beyond(plant, kind, gains):
    loop = loop_of(plant, kind, 0)
    delay = margins_of(loop.opened(loop.drives[0])).delay
    for factor, grows in ((0.99, False), (1.01, True)):
        middle, end = late_run(plant, np.array(gains), factor * delay)
        assert (end > middle) == grows


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.02, 0.35, 0.6, 0.8, 0.97])
@pytest.mark.parametrize(("plant", "kind", "late"), [loop for loop in LOOPS if not loop[2]])
def test_a_dead_time_that_is_there_is_taken_from_the_margin(plant, kind, late, share):
    loop = loop_of(plant, kind, late)
    whole = margins_of(loop.opened(loop.drives[0])).delay
    if math.isinf(whole):
        return
    delayed = plant_of(*PLANTS[plant])
    delayed.inputs = {"u": replace(delayed.inputs["u"], delay=share * whole)}
    with_delay = linearised(loop_problem(controller_of(LAWS[kind]), delayed, inside=True))
    left = margins_of(with_delay.opened(with_delay.drives[0])).delay
    assert left == pytest.approx((1.0 - share) * whole, rel=1e-6)


@pytest.mark.parametrize(("plant", "kind", "late"), LOOPS)
def test_the_peak_of_the_sensitivity_is_above_all_samples(plant, kind, late):
    loop = loop_of(plant, kind, late)
    opened = loop.opened(loop.drives[0])
    found = margins_of(opened)
    omega = np.linspace(1e-3, math.pi / H, 7001)
    peak = (1.0 / np.abs(1.0 + opened.at(omega))).max()
    assert peak <= found.sensitivity * (1.0 + 1e-9)
    assert found.sensitivity <= peak * 1.01


# --- rules ---

SHIPPED = [
    ("servo.frb", "motor", {}, 1.0),
    ("ball-and-beam.frb", "ball-and-beam", {}, 1.0),
    ("cartpole.frb", "cartpole", {}, 0.5),
    ("tanks.frb", "tanks", {"level2": 0.1}, 1.0),
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "plant", "set_point", "share"), SHIPPED)
def test_no_gain_of_the_rules_is_worse_than_the_worst(name, plant, set_point, share):
    problem = loop_problem(load(shipped(name)), find_plant(plant), set_point=set_point)
    loop = linearised(problem)
    for drive in loop.drives:
        worst = drive_margins(loop, drive, rule_gains(loop, share)).worst
        rng = np.random.default_rng(1)
        for _ in range(25):
            values = [rng.uniform(gain.low, gain.high) for gain in worst.gains]
            found = margins_of(loop.opened(drive, changed(worst.gains, values)))
            assert found.stable
            for margin in ("gain", "phase", "delay"):
                assert getattr(found, margin) >= getattr(worst.margins, margin) * (1.0 - 1e-6)
            assert found.gain_down <= worst.margins.gain_down * (1.0 + 1e-6)
            assert found.sensitivity <= worst.margins.sensitivity * (1.0 + 1e-6)


def test_a_small_run_goes_as_the_linearised_loop():
    text, plant = load(shipped("servo.frb")), find_plant("motor")
    loop = linearised(loop_problem(text, plant))
    opened = loop.opened(loop.drives[0])
    closed = opened.a - np.outer(opened.b, opened.c)
    small = 1e-7
    run = simulate(text, starting_at(plant, [small, 0.0, 0.0]), reference={"position": 0.0},
                   duration=0.2)  # fmt: skip
    z, way = np.array([small, 0.0, 0.0]), []
    for _ in run.time:
        way.append(z[0])
        z = closed @ z
    # The rules are linear along e and ce each; together min makes an edge between them.
    assert np.abs(run.outputs["position"] - way).max() < 0.2 * small


def test_a_loop_at_a_limit_has_no_margins():
    problem = loop_problem(load(shipped("heater.frb")), find_plant("room"))
    loop = linearised(problem)
    with pytest.raises(LoopProofError, match="does not answer"):
        drive_margins(loop, loop.drives[0])


def test_an_input_that_rests_beyond_its_range_is_said():
    """The drive is saturated: the error gives no gain, its rate alone answers."""
    rules = parse(
        "rulebase r\ninput e -1 .. 1\ninput ce -1 .. 1\noutput u -1 .. 1\n"
        "terms e: triangles N P\nterms ce: triangles N P\nterm u N: singleton -1\n"
        "term u Z: singleton 0\nterm u P: singleton 1\n"
        "inference u: defuzzifier weighted-average\nrule if e is N and ce is N then u is N\n"
        "rule if e is P and ce is N then u is Z\nrule if e is N and ce is P then u is Z\n"
        "rule if e is P and ce is P then u is P\n"
    )
    assert rules.rulebase is not None, rules.diagnostics
    text = load_text(
        'controller law\nuse r from "r.frb"\nperiod 20 ms\naxis linear\n  e = error of x1\n'
        "  d = rate of e, filter 1 s\n  u = rules r(e, d)\n  drive u = u\n"
    )
    text = replace(text, sheets={"r": (rules.rulebase,)})
    plant = plant_of([[-1.0]], [1.0])
    for set_point, held in (
        (0.2, ()),
        (9.0, ("'e' rests at 8.5, beyond its range -1 .. 1: no gain there",)),
    ):
        found = linearised(loop_problem(text, plant, set_point={"x1": set_point}))
        assert found.held == held


# --- the command ---


@pytest.mark.slow
def test_the_command_prints_margins_and_draws_them(capsys, tmp_path):
    path = shipped("heater.frb")
    out = tmp_path / "margins.png"
    assert main(["margins", str(path), "--at", "temperature=21", "--plot", str(out)]) == 0
    assert "57.8° at 0.002211 rad/s" in capsys.readouterr().out
    assert out.stat().st_size > 10_000


@pytest.mark.slow
def test_json_has_null_for_what_is_unlimited(capsys):
    assert main(["margins", str(shipped("servo.frb")), "--json"]) == 0
    (data,) = json.loads(capsys.readouterr().out)
    assert data["drive"] == "shaft.voltage"
    assert data["nominal"]["gain_down"] == 0.0
    assert data["worst"]["phase"] <= data["nominal"]["phase"]


def test_an_unstable_loop_is_said_with_its_radius(capsys, tmp_path):
    path = tmp_path / "wild.frb"
    text = "controller wild\nperiod 20 ms\naxis cart\n  e = error of x\n  drive f = -1 * e\n"
    path.write_text(text, encoding="utf-8")
    assert main(["margins", str(path), "--plant", "cartpole"]) == 3
    assert "not stable, the spectral radius is 1." in capsys.readouterr().out


@pytest.mark.parametrize("warm", [18.0, 20.0, 28.0, 31.7, 40.0])
def test_a_rest_with_small_memory_beside_large_states_is_found(warm):
    """Roundings of the temperature move its rate: steps to the rest stay above 1e-12 of it."""
    heater, room = load(shipped("heater.frb")), find_plant("room")
    loop = linearised(loop_problem(heater, room, set_point={"temperature": warm}))
    found = margins_of(loop.opened(loop.drives[0]))
    assert found.gain == pytest.approx(1438.0, rel=1e-3)


QUAD = """
from fuzzyarm.plant import Plant, Port


class Quad(Plant):
    inputs = {"thrust": Port("N", 0.0, 25.0)}
    outputs = {
        "height": Port("m", -1.0, 20.0),
        "climb": Port("m/s", -8.0, 8.0, rate_of="height"),
    }
    states = {"height": "m", "climb": "m/s", "force": "N"}
    parameters = {"m": 1.3}

    def derivative(self, t, x, u, p):
        return [x[1], x[2] / p[0] - 9.81, (u[0] - x[2]) / 0.05]
"""
HOVER = """controller hover
period 10 ms
use climb from "climb.frb"
axis lift
  dh = error of height
  e = dh * 0.5
  ce = error of climb * 0.4
  push = rules climb(e, ce)
  int = integral of dh, within -8 .. 8, anti-windup hold
  drive thrust = 11.772 + push * 10 + int * 0.5, within 0 .. 25
"""
CLIMB = r"""rulebase climb
input e -1 .. 1
input ce -1 .. 1
output u -1 .. 1
terms e, ce: triangles N Z P
terms u: triangles NB NS ZE PS PB
inference aggregation max, defuzzifier centroid exact, outside clamp
rules u
  e \ ce  N   Z   P
  N       NB  NS  ZE
  Z       NS  ZE  PS
  P       ZE  PS  PB
"""


@pytest.mark.slow
def test_an_integral_holds_what_the_feed_forward_lacks(tmp_path):
    """In the middle of the sensor's range the rules are flat, and Newton's method goes astray."""
    for name, text in (("quad.py", QUAD), ("hover.frb", HOVER), ("climb.frb", CLIMB)):
        (tmp_path / name).write_text(text)
    found = margins(str(tmp_path / "hover.frb"), str(tmp_path / "quad.py"))
    (drive,) = found.values()
    assert drive.nominal.stable


BUCK = """
from fuzzyarm.plant import Plant, Port


class Buck(Plant):
    axis = "out"
    inputs = {"duty": Port("1", 0.0, 1.0)}
    outputs = {"voltage": Port("V", 0.0, 12.0), "current": Port("A", -20.0, 20.0)}
    states = {"i": "A", "v": "V"}

    def derivative(self, t, x, u, p):
        return [(12.0 * u[0] - 0.02 * x[0] - x[1]) / 22e-6, (x[0] - 0.5 * x[1]) / 100e-6]

    def measure(self, t, x, u, p):
        return [x[1], x[0]]
"""
OUT = """controller out
period 10 us
use pd7 from "pd7.frb"
axis out
  e  = error of voltage
  en = e * 3
  ce = rate of e * 6e-5, filter 20 us
  u  = rules pd7(en, ce)
  du = u * 60
  d  = integral of du, within 0 .. 1
  drive duty = d
"""


@pytest.mark.slow
def test_a_state_that_nothing_reads_is_named(capsys):
    """A speed loop rests at any angle."""
    words = [str(EXAMPLES / "incremental-pi.frb"), "--plant", "motor"]
    assert main(["margins", *words]) == 1
    assert main(["prove", *words, "--stable"]) == 4
    out, err = capsys.readouterr()
    assert "the loop rests at any 'position'" in out
    assert "the loop rests at any 'position'" in err


@pytest.mark.slow
def test_a_loop_rests_whose_outputs_are_not_states_by_name(tmp_path):
    """Far from its set point the rules are flat; there they have an edge, so no rounding may do."""
    (tmp_path / "buck.py").write_text(BUCK)
    found = []
    for law in ("u  = rules pd7(en, ce)", "u  = en * 1.5 + ce * 1.5"):
        path = tmp_path / "out.frb"
        path.write_text(OUT.replace("u  = rules pd7(en, ce)", law))
        (drive,) = margins(
            str(path), str(tmp_path / "buck.py"), set_point={"voltage": 5.0}
        ).values()
        found.append(drive.nominal)
    fuzzy, linear = found
    assert fuzzy.stable
    assert fuzzy.gain == pytest.approx(linear.gain, rel=1e-9)
    assert fuzzy.delay == pytest.approx(linear.delay, rel=1e-9)


@pytest.mark.parametrize(("plant", "kind", "late"), LOOPS)
def test_the_phase_of_the_picture_crosses_where_the_margin_is(plant, kind, late):
    loop = loop_of(plant, kind, late)
    each = drive_margins(loop, loop.drives[0])
    chart = margins_chart([each], "loop")
    if math.isinf(each.nominal.phase):
        return
    phase = next(p for row in chart.rows for p in row if p and p.up.name == "phase")
    curve, mark = (part for part in phase.parts if isinstance(part, Line))
    at = np.interp(each.nominal.phase_at, curve.x, curve.y)
    assert at == pytest.approx(each.nominal.phase - 180.0, abs=0.5)
    assert tuple(mark.y) == pytest.approx((-180.0, each.nominal.phase - 180.0))
