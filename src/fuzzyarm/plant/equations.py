"""Equations of a user's plant as machine code, without a compiler: traced into programs.

A plant in plain Python is evaluated on symbols instead of numbers. If it uses only arithmetic and
functions of :mod:`math`, the result is an expression, which runs in the loop as machine code as a
program of operations (:mod:`fuzzyarm.symbolic.programs`). Equations that branch on a value
(``if x[0] > 0``), or differ when evaluated again, are not traced but called as Python; or
compiled by numba, if that is installed and they are marked as kernels.
"""

from __future__ import annotations

import contextlib
import dis
import functools
import importlib.util
import math
import os
import pickle
from array import array
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy, deepcopy
from itertools import chain
from operator import is_
from queue import Queue
from types import FunctionType, GeneratorType, MethodType, ModuleType
from typing import Any, NamedTuple, cast
from weakref import WeakKeyDictionary

import numpy as np

from fuzzyarm.symbolic import op
from fuzzyarm.symbolic.evaluation import evaluate
from fuzzyarm.symbolic.kernels import copied, with_names
from fuzzyarm.symbolic.nodes import Node, as_node, comparing_values, symbol
from fuzzyarm.symbolic.programs import program_of

USERS = (Exception, SystemExit)
"""Exceptions of a user's code; ``sys.exit`` in it must not end the command."""


def is_of_package(kind: type) -> bool:
    """Whether the class of a plant, or of its base, belongs to the package.

    Others belong to a user or another package.
    """
    return kind.__module__.startswith("fuzzyarm.")


def begins_by_itself(plant: Any) -> bool:
    """Whether the start of a plant is a user's code, not written for threads."""
    return not type(plant).start.__module__.startswith("fuzzyarm.")


class Equations(NamedTuple):
    """The equations of a plant as programs over time, states, inputs and parameters in a row.

    Attributes
    ----------
    rates : array of float
        Rates of the states.
    outputs : array of float or None
        Outputs; None if they are the first states.
    """

    rates: array[float]
    outputs: array[float] | None

    @property
    def addresses(self) -> tuple[float, float]:
        """Addresses of the programs for kernels; 0 for none. Valid while this lives."""
        return _address(self.rates), _address(self.outputs)


def _address(program: array[float] | None) -> float:
    """Return the odd address of a program; a float represents it exactly."""
    return 0.0 if program is None else float(program.buffer_info()[0] + 1)


TRACED = "_fuzzyarm_traced"
"""Attribute for the result of tracing a plant, with the plant's attributes at that time.

None for attributes: valid whatever becomes of them, since a run has its addresses. Stored in the
plant, which need not be hashable (a dataclass is not).
"""


def traced(plant: Any) -> Equations | None:
    """Return the equations of a plant as programs; None if they cannot be traced.

    Parameters
    ----------
    plant : Plant
        With `derivative`, and `measure` or None.
    """
    attributes = {name: value for name, value in vars(plant).items() if name != TRACED}
    if TRACED in vars(plant):
        before, cached = vars(plant)[TRACED]
        if before is None or _is_alike(before, attributes, is_):
            return cast("Equations | None", cached)
    equations = _traced(plant)
    vars(plant)[TRACED] = attributes, equations
    return equations


def keep_traced(plant: Any, source: Any) -> None:
    """Keep the traced programs for the life of the plant, for its runs.

    A copy of a plant shares those of the original, if kept.
    """
    kept = vars(source).get(TRACED)
    if kept is not None and kept[0] is None:
        vars(plant)[TRACED] = kept
    vars(plant)[TRACED] = None, traced(plant)


def _is_alike(
    before: Mapping[str, Any], after: Mapping[str, Any], same: Callable[[Any, Any], bool]
) -> bool:
    return before.keys() == after.keys() and all(map(same, before.values(), after.values()))


