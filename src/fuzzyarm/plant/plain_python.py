"""A user's plant in plain Python: tried once before it runs, then called from a loop.

Errors name the line at fault.
"""

from __future__ import annotations

import ast
import inspect
import math
import traceback
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np

from fuzzyarm.base.names import did_you_mean, nearest
from fuzzyarm.base.numbers import counted, number_text
from fuzzyarm.base.units import differs, product, read_unit
from fuzzyarm.plant.equations import USERS, apart, is_of_package
from fuzzyarm.plant.plant import (
    PARTS,
    STEP,
    TIME,
    Parameter,
    Plant,
    PlantError,
    Port,
    interface_of,
    measure_states,
    runge_kutta_4,
)
from fuzzyarm.plant.trajectory import Trajectory
from fuzzyarm.symbolic.kernels import with_names

EXAMPLES = {
    "inputs": '{"power": Port("%", 0, 100)}',
    "outputs": '{"temperature": Port("°C")}',
    "states": '{"T": "°C"}',
    "parameters": '{"loss": 0.01}',
}

ARGUMENTS = {"derivative": "t, x, u, p", "measure": "t, x, u, p", "step": "t, x, u, p, dt"}
"""Arguments of a plant's equations after ``self``."""


NUMBER_OF_PARAMETER = "its number is self.parameters[NAME].value"

HOME = "_fuzzyarm_home"
"""Attribute of a plant of a user's file with its origin."""


class Home(NamedTuple):
    """Origin of a plant: file, text, name in it; and its initial attributes."""

    path: str
    source: str
    key: str
    begun: Mapping[str, Any]

    def __deepcopy__(self, _copies: object) -> Home:
        return self


def require_ports(plant: Plant) -> None:
    """Raise PlantError for invalid ports, states or parameters.

    Parameters
    ----------
    plant : Plant
        A user's plant.
    """
    for what, example in EXAMPLES.items():
        ports = getattr(plant, what)
        if not ports and what != "parameters":
            raise _fault(plant, what, f"it has no {what}", hint=f"write  {what} = {example}")
        if not isinstance(ports, Mapping):
            raise _fault(
                plant, what, f"{what} must be a mapping of names, not {_words(ports)}",
                hint=f"write  {what} = {example}",
            )  # fmt: skip
        for name, value in ports.items():
            if not isinstance(name, str):
                raise _fault(plant, what, f"a name in {what} is {_words(name)}, not text")
            _require_value(plant, what, name, value)
    if plant.derivative is None and plant.step is None and plant.dynamics is None:
        near = next(
            (
                attribute
                for attribute in dir(plant)
                if attribute.startswith("der") and attribute != "derivative"
            ),
            "",
        )
        text = f", but '{near}'" if near else ""
        hint = "def derivative(self, t, x, u, p):  returns the rate of each state"
        raise _fault(plant, near or "states", f"it has no derivative{text}", hint=hint)
    _require_no_slip(plant)
    _require_rates(plant)
    if plant.measure is None and plant.dynamics is None:
        _require_first_states(plant)
    _require_followable(plant)
    for what in ("longest_step", "duration"):
        number = getattr(plant, what)
        if number is not None and not (_is_number(number) and number > 0.0):
            raise _fault(plant, what, f"{what} is {_words(number)}", hint="a positive number of s")


def _require_rates(plant: Plant) -> None:
    """Raise PlantError for a rate of a port missing among the outputs."""
    for name, port in plant.outputs.items():
        axis = name.rpartition(".")[0]
        others = [other for other in plant.outputs if other.rpartition(".")[0] == axis]
        bare = [other.rpartition(".")[2] for other in others if other != name]
        if port.rate_of and port.rate_of not in bare:
            near = nearest(port.rate_of, bare)
            raise _fault(
                plant, "outputs", f"output '{name}' is the rate of '{port.rate_of}', not an output",
                hint=did_you_mean(near) if near else f"there are {', '.join(bare)}",
            )  # fmt: skip


def _require_first_states(plant: Plant) -> None:
    """Raise PlantError where an output of a plant without `measure` is the wrong state."""
    outputs = [(name.rpartition(".")[2], port.unit) for name, port in plant.outputs.items()]
    for (name, unit), (state, own) in zip(outputs, plant.states.items(), strict=False):
        if name != state and (name in plant.states or _differ(unit, own)):
            message = f"output '{name}' ({unit}) is taken from the state '{state}' ({own})"
            hint = "without a measure(self, t, x, u, p) outputs are the first states, in order"
            raise _fault(plant, "outputs", message, hint=hint)


