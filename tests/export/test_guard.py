"""Guards of exported C: what passes beside exact V, the latch, the self-test, what is refused."""

from __future__ import annotations

import hashlib
import json
import math
import re
import shutil
import subprocess
from dataclasses import replace
from fractions import Fraction
from operator import mul
from typing import NamedTuple

import needs
import numpy as np
import pytest
from budget import cases
from c_programs import HOST, compile_c, need

import fuzzyarm
from fuzzyarm.apps.cli.main import main
from fuzzyarm.control.controllers.text import read_controller
from fuzzyarm.exchange.compiled import certified, controller_program, making_of
from fuzzyarm.exchange.export.arduino import board_part
from fuzzyarm.exchange.export.boards import board_named
from fuzzyarm.exchange.export.controller_lowering import controller_program as lowered
from fuzzyarm.exchange.export.trial import EvaluatedController
from fuzzyarm.exchange.export.walk_of_steps import steps_of
from fuzzyarm.plant.own import trusted_plant
from fuzzyarm.proof.check.walk import ProgramWalk
from fuzzyarm.proof.loop import loop_problem
from fuzzyarm.requests.making import ExportRequest
from fuzzyarm.symbolic.evaluation import evaluate
from fuzzyarm.symbolic.nodes import apply, constant

LOOPS = {
    "servo": ("--plant", "motor"),  # no current is measured
    "cartpole": ("--plant", "cartpole"),  # all states are
    "heater": ("--plant", "room", "--at", "temperature=21"),  # memory, and a rest away from 0
}


class Guarded(NamedTuple):
    """A shipped controller with a fallback, its certificate, and its C."""

    name: str
    folder: object
    certificate: dict
    source: str

    @property
    def delta(self):
        return Fraction(re.search(r"V <= 1 [+-] ([-0-9.e]+)", self.source)[1])

    @property
    def whole(self):
        return "a state that passes has V <= 1" in self.source


def with_fallback(folder, name, words="on leaving 0"):
    """Put a shipped controller with a fallback into a folder; return its path."""
    for path in fuzzyarm.shipped("pd7.frb").parent.glob("*.frb"):
        shutil.copy(path, folder)
    path = folder / f"{name}.frb"
    path.write_text(re.sub(r"(\n  drive .*)", rf"\1, {words}", path.read_text()))
    return path


def proved(path, *words):
    """Prove that a controller is stable; return its certificate."""
    out = path.with_suffix(".json")
    assert main(["prove", str(path), *words, "--stable", "--certificate", str(out)]) == 0
    return out


MADE: dict[str, Guarded] = {}


@pytest.fixture
def guarded(tmp_path_factory, request):
    """One of the loops, made once."""
    if request.param not in MADE:
        path = with_fallback(tmp_path_factory.mktemp(request.param), request.param)
        certificate = proved(path, *LOOPS[request.param])
        out = path.with_suffix(".c")
        assert main(["compile", str(path), "-o", str(out), "--guard", str(certificate)]) == 0
        data = json.loads(certificate.read_text())
        MADE[request.param] = Guarded(request.param, path.parent, data, out.read_text())
    return MADE[request.param]


every_loop = pytest.mark.parametrize("guarded", LOOPS, indirect=True)
on_servo = pytest.mark.parametrize("guarded", ["servo"], indirect=True)

# ── exact V, from the file of the certificate ────────────────────────────────────────


def least_v(certificate, known):
    """Return V's matrix over some states, at the least over the others: by elimination."""
    region = certificate["regions"][0]
    names, p = region["states"], [[Fraction(x) for x in row] for row in region["p"]]
    order = [k for k, name in enumerate(names) if name not in known]
    order += [names.index(name) for name in known]
    p = [[p[i][j] for j in order] for i in order]
    for k in range(len(names) - len(known)):
        for i in range(k + 1, len(p)):
            factor = p[i][k] / p[k][k]
            p[i] = [x - factor * y for x, y in zip(p[i], p[k], strict=True)]
    first = len(names) - len(known)
    return [row[first:] for row in p[first:]]


