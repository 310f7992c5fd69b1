"""Loops of which something false was refuted, or that ended in a traceback."""

from __future__ import annotations

import math
import time
import warnings
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from fuzzyarm import load_controller, shipped
from fuzzyarm.apps.cli.main import main
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.proof.check import check_certificate
from fuzzyarm.proof.check.numbers import exact, is_positive_definite
from fuzzyarm.proof.loop import (
    LoopVerdict,
    prove_loop,
    read_claim,
    write_certificate,
)
from fuzzyarm.proof.loop.form import Form
from fuzzyarm.proof.loop.instability import growth
from fuzzyarm.proof.loop.lmi import Inequality, feasible_point, minimise
from fuzzyarm.proof.stop import Stop, TimeOverError

HEAD = "from fuzzyarm.plant import Plant, Port\n"
LAG = """
class Lag(Plant):
    inputs = {"u": Port("V", -5000.0, 5000.0)}
    outputs = {"y": Port("m", -10.0, 10.0)}
    states = {"y": "m"}
    duration = 1.0
    def derivative(self, t, x, u, p):
        return [RATE]
"""
OSCILLATOR = """
class Oscillator(Plant):
    inputs = {"u": Port("V", -50.0, 50.0)}
    outputs = {"y": Port("m", -1.0, 1.0)}
    states = {"y": "m", "v": "m/s"}
    duration = 60.0
    def derivative(self, t, x, u, p):
        return [x[1], -25.0*x[0] + 0.2*x[1] + 10.0*u[0]]
"""


def grown(evidence: str) -> float:
    """Return by what a deviation grows per period, as it is said."""
    words = evidence.removeprefix("next to rest a deviation grows at least ")
    return float(words.removesuffix(" times per period"))


def plant_file(folder: Path, body: str, name: str = "plant.py") -> str:
    path = folder / name
    path.write_text(HEAD + body)
    return str(path)


def lag(folder: Path, rate: str) -> str:
    return plant_file(folder, LAG.replace("RATE", rate))


def controller(folder: Path, lines: str, period: str = "10 ms", name: str = "c") -> ControllerText:
    path = folder / f"{name}.frb"
    path.write_text(f"controller {name}\nperiod {period}\naxis a\n{lines}")
    return load_controller(str(path))


def proportional(folder: Path, gain: float) -> ControllerText:
    return controller(
        folder, f"  e = error of y\n  drive u = {'-' * (gain < 0)}e * {abs(gain)!r}\n"
    )


def proved(text: ControllerText, claim: str, plant: str, **words: object) -> LoopVerdict:
    return prove_loop(text, read_claim(claim, plant), budget=20.0, **words)  # type: ignore[arg-type]


def exponential(matrix: np.ndarray) -> np.ndarray:
    total = term = np.eye(len(matrix))
    for k in range(1, 40):
        term = term @ matrix / k
        total = total + term
    return total


# ── a false refutation ───────────────────────────────────────────────────────────────


@pytest.mark.slow
def test_a_stiff_plant_is_not_refuted_by_an_integrator_that_diverges(tmp_path: Path) -> None:
    plant = lag(tmp_path, "-2000.0*x[0] + 2000.0*u[0]")  # next y = -0.5 y
    from_here = proved(
        proportional(tmp_path, 0.5), "from y in 1 .. 1: y in -2 .. 2 during 0 .. 1 s", plant
    )
    assert from_here.verdict != "refuted"


@pytest.mark.slow
def test_a_stiff_loop_is_proved_up_to_its_limit(tmp_path: Path) -> None:
    plant = lag(tmp_path, "-2000.0*x[0] + 2000.0*u[0]")  # next y = -gain y, except for e^-20
    assert proved(proportional(tmp_path, 0.99), "stable", plant).verdict == "proved"
    refuted = proved(proportional(tmp_path, 1.01), "stable", plant)
    assert refuted.verdict == "refuted"
    assert grown(refuted.evidence[-1]) == pytest.approx(1.01, abs=2e-5)


