"""Other people's files give the numbers that the programs they were written for gave."""

from __future__ import annotations

from functools import cache

import pytest
from corpus import Row, summary, survey
from needs import CORPUS, requires

pytestmark = [
    pytest.mark.slow,
    requires("corpus"),
]

EXPLAINED = {"tsukamoto": "fuzzylite gives infinity for a sigmoid that fires fully"}
"""Part of a file's name → why its numbers differ; docs/reference/formats.md tells more."""


@cache
def rows() -> tuple[Row, ...]:
    return tuple(survey(CORPUS / "files"))


@pytest.mark.parametrize(("suffix", "least"), [(".fll", 0.99), (".fis", 0.95), (".fcl", 0.95)])
def test_files_import(suffix: str, least: float) -> None:
    of_suffix = [row for row in rows() if row.format == suffix]
    with_rules = [row for row in of_suffix if "error[no-rules]" not in row.first]
    assert len(with_rules) >= 0.85 * len(of_suffix)
    assert sum(row.imported for row in with_rules) >= least * len(with_rules)


def test_a_file_that_does_not_import_says_where() -> None:
    for row in rows():
        assert row.imported or row.first.partition("error[")[2]


def test_imported_files_give_the_reference_numbers() -> None:
    counts = summary(list(rows()))["all"]
    assert counts["compared"] > 100
    assert counts["matched"] >= 0.98 * counts["compared"]


def test_each_remaining_difference_is_known() -> None:
    differing = [row.file for row in rows() if row.differences]
    assert [f for f in differing if not any(part in f for part in EXPLAINED)] == []
