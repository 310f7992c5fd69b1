"""Arrays: elements in a stretch of memory, seen through a shape and steps.

A view shares the memory of its array, as in NumPy; kernels of machine code receive it by the buffer
protocol. Loops over elements are Python loops over lists.
"""

from __future__ import annotations

import math
import operator
from array import array as row_of
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import product, repeat
from types import EllipsisType
from typing import Any

from fuzzyarm.apps.playground.arrays.kinds import DTYPES, DType, bool_, dtype, float32, promoted

_BY_CODE = {data_type.code: data_type for data_type in DTYPES}
FLOAT, WHOLE, BOOL, OBJECT = dtype(float), dtype(int), dtype(bool), dtype(object)

Shape = tuple[int, ...]


class Things(list[Any]):
    """Elements of any type, instead of memory."""

    def __getitem__(self, index: Any) -> Any:
        """Return one, or a stretch."""
        item = super().__getitem__(index)
        return Things(item) if isinstance(index, slice) else item

    def tolist(self) -> list[Any]:
        """Return a list."""
        return list(self)


def _memory(values: Sequence[Any], kind: DType) -> Any:
    """Return the memory of some elements."""
    if kind is OBJECT:
        return Things(values)
    if kind is BOOL:
        return memoryview(bytearray(map(bool, values))).cast("?")
    # Whole numbers as they are; a float among them is a TypeError, and then each is converted.
    if kind.kind == "i":
        try:
            return memoryview(row_of(kind.code, values))
        except TypeError:
            return memoryview(row_of(kind.code, list(map(int, values))))
    return memoryview(row_of(kind.code, values))


def _steps(shape: Shape) -> Shape:
    """Return the steps of a shape whose elements are contiguous."""
    steps, step = [], 1
    for size in reversed(shape):
        steps.append(step)
        step *= size
    return tuple(reversed(steps))


class _Flags:
    """The memory layout of an array, as in NumPy."""

    def __init__(self, contiguous: bool) -> None:
        self.c_contiguous = contiguous
        self.writeable = True


class _Flat:
    """The elements in order, by one index."""

    def __init__(self, of: ndarray) -> None:
        self._of = of

    def __getitem__(self, index: Any) -> Any:
        return self._of.reshape(-1)[index]

    def __iter__(self) -> Iterator[Any]:
        return iter(elements(self._of))