def known_states(guarded):
    """Return members of C by the state of the loop that is in them, in the order of the guard."""
    region = guarded.certificate["regions"][0]
    memory = {name: f"s.{key.split(':')[2]}" for name, key in region["loop"]["memory"].items()}
    members = {
        name: memory.get(name, f"measured.{name}")
        for name in region["states"]
    }  # fmt: skip
    pattern = rf"^bool {guarded.name}_left[^\n]*\n{{.*?\n}}"
    text = re.search(pattern, guarded.source, re.DOTALL | re.MULTILINE)[0]
    return {n: m for n, m in members.items() if re.search(rf"\b{m.split('.')[1]}\b", text)}


def border(matrix, centre, count, delta):
    """Return states at most a few δ from W = 1, as numbers of 32 bits, and W exactly."""
    draw = np.random.default_rng(5)
    plain = np.array([[float(x) for x in row] for row in matrix])
    upper = np.linalg.cholesky(plain).T
    way = draw.normal(size=(count, len(matrix)))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    size = np.sqrt(1.0 + float(delta) * draw.uniform(-3.0, 3.0, (count, 1)))
    return (np.linalg.solve(upper, (way * size).T).T + centre).astype(np.float32)


def exact_values(matrix, centre, states):
    """Yield W of states, exactly: as whole numbers over one denominator."""
    cells = [x for row in matrix for x in row]
    over = math.lcm(*(x.denominator for x in cells))
    unit = math.lcm(2**160, *(c.denominator for c in centre))
    weights = [[int(x * over) for x in row] for row in matrix]
    middle = [int(c * unit) for c in centre]
    whole = over * unit**2
    for state in states.tolist():
        off = []
        for x, c in zip(state, middle, strict=True):
            top, bottom = x.as_integer_ratio()
            off.append(top * (unit // bottom) - c)
        rows = (sum(map(mul, row, off)) for row in weights)
        yield sum(map(mul, rows, off)), whole


DRIVER = """
int main(void)
{{
    float x[{count}];
    while (fread(x, sizeof x, 1, stdin) == 1) {{
        {name}_state s;
        {name}_reference reference = {{{references}}};
        {name}_measured measured;
        {name}_init(&s);
        {first}
        {load}
        putchar({name}_left(&s, &reference, &measured) ? '1' : '0');
    }}
    return 0;
}}
"""


def passes(guarded, states, flags=()):
    """Return which states a compiled guard lets pass."""
    members = known_states(guarded)
    references = {"heater": "21.0f", "servo": "0.0f, 0.0f", "cartpole": "0.0f, 0.0f"}
    text = DRIVER.format(
        name=guarded.name, count=len(members), references=references[guarded.name],
        first="s.first = false;" if "bool first" in headers(guarded) else "",
        load="\n        ".join(f"{m} = x[{k}];" for k, m in enumerate(members.values())),
    )  # fmt: skip
    source, program = guarded.folder / "driver.c", guarded.folder / f"driver{len(flags)}"
    opening = "#include <stdio.h>\n#include <math.h>\n#include <stdbool.h>\n"
    narrow = "#define double float\n" if flags else ""
    source.write_text(f'{opening}{narrow}#include "{guarded.name}.c"\n{text}')
    need(HOST)
    words = [HOST, "-std=c99", "-O2", *flags, str(source), "-o", str(program), "-lm"]
    subprocess.run(words, check=True, capture_output=True)
    given = states.tobytes()
    done = subprocess.run([str(program)], input=given, capture_output=True, check=True)
    return np.frombuffer(done.stdout, np.uint8) == ord("0")


def headers(guarded):
    return (guarded.folder / f"{guarded.name}.h").read_text()


ARITHMETIC = {
    "double": (),
    "as on an AVR": ("-fsingle-precision-constant",),
    "contracted": ("-fsingle-precision-constant", "-mfma", "-ffp-contract=fast"),
}


@pytest.mark.slow
@every_loop
def test_what_passes_at_the_border_is_as_the_head_says(guarded):
    region = guarded.certificate["regions"][0]
    known = list(known_states(guarded))
    assert guarded.whole == (len(known) == len(region["states"]))
    assert 0 < guarded.delta < Fraction(1, 5000)
    matrix = least_v(guarded.certificate, known)
    rest = [Fraction(region["loop"]["rest"][name][0]) for name in known]
    states = border(
        matrix, np.array(list(map(float, rest))), cases(10_000, 1_000_000), guarded.delta
    )
    d, table = guarded.delta, []
    for value, whole in exact_values(matrix, rest, states):
        away, margin = (value - whole) * d.denominator, whole * d.numerator
        table.append((away <= 0, away <= -margin, away > margin))
    inside, deep, far = np.array(table).T
    for words in ARITHMETIC.values():
        found = passes(guarded, states, words)
        if guarded.whole:
            assert not (found & ~inside).any()
            assert found[deep].all()
        else:
            assert found[inside].all()
            assert not (found & far).any()
        assert min(found.sum(), (~found).sum()) > 0.2 * len(found)
    odd = np.full((3, len(known)), [[np.inf], [-np.inf], [3e38]], np.float32)
    assert not passes(guarded, odd).any()


@pytest.mark.slow
@on_servo
def test_the_least_v_is_that_of_the_best_current(guarded):
    # The independent elimination against a minimum that is searched.
    (row,) = border(least_v(guarded.certificate, ["position", "velocity"]), np.zeros(2), 1, 0)
    p = np.array([[float(Fraction(x)) for x in r] for r in guarded.certificate["regions"][0]["p"]])
    z = [np.array([*row.astype(float), i]) for i in np.linspace(-90.0, 90.0, 20_001)]
    assert min(x @ p @ x for x in z) == pytest.approx(1.0, abs=1e-5)


# ── the step ─────────────────────────────────────────────────────────────────────────

SEQUENCE = """
#include <stdio.h>
int main(void)
{{
    static {name}_state s, t;
    {name}_reference reference = {{0.0f, 0.0f}};
    {name}_measured measured;
    {name}_drives drive, plain;
    float x[3];
    {name}_init(&s);
    {name}_init(&t);
    while (fread(x, sizeof x, 1, stdin) == 1) {{
        if (x[2] != 0.0f) {{
            {name}_init(&s);
            {name}_init(&t);
        }}
        measured.position = x[0];
        measured.velocity = x[1];
        {name}_guarded_step(&s, &reference, &measured, &drive);
        {name}_step(&t, &reference, &measured, &plain);
        fwrite(&drive.voltage, sizeof(float), 1, stdout);
        fwrite(&plain.voltage, sizeof(float), 1, stdout);
    }}
    return 0;
}}
"""


def run_sequence(folder, rows):
    """Return the drives of guarded and plain steps."""
    (folder / "sequence.c").write_text('#include "servo.c"\n' + SEQUENCE.format(name="servo"))
    program = folder / "sequence"
    compile_c([folder / "sequence.c"], program, HOST, "-Wno-unused-function")
    given = np.array(rows, np.float32).tobytes()
    done = subprocess.run([str(program)], input=given, capture_output=True, check=True)
    return np.frombuffer(done.stdout, np.float32).reshape(-1, 2)


ROWS = [
    (0.05, 0.0, 0), (np.nan, 0.0, 0), (-0.1, 0.5, 0),  # inside, lost, inside
    (3.0, 0.0, 0), (0.05, 0.0, 0), (np.nan, 0.0, 0),  # outside, and back
    (0.05, 0.0, 1),  # init
]  # fmt: skip


@on_servo
def test_once_left_it_sends_the_fallback_until_init(guarded):
    found, plain = run_sequence(guarded.folder, ROWS).T
    assert (found[:3] == plain[:3]).all()
    assert (found[:3] != 0.0).all()
    assert found[3:6].tolist() == [0.0, 0.0, 0.0]
    assert found[6] == plain[6] == found[0]


@on_servo
def test_hold_is_the_last_value(guarded, tmp_path):
    path = with_fallback(tmp_path, "servo", "on nan 3, on leaving hold")
    certificate = proved(path, *LOOPS["servo"])
    assert (
        main(["compile", str(path), "-o", f"{tmp_path}/servo.c", "--guard", str(certificate)]) == 0
    )
    found, plain = run_sequence(tmp_path, ROWS).T
    assert (found[:3] == plain[:3]).all()
    assert found[1] == 3.0
    assert (found[3:6] == found[2]).all()
    assert "voltage holds, until init" in (tmp_path / "servo.c").read_text()


@pytest.mark.slow
@on_servo
def test_the_step_itself_is_as_without_a_guard(guarded, tmp_path):
    out = tmp_path / "servo.c"
    assert main(["compile", f"{guarded.folder}/servo.frb", "-o", str(out)]) == 0
    plain = out.read_text()
    for begin, end in (("\nstatic double servo_least", "void servo_init(servo_state *s)\n{"),
                       ("\nvoid servo_step", "#ifdef FUZZYARM_SELF_TEST")):  # fmt: skip
        code = plain[plain.rindex(begin) : plain.rindex(end)]
        assert len(code) > 500
        assert code in guarded.source


@on_servo
def test_the_head_says_what_is_proved_of_which_plant(guarded):
    head = re.sub(r"\s+\*\s+", " ", guarded.source.partition("*/")[0])
    digest = guarded.certificate["proved"]["plant"]
    for words in (
        "stable on motor, as sampled; for starts in an ellipsoid that reaches to position in",
        "guard: V of position, velocity, the least over current",
        "every state with V <= 1 passes; one that passes has such a V <= 1 + ",
        "of the set points position = 0, velocity = 0; with others or NaN it refuses",
        "after a state that it refuses: voltage = 0, until init",
        f"plant motor, SHA-256 of its equations {digest}",
        "servo_guarded_step every 0.001 s",
    ):
        assert words in head


OWN = """
from fuzzyarm.plant import Plant, Port

class Lag(Plant):
    states = {"y": "V", "z": "V"}
    inputs = {"u": Port("V", -10, 10)}
    outputs = {"y": Port("V", -5, 5), "sum": Port("V", -10, 10)}

    def derivative(self, t, x, u, p):
        return [x[1] - x[0], u[0] - 2 * x[1]]

    def measure(self, t, x, u, p):
        return [x[0], x[0] + 2 * x[1]]
"""


def test_outputs_that_are_sums_of_states_are_known(tmp_path):
    (tmp_path / "lag.py").write_text(OWN)
    path = tmp_path / "c.frb"
    path.write_text(
        "controller c\nperiod 100 ms\naxis a\n  e = error of y\n  m = measured sum\n"
        "  drive u = e * 2 - m * 0.5, within -10 .. 10, on leaving hold\n"
    )
    certificate = proved(path, "--plant", str(tmp_path / "lag.py"))
    out, words = tmp_path / "c.c", ["--guard", str(certificate), "--trust"]
    assert main(["compile", str(path), "-o", str(out), *words]) == 0
    source = out.read_text()
    assert self_test(tmp_path, "c", source) == 0
    digest = hashlib.sha256((tmp_path / "lag.py").read_bytes()).hexdigest()
    assert f"file lag.py, SHA-256 {digest}" in re.sub(r"\s+\*\s+", " ", source)
    assert "a state that passes has V <= 1" in source
    # V = |L k|² of k = (y, y + 2 z) is V of (y, z).
    region = json.loads(certificate.read_text())["regions"][0]
    p = np.array([[float(Fraction(x)) for x in row] for row in region["p"]])
    (a, b), (c,) = (
        [float(x) for x in re.findall(r"[( ]\(?(-?\d\.\d+(?:e-\d+)?)\)? \* off", line)]
        for line in re.findall(r"const double row.*", source)
    )
    factor = np.array([[a, b], [0.0, c]]) @ np.array([[1.0, 0.0], [1.0, 2.0]])
    assert factor.T @ factor == pytest.approx(p, rel=1e-5)


# ── the self-test ────────────────────────────────────────────────────────────────────


def self_test(folder, name, source):
    (folder / "tested.c").write_text(source)
    program = folder / "tested"
    words = [
        HOST,
        "-std=c99",
        "-ffp-contract=off",
        "-DFUZZYARM_SELF_TEST",
        "tested.c",
        "-o",
        program,
    ]
    need(HOST)
    subprocess.run([*map(str, words), "-lm"], cwd=folder, check=True)
    return subprocess.run([str(program)], check=False).returncode


@every_loop
def test_the_self_test_passes(guarded):
    assert self_test(guarded.folder, guarded.name, guarded.source) == 0


LOST = r" && \(measured->velocity == measured->velocity\)(?=\) \{\n        s->left)"
FAULTS = {
    "the limit": (r"<= 1\.00000\d*\)", "<= 1.0001)"),
    "the limit, below": (r"<= 1\.00000\d*\)", "<= 0.9999)"),
    "a weight": (r"(?<=row_2 = )\S+", lambda found: repr(1.0003 * float(found[0]))),
    "the latch": (r"if \(!s->left && ", "if ("),
    "the lost sample": (LOST, ""),
    "a set point": (r"\(\(double\)reference->position == 0\.0\) && ", ""),
    "the fallback": (r"drive->voltage = 0\.0f;", "drive->voltage = 1.0f;"),
    "the test": (r"if \(servo_left\(s, reference, measured\)\)", "if (false)"),
    "init": (r"s->left = false;", "s->left = true;"),
}  # fmt: skip


@on_servo
@pytest.mark.parametrize("fault", FAULTS)
def test_the_self_test_finds_a_fault(guarded, fault):
    damaged, count = re.subn(*FAULTS[fault], guarded.source)
    assert count == 1
    assert self_test(guarded.folder, guarded.name, damaged) == 1


@pytest.mark.slow
@on_servo
def test_an_arduino_library_has_the_guard_at_its_price(guarded, tmp_path):
    needs.need("avr-gcc", "simavr")
    controller = read_controller(str(guarded.folder / "servo.frb"))
    request = ExportRequest(file=controller.path, guard=str(guarded.folder / "servo.json"))
    how = replace(certified(making_of(request), controller, request), precision="float32")
    with_guard, _ = controller_program(controller, how, "float32")
    part = board_part(with_guard, "servo", board_named("uno"))
    assert "servo_guarded_step(&state" in part.sketch
    found = part.measured(board_named("uno"))
    # The same calls of the step without a guard.
    plain = replace(part.call, call=part.call.call.replace("guarded_", ""))
    without = replace(part, call=plain).measured(board_named("uno"))
    assert found.passes
    assert found.stack == without.stack
    assert found.footprint.flash - without.footprint.flash <= 400
    more = np.array(found.cycles) - np.array(without.cycles)
    assert more.min() > 0
    assert more.max() < 300e-6 * 16e6


# ── what the guard reads ─────────────────────────────────────────────────────────────


class Numbers:
    """Floats, by their values, as the numbers of the checker's walk."""

    def number(self, value):
        return Fraction(value)  # a float is infinite there

    def apply(self, operation, arguments):
        found = evaluate(apply(operation, *(constant(float(x)) for x in arguments)), {})
        return bool(found) if operation in ("less", "less_equal", "equal") else Fraction(found)

    def limit(self, x, low, high):
        return Fraction(min(max(float(x), low), high))

    def excess(self, value, x, low, high):
        return value - x

    def rules(self, sheet, output, inputs):
        return Fraction(
            float(fuzzyarm.infer(sheet, {k: float(x) for k, x in inputs.items()})[output])
        )


@pytest.mark.parametrize(("name", "plant"), [("heater", "room"), ("tanks", "tanks")])
def test_memory_has_one_name_in_the_certificate_and_in_the_program(name, plant):
    text = read_controller(str(fuzzyarm.shipped(f"{name}.frb")))
    steps = steps_of(text)
    problem = loop_problem(text, trusted_plant(plant))
    walk, program = ProgramWalk(problem), EvaluatedController(lowered(steps))
    assert {key for key in walk.states if key in steps.variables}
    assert {x.symbol for x in steps.of_sort("state")} <= set(walk.states)
    states = {key: Fraction(x) for key, x in walk.states.items()}
    (port,) = steps.of_sort("measured")
    draw = np.random.default_rng(3)
    for k in range(30):
        value = Fraction(float(draw.normal()))
        reference = [0.0] * len(steps.of_sort("reference"))
        program.step(*reference, float(value))
        outputs = dict.fromkeys(problem.site.interface.outputs, Fraction(0))
        outputs[problem.site.find(text.model, "measured", (port.axis, port.name))] = value
        _, states = walk.period(Numbers(), outputs, states, first=k == 0)
        for key in walk.states:
            if key in steps.variables:
                assert program.value(key) == pytest.approx(float(states[key]), rel=1e-9, abs=1e-12)


# ── refusals ─────────────────────────────────────────────────────────────────────────


def refusal(capsys, *words):
    assert main([str(word) for word in words]) in (1, 2)
    return capsys.readouterr().err


@pytest.mark.slow
@on_servo
def test_only_what_has_a_guard_gets_one(guarded, tmp_path, capsys):
    path, certificate = guarded.folder / "servo.frb", guarded.folder / "servo.json"
    out = tmp_path / "x.h"
    told = refusal(capsys, "compile", path, "-o", tmp_path / "x.st", "--guard", certificate)
    assert "a guard is exported in C, and 'x.st' is not" in told
    told = refusal(capsys, "compile", path, "-o", out, "--guard", certificate, "--table")
    assert "the certificate is about the rules, not about a table or integers" in told
    other = with_fallback(tmp_path, "cartpole")
    told = refusal(capsys, "compile", other, "-o", out, "--guard", certificate)
    assert "this certificate is of servo.frb, not of cartpole.frb" in told
    changed = with_fallback(tmp_path, "servo", "on leaving 1")
    told = refusal(capsys, "compile", changed, "-o", out, "--guard", certificate)
    assert "servo.frb is not the file that was proved" in told
    rulebase = tmp_path / "pd7.frb"
    told = refusal(capsys, "compile", rulebase, "-o", out, "--guard", certificate)
    assert "--guard does not apply" in told
    assert not out.exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--from", "position in 0.4 .. 0.41"), "of tubes, and a guard is made of a region alone"),
        (("--sensor-delay", "position=1ms"), "the sensor of 'position' does not give the state"),
        (("--continuous",), "of the loop in continuous time"),
    ],
)
def test_a_certificate_of_anything_else_is_refused(tmp_path, capsys, words, sentence):
    path = with_fallback(tmp_path, "servo")
    certificate = proved(path, *LOOPS["servo"], *words)
    told = refusal(capsys, "compile", path, "-o", tmp_path / "x.h", "--guard", certificate)
    assert sentence in told


