"""Controllers in the terminal and in figures: lines with what flows, diagrams, differences."""

import itertools
import json
import re

import pytest

import fuzzyarm
from fuzzyarm.apps.cli.main import main
from fuzzyarm.apps.show.controller import SignalFlow, controller_view, flow_rows, line_words
from fuzzyarm.apps.show.controller_diff import compare_controllers
from fuzzyarm.apps.show.diagram import block_diagram
from fuzzyarm.apps.show.drawing import plain_text
from fuzzyarm.apps.show.figures import controller_figure, diagram_figure
from fuzzyarm.apps.show.figures.diagram import PEN
from fuzzyarm.apps.show.placement import place
from fuzzyarm.base.shipped_files import shipped, shipped_names
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.language import parse

NAMES = sorted(
    name
    for name in shipped_names()
    if name.endswith(".frb") and "\ncontroller " in shipped(name).read_text(encoding="utf-8")
)


def flow(name):
    (axes,) = fuzzyarm.load(shipped(name)).model.axes
    return plain_text(SignalFlow(axes))


def test_lanes_begin_where_signals_are_made_and_end_where_they_are_read_last():
    assert flow("tanks.frb") == (
        "  ●     h = error of level2\n"
        "  ├─●   e = h * G_e\n"
        "  ● │   ce = rate of h * G_ce, filter 2 s\n"
        "  ●─┘   v = rules roompi(e, ce)\n"
        "  ├─●   i = integral of v, anti-windup hold\n"
        "  ●─┘   pump = v * G_p + i * G_i\n"
        "  └──▶  drive pump = pump, within 0 .. 12\n"
    )


def test_zooms_learners_and_partners_have_their_signs():
    assert "  ◆─◆     zoom e, ce by magnification inside window\n" in flow("cfaf.frb")
    assert "  ├─┼▶  learn F by P(e, ce), delay 1" in flow("soc-zero.frb")
    text = plain_text(controller_view(fuzzyarm.load(shipped("dac+fuzzy.frb"))))
    assert "drive torque = partner base" in text


@pytest.mark.parametrize("name", NAMES)
def test_a_line_is_written_as_the_language_reads_it(name):
    """The lines of the view, below the head of the file, mean what the file means."""
    text = fuzzyarm.load(shipped(name))
    partners = [each.name for each in text.model.partners]
    head = text.source[: text.source.index("\naxis ")]
    parts = [head]
    for axes in text.model.axes:
        parts.append(f"\naxis {', '.join(axes.names)}")
        parts += [f"  {line_words(line, partners)}" for line in axes.lines]
    parsed = parse("\n".join([*parts, ""]))
    assert parsed.controller == text.model


@pytest.mark.parametrize("name", NAMES)
def test_every_lane_has_its_beginning_and_its_end(name):
    for axes in fuzzyarm.load(shipped(name)).model.axes:
        rows = flow_rows(axes)
        assert len({len(row.strokes) for row in rows}) == 1
        for above, row in itertools.pairwise(rows):
            for k in range(0, len(row.strokes), 2):
                goes_on = above.below[k : k + 1] == "│"
                comes = row.strokes[k] in "│├┤┼└┘┴◆" or (row.strokes[k] == "●" and goes_on)
                assert comes == goes_on or (row.strokes[k] == "─" and not goes_on), (above, row)
        assert "│" not in rows[-1].below


def test_long_lines_are_wrapped_beside_their_lanes():
    (axes,) = fuzzyarm.load(shipped("tanks.frb")).model.axes
    lines = plain_text(SignalFlow(axes), width=40).splitlines()
    assert all(len(line) <= 40 for line in lines)
    assert "  ● │   ce = rate of h * G_ce, filter 2" in lines
    assert "  │ │     s" in lines


