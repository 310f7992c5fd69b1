"""Write what commands print into pages on errors: `python tools/make_comparison.py`.

A table stands between a comment that is its command and `<!-- end -->`.
"""

from __future__ import annotations

import io
import re
import shlex
from contextlib import redirect_stdout
from pathlib import Path

from fuzzyarm.apps.cli import main
from fuzzyarm.base.files import write_atomically

PAGES = [
    Path(__file__).parents[1] / "docs" / "explanation" / name
    for name in ("comparison.md", "reproduction.md")
]

TABLE = re.compile(r"(?ms)^<!-- (fuzzyarm [^\n]*?) -->\n(.*?)^<!-- end -->$")


def printed(command: str) -> str:
    """Return what a command prints."""
    with redirect_stdout(io.StringIO()) as out:
        if main(shlex.split(command)[1:]):
            raise SystemExit(f"{command} failed")
    return out.getvalue()


def page(text: str, of: str = "fuzzyarm") -> str:
    """Return the page with the tables of today of commands that begin so."""

    def today(table: re.Match[str]) -> str:
        shown = printed(table[1]) if table[1].startswith(of) else table[2]
        return f"<!-- {table[1]} -->\n{shown}<!-- end -->"

    return TABLE.sub(today, text)


if __name__ == "__main__":
    for path in PAGES:
        write_atomically(path, page(path.read_text(encoding="utf-8")))
