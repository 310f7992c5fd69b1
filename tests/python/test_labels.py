"""What has an index, or dims and coordinates, comes back with them; text is not a number."""

import pickle
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

import fuzzyarm
from fuzzyarm.inference import InferenceError, MissingInputError, NotANumberError

ways = pytest.mark.parametrize("way", ["infer", "compiled", "called"])


@pytest.fixture(scope="module")
def evaluate(pd7):
    fast = fuzzyarm.compiled(pd7)
    return {"infer": lambda *a, **k: fuzzyarm.infer(pd7, *a, **k), "compiled": fast, "called": pd7}


@pytest.fixture(scope="module")
def pd7():
    return fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))


FRAME = pd.DataFrame(
    {"e": [1.3, 0.0, -1.3], "other": ["x", "y", "z"], "ce": [0.0, 1.0, 2.0]},
    index=pd.Index([7, 3, 5], name="sample"),
)


@ways
def test_a_frame_gives_its_columns_by_name(evaluate, way):
    found = evaluate[way](FRAME)
    plain = evaluate[way](e=FRAME["e"].to_numpy(), ce=FRAME["ce"].to_numpy())
    assert isinstance(found, pd.DataFrame)
    pd.testing.assert_frame_equal(found, pd.DataFrame(plain, index=FRAME.index))


@ways
def test_a_series_keeps_its_index(evaluate, way):
    found = evaluate[way](e=FRAME["e"], ce=0.5)["u"]
    plain = evaluate[way](e=FRAME["e"].to_numpy(), ce=0.5)["u"]
    pd.testing.assert_series_equal(found, pd.Series(plain, FRAME.index, name="u"))


def test_a_frame_as_one_input_keeps_both_axes(pd7):
    wide = pd.DataFrame([[0.0, 1.0], [2.0, 3.0]], index=["p", "q"], columns=["a", "b"])
    found = pd7(e=wide, ce=1.0)["u"]
    pd.testing.assert_frame_equal(
        found, pd.DataFrame(pd7(e=wide.to_numpy(), ce=1.0)["u"], ["p", "q"], ["a", "b"])
    )


def test_nullable_numbers_and_integers(pd7):
    series = pd.Series([1, 2], dtype="Int64")
    assert pd7(e=series, ce=0)["u"].tolist() == pd7(e=[1.0, 2.0], ce=0)["u"].tolist()
    with pytest.raises(NotANumberError, match="NaN"):
        pd7(e=pd.Series([1, None], dtype="Int64"), ce=0)


@given(st.permutations(["e", "ce"]), st.booleans())
def test_arrays_with_dims_broadcast_by_them(order, shared):
    pd7 = fuzzyarm.load(fuzzyarm.shipped("pd7.frb"))
    xs, ys = np.linspace(-6, 6, 3), np.linspace(-5, 5, 4)
    grid = xr.Dataset(coords={"e": xs, "ce": ys, "where": "lab"})
    given_ = {name: grid[name] for name in order}
    if shared:  # an input over both dims
        given_["ce"] = grid["ce"] + 0.0 * grid["e"]
    found = pd7(**given_)["u"]
    plain = pd7(e=xs[:, None], ce=ys)["u"]
    np.testing.assert_array_equal(found.transpose("e", "ce"), plain)
    assert set(found.coords) == {"e", "ce", "where"}


def test_a_dataset_gives_its_variables_by_name(pd7):
    data = xr.Dataset(
        {"e": ("time", [1.0, 2.0]), "ce": ("time", [0.0, 1.0])}, coords={"time": [5, 6]}
    )
    found = pd7(data)
    assert isinstance(found, xr.Dataset)
    assert found["u"].dims == ("time",)
    assert found["time"].to_numpy().tolist() == [5, 6]


@pytest.mark.parametrize(
    ("given_", "error", "words"),
    [
        ({"e": "2", "ce": 0}, NotANumberError, "'e' is not a number: '2'"),
        ({"e": b"2", "ce": 0}, NotANumberError, "is not a number"),
        ({"e": np.array("2"), "ce": 0}, NotANumberError, "is not a number"),
        ({"e": ["2", "3"], "ce": 0}, NotANumberError, "is not an array of numbers"),
        ({"e": np.array(["2"], object), "ce": 0}, NotANumberError, "is not an array of numbers"),
        ({"e": pd.Series(["1"]), "ce": 0}, NotANumberError, "is not an array of numbers"),
        ({"e": [1 + 2j], "ce": 0}, NotANumberError, "is not an array of numbers"),
        (
            {"e": FRAME["e"], "ce": FRAME["ce"].reset_index(drop=True)},
            InferenceError,
            "'e' and 'ce' have different indexes",
        ),
        ({"e": FRAME["e"], "ce": np.zeros((2, 3))}, InferenceError, "labels for the shape"),
        ({"e": FRAME["e"], "ce": xr.DataArray([1.0])}, InferenceError, "not by both"),
        ({"e": xr.DataArray([1.0], dims="t"), "ce": [1.0]}, InferenceError, "has no dims"),
        (
            {
                "e": xr.DataArray([1.0], dims="t", coords={"t": [1]}),
                "ce": xr.DataArray([1.0], dims="t", coords={"t": [2]}),
            },
            InferenceError,
            "coordinates of the inputs differ",
        ),
    ],
)
@ways
def test_what_is_refused(evaluate, way, given_, error, words):
    with pytest.raises(error, match=words):
        evaluate[way](**given_)


@ways
def test_inputs_that_are_not_by_name(evaluate, way):
    with pytest.raises(MissingInputError, match="ce"):
        evaluate[way](FRAME[["e"]])
    with pytest.raises(InferenceError, match="given twice"):
        evaluate[way](FRAME, e=3)


def test_a_table_keeps_labels_too(pd7):
    table = pd7.table(levels=5)
    found = table.lookup(FRAME["e"], 0.5, mode="linear")
    plain = table.lookup(FRAME["e"].to_numpy(), 0.5, mode="linear")
    pd.testing.assert_series_equal(found, pd.Series(plain, FRAME.index, name="u"))
    grid = xr.Dataset(coords={"e": [0.0, 1.0], "ce": [0.0, 2.0, 3.0]})
    assert table.lookup(ce=grid["ce"], e=grid["e"]).sizes == {"e": 2, "ce": 3}


def test_a_list_is_not_a_mapping(pd7):
    with pytest.raises(InferenceError, match="given by name"):
        fuzzyarm.infer(pd7, [1, 2])
    with pytest.raises(NotANumberError, match="is not a number: '1'"):
        fuzzyarm.compiled(pd7).at("1", 2)


def test_what_is_compiled_goes_to_another_process(pd7):
    fast = fuzzyarm.compiled(pd7)
    again = pickle.loads(pickle.dumps(fast))
    assert again.rulebase == pd7
    assert again(e=1.3, ce=-2.2) == fast(e=1.3, ce=-2.2)
    code = "import pickle, sys; print(pickle.load(sys.stdin.buffer)(e=1.3, ce=-2.2)['u'])"
    done = subprocess.run(
        [sys.executable, "-c", code], input=pickle.dumps(fast), capture_output=True, check=True
    )
    assert float(done.stdout) == fast(e=1.3, ce=-2.2)["u"]


def test_nobody_loads_pandas_who_has_none():
    code = (
        "import sys, fuzzyarm; pd7 = fuzzyarm.load(fuzzyarm.shipped('pd7.frb')); pd7(e=[1], ce=0);"
        "print([m for m in ('pandas', 'xarray') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
