"""Analysis of a rule base without a run: describing function and phase portrait."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzyarm.base.errors import FuzzyarmError, demand_extra
from fuzzyarm.base.shown import Plotted, one_line
from fuzzyarm.control.controllers.controller import Controller
from fuzzyarm.control.controllers.on_plant import site_of
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.course import Options
from fuzzyarm.control.loop.reference import AnySignal, AnyTime, Signal, as_seconds, as_signals
from fuzzyarm.control.loop.run import AnyController, as_controller, text_of
from fuzzyarm.control.loop.simulation import simulate
from fuzzyarm.inference import infer
from fuzzyarm.language.model.controller import Drive, Learn, SignalLine
from fuzzyarm.language.model.rulebase import AnyRuleBase, RuleBase
from fuzzyarm.plant.adapters import EnvironmentPlant, UnitPlant
from fuzzyarm.plant.control_systems import rate_of
from fuzzyarm.plant.own import find_plant, start_of, starting_at
from fuzzyarm.plant.plant import Plant

Vector = NDArray[np.float64]


class AnalysisError(FuzzyarmError, ValueError):
    """No describing function or phase portrait of the object `name`."""

    def __init__(self, message: str, *, name: str, hint: str = "") -> None:
        super().__init__(message, hint=hint)
        self.name = name


# --- Describing functions ---

FEWEST, MOST = 256, 4_096
"""Samples per period: doubled from the first number until converged, up to the second."""


def describing_function(
    thing: AnyRuleBase | ControllerText,
    amplitudes: ArrayLike,
    frequency: float = 0.0,
    *,
    tolerance: float = 1e-5,
) -> NDArray[np.complex128]:
    """Return the sinusoidal-input describing function.

    Under the error ``A sin ωt`` the fundamental of the output is ``|N| A sin(ωt + arg N)``; higher
    harmonics are neglected, as a plant with low-pass behaviour attenuates them.

    Parameters
    ----------
    thing : RuleBase or ControllerText
        A rule base with one input, the error, or two: the error and its rate. Or a controller
        without states, with its gains and limits; its first error is the input, its
        first drive the output.
    amplitudes : array_like
        A, positive, in the unit of the error.
    frequency : float, optional
        ω, rad/s; matters for a rate input, which is ``A ω cos ωt``.
    tolerance : float, optional
        Convergence limit: change on doubling the samples, relative to the largest magnitude.

    Returns
    -------
    ndarray of complex, the shape of `amplitudes`
        N(A, ω).

    Raises
    ------
    AnalysisError
        If it has more inputs, or the controller has states.

    Examples
    --------
    >>> from fuzzyarm import load, shipped
    >>> n = describing_function(load(shipped("pd7.frb")), [0.5, 2.0, 12.0])
    >>> [round(float(abs(each)), 3) for each in n]
    [1.197, 0.979, 0.416]
    """
    sizes = np.atleast_1d(np.asarray(amplitudes, float))
    if not (np.all(sizes > 0.0) and np.all(np.isfinite(sizes)) and 0.0 <= frequency < math.inf):
        message = "amplitudes must be positive numbers, and a frequency zero or more"
        raise AnalysisError(message, name="amplitudes")
    answer = _static(thing)
    values = _fundamental(answer, sizes, frequency, FEWEST)
    points = 2 * FEWEST
    while points <= MOST:
        finer = _fundamental(answer, sizes, frequency, points)
        settled = np.max(np.abs(finer - values)) <= tolerance * np.max(np.abs(finer))
        values, points = finer, 2 * points
        if settled:
            break
    return values.reshape(np.shape(amplitudes))


def _fundamental(
    answer: Callable[[Vector, Vector], Vector], sizes: Vector, frequency: float, points: int
) -> NDArray[np.complex128]:
    """Return ``2/(n A) Σ f (sin + j cos)``, the midpoint rule: spectral accuracy for smooth f."""
    angle = 2.0 * np.pi * (np.arange(points) + 0.5) / points
    sine, cosine = np.sin(angle), np.cos(angle)
    error, rate = sizes[:, None] * sine, sizes[:, None] * frequency * cosine
    values = answer(error, rate)
    return np.asarray((values * (sine + 1j * cosine)).sum(axis=1) * 2.0 / (points * sizes))


def _static(thing: AnyRuleBase | ControllerText) -> Callable[[Vector, Vector], Vector]:
    """Return the output as a function of error and rate, arrays of one shape."""
    if isinstance(thing, AnyRuleBase):
        return _of_rulebase(thing.model)
    return _of_controller(thing)


def _of_rulebase(rulebase: RuleBase) -> Callable[[Vector, Vector], Vector]:
    names = [variable.name for variable in rulebase.inputs]
    output = rulebase.outputs[0].name
    if len(names) > 2:
        message = f"'{rulebase.name}' has {len(names)} inputs; error and its rate are two"
        raise AnalysisError(message, name=rulebase.name)

    def answer(error: Vector, rate: Vector) -> Vector:
        values = dict(zip(names, (error, rate), strict=False))
        return np.asarray(infer(rulebase, values, outputs=[output])[output], float)

    return answer


def _of_controller(text: ControllerText) -> Callable[[Vector, Vector], Vector]:
    model = text.model
    for _, line in model.lines():
        source = line.source if isinstance(line, SignalLine) else None
        if source is not None and (source.record.states or source.kind == "driven"):
            message = f"{model.name} remembers: it has '{source.kind}{source.record.joined}'"
            hint = "a describing function needs a controller without states"
            raise AnalysisError(message, name=model.name, hint=hint)
        if isinstance(line, Learn) or (isinstance(line, Drive) and line.slew is not None):
            what = "learns" if isinstance(line, Learn) else "limits a rate of change"
            raise AnalysisError(f"{model.name} remembers: it {what}", name=model.name)
    run = text.run()
    errors = [name for name in run.references if name in run.inputs]
    if not errors:
        message = f"{model.name} has no error of which it could be a function"
        raise AnalysisError(message, name=model.name)
    first, drive = errors[0], run.drives[0]
    rates = [name for name in errors if rate_of(name, errors) == first]
    measured = dict.fromkeys(run.inputs, 0.0)
    set_points = dict.fromkeys(run.references, 0.0)

    def answer(error: Vector, rate: Vector) -> Vector:
        values = np.empty(error.shape)
        for place in np.ndindex(error.shape):
            # The set points are 0: error = 0 - measured.
            measured[first] = -float(error[place])
            for name in rates:
                measured[name] = -float(rate[place])
            values[place] = run.step(measured, set_points)[drive]
        return values

    return answer


def nonlinearity(thing: AnyRuleBase | ControllerText) -> Any:
    """Return a rule base of one input, or a controller without rates, for python-control.

    The result is the ``F`` of :func:`control.describing_function_plot` and
    :func:`control.describing_function`.

    Parameters
    ----------
    thing : RuleBase or ControllerText
        As of :func:`describing_function`.

    Raises
    ------
    AnalysisError
        See :func:`describing_function`.
    MissingExtraError
        If python-control is not installed.
    """
    demand_extra("control", "plants", "a python-control nonlinearity")
    import control

    answer = _static(thing)

    class Rules(control.DescribingFunctionNonlinearity):  # type: ignore[misc]
        """A static nonlinearity whose describing function is a quadrature."""

        def __call__(self, value: float) -> float:
            at = np.array([float(value)])
            return float(answer(at, 0.0 * at)[0])

        def describing_function(self, A: float) -> complex:  # noqa: N803
            # python-control starts at amplitude zero, where N is the slope.
            return complex(describing_function(thing, max(float(A), 1e-9)))

        def _isstatic(self) -> bool:
            return True

    return Rules()


# --- Phase portraits ---


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Portrait(Plotted):
    """Trajectories from many starts in the plane of two quantities.

    Attributes
    ----------
    name : str
        The system.
    x, y : str
        Labels of the axes across and up, with units.
    paths : list of ndarray, shape (n, 2)
        One trajectory for each start, over time.
    target : pair of float
        The equilibrium; NaN where only the first coordinate is known.
    field : tuple of ndarray or None
        Grid across, grid up, and the rates of both there, shape (up, across); only for systems of
        second order.
    """

    name: str
    x: str
    y: str
    paths: list[Vector]
    target: tuple[float, float]
    field: tuple[Vector, Vector, Vector, Vector] | None = None

    def __repr__(self) -> str:
        return one_line(self, f"{self.name}: {len(self.paths)} motions, {self.y} over {self.x}")


STARTS = 12
"""Number of starts around the target."""

INTERVALS = 250
"""Time steps of the double integrator."""


def phase_portrait(
    thing: AnyRuleBase | AnyController,
    plant: Plant | str | os.PathLike[str] | None = None,
    *,
    reference: Mapping[str, AnySignal] | None = None,
    starts: Sequence[tuple[float, float]] | None = None,
    duration: AnyTime | None = None,
    options: Options | None = None,
) -> Portrait:
    """Return the phase portrait of a rule base alone, or of a controller on a plant.

    Parameters
    ----------
    thing : RuleBase, ControllerText, Controller, str or path-like
        A rule base with two inputs, error and its rate, needs no plant: it then drives a double
        integrator, ``ë = -u(e, ė)``.
    plant : Plant, str or path-like, optional
        Its first tracked output and the rate of that (or its second output) span the plane; both
        must be states. A string is its name or file.
    reference : mapping of str to Signal, str or float, optional
        As of :func:`simulate`; by default the middle of the tracked output's range.
    starts : sequence of pair of float, optional
        By default twelve around the target, within the ranges of inputs or ports.
    duration : float or str, optional
        s, or with its unit; by default the plant's own, and 20 s for a rule base alone.
    options : Options, optional
        Options of runs on a plant.

    Raises
    ------
    AnalysisError
        If no two states span a plane.
    """
    seconds = None if duration is None else as_seconds(duration, "duration")
    if isinstance(thing, AnyRuleBase):
        thing = thing.model
        if plant is not None:
            hint = (
                "a controller says what goes to which port;"
                " fuzzyarm new NAME --kind controller writes one"
            )
            message = f"'{thing.name}' is a rule base, which no plant can be driven by"
            raise AnalysisError(message, name=thing.name, hint=hint)
        return _of_double_integrator(thing, starts, seconds or 20.0)
    if plant is None:
        message = "a controller needs a plant for a phase portrait"
        raise AnalysisError(message, name="plant")
    plant = find_plant(plant)
    signals = as_signals(reference)
    return _on_plant(as_controller(thing), plant, signals, starts, seconds, options)


def _around(target: tuple[float, float], reach: tuple[float, float]) -> list[tuple[float, float]]:
    """Return starts on an ellipse."""
    angles = 2.0 * np.pi * np.arange(STARTS) / STARTS
    return [
        (target[0] + reach[0] * math.cos(a), target[1] + reach[1] * math.sin(a)) for a in angles
    ]


def _of_double_integrator(
    rulebase: RuleBase, starts: Sequence[tuple[float, float]] | None, duration: float
) -> Portrait:
    if len(rulebase.inputs) != 2:
        message = f"'{rulebase.name}' has {len(rulebase.inputs)} inputs; error and rate are two"
        raise AnalysisError(message, name=rulebase.name)
    answer = _of_rulebase(rulebase)
    first, second = rulebase.inputs
    reach = (0.8 * (first.high - first.low) / 2, 0.8 * (second.high - second.low) / 2)
    centre = ((first.high + first.low) / 2, (second.high + second.low) / 2)

    def slope(x: Vector) -> Vector:
        return np.column_stack([x[:, 1], -answer(x[:, 0], x[:, 1])])

    # All starts at once, by classical Runge-Kutta steps.
    x = np.array(starts or _around(centre, reach), float)
    h = duration / INTERVALS
    path = [x]
    for _ in range(INTERVALS):
        one = slope(x)
        two = slope(x + 0.5 * h * one)
        three = slope(x + 0.5 * h * two)
        x = x + h / 6.0 * (one + 2.0 * two + 2.0 * three + slope(x + h * three))
        path.append(x)
    paths = list(np.stack(path, axis=1))
    across = np.linspace(first.low, first.high, 25)
    up = np.linspace(second.low, second.high, 25)
    e, ce = np.meshgrid(across, up)
    return Portrait(
        name=f"{rulebase.name} on a double integrator",
        x=first.name,
        y=second.name,
        paths=paths,
        target=(0.0, 0.0),
        field=(across, up, ce, -answer(e, ce)),
    )


def _on_plant(
    controller: Controller,
    plant: Plant,
    references: Mapping[str, Signal] | None,
    starts: Sequence[tuple[float, float]] | None,
    duration: float | None,
    options: Options | None,
) -> Portrait:
    if isinstance(plant, EnvironmentPlant | UnitPlant):
        message = f"{plant.name} does not expose its states: it cannot be started from others"
        raise AnalysisError(message, name=plant.name)
    site = site_of(plant)
    interface = site.interface
    if references:
        tracked = interface.port(next(iter(references)))
    else:
        text = text_of(controller, site)
        errors = [
            (axes.names[0], line.source.name)
            for axes, line in text.model.lines()
            if isinstance(line, SignalLine) and line.source and line.source.kind == "error"
        ]
        measured = [site.find(text.model, "measured", error) for error in errors]
        tracked = measured[0] if measured else next(iter(interface.outputs))
    # The plane: the tracked output and its rate, or without a rate the next output.
    others = [port for port in interface.outputs if port != tracked]
    rates = [p for p in others if p[0] == tracked[0] and interface.outputs[p].rate_of == tracked[1]]
    pair = [interface.label(port) for port in (tracked, *(rates or others)[:1])]
    states = list(plant.states)
    if len(pair) < 2 or not all(name in states for name in pair):
        message = f"{plant.name} does not have two outputs that are states"
        raise AnalysisError(message, name=plant.name)
    ports = [interface.outputs[port] for port in (tracked, *(rates or others)[:1])]
    middle = [(p.low + p.high) / 2 if math.isfinite(p.high - p.low) else 0.0 for p in ports]
    reach = [0.35 * (p.high - p.low) if math.isfinite(p.high - p.low) else 1.0 for p in ports]
    references = references or {pair[0]: Signal("step", (middle[0],))}
    set_point = float(references[pair[0]].at(np.array([math.inf]))[0][0])
    target = (set_point, 0.0 if rates else math.nan)
    # All other states begin as the plant does.
    at_rest = start_of(plant, np.random.default_rng(0))
    paths = []
    for start in starts or _around((set_point, middle[1]), (reach[0], reach[1])):
        state = list(at_rest)
        for name, value in zip(pair, start, strict=True):
            state[states.index(name)] = float(value)
        there = starting_at(plant, state)
        run = simulate(controller, there, reference=references, duration=duration, options=options)
        paths.append(np.column_stack([run.outputs[name] for name in pair]))
    across, up = (f"{name}, {port.unit}" for name, port in zip(pair, ports, strict=True))
    return Portrait(
        name=f"{controller.name} on {plant.name}", x=across, y=up, paths=paths, target=target
    )