def _is_same(before: object, after: object) -> bool:
    """Whether an attribute is unchanged, recursively."""
    if before is after:
        return True
    try:
        return pickle.dumps(before) == pickle.dumps(after)
    except Exception:  # user code may raise anything
        return type(before) is type(after)


def expressions_of(plant: Any) -> Roots | None:
    """Return rates and outputs of a plant as expressions; None if they cannot be traced.

    Parameters
    ----------
    plant : Plant
        Any; plants with kernels or with a `step` have no equations to trace.

    Returns
    -------
    rates : list of Node
        Over ``t``, the states ``x0`` …, the inputs ``u0`` … and the parameters ``p0`` ….
    outputs : list of Node or None
        None if they are the first states.
    """
    if plant.derivative is None or plant.step is not None or plant.dynamics is not None:
        return None
    seeds = (0, 1) if begins_by_itself(plant) else (0,)
    first, *again = (_begun_roots(apart(plant), seed) for seed in seeds)
    if first is None or any(first != other for other in again):  # they depend on a random start
        return None
    return first if _agrees(plant, first) else None


def has_queue(plant: Any) -> bool:
    """Whether a plant keeps a queue, for instance for a delay: a list that its code pops counts."""
    plant = apart(plant)
    plant.start(np.random.default_rng(0))  # usually created there
    kept = [*vars(plant).values(), *vars(type(plant)).values()]
    codes = [getattr(each, "__code__", None) for each in vars(type(plant)).values()]
    pops = any("pop" in code.co_names for code in codes if code is not None)
    kinds = (deque, Queue, list) if pops else (deque, Queue)
    return any(isinstance(value, kinds) for value in kept)


def _traced(plant: Any) -> Equations | None:
    # Those of the package are kernels, or run foreign code (an FMU, a system).
    if is_of_package(type(plant)):
        return None
    first = expressions_of(plant)
    if first is None:
        return None
    flat = [name for group in _names_of(plant) for name in group]
    rates, outputs = (None if roots is None else program_of(roots, (), flat) for roots in first)
    assert rates is not None
    return Equations(rates, outputs)


_agreed: WeakKeyDictionary[type, set[tuple[Node, ...]]] = WeakKeyDictionary()
"""Verified traces of each class, so that runs with other parameters need no verification."""

MOST_AGREED = 1000
"""Largest number for a class."""


def _agrees(plant: Any, roots: Roots) -> bool:
    """Whether traced expressions agree with the equations at various points.

    A symbol is not a float, and has a remainder of another sign: code that tests such things, or
    catches every error, treats symbols differently from numbers.
    """
    rates, outputs = roots
    key = (*rates, *(outputs or ()))
    agreements = _agreed.setdefault(type(plant), set())
    if key in agreements:
        return True
    if len(agreements) >= MOST_AGREED:
        agreements.clear()
    names = _names_of(plant)
    # Equations may change attributes of the plant, so they run on a copy.
    separate = apart(plant)
    try:
        start = [float(value) for value in _started(separate, 0)]
    except USERS:
        return False
    for point in _points(plant, start):
        (t,), *groups = point
        values = dict(zip((n for row in names for n in row), (t, *chain(*groups)), strict=True))
        for method, expected in ((separate.derivative, rates), (separate.measure, outputs)):
            if expected is not None and not _is_answer(method, t, groups, expected, values):
                return False
    agreements.add(key)
    return True


def _is_answer(
    method: Callable[..., Any],
    t: float,
    groups: Sequence[Sequence[float]],
    roots: Sequence[Node],
    values: Mapping[str, float],
) -> bool:
    try:
        answers = [float(value) for value in method(t, *map(list, groups))]
    except USERS:  # outside its domain: the square root of a negative level
        return True
    traced_answers = [evaluate(root, values) for root in roots]
    return all(
        math.isclose(answer, traced, rel_tol=1e-9, abs_tol=1e-12) or not math.isfinite(answer)
        for answer, traced in zip(answers, traced_answers, strict=True)
    )


