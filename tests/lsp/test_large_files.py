"""A file whose check takes long: questions are answered beside it, and it ends right."""

from __future__ import annotations

import asyncio

import pytest
import pytest_lsp
from lsprotocol import types
from pytest_lsp import LanguageClient
from server_client import CONFIG, File, partial, start

from fuzzyarm.apps.lsp.session import SLOW, Session
from fuzzyarm.exchange.files import check_text

pytestmark = pytest.mark.slow


@pytest_lsp.fixture(scope="module", loop_scope="module", config=CONFIG)
async def client(lsp_client: LanguageClient):
    await start(lsp_client)
    yield
    await lsp_client.shutdown_session()


def _large(size: int) -> str:
    terms = " ".join(f"T{i}" for i in range(size))
    lines = ["rulebase large", "input a 0 .. 9", "input b 0 .. 9", "input c 0 .. 9",
             "output u 0 .. 9", f"terms a, b, c, u: triangles {terms}"]  # fmt: skip
    lines += [
        f"rule if a is T{i} and b is T{j} and c is T{k} then u is T{(i + j + k) // 3}"
        for i in range(size) for j in range(size) for k in range(size)
    ]  # fmt: skip
    return "\n".join([*lines, ""])


@pytest.mark.asyncio(loop_scope="module")
async def test_hasty_typing_in_a_large_file_ends_with_a_fresh_check(client: LanguageClient) -> None:
    text = _large(19)
    file = await File.open(client, text)
    assert file.found == []
    last = text.count("\n")
    for column, letter in enumerate("rule if a is "):
        where = partial((last, column), (last, column), letter)
        identifier = types.VersionedTextDocumentIdentifier(file.version + column, file.uri)
        client.text_document_did_change(types.DidChangeTextDocumentParams(identifier, [where]))
    answer = await asyncio.wait_for(file.ask("completion", last, len("rule if a is ")), 30)
    members = [i.label for i in answer.items if i.kind == types.CompletionItemKind.EnumMember]
    assert members == [f"T{i}" for i in range(19)]
    file.version += len("rule if a is ")
    found = await file.change(partial((last, 13), (last, 13), "T7 then u is T99"))
    expected = check_text(text + "rule if a is T7 then u is T99").diagnostics
    assert [d.code for d in found] == [d.name for d in expected] == ["unknown-term"]


def test_a_slow_session_completes_with_the_meaning_it_had_last() -> None:
    text = "rulebase s\ninput a 0 .. 1\noutput u 0 .. 1\nterms a, u: triangles N P\n"
    session = Session("s.frb", text)
    session.review()
    session.cost = 2 * SLOW
    session.replace(text + "rule if a is ")
    quick = session.quick_reading
    assert quick.model is session.quick_reading.model
    assert quick.tokens_of(5)[-1].text == "is"
    other = Session("s.frb", session.text)
    assert session.adopt(other)
    assert session.review() is other.review()
    assert not session.adopt(Session("s.frb", text))


def _slow_to_check(name: str) -> str:
    """Return a small file whose check takes seconds: its expectations are slow."""
    expectations = "".join(f"expect a = {i / 4000} -> u > 2\n" for i in range(4000))
    return (
        f"rulebase {name}\ninput a 0 .. 1\noutput u 0 .. 1\nterms a, u: triangles N P\n"
        "inference defuzzifier centroid(60000), implication hamacher, aggregation einstein\n"
        f"rules u\n  a N P\n  u N P\n{expectations}"
    )


@pytest.mark.asyncio(loop_scope="module")
async def test_questions_are_answered_beside_a_check_and_a_key_stroke_ends_it(
    client: LanguageClient,
) -> None:
    text, uri = _slow_to_check("slow"), "file:///rules/slow.frb"
    item = types.TextDocumentItem(uri, "fuzzyarm", 1, text)
    client.text_document_did_open(types.DidOpenTextDocumentParams(item))
    file = File(client, uri)
    await asyncio.sleep(0.5)  # the check has begun
    answer = await file.ask("hover", 1, 7)
    assert "input" in answer.contents.value
    assert uri not in client.diagnostics, "the check was over before the question"
    found = await file.change(types.TextDocumentContentChangeWholeDocument("rulebase quick\n"))
    assert {d.code for d in found} == {"no-inputs", "no-outputs", "no-rules"}
    again = await file.change(types.TextDocumentContentChangeWholeDocument("rulebase quick2\n"))
    assert {d.code for d in again} == {"no-inputs", "no-outputs", "no-rules"}


@pytest.mark.parametrize("text", [_slow_to_check("s"), _large(5)])
def test_a_check_ends_when_its_text_is_outdated(text: str) -> None:
    class OutdatedError(Exception):
        pass

    steps = 0

    def stop_at_the_third() -> None:
        nonlocal steps
        steps += 1
        if steps == 3:
            raise OutdatedError

    session = Session("s.frb", text)
    with pytest.raises(OutdatedError):
        session.review(stop_at_the_third)
    assert not session.reviewed
