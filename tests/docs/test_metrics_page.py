"""The page of metrics and lesson 5: every formula, computed, is the metric of a run."""

import math
import re
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

import fuzzyarm
from fuzzyarm.control.loop.metrics import FORMULAS, METRIC_KINDS, Metrics, metrics_of
from fuzzyarm.inference.infer import DEFAULT_TOLERANCE
from fuzzyarm.language.statements import TABLE_MODES, VERBS
from fuzzyarm.proof.map.bounds import LIKE_EXPECT

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "reference" / "metrics.md").read_text("utf-8")
LESSON = (DOCS / "tutorial" / "5-a-controller.md").read_text("utf-8")

WITHOUT_SAMPLES = {"chatter", "rms_periods", "rms_path"}
"""Of every control period: samples do not tell."""


def formulas():
    """Return the formulas that stand on the page, by metric."""
    rows = re.findall(r"(?m)^\| `(\w+)` \| [^|]+ \| `((?:[^`|]|\\\|)+)`", PAGE)
    return {name: formula.replace(r"\|", "|") for name, formula in rows}


def test_every_metric_has_its_formula_and_its_words():
    names = [each.name for each in fields(Metrics)]
    assert set(names) <= set(FORMULAS)
    assert [name for name in formulas() if name in names] == names
    told = {
        name.strip("` ")
        for cell in re.findall(r"(?m)^\| ((?:`\w+`(?:, )?)+) \| [A-Z]", PAGE)
        for name in cell.split(",")
    }
    assert told == set(names)


@pytest.fixture(scope="module")
def lesson(tmp_path_factory):
    """Return the files of lesson 5, in a folder."""
    folder = tmp_path_factory.mktemp("lesson")
    for name, text in re.findall(r"(?ms)^```frb\n# (\S+)\n(.*?)^```", LESSON):
        (folder / name).write_text(text, "utf-8")
    return folder


def names_of(run):
    """Return what the formulas of the page speak of, of a run with one step of one output."""
    e, reference = run.error_matrix[:, 0], run.reference[:, 0]
    output = reference - e
    jumps = np.flatnonzero(np.diff(reference))
    begin = int(jumps[0]) + 1 if len(jumps) else 0
    before = output[max(begin - 1, 0)]
    step = reference[-1] - before
    d = np.column_stack(list(run.drives.values()))
    low, high = np.array(list(run.limits.values())).T
    return {
        "e": e,
        "t": run.time - run.time[0],
        "T": run.period,
        "n": len(e),
        "way": (output[begin:] - before) / step,
        "step": step,
        "d": d,
        "low": low,
        "high": high,
        "last": lambda where: np.flatnonzero(where)[-1],
        "diff": lambda x: np.diff(x, axis=0),
        "any": lambda x: np.any(x, axis=1),
        "max": lambda *x: max(*x) if len(x) > 1 else np.max(x[0]),
        **{name: getattr(np, name) for name in ("sqrt", "mean", "abs", "sum", "argmax")},
    }


@pytest.mark.parametrize(
    ("file", "reference"), [("turn.frb", "step:1"), ("hold.frb", "step:-0.5,0.1")]
)
@pytest.mark.parametrize("name", sorted(set(formulas()) & set(FORMULAS) - WITHOUT_SAMPLES))
def test_a_formula_is_the_metric(name, file, reference, lesson):
    run = fuzzyarm.simulate(
        lesson / file, "motor", reference={"position": reference}, duration="2s"
    )
    known = names_of(run)
    if name in ("rise", "settling"):  # from the step on
        known["t"] = known["t"][: len(known["way"])]
    value = eval(formulas()[name], {"__builtins__": {}}, known)
    metric = getattr(next(iter(run.metrics.values())), name)
    assert math.isclose(float(value), metric, rel_tol=1e-9, abs_tol=1e-12), (value, metric)


SCALES = {"error": 2, "drive": 4, "every": 4}
TIME = 8


