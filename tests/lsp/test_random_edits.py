"""Many random edits: no exception, and the findings of a fresh check after each."""

from __future__ import annotations

import random

import pytest
from budget import cases
from random_edits import SMALL, changed, random_edit

from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.exchange.files import check_text
from fuzzyarm.language.edit import coloured, complete, hover

STEPS = cases(800, 10_000)


@pytest.mark.slow
@pytest.mark.parametrize("part", range(2))
def test_random_edits_of_the_document_model(part: int) -> None:
    chance = random.Random(60 + part)
    session = Session("small.frb", SMALL)
    sound = 0
    for step in range(STEPS // 2):
        where, new = random_edit(session.text, chance)
        expected = changed(session.text, where, new)
        session.change(where, new)
        assert session.text == expected, (step, where, new)
        review = session.review()
        assert review.diagnostics == check_text(session.text, "small.frb").diagnostics, step
        sound += not review.failed
        if step % 10 == 0:
            line = chance.randrange(len(session.lines) + 1) + 1
            complete(session.reading, line, 1 + chance.randrange(40))
            hover(session.reading, line, 1 + chance.randrange(40))
            coloured(session.reading)
    # The edits must reach sound files too, where the checks and expectations run.
    assert sound > STEPS // 2 // 500


@pytest.mark.slow
def test_tables_survive_edits_too() -> None:
    from fuzzyarm.apps.lsp.tables import TableText
    from fuzzyarm.table import parse_lut

    text = (
        "fuzzyarm-table 1\ninput 𝜃 -1 .. 1\ninput x -1 .. 1\noutput u -1 .. 1\n"
        "index row 𝜃, column x\nlevels -1 .. 1 step 1\ngrid\n"
        "  𝜃 \\ x  -1  0  1\n  -1  -1  0  0\n  0  0  0  0\n  1  0  0  1\n"
    )
    chance = random.Random(7)
    session = Session("small.lut", text)
    for _ in range(400):
        where, new = random_edit(session.text, chance)
        session.change(where, text if where is None else new)
        found = session.review().diagnostics
        assert found == parse_lut(session.text, "small.lut").diagnostics
        table = TableText(session.text)
        line, column = chance.randrange(12) + 1, chance.randrange(20) + 1
        table.complete(line, column)
        table.hover(line, column)
        table.symbols()
        table.folds()
        table.coloured()
