"""Terms and norms of a user's own are drawn like the built-in ones."""

import os
import subprocess
import sys

import pytest

KINDS = """
from fuzzyarm import kinds, op

kinds.tnorm("yager2", lambda a, b: 1 - op.minimum(1, op.sqrt((1 - a) ** 2 + (1 - b) ** 2)))
kinds.shape(
    "cosine-bell",
    ("centre", "width"),
    lambda x, centre, width: op.where(
        abs(x - centre) < width, 0.5 * (1 + op.cos(op.pi * (x - centre) / width)), 0
    ),
)
"""
TEXT = """rulebase own
input x -3 .. 3
output y 0 .. 1
term x A: cosine-bell -2 3
term x B: cosine-bell 2 3
terms y: triangles L H
inference and yager2
rule if x is A then y is L
rule if x is B then y is H
"""


@pytest.fixture
def run(tmp_path):
    """A function that runs commands in a process of its own, where the kinds are registered."""
    (tmp_path / "own.frb").write_text(TEXT)

    def call(*commands):
        code = KINDS + "from fuzzyarm.apps.cli import main\n"
        code += "".join(f"assert main({list(words)!r}) == 0\n" for words in commands)
        done = subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True,
            text=True,
            cwd=tmp_path,
            env={**os.environ, "COLUMNS": "80"},
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    return call


@pytest.mark.slow
def test_in_the_terminal(run):
    out = run(["show", "own.frb", "--at", "x=2"])
    assert "  A ▆▆▇▇▇█████████▇▇▇▇▆▆▅▅▅▄▄▃▃▂▂▂▁▁▁▁▁▁" in out
    assert "cosine-bell -2 3" in out
    assert "and yager2, or max, implication min" in out
    assert "  B  1.0000  ████████████████████" in out


@pytest.mark.slow
def test_while_the_file_is_written(run):
    views = ("surface", "rules", "terms", "firing")
    words = [word for view in views for word in ("--view", view)]
    out = run(["watch", "--once", "own.frb", "--at", "x=2", *words])
    assert " A ▆▆▇▇" in out
    assert "1.00  if x is B then y is H" in out
    assert "1 of 2 rules fire" in out


@pytest.mark.slow
def test_as_figures(run, tmp_path):
    parts = ("all", "terms", "surface")
    run(
        *(["plot", "own.frb", "-o", f"{part}.svg", "--what", part] for part in parts),
        ["eval", "own.frb", "x=1", "--plot", "inference.svg"],
    )
    for name in (*parts, "inference"):
        assert (tmp_path / f"{name}.svg").stat().st_size > 10_000
