"""Plants: ports, states, parameters and equations; their kernels for the closed loop."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.names import near_hint
from fuzzyarm.base.shown import one_line
from fuzzyarm.plant.equations import compiled_by_numba, has_numba, traced
from fuzzyarm.plant.setting import RunArithmetic
from fuzzyarm.symbolic.kernels import (
    address_of,
    call,
    has_machine_code,
    is_built,
    is_kernel,
    kernel,
)

if TYPE_CHECKING:
    from fuzzyarm.base.picture import Drawing
    from fuzzyarm.plant.trajectory import Trajectory


class PlantError(FuzzyarmError, ValueError):
    """A plant does not fit, or cannot be run; `name` is the port or quantity at fault."""

    def __init__(self, message: str, *, name: str = "", hint: str = "") -> None:
        super().__init__(message, hint=hint)
        self.name = name


# --- Ports and parameters ---


@dataclass(frozen=True)
class Port:
    """One quantity that a plant takes or gives.

    Parameters
    ----------
    unit : str, optional
        ``rad`` is shown in degrees.
    low, high : float, optional
        Of an input: the limits of the actuator. Of an output: the range of the sensor, over
        which its bits are spread and from which a check judges gains.
    slew : float, optional
        Of an input: the largest change, units for each second.
    start : float, optional
        Of an input: its value before the first control period, from which a slew begins. By
        default 0, or the limit next to 0.
    rate_of : str, optional
        Of an output: the port of the same axis whose rate it is. The reference of that rate
        follows from the reference of the port.
    bound : float, optional
        Of an output: beyond this magnitude the run has diverged. A value that is not a number is
        a sensor that fails while all states and drives are finite.
    error_bound : float, optional
        Of an output that follows: beyond this error the run has diverged, too.
    """

    unit: str = "1"
    low: float = -math.inf
    high: float = math.inf
    slew: float = math.inf
    rate_of: str = ""
    bound: float = 1e9
    error_bound: float = math.inf
    start: float | None = None

    def __post_init__(self) -> None:
        unit: object = self.unit
        if not isinstance(unit, str):
            hint = f'the unit comes first:  Port("1", {unit}, {self.low})'
            raise PlantError(f"the unit of a port must be text, not {unit!r}", hint=hint)
        for name in ("low", "high", "slew", "bound", "error_bound", "start"):
            value = getattr(self, name)
            if name == "start" and value is None:
                continue
            if isinstance(value, bool) or not isinstance(value, int | float | np.number):
                raise PlantError(f"{name} of a port is {value!r}, not a number", name=name)
        if not self.low < self.high:
            message = f"a port from {self.low:g} to {self.high:g} has no range"
            raise PlantError(message)
        if not self.slew > 0:
            raise PlantError(f"a slew of {self.slew:g} is out of range", hint="a positive number")
        if self.start is not None and not self.low <= self.start <= self.high:
            message = f"a start of {self.start:g} is outside {self.low:g} .. {self.high:g}"
            raise PlantError(message, name="start", hint="a value within the limits of the port")

    @property
    def idle(self) -> float:
        """Of an input: its value while nothing drives it; by default 0 or the limit next to 0."""
        return self.within(0.0 if self.start is None else self.start)

    def within(self, value: float) -> float:
        """Return a value brought into the limits."""
        return min(max(value, self.low), self.high)


@dataclass(frozen=True)
class Parameter:
    """A number of a plant that ``--set`` and ``--sweep`` may change.

    Parameters
    ----------
    value : float
        By default.
    unit : str, optional
        SI; "1" for none.
    meaning : str, optional
        What it is.
    """

    value: float
    unit: str = "1"
    meaning: str = ""


@dataclass(frozen=True)
class Particulars:
    """Properties of a plant that brings its own kernels.

    Attributes
    ----------
    extra : int
        Numbers behind its outputs that laws receive although they are not ports.
    room : int
        Numbers of its states and of the room behind them; 0 for what Runge-Kutta steps need.
    disturbed : tuple of str
        Inputs to which loads may be added; all where it is empty.
    options : tuple of str
        Options of a run that it knows beside those of every plant: ``torque_limits``,
        ``inductance``, ``supply``; ``conventions``, ``precision``, ``pi``, where its kernels round
        what they store.
    opponent : tuple of str
        A shipped linear controller, and its gains: what tuned controllers without rules have to
        beat.
    """

    extra: int = 0
    room: int = 0
    disturbed: tuple[str, ...] = ()
    options: tuple[str, ...] = ()
    opponent: tuple[str, ...] = ()


# --- What a user writes ---


class Plant:
    """Base of all plants. One of your own needs `inputs`, `outputs`, `states`, `derivative`.

    The equations may be a kernel (a function marked with :func:`fuzzyarm.symbolic.kernels.kernel`,
    which runs as machine code) or any plain Python.

    Attributes
    ----------
    name : str
        Under which it is reported.
    axis : str
        Name of its only axis. Where there are several, ports are called ``axis.port``.
    inputs, outputs : mapping of str to Port
        What it takes from a controller and what is measured. The first output is tracked where
        nothing else is asked for.
    states : mapping of str to str
        Names and units.
    parameters : mapping of str to Parameter or float
        In the order in which the equations find them.
    longest_step : float
        Longest step of the integrator, s; a longer control period is divided.
    duration : float or None
        Of a run where nothing else is asked for, s.
    trajectories : mapping of str to Trajectory or callable
        What it can follow besides references, by name; the first where nothing else is asked
        for. A function makes one of its arguments ``angles``, ``segment`` and ``hold``, those
        that it has.
    compared_along : tuple of str
        Trajectories by which controllers are compared and tuned; all where it is empty.
    loaded_parameters : mapping of str to float
        Those with the load that it carries where a trajectory says so; others stay.
    ended : bool
        Set by a plant in plain Python to end the run, as an episode does.

    Examples
    --------
    >>> class Kiln(Plant):
    ...     name = "kiln"
    ...     inputs = {"power": Port("%", 0, 100)}
    ...     outputs = {"temperature": Port("°C")}
    ...     states = {"T": "°C"}
    ...     parameters = {"loss": 0.01}
    ...
    ...     def derivative(self, t, x, u, p):
    ...         return [0.2 * u[0] - p[0] * (x[0] - 20.0)]
    >>> Kiln().derivative(0.0, [20.0], [50.0], [0.01])
    [10.0]
    """

    name: str = ""
    summary: ClassVar[str] = ""
    axis: str = ""
    inputs: Mapping[str, Port] = MappingProxyType({})
    outputs: Mapping[str, Port] = MappingProxyType({})
    states: Mapping[str, str] = MappingProxyType({})
    parameters: Mapping[str, Parameter | float] = MappingProxyType({})
    longest_step: float = math.inf
    duration: float | None = None
    trajectories: Mapping[str, Trajectory | Callable[..., Trajectory]] = MappingProxyType({})
    compared_along: tuple[str, ...] = ()
    loaded_parameters: Mapping[str, float] = MappingProxyType({})
    ended: bool = False

    def __repr__(self) -> str:
        ports = f"{', '.join(self.inputs) or 'nothing'} → {', '.join(self.outputs) or 'nothing'}"
        return one_line(self, f"{self.name}: {ports}")

    def start(self, rng: np.random.Generator) -> Sequence[float]:
        """Return the states at the start; zeros by default."""
        return [0.0] * len(self.states)

    # One of these two. `t` is the time, s; `x` the states, `u` the inputs and `p` the parameters,
    # each in the order of its mapping.
    derivative: Callable[..., Sequence[float]] | None = None
    """``derivative(t, x, u, p)``: the rate of each state."""

    step: Callable[..., Sequence[float]] | None = None
    """``step(t, x, u, p, dt)``: the states after `dt` seconds."""

    measure: Callable[..., Sequence[float]] | None = None
    """``measure(t, x, u, p)``: the outputs; by default the first states."""

    random_trajectory: Callable[[np.random.Generator], Trajectory] | None = None
    """``random_trajectory(rng)``: a move to tune on; by default one to compare along, scaled."""

    draw: Callable[..., Drawing] | None = None
    """``draw(scene)``: what it looks like at a sample of a run, see
    :class:`fuzzyarm.plant.drawings.PlantScene`; by default it has curves alone."""

    dynamics: Callable[..., Dynamics] | None = None
    """Of a plant that brings its own kernels, see :func:`dynamics_of`."""

    particulars: ClassVar[Particulars] = Particulars()
    """Properties of such a plant."""

    def with_options(self, options: DriveOptions) -> Self:
        """Return it with the drives that the options of a run ask for."""
        return self

    @classmethod
    def variants(cls) -> Sequence[Plant]:
        """Return a plant of this class for each kernel that it has."""
        return [cls()]


class DriveOptions(Protocol):
    """Options of a run about the drives of a plant that has them."""

    @property
    def torque_limits(self) -> tuple[float, float]:
        """Largest torques, N m."""

    @property
    def inductance(self) -> float:
        """Of each armature, H."""

    @property
    def supply(self) -> float:
        """Largest voltage at a motor, V."""


# --- How controllers see it ---

Address = tuple[str, str]
"""Axis and port."""


@dataclass(frozen=True)
class ReferenceQuantity:
    """A quantity for which a controller may ask a reference.

    Attributes
    ----------
    of : tuple of str
        Axis and port of the output whose reference is given.
    order : int
        0 for that reference, 1 for its rate, 2 for its acceleration.
    """

    of: Address
    order: int = 0


@dataclass(frozen=True)
class Interface:
    """The ports of a plant, by axis.

    Attributes
    ----------
    axes : tuple of str
        In the order of the outputs.
    inputs, outputs : mapping
        In the order of the plant's arrays.
    references : mapping
        What a controller may ask for, in the order of the loop's array.
    """

    axes: tuple[str, ...]
    inputs: Mapping[Address, Port]
    outputs: Mapping[Address, Port]
    references: Mapping[Address, ReferenceQuantity]

    def port(self, name: str) -> Address:
        """Return axis and port of an output or input that a user names."""
        all_ports = [*self.outputs, *self.inputs]
        ports = [address for address in all_ports if name in (address[1], ".".join(address))]
        if len(ports) == 1:
            return ports[0]
        names = [self.label(address) for address in all_ports]
        if ports:
            hint = " or ".join(self.label(address) for address in ports)
            raise PlantError(f"several axes have a port '{name}'", name=name, hint=hint)
        hint = near_hint(name, names)[0] or f"there are {', '.join(names)}"
        raise PlantError(f"no port '{name}'", name=name, hint=hint)

    def every_port(self, name: str) -> list[Address]:
        """Return the ports that a user means by a name: without an axis those of all axes."""
        same = [output for output in (*self.outputs, *self.inputs) if output[1] == name]
        return same or [self.port(name)]

    def label(self, port: Address) -> str:
        """Return how a port is called: without its axis where there is one only."""
        return port[1] if len(self.axes) == 1 else ".".join(port)


def interface_of(plant: Plant) -> Interface:
    """Sort the ports of a plant by axis."""
    _require_complete(plant)
    inputs = {_address(plant, name): port for name, port in plant.inputs.items()}
    outputs = {_address(plant, name): port for name, port in plant.outputs.items()}
    axes = tuple(dict.fromkeys(axis for axis, _ in (*outputs, *inputs)))
    references: dict[Address, ReferenceQuantity] = {}
    for address in outputs:
        references[address] = _reference(outputs, address)
    for (axis, name), port in outputs.items():
        third = (axis, "acceleration")
        if name == "velocity" and port.rate_of and third not in references:
            references[third] = ReferenceQuantity((axis, port.rate_of), 2)
    return Interface(axes, inputs, outputs, references)


def _address(plant: Plant, name: str) -> Address:
    axis, _, port = name.rpartition(".")
    return (axis or plant.axis or plant.name, port)


def _reference(outputs: Mapping[Address, Port], address: Address) -> ReferenceQuantity:
    axis, order = address[0], 0
    while outputs[address].rate_of:
        address = (axis, outputs[address].rate_of)
        order += 1
        if address not in outputs or order > 2:
            message = f"'{address[1]}' is not an output that has a rate"
            raise PlantError(message, name=address[1])
    return ReferenceQuantity(address, order)


def _require_complete(plant: Plant) -> None:
    name = plant.name or type(plant).__name__
    for what in ("name", "axis"):
        word = getattr(plant, what)
        if not isinstance(word, str):
            hint = f'{what} = "{word}"'
            raise PlantError(f"the {what} of plant {name} is not a text", name=what, hint=hint)
    for what in ("inputs", "outputs", "states"):
        if not getattr(plant, what):
            raise PlantError(f"plant {name} has no {what}", name=what)
    if plant.derivative is None and plant.step is None and plant.dynamics is None:
        hint = "derivative(self, t, x, u, p) returns the rate of each state"
        raise PlantError(f"plant {name} has no equations", name="derivative", hint=hint)
    if plant.measure is None and len(plant.outputs) > len(plant.states):
        message = f"plant {name} has {len(plant.outputs)} outputs and {len(plant.states)} states"
        raise PlantError(message, name="measure", hint="measure(self, t, x, u, p) returns outputs")


def parameter(plant: Plant, name: str) -> Parameter:
    """Return a parameter of a plant; PlantError if it has none of this name."""
    parameter = plant.parameters.get(name)
    if parameter is None:
        hint = near_hint(name, plant.parameters)[0]
        raise PlantError(f"{plant.name} has no parameter '{name}'", name=name, hint=hint)
    return parameter if isinstance(parameter, Parameter) else Parameter(float(parameter))


# --- Kernels: a plant as the loop calls it ---
#
# One kernel takes five arrays: x, the states and behind them room to work in; y, the outputs; u,
# the inputs; p, the parameters; and the clock, which says what to do, too. States, outputs and
# inputs are in the units of their ports and states (angles in rad), in the order of the mappings of
# the plant; parameters are in theirs. Where equations have no value (a root of what is negative, a
# division by zero) the rate is NaN or infinite, and so are the states from then on: the loop looks
# at the outputs after every period and ends such a run as one that has diverged.

TIME, STEP, PARTS, IN_SINGLE, TASK = range(5)
"""Cells of the clock: time, s; control period, s; steps of the integrator; single precision."""

CLOCK_SIZE = 5

MEASURE, ADVANCE, ACTUATE, DERIVE = range(4)
"""Tasks: outputs of the states; the states a control period on; of what a controller asks for what
drives the plant; what follows from outputs as sensors have them."""

WORK = 3
"""Numbers of room behind the states, for each state."""


@dataclass(frozen=True)
class Dynamics:
    """The kernel of a plant.

    Attributes
    ----------
    address : int
        Where the loop finds it.
    actuates : bool
        Whether it makes its drives itself; otherwise their limits do.
    extra : int
        How many numbers it derives, behind the outputs.
    kernel : callable, optional
        What stands at the address, for a loop into which it is compiled.
    bindings : mapping of str to callable
        What it is bound to.
    ports : tuple of int
        How many references, outputs (with those that it derives) and inputs it has.
    """

    address: int
    actuates: bool = False
    extra: int = 0
    kernel: Callable[..., None] | None = None
    bindings: Mapping[str, Callable[..., Any]] = field(default_factory=dict)
    ports: tuple[int, int, int] = (0, 0, 0)


@kernel
def derivative(t: float, x: list[float], u: list[float], p: list[float]) -> tuple[float, ...]:
    """Stand for the equations of a plant, which are bound to this name."""
    return (0.0,)


@kernel
def measure(t: float, x: list[float], u: list[float], p: list[float]) -> tuple[float, ...]:
    """Stand for the outputs of a plant, which are bound to this name."""
    return (0.0,)


@kernel
def find_slopes(
    t: float, x: list[float], u: list[float], p: list[float], slopes: list[float]
) -> None:
    """Fill in the rates of the states."""
    rates = derivative(t, x, u, p)
    for i in range(len(slopes)):
        slopes[i] = rates[i]


@kernel
def measure_states(
    x: list[float], y: list[float], u: list[float], p: list[float], clock: list[float]
) -> None:
    """Measure the first states."""
    for i in range(len(y)):
        y[i] = x[i]


@kernel
def measure_outputs(
    x: list[float], y: list[float], u: list[float], p: list[float], clock: list[float]
) -> None:
    """Measure what the plant says."""
    values = measure(clock[TIME], x[0 : len(x) // 4], u, p)
    for i in range(len(y)):
        y[i] = values[i]


@kernel
def run_plant(
    x: list[float], y: list[float], u: list[float], p: list[float], clock: list[float]
) -> None:
    """Do what the clock says with a plant of which there are equations."""
    if clock[TASK] == ADVANCE:
        runge_kutta_4(x, y, u, p, clock)
    else:
        measure_states(x, y, u, p, clock)


@kernel
def runge_kutta_4(
    x: list[float], y: list[float], u: list[float], p: list[float], clock: list[float]
) -> None:
    """Advance by classical fourth-order steps with the inputs held."""
    #     x(t + h) = x + h/6 (a + 2 b + 2 c + d)
    #     a = f(t, x)                 b = f(t + h/2, x + h/2 a)
    #     c = f(t + h/2, x + h/2 b)   d = f(t + h, x + h c)
    #
    # Behind the n states stand those at the start of the step, the weighted slopes, the slopes. One
    # loop over the states for each slope: all rates are found from the same states, before the
    # first of them moves.
    n = len(x) // 4
    states, slope = x[0:n], x[3 * n : 4 * n]  # the equations of a user may count from the end
    h = clock[STEP] / clock[PARTS]
    t = clock[TIME]
    for _ in range(int(clock[PARTS])):
        find_slopes(t, states, u, p, slope)
        for i in range(n):
            x[n + i] = x[i]
            x[2 * n + i] = slope[i]
            x[i] = x[n + i] + 0.5 * h * slope[i]
        find_slopes(t + 0.5 * h, states, u, p, slope)
        for i in range(n):
            x[2 * n + i] += 2.0 * slope[i]
            x[i] = x[n + i] + 0.5 * h * slope[i]
        find_slopes(t + 0.5 * h, states, u, p, slope)
        for i in range(n):
            x[2 * n + i] += 2.0 * slope[i]
            x[i] = x[n + i] + h * slope[i]
        t += h
        find_slopes(t, states, u, p, slope)
        for i in range(n):
            x[i] = x[n + i] + h / 6.0 * (x[2 * n + i] + slope[i])


ARRAYS = "fffff"
"""Of a kernel of a plant, see :func:`fuzzyarm.symbolic.kernels.address_of`."""


@kernel
def find_slopes_by_program(
    t: float, x: list[float], u: list[float], p: list[float], slopes: list[float]
) -> None:
    """Fill in the rates of the states by a program, whose address stands behind the parameters."""
    behind = len(p) - 2
    # The time goes over in the array that is filled: kernels make none, and what the program reads
    # is copied before it writes.
    slopes[0] = t
    call(int(p[behind]), slopes[0:1], x, u, p[0:behind], slopes)


@kernel
def measure_by_program(
    x: list[float], y: list[float], u: list[float], p: list[float], clock: list[float]
) -> None:
    """Measure what a program says, whose address stands behind that of the rates."""
    behind = len(p) - 2
    y[0] = clock[TIME]
    call(int(p[behind + 1]), y[0:1], x[0 : len(x) // 4], u, p[0:behind], y)


def is_compiled(plant: Plant) -> bool:
    """Whether the loop calls a plant by address: its equations are kernels, or traced."""
    if plant.dynamics is not None:
        return True
    if not has_machine_code():
        return _is_of_kernels(plant)
    return _is_built(plant) or is_traced(plant) or _is_for_numba(plant)


def _is_of_kernels(plant: Plant) -> bool:
    equations = [function for function in (plant.derivative, plant.measure) if function is not None]
    return plant.step is None and all(is_kernel(equation) for equation in equations)


def is_traced(plant: Plant) -> bool:
    """Whether the equations of a plant run as programs of operations."""
    if plant.dynamics is not None or plant.step is not None or not has_machine_code():
        return False
    return not _is_built(plant) and traced(plant) is not None


def _is_for_numba(plant: Plant) -> bool:
    """Whether the equations are kernels of a user that numba compiles."""
    return _is_of_kernels(plant) and not _is_built(plant) and has_numba()


def _is_built(plant: Plant) -> bool:
    """Whether the equations are part of the machine code."""
    return _is_of_kernels(plant) and is_built(*_bound(plant))


def _bound(plant: Plant) -> tuple[Callable[..., None], str, dict[str, Any]]:
    bindings: dict[str, Any] = {"derivative": plant.derivative}
    if plant.measure is not None:
        bindings |= {"measure_states": measure_outputs, "measure": plant.measure}
    return run_plant, ARRAYS, bindings


BY_PROGRAM: tuple[dict[str, Callable[..., Any]], ...] = (
    {"find_slopes": find_slopes_by_program},
    {"find_slopes": find_slopes_by_program, "measure_states": measure_by_program},
)
"""What a plant of traced equations is bound to: without and with outputs of its own."""


def dynamics_of(
    plant: Plant,
    arithmetic: RunArithmetic,
    *,
    finely: bool = False,
    address: Callable[..., int] | None = None,
) -> Dynamics:
    """Give the kernel of a plant an address.

    Parameters
    ----------
    plant : Plant
        Whose equations are kernels.
    arithmetic : RunArithmetic
        Of the run.
    finely : bool, optional
        Whether one with an integrator of its own is to move by Runge-Kutta steps, as all others.
    address : callable, optional
        Who is asked for the address of a function with bindings; by default
        :func:`fuzzyarm.symbolic.kernels.address_of`.
    """
    if address is None:
        address = _address_in(arithmetic)
    if plant.dynamics is not None:
        dynamics = plant.dynamics(arithmetic, address, finely=finely)
        interface = interface_of(plant)
        outputs = len(interface.outputs) + dynamics.extra
        return replace(dynamics, ports=(len(interface.references), outputs, len(interface.inputs)))
    if arithmetic.compiled and is_traced(plant):
        return Dynamics(address(run_plant, **BY_PROGRAM[plant.measure is not None]))
    function, types, bindings = _bound(plant)
    if arithmetic.compiled and _is_for_numba(plant):
        return Dynamics(address(compiled_by_numba(function, types, bindings)))
    return Dynamics(address(function, **bindings), kernel=function, bindings=bindings)


def _address_in(arithmetic: RunArithmetic) -> Callable[..., int]:
    def address(function: Callable[..., None], **bindings: Any) -> int:
        return address_of(function, ARRAYS, bindings, compiled=arithmetic.compiled)

    return address


# --- Its numbers ---


def numbers_of(
    plant: Plant, driven: Collection[Address], arithmetic: RunArithmetic
) -> NDArray[np.float64]:
    """Return the numbers that the equations of a plant read."""
    pack = getattr(plant, "pack", None)
    if pack is not None:
        return np.asarray(pack(driven, arithmetic), float)
    numbers = [parameter(plant, name).value for name in plant.parameters]
    if arithmetic.compiled and is_traced(plant):
        equations = traced(plant)
        assert equations is not None
        numbers += equations.addresses
    return np.array(numbers, float)


def with_actuators(plant: Plant, actuators: Mapping[str, Port]) -> Plant:
    """Return a plant with other actuators; by input, of every axis where none is named."""
    if plant.dynamics is not None:
        hint = "the options --limits and --supply bound its torques and voltages"
        raise PlantError(f"the {plant.name} makes its drives itself", name="actuator", hint=hint)
    interface = interface_of(plant)
    changed = dict(plant.inputs)
    names = {_address(plant, name): name for name in plant.inputs}
    for name, port in actuators.items():
        for address in interface.every_port(name):
            if address not in names:
                raise PlantError(f"'{name}' is an output, not an input", name=name)
            old = interface.inputs[address]
            start = port.start
            if start is None and old.start is not None:
                start = port.within(old.start)
            changed[names[address]] = replace(port, unit=old.unit, start=start)
    other = copy(plant)
    other.inputs = changed
    return other


def with_parameters(plant: Plant, values: Mapping[str, float]) -> Plant:
    """Return a plant with some parameters changed; what is set holds with its load, too."""
    changed = dict(plant.parameters)
    for name, value in values.items():
        old = parameter(plant, name)
        if not math.isfinite(value):
            raise PlantError(f"parameter {name} = {value} is out of range", name=name)
        changed[name] = replace(old, value=float(value))
    other = copy(plant)
    other.parameters = changed
    if plant.loaded_parameters is not Plant.loaded_parameters:
        others = plant.loaded_parameters.items()
        other.loaded_parameters = {name: value for name, value in others if name not in values}
    return other
