"""A claim says which loop, start and time it is about; a certificate means what it says."""

from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import importlib
import json
import math
import os
import sys
from fractions import Fraction
from pathlib import Path

import pytest

from fuzzyarm import load_controller, prove, shipped
from fuzzyarm.apps.cli.main import main
from fuzzyarm.control.loop.course import Sensor
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.plant.own import PLANTS, find_plant
from fuzzyarm.plant.plant import PlantError, Port, with_parameters
from fuzzyarm.proof.check import check_certificate
from fuzzyarm.proof.check.checking import region_lines
from fuzzyarm.proof.claim.identity import loop_digests
from fuzzyarm.proof.claim.problem import ClaimError, LoopProofError, loop_problem
from fuzzyarm.proof.claim.text import claimed_periods, claimed_plant, loop_sentence, require_sense
from fuzzyarm.proof.loop import (
    CertificateError,
    MapSearch,
    certify_tube,
    loop_tube,
    map_starts,
    prove_loop,
    read_claim,
    write_certificate,
)

PLANT = """
from fuzzyarm.plant import Plant, Port
class {name}(Plant):
    inputs = {{"u": Port("V", -5.0, 5.0)}}
    outputs = {{"y": Port("m", -10.0, 10.0)}}
    states = {states}
    parameters = {parameters}
    duration = 1.0
    def start(self, rng):
        return {start}
    def derivative(self, t, x, u, p):
        return {rates}
"""

LAW = "controller c\nperiod 10 ms\naxis a\n  e = error of y\n  drive u = e * 2\n{}"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def plant_file(
    name="lag", start="[0.5]", states='{"y": "m"}', parameters="{}", rates="[u[0] - x[0]]"
):
    text = PLANT.format(
        name=name.title(), start=start, states=states, parameters=parameters, rates=rates
    )
    Path(f"{name}.py").write_text(text, encoding="utf-8")
    return f"{name}.py"


def law(lines=""):
    Path("c.frb").write_text(LAW.format(lines), encoding="utf-8")
    return load_controller("c.frb")


# --- In which time ---


@pytest.mark.parametrize(
    ("begin", "end", "jumps", "expected"),
    [
        (0.0, 0.003, False, (0, 2)),
        (0.0, 0.003, True, (0, 3)),  # what a drive becomes at the end counts
        (0.001, 0.001, False, (0, 0)),  # an instant on a sample: where the period before ends
        (0.001, 0.001, True, (0, 1)),
        (0.003, 0.007, False, (3, 6)),
        (0.003, 0.007, True, (2, 7)),
        (0.0, 0.0035, True, (0, 3)),
        (0.003, math.inf, False, (3, None)),
        (0.003, math.inf, True, (2, None)),
        (0.0, 1.001, False, (0, 1000)),
    ],
)
def test_periods_in_which_a_claim_counts(begin, end, jumps, expected):
    claim = LoopClaim("motor", output="y", when="during", begin=begin, end=end)
    assert claimed_periods(claim, 0.001, jumps=jumps) == expected


def test_a_drive_counts_with_its_new_value_at_the_end(folder):
    name, text = plant_file(), law()
    # y = 0.5 at the start: u = -1 in the first period, and -0.9702 in the second one.
    within = f"on '{name}': u in -1.0001 .. -0.99 during 0 .. "
    assert prove_loop(text, read_claim(f"{within}9 ms")).proved
    assert prove_loop(text, read_claim(f"{within}10 ms")).verdict == "refuted"
    assert prove_loop(
        text, read_claim(f"on '{name}': u in -1.0001 .. -0.97 during 0 .. 10 ms")
    ).proved


@pytest.mark.parametrize(
    ("during", "proved"),
    [
        ("0 .. 10 ms", True),
        ("0 .. 10.00000000005 ms", False),
        ("10 .. 10 ms", True),
        ("10.00000000005 .. 10.00000000005 ms", False),
        ("9.99999999995 .. 10 ms", True),
    ],
)
def test_the_end_of_a_claim_is_its_decimal(folder, during, proved):
    name = plant_file(rates="[900 * u[0]]", start="[0]")
    Path("c.frb").write_text(LAW.replace("e * 2", "e * 0 + 1").format(""), encoding="utf-8")
    text = load_controller("c.frb")
    # y is 9 at 10 ms, and 4.5e-11 more after 5e-14 s.
    claim = f"on '{name}' from y in 0 .. 0: y in -1 .. 9.00000000001 during {during}"
    assert prove_loop(text, read_claim(claim)).proved is proved


