"""A python-control system as a plant; a plant, or a controller as text, as such a system."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, cast

import numpy as np

from fuzzyarm.base.errors import demand_extra
from fuzzyarm.plant.actuators import advance, dead_time, limit
from fuzzyarm.plant.plain_python import plain_motion, plain_outputs
from fuzzyarm.plant.plant import (
    CLOCK_SIZE,
    WORK,
    Address,
    Parameter,
    Plant,
    PlantError,
    Port,
    interface_of,
    numbers_of,
)
from fuzzyarm.plant.setting import RunArithmetic
from fuzzyarm.symbolic.kernels import with_names

RATES = {"velocity": "position", "v": "x", "omega": "theta", "speed": "position"}
"""Outputs that are rates of other outputs, by their usual names."""


# --- From python-control ---


def is_control_system(thing: Any) -> bool:
    """Whether an object is a system of python-control, which need not be installed."""
    return all(hasattr(thing, name) for name in ("ninputs", "noutputs", "input_labels", "dt"))


class ControlPlant(Plant):
    """A python-control system as a plant.

    A continuous system is integrated by fourth-order Runge-Kutta steps with constant inputs, a
    discrete one by its own difference equation and period. Direct feedthrough uses the input of the
    period before, which avoids an algebraic loop.

    Parameters
    ----------
    system : StateSpace, TransferFunction or NonlinearIOSystem
        With at least one input, one output and one state. The labels of its signals are the
        names of the ports, without brackets; a single ``u[0]`` is ``u``.
    limits : mapping of str to pair of float, optional
        Limits of the actuators, by input; none by default.
    start : sequence of float, optional
        Initial states; zeros by default.
    longest_step : float, optional
        Of the integrator, s; by default half of the shortest time constant of a linear system. A
        nonlinear system takes one step for each control period.

    Raises
    ------
    PlantError
        If the object is of another kind, or an improper transfer function.
    MissingExtraError
        If python-control is not installed.

    Examples
    --------
    >>> import control
    >>> motor = control.tf([2.15], [0.123, 1, 0], inputs="voltage", outputs="position")
    >>> plant = ControlPlant(motor, limits={"voltage": (-24, 24)})
    >>> plant.inputs["voltage"].high, list(plant.outputs)
    (24.0, ['position'])
    """

    def __init__(
        self,
        system: Any,
        *,
        limits: Mapping[str, tuple[float, float]] | None = None,
        start: Sequence[float] | None = None,
        longest_step: float | None = None,
    ) -> None:
        system = _with_states(system)
        self.system = system
        self.name = re.sub(r"[^\w+-]+", "", system.name) or "system"
        # Linear systems in plain loops: NumPy would take ten times as long.
        linear = hasattr(system, "A")
        self._rows = [_rows(getattr(system, matrix)) for matrix in "ABCD"] if linear else []
        self._start = None if start is None else [float(matrix) for matrix in start]
        bounds = {name: (float(low), float(high)) for name, (low, high) in (limits or {}).items()}
        names = _names(system.input_labels)
        for name in bounds:
            if name not in names:
                raise PlantError(f"{self.name} has no input '{name}'", name=name)
        self.inputs = {name: Port("1", *bounds.get(name, ())) for name in names}
        outputs = _names(system.output_labels)
        self.outputs = {name: Port(rate_of=rate_of(name, outputs)) for name in outputs}
        self.states = dict.fromkeys(_names(system.state_labels), "1")
        self.parameters = _parameters(system)
        self._fixed = {
            name: value for name, value in system.params.items() if name not in self.parameters
        }
        self.period = None if system.dt in (0, None, True) else float(system.dt)
        self.measure = self._linear_outputs if linear else self._outputs
        if system.dt in (0, None):
            self.derivative = self._linear_slope if linear else self._slope
            self.longest_step = _longest_step(system) if longest_step is None else longest_step
        else:
            self.step = self._step
            self.longest_step = self.period or math.inf

    def start(self, rng: np.random.Generator) -> Sequence[float]:
        """Return the initial states."""
        return [0.0] * len(self.states) if self._start is None else self._start

    def _params(self, p: Sequence[float]) -> dict[str, Any]:
        return {**self._fixed, **dict(zip(self.parameters, p, strict=True))}

    def _slope(self, t: float, x: Any, u: Any, p: Any) -> list[float]:
        rates = self.system.dynamics(t, x, u, params=self._params(p))
        return cast(list[float], np.asarray(rates, float).ravel().tolist())

    def _outputs(self, t: float, x: Any, u: Any, p: Any) -> list[float]:
        values = self.system.output(t, x, u, params=self._params(p))
        return cast(list[float], np.asarray(values, float).ravel().tolist())

    def _linear_slope(self, t: float, x: Any, u: Any, p: Any) -> list[float]:
        return _product(self._rows[0], x, self._rows[1], u)

    def _linear_outputs(self, t: float, x: Any, u: Any, p: Any) -> list[float]:
        return _product(self._rows[2], x, self._rows[3], u)

    def _step(self, t: float, x: Any, u: Any, p: Any, dt: float) -> list[float]:
        if self.period is not None and not math.isclose(dt, self.period, rel_tol=1e-6):
            raise PlantError(
                f"{self.name} is sampled every {self.period:g} s, not every {dt:g} s",
                name=self.name,
                hint=f"period {1000 * self.period:g} ms, or a multiple of it",
            )
        return self._linear_slope(t, x, u, p) if self._rows else self._slope(t, x, u, p)


def _with_states(system: Any) -> Any:
    """Return a system with states, converting a transfer function."""
    demand_extra("control", "plants", "a python-control system")
    import control

    if isinstance(system, control.TransferFunction):
        try:
            system = control.ss(
                system,
                inputs=system.input_labels,
                outputs=system.output_labels,
                name=system.name,
            )
        except Exception as error:  # MIMO without slycot, or improper
            message = f"the transfer function has no state space: {error}"
            raise PlantError(message, name=str(system.name)) from error
    if not is_control_system(system) or not hasattr(system, "dynamics"):
        message = f"{type(system).__name__} is not a system with states"
        raise PlantError(message, hint="StateSpace, TransferFunction or NonlinearIOSystem")
    for what, count in (
        ("inputs", system.ninputs),
        ("outputs", system.noutputs),
        ("states", system.nstates),
    ):
        if not count:
            raise PlantError(f"system {system.name} has no {what}", name=what)
    return system


def _names(labels: Sequence[str]) -> list[str]:
    """Return port names: ``u[0]`` and ``u[1]`` become ``u0`` and ``u1``, a single one ``u``."""
    if len(labels) == 1:
        return [re.sub(r"\[0\]$", "", labels[0])]
    return [re.sub(r"\[(\d+)\]", r"\1", label) for label in labels]


def rate_of(name: str, outputs: Sequence[str]) -> str:
    """Return the output whose rate, by the names, another output is, or ""."""
    axis, dot, port = name.rpartition(".")
    source = RATES.get(port, "")
    return source if source and axis + dot + source in outputs else ""


def _rows(matrix: Any) -> list[list[float]]:
    return cast(list[list[float]], np.asarray(matrix, float).tolist())


def _product(
    first: list[list[float]], x: Sequence[float], second: list[list[float]], u: Sequence[float]
) -> list[float]:
    """Return ``first x + second u``, each row summed from left to right."""
    values = []
    for a, b in zip(first, second, strict=True):
        total = 0.0
        for i in range(len(x)):
            total += a[i] * x[i]
        for i in range(len(u)):
            total += b[i] * u[i]
        values.append(total)
    return values


def _parameters(system: Any) -> dict[str, Parameter | float]:
    """Return the numeric parameters of a system."""
    return {
        name: Parameter(float(value))
        for name, value in system.params.items()
        if isinstance(value, (int, float)) and not isinstance(value, bool)
    }


def _longest_step(system: Any) -> float:
    """Return half of the shortest time constant of a linear system."""
    if not hasattr(system, "A"):
        return math.inf
    # RK4 is stable up to |λ| h = 2.78 on the negative real axis; ½ is accurate.
    fastest = float(np.max(np.abs(np.linalg.eigvals(np.asarray(system.A, float)))))
    return 0.5 / fastest if fastest > 0 else math.inf


# --- To python-control ---


def to_control(thing: Any, period: float | None = None, **options: Any) -> Any:
    """Return a plant or a controller as text as a discrete-time python-control system.

    Signals have the names of ports, ``axis_port`` with several axes; the reference of a controller
    is ``reference_`` and its name. So ``control.interconnect([plant, controller])`` joins them by
    name.

    Parameters
    ----------
    thing : Plant or ControllerText
        A plant is sampled: fourth-order Runge-Kutta steps with held inputs, limited in range and
        slew, and late by the dead times of their actuators. A controller has its states in those of
        the system: 0 in the first one (the default) resets it.
    period : float, optional
        Sampling period of a plant, s. A controller has its own.
    **options
        ``gains`` and ``single`` of a controller, see
        :class:`~fuzzyarm.control.controllers.text.ControllerRun`.

    Returns
    -------
    control.NonlinearIOSystem
        Discrete, with `period` as its ``dt``.

    Raises
    ------
    PlantError
        If a plant has no `period`, or is the arm, which has its own integrator.
    MissingExtraError
        If python-control is not installed.
    """
    demand_extra("control", "plants", "a python-control system")
    if isinstance(thing, Plant):
        if options:
            raise PlantError(f"a plant has no option '{next(iter(options))}'")
        return _system_of_plant(thing, period)
    if not hasattr(thing, "run"):
        message = f"{type(thing).__name__} is neither a plant nor a controller as text"
        raise PlantError(message)
    own_period = float(thing.model.period)
    if period is not None and period != own_period:
        message = f"{thing.model.name} runs every {own_period:g} s, not every {period:g} s"
        raise PlantError(message, name="period")
    return _system_of_controller(thing.run(**options), own_period)


def signal_name(port: str) -> str:
    """Return the name of a port for python-control: without dots."""
    return port.replace(".", "_")


def _system_of_plant(plant: Plant, period: float | None) -> Any:
    import control

    interface = interface_of(plant)
    if plant.derivative is None and plant.step is None:
        raise PlantError(f"{plant.name} has an integrator of its own", name=plant.name)
    if period is None or not 0 < period < math.inf:
        message = f"the period of {plant.name} is out of range: {period}"
        raise PlantError(message, name="period", hint="a number of seconds")
    states, size = len(plant.states), len(interface.outputs)
    move, measure = plain_motion(plant, states), plain_outputs(plant, states)
    numbers = numbers_of(plant, (), RunArithmetic())
    parts = max(1, math.ceil(period / plant.longest_step - 1e-9))
    ports = list(interface.inputs.values())
    # States of the system: those of the plant, then the last values of slew-limited inputs, then
    # of each late input its values of the periods before, youngest first.
    slewed = [index for index, port in enumerate(ports) if port.slew < math.inf]
    delays = [dead_time(port.dead_time, period) for port in ports]
    queues = [count + (rest > 0.0) for count, rest in delays]
    turns = sorted(range(len(ports)), key=lambda index: delays[index][1])

    def felt(x: Any, u: Any) -> tuple[Any, list[float], Any]:
        """Return the inputs as they act, dead times for the rest of the period, next states."""
        limits: Any = np.array([[p.low, p.high, p.slew * period, p.idle] for p in ports])
        limits[slewed, 3] = x[states : states + len(slewed)]
        drives: Any = np.array(u, float)
        limit(drives, limits.ravel(), False)
        last, lines = drives[slewed], np.split(x[states + len(slewed) :], np.cumsum(queues)[:-1])
        dead_times: list[float] = []
        for index, (queue, (_, rest), turn) in enumerate(zip(lines, delays, turns, strict=True)):
            line = [drives[index], *queue]
            lines[index] = np.array(line[:-1])
            dead_times += [0.0, rest, 0.0, line[-2] if rest else line[-1], turn]
            drives[index] = line[-1]
        return drives, dead_times, np.concatenate([last, *lines])

    def clock(t: float) -> Any:
        clock_values = np.zeros(CLOCK_SIZE)
        clock_values[:3] = t, period, parts
        return clock_values

    def moved(_task: int, _links: Any, *arrays: Any) -> None:
        move(*arrays)

    in_parts = with_names(advance, {"ask_plant": moved})

    def after(t: float, x: Any, u: Any, _params: Any) -> Any:
        drives, dead_times, rest = felt(x, u)
        # State array of the kernel: the states, then scratch for its Runge-Kutta steps.
        board = np.concatenate([x[:states], np.zeros(WORK * states)])
        in_parts([], board, None, drives, numbers, clock(t), dead_times, [], 0)
        return np.concatenate([board[:states], rest])

    def outputs(t: float, x: Any, u: Any, _params: Any) -> Any:
        measured = np.zeros(size)
        measure(np.asarray(x[:states], float), measured, felt(x, u)[0], numbers, clock(t))
        return measured

    names = {kind: _labels(interface, kind) for kind in ("inputs", "outputs")}
    labels = [signal_name(name) for name in plant.states]
    labels += [f"{names['inputs'][index]}_before" for index in slewed]
    labels += [
        f"{name}_pending{k + 1}"
        for name, count in zip(names["inputs"], queues, strict=True)
        for k in range(count)
    ]
    return control.nlsys(
        after, outputs, dt=period, name=signal_name(plant.name), states=labels, **names
    )


def _labels(interface: Any, kind: str) -> list[str]:
    ports: Mapping[Address, Port] = getattr(interface, kind)
    return [signal_name(interface.label(port)) for port in ports]


def _system_of_controller(run: Any, period: float) -> Any:
    # `run` is a fuzzyarm.control.controllers.text.ControllerRun, of a room below this one.
    import control

    cache: dict[str, Any] = {}
    references, measured = run.references, run.inputs

    def period_of(x: Any, u: Any) -> tuple[list[float], tuple[float, ...]]:
        """Run one period; python-control calls for outputs and states separately."""
        # One step gives both, so the last one is kept by its exact arguments.
        key = (np.asarray(x, float).tobytes(), np.asarray(u, float).tobytes())
        if cache.get("key") != key:
            run.state = tuple(float(value) for value in x)
            set_points = dict(zip(references, map(float, u), strict=False))
            is_now = dict(zip(measured, map(float, u[len(references) :]), strict=True))
            drives = run.step(is_now, set_points)
            cache.update(key=key, found=([drives[name] for name in run.drives], run.state))
        return cast(tuple[list[float], tuple[float, ...]], cache["found"])

    def after(_t: float, x: Any, u: Any, _params: Any) -> Any:
        return np.array(period_of(x, u)[1])

    def outputs(_t: float, x: Any, u: Any, _params: Any) -> Any:
        return np.array(period_of(x, u)[0])

    run.start()
    update: Callable[..., Any] = after
    return control.nlsys(
        update,
        outputs,
        dt=period,
        name=signal_name(run.text.model.name),
        states=len(run.state),
        inputs=[
            *(f"reference_{signal_name(name)}" for name in references),
            *map(signal_name, measured),
        ],
        outputs=[signal_name(name) for name in run.drives],
    )
