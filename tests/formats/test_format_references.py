"""Our own files give the numbers that pyfuzzylite 8.0.6 gave for them."""

from __future__ import annotations

from pathlib import Path

import pytest
from corpus import read_references, worst_difference

from fuzzyarm.exchange.formats import parse, read, write

HERE = Path(__file__).parent
REFERENCES = sorted((HERE / "reference").glob("*.json"))


@pytest.mark.parametrize("path", REFERENCES, ids=lambda path: path.stem)
def test_numbers_of_the_other_program(path: Path) -> None:
    rulebase = read(HERE / "data" / path.stem).rulebase
    assert rulebase is not None
    (reference,) = read_references(path)
    assert len(reference.inputs) == 60
    assert worst_difference(rulebase, reference) < 1e-9


@pytest.mark.parametrize("path", REFERENCES, ids=lambda path: path.stem)
@pytest.mark.parametrize("suffix", [".frb", ".fll"])
def test_numbers_after_a_conversion(path: Path, suffix: str) -> None:
    rulebase = read(HERE / "data" / path.stem).rulebase
    assert rulebase is not None
    text = write(rulebase, suffix).text
    assert text is not None
    again = parse(text, suffix).rulebase
    assert again is not None
    (reference,) = read_references(path)
    assert worst_difference(again, reference) < 1e-9