@pytest.mark.parametrize(
    "fields",
    [
        {"when": "always", "end": 1.0},
        {"when": "always", "begin": 1.0},
        {"when": "during", "begin": 1.0, "end": 0.5},
        {"when": "during", "begin": -1.0, "end": 0.5},
        {"when": "during", "end": 0.0},
        {"when": "during", "end": -1.0},
        {"when": "during", "end": math.inf},
        {"when": "after", "begin": 1.0, "end": 2.0},
        {"when": "after", "begin": -1.0},
        {"low": 1.0, "high": 0.0},
        {"low": math.nan},
        {"low": -math.inf},
        {"start": (("y", 0.0, 1.0), ("y", 2.0, 3.0))},
        {"at": (("y", 0.0), ("y", 1.0))},
        {"at": (("y", math.nan),)},
        {"output": "", "high": 0.0},
        {"output": "", "high": 0.0, "stable": True, "begin": 1.0},
    ],
)
def test_a_claim_that_means_nothing_is_refused(fields):
    with pytest.raises(ClaimError):
        require_sense(LoopClaim("motor", **{"output": "y", "high": 1.0, **fields}))


# --- Certificates with other fields ---


def sealed(data):
    data = {name: value for name, value in data.items() if name != "seal"}
    text = json.dumps(data, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return {**data, "seal": hashlib.sha256(text.encode()).hexdigest()}


@pytest.fixture(scope="module")
def certificate(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("certificate"))
        name, text = plant_file(), law()
        claim = read_claim(f"on '{name}' from y in 0.4 .. 0.5: y in 0.3 .. 0.6 during 0 .. 30 ms")
        write_certificate(certify_tube(text, claim), "c.json")
        assert check_certificate("c.json", trust=True).proved
        return json.loads(Path("c.json").read_text(encoding="utf-8"))


@pytest.fixture
def certified(folder, certificate):
    """A certificate, in a folder with its plant and its controller."""
    plant_file()
    law()
    return certificate


def checked(data, **claim):
    data = {**data, "claim": {**data["claim"], **claim}}
    Path("c.json").write_text(json.dumps(sealed(data)), encoding="utf-8")
    return check_certificate("c.json", trust=True)


@pytest.mark.parametrize(
    "claim",
    [
        {"when": "always"},
        {"when": "after", "from": "0"},
        {"when": "always", "to": "0", "between": ["-100", "-99"]},
        {"when": "after", "to": "0", "between": ["-100", "-99"]},
        {"to": "-1", "between": ["-100", "-99"]},
        {"to": "0", "between": ["-100", "-99"]},
        {"from": "5", "to": "1/1000", "between": ["-100", "-99"]},
        {"start": [["y", "0", "1"], ["y", "2/5", "1/2"]]},
        {"output": "", "between": ["0", "0"]},
    ],
)
def test_a_sealed_certificate_of_a_claim_without_a_meaning_is_none(certified, claim):
    with pytest.raises(CertificateError, match="means nothing"):
        checked(certified, **claim)


@pytest.mark.parametrize(
    "claim",
    [
        {"between": ["-100", "-99"]},
        {"start": [["y", "0", "1/2"]]},
        {"to": "1"},
        {"output": "u"},
        *(
            {"from": at, "to": at, "between": ["-100", "-99"]}
            for k in (1, 2, 3)
            for at in (f"{k}/100", str(Fraction(0.01) * k), str(Fraction(k / 100)))
        ),
        {"from": "1/3000", "to": "1/2500", "between": ["-100", "-99"]},
    ],
)
def test_a_sealed_certificate_of_a_false_claim_proves_nothing(certified, claim):
    assert checked(certified, **claim).verdict == "undecided"


@pytest.mark.slow
def test_an_instant_on_a_sample_is_proved_with_its_value(certified):
    instant = {"from": "1/50", "to": "1/50"}
    assert checked(certified, **instant).proved
    # y' is about -3 y, so that y is at most 0.4852 from 10 ms on, and 0.4709 at 20 ms.
    assert checked(certified, between=["3/10", "49/100"], **instant).proved
    assert not checked(certified, between=["3/10", "47/100"], **instant).proved
    assert checked(certified, start=[]).proved  # from 0.5, where the plant begins by itself


def test_a_certificate_names_all_files(certified):
    data = {**certified, "sha256": {}}
    with pytest.raises(CertificateError, match="this certificate is of"):
        checked(data)


# --- Which start ---


DRAWN = "[0.0 * x + float(rng.standard_normal()) for x in (1.0,)]"


@pytest.mark.slow
@pytest.mark.parametrize(
    "start", [DRAWN, "[rng.uniform(0.1, 0.2)]", "[float(__import__('random').random())]"]
)
def test_a_start_that_is_drawn_has_to_be_said(folder, start):
    name, text = plant_file(start=start), law()
    verdict = prove_loop(text, read_claim(f"on '{name}': y in -9 .. 9 during 0 .. 100 ms"))
    assert verdict.verdict == "undecided"
    assert "draws where it starts" in verdict.reason
    assert "from y in LOW .. HIGH" in verdict.reason
    with pytest.raises(LoopProofError, match="draws where it starts"):
        loop_tube(text, read_claim("stable", name), 0.1)
    said = f"on '{name}' from y in -1 .. 1: y in -9 .. 9 during 0 .. 100 ms"
    assert prove_loop(text, read_claim(said)).proved
    assert prove_loop(text, read_claim(f"stable on '{name}'")).proved  # from no start


def test_a_certificate_does_not_make_a_drawn_start_known(folder):
    name, text = plant_file(), law()
    write_certificate(
        certify_tube(text, read_claim(f"on '{name}': y in -9 .. 9 during 0 .. 20 ms")), "c.json"
    )
    plant_file(start="[rng.uniform(0.5, 5)]")
    with pytest.raises(CertificateError, match=r"lag\.py is not the plant that was proved"):
        check_certificate("c.json", trust=True)
    data = json.loads(Path("c.json").read_text(encoding="utf-8"))
    data["proved"] = loop_digests(text, find_plant(name))  # forged
    Path("c.json").write_text(json.dumps(sealed(data)), encoding="utf-8")
    verdict = check_certificate("c.json", trust=True)
    assert verdict.verdict == "undecided"
    assert "draws where it starts" in verdict.reason


@pytest.mark.slow
def test_a_start_made_of_a_parameter_follows_it():
    text = load_controller("rulebases/cartpole.frb")
    tail = ": theta in -0.1 .. 0.1 during 0 .. 100 ms"
    wide = prove_loop(text, read_claim(f"on cartpole with theta_0 in 0.05 .. 0.3{tail}"))
    assert wide.verdict == "undecided"
    assert "makes its start of 'theta_0'" in wide.reason
    # theta begins at 0.3 where the parameter is 0.3.
    point = prove_loop(text, read_claim(f"on cartpole with theta_0 in 0.3 .. 0.3{tail}"))
    assert point.verdict == "refuted"
    other = prove_loop(text, read_claim(f"on cartpole with M in 1 .. 1.1{tail}"))
    assert other.verdict != "refuted"
    assert "makes its start" not in other.reason


@pytest.mark.parametrize(
    "read",
    ["self.parameters", "{**self.parameters}", "dict(self.parameters)", "self.parameters.copy()",
     "(self.parameters | {})", "({} | self.parameters)", "dict(self.parameters.items())"],
)  # fmt: skip
def test_a_start_made_of_a_copy_of_the_parameters_follows_them(folder, read):
    name, text = (
        plant_file(start=f"[float({read}['b'])]", parameters="{'b': 1.0}"),
        law(),
    )
    verdict = prove_loop(
        text, read_claim(f"on '{name}' with b in 1 .. 2: y in -1.1 .. 1.1 during 0 .. 100 ms")
    )
    assert verdict.verdict == "undecided"
    assert "makes its start of 'b'" in verdict.reason


@pytest.mark.slow
def test_a_verdict_says_where_states_begin_that_a_claim_leaves_out(folder):
    name = plant_file(
        states='{"y": "m", "v": "m/s"}', start="[0.5, 0.25]", rates="[x[1], u[0] - x[1]]"
    )
    verdict = prove_loop(
        law(), read_claim(f"on '{name}' from y in 0 .. 0.1: y in -1 .. 1 during 0 .. 50 ms")
    )
    assert verdict.evidence == ("of runs that start as the plant does: v = 0.25",)


# --- Which loop ---


def test_all_that_makes_another_loop_is_in_the_sentence(folder):
    claim = read_claim("stable on motor with J in 1 .. 2")
    assert loop_sentence(claim) == "stable on motor with J in 1 .. 2"
    sensors = {"y": Sensor(delay=0.04, resolution=0.5), "v": Sensor(difference=0.01), "w": Sensor()}
    assert loop_sentence(claim, sensors, {"u": "voltage", "y": "y"}, continuous=True) == (
        "stable on motor with J in 1 .. 2; u joined to voltage;"
        " sensor of y: resolution 0.5, delay 0.04 s;"
        " sensor of v: by difference, filter 0.01 s; in continuous time"
    )


@pytest.mark.slow
def test_the_sentence_of_a_late_sensor_is_that_of_its_certificate(folder):
    name, text = plant_file(), law()
    claim = read_claim(f"stable on '{name}'")
    sensors = {"y": Sensor(delay="20ms")}
    sentence = f"stable on '{name}'; sensor of y: delay 0.02 s"
    verdict = prove_loop(text, claim, sensors=sensors)
    assert verdict.proved
    assert verdict.statement == sentence
    write_certificate(verdict.certificate, "c.json")
    again = check_certificate("c.json", trust=True)
    assert again.proved
    assert again.statement == sentence
    assert main(["compile", "c.frb", "-o", "c.h", "--certificate", "c.json", "--trust"]) == 0
    head = " ".join(Path("c.h").read_text(encoding="utf-8").replace("*", " ").split())
    said = head[head.index(f"{sentence}, as sampled; ") :]
    assert "for starts in an ellipsoid that reaches to y in -" in said
    assert said.index("ellipsoid") < said.index("; certificate ")


def test_gains_that_are_not_those_of_the_file_are_said():
    path = shipped("servo.frb")
    claim = read_claim("stable on motor")
    assert loop_sentence(claim, text=load_controller(path)) == "stable on motor"
    text = load_controller(path, {"G_e": 1.5})
    assert loop_sentence(claim, text=text) == "stable on motor; G_e = 1.5"
    assert loop_sentence(claim, text=load_controller(path, {"G_e": 16.0})) == "stable on motor"


@pytest.mark.slow
def test_a_changed_plant_is_said(servo, servo_verdict):
    motor = find_plant("motor")
    name, value = next((n, p) for n, p in motor.parameters.items())
    number = getattr(value, "value", value) * 1.01
    verdict = prove_loop(
        servo, read_claim("stable on motor"), plant=with_parameters(motor, {name: number})
    )
    assert verdict.statement == f"stable on motor; {name} = {number!r}"
    assert servo_verdict.statement == "stable on motor"


MADE = """
from dataclasses import dataclass
from fuzzyarm.plant import Plant, Port
FALL = 1.0
@dataclass
class Made(Plant):
    k: float = 1.0
    inputs = {"u": Port("V", -5.0, 5.0)}
    outputs = {"y": Port("m", -10.0, 10.0)}
    states = {"y": "m"}
    parameters = {"b": 1.0}
    duration = 1.0
    first = 0.5
    def start(self, rng):
        return [self.first]
    def derivative(self, t, x, u, p):
        return [p[0] * u[0] - FALL * self.k * x[0]]
"""


def made_plant():
    Path("made.py").write_text(MADE, encoding="utf-8")
    return find_plant("made.py")


def attribute(**values):
    def change(plant):
        for name, value in values.items():
            setattr(plant, name, value)
        return plant

    return change


def of_class(plant):
    type(plant).first = 0.25
    return plant


def of_module(plant):
    sys.modules[type(plant).__module__].FALL = 3.0
    return plant


WIDE = {"u": Port("V", -50.0, 50.0)}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda plant: dataclasses.replace(plant, k=2.0), "equations other than those of"),
        (attribute(k=2.0), "equations other than those of"),
        (of_module, "equations other than those of"),
        (attribute(derivative=lambda t, x, u, p: [u[0]]), "equations other than those of"),
        (lambda plant: with_parameters(plant, {"b": 1.5}), "b = 1.5"),
        (attribute(parameters={"b": 1.5}), "b = 1.5"),
        (attribute(inputs=WIDE), "actuator u: -50 .. 50"),
        (attribute(outputs={"y": Port("m", -10.0, 10.0, bound=7.0)}), "bound 7"),
        (attribute(first=0.25), "start y = 0.25"),
        (of_class, "start y = 0.25"),
    ],
)  # fmt: skip
def test_a_plant_that_python_changed_is_said_and_bound(folder, change, words):
    plant, text = made_plant(), law()
    claim = read_claim("y in -1 .. 1 during 0 .. 20 ms", "made.py")
    plain = prove_loop(text, claim, plant=plant)
    assert plain.proved
    assert plain.statement == "on 'made.py': y in -1 .. 1 during 0 .. 0.02 s"
    changed = change(plant)
    verdict = prove_loop(text, claim, plant=changed)
    assert verdict.statement.startswith(f"{plain.statement}; ")
    assert words in verdict.statement
    for certificate in (
        certify_tube(text, claim, plant=changed),
        prove_loop(text, read_claim("stable", "made.py"), plant=changed).certificate,
    ):
        write_certificate(certificate, "c.json")
        with pytest.raises(CertificateError, match="is not the plant that was proved"):
            check_certificate("c.json", trust=True)
        words_ = ["compile", "c.frb", "-o", "c.h", "--certificate", "c.json", "--trust"]
        assert main(words_) == 1
        assert not Path("c.h").exists()
        again = check_certificate("c.json", text, changed)
        assert again.proved
        assert words in again.statement


