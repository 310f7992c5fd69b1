"""The referee's suite: its schema, its evaluators against closed forms, what fuzzyarm answers."""

from __future__ import annotations

import json
import sys
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import pytest
from budget import part
from jsonschema import Draft202012Validator
from needs import requires

from conformance import exact, pieces, report, second, suite
from conformance.make_cases import converted
from conformance.run import RESULTS, TOLERANCE, TOOLS, judged, main
from conformance.topics import TOPICS

ALL = suite.read_all(validated=False)
BY_NAME = {case.name: case for case in ALL}
POINTS = [(case, k) for case in ALL for k in range(len(case.data["points"]))]


def test_there_are_at_least_200_cases_of_every_topic():
    assert len(ALL) >= 200
    assert {case.topic for case in ALL} == set(TOPICS)


@pytest.mark.slow
def test_every_file_follows_the_schema():
    assert suite.read_all() == ALL


def test_the_schema_is_one_and_knows_every_word_of_the_evaluators():
    schema = json.loads(suite.SCHEMA.read_text())
    Draft202012Validator.check_schema(schema)
    words = schema["$defs"]
    assert set(words["tnorm"]["enum"]) == set(exact.T_NORMS)
    assert {*words["snorm"]["enum"], "sum"} == set(exact.S_NORMS)


def test_the_files_are_what_is_asked_today():
    """A topic that was changed without `make_cases` is found: names, systems and points."""
    for topic, cases in TOPICS.items():
        written = [case.data for case in ALL if case.topic == topic]
        asked = json.loads(json.dumps(list(cases())))
        stripped = [
            {**case, "points": [{"inputs": p["inputs"]} for p in case["points"]]}
            for case in written
        ]
        assert stripped == asked, topic


def exact_value(case, k):
    point = case.data["points"][k]
    numbers = converted(dict(case.data), Fraction), converted(point["inputs"], Fraction)
    return {name: exact.number(numbers[0], name, numbers[1]) for name in case.data["outputs"]}


@pytest.mark.parametrize("topic", TOPICS)
def test_the_written_numbers_are_those_of_the_exact_evaluator(topic):
    chosen = [(case, k) for case, k in POINTS if case.topic == topic]
    for case, k in part(chosen, 23):
        for name, value in exact_value(case, k).items():
            expected = case.data["points"][k]["expected"][name]
            if "none" in expected:
                assert value is None
                continue
            assert float(value) == expected["value"], (case.name, k)
            if "rational" in expected:
                assert value == Fraction(expected["rational"])


# Integrals in 50 decimals take their time: of those the test takes few, of all others every ninth.
CHEAP = [
    (case, k)
    for case, k in POINTS
    if "samples" in case.data["settings"]["defuzzifier"]
    or case.data["settings"]["defuzzifier"]["method"] in {"weighted average", "tsukamoto"}
    if case.data["settings"]["defuzzifier"].get("samples", 0) <= 101
    if case.data["settings"]["defuzzifier"].get("sampling") != "joined"
]
DEAR = ["tipper-exact", "aggregation-probabilistic-sum-exact"]


def second_agrees(case, k):
    point = case.data["points"][k]
    for name, expected in point["expected"].items():
        numbers = converted(dict(case.data), Decimal), converted(point["inputs"], Decimal)
        value = second.number(numbers[0], name, numbers[1])
        if "none" in expected:
            assert value is None
        else:
            assert abs(float(value) - expected["value"]) <= 1e-12 * case.span[name], (case.name, k)


def test_the_second_way_agrees():
    for case, k in part(CHEAP, 20):
        second_agrees(case, k)


@pytest.mark.slow
@pytest.mark.parametrize("name", DEAR)
def test_the_second_way_agrees_on_integrals(name):
    second_agrees(BY_NAME[name], 0)


F = Fraction


def test_pieces_against_closed_forms():
    triangle = pieces.through([(F(0), F(0)), (F(3), F(1)), (F(5), F(0))], F(0), F(6))
    assert pieces.area(triangle) == F(5, 2)
    assert pieces.moment(triangle) / pieces.area(triangle) == F(0 + 3 + 5, 3)
    cut = pieces.combined(triangle, pieces.level(F(1, 2), F(0), F(6)), min)
    assert pieces.area(cut) == F(5, 2) * (1 - F(1, 4))  # what is cut off is similar to the whole
    assert pieces.greatest(cut) == [(F(3, 2), F(4))]
    # A right triangle is halved at 1/√2 of its height from the tip.
    right = pieces.through([(F(0), F(1)), (F(1), F(0))], F(0), F(1))
    assert abs(float(pieces.half(right)) - (1 - 0.5**0.5)) < 1e-15
    squared = pieces.combined(right, right, exact.T_NORMS["product"], "product")
    assert pieces.area(squared) == F(1, 3)
    with pytest.raises(pieces.NotStraightError, match="not straight"):
        pieces.combined(squared, right, min)


