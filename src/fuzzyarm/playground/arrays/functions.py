"""What is done with arrays: arithmetic, comparisons, sums, places, and how they are put together.

Names, arguments and results are NumPy's, and so are the bits of sums: they are taken pairwise, in
the order of its loops.
"""

from __future__ import annotations

import builtins
import math
import operator
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import reduce
from itertools import accumulate, product
from typing import Any

from fuzzyarm.playground.arrays.array import (
    BOOL,
    FLOAT,
    WHOLE,
    array_of,
    broadcast_shapes,
    broadcast_to,
    elements,
    kind_of,
    made,
    ndarray,
    one,
    operate,
)
from fuzzyarm.playground.arrays.kinds import DType, dtype, float32, promoted

inf, nan, pi, e = math.inf, math.nan, math.pi, math.e
newaxis = None

METHODS = frozenset(
    [
        "sum",
        "prod",
        "mean",
        "std",
        "max",
        "min",
        "any",
        "all",
        "argmax",
        "argmin",
        "cumsum",
        "round",
        "clip",
        "nonzero",
        "searchsorted",
        "take",
        "argsort",
        "swapaxes",
        "dot",
        "repeat",
    ]
)
"""Functions that are methods of arrays as well."""


# --- Making arrays ---


def asarray(value: Any, dtype: Any = None, **_order: Any) -> ndarray:
    """Return an array; the same one where it is one."""
    return array_of(value, dtype)


asanyarray = asarray


def array(value: Any, dtype: Any = None, **_order: Any) -> ndarray:
    """Return a new array."""
    return array_of(value, dtype).copy()


def ascontiguousarray(value: Any, dtype: Any = None) -> ndarray:
    """Return an array whose elements are contiguous."""
    source = array_of(value, dtype)
    return source if source.flags.c_contiguous else source.copy()


def _shape(shape: Any) -> tuple[int, ...]:
    return tuple(map(int, shape)) if isinstance(shape, Iterable) else (int(shape),)


def full(shape: Any, value: Any, dtype: Any = None) -> ndarray:
    """Return an array of one value."""
    of = _shape(shape)
    result = made([0] * math.prod(of), array_of(value, dtype).dtype, of)
    result[...] = value
    return result


def zeros(shape: Any, dtype: Any = float) -> ndarray:
    """Return an array of zeros."""
    of = _shape(shape)
    kind = _dtype(dtype)
    if kind.kind == "O":
        return made([0] * math.prod(of), kind, of)
    memory = memoryview(bytearray(builtins.max(math.prod(of), 1) * kind.itemsize)).cast(kind.code)  # type: ignore[call-overload]
    return ndarray(memory, kind, of)


empty = zeros
_dtype = dtype


def ones(shape: Any, dtype: Any = float) -> ndarray:
    """Return an array of ones."""
    return full(shape, 1, dtype)


def zeros_like(like: Any, dtype: Any = None) -> ndarray:
    """Return zeros in the shape of an array."""
    source = array_of(like)
    return zeros(source.shape, dtype or source.dtype)


empty_like = zeros_like


def ones_like(like: Any, dtype: Any = None) -> ndarray:
    """Return ones in the shape of an array."""
    source = array_of(like)
    return full(source.shape, 1, dtype or source.dtype)


def full_like(like: Any, value: Any, dtype: Any = None) -> ndarray:
    """Return one value in the shape of an array."""
    source = array_of(like)
    return full(source.shape, value, dtype or source.dtype)


def arange(*ends: Any, dtype: Any = None) -> ndarray:
    """Return evenly spaced numbers, without the end."""
    start, stop, step = (0, *ends, 1) if len(ends) == 1 else (*ends, 1)[:3]
    if builtins.all(isinstance(number, int) for number in (start, stop, step)):
        values: list[Any] = list(range(start, stop, step))
    else:
        values = [
            start + k * step for k in range(builtins.max(math.ceil((stop - start) / step), 0))
        ]
    return array_of(values, dtype or (WHOLE if not values else None))


def linspace(start: Any, stop: Any, num: int = 50, **_more: Any) -> ndarray:
    """Return evenly spaced numbers with both ends."""
    first, last, count = float(start), float(stop), int(num) - 1
    if count < 1:
        return made([first][: count + 1], FLOAT)
    step = (last - first) / count
    if step == 0.0:
        values = [k / count * (last - first) + first for k in range(count + 1)]
    else:
        values = [k * step + first for k in range(count + 1)]
    values[-1] = last
    return made(values, FLOAT)