def _points(plant: Any, start: list[float]) -> Iterator[tuple[Sequence[float], ...]]:
    """Yield times, states, inputs and parameters: at rest, at limits, integers, random ones."""
    stated = plant.parameters
    stated = stated.unnoted if isinstance(stated, Watched) else stated
    parameters = [float(getattr(parameter, "value", parameter)) for parameter in stated.values()]
    ports = plant.inputs.values()
    low = [port.low if math.isfinite(port.low) else -1.0 for port in ports]
    high = [port.high if math.isfinite(port.high) else 1.0 for port in ports]
    zero, count = [0.0] * len(low), len(start)
    yield (0.0,), start, zero, parameters
    yield (1.0,), start, low, parameters
    yield (2.0,), start, high, parameters
    # Whole numbers, of parameters too, reveal modes and remainders; random points at several scales
    # the rest.
    for whole in (-1.0, 0.0, 1.0, 2.0):
        for numbers in (parameters, [whole] * len(parameters)):
            yield (whole,), [whole] * count, [whole] * len(low), numbers
    generator = np.random.default_rng(0)
    for spread in (0.1, 1.0, 1.0, 10.0):
        states = (np.array(start) + spread * generator.standard_normal(count)).tolist()
        inputs = generator.uniform(low, high).tolist()
        near = (np.array(parameters) * generator.uniform(0.5, 1.5, len(parameters))).tolist()
        for numbers in (parameters, near):
            yield (float(generator.uniform(0.0, 5.0)),), states, inputs, numbers


Roots = tuple[list[Node], list[Node] | None]
"""The results over symbols: rates, and outputs if the plant has a `measure`."""


def _begun_roots(plant: Any, seed: int) -> Roots | None:
    """Return the traced results of a started plant; None if not a reproducible expression."""
    try:
        _started(plant, seed)
    except USERS:  # the run will raise it
        return None
    before, shared = dict(vars(apart(plant))), _class_attributes(plant)
    rates = _roots(plant.derivative, _names_of(plant), len(plant.states))
    outputs = None
    if rates is not None and plant.measure is not None:
        outputs = _roots(plant.measure, _names_of(plant), len(plant.outputs))
        rates = None if outputs is None else rates
    is_unchanged = _is_alike(before, vars(plant), _is_same) and shared == _class_attributes(plant)
    return (
        (rates, outputs) if rates is not None and is_unchanged else None
    )  # counters are not traced


def _started(plant: Any, seed: int) -> Sequence[float]:
    """Start a plant; reads of its start are not reads of its equations."""
    watched = plant.parameters if isinstance(plant.parameters, Watched) else Watched({})
    before = set(watched.read)
    states: Sequence[float] = plant.start(np.random.default_rng(seed))
    watched.read = before
    return states


def _class_attributes(plant: Any) -> dict[tuple[type, str], object]:
    """Snapshot the mutable class attributes of a user's plant."""
    contents = {}
    for kind in type(plant).__mro__:
        if not is_of_package(kind):
            for name, value in vars(kind).items():
                if isinstance(value, int | float | list | dict | set) and name not in PORTS:
                    contents[kind, name] = _contents(value)
    return contents


PORTS = ("inputs", "outputs", "states", "parameters")
"""Properties of a plant that no run changes."""


def _names_of(plant: Any) -> list[list[str]]:
    """Return the names of the arguments of equations: time, states, inputs, parameters."""
    sizes = len(plant.states), len(plant.inputs), len(plant.parameters)
    return [
        ["t"],
        *([f"{letter}{k}" for k in range(size)] for letter, size in zip("xup", sizes, strict=True)),
    ]