def _differ(one: str, other: str) -> bool:
    """Whether two units are known, and are not the same."""
    units = read_unit(one), read_unit(other)
    return all(units) and differs(product(*units, -1))


_MEASURING = {"measurement", "measurements", "observe", "output"}
"""Methods of other programs with the meaning of `measure`."""


def _require_no_slip(plant: Plant) -> None:
    """Raise PlantError for an attribute that looks like a misspelt optional one."""
    own_classes = [kind for kind in type(plant).__mro__ if not is_of_package(kind)]
    for name, value in [pair for kind in own_classes for pair in vars(kind).items()]:
        options = ["longest_step"]
        if isinstance(value, Mapping | Trajectory) and not hasattr(Plant, name):
            options.append("trajectories")
        near = "" if name in options else nearest(name, options)
        if name in _MEASURING and callable(value) and not hasattr(Plant, name):
            near = "" if type(plant).measure is not Plant.measure else "measure"
        if near:
            raise _fault(plant, name, f"'{name}' is not read", hint=did_you_mean(near))


def _require_followable(plant: Plant) -> None:
    """Raise PlantError for invalid trajectories or loads."""
    ways: object = plant.trajectories
    hint = 'write  trajectories = {"up": through([(1.0,)], segment=2.0)}'
    if not isinstance(ways, Mapping):
        message = f"trajectories must be a mapping of names, not {_words(ways)}"
        raise _fault(plant, "trajectories", message, hint=hint)
    for name, way in ways.items():
        if not (isinstance(way, Trajectory) or callable(way)):
            message = f"trajectory '{name}' is {_words(way)}"
            raise _fault(plant, "trajectories", message, hint=hint)
    for name in plant.compared_along:
        if name not in ways:
            message = f"compared_along names '{name}', which is not a trajectory"
            raise _fault(plant, "compared_along", message, hint=f"there are {', '.join(ways)}")
    load: object = plant.loaded_parameters
    if not isinstance(load, Mapping):
        message = f"loaded_parameters must be a mapping of names to numbers, not {_words(load)}"
        raise _fault(plant, "loaded_parameters", message, hint='write  {"m": 5.0}')
    for name, value in load.items():
        if name not in plant.parameters or not _is_number(value):
            message = f"loaded_parameters has {_words(name)}: {_words(value)}"
            hint = f"numbers of its parameters: {', '.join(plant.parameters)}"
            raise _fault(plant, "loaded_parameters", message, hint=hint)


def _require_value(plant: Plant, what: str, name: str, value: object) -> None:
    if what in ("inputs", "outputs"):
        if isinstance(value, Port):
            if what == "outputs" and value.dead_time:
                hint = f"a sensor is delayed by --sensor-delay {name}=TIME"
                raise _fault(plant, what, f"output '{name}' has the delay of an actuator", hint)
            return
        unit = value if isinstance(value, str) else "1"
        rest = ", 0, 100" if what == "inputs" else ""
        raise _fault(
            plant, what, f"{what[:-1]} '{name}' is {_words(value)}, not a Port",
            hint=f'write  "{name}": Port("{unit}"{rest})',
        )  # fmt: skip
    if what == "states" and not isinstance(value, str):
        hint = f'its unit follows the name:  "{name}": "m"'
        raise _fault(plant, what, f"state '{name}' has {_words(value)} for a unit", hint=hint)
    if what == "parameters" and not (isinstance(value, Parameter) or _is_number(value)):
        hint = f'write  "{name}": 0.01  or  "{name}": Parameter(0.01, "1/s")'
        raise _fault(plant, what, f"parameter '{name}' is {_words(value)}, not a number", hint=hint)


def require_sound(plant: Plant) -> None:
    """Raise PlantError if a user's plant is invalid: first its ports, then its equations.

    Of a shipped one only the equations, with changed parameters.
    """
    if not is_of_package(type(plant)):
        require_ports(plant)
        interface_of(plant)
        try_equations(plant)
    elif set_parameters(plant):
        try_equations(plant)


def set_parameters(plant: Plant) -> dict[str, float]:
    """Return the parameters of a plant with changed values."""
    home = vars(plant).get(HOME)
    own = type(plant).parameters
    own = home.begun.get("parameters", own) if isinstance(home, Home) else own
    return {
        name: value
        for name in plant.parameters
        if name in own and (value := _value(plant.parameters[name])) != _value(own[name])
    }


