"""What `prove` lines say, and the verdicts on them: numbers of pd7 that were found by hand."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

import fuzzyarm
from fuzzyarm.apps.cli.main import main
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.base.diagnostic import RuleBaseError
from fuzzyarm.exchange import files as api
from fuzzyarm.exchange.files import check_text
from fuzzyarm.language import format_text, parse, write
from fuzzyarm.language.edit import complete, hover, read
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.proof.map import Prover, prove, prove_all
from fuzzyarm.proof.map.tables import cell_errors

if TYPE_CHECKING:
    from fuzzyarm.apps.watch import WatchedFile

PD7 = fuzzyarm.shipped("pd7.frb").read_text()

LINES = {
    "u in -5.34 .. 5.34": "proved",
    "e in 2 .. 6, ce in 2 .. 6 -> u >= 0": "proved",
    "u rises with e": "refuted",
    "e in 0 .. 0 -> u rises with ce": "proved",
    "u slope e in -0.43 .. 4.34": "proved",
    "u slope e in -0.42 .. 4.34": "refuted",
    "u odd": "proved",
    "u covered": "proved",
    "table linear within 0.55": "proved",
    "table linear within 0.54": "refuted",
    "table bins within 1.999": "proved",
    "table bins within 1.998": "refuted",
    "u < 5.333333333333334": "proved",
    "u <= 5.333333333333333": "refuted",
    "e in 0 .. 6, ce in 0 .. 6 -> u >= 0": "proved",
    "e in 0 .. 6, ce in 0 .. 6 -> u > 0": "refuted",
}


@pytest.fixture(scope="module")
def pd7() -> RuleBase:
    return fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))


def holds(rulebase: RuleBase, line: str) -> bool:
    """Whether an `expect` line holds, by inference."""
    review = check_text(write(rulebase) + line + "\n")
    return not any(each.name == "failed-expectation" for each in review.diagnostics)


@pytest.mark.parametrize(("line", "verdict"), LINES.items())
def test_verdicts_on_pd7(pd7: RuleBase, line: str, verdict: str) -> None:
    found = prove(pd7, line)
    assert (found.statement, found.verdict) == (line, verdict)
    assert all(holds(pd7, each) for each in found.evidence)
    if verdict == "refuted" and "bins" not in line:  # 16/3 is above the float that stands for it
        assert found.evidence or "in exact arithmetic" in found.reason


def test_a_fall_is_shown_by_a_pair_of_points(pd7: RuleBase) -> None:
    first, second = prove(pd7, "u rises with e").evidence
    values = [float(line.rpartition("=")[2]) for line in (first, second)]
    positions = [float(line.split("e = ")[1].split(",")[0]) for line in (first, second)]
    assert positions[0] < positions[1]
    assert values[0] > values[1]


@pytest.mark.parametrize(
    "exact", [False, pytest.param(True, marks=pytest.mark.slow)], ids=["floats", "rationals"]
)
def test_numbers_of_pd7(pd7: RuleBase, exact: bool) -> None:
    prover = Prover(pd7, "u", exact=exact, tolerance=1e-7)
    value = prover.value({})
    assert value.pieces == 288
    assert value.reached_high == pytest.approx(16 / 3, abs=1e-12)
    assert 16 / 3 <= value.high <= 16 / 3 + 2e-7
    slope = prover.slope({}, "e")
    assert slope.reached_high == pytest.approx(13 / 3)
    assert slope.reached_low == pytest.approx(-0.427808, abs=1e-6)
    rounded = fuzzyarm.compile_table(pd7)
    assert prover.table(rounded, "linear").high == pytest.approx(0.543485453, abs=2e-7)
    if not exact:
        plain = fuzzyarm.compile_table(pd7, rounding=0.0)
        assert prover.table(plain, "linear").high == pytest.approx(0.58017, abs=5e-6)
        assert prover.table(rounded, "bins").high == pytest.approx(1031 / 516, abs=2e-7)
        assert prover.steepness({}).high == pytest.approx((218 / 9) ** 0.5, abs=1e-6)
    low, high = prover.exactly({"e": -6, "ce": -5}), prover.exactly({"e": -6, "ce": -4})
    assert (low, high) == (Fraction(-47, 9), Fraction(-16, 3))


def test_no_rule_is_part_of_the_value() -> None:
    text = (
        "rulebase r\ninput x 0 .. 10\noutput y 0 .. 1\nterm x low: triangle 0 2 4\n"
        "term x high: triangle 6 8 10\nterms y: triangles N P\n"
        "inference no-rule {}\nrule if x is low then y is N\nrule if x is high then y is P\n"
    )
    silent = parse(text.format("error")).rulebase
    valued = parse(text.format("0.9")).rulebase
    assert silent is not None
    assert valued is not None
    assert prove(silent, "y covered").verdict == "refuted"
    assert prove(silent, "y <= 1").verdict == "refuted"
    assert prove(silent, "x in 1 .. 3 -> y <= 0.5").verdict == "proved"
    assert prove(valued, "y <= 0.8").verdict == "refuted"
    assert prove(valued, "x in 5 .. 5 -> y <= 0.8").verdict == "refuted"
    assert prove(valued, "y <= 0.9").verdict == "proved"
    assert prove(valued, "y rises with x").verdict == "undecided"


def test_what_is_not_covered_is_refused_by_name(pd7: RuleBase) -> None:
    curved = parse(PD7.replace("terms e, ce, u: triangles", "terms e, ce, u: gaussians")).rulebase
    maxima = parse(PD7.replace("centroid exact", "mean-of-maximum")).rulebase
    assert curved is not None
    assert maxima is not None
    for rulebase, line, word in (
        (curved, "u rises with e", "gaussian"),
        (maxima, "u rises with e", "mean-of-maximum"),
        (maxima, "u slope e in -9 .. 9", "mean-of-maximum"),
        (maxima, "u odd", "mean-of-maximum"),
    ):
        found = prove(rulebase, line)
        assert found.verdict == "undecided"
        assert word in found.reason


@pytest.mark.parametrize(
    ("old", "new", "word"),
    [
        ("terms e, ce, u: triangles", "terms e, ce, u: gaussians", "gaussian"),
        ("inference and min", "inference and einstein", "einstein"),
        ("inference and min", "inference and product", "product"),
        ("implication min", "implication product", "scaled sets"),
        ("aggregation max", "aggregation probor", "probor"),
        ("centroid exact", "centroid(101, endpoints)", "sampled"),
        ("rules u", "rule if e is very NB then u is NB\nrules u", "very"),
        ("rules u", "rule if e is NB or ce is NB then u is NB\nrules u", "or probor"),
    ],
    ids=lambda words: words.split()[-1],
)
@pytest.mark.parametrize("line", ["u rises with e", "u slope e in -99 .. 99", "u odd"])
def test_what_goes_by_boxes_has_no_slopes_and_says_why(
    old: str, new: str, word: str, line: str
) -> None:
    """True or not: never proved, and the reason is named."""
    text = PD7.replace("or max", "or probor").replace(old, new)
    rulebase = parse(text).rulebase
    assert rulebase is not None
    found = prove(rulebase, line)
    assert found.verdict == "undecided"
    assert word in found.reason
    assert not found.points


@pytest.mark.parametrize(
    ("line", "name", "replacement"),
    [
        ("u rise with e", "unexpected-token", "rises"),
        ("u rises e", "unexpected-token", None),
        ("u slop e in 1 .. 2", "unexpected-token", "slope"),
        ("v >= 0", "unknown-variable", None),
        ("e >= 0", "not-an-output", None),
        ("u rises with u", "not-an-input", None),
        ("e in 2 .. 7 -> u >= 0", "bad-range", None),
        ("e in 2 .. 6, u > 0", "incomplete-statement", None),
        ("e in 1 .. 2, e in 2 .. 3 -> u > 0", "duplicate-setting", None),
        ("e in 1 .. 2 -> u odd", "not-symmetric", None),
        ("u slope e in 3 .. 1", "bad-range", None),
        ("table line within 3", "unexpected-token", "linear"),
        ("table linear within 0", "bad-tolerance", None),
    ],
)
def test_mistakes(pd7: RuleBase, line: str, name: str, replacement: str | None) -> None:
    found = parse(f"{PD7}prove {line}\n").diagnostics
    assert [each.name for each in found] == [name]
    assert found[0].replacement == replacement
    with pytest.raises(RuleBaseError) as error:
        prove(pd7, line)
    assert [each.name for each in error.value.diagnostics] == [name]
    assert str(error.value).startswith(f"prove('{line}'): error[{name}]: ")  # no position of a text


BENT = """rulebase bent
input e -6 .. 6
input ce -6 .. 6
input x 0 .. 1
output u -6 .. 6
terms e, ce: triangles N Z P
terms x: triangles L H
terms u: triangles N Z P
inference and product, or probor, implication product, defuzzifier centroid exact, no-rule error
rule if e is N or ce is N and x is L then u is N
rule if e is Z and ce is Z then u is Z
rule if e is P and ce is P and x is H then u is P
"""
"""Goes by boxes, which do not settle within a second whether some rule fires everywhere."""


def test_a_corner_refutes_before_any_search() -> None:
    rulebase = fuzzyarm.parse(BENT).rulebase
    verdict = prove(rulebase, "u <= 1", budget=1e-6)  # no time for the search
    assert verdict.verdict == "refuted"
    assert verdict.evidence == ("expect e = 6, ce = 6, x = 1 -> u = 4",)
    assert prove(rulebase, "e in -6 .. -5 -> u <= 1", budget=1e-6).verdict == "undecided"


def test_bounds_are_told_where_it_is_open_whether_a_rule_fires() -> None:
    verdict = prove(fuzzyarm.parse(BENT).rulebase, "u <= 5.9", budget=0.2)
    assert verdict.verdict == "undecided"
    assert verdict.bound is not None
    low, high = verdict.bound
    assert low <= -4.0 < 4.0 <= high


def test_lines_are_read_and_written_alike() -> None:
    text = PD7 + "".join(f"prove   {line}  # why\n" for line in LINES)
    parsed = parse(text)
    assert parsed.diagnostics == ()
    assert parsed.rulebase is not None
    assert format_text(text).splitlines()[-len(LINES) :] == [
        f"prove {line}  # why" for line in LINES
    ]
    assert parse(write(parsed.rulebase)).rulebase == parsed.rulebase


def test_an_output_called_table_keeps_its_quotes() -> None:
    text = PD7.replace("output u", "output 'table'").replace("rules u", "rules 'table'")
    text = text.replace("ce, u:", "ce, 'table':").replace("-> u", "-> 'table'")
    line = "prove 'table' <= 6"
    assert format_text(f"{text}{line}\n").splitlines()[-1] == line


def test_completion_and_hover() -> None:
    def labels(line: str) -> list[str]:
        text = f"{PD7}prove {line}"
        reading = read(text, "pd7.frb")
        lines = text.splitlines()
        return [each.label for each in complete(reading, len(lines), len(lines[-1]) + 1)]

    assert {"u", "e", "ce", "table"} <= set(labels(""))
    assert {"rises", "slope", "odd", "covered", "in", "<="} <= set(labels("u "))
    assert set(labels("u rises with ")) == {"e", "ce"}
    assert {"linear", "nearest", "bins"} <= set(labels("table "))
    text = f"{PD7}prove u rises with e\n"
    found = hover(read(text, "pd7.frb"), len(text.splitlines()), 10)
    assert found is not None
    assert "never falls" in found.markdown
    session = Session("pd7.frb", text)
    session.review()
    told = session.hover(len(text.splitlines()), 10)
    assert told is not None
    assert "refuted" in told.markdown


@pytest.mark.slow
def test_where_a_property_fails_is_marked_and_pasted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On the figure, on the surface of `watch`, and by a quick fix that makes the file say so."""
    from fuzzyarm.apps.watch import WatchedFile

    path = tmp_path / "p.frb"
    path.write_text(f"{PD7}prove u rises with e  # why\nprove u odd\n")
    document = WatchedFile(path)
    (finding,) = [each for each in document.findings if each.name == "refuted-property"]
    (refuted, odd) = document.session.verdicts
    assert [list(point.values()) for point in refuted.points] == [[-3, -6], [-2, -6]]
    assert odd.points == ()
    assert capture(document) == 2
    figures = []
    monkeypatch.setattr(
        "fuzzyarm.base.figure_files.save_figure", lambda figure, _: figures.append(figure)
    )
    assert main(["plot", str(path), "-o", str(tmp_path / "p.png"), "--what", "surface"]) == 0
    (figure,) = figures
    drawn = {tuple(line.get_xydata()[0]) for axes in figure.axes for line in axes.lines}
    assert {(-6, -3), (-6, -2)} <= drawn
    assert any("u rises with e" in each.get_text() for each in figure.axes[1].texts)
    (fix,) = document.session.kind.fixes(document.session.reading, finding)
    (edit,) = fix.edits
    lines = document.text.splitlines()
    lines[edit.span.line - 1] += edit.text
    pasted = check_text("\n".join(lines) + "\n")
    assert [each.name for each in pasted.diagnostics] == ["refuted-property"]


