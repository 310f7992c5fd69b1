"""Plants: ports, states, parameters and equations; their kernels for the closed loop."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import FuzzyarmError, UsageError
from fuzzyarm.base.names import near_hint
from fuzzyarm.base.numbers import read_time
from fuzzyarm.base.shown import one_line
from fuzzyarm.plant.equations import compiled_by_numba, has_numba, is_of_package, traced
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
    """An invalid plant, or one that cannot run; `name` is the port or quantity at fault."""

    def __init__(self, message: str, *, name: str = "", hint: str = "") -> None:
        super().__init__(message, hint=hint)
        self.name = name


# --- Ports and parameters ---


@dataclass(frozen=True)
class Port:
    """An input or output of a plant.

    Parameters
    ----------
    unit : str, optional
        ``rad`` is displayed in degrees.
    low, high : float, optional
        Of an input: limits of the actuator. Of an output: range of the sensor, which its
        resolution divides and which scales the judgement of gains.
    slew : float, optional
        Of an input: largest rate of change, per second.
    start : float, optional
        Of an input: value before the first control period, where slewing begins. By default 0, or
        the limit nearest to 0.
    delay : float or str, optional
        Of an input: dead time of the actuator, s, or with its unit, as in ``"30ms"``; the value
        may change inside a control period.
    rate_of : str, optional
        Of an output: the port of the same axis whose rate it is. Its reference is the derivative
        of that port's.
    bound : float, optional
        Of an output: largest magnitude without divergence. A NaN value is a failed sensor while
        all states and drives are finite.
    error_bound : float, optional
        Of a tracked output: largest error without divergence.
    """

    unit: str = "1"
    low: float = -math.inf
    high: float = math.inf
    slew: float = math.inf
    rate_of: str = ""
    bound: float = 1e9
    error_bound: float = math.inf
    start: float | None = None
    delay: float | str = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "delay", _delay(self.delay))
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
    def dead_time(self) -> float:
        """The delay of an actuator, s."""
        return float(self.delay)

    @property
    def idle(self) -> float:
        """Value of an input without a drive; by default 0 or the limit nearest to 0."""
        return self.within(0.0 if self.start is None else self.start)

    def within(self, value: float) -> float:
        """Return a value clamped to the limits."""
        return min(max(value, self.low), self.high)


def _delay(delay: object) -> float:
    """Return a dead time in s."""
    try:
        seconds = read_time(delay, "the delay") if isinstance(delay, str) else delay
    except UsageError as error:
        raise PlantError(error.message, name="delay", hint='delay="30ms"') from None
    if isinstance(seconds, bool) or not isinstance(seconds, int | float | np.number):
        raise PlantError(f"delay of a port is {delay!r}, not a time", name="delay")
    if not 0.0 <= seconds < math.inf:
        hint = "zero or a positive number"
        raise PlantError(f"a delay of {seconds:g} s is out of range", name="delay", hint=hint)
    return float(seconds)


@dataclass(frozen=True)
class Parameter:
    """A number of a plant that ``--set`` and ``--sweep`` may change.

    Parameters
    ----------
    value : float
        Default.
    unit : str, optional
        SI; "1" for none.
    meaning : str, optional
        Description.
    """

    value: float
    unit: str = "1"
    meaning: str = ""


@dataclass(frozen=True)
class Particulars:
    """Properties of a plant with its own kernels.

    Attributes
    ----------
    extra : int
        Numbers after its outputs that laws receive although they are not ports.
    room : int
        Size of the state array with scratch; 0 for that of Runge-Kutta steps.
    disturbed : tuple of str
        Inputs that accept loads; empty means all.
    options : tuple of str
        Additional run options: ``torque_limits``, ``inductance``, ``supply``; ``conventions``,
        ``precision``, ``pi`` if its kernels round stored values.
    opponent : tuple of str
        A shipped linear controller with its gains: the benchmark for tuned controllers without
        rules.
    """

    extra: int = 0
    room: int = 0
    disturbed: tuple[str, ...] = ()
    options: tuple[str, ...] = ()
    opponent: tuple[str, ...] = ()


# --- The interface for users ---


class Plant:
    """Base class of plants. Your own needs `inputs`, `outputs`, `states`, `derivative`.

    The equations may be a kernel (a function marked with :func:`fuzzyarm.symbolic.kernels.kernel`,
    which runs as machine code) or any plain Python.

    Attributes
    ----------
    name : str
        Name in reports.
    axis : str
        Name of its only axis. With several axes, ports are called ``axis.port``.
    inputs, outputs : mapping of str to Port
        Driven and measured quantities. By default the first output is tracked.
    states : mapping of str to str
        Names and units.
    parameters : mapping of str to Parameter or float
        In the order of the argument `p` of the equations.
    longest_step : float
        Largest integration step, s; a longer control period is divided.
    duration : float or None
        Default duration of a run, s.
    trajectories : mapping of str to Trajectory or callable
        Trajectories by name; the first is the default. A maker is called with those of
        ``angles``, ``segment`` and ``hold`` that it accepts.
    compared_along : tuple of str
        Trajectories for comparing and tuning controllers; empty means all.
    loaded_parameters : mapping of str to float
        Parameters that differ with the load carried along a trajectory.
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

    def __init_subclass__(cls) -> None:
        # Ports and parameters of shipped plants are the same for all of a process.
        super().__init_subclass__()
        if is_of_package(cls):
            for name, value in list(vars(cls).items()):
                if isinstance(value, dict):
                    setattr(cls, name, MappingProxyType(value))

    def __repr__(self) -> str:
        ports = f"{', '.join(self.inputs) or 'nothing'} → {', '.join(self.outputs) or 'nothing'}"
        return one_line(self, f"{self.name or usual_name(self)}: {ports}")

    def start(self, rng: np.random.Generator) -> Sequence[float]:
        """Return the initial states; zeros by default."""
        return [0.0] * len(self.states)

    # One of the next two. `t` is the time, s; `x` the states, `u` the inputs and `p` the
    # parameters, each in the order of its mapping.
    derivative: Callable[..., Sequence[float]] | None = None
    """``derivative(t, x, u, p)``: the rate of each state."""

    step: Callable[..., Sequence[float]] | None = None
    """``step(t, x, u, p, dt)``: the states after `dt` seconds."""

    measure: Callable[..., Sequence[float]] | None = None
    """``measure(t, x, u, p)``: the outputs; by default the first states."""

    random_trajectory: Callable[[np.random.Generator], Trajectory] | None = None
    """``random_trajectory(rng)``: a move for tuning; default: one of `compared_along`, scaled."""

    draw: Callable[..., Drawing] | None = None
    """``draw(scene)``: a drawing of a sample of a run, see
    :class:`fuzzyarm.plant.drawings.PlantScene`; by default it has curves alone."""

    dynamics: Callable[..., Dynamics] | None = None
    """Maker of its own kernels, see :func:`dynamics_of`."""

    particulars: ClassVar[Particulars] = Particulars()
    """Properties of a plant with its own kernels."""

    def with_options(self, options: DriveOptions) -> Self:
        """Return the plant with the drives of the run options."""
        return self

    @classmethod
    def variants(cls) -> Sequence[Plant]:
        """Return a plant of this class for each of its kernels."""
        return [cls()]


