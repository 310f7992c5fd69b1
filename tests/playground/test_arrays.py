"""The arrays that stand in for NumPy in a page agree with NumPy, to the bit."""

import json
import math
import subprocess
import sys

import numpy as np
import pytest

from fuzzyarm.apps.playground.arrays.module import MissingNumPyError, install, stand_in

own, _ = stand_in()

A = [[1.5, -2.0, 0.1], [3.25, math.nan, 7.0]]
B = [0.3, -0.7, 2.5]
LONG = [math.sin(k) * 10.0 ** (k % 7 - 3) for k in range(1001)]

SAME = {
    "arithmetic": lambda x: (x.array(A) + B) * 2 - x.array(B) / [2.0, 0.0, -3.0],
    "powers": lambda x: x.array(B) ** 2 + x.sqrt(x.abs(x.array(B))),
    "powers without a value": lambda x: x.power(
        x.array([-8.0, 0.0, -0.0, -0.0, 4.0]), x.array([0.5, -1.0, -1.0, -2.0, 0.5])
    ),
    "whole numbers": lambda x: x.arange(12).reshape(3, 4).T[::2, 1:] // 2 % 3,
    "half a division": lambda x: x.array([1.0, -1.0, 0.0]) / 0.0,
    "promotion": lambda x: x.array(B, x.float32) + x.array([1, 2, 3], x.int16),
    "more promotion": lambda x: x.array(B, x.float32) + x.arange(3),
    "single precision": lambda x: (x.array(LONG, x.float32) * x.float32(0.1)).astype(float),
    "a number beside singles": lambda x: x.array(B, x.float32) * 0.1,
    "comparisons": lambda x: (x.array(A) > 0.0) & ~(x.array(A) >= 3.0) | x.isnan(x.array(A)),
    "where": lambda x: x.where(x.isnan(x.array(A)), -1.0, A),
    "where, a place": lambda x: x.where(x.array([0, 1, 1])),
    "sums": lambda x: [x.sum(x.array(LONG)), x.array(LONG).sum(), x.mean(x.array(LONG))],
    "sums of singles": lambda x: x.array(LONG, x.float32).reshape(7, 143).sum(axis=0),
    "sums along rows": lambda x: x.array(LONG).reshape(7, 143).sum(axis=1),
    "sums across rows": lambda x: x.array(LONG).reshape(7, 143).sum(axis=0),
    "running sums": lambda x: [x.cumsum(x.array(LONG)), x.add.accumulate(x.array(LONG))],
    "running sums of singles": lambda x: x.add.accumulate(
        x.array(LONG, x.float32).reshape(7, 143), axis=0, dtype=x.float32
    ),
    "extremes": lambda x: [x.array(A).max(axis=1), x.min(x.array(B)), x.array(A).argmax(axis=0)],
    "extremes of stretches": lambda x: x.maximum.reduceat(x.array(LONG), x.array([0, 10, 500])),
    "extremes with a start": lambda x: x.max(x.array([]), initial=0.0),
    "differences": lambda x: [x.diff(x.array(A), axis=0), x.diff(x.array(B))],
    "differences between others": lambda x: [
        x.diff(x.arange(24).reshape(2, 3, 4) ** 2, axis=axis) for axis in (0, 1, 2, -2)
    ],
    "turned": lambda x: [
        x.transpose(x.arange(24).reshape(2, 3, 4), *order) for order in ((), ((1, 2, 0),))
    ],
    "cut to whole numbers": lambda x: [
        x.array([1.9, -2.9, 3.0], x.int64), x.array([1, 2.5], x.int16), x.array([True, 2], float),
    ],
    "order": lambda x: [x.sort(x.array(LONG)), x.argsort(x.array(B)), x.unique([3, 1, 3])],
    "places": lambda x: [x.argwhere(x.array(A) > 1.0), x.flatnonzero(x.array([0, 2, 0, 1]))],
    "place in order": lambda x: x.unravel_index(7, (3, 4)),
    "search": lambda x: x.searchsorted(x.array([0.0, 1.0, 2.0]), [0.0, 0.5, 2.0, 9.0], "right"),
    "interpolation": lambda x: x.interp(x.array([-1.0, 0.25, 9.0]), [0.0, 1.0, 2.0], B),
    "lines": lambda x: [x.linspace(-6.0, 6.0, 61), x.linspace(0.1, 0.7, 7), x.linspace(1, 1, 3)],
    "grids": lambda x: x.broadcast_to(x.ix_(B, [1.0, 2.0])[0] * x.ix_(B, [1.0, 2.0])[1], (3, 2)),
    "meshes": lambda x: x.meshgrid(B, [1.0, 2.0]),
    "indices": lambda x: x.array(A)[[0, 1], [2, 0]],
    "indices beside stretches": lambda x: x.arange(24).reshape(2, 3, 4)[:, [0, 2], 1:],
    "new axes": lambda x: x.array(B)[:, None] * x.array(B)[None, :],
    "a mask": lambda x: x.array(A)[~x.isnan(x.array(A))],
    "next numbers": lambda x: x.nextafter(x.array(B), math.inf),
    "next singles": lambda x: x.nextafter(x.array(B, x.float32), x.float32(-math.inf)),
    "next of nothing": lambda x: x.nextafter(x.zeros(2, x.float32), x.float32(1.0)),
    "rounding": lambda x: [x.rint(x.array([0.5, 1.5, -0.4])), x.round(x.array(LONG), 3)],
    "clipping": lambda x: [x.clip(x.array(B), -0.5, 1.0), x.array(B).clip(0.0, 1.0)],
    "put together": lambda x: [
        x.concatenate([B, [1.0]]), x.stack([B, B], axis=1), x.column_stack([B, B]),
        x.vstack([B, B]), x.hstack([x.array(A), x.array(A)]), x.append(B, 1.0),
    ],
    "repeated": lambda x: [x.repeat(x.array(B), 2), x.repeat(x.array(A), [1, 2], axis=0)],
    "axes": lambda x: [x.moveaxis(x.arange(24).reshape(2, 3, 4), 2, 0), x.array(A).T],
    "taken": lambda x: [
        x.take(x.array(A), 1, axis=1),
        x.take_along_axis(x.array(A), x.array([[2, 0, 1], [0, 0, 0]]), 1),
    ],
    "a product of rows": lambda x: x.dot(x.array([[1.0, 2.0], [3.0, 4.0]]), x.array([0.5, 0.25])),
    "counts": lambda x: [
        x.bincount(x.array([0, 2, 2, 5])), x.bincount([1, 0, 1], [0.1, 0.2, 0.3], minlength=4),
    ],
    "running sums elsewhere": lambda x: [
        x.cumsum(x.array(B), out=there) for there in [x.zeros(3)]
    ] + [x.diff(x.array(A), axis=0, prepend=x.zeros((1, 3)))],
    "rows each once": lambda x: list(
        x.unique(x.array([[2.0, 1.0], [0.0, 3.0], [2.0, 1.0]]), axis=0, return_inverse=True)
    ),
    "numbers at random": lambda x: [
        x.random.default_rng(7).random(5), x.random.default_rng(1).uniform(-6.0, 6.0, 4),
        x.random.default_rng(0).integers(0, 49, 20), x.random.default_rng(3).choice(B, 9),
        x.random.default_rng(5).permutation(x.array(range(40))),
        x.random.default_rng(6).permutation(11),
    ],
    "division by nothing": lambda x: [
        x.array([3, -3, 0]) // 0, x.array([3, 0]) % x.array([0, 2]), x.array(B) // 0.0,
        x.array(B) % 0.0, x.array([0.0]) // 0.0,
    ],
    "powers beyond": lambda x: x.power(x.array([-4.0, -4.0, 4.0]), x.array([8656.3, 8657.0, 9e9])),
    "signs of zeros": lambda x: [
        rounded(x.array([-0.3, -0.0, 0.3])) for rounded in (x.floor, x.ceil, x.trunc, x.rint)
    ],
    "NaN among others": lambda x: [
        x.searchsorted(x.array([0.0, 1.0, math.nan]), x.array([0.5, 2.0, math.nan]), side=side)
        for side in ("left", "right")
    ],
    "a line at NaN": lambda x: x.interp(x.array([math.nan, 0.5]), [0.0, 1.0], [2.0, 3.0]),
    "near or not": lambda x: [
        x.allclose([math.inf, 1.0], [math.inf, 1.0 + 1e-9]), x.allclose([1.0], [math.inf]),
        x.allclose([math.nan], [math.nan]),
    ],
    "evenly spaced": lambda x: [
        x.arange(-3.8, -1.9, 0.7), x.arange(0.0, 1.0, 0.1), x.arange(1.5, 0), x.arange(3.0),
    ],
    "axes that are kept": lambda x: [
        kept(x.array(A), axis=axis, keepdims=True)
        for kept in (x.sum, x.prod, x.max, x.any, x.all) for axis in (0, 1, None)
    ],
    "each once": lambda x: list(
        x.unique(x.array([[2.0, 1.0], [math.nan, 1.0]]), return_inverse=True)
    ),
    "attributes of a single number": lambda x: [
        [each.ndim, each.size, bool(each.any()), each.sum(), each.reshape(-1)]
        for each in (x.isnan(x.array(1.0)), x.sqrt(x.array(4.0)), x.sum(x.array([1, 2])))
    ],
    "a decorator": lambda x: x.errstate(divide="ignore")(lambda: x.array(B) / 0.0)(),
    "a large seed": lambda x: x.random.default_rng(2**200 + 17).random(3),
}  # fmt: skip