@pytest.mark.slow
@pytest.mark.parametrize(
    ("guarded", "outside"), [("servo", False), ("heater", True)], indirect=["guarded"]
)
def test_a_plant_that_starts_outside_the_region_is_said(guarded, tmp_path, capsys, outside):
    capsys.readouterr()
    path, certificate = (f"{guarded.folder}/{guarded.name}{end}" for end in (".frb", ".json"))
    assert main(["compile", path, "-o", f"{tmp_path}/x.c", "--guard", certificate]) == 0
    told = capsys.readouterr().err
    assert ("room starts at temperature = 15, wall = 15, outside the region" in told) == outside


@pytest.mark.slow
def test_a_drive_without_a_fallback_is_refused(tmp_path, capsys):
    path = with_fallback(tmp_path, "servo", "on nan 0")
    certificate = proved(path, *LOOPS["servo"])
    told = refusal(capsys, "compile", path, "-o", tmp_path / "x.h", "--guard", certificate)
    assert "the drive of 'voltage' does not say what it sends once a guard refuses a state" in told
    assert "add  , on leaving 0  or  , on leaving hold" in told


@on_servo
@needs.requires("gcov")
def test_the_report_of_a_guarded_program_names_its_certificate(guarded, tmp_path):
    words = [f"{guarded.folder}/servo.frb", "-o", f"{tmp_path}/s.c", "--report", f"{tmp_path}/r"]
    assert main(["compile", *words, "--guard", f"{guarded.folder}/servo.json"]) == 0
    settings = (tmp_path / "r" / "report.json").read_text()
    assert f"certificate {guarded.certificate['seal']}" in settings