NEIGHBOURS = [
    ("import helper", "helper.FALL", "helper.py", "helper"),
    ("from pkg import helper", "helper.FALL", "pkg/helper.py", "pkg.helper"),
    ("import pkg.helper", "pkg.helper.FALL", "pkg/helper.py", "pkg.helper"),
    ("import helper", "helper.fall()", "helper.py", "helper"),
]


@pytest.mark.slow
@pytest.mark.parametrize("by_program", [False, True])
@pytest.mark.parametrize(("line", "use", "file", "module"), NEIGHBOURS)
def test_a_helper_that_python_changed_is_said_and_bound(
    folder, monkeypatch, line, use, file, module, by_program
):
    for name in ("helper", "pkg", "pkg.helper"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    Path(file).parent.mkdir(exist_ok=True)
    Path(file).write_text("FALL = 1.0\ndef fall():\n    return FALL\n", encoding="utf-8")
    made = MADE.replace("FALL = 1.0", line).replace("FALL *", f"{use} *")
    Path("made.py").write_text(made, encoding="utf-8")
    text, claim = law(), read_claim("y in -1 .. 1 during 0 .. 20 ms", "made.py")
    if by_program:  # which imports it before the plant does
        monkeypatch.syspath_prepend(str(folder))
        importlib.import_module(module).FALL = 3.0
        owned = sys.modules[module]
        verdict = prove_loop(text, claim, plant=find_plant("made.py"))
        assert verdict.statement == "on 'made.py': y in -1 .. 1 during 0 .. 0.02 s"
        certificate = certify_tube(text, claim, plant=find_plant("made.py"))
        write_certificate(certificate, "c.json")
        assert check_certificate("c.json", trust=True).proved
        assert sys.modules[module] is owned
        return
    plant = find_plant("made.py")
    assert prove_loop(text, claim, plant=plant).statement.endswith("0.02 s")
    sys.modules[module].FALL = 3.0
    assert "equations other than those of" in prove_loop(text, claim, plant=plant).statement
    write_certificate(certify_tube(text, claim, plant=plant), "c.json")
    with pytest.raises(CertificateError, match="is not the plant that was proved"):
        check_certificate("c.json", trust=True)


def test_equations_that_import_a_helper_when_called_are_not_proved(folder):
    Path("helper.py").write_text("FALL = 1.0\n", encoding="utf-8")
    late = MADE.replace("FALL = 1.0\n", "").replace(
        "        return [p[0]", "        from helper import FALL\n        return [p[0]"
    )
    Path("made.py").write_text(late, encoding="utf-8")
    claim = read_claim("y in -1 .. 1 during 0 .. 20 ms", "made.py")
    assert not prove_loop(law(), claim, plant=find_plant("made.py")).proved


def test_a_shipped_plant_is_changed_by_no_program():
    for plant in map(find_plant, PLANTS):
        fresh = find_plant(plant.name)
        for kind in ("inputs", "outputs", "parameters", "states"):
            name, _ = next(iter(getattr(plant, kind).items()))
            before = getattr(fresh, kind)[name]
            with contextlib.suppress(TypeError):
                getattr(plant, kind)[name] = None
            assert getattr(find_plant(plant.name), kind)[name] == before


def test_a_plant_with_the_name_of_another_one_is_said(folder):
    plant = made_plant()
    plant.name = "motor"
    assert "equations other than those of motor" in loop_sentence(
        read_claim("stable on motor"), plant=plant
    )
    other = loop_sentence(read_claim("stable on 'other.py'"), plant=plant)
    assert "a plant given in Python" in other


def changed_rules(text, tmp):
    (rules,) = text.sheets["r"]
    output = dataclasses.replace(rules.outputs[0], outside="extend")
    sheet = dataclasses.replace(rules, outputs=(output,))
    return dataclasses.replace(text, sheets={"r": (sheet,)})


def rewritten_rules(text, tmp):
    path = tmp / "r.frb"
    stamp = path.stat()
    path.write_text(path.read_text(encoding="utf-8").replace("singleton 1", "singleton 0.9"))
    os.utime(path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
    return text


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda text, _: text.with_gains({"K": 1.5}), "K = 1.5"),
        (
            lambda text, _: dataclasses.replace(
                text, model=dataclasses.replace(text.model, period=0.02)
            ),
            "lines other than those of its file",
        ),
        (
            lambda text, _: dataclasses.replace(text, model=text.with_gains({"K": 1.5}).model),
            "K = 1.5",
        ),
        (changed_rules, "r is not as in its file"),
        (rewritten_rules, "r is not as in its file"),
    ],
)
def test_a_controller_that_is_not_that_of_its_file_is_said_and_bound(folder, change, words):
    name = plant_file()
    Path("r.frb").write_text(
        "rulebase r\ninput e -1 .. 1\noutput u -1 .. 1\nterms e: triangles N Z P\n"
        "term u N: singleton -1\nterm u Z: singleton 0\nterm u P: singleton 1\n"
        "inference u: defuzzifier weighted-average\nrule if e is N then u is N\n"
        "rule if e is Z then u is Z\nrule if e is P then u is P\n"
    )
    Path("c.frb").write_text(
        'controller c\nuse r from "r.frb"\nperiod 10 ms\ngain K = 2\naxis a\n'
        "  e = error of y\n  u = rules r(e)\n  drive u = u * K\n"
    )
    text = load_controller("c.frb")
    claim = read_claim(f"stable on '{name}'")
    assert loop_sentence(claim, text=text) == f"stable on '{name}'"
    changed = change(text, folder)
    verdict = prove_loop(changed, claim)
    assert verdict.proved
    assert verdict.statement == f"stable on '{name}'; {words}"
    write_certificate(verdict.certificate, "c.json")
    with pytest.raises(CertificateError, match=r"is not the (controller|file) that was proved"):
        check_certificate("c.json", load_controller("c.frb"), trust=True)