def fromiter(values: Iterable[Any], dtype: Any, count: int = -1) -> ndarray:
    """Return an array of what an iterator gives."""
    listed = list(values)
    return array_of(listed if count < 0 else listed[:count], dtype)


def diag(values: Any) -> ndarray:
    """Return a matrix with these numbers on its diagonal."""
    source = array_of(values)
    result = zeros((source.size, source.size), source.dtype)
    for k, value in enumerate(elements(source)):
        result[k, k] = value
    return result


def meshgrid(*axes: Any, indexing: str = "xy") -> list[ndarray]:
    """Return the coordinates of a grid."""
    rows = [array_of(axis) for axis in axes]
    if indexing == "xy" and len(rows) > 1:
        a, b = meshgrid(rows[1], rows[0], indexing="ij")
        return [b, a]
    return [axis_array.copy() for axis_array in broadcast_arrays(*ix_(*rows))]


def ix_(*axes: Any) -> tuple[ndarray, ...]:
    """Return each axis in its own dimension."""
    rows = [array_of(axis) for axis in axes]
    return tuple(
        row.reshape((1,) * k + (row.size,) + (1,) * (len(rows) - k - 1))
        for k, row in enumerate(rows)
    )


# --- Functions of elements ---


def _divided(a: Any, b: Any) -> float:
    try:
        return float(a / b)
    except ZeroDivisionError:
        if a == 0 or a != a:
            return nan
        return math.copysign(inf, a) * math.copysign(1.0, b)


def _raised(a: Any, b: Any) -> Any:
    try:
        return a**b if not isinstance(a, float) or b != 2 else a * a
    except OverflowError:
        return inf if a > 0 or b % 2 == 0 else -inf
    except ZeroDivisionError:
        return inf


def _largest(a: Any, b: Any) -> Any:
    return a if a >= b or a != a else b


def _least(a: Any, b: Any) -> Any:
    return a if a <= b or a != a else b


def _quiet(act: Callable[[float], float], beyond: float) -> Callable[[float], float]:
    """Return a function of mathematics that is NaN where it has no value."""

    def quiet(x: float) -> float:
        try:
            return act(x)
        except ValueError:
            return nan
        except OverflowError:
            return beyond

    return quiet


class ufunc:
    """A function of elements, with what NumPy makes of it.

    Parameters
    ----------
    act : callable
        Of numbers.
    kind : DType, optional
        Of its results; else that of what it is given.
    floats : bool
        Whether whole numbers become floats.
    """

    def __init__(
        self, act: Callable[..., Any], kind: DType | None = None, *, floats: bool = False
    ) -> None:
        self._act, self._kind, self._floats = act, kind, floats

    def __call__(self, *given: Any, out: Any = None, where: Any = None, **named: Any) -> Any:
        """Apply it to all elements; with `where` only to those, in `out`."""
        kind = self._kind if named.get("dtype") is None else _dtype(named["dtype"])
        if kind is None and self._floats:
            kinds = [
                array_of(operand).dtype for operand in given if not isinstance(operand, int | float)
            ]
            together = reduce(promoted, kinds) if kinds else FLOAT
            kind = together if together.kind == "f" else FLOAT
        if where is not None and where is not True:
            mask = broadcast_to(where, out.shape)
            before = elements(out)
            results = operate(self._act, given, kind)
            results = elements(broadcast_to(results, out.shape))
            flags = elements(mask)
            out[...] = made(
                [new if yes else old for new, old, yes in zip(results, before, flags, strict=True)],
                out.dtype, out.shape,
            )  # fmt: skip
            return out
        return operate(self._act, given, kind, out)

    def accumulate(self, given: Any, axis: int = 0, dtype: Any = None) -> ndarray:
        """Return what it makes of the first elements along an axis, for each."""
        of = array_of(given, dtype)
        kind = of.dtype if of.dtype is not BOOL else WHOLE
        act = self._act
        if kind.name == "float32":
            act = lambda a, b: float32(float(a) + float(b)) if self is add else self._act(a, b)  # noqa: E731
        return _along(of, axis, lambda row: list(accumulate(row, act)), kind)

    def reduce(self, given: Any, axis: Any = 0, initial: Any = None, **_more: Any) -> Any:
        """Return what it makes of all elements along an axis."""
        return _reduced(given, axis, lambda row: reduce(self._act, row), initial=initial)

    def reduceat(self, given: Any, places: Any, axis: int = 0) -> ndarray:
        """Return what it makes of the stretches that begin at some places."""
        of = array_of(given)
        starts = elements(array_of(places))
        ends = [*starts[1:], of.shape[axis]]
        pairs = list(zip(starts, ends, strict=True))
        return _along(of, axis, lambda row: [reduce(self._act, row[a:b]) for a, b in pairs])

    def outer(self, a: Any, b: Any) -> Any:
        """Return it of each of one and each of the other."""
        first = array_of(a)
        return self(first.reshape((*first.shape, *(1,) * array_of(b).ndim)), b)