def plain(value):
    """Return what can be compared: kinds and bits."""
    if isinstance(value, list | tuple):
        return [plain(each) for each in value]
    if getattr(value, "shape", ()):
        return [str(value.dtype), list(value.shape), repr(value.tolist())]
    return repr(float(value))


@pytest.mark.parametrize("what", SAME)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_a_function_gives_the_bits_of_numpy(what):
    with np.errstate(all="ignore"):
        assert plain(SAME[what](own)) == plain(SAME[what](np))


@pytest.mark.parametrize(
    "name",
    ["bool_", "uint8", "int8", "int16", "int32", "uint32", "int64", "intp", "uintp", "float32"],
)
def test_a_kind_is_that_of_numpy(name):
    found, expected = (x.zeros(1, getattr(x, name)).dtype for x in (own, np))
    assert (found.name, found.itemsize) == (expected.name, expected.itemsize)


def test_a_view_shares_its_memory():
    array = own.zeros((3, 4))
    array[1:, ::2] = 7.0
    array.view(own.int64)[0, 0] = 1
    assert array.tolist() == [[5e-324, 0, 0, 0], [7, 0, 7, 0], [7, 0, 7, 0]]
    other = own.asanyarray(memoryview(bytearray(16)).cast("d"))
    other[1] = 2.0
    assert other.data.tolist() == [0.0, 2.0]