def _value(parameter: object) -> float:
    return parameter.value if isinstance(parameter, Parameter) else float(cast(float, parameter))


def try_equations(plant: Plant) -> None:
    """Evaluate the equations of a plant once at the start; PlantError if they are invalid.

    Parameters
    ----------
    plant : Plant
        With valid ports. `step` is not tried: it may have side effects.
    """
    if plant.dynamics is not None or plant.step is not None:
        return
    plant = apart(plant)
    numbers = [*map(_value, plant.parameters.values())]
    drives = [port.idle for port in plant.inputs.values()]
    states = _numbers(plant, "start", lambda: plant.start(np.random.default_rng(0)), plant.states)
    for what, names in (("derivative", plant.states), ("measure", plant.outputs)):
        equations = getattr(plant, what)
        if equations is None:
            continue
        _numbers(plant, what, partial(equations, 0.0, list(states), drives, numbers), names)


def _numbers(
    plant: Plant, what: str, ask: Callable[[], Any], ports: Mapping[str, object]
) -> list[float]:
    """Return the result of a method of a plant, one number for each name."""
    try:
        answer = ask()
    except PlantError:
        raise
    except USERS as error:
        message, hint = _of_error(plant, what, error)
        raise _fault(plant, what, message, hint, _user_frame(error)) from error
    values = _one_for_each(plant, what, answer, ports)
    for name, value in zip(ports, answer, strict=True):
        if not _is_number(value):
            raise _fault(plant, what, f"{what} returns {_words(value)} for '{name}', not a number")
        # With finite states a NaN output is a lost sample.
        is_lost = what == "measure" and bool(plant.states) and math.isnan(value)
        if not math.isfinite(value) and not is_lost:
            hint = "it divides by zero, or takes the root of a negative number"
            at_first = "at the start, with all inputs at 0 or their nearest limit"
            message = f"{what} returns {value} for '{name}' {at_first}"
            raise _fault(plant, what, message, hint=hint if math.isnan(value) else "")
    return values


def _one_for_each(plant: Plant, what: str, answer: Any, ports: Mapping[str, object]) -> list[float]:
    """Convert the result of a method of a plant to numbers, one for each name."""
    try:
        values = [*map(float, answer)]
    except (TypeError, ValueError):
        pass
    else:
        if len(values) == len(ports):
            return values
    kind = {"derivative": "rate for each state", "measure": "value for each output"}
    expectation = f"one {kind.get(what, 'number for each state')}: {', '.join(ports)}"
    if answer is None:
        raise _fault(plant, what, f"{what} returns nothing", hint=f"return a list, {expectation}")
    try:
        values = list(answer)
    except TypeError:
        raise _fault(
            plant,
            what,
            f"{what} returns {_words(answer)}, not a list",
            hint=f"return a list, {expectation}",
        ) from None
    if len(values) != len(ports):
        counts = f"{counted(len(values), 'number')} for {len(ports)}"
        nouns = "outputs" if what == "measure" else "states"
        raise _fault(plant, what, f"{what} returns {counts} {nouns}", hint=f"return {expectation}")
    name, value = next((n, v) for n, v in zip(ports, values, strict=True) if not _is_number(v))
    hint = NUMBER_OF_PARAMETER if isinstance(value, Parameter) else ""
    raise _fault(plant, what, f"{what} returns {_words(value)} for '{name}', not a number", hint)


# --- Calls from the loop ---


def plain_motion(plant: Plant, states: int) -> Callable[..., None]:
    """Return a kernel-like function that advances a plant in plain Python."""
    if plant.step is None:
        slope = plant.derivative
        assert slope is not None

        def derivative(t: float, x: Any, u: Any, p: Any) -> Any:
            rates = slope(t, x[:states].tolist(), u.tolist(), p.tolist())
            return _one_for_each(plant, "derivative", rates, plant.states)

        return with_names(runge_kutta_4, {"derivative": derivative})
    step = plant.step

    def advance(x: Any, _y: Any, u: Any, p: Any, clock: Any) -> None:
        h = clock[STEP] / clock[PARTS]
        for part in range(int(clock[PARTS])):
            after = step(clock[TIME] + part * h, x[:states].tolist(), u.tolist(), p.tolist(), h)
            for i, value in enumerate(_one_for_each(plant, "step", after, plant.states)):
                x[i] = value

    return advance