# --- Whose code runs ---


EVIL = "open('ran', 'w').close()\n"


def test_a_line_of_a_file_does_not_run_code(folder):
    name = plant_file()
    text = law(f"prove on '{name}': y in -1 .. 1 during 0 .. 20 ms\n")
    Path(name).write_text(EVIL + Path(name).read_text(encoding="utf-8"), encoding="utf-8")
    (claim,) = text.claims
    for judge in (
        lambda: prove_loop(text, claim),
        lambda: prove(text, claim),
        lambda: prove("c.frb"),
        lambda: certify_tube(text, claim),
        lambda: loop_tube(text, claim, 0.1),
    ):
        with pytest.raises(PlantError, match="is code, which does not run") as error:
            judge()
        assert error.value.hint == "--trust runs it"
        assert not Path("ran").exists()
    assert prove("c.frb", claim, trust=True).proved
    assert Path("ran").exists()
    assert prove("c.frb", trust=True)[0].proved
    assert prove(
        "c.frb", plant=f"./{name}", statement=f"on '{name}': y in -1 .. 1 during 0 .. 20 ms"
    )


def test_a_certificate_does_not_run_code(certified):
    Path("lag.py").write_text(EVIL + Path("lag.py").read_text(encoding="utf-8"), encoding="utf-8")
    write = json.dumps(sealed(certified))
    Path("c.json").write_text(write, encoding="utf-8")
    for words in ({}, {"named": "motor"}):
        with pytest.raises(PlantError, match="is code, which does not run"):
            check_certificate("c.json", **words)
        assert not Path("ran").exists()
    # A file that is named runs in its place, and is another plant.
    other = Path("lag.py").read_text(encoding="utf-8").removeprefix(EVIL)
    Path("other.py").write_text(other.replace("u[0]", "2.0 * u[0]"), encoding="utf-8")
    with pytest.raises(CertificateError, match="is not the plant that was proved"):
        check_certificate("c.json", named="other.py")
    assert not Path("ran").exists()
    assert check_certificate("c.json", named="./lag.py").proved
    assert Path("ran").exists()


