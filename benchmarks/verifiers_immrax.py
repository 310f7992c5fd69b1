"""The loop of `verifiers.py` by immrax: run by an interpreter that has it, with a network in ONNX.

Prints the bounds and times as JSON: the network is read, its loop embedded, and followed by Euler
steps of 1 ms.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import equinox as eqx
import immrax as irx
import jax
import jax.numpy as jnp
import numpy as np
import onnx
from immutabledict import immutabledict
from onnx import numpy_helper


class Pendulum(irx.OpenLoopSystem):  # type: ignore[misc]
    """The single pendulum of ARCH-COMP."""

    def __init__(self) -> None:
        self.evolution, self.xlen = "continuous", 2

    def f(self, _t: Any, x: Any, u: Any, _w: Any) -> Any:
        """Return the rates of angle and rate."""
        return jnp.array([x[1], 2.0 * jnp.sin(x[0]) + 8.0 * u[0]])


def parameters(net: Any) -> list[Any]:
    """Return weights and biases, layer by layer."""
    linear = [each for each in net.seq.layers if isinstance(each, eqx.nn.Linear)]
    return [array for each in linear for array in (each.weight, each.bias)]


def network(path: str, gains: list[float]) -> Any:
    """Read a chain of Gemm and Relu over a signal; the signal's gains go into its first layer."""
    arrays = [numpy_helper.to_array(each) for each in onnx.load(path).graph.initializer]
    arrays[0] = arrays[0] @ np.array([gains], arrays[0].dtype)
    sizes = [str(len(gains)), *(f"{bias.size} relu" for bias in arrays[1:-1:2]), "1"]
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "arch.txt").write_text(" ".join(sizes))
        empty = irx.NeuralNetwork(Path(folder), load=False)
    return eqx.tree_at(parameters, empty, [jnp.asarray(array) for array in arrays])


def main(path: str, given: str) -> None:
    """Print what is found."""
    task = json.loads(given)
    begin, end = task["time"]
    system = irx.NNCSystem(Pendulum(), network(path, task["gains"]))
    embedding = irx.NNCEmbeddingSystem(system, "crown", "local", "local")
    how = immutabledict(permutations=irx.standard_permutation(5), corners=irx.two_corners(5))
    nothing = irx.icentpert(jnp.zeros(1), jnp.zeros(1))
    low, high = (jnp.array(side) for side in zip(*task["start"], strict=True))

    def follow(x: Any) -> tuple[Any, Any]:
        course = embedding.compute_trajectory(
            0.0, end, x, (lambda _t, _x: nothing,), 0.001, solver="euler", f_kwargs=how
        )
        return course.ts, course.ys

    compiled, start = jax.jit(follow), irx.i2ut(irx.interval(low, high))
    seconds = [time.process_time()]
    for _ in range(2):  # the first call compiles
        times, states = jax.block_until_ready(compiled(start))
        seconds.append(time.process_time())
    times, states = np.asarray(times), np.asarray(states)
    late = (times >= begin - 1e-6) & (times <= end + 1e-6)
    found = {"low": float(states[late, 0].min()), "high": float(states[late, 2].max())}
    compiling, running = np.diff(seconds).tolist()
    print(json.dumps(found | {"compiling": compiling, "running": running}))


if __name__ == "__main__":
    main(*sys.argv[1:])
