"""The pages for those who come from elsewhere: commands are run, numbers are the program's."""

from __future__ import annotations

import re
import shlex
import shutil
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import fuzzyarm
from fuzzyarm.apps.cli.main import main
from fuzzyarm.base.protected import MARK
from fuzzyarm.language import parse
from fuzzyarm.language.model.rulebase import Defuzzifier, RuleBase

ROOT = Path(__file__).parents[2]
PAGES = ("scikit-fuzzy", "simpful", "pyit2fls", "matlab", "fuzzylite")
TEXTS = {page: (ROOT / f"docs/howto/from-{page}.md").read_text(encoding="utf-8") for page in PAGES}


def blocks(page: str, kind: str) -> list[str]:
    return re.findall(rf"```{kind}\n(.*?)```", TEXTS[page], flags=re.DOTALL)


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES)
def test_commands_print_what_is_shown_and_write_what_is_shown(
    page: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    shutil.copytree(ROOT / "examples/elsewhere", tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    shown = blocks(page, "frb")
    consoles = blocks(page, "console")
    assert len(shown) == len(consoles) > 0
    for console, text in zip(consoles, shown, strict=True):
        for call in console.split("$ fuzzyarm ")[1:]:
            words, _, output = call.partition("\n")
            assert main(shlex.split(words)) == 0
            assert capsys.readouterr().out == output
        (written,) = re.findall(r"(\S+\.frb): written", console)
        mark, _, rest = Path(written).read_text(encoding="utf-8").partition("\n")
        assert MARK in mark
        assert rest == text  # the pages leave the mark out


def test_python_runs_as_it_stands() -> None:
    (code,) = blocks("scikit-fuzzy", "python")
    names: dict[str, object] = {}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        exec(code, names)
    (found,) = [w.message for w in caught if isinstance(w.message, fuzzyarm.FileWarning)]
    share = re.search(r"'valve' differs by up to (\S+) of its range", found.diagnostic.message)
    assert share is not None
    assert f"`valve` differs by up to {float(share[1]):.1e} of its range" in TEXTS["scikit-fuzzy"]
    kinds = [names[name].inputs[0].terms[0].shape.kind for name in ("short", "same")]  # type: ignore[attr-defined]
    assert kinds == ["gaussian", "points"]


def worst_share(rulebase: RuleBase, way: Defuzzifier) -> float:
    """Return the greatest difference of a way from the exact centroid, in parts of the range."""
    (output,) = rulebase.outputs
    axes = np.meshgrid(*(np.linspace(v.low, v.high, 41) for v in rulebase.inputs), indexing="ij")
    points = {v.name: axis for v, axis in zip(rulebase.inputs, axes, strict=True)}

    def values(defuzzifier: Defuzzifier):
        changed = replace(output, defuzzifier=defuzzifier)
        return fuzzyarm.infer(replace(rulebase, outputs=(changed,)), points)[output.name]

    return float(np.abs(values(way) - values(Defuzzifier())).max() / (output.high - output.low))


@pytest.mark.parametrize("page", ["scikit-fuzzy", "matlab", "fuzzylite"])
def test_the_sizes_of_the_differences(page: str) -> None:
    rulebase = parse(blocks(page, "frb")[0]).rulebase
    assert rulebase is not None
    rows = re.findall(r"`centroid\((\d+), (\w+)\)` \| (\d\.\de-\d+) \|", TEXTS[page])
    assert len(rows) > 2
    for count, sampling, size in rows:
        way = Defuzzifier("centroid", int(count), sampling)
        assert f"{worst_share(rulebase, way):.1e}" == size, way


def test_every_script_of_the_examples_is_on_a_page() -> None:
    files = {path.name for path in (ROOT / "examples/elsewhere").iterdir() if path.is_file()}
    text = "".join(TEXTS.values())
    assert {name for name in files if f"examples/elsewhere/{name}" not in text} == set()
