"""What is built is what its sources say: types of messages, the editor, the playground."""

import subprocess
from pathlib import Path

from needs import requires

from tools.message_types import FILE, printed_types

TOOLS = Path(__file__).parents[2] / "editors/designer"


def test_the_types_of_messages_are_those_of_the_records(update_golden):
    if update_golden:
        FILE.write_text(printed_types(), encoding="utf-8")
    assert FILE.read_text(encoding="utf-8") == printed_types(), "make types"


@requires("esbuild")
def test_the_editor_and_the_playground_are_what_their_sources_say():
    words = ["node", "build.js", "--check"]
    done = subprocess.run(words, cwd=TOOLS, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