@pytest.mark.slow
@pytest.mark.filterwarnings("error")
def test_a_run_that_its_integrator_loses_is_no_witness(tmp_path: Path) -> None:
    # Without a bound nothing stops it before the numbers end.
    text = LAG.replace("RATE", "-2000.0*x[0] + 2000.0*u[0]")
    plant = plant_file(tmp_path, text.replace("-10.0, 10.0)", "-10.0, 10.0, bound=float('inf'))"))
    assert proved(proportional(tmp_path, 0.9), "stable", plant).verdict == "proved"


@pytest.mark.slow
def test_an_unstable_loop_is_refuted_without_a_run_that_goes_far(tmp_path: Path) -> None:
    plant = lag(tmp_path, "u[0]")  # next y = -1.0001 y: within a second 1.01 times as much
    refuted = proved(proportional(tmp_path, 200.01), "stable", plant)
    assert refuted.verdict == "refuted"
    (evidence,) = refuted.evidence
    assert grown(evidence) == pytest.approx(1.0001, abs=2e-5)
    assert proved(proportional(tmp_path, 199.99), "stable", plant).verdict == "proved"


@pytest.mark.parametrize(("end", "verdict"), [(0.36787943, "refuted"), (0.36787945, "proved")])
def test_a_bound_next_to_a_run_is_refuted_only_if_it_is_beyond(
    tmp_path: Path, end: float, verdict: str
) -> None:
    plant = lag(tmp_path, "-x[0] + 0.0*u[0]")  # 1/e = 0.367879441 after 1 s
    claim = f"from y in 1 .. 1: y in 0 .. {end} during 1 .. 1 s"
    assert proved(proportional(tmp_path, 0.5), claim, plant).verdict == verdict


@pytest.mark.parametrize(("off", "verdict"), [(1e-6, "proved"), (-1e-6, "refuted")])
def test_an_integrator_that_is_slightly_wrong_refutes_nothing(
    tmp_path: Path, off: float, verdict: str
) -> None:
    plant = lag(tmp_path, "-150.0*x[0] + 0.0*u[0]")  # RK4 at 10 ms: 0.273 for e^-1.5 = 0.223
    claim = f"from y in 1 .. 1: y in 0 .. {math.exp(-1.5) + off!r} during 0.01 .. 0.01 s"
    assert proved(proportional(tmp_path, 0.5), claim, plant).verdict == verdict


def one_state(a: float, spread: float, gain: float = 0.0) -> Form:
    """Return x⁺ = (a ± spread) x + δ gain x, |δ| ≤ 1."""
    zero, count = Fraction(0), int(gain != 0.0)
    return Form(
        ("x",), {}, ((Fraction(a),),), ((Fraction(1),) * count,),
        ((Fraction(spread), *(zero,) * count),), ((Fraction(gain), zero),) * count,
        (), (), {}, {}, 0.01,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("numbers", "least"),
    [
        ((1.1, 0.0), 1.1),
        ((-1.1, 0.05), 1.05),
        ((1.1, 0.2), 0.0),
        ((0.9, 0.0), 0.0),
        ((1.5, 0.0, 0.4), 1.1),
        ((1.5, 0.0, 0.6), 0.0),
    ],
)
def test_a_loop_grows_only_if_all_that_it_may_be_do(
    numbers: tuple[float, ...], least: float
) -> None:
    found = growth(one_state(*numbers).system)
    assert found <= least
    assert found == pytest.approx(least, rel=0.1)


