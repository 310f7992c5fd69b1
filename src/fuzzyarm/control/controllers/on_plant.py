"""A controller as text on a plant, and its learned tables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from decimal import Decimal
from functools import cache
from typing import Any, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.names import near_hint
from fuzzyarm.control.controllers.code import AXIS, ControllerCode, Sheet, SourceError, Wiring
from fuzzyarm.control.controllers.controller import CompiledController, Controller, Sum
from fuzzyarm.control.controllers.kernel import step_on
from fuzzyarm.control.controllers.law import (
    LINKS,
    LINKS_END,
    MEMORY,
    MEMORY_END,
    OBSERVATION_END,
    SIGNALS,
    Gain,
    Gains,
    Law,
    law_address,
    write_observation,
)
from fuzzyarm.control.controllers.program import write_down
from fuzzyarm.control.controllers.robot_laws import EFFORTS, InverseDynamics, robot_law
from fuzzyarm.control.controllers.text import ControllerText, gains_of, ports_of
from fuzzyarm.language.model.controller import Axes, ControllerModel, Drive, SignalLine
from fuzzyarm.plant.arm import RATIOS, motor_torque
from fuzzyarm.plant.driven_arm import JOINTS, Arm
from fuzzyarm.plant.plant import Address, Interface, Plant, interface_of
from fuzzyarm.plant.setting import (
    CLOCK,
    SINGLE,
    STUDY_TIMING,
    Observation,
    Pair,
    RunArithmetic,
    Timing,
    stored,
)
from fuzzyarm.symbolic.kernels import kernel
from fuzzyarm.table import Axis, LookupTable

# --- Ports of the controller and ports of the plant ---


@dataclass(frozen=True)
class Site:
    """The plant of a controller, as seen from it.

    Attributes
    ----------
    name : str
        Name of the plant.
    interface : Interface
        Its ports.
    extra : int
        Numbers after its outputs that are not ports, see :mod:`fuzzyarm.plant.driven_arm`.
    connect : mapping of str to str
        From names of the controller to ports of the plant, if they differ.
    model : InverseDynamics or None
        The model of a robot, for the laws of the study.
    """

    name: str
    interface: Interface
    extra: int = 0
    connect: Mapping[str, str] = field(default_factory=dict)
    model: InverseDynamics | None = None

    @property
    def observation_end(self) -> int:
        """The length of an observation: clock, references, outputs."""
        interface = self.interface
        return CLOCK + len(interface.references) + len(interface.outputs) + self.extra

    def wiring(self, model: ControllerModel) -> Wiring:
        """Assign cells to the ports of a controller."""
        interface, end, size = self.interface, self.observation_end, len(self.interface.inputs)
        first = {"reference": CLOCK, "measured": CLOCK + len(interface.references)}
        first["drive"] = end + size
        cells: dict[str, dict[Address, int]] = {kind: {} for kind in first}
        for kind, wires in cells.items():
            places = {port: at for at, port in enumerate(self._ports(kind))}
            for address in ports_of(model, kind):
                wires[address] = first[kind] + places[self.find(model, kind, address)]
        drives = {
            address: interface.inputs[self.find(model, "drive", address)]
            for address in cells["drive"]
        }
        shared = Counter(cells["drive"].values())
        return Wiring(
            cells["reference"],
            cells["measured"],
            cells["drive"],
            tuple(range(end, end + len(interface.axes))),
            end + 2 * size + (SIGNALS if self.extra else 0),
            {
                address: port.start
                for address, port in drives.items()
                # Each of several axes with a common input drives a part of it only.
                if port.start is not None and shared[cells["drive"][address]] == 1
            },
        )

    def driven(self, model: ControllerModel) -> frozenset[Address]:
        """Return the inputs driven by a controller."""
        return frozenset(self.find(model, "drive", port) for port in ports_of(model, "drive"))

    def find(self, model: ControllerModel, kind: str, address: Address) -> Address:
        """Return axis and port of the plant for those of a controller.

        A single axis on both sides matches under any name, and so do the axes of a cascade; an axis
        may be connected as a whole, to run on one of several.
        """
        ports = self._ports(kind)
        axis, named = found = self._joined(model, address)
        if found in ports:
            return found
        port = address[1]
        if axis not in self.interface.axes:
            hint = f"it has {', '.join(self.interface.axes)}"
            raise SourceError(f"the {self.name} has no axis '{axis}'", hint=hint)
        names = [name for home, name in ports if home == axis]
        used_ports = {name for _, name in ports_of(model, kind)}
        # Without a similar name, suggest a port that the controller does not use yet.
        free = [name for name in names if name not in used_ports] or names
        what = "drive" if kind == "drive" else f"{kind} value"
        hint, likely = f"it has {', '.join(names)}", near(named, free)
        # The name exists on the plant: it was connected to another port.
        if likely != port:
            hint += f"; --connect {port}={likely} joins them"
        raise SourceError(f"the {self.name} has no {what} '{named}'", hint=hint)

    def has(self, model: ControllerModel, kind: str, address: Address) -> bool:
        """Return whether the plant has the axis and port of a controller."""
        return self._joined(model, address) in self._ports(kind)

    def _joined(self, model: ControllerModel, address: Address) -> Address:
        """Return axis and port behind a name of the controller, present on the plant or not."""
        axis, port = address
        joined = self.connect.get(axis, axis)
        axis = joined if joined in self.interface.axes else axis
        named = self.connect.get(".".join(address), self.connect.get(port, port))
        if "." in named:
            axis, _, named = named.rpartition(".")
        elif len(self.interface.axes) == 1 and (model.has_one_axis or model.is_cascade):
            axis = self.interface.axes[0]
        return axis, named

    def _ports(self, kind: str) -> Mapping[Address, object]:
        interface = self.interface
        return {
            "reference": interface.references,
            "measured": interface.outputs,
            "drive": interface.inputs,
        }[kind]


def near(word: str, names: list[str]) -> str:
    """Return the most similar name, or the first."""
    return near_hint(word, names)[1] or names[0]


def site_of(plant: Plant, connect: Mapping[str, str] | None = None) -> Site:
    """Describe a plant as the site of a controller."""
    extra = plant.particulars.extra
    model = getattr(plant, "inverse_dynamics", None)
    return Site(plant.name, interface_of(plant), extra, dict(connect or {}), model)


PORT_KINDS = ("reference", "measured", "drive")
"""Kinds of ports of a controller."""

SITE_OF_LAWS = site_of(Arm())
"""The plant of the study's laws, which use its ports and its pose."""


