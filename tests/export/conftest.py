"""Trials of exported controllers are shorter here, except where they are judged."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from budget import cases

from fuzzyarm.exchange.export import controllers

JUDGES = {"test_noticed_mutants.py"}
"""Tests of the sequence that a controller is tried with."""


@pytest.fixture(scope="module", autouse=True)
def shorter_trials(request: pytest.FixtureRequest) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        if request.path.name not in JUDGES:
            patch.setattr(controllers, "PERIODS", cases(50, 200))
        yield
