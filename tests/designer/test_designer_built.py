"""What is built is what its sources say: types of messages, the editor, the mailed page."""

import shutil
import subprocess
from pathlib import Path

import pytest

from tools.message_types import FILE, printed_types

TOOLS = Path(__file__).parents[2] / "editors/designer"


def test_the_types_of_messages_are_those_of_the_records(update_golden):
    if update_golden:
        FILE.write_text(printed_types(), encoding="utf-8")
    assert FILE.read_text(encoding="utf-8") == printed_types(), "make types"


@pytest.mark.skipif(
    shutil.which("node") is None or not (TOOLS / "node_modules/esbuild").exists(),
    reason="esbuild is not installed (make page-tools)",
)
def test_the_editor_and_the_mailed_page_are_what_their_sources_say():
    words = ["node", "build.js", "--check"]
    done = subprocess.run(words, cwd=TOOLS, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
