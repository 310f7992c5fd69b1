"""A lookup table as a network of rectifiers in ONNX, for verifiers of neural networks.

A grid of values is made continuous by Kuhn's triangulation, which cuts each cell into simplices by
the order of its coordinates; the function that is linear in each of them is

    f(x) = Σ_k v_k max(0, 1 - max(0, a) - max(0, -a)),    a = g(x) - k,

where v_k is the value at the grid point k, g_i(x_i) the position on axis i in levels, and max(0, a)
the largest of 0, a_1 … a_n. All of it is sums and max(0, ·), so that a chain of ``Gemm`` and
``Relu`` computes it: which all readers of networks accept. A table over one input is
interpolated linearly by f; over more inputs f differs from interpolation within the cells. There,
with t the position in a cell, m_S the mixed difference of its corners over the axes S,

    linear interpolation = Σ_S m_S Π_S t_i,    f = Σ_S m_S min_S t_i,

and min - Π of k factors within 0 .. 1 is at most k^(-1/(k-1)) (1 - 1/k): a bound on the difference.

References
----------
H. W. Kuhn, "Some combinatorial lemmas in topology", IBM J. Res. Dev. 4 (1960).
L. Lovász, "Submodular functions and convexity", in Mathematical Programming: The State of the Art
(1983): f on one cell.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import demand_extra
from fuzzyarm.base.numbers import outward_text
from fuzzyarm.exchange.export.numbers import ExportError
from fuzzyarm.exchange.export.routine import MADE, CallCost, plain, routine_words
from fuzzyarm.exchange.export.table import FloatTable, Reals, TableRoutine, fewer_levels
from fuzzyarm.version import __version__

MOST_NODES = 2_500
"""Grid points of a network: its widest matrix has twice their square of entries."""

OPSET, IR_VERSION = 13, 8
"""Versions of ONNX that every current reader knows."""

_Row = dict[int, float]
"""A linear combination of the neurons of a layer; the constant is at -1."""

_ONE = -1


def _sum(*parts: tuple[float, _Row]) -> _Row:
    total: _Row = {}
    for factor, row in parts:
        for key, value in row.items():
            total[key] = total.get(key, 0.0) + factor * value
    return {key: value for key, value in total.items() if value}


class _Chain:
    """Layers under construction: rows over the last layer become neurons of the next one."""

    def __init__(self, inputs: int) -> None:
        self.layers: list[tuple[NDArray[np.float64], NDArray[np.float64]]] = []
        self.width = inputs

    def layer(self, rows: Sequence[_Row]) -> list[_Row]:
        """Append a layer of these rows; return its neurons."""
        weights, bias = np.zeros((len(rows), self.width)), np.zeros(len(rows))
        for i, row in enumerate(rows):
            for key, value in row.items():
                if key == _ONE:
                    bias[i] = value
                else:
                    weights[i, key] = value
        self.layers.append((weights, bias))
        self.width = len(rows)
        return [{i: 1.0} for i in range(len(rows))]


def _constant(value: float) -> _Row:
    return {_ONE: value}


@dataclass(frozen=True, eq=False)
class NetworkTable(FloatTable):
    """A table as a network: its levels and values in the type of its numbers."""

    @cached_property
    def layers(self) -> list[tuple[Reals, Reals]]:
        """Weights (neurons × neurons before) and biases; all but the last one are rectified."""
        chain, levels = _Chain(len(self.points)), [x.astype(np.float64) for x in self.points]
        # Clamp first, by the upper end and then by the lower one: far out nothing cancels.
        ends = [(x[0], x[-1]) for x in levels]
        beyond = chain.layer([{i: -1.0, _ONE: high} for i, (_, high) in enumerate(ends)])
        within = chain.layer(
            [_sum((-1.0, row), (1.0, _constant(high - low)))
             for row, (low, high) in zip(beyond, ends, strict=True)]
        )  # fmt: skip
        if len(levels) == 1:
            curve = self._kinked(chain, within, [self.values.astype(np.float64)])[0]
            chain.layer([_sum((1.0, curve), (1.0, _constant(float(self.values[0]))))])
        else:
            positions = self._kinked(chain, within, [np.arange(x.size) for x in levels])
            chain.layer([self._blend(chain, positions)])
        kind = self.precision.outside
        return [(weights.astype(kind), bias.astype(kind)) for weights, bias in chain.layers]

    def _kinked(
        self, chain: _Chain, within: Sequence[_Row], curves: Sequence[NDArray[Any]]
    ) -> list[_Row]:
        """Return curves over the levels of each axis, less their first values."""
        kinks: list[_Row] = []
        parts: list[list[tuple[int, float]]] = []
        for row, points, curve in zip(within, self.points, curves, strict=True):
            levels = points.astype(np.float64)
            slopes = np.diff(curve) / np.diff(levels)
            # Of an even grid a single one is left; one level has a slope of 0.
            bends = np.diff(slopes, prepend=0.0).tolist() if slopes.size else [0.0]
            steps = [(k, bend) for k, bend in enumerate(bends) if bend or k == 0]
            parts.append([(len(kinks) + j, bend) for j, (_, bend) in enumerate(steps)])
            kinks += [_sum((1.0, row), (1.0, _constant(levels[0] - levels[k]))) for k, _ in steps]
        neurons = chain.layer(kinks)
        return [_sum(*((step, neurons[j]) for j, step in part)) for part in parts]

    def _blend(self, chain: _Chain, positions: list[_Row]) -> _Row:
        """Return f over positions on the axes, in levels."""
        nodes = list(np.ndindex(*self.table.shape))
        largest: dict[tuple[int, ...], tuple[_Row, _Row]] = {}  # of a_1 … a_j and of -a, less a_j
        for j in range(1, len(positions)):
            # The largest of a_1 … a_(j+1), less a_(j+1), depends on the steps k_1-k_2, k_2-k_3 …
            steps = sorted({tuple(np.diff(k[: j + 1]).tolist()) for k in nodes})
            rows: list[_Row] = []
            for step in steps:
                gap = _constant(step[-1])
                ahead = _sum((1.0, positions[j - 1]), (-1.0, positions[j]), (1.0, gap))
                up, down = largest.get(step[:-1], ({}, {}))
                rows += [_sum((1.0, up), (1.0, ahead)), _sum((1.0, down), (-1.0, ahead))]
            neurons = chain.layer([*rows, *positions])
            positions = neurons[len(rows) :]
            largest = {step: (neurons[2 * i], neurons[2 * i + 1]) for i, step in enumerate(steps)}
        last = positions[-1]
        rows = []
        for k in nodes:
            up, down = largest[tuple(np.diff(k).tolist())]
            rows.append(_sum((1.0, up), (1.0, last), (-1.0, _constant(k[-1]))))
            rows.append(_sum((1.0, down), (-1.0, last), (1.0, _constant(k[-1]))))
        sides = chain.layer(rows)
        hats = chain.layer(
            [_sum((1.0, _constant(1.0)), (-1.0, sides[2 * i]), (-1.0, sides[2 * i + 1]))
             for i in range(len(nodes))]
        )  # fmt: skip
        values = self.values.astype(np.float64).tolist()
        return _sum(*zip(values, hats, strict=True))

    def apart(self) -> float:
        """Return the largest difference from linear interpolation, before rounding."""
        corners = self.table.values
        size = corners.ndim
        total = np.zeros([max(1, length - 1) for length in corners.shape])
        for axes in _subsets(size):
            mixed = corners
            for axis in range(size):
                if corners.shape[axis] < 2:
                    mixed = mixed * (axis not in axes)
                elif axis in axes:
                    mixed = np.diff(mixed, axis=axis)
                else:
                    mixed = mixed.take(range(corners.shape[axis] - 1), axis)
            k = len(axes)
            total += np.abs(mixed) * k ** (-1 / (k - 1)) * (1 - 1 / k)
        return float(total.max())

    def inputs_near(self, k: int, dense: NDArray[np.float64]) -> Reals:
        """Return the levels of an axis, points between them and points outside."""
        levels = np.array(self.table.axes[k].levels)
        width = float(levels[-1] - levels[0]) or 1.0
        between = [levels[:-1] + share * np.diff(levels) for share in (0.25, 0.5, 0.577, 0.8)]
        points = np.concatenate([levels, *between, [levels[0] - width, levels[-1] + width]])
        return np.unique(points.astype(self.precision.outside))

    def evaluate(self, *inputs: Any) -> Reals:
        """Return the outputs of the network, by the reference evaluator of ONNX."""
        columns = np.broadcast_arrays(*(np.asarray(x, self.precision.outside) for x in inputs))
        given = np.stack([column.ravel() for column in columns], axis=1)
        (found,) = self._session.run(None, {"inputs": given})
        return np.asarray(found).reshape(columns[0].shape)

    @cached_property
    def _session(self) -> Any:
        from onnx.reference import ReferenceEvaluator

        return ReferenceEvaluator(self.model("network", ()))

    def remarks(self) -> list[str]:
        """Return the header's lines on numbers."""
        apart = outward_text(self.apart() * (1.0 + 1e-12), up=True, digits=6)
        return [
            f"{self.precision.outside.__name__} numbers; inputs are finite",
            f"differs from linear interpolation by at most {apart}, in units of the output, before"
            " rounding",
        ]

    def model(self, name: str, words: Sequence[str]) -> Any:
        """Return the network in ONNX, from `inputs`, a row for each point, to `output`."""
        from onnx import TensorProto, helper, numpy_helper

        kind = TensorProto.FLOAT if self.precision.outside is np.float32 else TensorProto.DOUBLE
        nodes, weights, last = [], [], "inputs"
        for i, pair in enumerate(self.layers, 1):
            rectified = i < len(self.layers)
            names = [f"weights_{i}", f"bias_{i}"]
            weights += [numpy_helper.from_array(x, key) for x, key in zip(pair, names, strict=True)]
            linear = f"sums_{i}" if rectified else "output"
            nodes.append(helper.make_node("Gemm", [last, *names], [linear], transB=1))
            if rectified:
                last = f"neurons_{i}"
                nodes.append(helper.make_node("Relu", [linear], [last]))
        graph = helper.make_graph(
            nodes,
            name,
            [helper.make_tensor_value_info("inputs", kind, ["points", len(self.table.axes)])],
            [helper.make_tensor_value_info("output", kind, ["points", 1])],
            weights,
        )
        return helper.make_model(
            graph,
            opset_imports=[helper.make_opsetid("", OPSET)],
            ir_version=IR_VERSION,
            producer_name="fuzzyarm",
            producer_version=__version__,
            doc_string="\n".join(words),
        )