def test_a_loop_that_only_switching_makes_stable_is_not_said_to_grow() -> None:
    # x'' = -51 x + 1.36 x' + 8.19 u, held for 0.5 s, with u = k x for x above 0, l x below it.
    moves = np.zeros((3, 3))
    moves[0, 1] = 1.0
    moves[1] = -51.009474130076754, 1.3579774548666972, 8.19191026232612
    step = exponential(moves * 0.5 / 64)
    for _ in range(6):
        step = step @ step
    a, b, above, below = step[:2, :2], step[:2, 2], -11.122280267824646, 3.806816034574606
    sides = [a + np.outer(b, [k, 0.0]) for k in (above, below)]
    assert all(max(abs(np.linalg.eigvals(side))) > 1.2 for side in sides)
    z = np.array([[math.cos(w), math.sin(w)] for w in np.linspace(0.0, 2.0 * math.pi, 361)])
    for _ in range(300):
        z = np.where(z[:, :1] >= 0.0, z @ sides[0].T, z @ sides[1].T)
    assert abs(z).max() < 1e-9
    middle, radius = 0.5 * (above + below), 0.5 * (below - above)
    rows = tuple(tuple(map(Fraction, row)) for row in a + np.outer(b, [middle, 0.0]))
    zero = Fraction(0)
    form = Form(
        ("x", "v"), {}, rows, tuple((Fraction(x),) for x in b), ((zero,) * 3,) * 2,
        ((Fraction(radius), zero, zero),), (), (), {}, {}, 0.5,
    )  # fmt: skip
    assert growth(form.system) == 0.0


def test_what_is_not_enclosed_refutes_nothing(tmp_path: Path) -> None:
    plant = lag(tmp_path, "-x[0] + 0.0*u[0] + 1e-9*math.atan2(x[0], 2.0)")
    Path(plant).write_text("import math\n" + Path(plant).read_text())
    # 0.3679 after 1 s, as every run in floats has it; but of `atan2` no tube is known.
    verdict = proved(
        proportional(tmp_path, 0.5), "from y in 1 .. 1: y in 0 .. 0.1 during 1 .. 1 s", plant
    )
    assert verdict.verdict == "undecided"


@pytest.mark.slow
def test_a_run_beyond_the_bound_of_its_plant_is_enclosed(tmp_path: Path) -> None:
    body = LAG.replace("RATE", "-x[0] + x[0]*x[0]*x[0] + 0.0*u[0]").replace(
        '"m", -10.0, 10.0', '"m", -10.0, 10.0, bound=5.0'
    )
    plant, text = plant_file(tmp_path, body), proportional(tmp_path, 0.5)
    verdict = proved(text, "stable from y in 0.5 .. 1.5", plant)
    assert verdict.verdict == "refuted"
    # y² = 1 / (1 - (1 - 1/1.5²) exp(2 t)) is 25 at t = ln(0.96 / (5 / 9)) / 2 = 0.2735
    assert verdict.evidence == (
        "from y = 1.5",
        "the run is beyond the bound of 'y', 5, after 0.28 s",
    )
    assert proved(text, "stable from y in -0.5 .. 0.5", plant).verdict == "proved"


def test_a_run_where_no_rule_fires_does_not_refute(tmp_path: Path) -> None:
    (tmp_path / "gap.frb").write_text(
        "rulebase gap\ninput e -1 .. 1\noutput u -1 .. 1\nterm e N: ramp -0.2 -0.4\n"
        "term e P: ramp 0.2 0.4\nterm u N: singleton -1\nterm u P: singleton 1\n"
        "inference u: defuzzifier weighted-average\nrule if e is N then u is N\n"
        "rule if e is P then u is P\n"
    )
    (tmp_path / "c.frb").write_text(
        'controller c\nuse gap from "gap.frb"\nperiod 10 ms\naxis a\n'
        "  e = error of y\n  u = rules gap(e)\n  drive u = u\n"
    )
    text = load_controller(str(tmp_path / "c.frb"))
    plant = lag(tmp_path, "u[0]")
    claim = "from y in 0.505 .. 0.505: y in -1 .. 1 during 0 .. 1 s"  # y = 0.505 - t
    verdict = proved(text, claim, plant)
    # The period is skipped there, and the drive stays.
    assert verdict.verdict == "undecided"


def test_a_loop_that_is_unstable_stays_refuted(tmp_path: Path) -> None:
    plant = lag(tmp_path, "u[0]")  # next y = (1 - 0.01 k) y
    assert proved(proportional(tmp_path, 210.0), "stable", plant).verdict == "refuted"
    assert proved(proportional(tmp_path, 190.0), "stable", plant).verdict == "proved"


