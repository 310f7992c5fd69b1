"""The view Prove without a browser: verdicts are those of the command, with pictures of loops."""

import shutil

import pytest
from test_designer_learning import Page

from fuzzyarm.apps.cli import main
from fuzzyarm.base.shipped_files import shipped

LINES = "\nprove u in -6 .. 6\nprove u rises with e\n"


@pytest.fixture
def page(tmp_path):
    for name in ("pd7.frb", "servo.frb", "thesis-6.1.lut", "roompi.frb", "heater.frb"):
        shutil.copy(shipped(name), tmp_path)
    (tmp_path / "lines.frb").write_text(shipped("pd7.frb").read_text() + LINES)
    return Page(tmp_path)


def verdicts(heard):
    return [news for news in heard if "verdict" in news]


def test_the_lines_of_a_text_are_judged_as_by_the_command(page, monkeypatch, capsys):
    monkeypatch.chdir(page.folder)
    heard = verdicts(page.do("prove", "lines.frb"))
    assert [news["verdict"] for news in heard] == ["proved", "refuted"]
    assert main(["prove", "lines.frb"]) == 1
    printed = capsys.readouterr().out
    for news in heard:
        for line in news["lines"][:-1]:  # the last one has the time
            assert line.partition(": ")[2] or line in printed
            assert line.removeprefix("line ").strip() in printed


def test_a_range_and_slopes_are_bounded(page, monkeypatch, capsys):
    monkeypatch.chdir(page.folder)
    (news,) = verdicts(page.do("prove", "pd7.frb", range=True))
    assert main(["prove", "pd7.frb", "--range"]) == 0
    assert news["lines"][0] in capsys.readouterr().out
    heard = verdicts(page.do("prove", "pd7.frb", slope=True))
    assert [news["lines"][0].partition(" in ")[0] for news in heard] == [
        "slope of u along e",
        "slope of u along ce",
    ]


def test_what_may_be_asked_is_told(page):
    rules, loop = (page.do("provable", name)[0] for name in ("lines.frb", "servo.frb"))
    assert (rules["loop"], rules["lines"], rules["outputs"]) == (False, 2, ["u"])
    assert (loop["loop"], loop["lines"]) == (True, 0)
    assert "motor" in loop["plants"]
    assert {field["name"] for field in loop["form"]} >= {"claim", "plant", "budget"}


@pytest.mark.parametrize(
    ("file", "asked", "words", "field"),
    [
        ("pd7.frb", {}, "has no `prove` lines", ""),
        ("servo.frb", {}, "has no `prove` lines", ""),
        ("lines.frb", {"output": "x", "range": True}, "no output is called 'x'", "output"),
        ("lines.frb", {"tolerance": "-1"}, "tolerance must be above 0, not -1", "tolerance"),
        ("servo.frb", {"claim": "stable upon motor"}, "claim 'stable upon motor': ", "claim"),
        ("servo.frb", {"claim": "stable", "plant": "own.py"}, "no plant 'own.py'", "plant"),
        ("thesis-6.1.lut", {}, "proves nothing", ""),
        ("pd7.frb", {"sector": True, "along": "q=1"}, "q", "along"),
        ("servo.frb", {"from": "position in 0 .. 1"}, "--from goes with", ""),
        ("servo.frb", {"duration": "soon", "plant": "motor"}, "soon", "duration"),
    ],
)
def test_what_cannot_be_proved_is_said_at_its_field(page, file, asked, words, field):
    last = page.do("prove", file, **asked)[-1]
    assert (last["end"], last["field"]) == ("failed", field), last
    assert words in last["message"]


def test_a_table_is_sent_to_its_view(page):
    assert "the view Table" in page.message("provable", "thesis-6.1.lut")


@pytest.mark.slow
def test_a_region_is_proved_and_drawn(page):
    (news,) = verdicts(page.do("prove", "servo.frb", claim="stable on motor"))
    assert news["verdict"] == "proved"
    assert news["panels"][0]["across"]["words"] == "position, rad"
    kinds = {part["is"] for panel in news["panels"] for part in panel["parts"]}
    assert kinds >= {"dots", "area", "line"}


@pytest.mark.slow
def test_a_plant_of_a_line_is_the_one_that_the_designer_was_given(page):
    own = page.folder / "own.py"
    own.write_text(
        "from fuzzyarm.plant import Plant, Port\n\n\nclass Own(Plant):\n"
        "    inputs = {'u': Port('V', -10, 10)}\n    outputs = {'y': Port('V')}\n"
        "    states = {'y': 'V'}\n\n    def derivative(self, t, x, u, p):\n"
        "        return [u[0] - x[0]]\n"
    )
    (page.folder / "own.frb").write_text(
        "controller own\nperiod 10 ms\naxis own\n  e = error of y\n  drive u = e\n\n"
        "prove on 'own.py' from y in 0.1 .. 0.2: y in 0 .. 0.3 during 0 .. 50 ms\n"
    )
    last = page.do("prove", "own.frb")[-1]
    assert (last["field"], last["message"]) == ("plant", "there is no plant 'own.py' here")
    page.own = (str(own),)
    (news,) = verdicts(page.do("prove", "own.frb"))
    assert (news["verdict"], news["lines"][0].partition(": ")[0]) == ("proved", "line 7")


