"""A value is one line among others, its text under print, and a drawing in a notebook."""

import re
from html.parser import HTMLParser

import pytest

import fuzzyarm
from fuzzyarm import RuleBaseBuilder, load, shipped
from fuzzyarm.apps import notebook
from fuzzyarm.apps.notebook import html_of_drawing
from fuzzyarm.control.loop import phase_portrait, simulate_many
from fuzzyarm.exchange.formats import read, write
from fuzzyarm.language import read_text
from fuzzyarm.learning import Fit, as_samples, validate
from fuzzyarm.plant import find_plant, reach_return


@pytest.fixture(scope="module")
def values():
    return dict(_values())


def _values():
    pd7, servo = load(shipped("pd7.frb")), load(shipped("servo.frb"))
    yield "nothing yet", RuleBaseBuilder("empty")
    fan = RuleBaseBuilder("fan")
    temp = fan.input("temp", 0, 1, terms=["cold", "hot"])
    fan.output("speed", 0, 1, terms={"on": 1}, defuzzifier="weighted-average", no_rule=0)
    fan.rule("if temp is hot then speed is on")
    yield "builder", fan
    yield "variable of a builder", temp
    yield "rule base", pd7
    yield "variable", pd7.inputs[0]
    yield "term", pd7.inputs[0].terms[0]
    yield "block", pd7.blocks[0]
    yield "parsed", fuzzyarm.parse(str(pd7))
    yield "review", fan.check()
    yield "table", pd7.table(levels=3)
    yield "axis", pd7.table(levels=3).axes[0]
    yield "report", fuzzyarm.compile_with_report(fan, levels=3)
    yield "trace", pd7.explain(e=1, ce=0.5)
    yield "verdict", fuzzyarm.prove(pd7, "u covered")
    yield "compiled", fuzzyarm.compiled(pd7)
    yield "controller", servo
    yield "what it says", servo.model
    yield "run", fuzzyarm.simulate(servo, "motor", duration=0.05)
    runs = [{"G_e": 1.0}, {"G_e": 2.0}]
    yield "many", simulate_many(servo, "motor", runs, duration=0.05, workers=1)
    yield "portrait", phase_portrait(pd7, duration=0.05, starts=[(1.0, 0.0)])
    yield "plant", find_plant("motor")
    yield "trajectory", reach_return()
    samples = as_samples(
        [[x / 9] for x in range(10)], [x / 9 for x in range(10)], names=("temp",), target="speed"
    )
    yield "samples", samples
    yield "validation", validate(fan.model, samples)
    yield "fit", _fit(pd7)
    yield "imported", read(shipped("pd7.frb"))
    yield "exported", write(pd7, ".fll")


def _fit(rulebase):
    """Return the result of a fit, without fitting."""
    shares = dict.fromkeys(("error", "error_of_numbers", "linear_error", "shrinkage"), 0.1)
    crossed = dict.fromkeys(("cross_validation", "linear_cross_validation"), 0.2)
    return Fit(
        rulebase=rulebase, text=str(rulebase), **shares, **crossed,
        candidates=(), structure="grid of 7 and 7", support=(), digits=4,
    )  # fmt: skip


@pytest.mark.slow
def test_a_value_is_one_line(values):
    for name, value in values.items():
        line = repr(value)
        assert "\n" not in line, name
        assert 10 < len(line) < 220, (name, line)
        assert " object at 0x" not in line, name


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("builder", "<RuleBaseBuilder fan: temp → speed, 1 rule>"),
        ("rule base", "<RuleBase pd7: e, ce → u, 49 rules>"),
        ("variable of a builder", "<Input temp 0 .. 1: cold hot>"),
        ("term", "Term(name='NB', shape=Shape('triangle', (-8.0, -6.0, -4.0)), lower=None)"),
        ("table", "<LookupTable u: e 3 × ce 3, nearest>"),
        ("trace", "<Trace pd7: e = 1, ce = 0.5 → u = 1, 4 of 49 rules fire>"),
        ("verdict", "<Verdict proved: u covered>"),
        ("trajectory", "<Trajectory reach-return: 15 s in 3 segments>"),
    ],
)
def test_what_the_line_says(values, name, line):
    assert repr(values[name]) == line


def test_the_text_of_a_rule_base_and_a_controller_is_its_file(values):
    assert fuzzyarm.parse(str(values["rule base"])).rulebase == values["rule base"]
    assert str(values["controller"]) == read_text(shipped("servo.frb"))
    assert fuzzyarm.parse(str(values["controller"])).controller == values["controller"].model


def test_print_draws_tables_and_traces(values):
    assert "4 of 49 rules fire" in str(values["trace"])
    assert re.search(r"e \\ ce +-6 +0 +6", str(values["table"]))


class Tags(HTMLParser):
    """What HTML consists of."""

    def __init__(self, text):
        super().__init__()
        self.names, self.open, self.text = set(), [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.names.add(tag)
        if tag != "img":
            self.open.append(tag)
        assert all(key in ("style", "src", "alt") for key, _ in attrs)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


ALLOWED = {"pre", "span", "table", "tr", "th", "td", "img"}


@pytest.mark.slow
def test_notebooks_draw_what_is_drawn(values):
    shown = {name: value for name, value in values.items() if hasattr(value, "_repr_html_")}
    assert set(shown) >= {
        "builder", "nothing yet", "rule base", "variable", "variable of a builder", "table",
        "trace", "verdict", "controller", "run", "portrait", "validation", "review",
    }  # fmt: skip
    pictures = {
        "rule base",
        "builder",
        "variable",
        "variable of a builder",
        "run",
        "portrait",
        "validation",
        "controller",
    }
    for name, value in shown.items():
        tags = Tags(value._repr_html_())
        assert tags.open == [], name
        assert tags.names <= ALLOWED, name
        assert ("img" in tags.names) == (name in pictures), name
    assert "table" in Tags(values["table"]._repr_html_()).names


HOSTILE = [
    "<script>alert(1)</script>",
    "</pre><img src=x onerror=alert(1)>",
    "a&b;<b>",
    "\x1b[31m\u202e",
]


@pytest.mark.slow
def test_hostile_names_are_only_text():
    made = RuleBaseBuilder(HOSTILE[0], HOSTILE[1])
    made.input(HOSTILE[1], 0, 1, HOSTILE[2], terms=HOSTILE)
    made.output(HOSTILE[2], 0, 1, HOSTILE[3], terms=HOSTILE, no_rule=0)
    made.grid(HOSTILE[2], HOSTILE)
    values = [made, made.model, made.model.inputs[0], made.table(levels=3), made.check()]
    for value in (*values, made.explain({HOSTILE[1]: 0.5})):
        html = value._repr_html_()
        tags = Tags(html)
        assert tags.names <= ALLOWED
        assert not re.search(r"<(script|b|i)\b|onerror=[^&]*>", re.sub(r'alt="[^"]*"', "", html))
        assert "\x1b" not in html
        assert "\u202e" not in html
        assert "\n" not in repr(value)
        assert repr(value).isprintable()


def test_very_many_rules_are_counted(values, monkeypatch):
    monkeypatch.setattr(notebook, "MOST_RULES", 0)
    assert "1 rules, which print writes" in values["builder"]._repr_html_()


def test_a_drawing_keeps_white_white():
    from rich.text import Text

    assert "#ffffff" in html_of_drawing(Text("x", "white on #b2182b"))


def test_figures_show_themselves(values):
    assert values["builder"].plot()._repr_png_().startswith(b"\x89PNG")
