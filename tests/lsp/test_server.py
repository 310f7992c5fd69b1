"""Every feature against the real server process, over its standard input and output."""

from __future__ import annotations

from pathlib import Path

import pytest
import pytest_lsp
from lsprotocol import types
from pygls.exceptions import JsonRpcException
from pytest_lsp import LanguageClient
from server_client import CHANGE, CONFIG, File, partial, start

from fuzzyarm.exchange.files import check_text
from fuzzyarm.language import format_text

pytestmark = [
    pytest.mark.asyncio(loop_scope="module"),
    pytest.mark.slow,  # a process that is started for them
]
ROOT = Path(__file__).parents[2]
PD7 = (ROOT / "rulebases" / "pd7.frb").read_text(encoding="utf-8")
TABLE = (ROOT / "rulebases" / "performance-yamazaki.lut").read_text(encoding="utf-8")

WIDE = """\
rulebase wide "𝜃 and 𝜔 are two units each"
input  𝜃   -1 .. 1
input  𝜔   -2 .. 2
output größe  -1 .. 1  # allow short-reach
terms 𝜃, 𝜔, größe: triangles 𝐍 Z 𝐏
rules größe
  𝜃 \\ 𝜔  𝐍  Z  𝐏
  𝐍      𝐍  𝐍  Z
  Z      𝐍  Z  𝐏
  𝐏      Z  𝐏  𝐏
"""


@pytest_lsp.fixture(scope="module", loop_scope="module", config=CONFIG)
async def client(lsp_client: LanguageClient):
    await start(lsp_client)
    yield
    await lsp_client.shutdown_session()


def _names(found: list[types.Diagnostic]) -> list[object]:
    return [d.code for d in found]


async def test_a_sound_file_has_no_findings(client: LanguageClient) -> None:
    file = await File.open(client, PD7)
    assert file.found == []


async def test_findings_are_those_of_the_command_line(client: LanguageClient) -> None:
    text = PD7.replace("PB\n  NM", "PX\n  NM").replace('-6 .. 6  "vel', '6 .. -6  "vel')
    file = await File.open(client, text)
    expected = check_text(text).diagnostics
    assert expected
    assert [(d.code, d.message.partition("\nhint: ")[0]) for d in file.found] == [
        (d.name, d.message) for d in expected
    ]
    assert [d.message.partition("\nhint: ")[2] for d in file.found] == [d.hint for d in expected]
    assert [d.range.start for d in file.found] == [
        types.Position(d.line - 1, d.column - 1) for d in expected
    ]
    assert {d.source for d in file.found} == {"fuzzyarm"}


async def test_findings_follow_each_key_stroke(client: LanguageClient) -> None:
    file = await File.open(client, PD7)
    lines = PD7.splitlines()
    row = next(i for i, line in enumerate(lines) if line.startswith("  NB "))
    column = lines[row].rindex("ZE")
    found = await file.change(partial((row, column + 1), (row, column + 2), "X"))
    assert _names(found) == ["unknown-term"]
    assert await file.change(partial((row, column + 1), (row, column + 2), "E")) == []
    assert _names(await file.change(CHANGE(text=""))) == _names_of("")


def _names_of(text: str) -> list[str]:
    return [d.name for d in check_text(text).diagnostics]


async def test_duplicates_name_the_other_place(client: LanguageClient) -> None:
    rule = "rule if e is NB and ce is NB then u is NB\n"
    file = await File.open(client, PD7 + rule)
    (found,) = [d for d in file.found if d.code == "duplicate-rule"]
    assert found.related_information is not None
    other = found.related_information[0]
    assert other.location.uri == file.uri
    line = next(i for i, text in enumerate(PD7.splitlines()) if text.startswith("  NB "))
    assert other.location.range.start.line == line
    assert list(found.tags or ()) == [types.DiagnosticTag.Unnecessary]


async def test_a_certain_hint_is_a_quick_fix(client: LanguageClient) -> None:
    text = PD7.replace("PM  PB  PB  PB", "PM  PX  PB  PB")
    file = await File.open(client, text)
    (found,) = file.found
    params = types.CodeActionParams(
        file.identifier, found.range, types.CodeActionContext(diagnostics=[found])
    )
    actions = await client.text_document_code_action_async(params)
    assert actions
    action = actions[0]
    assert isinstance(action, types.CodeAction)
    assert action.title.startswith("change 'PX' to 'P")
    assert action.is_preferred
    assert action.edit is not None
    assert action.edit.changes is not None
    (edit,) = action.edit.changes[file.uri]
    assert edit.range == found.range


