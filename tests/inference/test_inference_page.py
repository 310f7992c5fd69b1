"""The examples of docs/explanation/inference.md are run, and its numbers compared."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/explanation/inference.md").read_text(encoding="utf-8")


def test_the_examples_run_as_they_stand(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    code, rounding = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    names: dict[str, object] = {}
    exec(code, names)
    shown = re.search(r"ce=-2\.2\) +# (\{.*\})", code)
    assert shown is not None
    assert eval(shown[1]) == eval("infer(rulebase, e=1.3, ce=-2.2)", names)
    exec(rounding, names)
    assert eval("many.tolist() == one == fast", names) is True


def test_every_norm_and_defuzzifier_is_named() -> None:
    from fuzzyarm.language.model.rulebase import SAMPLINGS
    from fuzzyarm.symbolic.kinds import DEFUZZIFIERS
    from tests.strategies import CONJUNCTIONS, DISJUNCTIONS

    shipped = [name for name in DEFUZZIFIERS if not DEFUZZIFIERS[name].own]
    for name in (*CONJUNCTIONS, *DISJUNCTIONS, *shipped, *SAMPLINGS):
        assert f"`{name}" in PAGE, name