@pytest.mark.parametrize(
    "name",
    [
        "../evil.py",
        "evil.py:Some",
        "evil.fmu",
        "evil.xml",
        "gym:evil:Env-v0",
        "menagerie:evil",
        "nothing",
    ],
)
def test_no_plant_but_a_shipped_one_is_loaded_for_a_file(folder, name):
    text = law(f"prove stable on '{name}'\n")
    with pytest.raises(PlantError, match=r"is code, which does not run|no file|no plant"):
        prove_loop(text, text.claims[0])


@pytest.mark.parametrize("name", ["a\0.py", "a\0.py:Some", "a\0.fmu"])
def test_a_name_that_no_path_can_have_is_no_plant(folder, name):
    text = law(f"prove stable on '{name}'\n")
    (claim,) = text.claims
    with pytest.raises(PlantError, match=r"no plant|no file"):
        claimed_plant(claim, "other.py")
    with pytest.raises(PlantError, match=r"no plant|no file"):
        claimed_plant(claim, trust=True)


@pytest.mark.parametrize(("periods", "count"), [("1.5", 2), ("1.0000009", 1), ("2.0000000001", 2)])
@pytest.mark.parametrize(("kind", "port"), [("sensor", "position"), ("actuator", "voltage")])
def test_a_delay_that_the_loop_would_round_is_refused(capsys, kind, port, periods, count):
    words = ["prove", str(shipped("servo.frb")), "--plant", "motor", "--stable"]
    assert main([*words, f"--{kind}-delay", f"{port}={periods}ms"]) == 4
    said = capsys.readouterr().out
    assert "undecided" in said
    assert f"the delay of '{port}' is {periods} control periods" in said
    assert f"{count} of them are 0.00{count} s" in said