async def test_the_missing_cell_is_added(client: LanguageClient) -> None:
    file = await File.open(client, PD7.replace("PB  PB  PB", "PB  PB"))
    found = next(d for d in file.found if d.code == "wrong-cell-count")
    params = types.CodeActionParams(
        file.identifier, found.range, types.CodeActionContext(diagnostics=[found])
    )
    actions = await client.text_document_code_action_async(params)
    assert actions is not None
    assert [a.title for a in actions] == ["add the missing cell"]


async def test_completion_offers_exactly_the_terms(client: LanguageClient) -> None:
    file = await File.open(client, PD7 + "rule if ce is ")
    last = len(PD7.splitlines())
    answer = await file.ask("completion", last, len("rule if ce is "))
    members = [i.label for i in answer.items if i.kind == types.CompletionItemKind.EnumMember]
    assert members == ["NB", "NM", "NS", "ZE", "PS", "PM", "PB"]


async def test_shapes_are_snippets(client: LanguageClient) -> None:
    file = await File.open(client, PD7 + "term e X: tri")
    answer = await file.ask("completion", len(PD7.splitlines()), len("term e X: tri"))
    item = answer.items[0]
    assert item.label == "triangle"
    assert item.insert_text_format == types.InsertTextFormat.Snippet
    assert item.text_edit.new_text == "triangle ${1:left} ${2:peak} ${3:right}"
    assert item.text_edit.range.start.character == len("term e X: ")


async def test_hover_explains_terms_cells_and_variables(client: LanguageClient) -> None:
    file = await File.open(client, PD7)
    lines = PD7.splitlines()
    row = next(i for i, line in enumerate(lines) if line.startswith("  NS "))
    cell = await file.ask("hover", row, lines[row].index("NB"))
    assert "if e is NS and ce is NB then u is NB" in cell.contents.value
    declared = next(i for i, line in enumerate(lines) if line.startswith("terms"))
    term = await file.ask("hover", declared, lines[declared].index("ZE"))
    assert "triangle -2 0 2" in term.contents.value
    assert "█" in term.contents.value
    variable = await file.ask("hover", 3, lines[3].index("e "))
    assert "`-6 .. 6`" in variable.contents.value
    assert "every value is covered" in variable.contents.value
    assert await file.ask("hover", 2, 0) is None


async def test_definition_references_and_rename(client: LanguageClient) -> None:
    file = await File.open(client, PD7)
    lines = PD7.splitlines()
    row = next(i for i, line in enumerate(lines) if line.startswith("  NS "))
    declared = next(i for i, line in enumerate(lines) if line.startswith("terms"))
    home = await file.ask("definition", row, 2)
    assert [(place.range.start.line, place.range.start.character) for place in home] == [
        (declared, lines[declared].index("NS"))
    ]
    context = types.ReferenceContext(include_declaration=False)
    uses = await file.ask("references", row, 2, context=context)
    assert [place.range.start.line for place in uses] == [row]
    marked = await file.ask("document_highlight", row, 2)
    assert len(marked) == 2
    ready = await file.ask("prepare_rename", row, 2)
    assert ready.placeholder == "NS"
    edit = await file.ask("rename", row, 2, new_name="SLIGHTLY_BELOW")
    edits = edit.changes[file.uri]
    # The terms of e, ce and u are declared together: all of them change, in header and grid.
    named = [e for e in edits if e.new_text.strip()]
    assert len(named) == PD7.count("NS")
    assert {e.new_text for e in named} == {"SLIGHTLY_BELOW"}  # the others align the grid
    with pytest.raises(JsonRpcException, match="has a term 'PB' already"):
        await file.ask("rename", row, 2, new_name="PB")


async def test_outline_folding_and_formatting(client: LanguageClient) -> None:
    untidy = PD7.replace("  e \\ ce  NB  NM", "  e \\ ce NB NM")
    file = await File.open(client, untidy)
    params = types.DocumentSymbolParams(file.identifier)
    outline = await client.text_document_document_symbol_async(params)
    assert [s.name for s in outline][:5] == ["pd7", "e", "ce", "u", "rules u"]
    assert [c.name for c in outline[1].children][:2] == ["NB", "NM"]
    folds = await client.text_document_folding_range_async(
        types.FoldingRangeParams(file.identifier)
    )
    assert len(folds) == 2
    options = types.FormattingOptions(tab_size=2, insert_spaces=True)
    edits = await client.text_document_formatting_async(
        types.DocumentFormattingParams(file.identifier, options)
    )
    assert [e.new_text for e in edits] == [format_text(untidy)]
    await file.change(CHANGE(text=untidy + "rul"))
    edits = await client.text_document_formatting_async(
        types.DocumentFormattingParams(file.identifier, options)
    )
    assert edits is None


async def test_words_have_kinds(client: LanguageClient) -> None:
    file = await File.open(client, PD7)
    params = types.SemanticTokensParams(file.identifier)
    answer = await client.text_document_semantic_tokens_full_async(params)
    data = list(answer.data)
    assert len(data) % 5 == 0
    # The first line is one comment, from the start, of the kind `comment`.
    assert data[:5] == [0, 0, len(PD7.splitlines()[0]), 9, 0]


