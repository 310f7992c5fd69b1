"""docs/howto/python.md shows what comes out."""

import doctest
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "howto" / "python.md"


def test_the_page_shows_what_comes_out(tmp_path, monkeypatch):
    pytest.importorskip("xarray")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("FUZZYARM_NATIVE", "0")
    flags = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
    text = "\n".join(
        "" if line.startswith("```") else line for line in PAGE.read_text("utf-8").splitlines()
    )
    test = doctest.DocTestParser().get_doctest(text, {}, "python.md", str(PAGE), 0)
    assert len(test.examples) > 30
    runner = doctest.DocTestRunner(optionflags=flags, verbose=False)
    runner.run(test)
    assert runner.summarize(verbose=False).failed == 0