def capture(document: WatchedFile) -> int:
    """How many marks of failures the surface of `watch` has."""
    from rich.console import Console

    assert document.scene is not None
    console = Console(width=90, no_color=True)
    with console.capture() as shown:
        console.print(document.scene.draw("surface", 60, 20))
    return shown.get().count("✗")


def test_check_proves_what_is_quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(api, "PROOF_SECONDS", 60.0)  # a busy machine takes more than a second
    review = check_text(f"{PD7}prove u odd\nprove u rises with e\n")
    assert [each.name for each in review.diagnostics] == ["refuted-property"]
    assert "expect e = " in review.diagnostics[0].message


@pytest.mark.slow
def test_the_command(tmp_path: object, capsys: pytest.CaptureFixture[str]) -> None:
    import pathlib

    folder = pathlib.Path(str(tmp_path))
    path = folder / "p.frb"
    path.write_text(f"{PD7}prove u odd\n")
    assert main(["prove", str(path)]) == 0
    assert "proved: u odd" in capsys.readouterr().out
    path.write_text(f"{PD7}prove u odd\nprove u <= 5\n")
    assert main(["prove", str(path), "--json"]) == 1
    data = json.loads(capsys.readouterr().out)
    assert [each["verdict"] for each in data] == ["proved", "refuted"]
    assert {"property", "verdict", "bound", "evidence", "pieces", "seconds"} <= set(data[0])
    path.write_text(f"{PD7}prove u <= 5.34\n")
    assert main(["prove", str(path), "--budget", "1e-9"]) == 4
    assert "time ran out" in capsys.readouterr().out
    for words, keys in ((["--range"], {"low", "high"}), (["--table", "linear"], {"worst"})):
        assert main(["prove", str(path), *words, "--json"]) == 0
        assert keys <= set(json.loads(capsys.readouterr().out))
    assert main(["prove", str(path), "--slope", "--json"]) == 0
    assert {"low", "high", "inputs"} <= set(json.loads(capsys.readouterr().out))
    assert main(["compile", str(path), "-o", str(folder / "t.lut")]) == 0
    assert "worst 0.543486 (proved)" in capsys.readouterr().out
    assert main(["prove", str(path), "--table", str(folder / "t.lut"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["worst"] == pytest.approx(1031 / 516, abs=1e-6)


def test_a_proved_error_holds_the_exported_arithmetic(pd7: RuleBase) -> None:
    from fuzzyarm.exchange.export import routines_of

    table = fuzzyarm.compile_table(pd7)
    prover = Prover(pd7, "u")
    bounds = {mode: prover.table(table, mode).high for mode in ("linear", "bins")}
    for mode, q in (("linear", 15), ("linear", 7), ("bins", 15), ("linear", None)):
        bound = bounds[mode]
        (routine,) = routines_of(table, mode=mode, q=q, proved={"u": bound})
        core = routine.core  # type: ignore[attr-defined]
        dense = np.linspace(-6, 6, 181)
        points = [core.inputs_near(k, dense) for k in (0, 1)]
        result = core.quantity(core.evaluate(*np.ix_(*points)))
        scales = core.scales[:-1]
        quantities = [
            np.clip(x.astype(float) if s is None else s.quantity(x), -6, 6)
            for x, s in zip(points, scales, strict=True)
        ]
        truth = fuzzyarm.infer(pd7, {"e": quantities[0][:, None], "ce": quantities[1][None, :]})
        worst = float(np.abs(result - np.asarray(truth["u"])).max())
        stated = routine.worst_proved()  # type: ignore[attr-defined]
        assert 0.9 * worst <= worst <= stated
        assert stated <= bound + (0.2 if q == 7 else 0.01)


def test_statements_of_several_outputs() -> None:
    text = (
        "rulebase r\ninput x -1 .. 1\noutput u -1 .. 1\noutput v -1 .. 1\n"
        "terms x, u, v: triangles N P\nrule if x is N then u is N and v is P\n"
        "rule if x is P then u is P and v is N\n"
    )
    assert parse(f"{text}prove table linear within 1\n").diagnostics[0].name == "ambiguous-output"
    lines = "prove u rises with x\nprove v falls with x\nprove table of v linear within 1\n"
    parsed = parse(text + lines)
    assert parsed.rulebase is not None
    assert [each.verdict for each in prove_all(parsed.rulebase)] == ["proved"] * 3


def test_a_check_that_has_no_time_says_which_command_has(monkeypatch: pytest.MonkeyPatch) -> None:
    rulebase = parse(f"{PD7}\nprove u rises with e\n").rulebase
    assert rulebase is not None
    monkeypatch.setattr(api, "PROOF_SECONDS", -1.0)
    findings = api.judge(rulebase).findings
    (undecided,) = [each for each in findings if each.name == "undecided-property"]
    assert "time ran out" in undecided.message
    assert undecided.hint == "fuzzyarm prove has more time"


NINE_CURVES = """rulebase curves
input e -1 .. 1
output u -1 .. 1
terms e, u: gaussians A B C D F G H I J
rules u
  e A B C D F G H I J
  u A B C D F G H I J
prove u in -2 .. 2
prove u covered
prove table nearest within 1
"""


@pytest.mark.slow
def test_what_is_known_of_sets_is_found_once_and_in_the_time_there_is(monkeypatch):
    from fuzzyarm.proof.map import memberships

    asked = 0
    ordinary = memberships.bounds

    def counted(*arguments):
        nonlocal asked
        asked += 1
        return ordinary(*arguments)

    monkeypatch.setattr(memberships, "bounds", counted)
    curves = parse(NINE_CURVES).rulebase
    for verdict in prove_all(curves, budget=0.0):
        assert verdict.verdict == "undecided"
        assert "time ran out" in verdict.reason
    assert asked < 100
    prover = Prover(curves, "u")
    prover.value({"e": (0.0, 0.01)})
    of_sets = asked
    prover.value({"e": (0.2, 0.21)})
    assert asked - of_sets < of_sets / 10


def test_no_table_is_made_of_what_nothing_is_proved_of(monkeypatch):
    from fuzzyarm import table

    monkeypatch.setattr(table, "compile_table", lambda *_, **__: pytest.fail("a table was made"))
    text = (
        "rulebase half\ninput e 0 .. 1\noutput m 0 .. 1\noutput u 0 .. 1\n"
        "terms e, m, u: triangles A B\nrule if e is A then m is B\nrule if e is B then m is A\n"
        "prove table of u nearest within 1\n"
    )
    parsed = parse(text)
    assert parsed.rulebase is not None, [str(each) for each in parsed.diagnostics]
    *_, verdict = prove_all(parsed.rulebase)
    assert verdict.verdict == "undecided"
    assert verdict.reason == "no rule concludes 'u'"


def test_the_errors_of_a_table_are_those_of_all_its_cells() -> None:
    rulebase = fuzzyarm.load(fuzzyarm.shipped("balance.frb"))
    (output,) = rulebase.outputs
    counts = zip(rulebase.inputs, (3, 4), strict=True)
    levels = {each.name: np.linspace(each.low, each.high, n).tolist() for each, n in counts}
    table = fuzzyarm.compile_table(rulebase, output.name, levels=levels)
    cells = [cell for cell, _ in cell_errors(table, rulebase, "linear")]
    assert cells == [(i, j) for i in range(2) for j in range(3)]


BEYOND_AN_OUTPUT = """
rulebase rb
input e -1 .. 1
output u -0.5 .. 0.5
terms e: triangles N Z P
term u N: singleton -1
term u Z: singleton 0
term u P: singleton 1
inference u: {way}, outside error
rule if e is N then u is N
rule if e is Z then u is Z
rule if e is P then u is P
"""


@pytest.mark.parametrize("way", ["defuzzifier weighted-average", "defuzzifier weighted-sum"])
@pytest.mark.parametrize("statement", ["e in 0.6 .. 1 -> u >= 0.4", "u in -0.5 .. 0.5", "u <= 2"])
def test_a_statement_on_a_value_that_is_not_there_is_refuted(statement: str, way: str) -> None:
    rulebase = fuzzyarm.parse(BEYOND_AN_OUTPUT.format(way=way)).rulebase
    verdict = prove(rulebase, statement)
    assert verdict.verdict == "refuted"
    assert "outside its range -0.5 .. 0.5" in verdict.reason
    assert verdict.reason.endswith("it has no value there")
    with pytest.raises(fuzzyarm.FuzzyarmError, match="outside its range"):
        fuzzyarm.infer(rulebase, **verdict.points[0])
    assert prove(rulebase, "e in -0.4 .. 0.4 -> u in -0.4001 .. 0.4001").proved
    # The slope is asked for where the output has a value; beyond that there is none.
    assert prove(rulebase, "u slope e in 0.9 .. 1.1").verdict == "undecided"
    assert prove(rulebase, "e in -0.4 .. 0.4 -> u slope e in 0.9 .. 1.1").proved


# ── edges ────────────────────────────────────────────────────────────────────────────

AT_THE_END = """rulebase r
input x 0 .. 4
output u -1 .. 1
term x A: triangle 0 2 4
term u P: singleton {value}
inference defuzzifier weighted-sum, no-rule 0
rule if x is any A then u is P
"""


@pytest.mark.parametrize(
    ("value", "line", "verdict"),
    [
        (-2, "u < -1", "refuted"),
        (-2, "u <= -1", "proved"),
        (-2, "u <= -1.0000000000001", "refuted"),
        (-2, "u > -1", "refuted"),
        (-2, "u < -0.999", "proved"),
        (2, "u > 1", "refuted"),
        (2, "u >= 1", "proved"),
        (2, "u >= 1.0000000000001", "refuted"),
        (2, "u < 1", "refuted"),
    ],
)
def test_a_value_that_is_clamped_is_at_the_end_and_not_beyond(
    value: int, line: str, verdict: str
) -> None:
    assert prove(parsed(AT_THE_END.format(value=value)), line).verdict == verdict


EDGE = """rulebase r
input x 0 .. 4
output u -1 .. 1
term x up: {up}
term x zero: singleton 0
term u low: singleton -1
term u high: singleton 1
inference defuzzifier weighted-average, no-rule -1
rule if x is up then u is high
"""
FIRES_AT_THE_EDGE = "rule if x is zero then u is high\n"


@pytest.mark.parametrize("line", ["u covered", "u > 0.5", "u = 1", "x in 0 .. 0 -> u covered"])
@pytest.mark.parametrize("up", ["trapezoid 0 0.5 inf inf", "ramp 0 0.25"])
def test_strengths_that_fade_towards_an_edge_at_which_another_rule_fires(
    up: str, line: str
) -> None:
    assert prove(parsed(EDGE.format(up=up) + FIRES_AT_THE_EDGE), line).verdict == "proved"
    assert prove(parsed(EDGE.format(up=up)), line).verdict == "refuted"


def test_where_no_rule_fires_beside_an_edge_a_point_is_named_at_which_none_does() -> None:
    rulebase = parsed(
        "rulebase r\ninput x 0 .. 4\ninput y -3 .. 3\noutput u 0 .. 10\n"
        "term x zero: singleton 0\nterm y A: triangle -3 3 4.5\nterm u P: singleton 8\n"
        "inference defuzzifier weighted-average, no-rule 0\n"
        "rule if x is zero and y is not A then u is P\nrule if y is A then u is P\n"
    )
    for line in ("u covered", "u > 7"):
        verdict = prove(rulebase, line)
        (point,) = verdict.points
        assert (verdict.verdict, point["y"]) == ("refuted", -3.0)
        assert fuzzyarm.infer(rulebase, point) == {"u": 0.0}


def test_where_products_are_0_at_all_corners_the_middle_is_no_counterexample() -> None:
    rulebase = parsed(
        "rulebase r\ninput x 0 .. 1\ninput y 0 .. 1\noutput u 0 .. 1\n"
        "term x A: ramp 0 1\nterm x B: ramp 1 0\nterm y A: ramp 0 1\nterm u P: singleton 1\n"
        "inference and product, defuzzifier weighted-average, no-rule 0\n"
        "rule if x is A and x is B and y is A then u is P\n"
    )
    verdict = prove(rulebase, "u covered")
    (point,) = verdict.points
    assert verdict.verdict == "refuted"
    assert fuzzyarm.infer(rulebase, point) == {"u": 0.0}
    assert prove(rulebase, "x in 0.1 .. 0.9, y in 0.1 .. 1 -> u covered").verdict == "proved"


JUMP = """rulebase r
input x 0 .. 2
output u -1 .. 1
term x left: binary 1 -inf
term x right: binary 1 inf
term u low: singleton -1
term u high: singleton 1
inference defuzzifier weighted-average
rule if x is {closed} then u is {one}
rule if x is not {closed} then u is {other}
lookup
  levels x: 0 2
"""


def test_a_table_differs_at_a_threshold_that_is_a_jump_of_the_rules() -> None:
    """The table takes the lower cell there; so rules agree whose left side has the edge."""
    right = parsed(JUMP.format(closed="right", one="high", other="low"))
    table = fuzzyarm.compile_table(right)
    assert abs(table.lookup(1.0, mode="nearest") - fuzzyarm.infer(right, x=1.0)["u"]) == 2.0
    assert prove(right, "table nearest within 1.9").verdict == "refuted"
    assert Prover(right, "u").table(table, "nearest").worst >= 2.0
    left = parsed(JUMP.format(closed="left", one="low", other="high"))
    assert prove(left, "table nearest within 0.001").verdict == "proved"


@pytest.mark.parametrize(
    ("line", "verdict"),
    [
        ("x in 1 .. 2 -> table nearest within 0.999", "refuted"),
        ("x in 1 .. 1 -> table nearest within 0.999", "refuted"),
        ("x in 1.1 .. 2 -> table nearest within 0.9", "proved"),
        ("x in 1.1 .. 2 -> table nearest within 0.8999", "refuted"),
        ("table nearest within 0.9", "refuted"),
    ],
)
def test_the_error_of_a_table_is_that_in_the_region(line: str, verdict: str) -> None:
    rulebase = parsed(
        "rulebase r\ninput x 0 .. 2\noutput u -1 .. 1\nterm x up: ramp 0 2\n"
        "term u low: singleton -1\nterm u high: singleton 1\n"
        "inference defuzzifier weighted-average\n"
        "rule if x is up then u is high\nrule if x is not up then u is low\n"
        "lookup\n  levels x: 0 2\n"
    )
    found = prove(rulebase, line)
    assert found.verdict == verdict
    low = float(line.split()[2]) if line.startswith("x in") else 0.0
    assert all(point["x"] >= low for point in found.points)


def parsed(text: str) -> RuleBase:
    rulebase = parse(text).rulebase
    assert rulebase is not None
    return rulebase


PRODUCT = """
rulebase r
input x 0 .. 1
output u -1 .. 2
term x A: ramp 0 1
term x B: ramp 1 0
term u P: singleton {value}
inference and product, no-rule {no_rule}
inference u: defuzzifier {way}, outside extend
rule if x is A and x is B then u is P
"""


@pytest.mark.parametrize(
    ("way", "value", "statement"),
    [
        ("weighted-sum", 4, "u < 1"),  # at one half: a corner of no piece
        ("weighted-sum", -4, "u > -1"),
        ("weighted-average", 1, "u < 1"),  # between two ends at which no rule fires
    ],
)
def test_a_limit_that_is_reached_inside_a_piece_is_reached(
    way: str, value: int, statement: str
) -> None:
    rulebase = parsed(PRODUCT.format(way=way, value=value, no_rule=0.5))
    verdict = prove(rulebase, statement)
    assert verdict.verdict == "refuted"
    assert verdict.evidence
    assert prove(rulebase, statement.replace("<", "<=").replace(">", ">=")).proved


def test_a_limit_that_only_a_point_without_a_rule_would_reach_is_not_reached() -> None:
    """With x for one rule and x² for the other, u = x / (1 + x) where any rule fires."""
    rulebase = parsed(
        "rulebase r\ninput x 0 .. 1\noutput u 0 .. 1\nterm x A: ramp 0 1\n"
        "term u P: singleton 0\nterm u Q: singleton 1\ninference and product, no-rule 1\n"
        "inference u: defuzzifier weighted-average\n"
        "rule if x is A then u is P\nrule if x is A and x is A then u is Q\n"
    )
    assert prove(rulebase, "u > 0").proved
    assert prove(rulebase, "x in 0.5 .. 1 -> u < 0.5").verdict == "refuted"