@dataclass(frozen=True, eq=False)
class NetworkRoutine(TableRoutine):
    """A table as a network."""

    core: NetworkTable

    def cost(self) -> CallCost:
        """Return the cost of one evaluation, without the products with 0."""
        layers = self.core.layers
        rectifiers = sum(bias.size for _, bias in layers[:-1])
        products = sum(int(np.count_nonzero(weights)) for weights, _ in layers)
        return CallCost((("rectifiers", rectifiers), ("multiplications", products)), 0)


def _subsets(axes: int) -> Iterator[tuple[int, ...]]:
    """Yield all choices of two axes or more."""
    for count in range(2, axes + 1):
        yield from itertools.combinations(range(axes), count)


def network_of(routines: Sequence[Any]) -> NetworkRoutine:
    """Return the network of a table.

    ExportError if it is not a single interpolated table of floating-point numbers,
    MissingExtraError without the package onnx.
    """
    demand_extra("onnx", "onnx", "a network (.onnx)")
    if len(routines) != 1:
        names = ", ".join(routine.output.name for routine in routines)
        raise ExportError(f"a network has one output, not {names}", hint="choose one by --output")
    (routine,) = routines
    core = getattr(routine, "core", None)
    if not isinstance(core, FloatTable):
        raise ExportError("a network is made of a table in floating point", hint=_HINT)
    if not core.linear:
        raise ExportError(f"a network is continuous, and '{core.mode}' jumps", hint=_HINT)
    if core.table.values.size > MOST_NODES:
        raise ExportError(
            f"the table has {core.table.values.size:,} cells; a network is made of at most"
            f" {MOST_NODES:,}",
            hint=fewer_levels(len(core.table.axes), MOST_NODES),
        )
    fields = {key: getattr(core, key) for key in ("table", "mode", "points", "values", "precision")}
    return NetworkRoutine(NetworkTable(**fields))


_HINT = "leave out --direct, --q and --mode"


def network_bytes(routine: NetworkRoutine, name: str) -> bytes:
    """Return the file of a network."""
    words = routine_words(routine)
    inputs = ", ".join(argument.name for argument in routine.arguments)
    model = routine.core.model(name, [MADE, f"inputs: {inputs}", *map(plain, words)])
    return bytes(model.SerializeToString(deterministic=True))
