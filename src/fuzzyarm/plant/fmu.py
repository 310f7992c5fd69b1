"""A functional mock-up unit (FMI 2 or 3) as a plant, run by FMPy."""

from __future__ import annotations

import ctypes
import math
import shutil
import weakref
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np

from fuzzyarm.base.errors import demand_extra
from fuzzyarm.base.protected import note_source
from fuzzyarm.plant.control_systems import rate_of
from fuzzyarm.plant.plant import Parameter, Plant, PlantError, Port, parameter

REAL = ("Real", "Float64", "Float32")
"""Types of port variables; FMI 2 has one, FMI 3 two."""

MOST_EVENTS = 100
"""Largest number of event iterations at the start."""


class UnitPlant(Plant):
    """An FMU as a plant: co-simulation if supported, otherwise model exchange.

    In co-simulation the FMU advances itself from period to period. In model exchange its continuous
    states are integrated by fourth-order Runge-Kutta steps; events are not supported there. Real
    variables of causality ``input`` and ``output`` are the ports, real parameters the parameters;
    direct feedthrough uses the input of the period before.

    Parameters
    ----------
    path : str
        Path of the ``.fmu`` file.
    longest_step : float, optional
        Communication or integration step, s; a control period by default.

    Raises
    ------
    OSError
        If the file cannot be read.
    PlantError
        If FMPy cannot run it on this machine, or it has no real input or output.
    MissingExtraError
        If FMPy is not installed.
    """

    def __init__(self, path: str, *, longest_step: float = math.inf) -> None:
        demand_extra("fmpy", "plants", "an FMU")
        self.path = str(path)
        self.description = description = _described(self.path)
        self.exchanges = description.coSimulation is None
        self.name = description.modelName or Path(self.path).stem
        self.longest_step = longest_step
        scalars = [variable for variable in description.modelVariables if variable.type in REAL]
        shaped = next((scalar for scalar in scalars if scalar.dimensions), None)
        if shaped is not None:
            message = f"variable '{shaped.name}' of {self.name} is an array, which is not supported"
            raise PlantError(message, name=shaped.name)
        drives = [scalar for scalar in scalars if scalar.causality == "input"]
        outputs_found = [scalar for scalar in scalars if scalar.causality == "output"]
        for what, variable in (("inputs", drives), ("outputs", outputs_found)):
            if not variable:
                raise PlantError(f"{self.name} has no {what} that are real numbers", name=what)
        self._of_inputs = _References(drives)
        self._of_outputs = _References(outputs_found)
        names = [variable.name for variable in outputs_found]
        self.inputs = {drive.name: _port(drive) for drive in drives}
        self.outputs = {
            variable.name: _port(variable, rate_of(variable.name, names))
            for variable in outputs_found
        }
        self._tunable = {scalar.name: scalar for scalar in scalars if _is_parameter(scalar)}
        self.parameters = {
            name: Parameter(float(variable.start), variable.unit or "1", variable.description or "")
            for name, variable in self._tunable.items()
        }
        self._instance: Any = None
        self._folder = ""
        if self.exchanges:
            self._exchange(description)
        else:
            self.states = {variable.name: variable.unit or "1" for variable in outputs_found}
            self.step = self._do_step
            stop = getattr(description.defaultExperiment, "stopTime", None)
            self.duration = float(stop) if stop else None

    def _exchange(self, description: Any) -> None:
        events = description.numberOfEventIndicators
        if events:
            message = (
                f"{self.name} has events ({events} indicators), which are not supported in "
                "model exchange"
            )
            raise PlantError(message, name=self.name, hint="export it for co-simulation")
        count = int(description.numberOfContinuousStates or 0)
        self.states = {f"state{index + 1}": "1" for index in range(count)}
        self._states = (ctypes.c_double * count)()
        self._slopes = (ctypes.c_double * count)()
        self.derivative = self._slope
        self.measure = self._measure

    # Copies (with other parameters) and other processes start their own instance.

    def __copy__(self) -> UnitPlant:
        return _again(self.path, self.longest_step, self.parameters, self.inputs)

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        return _again, (self.path, self.longest_step, self.parameters, self.inputs)

    # --- Running ---

    def start(self, rng: np.random.Generator) -> Sequence[float]:
        """Start a new instance; return its outputs, or its continuous states."""
        unit = self._new_instance()
        self.ended = False
        two = self.description.fmiVersion == "2.0"
        if two:
            unit.setupExperiment(startTime=0.0)
        values = [parameter(self, name).value for name in self._tunable]
        _References(list(self._tunable.values())).write(unit, values)
        if two:
            unit.enterInitializationMode()
        else:
            unit.enterInitializationMode(startTime=0.0)
        self._of_inputs.write(unit, [port.idle for port in self.inputs.values()])
        unit.exitInitializationMode()
        if not self.exchanges:
            return self._of_outputs.read(unit)
        self._settle(unit)
        unit.getContinuousStates(self._states, len(self._states))
        return list(self._states)

    def _settle(self, unit: Any) -> None:
        """Leave the event mode, the initial one in model exchange."""
        for _ in range(MOST_EVENTS):
            news = unit.newDiscreteStates if hasattr(unit, "newDiscreteStates") else None
            again = (news or unit.updateDiscreteStates)()[0]
            if not again:
                break
        unit.enterContinuousTimeMode()

    def _new_instance(self) -> Any:
        import fmpy

        try:
            if not self._folder:
                self._folder = fmpy.extract(self.path)
                weakref.finalize(self, shutil.rmtree, self._folder, ignore_errors=True)
            self._free()
            kind = "ModelExchange" if self.exchanges else "CoSimulation"
            self._instance = fmpy.instantiate_fmu(self._folder, self.description, kind)
        except Exception as error:  # FMPy raises plain Exception, the loader anything
            message = f"{self.path} cannot be started: {_in_one_line(error)}"
            raise PlantError(message, name=self.name) from error
        weakref.finalize(self, _freed, self._instance)
        return self._instance

    def _free(self) -> None:
        if self._instance is not None:
            _freed(self._instance)
            self._instance = None

    def _do_step(self, t: float, x: Any, u: Any, p: Any, dt: float) -> Sequence[float]:
        self._of_inputs.write(self._instance, u)
        status = self._instance.doStep(currentCommunicationPoint=t, communicationStepSize=dt)
        self.ended = bool(status and status[1])  # FMI 3: termination requested
        return self._of_outputs.read(self._instance)

    def _put(self, t: float, x: Any, u: Any) -> Any:
        unit = self._instance
        unit.setTime(t)
        self._states[:] = x
        unit.setContinuousStates(self._states, len(self._states))
        self._of_inputs.write(unit, u)
        return unit

    def _slope(self, t: float, x: Any, u: Any, p: Any) -> Sequence[float]:
        unit = self._put(t, x, u)
        two = self.description.fmiVersion == "2.0"
        reader = unit.getDerivatives if two else unit.getContinuousStateDerivatives
        reader(self._slopes, len(self._slopes))
        return list(self._slopes)

    def _measure(self, t: float, x: Any, u: Any, p: Any) -> Sequence[float]:
        return self._of_outputs.read(self._put(t, x, u))