def test_two_triangles_that_cross():
    """max of two unit triangles one apart: two of area 1 less the overlap of a quarter."""
    one = pieces.through([(F(-1), F(0)), (F(0), F(1)), (F(1), F(0))], F(-1), F(2))
    other = pieces.through([(F(0), F(0)), (F(1), F(1)), (F(2), F(0))], F(-1), F(2))
    both = pieces.combined(one, other, max)
    assert pieces.area(both) == F(2) - F(1, 4)
    assert pieces.moment(both) / pieces.area(both) == F(1, 2)
    assert pieces.greatest(both) == [(F(0), F(0)), (F(1), F(1))]


def test_exponentials_have_sixty_digits():
    e = "2.718281828459045235360287471352662497757247093699959574966967"
    assert abs(exact.exponential(F(1)) - F(e)) < F(1, 10**59)
    assert abs(exact.exponential(F(-3)) * exact.exponential(F(3)) - 1) < F(1, 10**58)


def test_ends_of_an_interval_by_hand():
    """Weights between 0 and 1 at 0 and 1: the average is anything from 0 to 1."""
    assert exact.ends([(F(0), (F(0), F(1))), (F(1), (F(0), F(1)))]) == (0, 1)
    assert exact.ends([(F(0), (F(1), F(1))), (F(3), (F(1), F(2)))]) == (F(3, 2), F(2))


@pytest.mark.parametrize(
    ("name", "number"),
    [
        ("tipper-endpoints-26", 20.24450811843363),
        ("tipper-endpoints-101", 19.95253894352102),
        ("tipper-joined-26", 19.847607361963195),
        ("tipper-exact", 19.85775920691492),
    ],
)
def test_one_example_has_its_four_numbers(name, number):
    expected = BY_NAME[name].data["points"][0]["expected"]["tip"]
    assert expected["value"] == pytest.approx(number, rel=1e-15)
    assert float(Fraction(expected["rational"])) == expected["value"]


@pytest.fixture(scope="module")
def runner():
    sys.path.insert(0, str(suite.FOLDER / "runners"))
    import fuzzyarm_runner

    yield fuzzyarm_runner
    sys.path.remove(str(suite.FOLDER / "runners"))


CHOICES = {"gap-bisector-endpoints-101"}
"""Where fuzzyarm differs and says why: conformance/differences.json."""


@pytest.mark.parametrize("engine", ["point", "arrays", "compiled"])
def test_fuzzyarm_passes(runner, engine):
    for case in part(ALL, 3 if engine == "point" else 6):
        answer = {"points": runner.ENGINES[engine](case.data)}
        verdict = judged(case, answer)
        assert (verdict["verdict"] == "pass") != (case.name in CHOICES), (case.name, verdict)


@pytest.mark.slow
@pytest.mark.parametrize(
    "engine",
    [
        pytest.param("c", marks=requires("C compiler")),
        "st",
        pytest.param("javascript", marks=requires("node")),
    ],
)
def test_what_fuzzyarm_exports_passes(runner, engine):
    for name in (
        "tipper-exact",
        "tipper-joined-26",
        "aggregation-einstein-midpoints-100",
        "sugeno-product",
    ):
        answer = {"points": runner.ENGINES[engine](BY_NAME[name].data)}
        assert judged(BY_NAME[name], answer)["verdict"] == "pass", name


def test_the_suite_itself_knows_nothing_of_fuzzyarm():
    for path in suite.FOLDER.glob("*.py"):
        assert "import fuzzyarm" not in path.read_text(), path.name
        assert "from fuzzyarm" not in path.read_text(), path.name


# --- malformed cases


def written(tmp_path: Path, change) -> Path:
    data = {"topic": "shapes", "says": "", "cases": [json.loads(json.dumps(dict(ALL[0].data)))]}
    change(data)
    path = tmp_path / "shapes.json"
    path.write_text(json.dumps(data))
    return path


def first(data):
    return data["cases"][0]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda d: d.pop("cases"), "shapes.json: the file: 'cases' is a required property"),
        (lambda d: first(d).pop("rules"), "'rules' is a required property"),
        (lambda d: first(d)["settings"].update({"and": "harmonic"}), "and: 'harmonic' is not"),
        (lambda d: first(d)["points"][0]["inputs"].clear(), "a point must give"),
        (lambda d: first(d)["rules"][0].update(then={"nobody": "here"}), "nobody is here"),
        (lambda d: first(d)["rules"][0].update({"if": {"is": ["x", "y"]}}), "asks for x is y"),
    ],
)  # fmt: skip
def test_a_malformed_case_is_one_sentence(tmp_path, capsys, change, sentence):
    path = written(tmp_path, change)
    with pytest.raises(suite.SuiteError) as error:
        suite.read(path)
    assert sentence in str(error.value)
    assert "\n" not in str(error.value)
    assert main(["--cases", str(tmp_path), "--results", str(tmp_path / "out"), "simpful"]) == 1
    assert capsys.readouterr().err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_file_that_is_not_json_is_one_sentence(tmp_path):
    (tmp_path / "shapes.json").write_text("{")
    with pytest.raises(suite.SuiteError, match="not JSON"):
        suite.read_all(tmp_path)