# --- The law ---
#
# The first cells are the observation of every law; then scratch for the drives of a partner, the
# drives of this controller, and (on the arm) scratch for `text_kernel`.

FIRST_RATIO, SECOND_RATIO = RATIOS


@kernel
def text_law(
    signals: list[float], numbers: list[float], memory: list[float], links: list[int]
) -> None:
    """Leave the drives of a controller as text among the signals.

    Constants: length of the observation, and number of drives of the plant. Memory: the cells;
    links: the code.
    """
    observation_end = int(numbers[0])
    size = int(numbers[1])
    step_on(signals[0:observation_end], links, memory)
    for i in range(size):
        signals[observation_end + i] = memory[observation_end + size + i]


@kernel
def drives_of_text(
    board: list[float],
    observation_end: int,
    size: int,
    laws: list[int],
    numbers: list[float],
    memory: list[float],
    drives: list[float],
) -> None:
    """As ``summed_drives``, with one controller as text as the only law."""
    cells = memory[laws[1 + MEMORY] : laws[1 + MEMORY_END]]
    step_on(board[0:observation_end], laws[laws[1 + LINKS] : laws[1 + LINKS_END]], cells)
    for i in range(size):
        drives[i] = 0.0 + cells[observation_end + size + i]  # a sum of one: no -0.0


@kernel
def text_kernel(
    now: Observation, numbers: list[float], memory: list[float], links: list[int]
) -> Pair:
    """Return the torque of both joints, motors included, from an observation."""
    signals = memory[2 * SIGNALS - OBSERVATION_END : 3 * SIGNALS - OBSERVATION_END]
    write_observation(now, signals)
    text_law(signals, numbers, memory, links)
    first, second = signals[OBSERVATION_END], signals[OBSERVATION_END + 1]
    single = memory[SINGLE] != 0.0
    velocity = now.state.velocity
    if numbers[2] != 0.0:
        first += stored(
            motor_torque(signals[OBSERVATION_END + 2], velocity[0], FIRST_RATIO), single
        )
    if numbers[3] != 0.0:
        second += stored(
            motor_torque(signals[OBSERVATION_END + 3], velocity[1], SECOND_RATIO), single
        )
    return first, second


class FindLaw(Protocol):
    """The controller of a catalogue law, by name."""

    def __call__(self, law: str, /) -> CompiledController:
        """Return the controller with its gains."""


