"""The examples of docs/explanation/type2.md are run, and what they show compared."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from fuzzyarm.symbolic.kinds import DEFUZZIFIERS

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/explanation/type2.md").read_text(encoding="utf-8")


def test_python_gives_what_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    names: dict[str, object] = {}
    shown = 0
    for block in re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL):
        statements = re.sub(
            r"^(fuzzyarm\.infer|fast\.at|\[round).*\n", "", block, flags=re.MULTILINE
        )
        exec(statements, names)
        for code, value in re.findall(r"^(\S.*?) +# ([{(\[\d].*)$", block, flags=re.MULTILINE):
            assert _numbers(eval(code, names)) == pytest.approx(_numbers(eval(value)), abs=1e-12), (
                code
            )
            shown += 1
    assert shown == 8


def _numbers(value: object) -> list[float]:
    return [float(each) for each in re.findall(r"[-+\d.e]*\d", repr(value))]


def test_every_way_is_named() -> None:
    for name in (name for name, record in DEFUZZIFIERS.items() if record.type2):
        assert f"`{name}" in PAGE
