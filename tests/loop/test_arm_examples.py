"""The examples of the arm run as they stand; some more in docs/test_comparison_page.py."""

import json
import runpy
from pathlib import Path

import pytest

from fuzzyarm.apps.cli import main

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_own_controller_is_short_and_runs_from_the_command_line(capsys):
    file = EXAMPLES / "own_controller.py"
    body = file.read_text().split('"""')[2].splitlines()
    assert len([line for line in body if line.strip()]) < 30
    assert main(["simulate", str(file), "--segment", "0.5", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["controller"] == "own_controller"
    assert max(result["rms"]) < 20.0
    main(["simulate", "pd", "--segment", "0.5", "--json"])
    assert max(result["final"]) < max(json.loads(capsys.readouterr().out)["final"])


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "close_a_loop",
        "compare_controllers",
        "compare_fuzzy",
        "hybrid_run",
        "identify_gains",
    ],
)
def test_example_runs(capsys, name, tmp_path, monkeypatch):
    words = {"hybrid_run": [str(tmp_path)]}
    monkeypatch.setattr("sys.argv", [f"{name}.py", *words.get(name, [])])
    runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")
    assert capsys.readouterr().out.count("\n") >= 2
    assert len(list(tmp_path.iterdir())) == (4 if "hybrid" in name else 0)