def test_two_cases_of_one_name_are_refused(tmp_path):
    path = written(tmp_path, lambda d: d["cases"].append(first(d)))
    with pytest.raises(suite.SuiteError, match="two cases have the name"):
        suite.read_all(path.parent)


def test_an_empty_folder_is_refused(tmp_path):
    with pytest.raises(suite.SuiteError, match="there is no case"):
        suite.read_all(tmp_path)


# --- runners


@pytest.mark.parametrize(
    ("said", "verdict"),
    [
        (None, "error"),
        ({"cannot": "no"}, "cannot"),
        ({"error": "oh"}, "error"),
        ({"points": [{}]}, "error"),
    ],
)
def test_what_is_not_an_answer(said, verdict):
    assert judged(BY_NAME["tipper-exact"], said)["verdict"] == verdict


def test_a_number_that_is_off_differs_and_nothing_is_not_zero():
    case = BY_NAME["no-rule-nothing-values"]
    points = [
        {"y": None if "none" in p["expected"]["y"] else p["expected"]["y"]["value"]}
        for p in case.data["points"]
    ]
    assert judged(case, {"points": points})["verdict"] == "pass"
    zero = [{"y": point["y"] or 0.0} for point in points]
    assert judged(case, {"points": zero})["says"] == "a number where there is none"
    off = [
        {"y": None if p["y"] is None else p["y"] + 5 * TOLERANCE * case.span["y"]} for p in points
    ]
    assert judged(case, {"points": off})["verdict"] == "differs"


def test_a_runner_of_ones_own(tmp_path, capsys):
    """One in a few lines of any language, one that prints something else, one that is not there."""
    script = tmp_path / "mine.py"
    script.write_text(
        "import json, sys\n"
        'print(json.dumps({"tool": "mine", "version": "1"}))\n'
        "for line in sys.stdin:\n"
        '    print(json.dumps({"name": json.loads(line)["name"], "cannot": "nothing at all"}))\n'
    )
    cases = tmp_path / "cases"
    cases.mkdir()
    (cases / "tsukamoto.json").write_text((suite.CASES / "tsukamoto.json").read_text())
    words = ["--cases", str(cases), "--results", str(tmp_path)]
    assert main([*words, "--runner", f"mine={sys.executable} {script}"]) == 0
    assert "mine: 0 pass, 0 differs, 6 cannot, 0 error" in capsys.readouterr().out
    assert main([*words, "--runner", "wrong=echo hello"]) == 1
    assert "wrong: not the lines of a runner" in capsys.readouterr().err
    assert main([*words, "--runner", "gone=/nowhere/runner"]) == 1
    assert (
        capsys.readouterr().err
        == "gone: /nowhere/runner does not start: No such file or directory\n"
    )
    assert not (tmp_path / "wrong.json").exists()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["scikit_fuzzy", "simpful_runner", "pyit2fls_runner"])
def test_a_peer_is_asked(name):
    """What its result file says of a case, it says today."""
    sys.path.insert(0, str(suite.FOLDER / "runners"))
    try:
        module = __import__(name)
    finally:
        sys.path.remove(str(suite.FOLDER / "runners"))
    asked = {"scikit_fuzzy": "tipper-joined-26", "simpful_runner": "tipper-endpoints-101",
             "pyit2fls_runner": "type-2-nie-tan-endpoints-101"}[name]  # fmt: skip
    assert (
        judged(BY_NAME[asked], {"points": module.answer(BY_NAME[asked].data)})["verdict"] == "pass"
    )


# --- the page


def test_the_results_are_those_of_these_cases():
    for result in report.results():
        assert set(result.verdicts) == set(BY_NAME), f"python -m conformance.run {result.key}"
    assert {result.key for result in report.results()} == set(TOOLS)


def test_the_page_is_that_of_the_results():
    reasons = json.loads(report.DIFFERENCES.read_text())
    assert report.PAGE.read_text() == report.page(ALL, report.results(), reasons)


def test_every_reason_is_of_something_that_differs():
    """An entry that explains nothing any more goes away."""
    reasons = json.loads(report.DIFFERENCES.read_text())
    used = set()
    for path in RESULTS.glob("*.json"):
        for name, verdict in json.loads(path.read_text())["verdicts"].items():
            if verdict["verdict"] in {"differs", "error"}:
                entry = report.reason(path.stem, name, reasons)
                assert entry["because"] in {"setting", "choice", "bug", "open"}, (path.stem, name)
                used.add(entry["says"])
    assert used == {entry["says"] for entry in reasons}