@dataclass(frozen=True)
class TextLaw(Law):
    """The law of a controller as text.

    Attributes
    ----------
    text : ControllerText
        The controller.
    site : Site
        The plant, as its site.
    find_law : callable
        From the name of a partner to its law.
    program : callable
        From the arithmetic of a run to the program of the kernel.
    partners : callable
        The controllers of its partners.
    """

    text: ControllerText = field(kw_only=True)
    site: Site = field(kw_only=True)
    find_law: FindLaw = field(kw_only=True)
    program: Any = field(kw_only=True)
    partners: Callable[[], Mapping[str, CompiledController]] = field(kw_only=True)

    def on(self, site: Site) -> TextLaw:
        """Return the law for another plant."""
        return make_law(self.text, self.find_law, site)


def text_law_of(controller: Controller) -> TextLaw | None:
    """Return the law of a controller as text; None of any other controller, sums among them."""
    law = controller.law if isinstance(controller, CompiledController) else None
    return law if isinstance(law, TextLaw) else None


def make_law(text: ControllerText, find_law: FindLaw, site: Site = SITE_OF_LAWS) -> TextLaw:
    """Make the law that runs a controller on a plant.

    Parameters
    ----------
    text : ControllerText
        The controller.
    find_law : callable
        From the name of a partner to its law.
    site : Site, optional
        That of the laws by default. Missing ports are an error when the law is used.
    """
    model = text.model
    gains = tuple(gains_of(model))

    @cache
    def partners() -> dict[str, CompiledController]:
        controllers = {}
        for partner in model.partners:
            require_for_laws(f"the partner '{partner.name}' ({partner.law})", site)
            law = find_law(partner.law)
            controllers[partner.name] = law.with_gains(
                {name: [value] for name, value in partner.gains}
            )
        return controllers

    @cache
    def program(arithmetic: RunArithmetic) -> ControllerCode:
        laws = {
            name: (law_address(partner.law, arithmetic), partner.block(arithmetic))
            for name, partner in partners().items()
        }
        return write_down(model, text.sheets, laws, site.wiring(model), arithmetic)

    def pack(_gains: Gains, _arithmetic: RunArithmetic) -> list[float]:
        driven = site.driven(model)
        powered = [float((joint, "voltage") in driven) for joint in JOINTS]
        return [float(site.observation_end), float(len(site.interface.inputs)), *powered]

    def remember(chosen: Gains, arithmetic: RunArithmetic) -> NDArray[np.float64]:
        # Gains of the text depend on the run's π; replaced ones do not.
        numbers = {
            gain.name: chosen[gain.name].value
            for gain in gains
            if chosen[gain.name].value != gain.value
        }
        return program(arithmetic).cells_with(numbers, arithmetic)

    def links(arithmetic: RunArithmetic) -> list[int]:
        return program(arithmetic).code

    return TextLaw(
        model.name,
        text_kernel,
        model.description,
        gains,
        pack,
        remember,
        links,
        remembers=any(True for _ in text.learners()),
        at_signals=text_law,
        text=text,
        site=site,
        find_law=find_law,
        program=program,
        partners=partners,
    )


def controller_on(controller: Controller, site: Site) -> Controller:
    """Return a controller, or a sum of them, for a plant."""
    if isinstance(controller, Sum):
        return Sum([controller_on(addend, site) for addend in controller.addends], controller.name)
    law = text_law_of(controller)
    if law is not None:
        site.wiring(law.text.model)  # raises for missing ports
        if site != law.site:
            compiled_controller = CompiledController(law.on(site), controller.gains)
            compiled_controller.name = controller.name
            return compiled_controller
    elif not controller.takes_ports:
        if site.model is not None and isinstance(controller, CompiledController):
            return robot_law(controller, site.model)
        require_for_laws(controller.name, site)
    return controller


def lacking(site: Site) -> str:
    """Return the ports of a study's law that a plant lacks; empty if it has all."""
    for kind, verb in (("measured", "measures"), ("drive", "drives")):
        for port in SITE_OF_LAWS._ports(kind):
            if port not in site._ports(kind):
                return f"{verb} {'.'.join(port)}, which the {site.name} does not have"
    same = site.extra == SITE_OF_LAWS.extra
    return "" if same else f"needs the pose, which the {site.name} does not have"


def require_for_laws(what: str, site: Site) -> None:
    """Raise SourceError if a plant lacks ports of the study's laws."""
    why = lacking(site)
    if why:
        hint = "controllers as text, and classes with a step, run on any plant"
        raise SourceError(f"{what} {why}", hint=hint)


