"""Random edits sent to the real process, in bursts as a hasty typist makes them."""

from __future__ import annotations

import random

import pytest
import pytest_lsp
from lsprotocol import types
from pytest_lsp import LanguageClient
from random_edits import SMALL, changed, random_edit
from server_client import CHANGE, CONFIG, File, partial, start

from fuzzyarm.exchange.files import check_text

pytestmark = [pytest.mark.asyncio(loop_scope="module"), pytest.mark.slow]


@pytest_lsp.fixture(scope="module", loop_scope="module", config=CONFIG)
async def client(lsp_client: LanguageClient):
    await start(lsp_client)
    yield
    await lsp_client.shutdown_session()


async def test_bursts_of_edits_end_with_the_findings_of_a_fresh_check(
    client: LanguageClient,
) -> None:
    chance = random.Random(16)
    file = await File.open(client, SMALL)
    text = SMALL
    for _ in range(120):
        changes = []
        for _ in range(chance.randrange(1, 8)):
            where, new = random_edit(text, chance)
            text = changed(text, where, new)
            whole = where is None
            changes.append(CHANGE(text=new) if whole else partial(where[:2], where[2:], new))
        found = await file.change(*changes)
        assert [d.code for d in found] == [d.name for d in check_text(text).diagnostics]
        await file.ask("completion", chance.randrange(15), chance.randrange(30))
    assert not [m for m in client.messages if m.type == types.MessageType.Error]
    assert client.error is None
