"""Identification of gains missing from the study, from its published figures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.apps.study.published import RMS_PLACES, PublishedRow, find_rows
from fuzzyarm.apps.study.reproduce import reproduce_row, row_controller
from fuzzyarm.base.errors import FuzzyarmError


class UnknownProblemError(FuzzyarmError, LookupError):
    """An unknown identification problem; `name` is its name."""

    def __init__(self, name: str) -> None:
        super().__init__(
            f"no gains of '{name}' were identified", hint=f"one of {', '.join(PROBLEMS)}"
        )
        self.name = name


@dataclass(frozen=True)
class Unknown:
    """An unknown gain."""

    gain: str  # its name
    joint: int | None  # index of its value; None for both
    start: float  # start of the search: a round number far from the result

    @property
    def label(self) -> str:
        """Name and joint."""
        return self.gain if self.joint is None else f"{self.gain}[{self.joint + 1}]"


@dataclass(frozen=True)
class IdentificationProblem:
    """Gains to find and the rows they must explain."""

    rows: tuple[str, ...]  # names of published rows
    unknowns: tuple[Unknown, ...]  # positive gains


PROBLEMS: dict[str, IdentificationProblem] = {
    "acdid+ie": IdentificationProblem(("acdid+ie",), (Unknown("K_I", None, 100.0),)),
    "mrac": IdentificationProblem(
        ("mrac",),
        (
            Unknown("K_1", None, 300.0),
            Unknown("K_2", None, 60.0),
            Unknown("a", None, 50.0),
            Unknown("b", None, 1.0),
        ),
    ),
    "mrac+ie": IdentificationProblem(("mrac+ie",), (Unknown("K_I", None, 5.0),)),
    "dac": IdentificationProblem(
        ("dac",),
        (
            Unknown("p_2", None, 1000.0),
            Unknown("p_3", None, 30.0),
            Unknown("C", 0, 1.0),
            Unknown("C", 1, 1.0),
        ),
    ),
    "dac+ie": IdentificationProblem(("dac+ie",), (Unknown("K_I", None, 20.0),)),
}
"""Identification problems by controller."""

FITTED_FIGURES = (0, 2, 4, 5, 6)
"""The RMS figures and the last figure of link 1; that of link 2 is chaotic in some rows."""

SMALLEST = 0.01
"""Published figures below this, in degrees, have too few digits for a fit."""

SHIFT = 20.0
"""Offset of the logarithms in the search, which keeps its relative steps away from zero."""

STEP = 0.02
"""Relative step of the finite differences: single precision makes the errors rough."""


@dataclass(frozen=True)
class Identified:
    """A fit.

    Attributes
    ----------
    name : str
        The controller.
    labels : tuple of str
        The unknowns.
    fitted : tuple of float
        The best values.
    spread : tuple of float
        Relative standard deviation of each by the curvature of the fit; large: weakly determined.
    shipped : tuple of float
        The values in the catalogue.
    fitted_rms, shipped_rms : tuple of float
        Relative differences of every RMS figure of every row, with either.
    evaluations : int
        Runs of all rows.
    """

    name: str
    labels: tuple[str, ...]
    fitted: tuple[float, ...]
    spread: tuple[float, ...]
    shipped: tuple[float, ...]
    fitted_rms: tuple[float, ...]
    shipped_rms: tuple[float, ...]
    evaluations: int


def identify(name: str, *, watch: Callable[[int], None] | None = None) -> Identified:
    """Fit the gains of a controller in :data:`PROBLEMS` to its published rows.

    `watch` is called with the number of evaluations so far.

    Parameters
    ----------
    name : str
        Name of a controller with unpublished gains.
    watch : callable, optional
        Called with the number of evaluations so far.

    Returns
    -------
    Identified
        The best gains, and how well the rows determine them.
    """
    from scipy.optimize import least_squares

    if name not in PROBLEMS:
        raise UnknownProblemError(name)
    problem = PROBLEMS[name]
    rows = find_rows(list(problem.rows))
    count = 0

    begin = np.array([unknown.start for unknown in problem.unknowns])

    def values(unknowns: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(begin * np.exp(unknowns - SHIFT))

    def residuals(unknowns: NDArray[np.float64]) -> NDArray[np.float64]:
        nonlocal count
        count += 1
        if watch is not None:
            watch(count)
        return _residuals(rows, problem.unknowns, values(unknowns))

    fit: Any = least_squares(
        residuals,
        np.full(len(begin), SHIFT),
        diff_step=STEP / SHIFT,
        bounds=(SHIFT - 3.0, SHIFT + 3.0),
        loss="soft_l1",
        f_scale=0.01,
        max_nfev=60,
    )
    fitted = values(fit.x)
    shipped = _shipped(rows[0], problem.unknowns)
    return Identified(
        name,
        tuple(unknown.label for unknown in problem.unknowns),
        tuple(float(value) for value in fitted),
        _spread(fit),
        tuple(float(value) for value in shipped),
        _rms_differences(rows, problem.unknowns, fitted),
        _rms_differences(rows, problem.unknowns, shipped),
        count,
    )


def _figures(
    row: PublishedRow, unknowns: Sequence[Unknown], values: NDArray[np.float64]
) -> NDArray[np.float64]:
    controller = row_controller(row)
    gains = {name: list(gain.value) for name, gain in controller.gains.items()}
    changed: dict[str, Sequence[float]] = {}
    for unknown, value in zip(unknowns, values, strict=True):
        numbers = gains[unknown.gain]
        for index in range(len(numbers)):
            if unknown.joint in {None, index}:
                numbers[index] = float(value)
        changed[unknown.gain] = numbers
    return np.array(reproduce_row(row, controller=controller.with_gains(changed)).figures)


def _residuals(
    rows: Sequence[PublishedRow], unknowns: Sequence[Unknown], values: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return relative differences of the figures; a diverged run counts as ten times off."""
    parts = []
    for row in rows:
        published = np.array(row.figures)
        fit_to = [i for i in FITTED_FIGURES if abs(published[i]) >= SMALLEST]
        ratio = _figures(row, unknowns, values)[fit_to] / published[fit_to] - 1.0
        parts.append(np.clip(np.nan_to_num(ratio, nan=10.0), -10.0, 10.0))
    return np.concatenate(parts)


def _rms_differences(
    rows: Sequence[PublishedRow], unknowns: Sequence[Unknown], values: NDArray[np.float64]
) -> tuple[float, ...]:
    places = list(RMS_PLACES)
    return tuple(
        float(value)
        for row in rows
        for value in _figures(row, unknowns, values)[places] / np.array(row.figures)[places] - 1.0
    )


def _shipped(row: PublishedRow, unknowns: Sequence[Unknown]) -> NDArray[np.float64]:
    gains = row_controller(row).gains
    return np.array([gains[unknown.gain].value[unknown.joint or 0] for unknown in unknowns])


def _spread(fit: Any) -> tuple[float, ...]:
    """Estimate relative standard deviations from the Jacobian over logarithms."""
    free = max(len(fit.fun) - len(fit.x), 1)
    covariance = np.linalg.pinv(fit.jac.T @ fit.jac) * (2.0 * fit.cost / free)
    return tuple(float(value) for value in np.sqrt(np.diag(covariance)))