def test_a_name_that_the_controller_lacks_is_connected_to_nothing() -> None:
    text = load_controller(shipped("servo.frb"))
    plant = find_plant("motor")
    loop_problem(text, plant, connect={"position": "shaft.position"})
    for name in ("positon", "shaft.speed"):
        with pytest.raises(LoopProofError, match=f"nothing in servo is called '{name}'"):
            loop_problem(text, plant, connect={name: "velocity"})


@pytest.mark.parametrize(
    ("rates", "keeps"),
    [
        ("[u[0] + self.parameters['k'] * x[0]]", ""),
        ("[u[0] + float(getattr(self.parameters['k'], 'value', self.parameters['k'])) * x[0]]", ""),
        ("[u[0] + self.k * x[0]]", "keeps"),
    ],
)
def test_a_parameter_that_equations_read_by_name_has_one_value(folder, rates, keeps):
    start = "[(vars(self).update(k=plain(self.parameters['k'])), 0.1)[1]]" if keeps else "[0.1]"
    plant_file("named", start, parameters="{'k': -1.0}", rates=rates)
    source = Path("named.py").read_text()
    Path("named.py").write_text(
        f"def plain(k):\n    return float(getattr(k, 'value', k))\n{source}"
    )
    Path("c.frb").write_text(LAW.format(""))
    text, plant = load_controller("c.frb"), find_plant("named.py")
    for low, high in ((10.0, 20.0), (20.0, 20.0)):
        claim = read_claim(f"stable with k in {low} .. {high}", "named.py")
        # x' = u + k x with u = -2 x diverges at k = 15 and at 20, and is stable at k = -1.
        assert prove_loop(text, claim, plant=plant).verdict == "refuted"


