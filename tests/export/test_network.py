"""A table as a network of rectifiers: its values, its error, and what cannot be one."""

from __future__ import annotations

import itertools
import shutil
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzyarm import shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.exchange.export import export_files, routines_of
from fuzzyarm.table import Axis, LookupTable, write_table

onnx = pytest.importorskip("onnx", reason="onnx is not installed")


@st.composite
def tables(draw: st.DrawFn) -> LookupTable:
    """Uneven grids over one to three inputs, one level among them."""
    axes = []
    for name in "abc"[: draw(st.integers(1, 3))]:
        steps = draw(st.lists(st.sampled_from([0.25, 0.5, 1.0, 2.0]), min_size=0, max_size=4))
        levels = (-1.5, *(-1.5 + sum(steps[: k + 1]) for k in range(len(steps))))
        axes.append(Axis(name, levels))
    shape = tuple(len(axis.levels) for axis in axes)
    values = draw(
        st.lists(st.integers(-8, 8), min_size=int(np.prod(shape)), max_size=int(np.prod(shape)))
    )
    return LookupTable(tuple(axes), "u", np.array(values, dtype=float).reshape(shape))


def kuhn(table: LookupTable, point: tuple[float, ...]) -> float:
    """Walk from the lower corner of the cell along its axes, the longest way first."""
    corner, shares = [], []
    for axis, coordinate in zip(table.axes, point, strict=True):
        levels = axis.levels
        x = min(max(coordinate, levels[0]), levels[-1])
        k = max(0, min(len(levels) - 2, int(np.searchsorted(levels, x, "right")) - 1))
        corner.append(k)
        shares.append((x - levels[k]) / (levels[k + 1] - levels[k]) if len(levels) > 1 else 0.0)
    value, at = float(table.values[tuple(corner)]), list(corner)
    for i in sorted(range(len(shares)), key=lambda i: -shares[i]):
        if len(table.axes[i].levels) < 2:
            continue
        before = float(table.values[tuple(at)])
        at[i] += 1
        value += shares[i] * (float(table.values[tuple(at)]) - before)
    return value


def network(table: LookupTable, path: Path, precision: str = "float64"):
    exported = export_files(routines_of(table, mode="linear", precision=precision), path)
    exported.write()
    return exported


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(tables(), st.lists(st.tuples(*[st.floats(-3, 8)] * 3), min_size=20, max_size=20))
def test_a_network_is_linear_in_every_simplex_of_a_cell(tmp_path_factory, table, drawn):
    path = tmp_path_factory.mktemp("n") / "t.onnx"
    (routine,) = network(table, path).routines
    count = len(table.axes)
    corners = itertools.product(*(axis.levels for axis in table.axes))
    points = [*corners, *(point[:count] for point in drawn)]
    runtime = pytest.importorskip("onnxruntime")
    session = runtime.InferenceSession(path.read_bytes())
    (found,) = session.run(None, {"inputs": np.array(points)})
    expected = [kuhn(table, point) for point in points]
    assert found.ravel() == pytest.approx(expected, abs=1e-12)
    assert routine.evaluate(*np.array(points).T) == pytest.approx(expected, abs=1e-12)
    # Interpolation within the cell is no farther away than stated.
    columns = np.array(points).T
    between = np.abs(table.lookup(*columns, mode="linear") - expected).max()
    assert between <= routine.core.apart() + 1e-12
    assert routine.accuracy.worst <= routine.core.apart() + 1e-12


def test_the_stated_difference_is_reached_by_two_inputs():
    twisted = LookupTable(
        (Axis("a", (0.0, 1.0)), Axis("b", (0.0, 2.0))), "u", np.array([[0.0, 0.0], [0.0, 1.0]])
    )
    (routine,) = export_files(routines_of(twisted, mode="linear"), "t.onnx").routines
    assert routine.core.apart() == 0.25  # of ab against min(a, b), in the middle
    assert routine.accuracy.worst == pytest.approx(0.25)


def test_a_table_over_one_input_is_exact(tmp_path, capsys):
    table = LookupTable((Axis("a", (-1.0, 0.0, 2.0)),), "u", np.array([3.0, -1.0, 5.0]))
    write_table(table, tmp_path / "t.lut")
    assert main(["compile", str(tmp_path / "t.lut"), "-o", str(tmp_path / "t.onnx")]) == 0
    said = capsys.readouterr().out
    assert "at most 4 rectifiers" in said  # two that clamp, two kinks
    (routine,) = network(table, tmp_path / "t.onnx").routines
    assert routine.accuracy.worst < 1e-15
    model = onnx.load(tmp_path / "t.onnx")
    onnx.checker.check_model(model, full_check=True)
    assert {node.op_type for node in model.graph.node} == {"Gemm", "Relu"}
    assert model.doc_string.startswith("made by fuzzyarm")


TWICE = """rulebase twice
input e -1 .. 1
output u -1 .. 1
output v -1 .. 1
terms e, u, v: triangles N P
rule if e is N then u is N, v is P
rule if e is P then u is P, v is N
"""


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["tipper.frb", "--direct"], "a network is made of a table in floating point"),
        (["tipper.frb", "--mode", "nearest"], "a network is continuous, and 'nearest' jumps"),
        (["tipper.frb", "--q", "15"], "a network is made of a table in floating point"),
        (["tipper.frb", "--levels", "60"], "at most 2,500"),
        (["twice.frb"], "a network has one output, not u, v"),
        (["servo.frb"], "a network has no memory"),
    ],
)
def test_what_is_no_network_is_refused(tmp_path, monkeypatch, capsys, words, told):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "twice.frb").write_text(TWICE)
    for name in ("tipper.frb", "servo.frb", "pd7.frb"):
        shutil.copy(shipped(name), tmp_path)
    assert main(["compile", *words, "-o", "n.onnx"]) in (1, 2)
    assert told in capsys.readouterr().err
    assert not (tmp_path / "n.onnx").exists()


def test_single_precision_is_measured_on_the_file(tmp_path):
    axes = (Axis("a", tuple(np.linspace(-6.0, 6.0, 13))), Axis("b", tuple(np.linspace(-1, 1, 9))))
    plane = LookupTable(axes, "u", np.add.outer(*(np.array(axis.levels) for axis in axes)))
    (routine,) = network(plane, tmp_path / "t.onnx", "float32").routines
    assert routine.core.apart() < 1e-15  # of a plane there is rounding alone
    assert 0.0 < routine.accuracy.worst < 1e-4


def test_without_the_package_one_sentence_says_what_to_install(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    table = LookupTable((Axis("a", (0.0, 1.0)),), "u", np.array([0.0, 1.0]))
    with pytest.raises(ImportError, match=r"a network \(.onnx\) needs an extra"):
        export_files(routines_of(table, mode="linear"), "t.onnx")