@pytest.mark.slow
def test_a_stable_straight_loop_is_never_refuted(tmp_path: Path) -> None:
    generator = np.random.default_rng(11)
    seen = 0
    for number in range(200):
        if seen == 12:
            break
        a = generator.normal(size=(2, 2)) * 10.0 ** generator.uniform(-1, 1.5)
        b = generator.normal(size=2) * 10.0 ** generator.uniform(-1, 1)
        gain = float(generator.normal() * 10.0 ** generator.uniform(-1, 1))
        block = np.zeros((3, 3))
        block[:2, :2], block[:2, 2] = a, b
        step = exponential(block * 0.01 / 64)
        for _ in range(6):
            step = step @ step
        closed = step[:2, :2] + np.outer(step[:2, 2], [-gain, 0.0])
        if not max(abs(np.linalg.eigvals(closed))) < 0.999:
            continue
        seen += 1
        size = float(10.0 ** generator.uniform(0, 3))
        rows = [f"{r[0]!r}*x[0] + {r[1]!r}*x[1] + {c!r}*u[0]" for r, c in
                zip(a.tolist(), b.tolist(), strict=True)]  # fmt: skip
        body = OSCILLATOR.replace("-1.0, 1.0", f"{-size!r}, {size!r}").replace(
            "[x[1], -25.0*x[0] + 0.2*x[1] + 10.0*u[0]]", f"[{', '.join(rows)}]"
        ).replace("duration = 60.0", "duration = 2.0")  # fmt: skip
        plant = plant_file(tmp_path, body, f"p{number}.py")
        verdict = proved(proportional(tmp_path, gain), "stable", plant)
        assert verdict.verdict != "refuted", (a, b, gain)
    assert seen == 12


# ── tracebacks, and claims that contradict themselves ────────────────────────────────


@pytest.mark.slow
def test_a_rate_without_a_filter_has_a_verdict_and_no_warning(tmp_path: Path) -> None:
    plant = lag(tmp_path, "u[0] - x[0]")
    lines = "  e = error of y\n  r = rate of e\n  drive u = e + r * 0.01\n"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        verdict = proved(controller(tmp_path, lines, "50 ms"), "stable", plant)
    # y+ = a y + b u, u = -y - 0.01 (y - y-) / 0.05, exactly.
    a, b = np.exp(-0.05), 1.0 - np.exp(-0.05)
    assert max(abs(np.linalg.eigvals([[a - 1.2 * b, 0.2 * b], [1.0, 0.0]]))) < 1.0
    assert verdict.verdict == "proved"


def test_a_name_of_a_state_and_of_another_output_is_refused(tmp_path: Path) -> None:
    body = OSCILLATOR.replace(
        "    def derivative", "    def measure(self, t, x, u, p):\n        return [x[1]]\n"
        "    def derivative"
    )  # fmt: skip
    plant = plant_file(tmp_path, body)
    text = proportional(tmp_path, 0.1)
    with pytest.raises(ValueError, match="of another value"):
        proved(text, "from y in 1 .. 1: y in 0 .. 1 during 0 .. 1 s", plant)


@pytest.mark.slow
def test_an_output_that_reads_a_drive_has_a_verdict(tmp_path: Path) -> None:
    body = LAG.replace('"y": Port("m", -10.0, 10.0)', '"y": Port("m"), "z": Port("m")').replace(
        "[RATE]",
        "[u[0] - x[0]]\n    def measure(self, t, x, u, p):\n        return [x[0], x[0] + u[0]]",
    )
    plant, text = plant_file(tmp_path, body), proportional(tmp_path, 2.0)
    for claim in ("from y in 0.5 .. 1: u in -2 .. 0 during 0 .. 0.1 s", "stable", "y in -1 .. 1"):
        verdict = proved(text, claim, plant)
        assert verdict.verdict == "undecided"
        assert verdict.reason.endswith("depends on an input at once")


def test_a_run_beyond_a_bound_of_the_plant_still_refutes(tmp_path: Path) -> None:
    plant = lag(tmp_path, "x[0]")  # y = 0.5 e^t, whatever the drive: 1.006876 at 0.7 s
    claim = "from y in 0.5 .. 0.5: y in -1 .. 1 during 0 .. 1 s"  # ln 2 = 0.693 s
    verdict = proved(proportional(tmp_path, 1.0), claim, plant)
    assert verdict.verdict == "refuted"
    assert verdict.evidence[1] == "y = 1.00688 after 0.7 s"


