"""Optimisers: Nelder-Mead, CMA-ES, differential evolution; points in the unit cube.

Each calls `ask` for the costs of points, one or many at a time, until `ask` raises to stop it. For
a seed the sequence of points is the same for any number of workers; so an interrupted search is
resumed by answering its first calls from the journal.

To add an optimiser, write such a function, its record here, and its name among the choices of
`method` in :class:`fuzzyarm.requests.TuneRequest`. Parameters that move together are
those of :mod:`.movement`; all are shares between 0 and 1 (:mod:`.design`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import demand_extra

Vector = NDArray[np.float64]

Ask = Callable[[Sequence[Vector]], list[float]]
"""From points to their costs. An exception from it ends the search."""


class Optimiser(NamedTuple):
    """A method by its name.

    Attributes
    ----------
    run : callable
        From `ask`, the first point and a seed; runs until `ask` raises an exception.
    doc : str
        One line.
    source : str
        Reference.
    batch : bool
        Whether it evaluates many points at a time.
    """

    run: Callable[[Ask, Vector, int], NoReturn]
    doc: str
    source: str
    batch: bool


FIRST_SIMPLEX = 0.08
"""Distance of the corners of the first simplex from the start, as a share of the unit cube."""

SMALLEST_SIMPLEX = 2e-4
"""Size of the simplex below which it is restarted."""


def nelder_mead(ask: Ask, start: Vector, seed: int) -> NoReturn:
    """Nelder-Mead simplex; restarted at the best point when it has shrunk.

    Adaptive to the number of dimensions (Gao and Han, Computational Optimization and Applications
    51, 2012), within bounds.
    """
    from scipy.optimize import minimize

    generator = np.random.default_rng(seed)
    size, best = FIRST_SIMPLEX, start
    trials: list[tuple[float, Vector]] = []

    def cost(point: Vector) -> float:
        (value,) = ask([point.copy()])
        trials.append((value, point.copy()))
        return value

    while True:
        # Random orientation: a restart in the same direction would repeat the collapse.
        signs = np.where(generator.random(len(start)) < 0.5, -1.0, 1.0)
        minimize(
            cost,
            best,
            method="Nelder-Mead",
            bounds=[(0.0, 1.0)] * len(start),
            options={
                "adaptive": True,
                "initial_simplex": simplex(best, size * signs),
                # SciPy stops when both hold: the simplex is small, and its costs are equal.
                "xatol": SMALLEST_SIMPLEX,
                "fatol": 0.0,
                "maxiter": 10**9,
                "maxfev": 10**9,
            },
        )
        # The best point so far need not be a corner of the simplex any more.
        value, best = min(trials, key=lambda trial: trial[0])
        trials = [(value, best)]
        size = float(generator.uniform(0.2, 1.0)) * FIRST_SIMPLEX


def simplex(corner: Vector, steps: Vector) -> Vector:
    """Return a corner and a neighbour along each axis, inwards if there is no room outwards."""
    values = np.tile(corner, (len(corner) + 1, 1))
    for at, step in enumerate(steps):
        beside = corner[at] + step
        values[at + 1, at] = beside if 0.0 <= beside <= 1.0 else corner[at] - step
    return values


FIRST_DEVIATION = 0.1
"""Standard deviation of the first generation, as a share of the unit cube."""


SEEDS = 2**32
"""Seeds of the package ``cma`` are below this."""


def cma_es(ask: Ask, start: Vector, seed: int) -> NoReturn:
    """CMA-ES: generations from a normal distribution with adapted covariance.

    Hansen, The CMA evolution strategy: a tutorial (arXiv 1604.00772); the package ``cma``. Where
    it has converged it begins again at the best point with half the deviation.
    """
    demand_extra("cma", "tune", "CMA-ES")
    import cma

    best, least, deviation = start, np.inf, FIRST_DEVIATION
    while True:
        # The package interprets a seed of 0 as the time of day, which no journal could resume.
        seed_ = seed % SEEDS or SEEDS - 1
        settings: dict[str, Any] = {"bounds": [0.0, 1.0], "seed": seed_, "verbose": -9}
        strategy = cma.CMAEvolutionStrategy(best.tolist(), deviation, settings)
        while not strategy.stop():
            points = [np.asarray(point) for point in strategy.ask()]
            costs = ask(points)
            strategy.tell(points, costs)
            if min(costs) < least:
                least = min(costs)
                best = points[int(np.argmin(costs))]
        seed += 1
        deviation = max(0.5 * deviation, 0.01)


PEOPLE = 4
"""Members of the population for each dimension."""


def differential_evolution(ask: Ask, start: Vector, seed: int) -> NoReturn:
    """Differential evolution, a generation at a time.

    Storn and Price, Journal of Global Optimization 11, 1997; the implementation is SciPy's. The
    file's values are a member of the first generation, the others are spread about them: half of
    them near, half over the whole cube.
    """
    from scipy.optimize import differential_evolution as evolve

    generator = np.random.default_rng(seed)
    first = start
    while True:
        count = max(8, PEOPLE * len(start))
        near = first + generator.normal(0.0, FIRST_DEVIATION, (count // 2, len(start)))
        far = generator.random((count - count // 2 - 1, len(start)))
        people = np.clip(np.vstack([first, near, far]), 0.0, 1.0)

        def costs(columns: Vector) -> Vector:
            # SciPy passes the generation with shape (parameters, members).
            return np.array(ask([np.array(column) for column in np.atleast_2d(columns.T)]))

        result = evolve(
            costs,
            [(0.0, 1.0)] * len(start),
            init=people,
            vectorized=True,
            updating="deferred",  # a whole generation at a time, independent of the workers
            polish=False,
            tol=1e-8,
            maxiter=10**7,
            rng=int(generator.integers(2**31)),
        )
        first = np.asarray(result.x)


OPTIMISERS: dict[str, Optimiser] = {
    "nelder-mead": Optimiser(
        nelder_mead,
        "a simplex from the file's values, with restarts",
        "Nelder and Mead 1965; SciPy",
        batch=False,
    ),
    "cma-es": Optimiser(
        cma_es, "generations that learn where to go", "Hansen 2016; cma", batch=True
    ),
    "evolution": Optimiser(
        differential_evolution,
        "differential evolution of a population",
        "Storn and Price 1997; SciPy",
        batch=True,
    ),
}
"""Every method by its name; the first is taken by default."""