def test_show_has_gains_lines_and_what_is_looked_up(capsys):
    assert main(["show", str(shipped("cfaf.frb"))]) == 0
    said = capsys.readouterr().out
    assert "every 0.6 ms, a set point every 5 periods, for the plant arm" in said
    assert re.search(r"converter +255/6 steps per unit of control", said)
    assert "rules pd7 from pd7-study.frb" in said
    assert "rules alpha7 from alpha7-study.frb" in said
    assert main(["show", str(shipped("soc-zero.frb")), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["kind"] == "controller"
    lines = shipped("soc-zero.frb").read_text(encoding="utf-8").splitlines()
    learn = next(each for each in data["diagram"]["blocks"] if each["kind"] == "learn")
    assert lines[learn["line"] - 1].strip().startswith("learn F by P")


@pytest.mark.parametrize("name", NAMES)
def test_words_of_a_diagram_stay_in_their_blocks_and_apart(name):
    picture = place(block_diagram(fuzzyarm.load(shipped(name))), PEN)
    boxes = [(b.x, b.y, b.x + b.width, b.y + b.height) for b in picture.blocks]
    for k, (x0, y0, x1, y1) in enumerate(boxes):
        assert x0 >= 0
        assert y0 >= 0
        assert x1 <= picture.width + 1e-9
        assert y1 <= picture.height + 1e-9
        for a0, b0, a1, b1 in boxes[k + 1 :]:
            assert x1 <= a0 or a1 <= x0 or y1 <= b0 or b1 <= y0
    for placed in picture.blocks:
        for text, style in placed.lines:
            assert PEN.width_of(text, style) <= placed.width
        assert len(placed.lines) * PEN.line <= placed.height
    for word in picture.words:
        right = word.x + PEN.width_of(word.text, word.style)
        assert right <= picture.width + 1e-9
        for x0, y0, x1, y1 in boxes:
            covered = word.x < x1 and x0 < right and y0 < word.y and word.y - PEN.line < y1
            assert not covered or word.style == "head"
        for (a, b), (c, d) in picture.strokes:  # an upright stroke may touch no name
            upright = a == c and word.x < a < right
            assert not (upright and min(b, d) < word.y and word.y - 0.8 * PEN.line < max(b, d))


def test_figures_are_drawn_of_all_kinds():
    for name in ("servo.frb", "soc-zero.frb"):
        text = fuzzyarm.load(shipped(name))
        small, whole = diagram_figure(text), controller_figure(text)
        assert whole.get_figheight() > small.get_figheight() + 3.0


@pytest.mark.slow
def test_plot_of_a_controller(tmp_path, capsys):
    for words in ([], ["--what", "diagram"]):
        path = tmp_path / f"{len(words)}.svg"
        assert main(["plot", str(shipped("servo.frb")), "-o", str(path), *words]) == 0
        drawn = path.read_text(encoding="utf-8")
        assert "drive voltage" in drawn
        assert "49 rules" in drawn
    capsys.readouterr()
    table = str(shipped("performance-yamazaki.lut"))
    assert main(["plot", table, "-o", "x.png", "--what", "diagram"]) == 1
    assert "--what diagram is for rule bases and controllers" in capsys.readouterr().err
    assert main(["show", table, "--diagram"]) == 1
    assert "--diagram is for rule bases and controllers" in capsys.readouterr().err


# --- Differences ---


def changed(old, new, name="servo.frb"):
    text = fuzzyarm.load(shipped(name))
    assert old in text.source, old
    other = parse(text.source.replace(old, new), str(shipped(name)))
    assert other.controller is not None, other.diagnostics
    return compare_controllers(text, ControllerText(other.controller, text.sheets, text.path))


def test_the_same_is_the_same_whatever_its_comments():
    assert changed("# A DC servo", "# Another comment").same
    for name in NAMES:
        text = fuzzyarm.load(shipped(name))
        assert compare_controllers(text, fuzzyarm.load(shipped(name))).same


@pytest.mark.parametrize(
    ("old", "new", "part", "said"),
    [
        ("= 16 ", "= 16.00001 ", "gains", "G_e: 16 1/rad -> 16.00001 1/rad"),
        ("tune 2 .. 200 log", "tune 2 .. 100 log", "gains", "G_e, tune: 2 .. 200 log -> 2 .. 100"),
        ("period 1 ms", "period 2 ms", "settings", "period: 1 ms -> 2 ms"),
        ("* G_ce\n", "* G_ce * 2\n", "lines", "ce: error of velocity * G_ce -> error of velocity"),
        ("-24 .. 24", "-12 .. 12", "lines", "drive voltage: u, within -24 .. 24 -> u, within -12"),
        ("axis shaft\n", "axis other\n", "lines", "axis shaft: e: error of position * G_e"),
        ("controller servo", "controller second", "settings", "name: servo -> second"),
    ],
)
def test_what_differs_is_said_where_it_differs(old, new, part, said):
    diff = changed(old, new)
    assert not diff.same
    assert any(str(each).startswith(said) for each in getattr(diff, part)), diff


def test_the_order_of_lines_counts_where_nothing_else_differs():
    lines = "  e  = error of position * G_e\n  ce = error of velocity * G_ce\n"
    first, second = lines.splitlines(keepends=True)
    assert changed(lines, second + first).order == ("shaft",)


def test_rule_bases_that_are_looked_up_are_compared(tmp_path, capsys):
    (tmp_path / "pd7.frb").write_text(
        shipped("pd7.frb").read_text(encoding="utf-8").replace("NB  NB  NB  NM", "NB  NB  NB  NS"),
        encoding="utf-8",
    )
    (tmp_path / "servo.frb").write_text(shipped("servo.frb").read_text(encoding="utf-8"))
    words = ["diff", str(shipped("servo.frb")), str(tmp_path / "servo.frb")]
    assert main(words) == 0
    said = capsys.readouterr().out
    assert "rules pd7\n" in said
    assert "~ if e is NB and ce is ZE: u is NM -> u is NS" in said
    assert main([*words, "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert (data["same"], data["gains"], len(data["rulebases"]["pd7"]["rules"])) == (False, [], 1)


def test_tables_that_are_looked_up_are_compared(tmp_path, capsys):
    table = fuzzyarm.load(shipped("thesis-6.1.lut"))
    values = table.values.copy()
    values[3, 4] += 1.0
    fuzzyarm.write_table(table.with_values(values), tmp_path / "thesis-6.1.lut")
    (tmp_path / "c.frb").write_text(shipped("fuzzy-lut.frb").read_text(encoding="utf-8"))
    assert main(["diff", str(shipped("fuzzy-lut.frb")), str(tmp_path / "c.frb"), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert [len(each["cells"]) for each in data["tables"].values()] == [1]


def test_a_controller_and_a_rule_base_cannot_be_compared(capsys):
    assert main(["diff", str(shipped("servo.frb")), str(shipped("pd7.frb"))]) == 1
    err = capsys.readouterr().err
    assert "a controller and a rule base cannot be compared" in err
    assert "looks up" in err
