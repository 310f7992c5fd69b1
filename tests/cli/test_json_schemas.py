"""What commands print with --json is what docs/schemas says, and the page is made of the same."""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator
from needs import is_here, need

from fuzzyarm import shipped
from fuzzyarm.apps.cli import main

ROOT = Path(__file__).parents[2]
PD7 = str(ROOT / "rulebases" / "pd7.frb")
THERMOSTAT = str(ROOT / "rulebases" / "thermostat.frb")
ALPHA7 = str(ROOT / "rulebases" / "alpha7.frb")
TIPPER2 = str(ROOT / "rulebases" / "tipper2.frb")
TANKS = str(ROOT / "rulebases" / "tanks.frb")
PARTNERS = str(ROOT / "rulebases" / "acdid+fuzzy.frb")
SERVO = str(ROOT / "rulebases" / "servo.frb")


@pytest.fixture(scope="module")
def maker() -> Any:
    spec = importlib.util.spec_from_file_location(
        "make_schemas", ROOT / "tools" / "make_schemas.py"
    )
    assert spec is not None and spec.loader is not None  # noqa: PT018
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


ON_MOTOR = ("--plant", "motor")
BOX = "from position in 0.1 .. 0.11"


FULL = """\
rulebase full
input  e -1 .. 1
input  r -1 .. 1
output u -1 .. 1
terms e, r, u: triangles NB ZE PB
inference and min, or max, implication min, aggregation max, defuzzifier centroid exact
rule if e is power(2) NB and r is NB then u is very NB
rule if e is ZE then u is ZE
rule if e is PB then u is PB
lookup
  levels -1 0 1
  bins e: -0.5 0.5
  round 0.1
expect e = 0, r = 0 -> u = 0 within 0.1
prove e in 0 .. 1 -> u >= -1
prove u rises with e
prove table of u linear within 5
tune
  peaks e, r  mirrored, keep order, partition, gap 2 %
  gain K  0.5 .. 2 times, per axis
  keep u ZE
"""
"""A rule base with a statement of each kind."""

WHOLE = """\
controller whole
period 1 ms
gain K = 16
axis shaft
  e = error of position * K
  r = error of velocity
  u = rules full(e, r)
  drive voltage = u, within -24 .. 24
prove on motor from position in 0.1 .. 0.2: position in -1 .. 1
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Some files: a faulty rule base, one with claims, tables, samples."""
    folder = tmp_path_factory.mktemp("json")
    (folder / "faulty.frb").write_text(
        "rulebase x\ninput e 0 .. 1\noutput u 0 .. 1\nterms e: triangles A B\n"
        "terms u: triangles A B\nrule if e is A then u is C\n"
        "rule if e is B then u is A\nrule if e is B then u is B\n"
    )
    (folder / "doubted.frb").write_text(
        "rulebase x\ninput e 0 .. 1\noutput u 0 .. 1\nterms e, u: triangles A B\n"
        "rule if e is A then u is A\nrule if e is B then u is A\nrule if e is B then u is B\n"
        "prove u in 0 .. 1\n"
    )
    (folder / "claims.frb").write_text(
        Path(PD7).read_text() + "prove u odd\nprove u rises with e\n"
    )
    (folder / "maxima.frb").write_text(
        Path(PD7).read_text().replace("centroid exact", "mean-of-maximum")
    )
    (folder / "endless.frb").write_text(
        "rulebase x\ninput e -inf .. inf\noutput u 0 .. 1\nterm e A: ramp 0 1\n"
        "terms u: triangles A B\ninference no-rule nan\nrule if e is A then u is A\n"
    )
    (folder / "full.frb").write_text(FULL)
    (folder / "whole.frb").write_text(WHOLE + FULL)
    (folder / "part.frb").write_text(WHOLE + FULL.replace("PB then u is PB", "PB then u is ZE"))
    rows = [f"{x / 7},{y / 7},{(x * y + x) / 49}" for x in range(7) for y in range(7)]
    (folder / "samples.csv").write_text("\n".join(["x,y,z", *rows, ""]))
    pairs = [f"{e},{ce},{(e + ce) / 2}" for e in range(-6, 7) for ce in range(-6, 7)]
    (folder / "pairs.csv").write_text("\n".join(["e,ce,u", *pairs, ""]))
    (folder / "flowers.csv").write_text(
        "\n".join(["w,kind", *(f"{x / 16},{'rose' if x < 8 else 'lily'}" for x in range(16)), ""])
    )
    (folder / "script.py").write_text(
        "from simpful import *\nFS = FuzzySystem()\n"
        "FS.add_linguistic_variable('a', LinguisticVariable([\n"
        "    TriangleFuzzySet(0, 0, 1, term='L'), TriangleFuzzySet(0, 1, 1, term='H')]))\n"
        "FS.add_linguistic_variable('y', LinguisticVariable([\n"
        "    TriangleFuzzySet(0, 0, 1, term='L'), TriangleFuzzySet(0, 1, 1, term='H')]))\n"
        "FS.add_rules(['IF (a IS L) THEN (y IS H)', 'IF (a IS H) THEN (y IS L)'])\n"
    )
    return folder