@pytest.mark.parametrize("name", sorted(set(METRIC_KINDS) - WITHOUT_SAMPLES))
def test_a_metric_grows_as_its_unit(name):
    time = 0.0625 * np.arange(200)
    errors = np.where(time > 0, np.exp(-time) * np.cos(3.0 * time), 0.0)
    drives = np.round(8.0 * errors)[:, None]

    def value(error, drive, seconds):
        return getattr(
            metrics_of(
                seconds * time, error * (time > 0), error * errors, drive * drives,
                [(-8.0 * drive, 6.0 * drive)], seconds * 0.0625,
            ),
            name,
        )  # fmt: skip

    symbol = METRIC_KINDS[name].symbol.replace("^", "**").replace(" ", "*").format(**SCALES)
    factor = eval(symbol or "1", {"s": TIME})
    assert value(2, 4, TIME) == pytest.approx(factor * value(1, 1, 1), rel=1e-12)
    assert value(1, 1, 1) != 0.0


def test_a_unit_in_words_has_one_symbol():
    pairs = {(kind.unit, kind.symbol) for kind in METRIC_KINDS.values()}
    assert len(pairs) == len(dict(pairs)) == len({symbol for _, symbol in pairs})


def test_what_expect_and_prove_say_is_complete():
    expect, prove = PAGE.split("## What `expect` says")[1].split("## What `prove` says")
    said = " ".join(re.findall(r"(?m)^\| (`[^|]*) \|", prove))
    for verb in VERBS:
        assert re.search(rf"`u {verb}[ `]", said), verb
    assert all(f"`{mode}`" in prove for mode in TABLE_MODES)
    assert DEFAULT_TOLERANCE == LIKE_EXPECT == 1e-9
    assert "at most 1e-9 of its range" in expect
    assert "within 1e-9 of the range" in prove
    for line in ("`u = VALUE`", "`u in LOW .. HIGH`", "within TOLERANCE"):
        assert line in expect
        assert line.strip("`") in prove


def test_lesson_5_says_when_the_shaft_is_there(lesson):
    run = fuzzyarm.simulate(
        lesson / "turn.frb", "motor", reference={"position": "step:1"}, duration="1s"
    )
    position = run.outputs["position"]
    assert position[run.time < 0.1349].max() < 0.99
    at = float(np.interp(0.135, run.time, position))
    assert 0.99 < at < 1.0 < position[run.time > 0.1351][0]
    assert "The shaft arrives after 0.135 s" in " ".join(LESSON.split())
    metrics = next(iter(run.metrics.values())).to_dict()
    rows = re.findall(r"(?m)^\| `(\w+)` \| (−?)([\d.]+)[^|]* \|", LESSON)
    assert {name for name, *_ in rows} >= {"rms", "max", "final", "rise", "overshoot", "settling"}
    for name, sign, digits in rows:
        value = float(digits) * (-1 if sign else 1)
        places = len(digits.partition(".")[2])
        assert round(metrics[name], places) == value, name


def test_lesson_5_explains_every_row():
    table = LESSON.split("| row | here | meaning |")[1].split("\n\n")[0]
    told = [name for cell in re.findall(r"(?m)^\| ((?:`\w+`(?:, )?)+) \|", table)
            for name in re.findall(r"\w+", cell)]  # fmt: skip
    assert told == [each.name for each in fields(Metrics)]


GLOSSARY = (
    "universe", "term", "membership", "antecedent", "consequent", "firing strength",
    "implication", "aggregation", "defuzzification", "sample", "set point", "lookup table",
    "bins", "gain", "drive", "levels", "reference", "error", "plant", "controller", "norm",
    "rule base", "hedge", "crisp", "axis", "period",
)  # fmt: skip


def test_the_glossary_has_the_words_once_each():
    text = (DOCS / "reference" / "glossary.md").read_text("utf-8")
    words = [
        word.strip()
        for cell in re.findall(r"(?m)^\| ([^|]+) \| [^|]+ \|$", text)
        for word in cell.split(",")
    ]
    words = [word for word in words if word != "word"]
    assert set(GLOSSARY) <= set(words)
    assert len(words) == len(set(words))
