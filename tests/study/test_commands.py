"""simulate, reproduce and identify as a person calls them."""

import json
import math

import pytest

from fuzzyarm.apps.cli import main

FAST = ["--segment", "0.2"]


def run(capsys, *words):
    status = main(list(words))
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_simulate_prints_the_contract(capsys):
    status, out, err = run(
        capsys,
        "simulate",
        "cdid+ie",
        "--trajectory",
        "pick-and-place",
        "--angles",
        "30",
        "-20",
        *FAST,
        "--payload",
        "--json",
    )
    assert (status, err) == (0, "")
    result = json.loads(out)
    assert result["controller"] == "cdid+ie"
    assert result["trajectory"] == "pick-and-place"
    assert result["samples"] == 4 * 67
    for name in ("rms", "max", "final"):
        assert len(result[name]) == 2
        assert all(math.isfinite(value) for value in result[name])
    assert result["precision"] == "float64"
    assert result["diverged"] is None


@pytest.mark.slow
def test_simulate_with_the_study_values(capsys):
    _, out, _ = run(capsys, "simulate", "pd", "--conventions", "study", "--payload", "--json")
    result = json.loads(out)
    assert result["samples"] == 3 * 1666
    assert result["precision"] == "float32"
    assert result["rms"][0] == pytest.approx(7.1415, abs=1e-3)
    assert result["final"][0] == pytest.approx(9.4447, abs=1e-3)


def test_precision_overrules_the_conventions(capsys):
    _, out, _ = run(
        capsys,
        "simulate",
        "pd",
        "--conventions",
        "study",
        "--precision",
        "float64",
        *FAST,
        "--json",
    )
    assert json.loads(out)["precision"] == "float64"


@pytest.mark.slow
def test_load_changes_the_result_and_no_payload_is_the_default(capsys):
    results = [
        json.loads(run(capsys, "simulate", "pd", *FAST, *words, "--json")[1])["rms"]
        for words in ([], ["--no-payload"], ["--payload"], ["--loaded", "2", "3"])
    ]
    assert results[0] == results[1]
    assert results[0] != results[2] == results[3]


@pytest.mark.slow
def test_simulate_as_text_and_plot(capsys, tmp_path):
    figure = tmp_path / "errors.png"
    status, out, _ = run(capsys, "simulate", "pd", *FAST, "--plot", str(figure))
    assert status == 0
    assert "rms" in out
    assert "joint2" in out
    assert figure.read_bytes().startswith(b"\x89PNG")


def test_gains_are_shown_and_set(capsys):
    _, out, _ = run(capsys, "simulate", "mrac+ie", "--show-gains")
    assert "identified" in out
    assert "N m/rad" in out
    _, out, _ = run(capsys, "simulate", "pd", "--set", "K_P=120,80", "--show-gains", "--json")
    shown = json.loads(out)["gains"]["K_P"]
    assert shown["value"] == [120.0, 80.0]
    assert shown["origin"] == "given"


def test_list_names_every_controller(capsys):
    _, out, _ = run(capsys, "simulate", "--list", "--json")
    assert {"pd", "cdid+ie", "mrac+ie"} <= set(json.loads(out))


def test_diverged_run_is_reported_with_finite_figures(capsys):
    status, out, _ = run(capsys, "simulate", "pid", "--set", "K_I=1000", "--json")
    result = json.loads(out)
    assert status == 3
    assert 0.0 < result["diverged"] < 1.0
    assert all(math.isfinite(value) for value in result["rms"])
    assert "NaN" not in out
    status, out, _ = run(capsys, "simulate", "pid", "--set", "K_I=1000")
    assert status == 3
    assert "diverged: stopped at" in out
    assert "nan" not in out


def test_run_without_a_sample_prints_null(capsys):
    _, out, _ = run(capsys, "simulate", "pd", "--set", "K_D=-1e9", "--json")
    result = json.loads(out)
    assert result["samples"] == 0
    assert result["rms"] == [None, None]