class _References:
    """Value references of variables, grouped by type for the calls."""

    def __init__(self, variables: Sequence[Any]) -> None:
        self._kinds: dict[str, list[int]] = {}
        for index, variable in enumerate(variables):
            self._kinds.setdefault(variable.type, []).append(index)
        self._references = [variable.valueReference for variable in variables]

    def write(self, unit: Any, values: Sequence[float]) -> None:
        for kind, places in self._kinds.items():
            numbers = [float(values[index]) for index in places]
            getattr(unit, f"set{kind}")([self._references[index] for index in places], numbers)

    def read(self, unit: Any) -> list[float]:
        numbers = [0.0] * len(self._references)
        for kind, places in self._kinds.items():
            values = getattr(unit, f"get{kind}")([self._references[index] for index in places])
            for index, value in zip(places, values, strict=True):
                numbers[index] = float(value)
        return numbers


def _described(path: str) -> Any:
    import fmpy

    note_source(path)
    if not Path(path).is_file():
        raise FileNotFoundError(2, "No such file or directory", path)
    try:
        description = fmpy.read_model_description(path)
    except Exception as error:  # a damaged archive may raise anything
        raise PlantError(f"{path} is not an FMU: {_in_one_line(error)}", name=path) from error
    if description.fmiVersion != "2.0" and not description.fmiVersion.startswith("3."):
        raise PlantError(f"{path} uses FMI {description.fmiVersion}, not 2.0 or 3", name=path)
    if description.coSimulation is None and description.modelExchange is None:
        raise PlantError(f"{path} is neither for co-simulation nor for model exchange", name=path)
    return description


def _port(variable: Any, rate: str = "") -> Port:
    low = -math.inf if variable.min is None else float(variable.min)
    high = math.inf if variable.max is None else float(variable.max)
    return Port(variable.unit or "1", low, high, rate_of=rate)


def _is_parameter(variable: Any) -> bool:
    settable = variable.variability in ("fixed", "tunable")
    return variable.causality == "parameter" and settable and variable.start is not None


def _in_one_line(error: Exception) -> str:
    """Return the first sentences of an error of FMPy, which may be a list."""
    lines = [line.strip(" -.") for line in str(error).splitlines() if line.strip()]
    return " ".join(lines[:2]) or type(error).__name__


def _freed(unit: Any) -> None:
    """Free an instance; idempotent."""
    if getattr(unit, "component", None):
        unit.terminate()
        unit.freeInstance()
        unit.component = None


def _again(path: str, longest_step: float, parameters: Any, inputs: Any) -> UnitPlant:
    plant = UnitPlant(path, longest_step=longest_step)
    plant.parameters, plant.inputs = cast(Any, parameters), cast(Any, inputs)
    return plant
