"""Whom to cite: publications of what a file uses, and none that was not looked up."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import fuzzyarm
from fuzzyarm.apps.cli import main
from fuzzyarm.base.sources import SOURCES
from fuzzyarm.language import parse
from fuzzyarm.language.model.methods import RULES_OVER_SETS, SELF_TUNING, methods_of, structures_of
from fuzzyarm.symbolic.kinds import DEFUZZIFIERS, HEDGES, SHAPES, SNORMS, TNORMS

ROOT = Path(__file__).parents[2]

BASE = """rulebase x
input e 0 .. 1
output u 0 .. 1
term e A: ramp 0 1
term e B: ramp 1 0
term u A: {a}
term u B: {b}
inference and {norm}
inference u: defuzzifier {way}
rule if e is A then u is A
rule if e is B then u is B
"""


@pytest.mark.parametrize(
    ("norm", "a", "b", "way", "keys"),
    [
        ("min", "singleton 0", "singleton 1", "weighted-average", ["zadeh1965", "takagi1985"]),
        ("product", "singleton 0", "singleton 1", "weighted-average", ["takagi1985"]),
        ("product", "ramp 0 1", "ramp 1 0", "tsukamoto", ["tsukamoto1979"]),
        ("product", "ramp 0 1", "ramp 1 0", "centroid", ["mamdani1975", "zadeh1965"]),
    ],
)
def test_a_rule_base_has_the_sources_of_what_it_uses(norm, a, b, way, keys):
    rulebase = parse(BASE.format(norm=norm, a=a, b=b, way=way)).rulebase
    assert list(methods_of(rulebase)) == keys


def test_every_key_of_a_record_is_a_source_and_every_source_is_used():
    records = [*DEFUZZIFIERS.values(), *TNORMS.values(), *SNORMS.values(), *SHAPES.values(),
               *HEDGES.values()]  # fmt: skip
    named = {key for record in records for key in record.sources}
    named |= {*RULES_OVER_SETS, *SELF_TUNING}
    assert named == set(SOURCES)


def test_an_entry_is_complete():
    for key, source in SOURCES.items():
        assert {"author", "title", "year", "pages"} <= set(source.fields), key
        assert source.fields["year"] in key
        text = source.bibtex(key)
        assert re.fullmatch(r"@\w+\{\w+,\n(  \w+ += \{[^{}]+\},\n)+\}", text), text


def test_the_command_prints_each_entry_once(capsys):
    assert main(["cite", str(ROOT / "rulebases" / "stfc.frb")]) == 0
    printed = capsys.readouterr().out
    assert re.findall(r"^@\w+\{(\w+),$", printed, re.MULTILINE) == [
        "fuzzyarm", "mudi1999", "mamdani1975", "zadeh1965",
    ]  # fmt: skip
    assert f"Version {fuzzyarm.__version__}" in printed


@pytest.mark.parametrize(
    ("name", "tunes_itself"),
    [("stfc", True), ("cfaf", True), ("servo", False), ("hfie", False)],
)
def test_rules_that_scale_rules_over_the_same_inputs_tune_themselves(name, tunes_itself):
    controller = fuzzyarm.load(ROOT / "rulebases" / f"{name}.frb").model
    assert structures_of(controller) == ({"mudi1999": ["self-tuning"]} if tunes_itself else {})


def test_a_table_says_nothing_of_methods(capsys):
    assert main(["cite", str(ROOT / "rulebases" / "thesis-6.1.lut")]) == 1
    assert capsys.readouterr().err.endswith("without a record of its methods\n")


def test_a_compiled_table_has_the_sources_of_the_rule_base_beside_it(tmp_path, capsys):
    rules, table = tmp_path / "x.frb", tmp_path / "x.lut"
    text = BASE.format(norm="min", a="ramp 0 1", b="ramp 1 0", way="centroid")
    rules.write_text(text, encoding="utf-8")
    assert main(["compile", str(rules), "--levels", "5", "-o", str(table)]) == 0
    capsys.readouterr()
    assert main(["cite", str(table)]) == 0
    assert "@article{mamdani1975," in capsys.readouterr().out
    rules.write_text(text.replace("ramp 0 1", "ramp 0 0.9"), encoding="utf-8")
    assert main(["cite", str(table)]) == 1
    assert capsys.readouterr().err.endswith("x.frb, which has changed since\n")
    rules.unlink()
    assert main(["cite", str(table)]) == 1
    assert capsys.readouterr().err.endswith("x.frb, which is not beside it\n")


def test_the_version_to_cite_is_that_of_the_package():
    assert f"\nversion: {fuzzyarm.__version__}\n" in (ROOT / "CITATION.cff").read_text()


def test_findings_as_annotations(tmp_path, capsys):
    path = tmp_path / "a,b.frb"
    path.write_text("rulebase x\ninput e 0 .. 1\noutput u 0 .. 1\nterms e, u: triangles A B\n"
                    "rule if e is A then u is C\nrule if e is B then u is B\n")  # fmt: skip
    assert main(["check", "--format", "github", "--quiet", str(path)]) == 1
    printed = capsys.readouterr().out
    place = str(path).replace(",", "%2C")
    (found,) = parse(path.read_text()).diagnostics
    assert printed == (f"::error file={place},line=5,col=26,title=unknown-term::{found.message}\n")
