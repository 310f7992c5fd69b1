"""The examples of docs/explanation/proofs.md are run, and what they show compared."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from fuzzyarm.apps.cli.main import main
from fuzzyarm.language import parse

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/explanation/proofs.md").read_text(encoding="utf-8")


def test_the_statements_are_read() -> None:
    lines = re.search(r"```\n(prove .*?)```", PAGE, flags=re.DOTALL)
    assert lines is not None
    text = (ROOT / "rulebases/pd7.frb").read_text(encoding="utf-8")
    parsed = parse(text + lines[1])
    assert parsed.diagnostics == ()
    assert parsed.rulebase is not None
    assert len(parsed.rulebase.properties) == 7


def test_python_gives_what_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    from fractions import Fraction

    monkeypatch.chdir(ROOT)
    names: dict[str, object] = {"Fraction": Fraction}
    shown = 0
    for block in re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL):
        for line in block.splitlines():
            code, _, value = line.partition("  # ")
            if not value:
                exec(code, names)
                continue
            shown += 1
            assert eval(code, names) == eval(value, names), line
    assert shown == 17


def test_commands_print_what_is_shown(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    for block in re.findall(r"```console\n(.*?)```", PAGE, flags=re.DOTALL):
        for call in block.split("$ fuzzyarm ")[1:]:
            words, _, output = call.partition("\n")
            assert main(shlex.split(words)) == 0
            assert capsys.readouterr().out == output