def _roots(
    function: Callable[..., Any], names: Sequence[Sequence[str]], count: int
) -> list[Node] | None:
    """Return the result of a function over symbols; None if it is not an expression of them."""
    (time,), *groups = names
    arguments = (symbol(time), *([symbol(name) for name in group] for group in groups))
    symbolic = over_symbols(function)
    before = _reached(symbolic)
    try:
        with comparing_values():
            first, again = ([as_node(rate) for rate in symbolic(*arguments)] for _ in range(2))
    except USERS:  # anything may be raised on symbols
        return None
    # A function with random numbers differs between two calls; one that counts, perhaps later.
    if first != again or before != _reached(symbolic):
        return None
    return first if len(first) == count else None


def _reached(function: Callable[..., Any]) -> dict[tuple[object, str], object]:
    """Snapshot what a function can change outside its plant: globals, modules, closures, defaults.

    Includes the functions of the user's module that it may call.
    """
    found: dict[tuple[object, str], object] = {}
    seen: set[object] = set()
    pending: list[Any] = [getattr(function, "__func__", function)]
    while pending:
        plain = pending.pop()
        if isinstance(plain, type) and plain not in seen:
            seen.add(plain)
            pending += [getattr(x, "__func__", x) for x in vars(plain).values()]
        if not isinstance(plain, FunctionType):
            continue
        if _imports_late(plain):
            found[plain, "import"] = object()
        # Functions of one module share its globals.
        for place, space in (id(plain.__globals__), plain.__globals__), (plain, _bound_by(plain)):
            if place in seen:
                continue
            seen.add(place)
            found |= {(place, name): _contents(value) for name, value in space.items()}
            pending += [
                x for x in space.values() if getattr(x, "__module__", None) == plain.__module__
            ]
    return found


_IMPORT_NAME = dis.opmap["IMPORT_NAME"]


def _imports_late(function: FunctionType) -> bool:
    """Whether a function imports a module of its folder, which Python may have changed by then."""
    code = function.__code__
    if _IMPORT_NAME not in code.co_code[::2]:  # rare, and decoding is slow
        return False
    folder = os.path.dirname(os.path.abspath(code.co_filename))
    instructions = dis.get_instructions(code)
    names = [line.argval.partition(".")[0] for line in instructions if line.opname == "IMPORT_NAME"]
    return any(
        os.path.exists(os.path.join(folder, found))
        for name in names
        for found in (name, f"{name}.py")
    )


def _bound_by(function: FunctionType) -> dict[str, Any]:
    """Return the closure and the defaults of a function."""
    bound = {str(k): value for k, value in enumerate(function.__defaults__ or ())}
    bound |= function.__kwdefaults__ or {}
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        with contextlib.suppress(ValueError):  # a cell still empty
            bound[f"({name})"] = cell.cell_contents
    return bound


def _contents(value: object) -> object:
    """Return an object's state for comparison; a generator's differs each time."""
    if isinstance(value, GeneratorType):
        return object()
    if isinstance(value, ModuleType | type):
        return {name: x for name, x in vars(value).items() if isinstance(x, int | float)}
    for kept in () if callable(value) else (value, getattr(value, "__dict__", None)):
        with contextlib.suppress(Exception):  # user code may raise anything
            return pickle.dumps(kept)
    return id(value)


