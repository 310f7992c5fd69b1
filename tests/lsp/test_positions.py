"""Code units and characters, and the command's ways to start and to refuse."""

from __future__ import annotations

import asyncio
import socket
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lsprotocol import types
from pytest_lsp.client import make_test_lsp_client
from server_client import PATIENCE

from fuzzyarm.apps.lsp.session import characters, to_place, to_position, units
from fuzzyarm.base.errors import MissingExtraError, demand_extra
from fuzzyarm.base.extras import installing

CODECS = {"utf-8": ("utf-8", 1), "utf-16": ("utf-16-le", 2), "utf-32": ("utf-32-le", 4)}
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=12)


@given(TEXTS, st.sampled_from(sorted(CODECS)))
def test_units_are_those_of_the_codec(text: str, encoding: str) -> None:
    codec, size = CODECS[encoding]
    assert units(text, encoding) == len(text.encode(codec)) // size


@given(TEXTS, st.sampled_from(sorted(CODECS)), st.data())
def test_places_and_positions_are_inverse(text: str, encoding: str, data: st.DataObject) -> None:
    column = data.draw(st.integers(1, len(text) + 1))
    position = to_position([text], 1, column, encoding)
    assert to_place([text], *position, encoding) == (1, column)


@pytest.mark.parametrize(("count", "expected"), [(-1, 0), (1, 1), (2, 1), (3, 2), (99, 3)])
def test_a_count_inside_a_pair_or_beyond_the_end_is_brought_back(count: int, expected: int) -> None:
    assert characters("a𝜃b", count, "utf-16") == expected


def test_a_missing_extra_is_one_clear_sentence() -> None:
    with pytest.raises(MissingExtraError) as caught:
        demand_extra("no_such_library", "lsp", "the language server")
    assert str(caught.value) == f"the language server needs an extra: {installing('lsp')}"


@pytest.mark.parametrize(("command", "extra"), [("lsp", "lsp")])
def test_the_commands_say_which_extra_they_need(command: str, extra: str) -> None:
    hide = (
        "import sys, importlib.util as u; real = u.find_spec;"
        "u.find_spec = lambda n, *a: None if n in ('pygls', 'textual') else real(n, *a);"
        f"from fuzzyarm.apps.cli import main; sys.exit(main({command.split()!r}))"
    )
    done = subprocess.run([sys.executable, "-c", hide], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert f"needs an extra: {installing(extra)}\n" in done.stderr


@pytest.mark.parametrize("port", ["0", "x", "70000", "localhost:"])
def test_a_bad_port_is_a_usage_error(port: str) -> None:
    from fuzzyarm.apps.cli import main

    assert main(["lsp", "--tcp", port]) == 2


async def test_the_server_answers_over_tcp() -> None:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-m", "fuzzyarm", "lsp", "--tcp", str(port), stderr=asyncio.subprocess.PIPE
    )
    assert process.stderr is not None
    assert str(port).encode() in await asyncio.wait_for(process.stderr.readline(), PATIENCE)
    client = make_test_lsp_client()
    for _ in range(1000):
        try:
            await client.start_tcp("127.0.0.1", port)
            break
        except OSError:
            await asyncio.sleep(0.1)
    params = types.InitializeParams(capabilities=types.ClientCapabilities())
    greeting = await asyncio.wait_for(client.initialize_session(params), PATIENCE)
    assert greeting.server_info is not None
    assert greeting.server_info.name == "fuzzyarm"
    await asyncio.wait_for(client.shutdown_async(None), PATIENCE)
    client.exit(None)
    assert await asyncio.wait_for(process.wait(), PATIENCE) == 0