CALLS = {
    "grade": [["grade", str(ROOT / "examples" / "assignments" / "fan")]],
    "cite": [["cite", TIPPER2]],
    "check": [["check", "faulty.frb"], ["check", PD7]],
    "eval": [["eval", PD7, "e=1", "ce=2"]],
    "eval-explain": [
        ["eval", PD7, "e=1", "ce=2", "--explain"],
        ["eval", TIPPER2, "service=2", "food=3", "--explain"],
        ["eval", THERMOSTAT, "error=1", "rate=0", "presence=1", "--explain"],
        ["eval", "endless.frb", "e=-1", "--explain"],
    ],
    "show": [
        ["show", PD7],
        ["show", THERMOSTAT],
        ["show", TIPPER2],
        ["show", "endless.frb"],
        ["show", "full.frb"],
    ],
    "show-table": [["show", str(shipped("thesis-6.1.lut"))]],
    "show-controller": [
        ["show", SERVO],
        ["show", TANKS],
        ["show", "whole.frb"],
        ["show", PARTNERS],
    ],
    "prove": [["prove", "claims.frb"], ["prove", "claims.frb", PD7]],
    "prove-range": [["prove", PD7, "--range"]],
    "prove-slope": [["prove", PD7, "--slope"]],
    "prove-table": [["prove", PD7, "--table", "linear"]],
    "prove-sector": [["prove", PD7, "--sector"], ["prove", PD7, "--sector", "--along", "e=1,ce=1"]],
    "prove-drives": [["prove", SERVO, "--sector"]],
    "margins": [["margins", SERVO]],
    "prove-loop": [
        ["prove", SERVO, *ON_MOTOR, "--stable"],
        ["prove", SERVO, *ON_MOTOR, "--claim", f"{BOX}: position in -1 .. 1", "--for", "3ms"],
    ],
    "prove-tube": [
        ["prove", SERVO, *ON_MOTOR, "--from", BOX.removeprefix("from "), "--for", "3ms"]
    ],
    "prove-map": [
        ["prove", "whole.frb", *ON_MOTOR, "--map", "--over", "position in 0 .. 1", "--budget", "1"]
    ],
    "compile": [
        ["compile", PD7, "-o", "a.lut"],
        ["compile", PD7, "--tolerance", "1", "-o", "b.lut"],
    ],
    "compile-source": [
        ["compile", PD7, "-o", "a.c"],
        ["compile", PD7, "-o", "a.js"],
        ["compile", "maxima.frb", "--direct", "-o", "maxima.c"],
    ],
    "compile-controller": [["compile", SERVO, "--table", "-o", "servo.c"]],
    "compile-report": [
        ["compile", file, "-o", "evident.c", "--report", "evidence"]
        for file in (PD7, "doubted.frb")
    ],
    "convert": [
        ["convert", PD7, "a.fll"],
        ["convert", PD7, THERMOSTAT, "d.frb", "--connect", "pd7/u -> thermostat/error"],
    ],
    "compile-board": [["compile", PD7, "--for", "arduino", "-o", "board"]],
    "convert-script": [["convert", "script.py", "-o", "systems"]],
    "diff-tables": [["diff", "a.lut", "b.lut"], ["diff", "a.lut", "a.lut"]],
    "diff-rules": [["diff", PD7, THERMOSTAT], ["diff", PD7, ALPHA7]],
    "diff-controllers": [["diff", SERVO, TANKS], ["diff", "whole.frb", "part.frb"]],
    "simulate": [["simulate", "pd"], ["simulate", SERVO, "--plant", "motor"]],
    "simulate-list": [["simulate", "--list"]],
    "simulate-gains": [["simulate", SERVO, "--show-gains"]],
    "sweep": [["sweep", SERVO, "--plant", "motor", "--sweep", "J=0.01..0.02:2"]],
    "sweep-controllers": [
        [
            "sweep",
            "pd",
            "pid",
            "fuzzy-lut",
            "--segment",
            "0.3",
            "--hold",
            "0.1",
            "--sweep",
            "payload=0..1:2",
            "--sweep",
            "K_P=20..800:2",
        ]
    ],
    "compare": [["compare", "pd", "fuzzy-lut", "--operations"]],
    "compare-runs": [["compare", SERVO, "--plant", "motor", "--step", "1", "--for", "50ms"]],
    "tune": [
        ["tune", SERVO, "--plant", "motor", "--evals", "3", "--unseen", "2", "-o", "t.frb"],
        ["tune", PD7, "--data", "pairs.csv", "--evals", "3", "--no-linear"],
    ],
    "learn": [["learn", "--segment", "0.1", "--hold", "0.05", "--every", "100", "-o", "l.lut"]],
    "fit": [
        ["fit", "samples.csv", "-o", "f.frb", "--move", "no"],
        ["fit", "flowers.csv", "-o", "g.frb", "--terms", "2", "--shrink", "0.01"],
    ],
    "validate": [["validate", "f.frb", "samples.csv"], ["validate", "g.frb", "flowers.csv"]],
    "validate-log": [
        [
            "validate",
            SERVO,
            "pairs.csv",
            "--columns",
            "position=e",
            "velocity=ce",
            "voltage=u",
            "reference.position=1",
            "reference.velocity=0",
        ],
    ],
    "reproduce": [["reproduce", "7.1.1/pd"]],
    "reproduce-list": [["reproduce", "--list"]],
    "identify": [["identify", "mrac"]],
    "shipped": [["shipped"]],
}
"""Calls of each output, in this order: later ones read what earlier ones have written."""

