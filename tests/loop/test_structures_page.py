"""The pages on structures: their texts are those of the files, their numbers those of the runs."""

import json
import re
from pathlib import Path

import pytest

from fuzzyarm.apps.cli import main

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "explanation" / "structures.md").read_text()
LAWS = (ROOT / "docs" / "howto" / "fuzzy-pid.md").read_text()

RUNS = re.findall(r"(?m)^\| `([\w/+-]+\.frb)` \| `([\w-]+)` \| `(--[^`]+)` \| (.+) \|$", PAGE)
ARM = re.findall(r"(?m)^\| `([\w+-]+)` \| ((?:[\d.]+ \| ){3}[\d.]+) \|$", PAGE)
TEXTS = re.findall(r"(?ms)^```text\n# (\S+\.frb)\n(.*?)^```", PAGE + LAWS)


def reported(words, capsys):
    assert main(["simulate", *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_the_page_has_what_the_tests_look_for():
    assert len(RUNS) >= 14
    assert len(ARM) >= 8
    assert {path for path, _ in TEXTS} >= {
        f"examples/controllers/{path.name}"
        for path in (ROOT / "examples/controllers").glob("*.frb")
    }


@pytest.mark.parametrize(
    ("path", "plant", "options", "shown"), RUNS, ids=[f"{run[0]} {run[2]}" for run in RUNS]
)
def test_every_row_is_what_its_run_gives(path, plant, options, shown, capsys):
    words = [str(ROOT / path), "--plant", plant, *options.split()]
    (metrics,) = reported(words, capsys)["metrics"].values()
    for name, cell in zip(
        ("rms", "overshoot", "settling", "variation"), shown.split(" | "), strict=True
    ):
        if cell == "-":
            assert metrics[name] is None, name
        else:  # last bits may differ from one machine to another
            assert metrics[name] == pytest.approx(float(cell), rel=2e-3, abs=1e-9), name


@pytest.mark.parametrize(("name", "shown"), ARM, ids=[row[0] for row in ARM])
def test_every_row_of_the_arm_is_what_its_run_gives(name, shown, capsys):
    run = reported([name, "--payload"], capsys)
    expected = [float(cell) for cell in shown.split(" | ")]
    assert run["rms"] + run["rms_path"] == pytest.approx(expected, abs=6e-5)


@pytest.mark.parametrize(("path", "text"), TEXTS, ids=[text[0] for text in TEXTS])
def test_every_text_is_that_of_its_file(path, text):
    assert text in (ROOT / path).read_text()