def connectable(controller: Controller) -> set[str]:
    """Return the axes and ports of a controller as text, which may be connected to a plant."""
    law = text_law_of(controller)
    return set() if law is None else connectable_names(law.text.model)


def connectable_names(model: ControllerModel) -> set[str]:
    """Return the axes and ports of a text, which may be connected to a plant."""
    ports = [port for kind in PORT_KINDS for port in ports_of(model, kind)]
    return {*model.axis_names, *(name for _, name in ports), *map(".".join, ports)}


def driven_by(controller: Controller, site: Site) -> frozenset[Address]:
    """Return the inputs of a plant driven by a controller."""
    cells: set[Address] = set()
    for part in controller.parts():
        law = text_law_of(part)
        if law is not None:
            cells |= site.driven(law.text.model)
        else:
            cells |= driven_plainly(site)
    return frozenset(cells)


def driven_plainly(site: Site) -> frozenset[Address]:
    """Return the inputs for laws and controllers in Python: the torques, if any."""
    efforts = EFFORTS if site.model is not None else ("torque",)
    torques = frozenset(port for port in site.interface.inputs if port[1] in efforts)
    return torques or frozenset(site.interface.inputs)


# --- Timing ---


def own_timing(controller: Controller) -> Timing | None:
    """Return control period and set points of a controller; None for a law."""
    timings: dict[Timing, Timed] = {}
    for part in controller.parts():
        model = timed(part)
        if model is not None:
            # As decimals: five periods of 0.6 ms are exactly the float of 3 ms.
            set_point = float(Decimal(repr(model.period)) * model.every)
            timings.setdefault(Timing(set_point, model.every), model)
    if len(timings) > 1:
        first, second, *_ = timings.values()
        raise SourceError(
            f"{first.name} and {second.name} cannot be added: {timing_words(first)} and "
            f"{timing_words(second)}",
            hint="write the same period and set-point into both",
        )
    return next(iter(timings), None)


class Timed(Protocol):
    """An object with a period of its own: the text of a controller, or one in Python."""

    @property
    def name(self) -> str:
        """Name of the controller."""

    @property
    def period(self) -> float:
        """In s."""

    @property
    def every(self) -> int:
        """Periods of a set point."""


def timed(part: Controller) -> Timed | None:
    """Return the timed part of an addend; None for a law, which has the timing of the study."""
    law = text_law_of(part)
    if law is not None:
        return law.text.model
    if not part.takes_ports or part.period is None:
        return None
    for name, value, least in (("period", part.period, 1e-9), ("every", part.every, 1)):
        kinds = (int, float) if name == "period" else (int,)
        if isinstance(value, bool) or not isinstance(value, kinds) or not least <= value < 1e9:
            hint = "a time in s, as in  period = 0.01" if name == "period" else "a whole number"
            raise SourceError(f"{name} of {part.name} is {value!r}", hint=hint)
    return cast(Timed, part)


def timing_words(model: Timed) -> str:
    """Return the timing of a controller in words."""
    return f"a period of {model.period:g} s with a set point every {model.every}"


def timing_on(controller: Controller, site: Site) -> Timing:
    """Return the timing of a controller on a plant; mandatory except for laws."""
    timing = own_timing(controller)
    if timing is None and site.model is None and lacking(site):
        hint = "write  period = 0.01  into its class, in s"
        raise SourceError(f"{controller.name} has no control period", hint=hint)
    return timing or STUDY_TIMING


# --- Limits of its drives ---

Limits = tuple[float, float]


def drive_limits(controller: Controller, site: Site) -> dict[Address, Limits]:
    """Return the limits of each drive: ``within`` of the drive itself or of its integral.

    Several drives of a port add up, and so do their limits; a law has none.
    """
    total: dict[Address, Limits] = {}
    for part in controller.parts():
        law = text_law_of(part)
        if law is not None:
            limits_of_drives = _limits_of_text(part.gains, law.text.model, site)
        else:
            limits_of_drives = dict.fromkeys(driven_plainly(site), UNLIMITED)
        for port, limits in limits_of_drives.items():
            total[port] = _added(total[port], limits) if port in total else limits
    return total


UNLIMITED = (-np.inf, np.inf)


def _added(first: Limits, second: Limits) -> Limits:
    return first[0] + second[0], first[1] + second[1]