@pytest.mark.slow
def test_a_budget_holds_within_half_of_it() -> None:
    servo = load_controller(shipped("servo.frb"))
    begun = time.thread_time()
    verdict = prove_loop(servo, read_claim("stable from position in -6 .. 6", "motor"), budget=4.0)
    assert verdict.verdict == "undecided"
    assert time.thread_time() - begun < 6.0


@pytest.mark.slow
def test_an_elimination_stops_in_time() -> None:
    generator = np.random.default_rng(1)
    square = generator.integers(-(10**6), 10**6, (150, 150)).astype(object)
    rows = [[exact(Fraction(int(x), 10**6 + 3)) for x in row] for row in square @ square.T]
    begun = time.thread_time()
    with pytest.raises(TimeOverError), Stop(0.2):
        is_positive_definite(rows)
    assert time.thread_time() - begun < 1.0
    with Stop(-1.0):  # a stop within has no more time than that
        inner = Stop()
    assert inner.now


@pytest.mark.slow
def test_a_check_stops_in_time(
    servo: ControllerText,
    servo_verdict: LoopVerdict,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = str(tmp_path / "c.json")
    write_certificate(servo_verdict.certificate, path)
    begun = time.thread_time()
    late = check_certificate(path, servo, budget=0.05)
    assert time.thread_time() - begun < 1.0
    assert late.verdict == "undecided"
    assert late.reason.endswith("time ran out")
    assert main(["prove", "--check", path, "--budget", "0.05"]) == 4
    assert "undecided" in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize("claim", ["stable", "from y in 1 .. 1: y in -2 .. 2 during 0 .. 1000000 s",
                                   "stable from y in 0.5 .. 0.6"])  # fmt: skip
def test_runs_of_a_proof_stop_in_time(tmp_path: Path, claim: str) -> None:
    body = LAG.replace("duration = 1.0", "longest_step = 1e-7\n    duration = 1e5")
    plant = plant_file(tmp_path, body.replace("RATE", "u[0] - x[0]"))
    text = proportional(tmp_path, 0.5)
    begun = time.thread_time()
    verdict = prove_loop(text, read_claim(claim, plant), budget=2.0)
    assert time.thread_time() - begun < 3.0
    assert verdict.verdict != "refuted"


def test_the_solver_of_inequalities_stops_in_time() -> None:
    late = np.zeros((1, 2, 2)), np.array([[[[-1.0, 0.0], [0.0, 1.0]]]])  # never both above 0
    assert feasible_point([Inequality(*late)], np.zeros(1), Stop(0.0)) is None
    inside = Inequality(np.eye(2)[None], np.array([[[[1.0, 0.0], [0.0, -1.0]]]]))
    assert minimise([inside], np.ones(1), np.zeros(1), Stop(0.0)) == 0.0
    assert minimise([inside], np.ones(1), np.zeros(1), Stop()) < -0.9


ERRORS = """
class Lag(Plant):
    inputs = {"u": Port("V", -20.0, 20.0)}
    outputs = {"y": Port("m", -10.0, 10.0, error_bound=1.0)}
    states = {"y": "m"}
    duration = 2.0
    def derivative(self, t, x, u, p):
        return [u[0] - 0.2*x[0]]
"""
TWO_INPUTS = """
class Two(Plant):
    inputs = {"u": Port("V", -4.0, 4.0), "w": Port("V", -3.0, 3.0, start=0.5)}
    outputs = {"y": Port("m", -20.0, 20.0), "z": Port("m", -20.0, 20.0)}
    states = {"y": "m", "z": "m"}
    duration = 1.0
    def derivative(self, t, x, u, p):
        return [u[0] - x[0], u[1]]
"""


@pytest.mark.parametrize(("set_point", "lost"), [("0.5", False), ("0", True), ("-0.2", True)])
def test_an_error_is_beyond_its_bound_where_the_output_is_beyond_both(tmp_path, set_point, lost):
    # From 1.25 the error is at most 0.75 at a set point of 0.5, 1.25 at 0 and 1.45 at -0.2.
    plant, start = plant_file(tmp_path, ERRORS), "y in 1.25 .. 1.25"
    claim = f"at y = {set_point} from {start}: y in -9 .. 9 during 0 .. 0.05 s"
    found = proved(proportional(tmp_path, 2.0), claim, plant)
    assert ("beyond the bound" in str(found)) is lost


@pytest.mark.slow
def test_an_actuator_that_nothing_drives_leaves_its_start(tmp_path):
    plant, text = plant_file(tmp_path, TWO_INPUTS), proportional(tmp_path, 1.0)
    for low, verdict in ("-0.01", "proved"), ("0.005", "refuted"):
        claim = f"from y in 0 .. 0.1: z in {low} .. 0.01 during 1 .. 1 s"
        assert proved(text, claim, plant).verdict == verdict


OF_START = """
from fuzzyarm.plant.plant import parameter
def kept(plant):
    plant.extra = 30.0 if 1.2 < parameter(plant, "q").value < 1.3 else 0.0
class Kept(Plant):
    inputs = {"u": Port("V", -4.0, 4.0)}
    outputs = {"y": Port("m", -20.0, 20.0)}
    states = {"y": "m"}
    parameters = {"q": 1.0}
    extra = 0.0
    keep = __neg__ = kept
    value = property(kept)
    def __getitem__(self, name):
        return kept(self)
    def start(self, rng):
        START
        return [0.1 * parameter(self, "q").value]
    def derivative(self, t, x, u, p):
        return [u[0] * p[0] + self.extra]
"""


@pytest.mark.parametrize(
    ("start", "refused"),
    [
        ("pass", False),
        ("low = max(0.0, 1.0)", False),
        ("kept(self)", True),
        ("self.extra = 30.0 if 1.2 < self.parameters['q'] < 1.3 else 0.0", True),
        ("vars(self)['extra'] = 0.0", True),
        ("setattr(self, 'extra', 0.0)", True),
        ("self.__setattr__('extra', 0.0)", True),
        ("self.keep()", True),
        ("self.value", True),
        ("-self", True),
        ("self['q']", True),
        ("other = self", True),
    ],
)
def test_a_start_that_may_keep_a_parameter_has_no_interval_of_it(tmp_path, start, refused):
    plant = plant_file(tmp_path, OF_START.replace("START", start))
    claim = "with q in 1 .. 2 from y in 0 .. 0.1: y in -1 .. 1 during 0 .. 0.1 s"
    found = proved(proportional(tmp_path, 1.0), claim, plant)
    assert (found.verdict == "undecided" and "by its name" in found.reason) is refused
    assert (found.verdict == "proved") is not refused


BY_A_SWITCH = """
controller c
period 50 ms
axis lag
  e = error of y
  n = e * -1
  r = MEMORY
  k = e where r < 0.5 else n
  drive u = k
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "memory", ["relay of e, width 0.4, levels 0 .. 1", "hysteresis of e, width 0.4"]
)
def test_a_loop_is_not_refuted_at_a_rest_to_which_its_memory_does_not_come(tmp_path, memory):
    """A relay rests at either level, and begins low: the law of its high one was refuted."""
    plant = plant_file(tmp_path, LAG.replace("RATE", "u[0]"))
    path = tmp_path / "switch.frb"
    path.write_text(BY_A_SWITCH.replace("MEMORY", memory))
    assert proved(load_controller(path), "stable from y in -0.1 .. 0.1", plant).verdict != "refuted"
    inside = "from y in -0.1 .. 0.1: y in -0.03 .. 0.03 during 2 .. 2.5 s"
    assert proved(load_controller(path), inside, plant).verdict == "proved"
    path.write_text(
        BY_A_SWITCH.replace("r = MEMORY", "r = n").replace("e where r < 0.5 else n", "n * 1")
    )
    assert proved(load_controller(path), "stable", plant).verdict == "refuted"
