"""The server answers every request, outlives whatever is none, and forgets what has passed."""

from __future__ import annotations

import asyncio
import gc
import json
import logging
import subprocess
import sys
from typing import Any

import pytest
from lsprotocol import types

from fuzzyarm.apps.lsp.features import make_server
from fuzzyarm.apps.lsp.server import MessageStream

URI = "file:///rules/a.frb"
AT = {"textDocument": {"uri": URI}, "position": {"line": 1, "character": 7}}
TEXT = "rulebase a\ninput x 0 .. 1\n"


def message(body: Any, head: bytes | None = None) -> bytes:
    data = body if isinstance(body, bytes) else json.dumps(body).encode()
    return (head or b"Content-Length: %d\r\n\r\n" % len(data)) + data


def request(number: int, method: str, params: Any) -> bytes:
    return message({"jsonrpc": "2.0", "id": number, "method": method, "params": params})


def notification(method: str, params: Any) -> bytes:
    return message({"jsonrpc": "2.0", "method": method, "params": params})


OPEN = {"textDocument": {"uri": URI, "languageId": "fuzzyarm", "version": 1, "text": TEXT}}
HELLO = [
    request(0, "initialize", {"capabilities": {}}),
    notification("initialized", {}),
    notification("textDocument/didOpen", OPEN),
]
FAREWELL = [request(10_000, "shutdown", None), notification("exit", None)]


def answers_to(*messages: bytes) -> dict[int | None, dict[str, Any]]:
    """Return the answers of a server to some messages by their numbers."""
    done = subprocess.run(
        [sys.executable, "-m", "fuzzyarm", "lsp"],
        input=b"".join([*HELLO, *messages, *FAREWELL]),
        capture_output=True,
        timeout=300,
        check=False,
    )
    stream, found = done.stdout, {}
    while stream:
        head, _, rest = stream.partition(b"\r\n\r\n")
        length = int(head.split(b"\r\n")[0].split(b":")[1])
        answer = json.loads(rest[:length])
        stream = rest[length:]
        if "method" not in answer:
            found[answer.get("id")] = answer
    return found


POSITIONS: list[Any] = [
    {"line": -1, "character": 0},
    {"line": 0, "character": -1},
    {"line": 1.5, "character": 0},
    {"line": "1", "character": 0},
    {"line": True, "character": 0},
    {"line": None, "character": 0},
    {"line": 10**12, "character": 0},
    {"line": 1},
    {},
    [],
    None,
]
BROKEN = [
    *({"textDocument": {"uri": URI}, "position": position} for position in POSITIONS),
    {"textDocument": {"uri": 5}, "position": AT["position"]},
    {"textDocument": {"uri": "file:///none.frb"}, "position": AT["position"]},
    {"position": AT["position"]},
    {},
    [1],
    7,
    None,
]
METHODS = ["completion", "hover", "definition", "references", "documentHighlight",
           "prepareRename", "rename", "codeAction", "formatting"]  # fmt: skip


def test_every_request_with_broken_parameters_is_answered_with_an_error() -> None:
    asked = [(f"textDocument/{method}", params) for method in METHODS for params in BROKEN]
    asked = [(m, p) for m, p in asked if m != "textDocument/formatting" or p != BROKEN[0]]
    asked += [("textDocument/rename", {**AT, "newName": 5}), ("no/such", {})]
    found = answers_to(
        *(request(k, method, params) for k, (method, params) in enumerate(asked, start=1)),
        request(5_000, "textDocument/hover", AT),
    )
    silent = [asked[k - 1] for k in range(1, len(asked) + 1) if k not in found]
    assert not silent
    lenient = [asked[k - 1] for k in range(1, len(asked) + 1) if "error" not in found[k]]
    assert not [each for each in lenient if each[0] != "textDocument/formatting"]
    assert "error" not in found[5_000]


NONSENSE = [
    message({}, b"Content-Length: abc\r\n\r\n"),
    message({}, b"Content-Length: -1\r\n\r\n"),
    message({}, b"Content-Length: 99999999999999999999999\r\n\r\n"),
    message({}, b"Nonsense\r\n\r\n"),
    b"\r\n\r\n\x00\xff",
    message(b"not json"),
    message(b"\xff\xfe"),
    message([]),
    message(5),
    message({}),
    message({"jsonrpc": "2.0"}),
    message({"jsonrpc": "2.0", "method": 5}),
    message({"jsonrpc": "2.0", "id": 5_001, "result": None}),
    message(AT, b"content-length:%d\n\r\n" % len(json.dumps(AT))),
    notification("textDocument/didChange", {}),
    notification("textDocument/didOpen", None),
    notification("$/cancelRequest", {"id": 77}),
]


def test_the_server_outlives_what_is_not_a_message() -> None:
    # One server hears all of it, and answers a question behind each.
    questions = range(1, len(NONSENSE) + 1)
    found = answers_to(
        *(
            part
            for number, nonsense in zip(questions, NONSENSE, strict=True)
            for part in (nonsense, request(number, "textDocument/hover", AT))
        )
    )
    for number, nonsense in zip(questions, NONSENSE, strict=True):
        assert "input **x**" in str(found.get(number, {}).get("result")), nonsense


def test_a_head_behind_other_text_on_its_line_is_found() -> None:
    class Lines:
        read = None

        def __init__(self, *lines: bytes) -> None:
            self.lines = list(lines)

        def readline(self) -> bytes:
            return self.lines.pop(0)

    stream = MessageStream(Lines(b"{}Content-Length: 12\r\n", b"\r\n", b"Content-Length: x\r\n"))
    lines = [stream.readline() for _ in range(3)]
    assert lines == [b"Content-Length: 12\r\n", b"\r\n", b"-\r\n"]


async def _edits(count: int) -> int:
    """Return how many objects each edit of a file leaves behind."""
    server = make_server()
    server.protocol.writer = type("Nowhere", (), {"write": lambda *_: None})()
    structured = server.protocol.structure_message
    for each in HELLO:
        body = json.loads(each.partition(b"\r\n\r\n")[2], object_hook=structured)
        server.protocol.handle_message(body)
    await asyncio.sleep(0.1)
    start = 0
    for number in range(count):
        if number == count // 2:
            start = _objects()
        change = {
            "textDocument": {"uri": URI, "version": number + 2},
            "contentChanges": [{"text": TEXT + f"# {number % 2}\n"}],
        }
        data = json.dumps({"jsonrpc": "2.0", "method": types.TEXT_DOCUMENT_DID_CHANGE,
                           "params": change})  # fmt: skip
        server.protocol.handle_message(json.loads(data, object_hook=structured))
        await asyncio.sleep(0.001)
    for _ in range(600):  # what is under way ends
        await asyncio.sleep(0.1)
        left = (_objects() - start) // (count // 2)
        if left <= 0:
            break
    return left


def _objects() -> int:
    gc.collect()
    return len(gc.get_objects())


@pytest.mark.slow
def test_an_edit_leaves_nothing_behind() -> None:
    # pytest keeps each record of a log for its report: at the level INFO those would be counted.
    logging.disable()
    try:
        assert asyncio.run(_edits(400)) <= 0
    finally:
        logging.disable(logging.NOTSET)