def over_symbols(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a copy of a function in whose globals :mod:`math` accepts symbols."""
    plain = getattr(function, "__func__", function)
    if not isinstance(plain, FunctionType):
        return function
    space = dict(plain.__globals__)
    space.setdefault("min", functools.partial(_folded, op.minimum))
    space.setdefault("max", functools.partial(_folded, op.maximum))
    for name, value in plain.__globals__.items():
        if value is math:
            space[name] = _Math()
        elif isinstance(value, type(math.sin)) and value in _FUNCTIONS_OF_MATH:  # hashable
            space[name] = _for_symbols(_FUNCTIONS_OF_MATH[value])
    copy = FunctionType(
        plain.__code__, space, plain.__name__, plain.__defaults__, plain.__closure__
    )
    copy.__kwdefaults__ = plain.__kwdefaults__
    owner = getattr(function, "__self__", None)
    return copy if owner is None else MethodType(copy, owner)


_FUNCTIONS_OF_MATH = {function: name for name, function in vars(math).items() if callable(function)}


class _Math:
    """The module :mod:`math` for symbols and numbers."""

    def __getattr__(self, name: str) -> Any:
        return _for_symbols(name)


def _for_symbols(name: str) -> Any:
    if name == "fabs":
        return abs
    return getattr(op, _OTHER_NAMES.get(name, name), None) or getattr(math, name)


_OTHER_NAMES = {"pow": "power", "trunc": "truncate"}


def _folded(norm: Callable[..., Any], *values: Any) -> Any:
    (first, *others) = values if len(values) > 1 else values[0]
    for other in others:
        first = norm(first, other)
    return first


# --- A user's kernels, compiled by numba ---


def has_numba() -> bool:
    """Whether numba is installed."""
    return importlib.util.find_spec("numba") is not None


@functools.cache
def _compiled(
    function: Callable[..., None], types: str, bindings: tuple[tuple[str, Any], ...]
) -> Callable[..., None]:
    import numba

    def compiled(kernel: FunctionType) -> Any:
        return numba.njit(error_model="numpy", nogil=True)(kernel)

    run = compiled(copied(function, dict(bindings), compiled))
    words = ", ".join(f"at_{k}, size_{k}" for k in range(len(types)))
    arrays = ", ".join(f"carray(at_{k}, size_{k})" for k in range(len(types)))
    space = {"run": run, "carray": numba.carray}
    exec(f"def entry({words}):\n    run({arrays})\n", space)
    pointer = numba.types.CPointer(numba.types.float64)
    signature = numba.types.void(*[pointer, numba.types.int64] * len(types))
    entry = numba.cfunc(signature)(space["entry"])

    def interpreted(*arguments: Any) -> None:
        with_names(function, dict(bindings))(*arguments)

    interpreted.__address__ = entry.address  # type: ignore[attr-defined]
    interpreted.entry = entry  # type: ignore[attr-defined]
    return interpreted


def compiled_by_numba(
    function: Callable[..., None], types: str, bindings: Mapping[str, Callable[..., Any]]
) -> Callable[..., None]:
    """Compile a kernel by numba, with an address for the loop."""
    return _compiled(function, types, tuple(sorted(bindings.items(), key=lambda pair: pair[0])))


# --- Attributes of a plant ---


class Watched(Mapping[str, Any]):
    """Parameters of a plant that note which are read; no dict, whose copies note nothing."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self._values = dict(values)
        self.read: set[str] = set()

    def __deepcopy__(self, _copies: object) -> Watched:
        return self  # copies of the plant note here, too

    @property
    def unnoted(self) -> Mapping[str, Any]:
        """The parameters for others than the plant."""
        return self._values

    def __getitem__(self, name: str) -> Any:
        self.read.add(name)
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def copy(self) -> dict[str, Any]:
        """Return the parameters; all of them are read."""
        return dict(self)

    def __or__(self, other: Mapping[str, Any]) -> dict[str, Any]:
        return dict(self) | dict(other)

    def __ror__(self, other: Mapping[str, Any]) -> dict[str, Any]:
        return dict(other) | dict(self)


def apart(plant: Any) -> Any:
    """Return a deep copy of a plant, so that the original keeps its attributes.

    Attributes that cannot be copied (a lock, a file, a socket) are shared.
    """
    other = copy(plant)
    fill(other, plant)
    return other


def fill(plant: Any, source: Any) -> None:
    """Replace the attributes of a plant by copies of another's."""
    copies = {id(source): plant}  # references to the source become references to the plant
    attributes = dict(vars(source))
    vars(plant).clear()
    attributes.pop(TRACED, None)
    for name, value in attributes.items():
        vars(plant)[name] = value
        with contextlib.suppress(Exception):  # user classes may fail to copy
            vars(plant)[name] = deepcopy(value, copies)