# --- Sectors, tables, tubes, certificates ---


@pytest.mark.slow
def test_sectors_and_the_error_of_a_table_are_those_of_the_command(page, monkeypatch, capsys):
    monkeypatch.chdir(page.folder)
    heard = verdicts(page.do("prove", "pd7.frb", sector=True))
    assert main(["prove", "pd7.frb", "--sector"]) == 0
    printed = capsys.readouterr().out.splitlines()
    assert [line for news in heard for line in news["lines"]] == printed
    assert all(news["panels"] for news in heard)
    (news,) = verdicts(page.do("prove", "pd7.frb", table="linear"))
    assert main(["prove", "pd7.frb", "--table", "linear"]) == 0
    assert news["lines"] == capsys.readouterr().out.splitlines()
    (own,) = verdicts(page.do("prove", "pd7.frb", table="thesis-6.1.lut"))
    assert own["lines"][0].startswith("worst ")
    last = page.do("prove", "pd7.frb", table="../x.lut")[-1]
    assert (last["field"], "not a table of this folder" in last["message"]) == ("table", True)


@pytest.mark.slow
def test_the_drives_of_a_controller_have_ranges_gains_and_sectors(page, monkeypatch, capsys):
    monkeypatch.chdir(page.folder)
    (news,) = verdicts(page.do("prove", "servo.frb", sector=True, plant="motor"))
    assert main(["prove", "servo.frb", "--sector", "--plant", "motor"]) == 0
    printed = capsys.readouterr().out.splitlines()
    assert news["lines"][0].partition(": ")[2] == printed[0].partition(": ")[2]
    assert set(printed[1:]) <= set(news["lines"])  # which also have limits and gains
    assert news["panels"]


@pytest.mark.slow
def test_a_certificate_is_offered_and_proves_what_it_says(page, monkeypatch, capsys):
    from fuzzyarm.apps.designer.jobs import Downloads

    kept = {}
    monkeypatch.setattr(
        Downloads, "offer", lambda self, name, content: kept.setdefault(name, content) and name
    )
    asked = {"map": True, "over": "position in -0.1 .. 0.1, velocity in -1 .. 1"}
    # Without a plant it is the usual one.
    for more in ({"claim": "stable"}, {"claim": "stable on motor"}, asked):
        kept.clear()
        news = verdicts(page.do("prove", "servo.frb", certificate=True, **more))[-1]
        assert [file["name"] for file in news["files"]] == ["servo.json"]
        path = page.folder / "servo.json"
        path.write_bytes(kept["servo.json"])
        assert str(page.folder) not in path.read_text()
        assert main(["prove", "--check", str(path)]) == 0
        assert "proved" in capsys.readouterr().out


@pytest.mark.slow
def test_a_loop_is_bounded_for_a_time_from_its_starts(page):
    asked = {"duration": "20ms", "from": "position in 0 .. 0.01", "plant": "motor"}
    (news,) = verdicts(page.do("prove", "servo.frb", **asked))
    assert news["verdict"] == "proved", news["lines"]
    assert "for 0.02 s" in news["lines"][0]
    assert news["panels"]


@pytest.mark.slow
def test_a_map_of_starts_is_that_of_the_command_and_fills(page, monkeypatch, capsys):
    monkeypatch.chdir(page.folder)
    asked = {"map": True, "over": "position in -1 .. 1, velocity in -4 .. 4", "plant": "motor"}
    *growing, news = verdicts(page.do("prove", "servo.frb", **asked))
    assert all(each["so_far"] and each["panels"] for each in growing)
    assert (news["verdict"], news["so_far"], len(news["panels"])) == ("proved", False, 1)
    words = ["prove", "servo.frb", "--plant", "motor", "--map", "--over", asked["over"]]
    assert main(words) == 0
    printed = capsys.readouterr().out.splitlines()
    assert [line.strip() for line in news["lines"][0].splitlines()][1:] == [
        line.strip() for line in printed[1 : len(news["lines"][0].splitlines())]
    ]


@pytest.mark.slow
def test_margins_are_those_of_the_command(page, monkeypatch, capsys):
    monkeypatch.chdir(page.folder)
    (facts,) = [news for news in page.do("opened-loop", "servo.frb") if "form" in news]
    assert [each["name"] for each in facts["plants"] if each["fits"]] == ["motor"]
    (news,) = verdicts(page.do("margins", "servo.frb"))
    assert main(["margins", "servo.frb", "--plant", "motor"]) == 0
    assert "\n".join(news["lines"]) == capsys.readouterr().out.strip()
    assert [panel["equal"] for panel in news["panels"]] == [False, False, True]


@pytest.mark.parametrize(
    ("file", "asked", "words", "field"),
    [
        ("pd7.frb", {}, "only the loop of a controller has margins", ""),
        ("servo.frb", {"plant": "room"}, "room", "plant"),
        ("servo.frb", {"share": "2"}, "share", "share"),
    ],
)
def test_a_loop_without_margins_says_why(page, file, asked, words, field):
    last = page.do("margins", file, **asked)[-1]
    assert (last["end"], last["field"]) == ("failed", field), last
    assert words in last["message"]
