"""Names of a user's that generated code has for itself: in every role, in every language."""

from __future__ import annotations

from pathlib import Path

import pytest
from budget import part
from hostile_names import ALL, OF_RULES, of_axes, of_gains, of_ports, of_rules, of_signals
from module_programs import failing_in_javascript, failing_in_rust
from own_tests import failing_in_c, failing_in_python, failing_in_scl

from fuzzyarm import shipped
from fuzzyarm.cli import main

FILES = {
    "signals": of_signals(ALL),
    "gains": of_gains(ALL),
    "ports": of_ports(ALL[::4]),
    "axes": of_axes(part(ALL, 3)),
    **{f"rules_{k}": of_rules(names) for k, names in enumerate(OF_RULES)},
}


def exported(folder: Path, suffix: str) -> list[Path]:
    """Return the files, exported."""
    paths = []
    for name, text in FILES.items():
        source = folder / f"{name}.frb"
        source.write_text(text, "utf-8")
        paths.append(folder / f"{name}{suffix}")
        direct = ["--direct"] if name.startswith("rules") else []
        words = ["compile", str(source), "-o", str(paths[-1]), "--precision", "float64", *direct]
        assert main(words) == 0, name
    return paths


@pytest.mark.slow
def test_in_micropython(tmp_path):
    assert failing_in_python(exported(tmp_path, ".py")) == []


@pytest.mark.slow
def test_in_javascript(tmp_path):
    assert failing_in_javascript(exported(tmp_path, ".mjs"), tmp_path) == []


@pytest.mark.slow
def test_in_rust(tmp_path):
    assert failing_in_rust(exported(tmp_path, ".rs"), tmp_path) == []


@pytest.mark.slow
def test_in_c(tmp_path):
    assert failing_in_c(exported(tmp_path, ".h"), tmp_path) == []


@pytest.mark.slow(seconds=15)
def test_in_structured_text(tmp_path):
    assert failing_in_scl(exported(tmp_path, ".scl")) == []


BESIDE = ("F_next", "F_visits", "F_ring", "F_values", "first", "F_2", "next", "values")


@pytest.mark.slow
def test_signals_beside_a_table_that_learns(tmp_path):
    lines = "".join(f"  {name} = change of e\n" for name in BESIDE)
    text = shipped("soc-zero.frb").read_text("utf-8")
    text = text.replace('"performance-yamazaki.lut"', f'"{shipped("performance-yamazaki.lut")}"')
    text = text.replace("  count =", f"{lines}  count =").replace("axis joint1, joint2", "axis a")
    text = text.replace("supply / 255", f"supply / 255 + {' + '.join(BESIDE)}")
    source = tmp_path / "made.frb"
    source.write_text(text)
    for suffix in (".py", ".mjs", ".rs", ".h", ".scl"):
        words = ["compile", str(source), "-o", str(tmp_path / f"made{suffix}")]
        assert main([*words, "--precision", "float64"]) == 0
    assert failing_in_python([tmp_path / "made.py"]) == []
    assert failing_in_javascript([tmp_path / "made.mjs"], tmp_path) == []
    assert failing_in_rust([tmp_path / "made.rs"], tmp_path) == []
    assert failing_in_c([tmp_path / "made.h"], tmp_path) == []
    assert failing_in_scl([tmp_path / "made.scl"]) == []