class ndarray:
    """An array.

    Parameters
    ----------
    memory : memoryview or Things
        Of the elements.
    kind : DType
        Of each.
    shape, steps : tuple of int
        How many there are along each axis, and from one to the next in the memory.
    start : int
        Where the first one lies.
    """

    __array_priority__ = 1.0

    def __init__(
        self, memory: Any, kind: DType, shape: Shape, steps: Shape | None = None,
        start: int = 0,
    ) -> None:  # fmt: skip
        self._memory, self.dtype, self.shape, self._start = memory, kind, shape, start
        self._step = _steps(shape) if steps is None else steps

    # --- Properties ---

    @property
    def ndim(self) -> int:
        """How many axes."""
        return len(self.shape)

    @property
    def size(self) -> int:
        """How many elements."""
        return math.prod(self.shape)

    @property
    def itemsize(self) -> int:
        """Bytes of an element."""
        return self.dtype.itemsize

    def __array__(self) -> ndarray:  # by which functions over numbers and arrays know one
        return self

    @property
    def nbytes(self) -> int:
        """Bytes of all."""
        return self.size * self.itemsize

    @property
    def strides(self) -> Shape:
        """Bytes from one element to the next."""
        return tuple(step * self.itemsize for step in self._step)

    @property
    def _is_even(self) -> bool:
        """Whether the elements are contiguous."""
        pairs = zip(self.shape, self._step, _steps(self.shape), strict=True)
        # Along an axis of one element no step is ever taken.
        return all(size == 1 or step == even for size, step, even in pairs) or self.size == 0

    @property
    def flags(self) -> _Flags:
        """Its memory layout."""
        return _Flags(self._is_even)

    @property
    def flat(self) -> _Flat:
        """The elements in order."""
        return _Flat(self)

    @property
    def T(self) -> ndarray:  # noqa: N802
        """The axes the other way round."""
        return self.transpose()

    @property
    def data(self) -> memoryview:
        """The memory."""
        return self.__buffer__(0)

    @property
    def ctypes(self) -> Any:
        """Not available."""
        raise AttributeError("addresses of arrays need NumPy, which this page does not have")

    def setflags(self, **_flags: Any) -> None:
        """Do nothing: all arrays may be written."""

    def __buffer__(self, _flags: int) -> memoryview:
        """Lend the memory to kernels."""
        if not self._is_even or self.dtype is OBJECT:
            raise BufferError("the elements do not lie one behind the other")
        part: memoryview = self._memory[self._start : self._start + self.size]
        return part

    def __len__(self) -> int:
        """Return the length of the first axis."""
        if not self.shape:
            raise TypeError("len() of unsized object")
        return self.shape[0]

    def __iter__(self) -> Iterator[Any]:
        """Go along the first axis."""
        if self.ndim == 1:
            return iter(elements(self))
        return (self[index] for index in range(len(self)))

    def __repr__(self) -> str:
        """Write it as nested lists."""
        return f"array({self.tolist()!r})"

    def __bool__(self) -> bool:
        """Whether the one element is true."""
        return bool(self._one())

    def __float__(self) -> float:
        """Return the one element."""
        return float(self._one())

    def __int__(self) -> int:
        """Return the one element."""
        return int(self._one())

    def __index__(self) -> int:
        """Return the one whole number."""
        return operator.index(self._one())

    def _one(self) -> Any:
        if self.size != 1:
            raise ValueError(
                "The truth value of an array with more than one element is ambiguous."
                " Use a.any() or a.all()"
            )
        return elements(self)[0]

    __hash__ = None  # type: ignore[assignment]

    # --- Elements ---

    def item(self) -> Any:
        """Return the one element."""
        return self._one()

    def tolist(self) -> Any:
        """Return nested lists."""
        flat = elements(self)
        if self.dtype.name == "float32":
            flat = list(map(float, flat))
        return _nested(flat, self.shape) if self.shape else flat[0]

    def _places(self) -> list[int]:
        """Where each element lies in the memory."""
        places = [self._start]
        for size, step in zip(self.shape, self._step, strict=True):
            offsets = range(0, size * step, step) if step else [0] * size
            places = [place + offset for place in places for offset in offsets]
        return places

    def __getitem__(self, key: Any) -> Any:
        """Return an element, a view, or a copy by a list of indices."""
        view, indices = _viewed(self, key)
        if indices is not None:
            shape, places = _gathered(view, indices)
            memory = view._memory
            return made([memory[place] for place in places], view.dtype, shape)
        if not view.shape and not (isinstance(key, tuple) and Ellipsis in map(_plain, key)):
            return one(view._memory[view._start], view.dtype)
        return view

    def __setitem__(self, key: Any, value: Any) -> None:
        """Write an element, or many."""
        view, indices = _viewed(self, key)
        if indices is not None:
            shape, places = _gathered(view, indices)
        else:
            shape, places = view.shape, None
        if not isinstance(value, ndarray | list | tuple) and not hasattr(value, "__array__"):
            values: Iterable[Any] = repeat(_cast(value, view.dtype))
        else:
            source = array_of(value)
            # NumPy, too, drops leading axes of one element.
            while source.ndim > len(shape) and source.shape[0] == 1:
                source = source.reshape(source.shape[1:])
            values = elements(broadcast_to(source, shape).astype(view.dtype))
        memory = view._memory
        if indices is None and view._is_even:
            size = view.size
            full = list(values) if not isinstance(values, repeat) else [next(values)] * size
            memory[view._start : view._start + size] = _memory(full, view.dtype)
            return
        # A mask without a true element has no position.
        for place, one in zip(view._places() if places is None else places, values, strict=False):
            memory[place] = one

    # --- Shape ---

    def reshape(self, *shape: Any) -> ndarray:
        """Return the elements in another shape; a view if they are contiguous."""
        sizes = tuple(map(int, shape[0] if isinstance(shape[0], Sequence) else shape))
        if -1 in sizes:
            rest = math.prod(size for size in sizes if size != -1)
            sizes = tuple(self.size // rest if size == -1 else size for size in sizes)
        if math.prod(sizes) != self.size:
            raise ValueError(f"cannot reshape array of size {self.size} into shape {sizes}")
        if self._is_even:
            return ndarray(self._memory, self.dtype, sizes, None, self._start)
        return made(elements(self), self.dtype, sizes)

    def ravel(self) -> ndarray:
        """Return all elements along one axis."""
        return self.reshape(-1)

    def flatten(self) -> ndarray:
        """Return a copy of all elements along one axis."""
        return self.copy().reshape(-1)

    def transpose(self, *axes: Any) -> ndarray:
        """Return the axes in another order."""
        order = tuple(axes[0] if axes and isinstance(axes[0], Sequence) else axes)
        order = order or tuple(range(self.ndim))[::-1]
        shape = tuple(self.shape[axis] for axis in order)
        steps = tuple(self._step[axis] for axis in order)
        return ndarray(self._memory, self.dtype, shape, steps, self._start)

    def squeeze(self) -> ndarray:
        """Return it without axes of one element."""
        return self.reshape(tuple(size for size in self.shape if size != 1))

    def copy(self) -> ndarray:
        """Return an array with its own memory."""
        return made(elements(self), self.dtype, self.shape)

    def astype(self, kind: Any, copy: bool = True) -> ndarray:
        """Return the elements as another kind."""
        to = dtype(kind)
        if to is self.dtype:
            return self.copy() if copy else self
        values = elements(self)
        if to.kind == "i" and self.dtype.kind == "f":
            values = list(map(int, values))
        return made(values, to, self.shape)

    def view(self, kind: Any) -> ndarray:
        """Read the same memory as another kind of the same size."""
        to = dtype(kind)
        if to.itemsize != self.itemsize:
            raise TypeError("a view of another size needs NumPy, which this page does not have")
        # A memoryview goes from one kind to another by way of bytes only.
        other = self._memory.cast("B").cast(to.code)
        return ndarray(other, to, self.shape, self._step, self._start)

    def tobytes(self) -> bytes:
        """Return the elements as they lie in memory, in order."""
        return bytes(_memory(elements(self), self.dtype).cast("B"))

    def fill(self, value: Any) -> None:
        """Write one value everywhere."""
        self[...] = value

    def __getattr__(self, name: str) -> Any:
        """Raise for a missing attribute; functions of `operators.METHODS` are methods as well."""
        raise AttributeError(f"arrays have no {name} without NumPy, which this page does not have")


def _plain(key: Any) -> Any:
    """Return an operand comparable with `Ellipsis`."""
    return key if isinstance(key, EllipsisType) else None


def _cast(value: Any, kind: DType) -> Any:
    if kind is BOOL:
        return bool(value)
    if kind is OBJECT:
        return value
    return int(value) if kind.kind == "i" else float(value)


def _nested(flat: list[Any], shape: Shape) -> list[Any]:
    for axis in range(len(shape) - 1, 0, -1):
        size, count = shape[axis], math.prod(shape[:axis])
        flat = [flat[k * size : (k + 1) * size] for k in range(count)]
    return flat


# --- Making them ---


def one(value: Any, kind: DType) -> Any:
    """Return an element of an array: a float of 64 bits and a whole number are Python's."""
    return kind.type(value) if kind.name in ("float32", "bool") else value


def single(value: Any, kind: DType) -> Any:
    """Return the one result of a function, which has the attributes of an array, as NumPy's."""
    return value if kind is OBJECT else kind.type(value)


def made(values: Sequence[Any], kind: DType, shape: Shape | None = None) -> ndarray:
    """Return an array of elements in order."""
    return ndarray(_memory(values, kind), kind, (len(values),) if shape is None else shape)


def elements(of: ndarray) -> list[Any]:
    """Return the elements in order."""
    memory, start, size = of._memory, of._start, of.size
    if of._is_even:
        part = memory[start : start + size]
    elif of.ndim == 1 and of._step[0] > 0:
        part = memory[start : start + (size - 1) * of._step[0] + 1 : of._step[0]]
    else:
        return [memory[place] for place in of._places()]
    values: list[Any] = part.tolist()
    return values


def kind_of(value: Any) -> DType:  # noqa: PLR0911
    """Return the kind of a number, or of numbers in a list."""
    if isinstance(value, ndarray):
        return value.dtype
    if isinstance(value, bool | bool_):
        return BOOL
    if isinstance(value, float32):
        return dtype(float32)
    if isinstance(value, int):
        return WHOLE
    if isinstance(value, float):
        return FLOAT
    if isinstance(value, Sequence) and not isinstance(value, str):
        kinds = [kind_of(element) for element in value]
        kind = kinds[0] if kinds else FLOAT
        for other in kinds[1:]:
            if other is not kind:
                kind = promoted(kind, other)
        return kind
    return OBJECT


def array_of(value: Any, kind: Any = None) -> ndarray:  # noqa: C901
    """Return an array of an array, a number, or nested lists."""
    to = None if kind is None else dtype(kind)
    if isinstance(value, ndarray):
        return value if to is None or to is value.dtype else value.astype(to)
    if isinstance(value, memoryview) and value.format in _BY_CODE and value.contiguous:
        shared = ndarray(value, _BY_CODE[value.format], value.shape or ())
        return shared if to is None else shared.astype(to, copy=False)
    if isinstance(value, memoryview | row_of | range):
        value = list(value)
    elif isinstance(value, str | bytes):
        raise TypeError("an array of texts needs NumPy, which this page does not have")
    elif isinstance(value, Iterable) and not isinstance(value, Sequence):
        value = list(value)
    if not isinstance(value, Sequence):
        data_type = kind_of(value) if to is None else to
        return made([_cast(value, data_type)], data_type, ())
    if not any(isinstance(element, Sequence | ndarray) for element in value):
        data_type = kind_of(value) if to is None else to
        if data_type.kind == "i":
            value = [int(element) for element in value]
        return made(value, data_type)
    rows = [array_of(element, to) for element in value]
    if len({row.shape for row in rows}) != 1:
        raise ValueError("setting an array element with a sequence: the rows differ in length")
    data_type = rows[0].dtype
    for row in rows[1:]:
        data_type = promoted(data_type, row.dtype)
    flat = [element for row in rows for element in elements(row.astype(data_type, copy=False))]
    return made(flat, data_type, (len(rows), *rows[0].shape))


# --- Indexing ---


def _viewed(of: ndarray, key: Any) -> tuple[ndarray, dict[int, ndarray] | None]:
    """Return the view of the plain indices, and arrays of indices by its axis."""
    keys = list(key) if isinstance(key, tuple) else [key]
    keys = _indices_of(keys)
    axis_count = sum(_axes_of(key_part) for key_part in keys)
    places = [k for k, key_part in enumerate(keys) if isinstance(key_part, EllipsisType)]
    rest = [slice(None)] * (of.ndim - axis_count)
    if places:
        keys[places[0] : places[0] + 1] = rest
    else:
        keys += rest
    if axis_count > of.ndim:
        raise IndexError(f"too many indices for array: array is {of.ndim}-dimensional")
    start, shape, steps, axis = of._start, list[int](), list[int](), 0
    indices: dict[int, ndarray] = {}
    for key_part in keys:
        if key_part is None:
            shape.append(1)
            steps.append(0)
            continue
        if isinstance(key_part, ndarray) and key_part.dtype is BOOL:
            for inner in _true_places(key_part):
                indices[len(shape)] = inner
                shape.append(of.shape[axis])
                steps.append(of._step[axis])
                axis += 1
            continue
        size, step = of.shape[axis], of._step[axis]
        axis += 1
        if isinstance(key_part, slice):
            first, last, by = key_part.indices(size)
            start += first * step
            shape.append(len(range(first, last, by)))
            steps.append(step * by)
        elif isinstance(key_part, ndarray):
            indices[len(shape)] = key_part
            shape.append(size)
            steps.append(step)
        else:
            if not -size <= key_part < size:
                raise IndexError(f"index {key_part} is out of bounds for axis with size {size}")
            start += (key_part % size) * step
    view = ndarray(of._memory, of.dtype, tuple(shape), tuple(steps), start)
    return view, indices or None


def _axes_of(key: Any) -> int:
    """Return the number of axes in an index."""
    if key is None or isinstance(key, EllipsisType):
        return 0
    return key.ndim if isinstance(key, ndarray) and key.dtype is BOOL else 1


def _indices_of(keys: Sequence[Any]) -> list[Any]:
    """Return indices as `_index_of` does; beside arrays numbers are arrays, too, as in NumPy."""
    indices = [_index_of(key) for key in keys]
    if any(isinstance(index, ndarray) for index in indices):
        return [made([k], WHOLE, ()) if isinstance(k, int) else k for k in indices]
    return indices


def _index_of(key: Any) -> Any:
    """Return an index as a number, a slice, None, an ellipsis or an array."""
    if key is None or isinstance(key, slice | EllipsisType):
        return key
    if isinstance(key, ndarray):
        return int(key) if not key.shape and key.dtype is not BOOL else key
    if isinstance(key, list | range):
        return array_of(list(key), None if len(key) else int)
    return operator.index(key)


def _true_places(mask: ndarray) -> list[ndarray]:
    """Return the indices, an array for each axis, at which a mask is true."""
    spots = [
        spot for spot, is_true in zip(product(*map(range, mask.shape)), elements(mask), strict=True)
        if is_true
    ]  # fmt: skip
    return [made([spot[axis] for spot in spots], WHOLE) for axis in range(mask.ndim)]


def _gathered(view: ndarray, chosen: dict[int, ndarray]) -> tuple[Shape, list[int]]:
    """Return the shape and the positions of a selection of a view by index arrays."""
    common = broadcast_shapes(*(index_array.shape for index_array in chosen.values()))
    spots = [0] * math.prod(common)
    for axis, index_array in chosen.items():
        size, step = view.shape[axis], view._step[axis]
        for k, index in enumerate(elements(broadcast_to(index_array, common))):
            if not -size <= index < size:
                raise IndexError(f"index {index} is out of bounds for axis {axis} with size {size}")
            spots[k] += (index % size) * step
    axes = sorted(chosen)
    together = axes == list(range(axes[0], axes[-1] + 1))
    first = axes[0] if together else 0
    others = [axis for axis in range(view.ndim) if axis not in chosen]
    before = [axis for axis in others if together and axis < first]
    after = [axis for axis in others if axis not in before]
    front, back = (_offsets(view, part) for part in (before, after))
    base = view._start
    places = [base + a + spot + b for a in front for spot in spots for b in back]
    shape = (
        *(view.shape[axis] for axis in before), *common, *(view.shape[axis] for axis in after)
    )  # fmt: skip
    return shape, places


def _offsets(view: ndarray, axes: Sequence[int]) -> list[int]:
    inner = ndarray(
        view._memory, view.dtype, tuple(view.shape[axis] for axis in axes),
        tuple(view._step[axis] for axis in axes),
    )  # fmt: skip
    return inner._places()


# --- Broadcasting ---


def broadcast_shapes(*shapes: Shape | int) -> Shape:
    """Return the shape that arrays of some shapes make together."""
    plain = [(shape,) if isinstance(shape, int) else tuple(shape) for shape in shapes]
    common: list[int] = []
    for k in range(1, max(map(len, plain), default=0) + 1):
        sizes = {shape[-k] for shape in plain if len(shape) >= k} - {1}
        if len(sizes) > 1:
            raise ValueError(
                f"shape mismatch: objects cannot be broadcast to a single shape {plain}"
            )
        common.append(sizes.pop() if sizes else 1)
    return tuple(reversed(common))


def broadcast_to(value: Any, shape: Any) -> ndarray:
    """Return a view in which axes of one element are repeated."""
    source = array_of(value)
    shape = (shape,) if isinstance(shape, int) else tuple(map(int, shape))
    more = len(shape) - source.ndim
    if more < 0 or broadcast_shapes(source.shape, shape) != shape:
        raise ValueError(f"cannot broadcast shape {source.shape} to shape {shape}")
    sizes, steps = (1,) * more + source.shape, (0,) * more + source._step
    strides = tuple(0 if size == 1 else step for size, step in zip(sizes, steps, strict=True))
    return ndarray(source._memory, source.dtype, shape, strides, source._start)


def operate(
    act: Callable[..., Any], source: Sequence[Any], kind: DType | None = None, out: Any = None
) -> Any:
    """Apply a function of numbers to all elements."""
    arrays = [
        array_of(operand) if isinstance(operand, ndarray | Sequence) else operand
        for operand in source
    ]
    shapes = [operand.shape for operand in arrays if isinstance(operand, ndarray)]
    kind = kind or _kind_together(arrays)
    if not shapes:
        return single(act(*arrays), kind)
    common = shapes[0] if all(shape == shapes[0] for shape in shapes) else broadcast_shapes(*shapes)
    columns = [
        elements(operand if operand.shape == common else broadcast_to(operand, common))
        if isinstance(operand, ndarray) else repeat(operand)
        for operand in arrays
    ]  # fmt: skip
    values = list(map(act, *columns))
    if out is not None:
        (out[0] if isinstance(out, tuple) else out)[...] = made(values, kind, common)
        return out[0] if isinstance(out, tuple) else out
    return made(values, kind, common) if common else single(values[0], kind)


def _kind_together(arrays: Sequence[Any]) -> DType:
    """Return the kind of a result: a number of Python is as wide as the arrays beside it."""
    dtypes = [operand.dtype for operand in arrays if isinstance(operand, ndarray)]
    if not dtypes:
        return kind_of(list(arrays))
    kind = dtypes[0]
    for other in dtypes[1:]:
        kind = promoted(kind, other)
    for operand in arrays:
        if not isinstance(operand, ndarray):
            number_kind = kind_of(operand)
            if number_kind.kind == "f" and kind.kind != "f":
                kind = number_kind
            elif number_kind.kind == "i" and kind is BOOL:
                kind = WHOLE
    return kind