class DriveOptions(Protocol):
    """Run options of a plant with motors."""

    @property
    def torque_limits(self) -> tuple[float, float]:
        """Largest joint torques, N m."""

    @property
    def inductance(self) -> float:
        """Armature inductance, H."""

    @property
    def supply(self) -> float:
        """Largest motor voltage, V."""


# --- The view of controllers ---

Address = tuple[str, str]
"""Axis and port."""


@dataclass(frozen=True)
class ReferenceQuantity:
    """A quantity that a controller may use as a reference.

    Attributes
    ----------
    of : tuple of str
        Axis and port of the output.
    order : int
        0 for its reference, 1 for the rate, 2 for the acceleration.
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
        Quantities available as references, in the order of the loop's array.
    """

    axes: tuple[str, ...]
    inputs: Mapping[Address, Port]
    outputs: Mapping[Address, Port]
    references: Mapping[Address, ReferenceQuantity]

    def port(self, name: str) -> Address:
        """Return axis and port of an output or input by its name."""
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
        """Return the ports of a name: without an axis those of all axes."""
        same = [output for output in (*self.outputs, *self.inputs) if output[1] == name]
        return same or [self.port(name)]

    def label(self, port: Address) -> str:
        """Return the name of a port, without its axis if there is only one."""
        return port[1] if len(self.axes) == 1 else ".".join(port)


