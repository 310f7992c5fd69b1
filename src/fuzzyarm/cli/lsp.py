"""The language server for editors: diagnostics, completion, hover, rename and more.

Editors start it themselves and talk to it over its standard input and output; with
`--tcp PORT` (or HOST:PORT) it waits for one connection instead. docs/authoring.md says how
to set up VS Code, Neovim and Helix. Needs: pip install "fuzzyarm[lsp]"
"""

from __future__ import annotations

import argparse
import os
import sys

from fuzzyarm.cli.main import demand_extra

_HOST = "127.0.0.1"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fuzzyarm lsp``."""
    parser.add_argument("--stdio", action="store_true", help="talk over stdin and stdout (usual)")
    parser.add_argument(
        "--tcp", metavar="[HOST:]PORT", type=_address, help="wait for a connection instead"
    )


def _address(text: str) -> tuple[str, int]:
    host, _, port = text.rpartition(":")
    if not port.isdigit() or not 0 < int(port) < 65536:
        raise argparse.ArgumentTypeError(f"'{text}' is no port, and no host with a port")
    return host.strip("[]") or _HOST, int(port)


def run(arguments: argparse.Namespace) -> int:
    """Serve until the editor says goodbye."""
    demand_extra("pygls", "lsp", "the language server")
    from fuzzyarm.lsp.features import make_server

    server = make_server()
    if arguments.tcp is None:
        # The server closes its output when it ends; ours stays open for the farewell.
        server.start_io(stdout=os.fdopen(os.dup(sys.stdout.fileno()), "wb"))
        return 0
    host, port = arguments.tcp
    print(f"fuzzyarm: waiting for an editor on {host}:{port}", file=sys.stderr, flush=True)
    server.start_tcp(host, port)
    return 0