RARE = {
    "eval-explain": {"lower_value"},  # of values of interval type 2
    "prove-loop": {"file"},
    "compare": {"seconds"},  # with --time, which measures for seconds
    "fit": {"fidelity", "test", "worst", "rms", "worst_share", "rms_share"},
    "reproduce": {
        "runs", "median", "band_low", "band_high", "lowest", "highest", "published_inside",
    },
    # Of tables, and of rule bases by numbers, which are compared alone.
    "diff-controllers": {"comparable", "transposed", "header", "cells", "output", "worst", "at",
                         "rms", "points", "missing", "proved"},
    "show": {"outcome", "mode"},
}  # fmt: skip
"""Properties that no call here prints."""

NEEDED = {"compile-report": ("gcov", "avr-gcc"), "compile-board": ("avr-gcc",)}
"""Tools that the calls of an output run."""


def test_every_output_has_a_call(maker: Any) -> None:
    assert list(CALLS) == [output.name for output in maker.OUTPUTS]


@pytest.mark.slow(seconds=10)
def test_what_commands_print_is_what_the_schemas_say(
    maker: Any, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    faults, never = [], {}
    for output in maker.OUTPUTS:
        if not all(map(is_here, NEEDED.get(output.name, ()))):
            continue
        validator = Draft202012Validator(maker.schema_of(output))
        validator.check_schema(maker.schema_of(output))
        printed: set[str] = set()
        for words in CALLS[output.name]:
            main([*words, "--json"])
            told = capsys.readouterr()
            assert told.out, (words, told.err)
            data = json.loads(told.out)
            faults += [
                (*words, error.json_path, error.message[:200])
                for error in validator.iter_errors(data)
            ]
            printed |= set(_names_in(data))
        missing = set(_properties(output.schema)) - printed - RARE.get(output.name, set())
        if missing:
            never[output.name] = missing
    assert faults == []
    assert never == {}
    need(*(tool for tools in NEEDED.values() for tool in tools))  # or not all was looked at


@pytest.mark.slow
def test_the_schemas_and_the_page_are_as_they_are_made(maker: Any) -> None:
    stale = [
        output.name
        for output in maker.OUTPUTS
        if (ROOT / "docs" / "schemas" / f"{output.name}.json").read_text("utf-8")
        != maker.schema_text(output)
    ]
    assert stale == [], "run python tools/make_schemas.py"
    assert (ROOT / "docs" / "reference" / "json.md").read_text("utf-8") == maker.page()
    requests = maker.requests()
    assert len(list((ROOT / "docs" / "schemas").iterdir())) == len(maker.OUTPUTS) + len(requests)


def _names_in(data: object) -> Iterator[str]:
    if isinstance(data, dict):
        yield from data
        for each in data.values():
            yield from _names_in(each)
    elif isinstance(data, list):
        for each in data:
            yield from _names_in(each)


def _properties(schema: dict[str, Any]) -> Iterator[str]:
    yield from schema.get("properties", {})
    inner = [
        *schema.get("properties", {}).values(),
        schema.get("items"),
        schema.get("additionalProperties"),
    ]
    for each in inner:
        if isinstance(each, dict):
            yield from _properties(each)
