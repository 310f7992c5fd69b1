"""Write what commands print into docs/comparison.md: `python docs/make_comparison.py`.

A table stands between a comment that is its command and `<!-- end -->`.
"""

from __future__ import annotations

import io
import re
import shlex
from contextlib import redirect_stdout
from pathlib import Path

from fuzzyarm.cli import main
from fuzzyarm.text.files import write_atomically

PAGE = Path(__file__).parent / "comparison.md"

TABLE = re.compile(r"(?ms)^<!-- (fuzzyarm [^\n]*?) -->\n(.*?)^<!-- end -->$")


def printed(command: str) -> str:
    """Return what a command prints."""
    with redirect_stdout(io.StringIO()) as out:
        if main(shlex.split(command)[1:]):
            raise SystemExit(f"{command} failed")
    return out.getvalue()


def page(text: str) -> str:
    """Return the page with the tables of today."""
    return TABLE.sub(lambda table: f"<!-- {table[1]} -->\n{printed(table[1])}<!-- end -->", text)


if __name__ == "__main__":
    write_atomically(PAGE, page(PAGE.read_text(encoding="utf-8")))