LIMITED = """
from fuzzyarm.plant import Parameter, Plant, Port
class Limited(Plant):
    axis = "a"
    outputs = {"y": Port("m", -10, 10, bound=100)}
    states = {"x": "m"}
    parameters = {"most": Parameter(5.0, "N", "limit")}
    longest_step = 0.01

    @property
    def inputs(self):
        most = self.parameters["most"].value
        return {"u": Port("N", -most, most)}

    def derivative(self, t, x, u, p):
        return [u[0] + x[0]]
"""


@pytest.mark.slow
def test_ports_have_the_limits_of_the_parameter_that_is_claimed(folder):
    Path("limited.py").write_text(LIMITED)
    Path("c.frb").write_text(LAW.format(""))
    text, plant = load_controller("c.frb"), find_plant("limited.py")
    found = prove_loop(text, read_claim("stable with most in 0.1 .. 0.1", "l.py"), plant=plant)
    # x' = x + u with |u| <= 0.1 is lost from beyond 0.1.
    assert found.verdict == "proved"
    assert 0.0 < found.region["x"][1] <= 0.1
    free = read_claim("stable with most in 0.1 .. 5", "l.py")
    assert prove_loop(text, free, plant=plant).verdict == "undecided"


def test_the_words_of_a_region_stay_inside_it(folder):
    region = {"x": (-0.9523949, 0.9523949), "v": (-1e-7 / 3, 12345678.9)}
    for line in region_lines(region, {"x": 0.87659}):
        name, told, *_ = line.split(" in ") if " in " in line else ("", "")
        if name.strip() in region:
            low, high = (float(end) for end in told.split(" (")[0].split(" .. "))
            assert region[name.strip()][0] <= low < high <= region[name.strip()][1]
    assert "± 0.8765 with" in "".join(region_lines(region, {"x": 0.87659}))
    for line in region_lines(region, {}, arrival=True):  # where runs are, not where they start
        name, told = line.strip().split(" in ")
        low, high = map(float, told.split(" .. "))
        assert low <= region[name][0] < region[name][1] <= high


@pytest.mark.slow
def test_numbers_of_a_claim_stand_in_its_sentence_as_they_are(folder):
    (folder / "plant.py").write_text(
        PLANT.format(
            name="P",
            states='{"y": "m", "x": "m"}',
            parameters={},
            start="[0.0, 1 / 3]",
            rates="[u[0] - x[0], -x[1]]",
        )
    )
    (folder / "c.frb").write_text(LAW.format(""))
    text, plant, third = load_controller("c.frb"), find_plant("plant.py"), 1 / 3
    claim = read_claim(f"stable from y in 0 .. {third!r}", "plant.py")
    found = map_starts(text, claim, MapSearch(5.0, runs=0), plant=plant)
    assert f"of y in 0 .. {third!r} every" in str(found)
    assert f"begin at x = {third!r}" in str(found)
    within = read_claim(f"from y in 0 .. {third!r}: y in -1 .. 1 during 0 .. 0.1 s", "plant.py")
    proved = prove_loop(text, within, plant=plant)
    assert proved.verdict == "proved"
    assert f"x = {third!r}" in str(proved)
    assert loop_sentence(claim, duration=1.23456789).endswith("for 1.23456789 s")