def interface_of(plant: Plant) -> Interface:
    """Group the ports of a plant by axis."""
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


def usual_name(plant: Plant) -> str:
    """Return the name of a plant whose class states none."""
    return type(plant).__name__.lower()


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
    """Return a parameter of a plant; PlantError for an unknown name."""
    parameter = plant.parameters.get(name)
    if parameter is None:
        hint = near_hint(name, plant.parameters)[0]
        raise PlantError(f"{plant.name} has no parameter '{name}'", name=name, hint=hint)
    return parameter if isinstance(parameter, Parameter) else Parameter(float(parameter))


# --- Kernels: the calling convention of a plant in the loop ---
#
# One kernel takes five arrays: x, the states followed by scratch; y, the outputs; u, the inputs; p,
# the parameters; and the clock, which also holds the task. States, outputs and inputs are in the
# units of their ports (angles in rad), in the order of the plant's mappings. Where equations are
# undefined (the root of a negative number, a division by zero) the rate is NaN or infinite, and so
# are the states from then on: the loop tests the outputs after every period and ends such a run as
# diverged.

TIME, STEP, PARTS, IN_SINGLE, TASK = range(5)
"""Cells of the clock: time, s; control period, s; steps of the integrator; single precision."""

CLOCK_SIZE = 5

MEASURE, ADVANCE, ACTUATE, DERIVE = range(4)
"""Tasks: measure the outputs; advance the states by a control period; turn commands into drives;
derive further measurements from measured outputs."""

WORK = 3
"""Scratch after the states, numbers for each state."""


@dataclass(frozen=True)
class Dynamics:
    """The kernel of a plant.

    Attributes
    ----------
    address : int
        Address for calls from the loop.
    actuates : bool
        Whether it turns commands into drives itself; otherwise the loop limits them.
    extra : int
        Number of derived measurements, after the outputs.
    kernel : callable, optional
        The kernel itself, to be compiled into a loop.
    bindings : mapping of str to callable
        Its bindings.
    ports : tuple of int
        Numbers of references, outputs (with derived measurements) and inputs.
    """

    address: int
    actuates: bool = False
    extra: int = 0
    kernel: Callable[..., None] | None = None
    bindings: Mapping[str, Callable[..., Any]] = field(default_factory=dict)
    ports: tuple[int, int, int] = (0, 0, 0)


@kernel
def derivative(t: float, x: list[float], u: list[float], p: list[float]) -> tuple[float, ...]:
    """Stand in for the equations of a plant, to which this name is bound."""
    return (0.0,)


@kernel
def measure(t: float, x: list[float], u: list[float], p: list[float]) -> tuple[float, ...]:
    """Stand in for the outputs of a plant, to which this name is bound."""
    return (0.0,)


@kernel
def find_slopes(
    t: float, x: list[float], u: list[float], p: list[float], slopes: list[float]
) -> None:
    """Evaluate the rates of the states."""
    rates = derivative(t, x, u, p)
    for i in range(len(slopes)):
        slopes[i] = rates[i]


@kernel
def measure_states(
    x: list[float], y: list[float], u: list[float], p: list[float], clock: list[float]
) -> None:
    """Copy the first states to the outputs."""
    for i in range(len(y)):
        y[i] = x[i]


