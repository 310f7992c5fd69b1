"""The report on files and their conversions: the search of `diff` beside a grid."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import conversions

from fuzzyarm.language import load_rulebase
from fuzzyarm.language.model.rulebase import RuleBase

ROOT = Path(__file__).parents[2]


def test_each_output_of_each_file_is_compared_and_no_grid_has_more(tmp_path, capsys):
    shutil.copy(ROOT / "examples" / "elsewhere" / "heater.fis", tmp_path / "b.fis")
    (tmp_path / "deeper").mkdir()
    shutil.copy(tmp_path / "b.fis", tmp_path / "deeper" / "a.fis")
    (tmp_path / "c.fis").write_text("[System]\nNumInputs=zero\n")
    assert conversions.main([str(tmp_path), "--to", ".fll", "--points", "2000", "--json"]) == 0
    out, err = capsys.readouterr()
    assert [pair["file"] for pair in json.loads(out)] == ["b.fis", "a.fis"]
    assert "c.fis: is not read" in err


def test_what_a_grid_has_and_the_search_has_not_is_told(tmp_path, capsys, monkeypatch):
    shutil.copy(ROOT / "examples" / "elsewhere" / "heater.fis", tmp_path)
    monkeypatch.setattr(conversions, "on_grid", lambda before, after, points: ([1e9], 1))
    assert conversions.main([str(tmp_path)]) == 1
    out = capsys.readouterr().out
    assert "MISSED" in out
    assert "1 grids have more than the search" in out


def test_the_grid_is_all_of_it(monkeypatch):
    monkeypatch.setattr(conversions, "AT_ONCE", 7)
    pd7: RuleBase = load_rulebase(ROOT / "rulebases" / "pd7.frb")
    worst, count = conversions.on_grid(pd7, pd7, 100)
    assert (worst, count) == ([0.0], 100)