@pytest.mark.parametrize(
    ("words", "status"),
    [
        (["cdidd"], 1),
        (["pd", "--angles", "nan", "1"], 2),
        (["pd", "--angles", "1", "99999"], 1),
        (["pd", "--segment", "0"], 2),
        (["pd", "--segment", "inf"], 2),
        (["pd", "--hold", "nan"], 2),
        (["pd", "--set", "K_P"], 2),
        (["pd", "--set", "K_P=x"], 2),
        (["pd", "--set", "K_P=inf"], 2),
        (["pd", "--set", "nothing=1"], 1),
        (["pd", "--loaded", "9"], 1),
        (["pd", "--limits", "0", "1"], 2),
        (["pd", "--runge-kutta", "-1"], 2),
        (["pd", "--way-points", "1"], 1),
        (["pd", "--way-points", "nan,1"], 2),
        (["pd", "--trajectory", "pick-and-place", "--hold", "1"], 1),
        (["pd", "--plot", "x.nothing"], 2),
        (["pd", "--plot", "/no/such/folder/x.png"], 1),
        (["missing.py"], 1),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else str(value),
)
def test_bad_input_is_one_clear_line(capsys, words, status, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    got, out, err = run(capsys, "simulate", *words)
    assert got == status
    assert out == ""
    assert err.startswith("fuzzyarm: ")
    assert err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("words", [[], ["pd", "--trajectory", "spiral"], ["pd", "--angles", "1"]])
def test_wrong_usage(capsys, words):
    assert run(capsys, "simulate", *words)[0] == 2


@pytest.mark.slow
def test_own_controller_runs_with_the_same_command(capsys, tmp_path):
    file = tmp_path / "mine.py"
    file.write_text(
        "from fuzzyarm.control.controllers import Controller\n"
        "class Mine(Controller):\n"
        "    def torque(self, reference, state, clock):\n"
        "        return 10.0 * reference.position[0], 0.0\n"
    )
    status, out, _ = run(capsys, "simulate", str(file), *FAST, "--json")
    assert status == 0
    assert json.loads(out)["controller"] == "mine"
    _, _, err = run(capsys, "simulate", f"{file}+pd", *FAST, "--json")
    assert "times as long as compiled pd" in err


@pytest.mark.slow
def test_reproduce_prints_the_contract(capsys):
    status, out, err = run(capsys, "reproduce", "7.1.1/pd", "5.4.1", "--json")
    assert (status, err) == (0, "")
    rows = json.loads(out)
    assert [(row["row"], row["table"], row["variant"]) for row in rows] == [
        ("ACDID", "5.4.1", "as-described"),
        ("ACDID", "5.4.1", "as-printed"),
        ("PD", "7.1.1", "as-printed"),
    ]
    for row in rows:
        assert len(row["published"]) == len(row["reproduced"]) == 8
        assert row["within"] is (row["variant"] == "as-printed")


@pytest.mark.slow
def test_reproduce_as_text_has_a_verdict_for_each_row(capsys, tmp_path):
    status, out, _ = run(capsys, "reproduce", "4.2.5.1/cdid", "--plot", str(tmp_path / "figures"))
    assert status == 0
    assert "published" in out
    assert "agrees: RMS within" in out
    assert "1 of 1 rows agree" in out
    (figure,) = (tmp_path / "figures").iterdir()
    assert figure.name == "4.2.5.1-cdid.png"
    assert figure.read_bytes().startswith(b"\x89PNG")


def test_reproduce_lists_rows_and_refuses_unknown_ones(capsys):
    _, out, _ = run(capsys, "reproduce", "--list")
    assert len(out.splitlines()) == 41
    status, _, err = run(capsys, "reproduce", "cdidd")
    assert status == 1
    assert "did you mean" in err


def test_identify_refuses_what_was_not_identified(capsys):
    status, _, err = run(capsys, "identify", "pd")
    assert status == 1
    assert "mrac" in err


@pytest.mark.slow
def test_identify_prints_fitted_beside_shipped(capsys):
    _, out, _ = run(capsys, "identify", "mrac+ie")
    assert "fitted" in out
    assert "K_I" in out
    _, out, _ = run(capsys, "identify", "mrac+ie", "--json")
    assert json.loads(out)[0]["labels"] == ["K_I"]


def duration(capsys, *words):
    """Return how long a run is, s: a sample every 3 ms."""
    status, out, _ = run(capsys, "simulate", "pd", *words, "--json")
    assert status == 0
    return 0.003 * json.loads(out)["samples"]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "moves"), [("reach", 1), ("reach-return", 2)])
def test_the_hold_is_5_s_unless_it_is_given(capsys, name, moves):
    words = ["--trajectory", name]
    assert duration(capsys, *words) == pytest.approx(5.0 * moves + 5.0, abs=0.02)
    assert duration(capsys, *words, "--segment", "0.5") == pytest.approx(
        0.5 * moves + 5.0, abs=0.02
    )
    assert duration(capsys, *words, "--hold", "0.3") == pytest.approx(5.0 * moves + 0.3, abs=0.02)
    both = ["--segment", "0.5", "--hold", "0.3"]
    assert duration(capsys, *words, *both) == pytest.approx(0.5 * moves + 0.3, abs=0.02)


def test_a_run_that_diverges_before_its_first_sample_prints_no_figures(capsys):
    words = ["simulate", "pd", "--set", "K_P=1e9", *FAST]
    status, out, _ = run(capsys, *words)
    assert status == 3
    assert "0 samples" in out
    assert "before the first sample" in out
    assert "nan" not in out
    _, out, _ = run(capsys, *words, "--json")
    result = json.loads(out)
    assert result["rms"] == result["max"] == result["final"] == [None, None]
    assert 0.0 < result["diverged"] < 0.003