@kernel
def measure_outputs(
    x: list[float], y: list[float], u: list[float], p: list[float], clock: list[float]
) -> None:
    """Evaluate the output function."""
    values = measure(clock[TIME], x[0 : len(x) // 4], u, p)
    for i in range(len(y)):
        y[i] = values[i]


@kernel
def run_plant(
    x: list[float], y: list[float], u: list[float], p: list[float], clock: list[float]
) -> None:
    """Run the task in `clock[TASK]` for an ODE plant."""
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
    # After the n states: those at the start of the step, the weighted slopes, the slopes. One loop
    # over the states for each slope: all rates are evaluated at the same states, before any of them
    # moves.
    n = len(x) // 4
    states, slope = x[0:n], x[3 * n : 4 * n]  # slices: a user's equations may index from the end
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
"""Signature of a plant's kernel, see :func:`fuzzyarm.symbolic.kernels.address_of`."""


@kernel
def find_slopes_by_program(
    t: float, x: list[float], u: list[float], p: list[float], slopes: list[float]
) -> None:
    """Evaluate the rates by a program (its address follows the parameters)."""
    addresses = len(p) - 2  # of the derivative and of the outputs, after the parameters
    # The time is passed in the output array: kernels allocate none, and the program copies its
    # inputs before it writes.
    slopes[0] = t
    call(int(p[addresses]), slopes[0:1], x, u, p[0:addresses], slopes)


@kernel
def measure_by_program(
    x: list[float], y: list[float], u: list[float], p: list[float], clock: list[float]
) -> None:
    """Evaluate the output program (its address follows the derivative's)."""
    addresses = len(p) - 2  # of the derivative and of the outputs, after the parameters
    y[0] = clock[TIME]
    call(int(p[addresses + 1]), y[0:1], x[0 : len(x) // 4], u, p[0:addresses], y)


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
    """Whether the equations are a user's kernels for numba."""
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
"""Bindings of a traced plant: without and with its own outputs."""


def dynamics_of(
    plant: Plant,
    arithmetic: RunArithmetic,
    *,
    finely: bool = False,
    address: Callable[..., int] | None = None,
) -> Dynamics:
    """Make the kernel of a plant callable by address.

    Parameters
    ----------
    plant : Plant
        With kernels as equations.
    arithmetic : RunArithmetic
        Of the run.
    finely : bool, optional
        Whether a plant with its own integrator uses Runge-Kutta steps instead.
    address : callable, optional
        Provider of the address of a function with bindings; by default
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


# --- Parameters as numbers ---


def numbers_of(
    plant: Plant, driven: Collection[Address], arithmetic: RunArithmetic
) -> NDArray[np.float64]:
    """Return the parameters of a plant as an array for its equations."""
    pack = getattr(plant, "pack", None)
    if pack is not None:
        return np.asarray(pack(driven, arithmetic), float)
    numbers = [parameter(plant, name).value for name in plant.parameters]
    if arithmetic.compiled and is_traced(plant):
        equations = traced(plant)
        assert equations is not None
        numbers += equations.addresses
    return np.array(numbers, float)


def with_actuators(
    plant: Plant,
    actuators: Mapping[str, Port],
    delays: Mapping[str, float] | None = None,
) -> Plant:
    """Return a plant with other actuators or dead times, by input; without an axis of all axes."""
    if plant.dynamics is not None:
        hint = "the options --limits and --supply bound its torques and voltages"
        raise PlantError(f"the {plant.name} makes its drives itself", name="actuator", hint=hint)
    interface = interface_of(plant)
    changed = dict(plant.inputs)
    names = {_address(plant, name): name for name in plant.inputs}

    def inputs(name: str) -> Iterator[str]:
        for address in interface.every_port(name):
            if address not in names:
                raise PlantError(f"'{name}' is an output, not an input", name=name)
            yield names[address]

    for name, port in actuators.items():
        for key in inputs(name):
            old, start = changed[key], port.start
            if start is None and old.start is not None:
                start = port.within(old.start)
            changed[key] = replace(port, unit=old.unit, start=start, delay=old.delay)
    for name, delay in (delays or {}).items():
        for key in inputs(name):
            changed[key] = replace(changed[key], delay=delay)
    other = copy(plant)
    other.inputs = changed
    return other


def with_parameters(plant: Plant, values: Mapping[str, float]) -> Plant:
    """Return a plant with changed parameters, which hold for the loaded plant, too."""
    changed = dict(plant.parameters)
    for name, value in values.items():
        old = parameter(plant, name)
        if not math.isfinite(value):
            raise PlantError(f"parameter {name} = {value} is out of range", name=name)
        is_plain = not isinstance(plant.parameters[name], Parameter)
        changed[name] = float(value) if is_plain else replace(old, value=float(value))
    other = copy(plant)
    other.parameters = changed
    if plant.loaded_parameters is not Plant.loaded_parameters:
        others = plant.loaded_parameters.items()
        other.loaded_parameters = {name: value for name, value in others if name not in values}
    return other