def test_a_port_is_claimed_once(folder):
    name, text = plant_file(), law()
    with pytest.raises(ClaimError, match=r"'lag\.y' is said twice"):
        loop_problem(text, find_plant(name), set_point={"y": 3.0, "lag.y": 0.0})
    sensors = {"y": Sensor(delay="10ms"), "lag.y": Sensor(delay="20ms")}
    with pytest.raises(ClaimError, match=r"'lag\.y' is said twice"):
        loop_problem(text, find_plant(name), sensors=sensors)


def test_what_was_driven_before_the_start_is_refused_where_the_actuator_says_it(folder):
    name = plant_file()
    Path("c.frb").write_text(
        "controller c\nperiod 10 ms\naxis a\n  e = error of y\n  d = driven u\n"
        "  drive u = d * 0.5 + e * 0.1\n"
    )
    text = load_controller("c.frb")
    claim = read_claim(f"on '{name}' from y in 0 .. 0: u in -0.1 .. 0.1 during 0 .. 9 ms")
    assert prove_loop(text, claim).proved
    plant = find_plant(name)
    plant.inputs = {"u": Port("V", -5.0, 5.0, start=4.0)}  # then u = 2 at once
    found = prove_loop(text, claim, plant=plant)
    assert found.verdict == "undecided"
    assert "begins at the start of its actuator" in found.reason


@pytest.mark.slow
def test_a_parameter_that_nothing_reads_is_not_claimed(folder):
    name = plant_file(parameters="{'k': 1.0, 'm': 2.0}", rates="[u[0] - p[0] * x[0]]")
    Path("c.frb").write_text(LAW.format(""))
    text = load_controller("c.frb")
    assert prove_loop(text, read_claim("stable with k in 1 .. 1.5", name)).proved
    for span in ("2 .. 2", "1 .. 3"):
        with pytest.raises(ClaimError, match="reads its parameter 'm'"):
            prove_loop(text, read_claim(f"stable with m in {span}", name))


@pytest.mark.slow
def test_a_certificate_of_other_parameters_is_of_the_same_plant(folder):
    text = load_controller(shipped("servo.frb"))
    for span in ("0.011 .. 0.011", "0.011 .. 0.0111"):
        verdict = prove_loop(text, read_claim(f"stable with J in {span}", "motor"))
        assert verdict.certificate is not None
        write_certificate(verdict.certificate, "c.json")
        assert check_certificate("c.json", text).proved


@pytest.mark.parametrize("delayed", ["sensor", "actuator"])
def test_delays_of_a_part_of_a_period_are_refused_also_of_ports_of_one_name(folder, delayed):
    """The sensor's went unseen beside an actuator of its name, and was taken for one period."""
    rates = "[u[0] - x[0], -x[1]]"
    text = PLANT.format(
        name="P", states='{"y": "m", "x": "m"}', parameters={}, start="[0.0, 0.0]", rates=rates
    )
    text = text.replace("10.0)}\n    states", '10.0), "u": Port("m")}\n    states')
    if delayed == "actuator":
        text = text.replace("-5.0, 5.0", "-5.0, 5.0, delay=0.013")
    (folder / "p.py").write_text(text)
    (folder / "c.frb").write_text(LAW.format("  z = measured u\n"))
    sensors = {"u": Sensor(delay=0.013)} if delayed == "sensor" else {}
    with pytest.raises(LoopProofError, match=r"1\.3 control periods"):
        loop_problem(load_controller("c.frb"), find_plant("p.py"), sensors=sensors)


def test_the_bounds_of_a_drive_are_its_own_also_beside_an_output_of_its_name(folder):
    """Both had those of the output."""
    text = PLANT.format(
        name="P", states='{"y": "m", "x": "m"}', parameters={}, start="[0.0, 0.1]",
        rates="[u[0] - x[0], -x[1]]",
    )  # fmt: skip
    (folder / "p.py").write_text(text.replace("10.0)}\n    s", '10.0), "u": Port("m")}\n    s'))
    (folder / "c.frb").write_text("controller c\nperiod 10 ms\naxis a\n  drive u = 3\n")
    claim = read_claim("stable", "p.py")
    bounds, _ = loop_tube(load_controller("c.frb"), claim, 0.1, plant=find_plant("p.py"))
    assert bounds.bounds("u", 0.0, 0.1).high == pytest.approx(0.1)
    assert bounds.bounds("driven u", 0.0, 0.1).low == pytest.approx(3.0)


def test_a_delay_of_very_many_periods_is_refused(folder):
    """Each was a state, and the matrices of a loop of 100,000 do not fit into memory."""
    servo, motor = load_controller(shipped("servo.frb")), find_plant("motor")
    delay = {"position": Sensor(delay=100.0)}
    for inside in (False, True):
        with pytest.raises(LoopProofError, match="100,000 control periods"):
            loop_problem(servo, motor, sensors=delay, inside=inside)