def test_a_mask_that_is_nowhere_true_writes_nothing():
    array = own.array(B)
    array[array > 9.0] = 7.0
    assert array.tolist() == B


@pytest.mark.parametrize(
    "choose",
    [
        lambda x, a: a[0, :, x.array([1, 2, 3])],
        lambda x, a: a[:, 1, x.array([1, 2, 3])],
        lambda x, a: a[x.array([0, 1]), 1:, x.array([1, 2])],
        lambda x, a: a[:, x.array([True, False, True]), -1],
        lambda x, a: a[:, :, 4:],
        lambda x, a: a[:, :0, 0],
    ],
)
def test_numbers_beside_arrays_of_indices_choose_what_numpy_does(choose):
    found, expected = (choose(x, x.arange(24).reshape(2, 3, 4)) for x in (own, np))
    assert (tuple(found.shape), found.tolist()) == (expected.shape, expected.tolist())


@pytest.mark.parametrize("value", [0.1, 1e-5, 3.0, 1.17e38, -2.5e-7, 16777216.0, math.inf])
def test_a_single_is_written_as_numpy_writes_it(value):
    assert str(own.float32(value)) == str(np.float32(value))


def test_what_is_not_there_is_missed_by_name():
    with pytest.raises(MissingNumPyError, match=r"numpy\.linalg is needed here, and this page has"):
        own.linalg  # noqa: B018
    with pytest.raises(NotImplementedError, match="noise is drawn by NumPy"):
        own.random.default_rng(1).standard_normal(3)


def test_where_there_is_numpy_it_stays():
    assert install() is False
    assert sys.modules["numpy"] is np


WITHOUT_NUMPY = """
import importlib.util, json, sys
if sys.argv[1] == "without":
    find = importlib.util.find_spec
    importlib.util.find_spec = lambda name, *more: None if name == "numpy" else find(name, *more)
    from fuzzyarm.apps.playground.arrays.module import install
    assert install()
"""