@pytest.mark.parametrize("encoding", ["utf-16", "utf-8", "utf-32"])
async def test_columns_count_the_units_that_were_agreed(encoding: str) -> None:
    client = await CONFIG.start()
    try:
        greeting = await start(client, None if encoding == "utf-16" else [encoding])
        assert greeting["capabilities"].position_encoding == encoding
        file = await File.open(client, WIDE)
        assert file.found == []

        def units(text: str) -> int:
            return len(text.encode(encoding + ("-le" if encoding != "utf-8" else ""))) // {
                "utf-8": 1, "utf-16": 2, "utf-32": 4,
            }[encoding]  # fmt: skip

        lines = WIDE.splitlines()
        column = units(lines[8][: lines[8].index("𝐏")])
        width = units("𝐏")
        cell = await file.ask("hover", 8, column)
        assert "if 𝜃 is Z and 𝜔 is 𝐏 then größe is 𝐏" in cell.contents.value
        assert cell.range.start.character == column
        assert cell.range.end.character == column + width
        found = await file.change(partial((8, column), (8, column + width), "𝐐"))
        assert [(d.code, d.range.start.character, d.range.end.character) for d in found] == [
            ("unknown-term", column, column + width)
        ]
        edit = await file.ask("rename", 6, 2, new_name="ϑ")
        assert len(edit.changes[file.uri]) == WIDE.count("𝜃") - 1
    finally:
        await client.shutdown_session()
        await client.stop()


async def test_line_ends_and_separators_are_those_of_the_protocol(client: LanguageClient) -> None:
    text = PD7.replace("\n", "\r\n").replace("49 rules", "49\u2028rules\x0c\x85")
    file = await File.open(client, text)
    assert _names(file.found) == _names_of(text)
    rows = text.split("\r\n")
    row = next(i for i, line in enumerate(rows) if line.startswith("  NB "))
    found = await file.change(partial((row, 2), (row, 4), "XX"))
    assert [(d.code, d.range.start.line) for d in found] == [("unknown-term", row)]


async def test_a_table_gets_the_same_help(client: LanguageClient) -> None:
    file = await File.open(client, TABLE, "table.lut")
    assert file.found == []
    lines = TABLE.splitlines()
    grid = next(i for i, line in enumerate(lines) if line.startswith("grid"))
    cells = lines[grid + 2].split()
    cell = await file.ask("hover", grid + 2, len(lines[grid + 2]) - 1)
    assert f"= {cells[-1]}**" in cell.contents.value
    outline = await client.text_document_document_symbol_async(
        types.DocumentSymbolParams(file.identifier)
    )
    assert outline[-1].name == "grid"
    name = outline[0].name
    line = next(i for i, text in enumerate(lines) if text.startswith("input"))
    uses = await file.ask(
        "references", line, lines[line].index(name, 6),
        context=types.ReferenceContext(include_declaration=True),
    )  # fmt: skip
    assert len(uses) >= 3
    edit = await file.ask("rename", line, lines[line].index(name, 6), new_name="error")
    assert len(edit.changes[file.uri]) == len(uses)
    damaged = TABLE.replace("index", "indx")
    found = await file.change(CHANGE(text=damaged))
    assert "unknown-keyword" in _names(found)
    offered = await file.ask("completion", 0, 0)
    assert "levels" in {item.label for item in offered.items}


@pytest.mark.parametrize("cut", [0.2, 0.5, 0.8, 0.97])
async def test_damage_leaves_help_for_the_rest(client: LanguageClient, cut: float) -> None:
    text = PD7[: int(len(PD7) * cut)] + '"\n\x00((\nrule if e is '
    file = await File.open(client, text)
    assert _names(file.found) == _names_of(text)
    await client.text_document_document_symbol_async(types.DocumentSymbolParams(file.identifier))
    await client.text_document_semantic_tokens_full_async(
        types.SemanticTokensParams(file.identifier)
    )
    last = text.count("\n")
    answer = await file.ask("completion", last, len("rule if e is "))
    members = [i.label for i in answer.items if i.kind == types.CompletionItemKind.EnumMember]
    assert members == (["NB", "NM", "NS", "ZE", "PS", "PM", "PB"] if cut > 0.4 else [])


async def test_a_closed_file_has_no_findings(client: LanguageClient) -> None:
    file = await File.open(client, "rulebase x")
    assert file.found
    client.text_document_did_close(types.DidCloseTextDocumentParams(file.identifier))
    with pytest.raises(JsonRpcException, match="is not open"):
        await file.ask("hover", 0, 0)
    assert file.found == []