def _limits_of_text(
    chosen: Mapping[str, Gain], model: ControllerModel, site: Site
) -> dict[Address, Limits]:
    total: dict[Address, Limits] = {}
    for axes in model.axes:
        for axis in axes.names:
            index = model.axis_names.index(axis)
            gains = {
                name: gain.value[index if len(gain.value) > 1 else 0]
                for name, gain in chosen.items()
            }
            for line in axes.lines:
                if isinstance(line, Drive):
                    port = site.find(model, "drive", (axis, line.port))
                    limits = line.within or _limits_of_integral(axes, line, gains)
                    total[port] = _added(total[port], limits) if port in total else limits
    return total


def _limits_of_integral(axes: Axes, drive: Drive, gains: Mapping[str, float]) -> Limits:
    """Return the limits of a drive that is a bounded integral times constants."""
    names = {factor.value for product in drive.products for factor in product.factors}
    for line in axes.lines:
        if not isinstance(line, SignalLine) or line.source is None or not names & set(line.names):
            continue
        within = line.source.option("within")
        if not isinstance(within, tuple):
            return UNLIMITED
        products = axes.gain_of(line.names[0], drive, gains)
        if products is None or len(drive.products) != 1:
            return UNLIMITED
        gain = sum(product.value(gains) for product in products)
        return min(gain * within[0], gain * within[1]), max(gain * within[0], gain * within[1])
    return UNLIMITED


# --- Learned tables ---


@dataclass(frozen=True, eq=False, kw_only=True)
class LearnedTables:
    """Tables that a controller has learned.

    Attributes
    ----------
    axes : tuple of Axis
        The inputs of each table.
    values : ndarray, shape (axes of the controller, levels of each input …)
        One table for each axis.
    visits : ndarray of int64, same shape
        Number of uses of each cell.
    """

    axes: tuple[Axis, ...]
    values: NDArray[np.float64]
    visits: NDArray[np.int64]

    def readable(self, *, single: bool) -> LearnedTables:
        """Return the tables without last digits from rounding.

        Parameters
        ----------
        single : bool
            Whether they were stored in single precision; then 6 decimals stay, otherwise 12.
        """
        decimals = 6 if single else 12
        return replace(self, values=np.round(self.values, decimals) + 0.0)  # + 0.0: no -0

    def pages(self, last: NDArray[np.int64] | None = None) -> list[tuple[Any, Any]]:
        """Return values and visits of each axis as rows and columns, for a picture.

        For a table over more than two inputs, the most visited page.

        Parameters
        ----------
        last : ndarray, optional
            Visits that select the page, if not those of these tables.
        """
        tables = []
        by = self.visits if last is None else last
        for values, visits, used in zip(self.values, self.visits, by, strict=True):
            if values.ndim == 1:
                page: tuple[Any, ...] = (None,)
            else:
                sums = used.sum(axis=(-2, -1))
                page = np.unravel_index(int(np.argmax(sums)), sums.shape) if sums.ndim else ()
            tables.append((values[page], visits[page]))
        return tables

    def tables(self, like: LookupTable) -> list[LookupTable]:
        """Return the table of each axis of the controller; everything else from `like`."""
        return [replace(like, axes=self.axes, values=value) for value in self.values]

    def table(self, like: LookupTable) -> LookupTable:
        """Return all tables as one, whose first input is the axis of the controller."""
        levels = tuple(float(i + 1) for i in range(len(self.values)))
        axes = (Axis(AXIS, levels, description="axis of the controller"), *self.axes)
        return replace(like, axes=axes, values=self.values)


def learned(law: TextLaw, arithmetic: RunArithmetic, memory: Any = None) -> LearnedTables:
    """Read the first learning table from the memory of a law.

    Parameters
    ----------
    law : TextLaw
        Law of a controller that learns.
    arithmetic : RunArithmetic
        Arithmetic of the run.
    memory : array_like, optional
        Memory after a run; the initial one by default.
    """
    line = next(law.text.learners())
    program: ControllerCode = law.program(arithmetic)
    if memory is None:
        memory = program.cells
    axes = tuple(axis for axis in _table(law.text.sheets[line.table][0]).axes if axis.name != AXIS)
    shape = tuple(len(axis.levels) for axis in axes)
    places = [program.learned[axis, line.table] for axis in law.text.model.axis_names]
    values = [memory[place.values : place.values + place.count] for place in places]
    visits = [memory[place.visits : place.visits + place.count] for place in places]
    return LearnedTables(
        axes=axes,
        values=np.array(values).reshape(-1, *shape),
        visits=np.array(visits).astype(np.int64).reshape(-1, *shape),
    )


def _table(sheet: Sheet) -> LookupTable:
    assert isinstance(sheet, LookupTable)
    return sheet