EXPORT = (
    WITHOUT_NUMPY
    + """
from fuzzyarm.apps.designer.exports import files_of
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.exchange.export import controllers, export_files, routines_of, rulebase
from fuzzyarm.language import load_rulebase
from fuzzyarm.base.shipped_files import shipped
controllers.PERIODS, rulebase._DENSE_POINTS = 20, 4_000
rules = load_rulebase(shipped("tipper.frb"))
files = [*export_files(routines_of(rules), "tipper.c").files]
path = shipped("servo.frb")
session = Session(str(path), path.read_text(encoding="utf-8"))
for suffix in (".py", ".st"):
    files += [(each.name, each.content.decode())
              for each in files_of(session, suffix, {}, lambda word: None)[0]]
print(json.dumps([text for _, text in files]))
"""
)


INFER = (
    WITHOUT_NUMPY
    + """
import numpy as np
from fuzzyarm.inference import infer
from fuzzyarm.language import parse
found = {}
for method in ("centroid", "bisector", "mean-of-maximum", "smallest-of-maximum",
               "nearest-of-maximum(12)", "farthest-of-maximum(12)", "centroid(11)"):
    rules = parse(
        "input e -1 .. 1\\ninput d -1 .. 1\\noutput u -2 .. 2\\nterms e, u: triangles N Z P\\n"
        f"terms d: gaussians N Z P\\ninference u: defuzzifier {method}\\n"
        "rule if e is N and d is N then u is N\\nrule if e is Z or d is P then u is Z\\n"
        "rule if e is P and d is not N then u is P\\n"
    ).rulebase
    ends = np.linspace(-1.0, 1.0, 5)
    values = infer(rules, e=ends[:, None], d=ends[None, :])["u"]
    found[method] = [round(value, 9) + 0.0 for row in values.tolist() for value in row]
print(json.dumps(found))
"""
)


# What a page asks of its Python where it has not the time to compute a surface as finely.
SURFACE = (
    WITHOUT_NUMPY
    + """
from fuzzyarm.apps.designer.requests import SurfaceWork
from fuzzyarm.apps.designer.surfaces import surface
from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.base.shipped_files import shipped
class Job:
    def __init__(self): self.news = []
    def tell(self, news): self.news.append(news)
    def check(self): pass
found = {}
for name in ("tipper.frb", "pd7.frb", "thermostat.frb"):
    session = Session(name, shipped(name).read_text(encoding="utf-8"))
    inputs = session.reading.parsed.rulebase.inputs
    ends = [(each.low, each.high) for each in inputs]
    point = tuple(0.25 * low + 0.75 * high for low, high in ends)
    job = Job()
    surface(session, SurfaceWork(point, 0, 1, tuple(ends[:2]), 0, 3, fired=True), job)
    values = [*job.news[0]["strengths"], *job.news[0]["outputs"], *job.news[1]["z"]]
    found[name] = [None if value is None else round(value, 9) + 0.0 for value in values]
print(json.dumps(found))
"""
)


REFERENCES = (
    WITHOUT_NUMPY
    + """
import numpy as np
from fuzzyarm.control.loop.reference import read_signal
times = np.array([0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.8, 1.0, 2.0])
signals = ("step:1,0.1", "ramp:0.5,0.1,0.2", "sine:1,0.5,0.1", "quintic:1,0.5,0.2,0.4,0.3")
print(json.dumps([[list(map(float, x)) for x in read_signal(s).at(times)] for s in signals]))
"""
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("script", "varied"),
    [
        (REFERENCES, lambda found: [len(set(values[0])) > 1 for values in found] == [True] * 4),
        (SURFACE, lambda found: [len(each) > 12 for each in found.values()] == [True] * 3),
        (EXPORT, lambda found: [len(text) > 1000 for text in found] == [True] * 4),
        (INFER, lambda found: [len(set(each)) > 3 for each in found.values()] == [True] * 7),
    ],
    ids=["references", "surface of a busy page", "code", "rules over arrays"],
)
def test_what_a_script_finds_is_the_same_without_numpy(script, varied):
    with_numpy, without = with_and_without(script)
    assert with_numpy == without
    assert varied(with_numpy)


def with_and_without(script):
    """Return what a script prints, with NumPy and without."""
    return [
        json.loads(
            subprocess.run(
                [sys.executable, "-W", "ignore", "-c", script, word],
                capture_output=True, text=True, check=True, env={"FUZZYARM_NATIVE": "0"},
            ).stdout
        )
        for word in ("with", "without")
    ]  # fmt: skip