def plain_outputs(plant: Plant, states: int) -> Callable[..., None]:
    """Return a kernel-like function that measures a plant in plain Python."""
    if plant.measure is None:
        return measure_states
    ask = plant.measure

    def measured(x: Any, y: Any, u: Any, p: Any, clock: Any) -> None:
        outputs = ask(clock[TIME], x[:states].tolist(), u.tolist(), p.tolist())
        for i, value in enumerate(_one_for_each(plant, "measure", outputs, plant.outputs)):
            y[i] = value

    return measured


# --- Messages ---


def _of_error(plant: Plant, what: str, error: BaseException) -> tuple[str, str]:
    """Return message and hint for an exception in a method of a plant."""
    message = f"{type(error).__name__}: {error}"
    names = {
        "x": list(plant.states), "u": list(plant.inputs), "p": list(plant.parameters),
    }  # fmt: skip
    if isinstance(error, TypeError) and "list indices must be integers" in str(error):
        order = "; ".join(f"{k}[0] is {v[0]}" for k, v in names.items() if v)
        return message, f"x, u and p are lists in the order of their names: {order}"
    if isinstance(error, TypeError) and "'Parameter'" in str(error):
        return message, NUMBER_OF_PARAMETER
    if isinstance(error, IndexError):
        counts = ", ".join(f"{len(v)} in {k}" for k, v in names.items())
        return message, f"there are {counts}"
    if isinstance(error, TypeError) and what in ARGUMENTS and "argument" in str(error):
        return message, f"write  def {what}(self, {ARGUMENTS[what]}):"
    return message, ""


def _user_frame(error: BaseException) -> str:
    """Return `FILE:LINE: ` of the last foreign line in the traceback."""
    own_folder = str(Path(__file__).parents[1])
    frames = traceback.extract_tb(error.__traceback__)
    places = [f"{f.filename}:{f.lineno}: " for f in frames if not f.filename.startswith(own_folder)]
    return places[-1] if places else ""


def _fault(plant: Plant, what: str, message: str, hint: str = "", place: str = "") -> PlantError:
    name = plant.name or type(plant).__name__
    place = place or place_of(plant, what)
    pairs = [f"{name} = {number_text(value)}" for name, value in set_parameters(plant).items()]
    given = f" with {', '.join(pairs)}" if pairs else ""
    return PlantError(f"{place}plant {name}{given}: {message}", name=what, hint=hint)


def place_of(plant: Plant, what: str) -> str:
    """Return ``FILE:LINE: `` of an attribute in the source of a plant; empty if unknown."""
    if is_of_package(type(plant)):
        return ""
    classes = [kind for kind in type(plant).__mro__ if not is_of_package(kind)]
    kind = next((base for base in classes if what in vars(base)), type(plant))
    try:
        method = inspect.unwrap(vars(kind)[what])
        code = method.__code__
        return f"{code.co_filename}:{code.co_firstlineno}: "
    except (AttributeError, KeyError):
        pass
    home = vars(plant).get(HOME)
    if not isinstance(home, Home):
        return ""
    line = _line_of(home.source, kind.__name__, what)
    return "" if line is None else f"{home.path}:{line}: "


def _line_of(source: str, kind: str, what: str) -> int | None:
    """Return the line of an attribute in the text of its class, or that of the class."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ClassDef) and node.name == kind:
            for line in node.body:
                targets = (
                    line.targets
                    if isinstance(line, ast.Assign)
                    else [getattr(line, "target", None)]
                )
                if any(isinstance(target, ast.Name) and target.id == what for target in targets):
                    return line.lineno
            return node.lineno
    return None


def _is_number(value: object) -> bool:
    return isinstance(value, int | float | np.number) and not isinstance(value, bool)


def _words(value: object) -> str:
    """Return a value in words: its text if short, else its type."""
    text = repr(value)
    return text if len(text) <= 40 else f"a {type(value).__name__}"


def lacks(names: Mapping[str, object]) -> Sequence[str]:
    """Return the reasons why the classes of a file are not plants, a sentence each."""
    sentences = []
    for name, kind in names.items():
        has = {what for what in (*EXAMPLES, *ARGUMENTS, "dynamics") if hasattr(kind, what)}
        if not has & {"inputs", "outputs", "states", "derivative", "step"}:
            continue
        if "outputs" not in has or not getattr(kind, "outputs", None):
            sentences.append(f"class {name} has no outputs")
        elif not {"derivative", "step"} & {w for w in has if getattr(kind, w) is not None}:
            near = [word for word in vars(kind) if word[:3] == "der"]
            other = f", but {near[0]}" if near else ""
            sentences.append(f"class {name} has no derivative(self, t, x, u, p){other}")
    return sentences