add, subtract, multiply = ufunc(operator.add), ufunc(operator.sub), ufunc(operator.mul)
divide = true_divide = ufunc(_divided, floats=True)
negative, absolute = ufunc(operator.neg), ufunc(builtins.abs)
square, power = ufunc(lambda x: x * x), ufunc(_raised)
maximum, minimum = ufunc(_largest), ufunc(_least)
mod = remainder = ufunc(lambda a, b: a % b if b else nan)
floor_divide = ufunc(lambda a, b: a // b if b else nan)
equal, not_equal = ufunc(operator.eq, BOOL), ufunc(operator.ne, BOOL)
less, less_equal = ufunc(operator.lt, BOOL), ufunc(operator.le, BOOL)
greater, greater_equal = ufunc(operator.gt, BOOL), ufunc(operator.ge, BOOL)
logical_and = ufunc(lambda a, b: bool(a) and bool(b), BOOL)
logical_or = ufunc(lambda a, b: bool(a) or bool(b), BOOL)
logical_not = ufunc(operator.not_, BOOL)
isnan, isinf, isfinite = (
    ufunc(math.isnan, BOOL),
    ufunc(math.isinf, BOOL),
    ufunc(math.isfinite, BOOL),
)
sqrt = ufunc(_quiet(math.sqrt, inf), floats=True)
sin, cos = ufunc(_quiet(math.sin, nan), floats=True), ufunc(_quiet(math.cos, nan), floats=True)
tan, arctan = ufunc(_quiet(math.tan, nan), floats=True), ufunc(math.atan, floats=True)
tanh, arctan2 = ufunc(math.tanh, floats=True), ufunc(math.atan2, floats=True)
exp = ufunc(_quiet(math.exp, inf), floats=True)
log = ufunc(lambda x: math.log(x) if x > 0.0 else (nan if x else -inf), floats=True)
hypot = ufunc(math.hypot, floats=True)
floor = ufunc(lambda x: float(math.floor(x)) if math.isfinite(x) else x, floats=True)
ceil = ufunc(lambda x: float(math.ceil(x)) if math.isfinite(x) else x, floats=True)
trunc = ufunc(lambda x: float(math.trunc(x)) if math.isfinite(x) else x, floats=True)
rint = ufunc(lambda x: math.copysign(float(_nearest(x)), x) if math.isfinite(x) else x, floats=True)
sign = ufunc(lambda x: x if x != x else type(x)((x > 0) - (x < 0)))
copysign = ufunc(math.copysign, floats=True)


def _nearest(x: float) -> int:
    return builtins.round(x)


def nextafter(a: Any, b: Any) -> Any:
    """Return the next number from each towards another one."""
    single = array_of(a).dtype.name == "float32"
    if not single:
        return operate(math.nextafter, (a, b), FLOAT)
    return operate(_next_single, (a, b), dtype(float32))


def _next_single(a: float, b: float) -> float:
    import struct

    if a == b or a != a or b != b:
        return b if a == b else nan
    if a == 0.0:
        return math.copysign(2.0**-149, b)
    (bits,) = struct.unpack("i", struct.pack("f", a))
    away = (b > a) == (a > 0.0)
    return float(struct.unpack("f", struct.pack("i", bits + (1 if away else -1)))[0])


def where(condition: Any, *values: Any) -> Any:
    """Choose between two values element by element; of a condition alone, where it is true."""
    if not values:
        return nonzero(condition)
    kinds = [branch for branch in values if isinstance(branch, ndarray)]
    kind = reduce(promoted, (branch.dtype for branch in kinds)) if kinds else None
    if kind is None or (
        kind.kind != "f" and builtins.any(isinstance(branch, float) for branch in values)
    ):
        kind = reduce(promoted, map(kind_of, values)) if not kinds else FLOAT
    return operate(lambda yes, a, b: a if yes else b, (condition, *values), kind)


def clip(given: Any, low: Any = None, high: Any = None, **named: Any) -> Any:
    """Hold elements between two ends."""
    result = given if low is None else maximum(given, low)
    return result if high is None else minimum(result, high, out=named.get("out"))


def round(given: Any, decimals: int = 0) -> Any:
    """Round to a number of decimals, halves to even, as NumPy does: by a power of ten."""
    ten = 10.0 ** builtins.abs(decimals)
    if decimals >= 0:
        return divide(rint(multiply(given, ten)), ten) if decimals else rint(given)
    return multiply(rint(divide(given, ten)), ten)


around = round
abs = absolute


def interp(at: Any, x: Any, y: Any) -> Any:
    """Return a line through points, at some places."""
    xs, ys = elements(array_of(x)), elements(array_of(y))

    def height(place: float) -> float:
        if place >= xs[-1]:
            return float(ys[-1])
        if place <= xs[0]:
            return float(ys[0])
        k = bisect_right(xs, place) - 1
        slope = (ys[k + 1] - ys[k]) / (xs[k + 1] - xs[k])
        return float(slope * (place - xs[k]) + ys[k])

    return operate(height, (at,), FLOAT)


# --- Along axes ---


def _along(
    of: ndarray, axis: int, act: Callable[[list[Any]], list[Any]], kind: DType | None = None
) -> ndarray:
    """Replace each row along an axis by a row of results."""
    axis %= of.ndim
    last = moveaxis(of, axis, -1)
    size = last.shape[-1]
    flat = elements(last)
    rows = [act(flat[k : k + size]) for k in range(0, len(flat), size or 1)]
    length = len(rows[0]) if rows else 0
    values = [value for row in rows for value in row]
    result = made(values, kind or of.dtype, (*last.shape[:-1], length))
    return moveaxis(result, -1, axis)


def _reduced(
    given: Any, axis: Any, act: Callable[[list[Any]], Any], kind: DType | None = None,
    *, initial: Any = None, keepdims: bool = False,
) -> Any:  # fmt: skip
    """Replace each row along an axis, or all elements, by one result."""
    of = array_of(given)
    kind = kind or of.dtype
    begin = [] if initial is None else [initial]
    if axis is None:
        return one(act([*begin, *elements(of)]), kind)
    if isinstance(axis, tuple):
        result = of
        for axis_number in sorted((a % of.ndim for a in axis), reverse=True):
            result = _reduced(result, axis_number, act, kind, initial=initial)
        return result
    axis %= of.ndim
    last = moveaxis(of, axis, -1)
    size = last.shape[-1]
    flat = elements(last)
    count = math.prod(last.shape[:-1])
    values = [act([*begin, *flat[k * size : (k + 1) * size]]) for k in range(count)]
    shape = (
        tuple(1 if k == axis else n for k, n in enumerate(of.shape))
        if keepdims
        else last.shape[:-1]
    )
    result = made(values, kind, shape)
    return result if shape else result[()]


def _pairwise(row: list[Any], keep: Callable[[Any], Any]) -> Any:
    """Return a sum in the order of NumPy: eight sums side by side, halves above 128 numbers."""
    count = len(row)
    if count < 8:
        return _added(row, -0.0, keep) + 0.0 if row else 0.0
    if count <= 128:
        sums = row[:8]
        whole = count - count % 8
        for start in range(8, whole, 8):
            sums = [keep(a + b) for a, b in zip(sums, row[start : start + 8], strict=True)]
        a, b, c, d = (keep(sums[k] + sums[k + 1]) for k in range(0, 8, 2))
        return _added(row[whole:], keep(keep(a + b) + keep(c + d)), keep)
    half = count // 2
    half -= half % 8
    return keep(_pairwise(row[:half], keep) + _pairwise(row[half:], keep))


def _added(given: Any, start: Any, round_to: Callable[[Any], Any]) -> Any:
    """Return a sum, one after the other; of singles each is rounded."""
    return reduce(lambda a, b: round_to(a + b), given, start)


def sum(given: Any, axis: Any = None, **named: Any) -> Any:
    """Return the sum: pairwise along rows, one row after the other across them."""
    of = array_of(given)
    if of.dtype is BOOL or of.dtype.kind == "i":
        return _reduced(of, axis, lambda row: reduce(operator.add, row, 0), WHOLE)
    keep: Callable[[Any], Any] = float32 if of.dtype.name == "float32" else _same
    if axis is None or of.ndim == 1 or (axis % of.ndim) == of.ndim - 1:
        return _reduced(of, axis, lambda row: _pairwise(row, keep))
    return _reduced(of, axis, lambda row: _added(row, -0.0, keep) + 0.0)


def _same(value: Any) -> Any:
    return value


def prod(given: Any, axis: Any = None, **_named: Any) -> Any:
    """Return the product."""
    kind = array_of(given).dtype
    kind = WHOLE if kind.kind != "f" else kind
    return _reduced(given, axis, lambda row: reduce(operator.mul, row, 1), kind)


def mean(given: Any, axis: Any = None) -> Any:
    """Return the mean."""
    of = array_of(given)
    count = of.size if axis is None else of.shape[axis]
    return divide(sum(of.astype(float, copy=False), axis), count)


def std(given: Any, axis: Any = None) -> Any:
    """Return the standard deviation."""
    of = array_of(given)
    centre = mean(of, axis)
    if axis is not None:
        centre = expand_dims(centre, axis)
    return sqrt(mean(square(subtract(of, centre)), axis))


def _most(row: list[Any]) -> Any:
    return reduce(_largest, row)


def _fewest(row: list[Any]) -> Any:
    return reduce(_least, row)


def _demand_elements(of: ndarray, axis: Any, named: dict[str, Any], what: str) -> None:
    count = of.size if axis is None else math.prod(of.shape[k] for k in _shape(axis))
    if count == 0 and "initial" not in named:
        raise ValueError(f"zero-size array to reduction operation {what} which has no identity")


def max(given: Any, axis: Any = None, **named: Any) -> Any:
    """Return the largest element; NaN where there is one."""
    of = array_of(given)
    _demand_elements(of, axis, named, "maximum")
    return _reduced(of, axis, _most, **named)


def min(given: Any, axis: Any = None, **named: Any) -> Any:
    """Return the least element; NaN where there is one."""
    of = array_of(given)
    _demand_elements(of, axis, named, "minimum")
    return _reduced(of, axis, _fewest, **named)


amax, amin = max, min


def nanmax(given: Any, axis: Any = None, **named: Any) -> Any:
    """Return the largest element that is a number."""
    return _reduced(given, axis, lambda row: _most([x for x in row if x == x] or [nan]), **named)


def ptp(given: Any, axis: Any = None) -> Any:
    """Return the largest element less the least."""
    return subtract(max(given, axis), min(given, axis))


def any(given: Any, axis: Any = None, **_named: Any) -> Any:
    """Whether one is true."""
    return _reduced(given, axis, lambda row: True in map(bool, row), BOOL)


def all(given: Any, axis: Any = None, **_named: Any) -> Any:
    """Whether all are true."""
    return _reduced(given, axis, lambda row: False not in map(bool, row), BOOL)


def _first(row: list[Any], best: Callable[[list[Any]], Any]) -> int:
    for k, value in enumerate(row):
        if value != value:
            return k
    return row.index(best(row))


def argmax(given: Any, axis: Any = None, **_named: Any) -> Any:
    """Return the place of the largest element."""
    return _reduced(given, axis, lambda row: _first(row, _most), WHOLE)


def argmin(given: Any, axis: Any = None, **_named: Any) -> Any:
    """Return the place of the least element."""
    return _reduced(given, axis, lambda row: _first(row, _fewest), WHOLE)


def nanargmax(given: Any, axis: Any = None) -> Any:
    """Return the place of the largest element that is a number."""
    return argmax(where(isnan(given), -inf, given), axis)


def cumsum(given: Any, axis: Any = None, **_named: Any) -> ndarray:
    """Return the running sum."""
    of = array_of(given)
    return add.accumulate(of.ravel() if axis is None else of, 0 if axis is None else axis)


def diff(given: Any, axis: int = -1, **_named: Any) -> ndarray:
    """Return the differences of neighbours."""
    of = moveaxis(array_of(given), axis, -1)
    return moveaxis(subtract(of[..., 1:], of[..., :-1]), -1, axis)


def sort(given: Any, axis: int = -1) -> ndarray:
    """Return the elements in order along an axis."""
    return _along(array_of(given), axis, lambda row: sorted(row, key=_nan_last))


def _nan_last(value: Any) -> Any:
    return (value != value, value)


def argsort(given: Any, axis: int = -1, **_named: Any) -> ndarray:
    """Return the places of the elements in order."""

    def places(row: list[Any]) -> list[Any]:
        return sorted(range(len(row)), key=lambda k: _nan_last(row[k]))

    return _along(array_of(given), axis, places, WHOLE)


def lexsort(keys: Any) -> ndarray:
    """Return the places in the order of the last key, then of the one before."""
    rows = [elements(array_of(key)) for key in keys]
    count = len(rows[0]) if rows else 0
    order = sorted(range(count), key=lambda k: tuple(row[k] for row in reversed(rows)))
    return made(order, WHOLE)


def unique(given: Any, **named: Any) -> Any:
    """Return the elements in order, each once."""
    flat = elements(array_of(given))
    values = sorted(set(flat))
    result = made(values, array_of(given).dtype)
    if named.get("return_inverse"):
        return result, made([bisect_left(values, x) for x in flat], WHOLE)
    return result


def isin(given: Any, among: Any) -> ndarray:
    """Whether each element is one of others."""
    members = set(elements(array_of(among)))
    return array_of(operate(lambda x: x in members, (array_of(given),), BOOL))


def searchsorted(points: Any, values: Any, side: str = "left") -> Any:
    """Return where values would stand among points."""
    row = elements(array_of(points))
    find = bisect_left if side == "left" else bisect_right
    size = len(row)
    return operate(lambda x: size if x != x else find(row, x), (values,), WHOLE)


def bincount(given: Any, minlength: int = 0) -> ndarray:
    """Return how often each whole number is there."""
    values = elements(array_of(given))
    counts = [0] * builtins.max(minlength, builtins.max(values, default=-1) + 1)
    for value in values:
        counts[value] += 1
    return made(counts, WHOLE)


# --- Places ---


def nonzero(given: Any) -> tuple[ndarray, ...]:
    """Return the places of what is not zero, an array for each axis."""
    of = array_of(given)
    spots = argwhere(of)
    return tuple(spots[:, axis] for axis in range(of.ndim))


def argwhere(given: Any) -> ndarray:
    """Return the places of what is not zero, a row for each."""
    of = array_of(given)
    spots = [
        spot
        for spot, is_true in zip(product(*map(range, of.shape)), elements(of), strict=True)
        if is_true
    ]
    return made([index for spot in spots for index in spot], WHOLE, (len(spots), of.ndim))


def flatnonzero(given: Any) -> ndarray:
    """Return the places of what is not zero, of all elements in order."""
    return made([k for k, value in enumerate(elements(array_of(given))) if value], WHOLE)


def unravel_index(place: Any, shape: Sequence[int]) -> tuple[Any, ...]:
    """Return a place in order as indices."""
    indices: list[Any] = []
    rest: Any = place if isinstance(place, ndarray) else int(place)
    for size in reversed(shape):
        indices.append(rest % size)
        rest = rest // size
    return tuple(reversed(indices))


def ndindex(*shape: Any) -> Iterator[tuple[int, ...]]:
    """Go through all indices of a shape."""
    sizes = shape[0] if len(shape) == 1 and isinstance(shape[0], Sequence) else shape
    return product(*map(range, sizes))


def take(given: Any, indices: Any, axis: int | None = None) -> Any:
    """Return what stands at some places along an axis."""
    of = array_of(given)
    if axis is None:
        return of.ravel()[indices]
    return of[(slice(None),) * (axis % of.ndim) + (indices,)]


def take_along_axis(given: Any, indices: Any, axis: int) -> ndarray:
    """Return what stands at places that differ from row to row."""
    of, at = array_of(given), array_of(indices)
    axis %= of.ndim
    shape = list(broadcast_shapes(*(
        tuple(1 if k == axis else n for k, n in enumerate(operand.shape)) for operand in (of, at)
    )))  # fmt: skip
    shape[axis] = at.shape[axis]
    grid = [
        made(list(range(n)), WHOLE).reshape([-1 if j == k else 1 for j in range(len(shape))])
        for k, n in enumerate(shape)
    ]
    grid[axis] = broadcast_to(at, shape)
    return array_of(
        broadcast_to(of, [of.shape[axis] if k == axis else n for k, n in enumerate(shape)])[
            tuple(grid)
        ]
    )


# --- Shape ---


def shape(given: Any) -> tuple[int, ...]:
    """Return the shape."""
    return array_of(given).shape


def ndim(given: Any) -> int:
    """Return how many axes."""
    return array_of(given).ndim


def size(given: Any) -> int:
    """Return how many elements."""
    return array_of(given).size


def reshape(given: Any, shape: Any) -> ndarray:
    """Return the elements in another shape."""
    return array_of(given).reshape(shape)


def ravel(given: Any) -> ndarray:
    """Return all elements along one axis."""
    return array_of(given).ravel()


def transpose(given: Any, axes: Any = None) -> ndarray:
    """Return the axes in another order."""
    of = array_of(given)
    return of.transpose() if axes is None else of.transpose(tuple(axes))


def moveaxis(given: Any, source: int, destination: int) -> ndarray:
    """Put an axis at another place."""
    of = array_of(given)
    order = [axis for axis in range(of.ndim) if axis != source % of.ndim]
    order.insert(destination % of.ndim, source % of.ndim)
    return of.transpose(tuple(order))


def swapaxes(given: Any, one: int, other: int) -> ndarray:
    """Exchange two axes."""
    of = array_of(given)
    order = list(range(of.ndim))
    order[one], order[other] = order[other], order[one]
    return of.transpose(tuple(order))


def expand_dims(given: Any, axis: int) -> ndarray:
    """Put in an axis of one element."""
    of = array_of(given)
    at = axis % (of.ndim + 1)
    return of.reshape((*of.shape[:at], 1, *of.shape[at:]))


def squeeze(given: Any) -> ndarray:
    """Return it without axes of one element."""
    return array_of(given).squeeze()


def atleast_1d(given: Any) -> ndarray:
    """Return an array of one axis at least."""
    of = array_of(given)
    return of.reshape((1,)) if not of.shape else of


def atleast_2d(given: Any) -> ndarray:
    """Return an array of two axes at least."""
    of = atleast_1d(given)
    return of.reshape((1, -1)) if of.ndim == 1 else of


def broadcast_arrays(*given: Any) -> tuple[ndarray, ...]:
    """Return all in the shape that they make together."""
    arrays = [array_of(item) for item in given]
    common = broadcast_shapes(*(item.shape for item in arrays))
    return tuple(broadcast_to(item, common) for item in arrays)


def repeat(given: Any, times: Any, axis: int | None = None) -> ndarray:
    """Repeat each element along an axis."""
    of = array_of(given)
    if axis is None:
        of, axis = of.ravel(), 0
    counts = elements(broadcast_to(times, (of.shape[axis],)))
    return _along(
        of, axis, lambda row: [x for x, n in zip(row, counts, strict=True) for _ in range(n)]
    )


# --- Putting together ---


def concatenate(parts: Any, axis: int = 0, dtype: Any = None) -> ndarray:
    """Put arrays one after the other."""
    arrays = [array_of(part, dtype) for part in parts]
    kind = reduce(
        promoted,
        (piece.dtype for piece in arrays if piece.size or len(arrays) == 1),
        arrays[0].dtype,
    )
    axis %= arrays[0].ndim
    whole = list(arrays[0].shape)
    whole[axis] = 0
    for piece in arrays:
        whole[axis] += piece.shape[axis]
    if axis == 0:
        flat = [x for piece in arrays for x in elements(piece.astype(kind, copy=False))]
        return made(flat, kind, tuple(whole))
    turned = concatenate([moveaxis(piece, axis, 0) for piece in arrays])
    return ascontiguousarray(moveaxis(turned, 0, axis))


def stack(parts: Any, axis: int = 0) -> ndarray:
    """Put arrays beside each other along a new axis."""
    arrays = [array_of(part) for part in parts]
    at = axis % (arrays[0].ndim + 1)
    return concatenate([expand_dims(piece, at) for piece in arrays], at)


def vstack(parts: Any) -> ndarray:
    """Put rows below each other."""
    return concatenate([atleast_2d(part) for part in parts])


def hstack(parts: Any) -> ndarray:
    """Put arrays beside each other."""
    arrays = [atleast_1d(part) for part in parts]
    return concatenate(arrays, 0 if arrays[0].ndim == 1 else 1)


def column_stack(parts: Any) -> ndarray:
    """Put columns beside each other."""
    arrays = [array_of(part) for part in parts]
    return concatenate([a.reshape((-1, 1)) if a.ndim < 2 else a for a in arrays], 1)


def append(given: Any, more: Any) -> ndarray:
    """Put more elements after those that there are."""
    return concatenate([ravel(given), ravel(more)])


def copyto(to: ndarray, value: Any, where: Any = True) -> None:
    """Write values into an array, at the places that are chosen."""
    if where is True:
        to[...] = value
        return
    mask, values = (elements(broadcast_to(operand, to.shape)) for operand in (where, value))
    pairs = zip(mask, values, elements(to), strict=True)
    to[...] = made([new if yes else old for yes, new, old in pairs], to.dtype, to.shape)


def array_equal(a: Any, b: Any) -> bool:
    """Whether two arrays have one shape and the same elements."""
    one, other = array_of(a), array_of(b)
    return one.shape == other.shape and elements(one) == elements(other)


def allclose(a: Any, b: Any, rtol: float = 1e-5, atol: float = 1e-8) -> bool:
    """Whether two arrays are nearly the same."""
    return bool(all(less_equal(absolute(subtract(a, b)), add(atol, multiply(rtol, absolute(b))))))


def dot(a: Any, b: Any) -> Any:
    """Return the product of matrices, or of rows."""
    one_, other = array_of(a), array_of(b)
    if other.ndim == 1:
        return sum(multiply(one_, other), -1)
    if one_.ndim == 1:
        return sum(multiply(expand_dims(one_, -1), other), -2)
    return sum(multiply(expand_dims(one_, -1), expand_dims(other, -3)), -2)


class errstate:
    """Nothing is said of divisions by zero here."""

    def __init__(self, **_kinds: str) -> None:
        pass

    def __enter__(self) -> None:
        """Begin."""

    def __exit__(self, *_error: object) -> None:
        """End."""


class nditer:
    """All elements of some arrays in one piece, the last of them to be written.

    Parameters
    ----------
    arrays : sequence of ndarray
        Broadcast together.
    """

    def __init__(self, arrays: Sequence[ndarray], **_flags: Any) -> None:
        *inputs, self._to = broadcast_arrays(*arrays)
        self._columns = [ascontiguousarray(column).ravel() for column in inputs]
        self._out = ascontiguousarray(self._to).ravel()

    def __enter__(self) -> nditer:
        """Begin."""
        return self

    def __exit__(self, *_error: object) -> None:
        """Write what is not yet in its place."""
        if not self._to.flags.c_contiguous:
            self._to[...] = self._out.reshape(self._to.shape)

    def __iter__(self) -> Iterator[tuple[ndarray, ...]]:
        """Give the one piece."""
        return iter([(*self._columns, self._out)])


def _operators() -> None:
    """Give arrays their operators, and the functions that are methods as well."""
    for name in METHODS:
        setattr(ndarray, name, globals()[name])
    both = {
        "add": add, "sub": subtract, "mul": multiply, "truediv": divide, "pow": power,
        "mod": mod, "floordiv": floor_divide,
    }  # fmt: skip
    for name, act in both.items():
        setattr(ndarray, f"__{name}__", lambda a, b, act=act: act(a, b))
        setattr(ndarray, f"__r{name}__", lambda a, b, act=act: act(b, a))
        setattr(ndarray, f"__i{name}__", lambda a, b, act=act: act(a, b, out=a))
    compared = {
        "eq": equal, "ne": not_equal, "lt": less, "le": less_equal, "gt": greater,
        "ge": greater_equal,
    }  # fmt: skip
    for name, act in compared.items():
        setattr(ndarray, f"__{name}__", lambda a, b, act=act: act(a, b))
    bits = {"and": operator.and_, "or": operator.or_, "xor": operator.xor}
    for name, plain in bits.items():
        act = ufunc(plain)
        setattr(ndarray, f"__{name}__", lambda a, b, act=act: act(a, b))
        setattr(ndarray, f"__r{name}__", lambda a, b, act=act: act(b, a))
        setattr(ndarray, f"__i{name}__", lambda a, b, act=act: act(a, b, out=a))
    turned = ufunc(lambda x: not x if isinstance(x, bool) else ~x)
    for name, of_one in {"neg": negative, "abs": absolute, "invert": turned}.items():
        setattr(ndarray, f"__{name}__", lambda a, of_one=of_one: of_one(a))
    setattr(ndarray, "__matmul__", dot)  # noqa: B010 - as all of them


_operators()
