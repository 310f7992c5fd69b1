"""Every controller by name.

The values are those printed in the study; the others were identified from its figures
(``fuzzyarm identify``) and are marked so. Where text and figures disagree a controller exists in
two variants: ``as-printed`` gives the published figures and is the default, ``as-described``
follows the text.

To add a controller
-------------------
A fuzzy one is a file in ``rulebases/`` and a line here. Any other law is a kernel and its record in
the module of its family (:mod:`.law`): constants in ``numbers``, states in ``memory``, and an
entry here. ``tests/loop/test_run.py`` compares its compiled and interpreted bits.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Literal

from fuzzyarm.base.diagnostic import RuleBaseError
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.names import did_you_mean, several_nearest
from fuzzyarm.base.shipped_files import missing_file_hint, shipped, shipped_names
from fuzzyarm.control.controllers.adaptive import (
    ADAPTIVE_CRITICALLY_DAMPED_LAW,
    DECENTRALISED_LAW,
    MODEL_REFERENCE_LAW,
)
from fuzzyarm.control.controllers.code import Sheet, SourceError
from fuzzyarm.control.controllers.controller import CompiledController, Controller, Sum
from fuzzyarm.control.controllers.conventional import (
    COMPUTED_TORQUE_LAW,
    CRITICALLY_DAMPED_LAW,
    FEED_FORWARD_INVERSE_LAW,
    INTEGRAL_LAW,
    PD_LAW,
    PURE_FEED_FORWARD_LAW,
)
from fuzzyarm.control.controllers.files import demand_text_file
from fuzzyarm.control.controllers.law import Law, Origin
from fuzzyarm.control.controllers.on_plant import make_law
from fuzzyarm.control.controllers.text import (
    Change,
    ControllerText,
    by_name,
    home_of,
    read_controller,
    with_files,
)
from fuzzyarm.language.model.controller import ControllerModel, Learn, SignalLine
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.language.reading import parse, parse_once, read_text
from fuzzyarm.table import LookupTable

# --- Entries of the catalogue, and the choices of their makers ---


@dataclass(frozen=True)
class Sources:
    """Rule bases and tables in place of those named in a controller.

    Parameters
    ----------
    rulebase : RuleBase, optional
        Of the control law.
    alpha : RuleBase, optional
        Of the factor on the control law.
    table : LookupTable or tuple of LookupTable, optional
        Of the control law; one for all axes, one with an input ``joint``, or one for each axis.
        Initial table of SOC.
    performance : LookupTable, optional
        Performance table of SOC.
    """

    rulebase: RuleBase | None = None
    alpha: RuleBase | None = None
    table: LookupTable | tuple[LookupTable, ...] | None = None
    performance: LookupTable | None = None

    def given(self) -> tuple[str, ...]:
        """Return the names of the given sources."""
        return tuple(field.name for field in fields(self) if getattr(self, field.name) is not None)

    def sheets(self, role: str) -> tuple[Sheet, ...]:
        """Return the source for a role: one for all axes or one for each."""
        role_sheets = getattr(self, role)
        return role_sheets if isinstance(role_sheets, tuple) else (role_sheets,)


NONE_GIVEN = Sources()
"""No replacement: everything from the text."""

Start = Literal["warm", "cold"]
Variant = Literal["as-printed", "as-described"]


@dataclass(frozen=True)
class Choice:
    """The choice among the controllers of one name.

    Parameters
    ----------
    start : {"warm", "cold"}, optional
        Initial knowledge of adaptive controllers.
    variant : {"as-printed", "as-described"}, optional
        By the study's figures or by its text, if they disagree.
    sources : Sources, optional
        Rule bases and tables in place of the shipped ones.
    """

    start: Start = "warm"
    variant: Variant = "as-printed"
    sources: Sources = field(default_factory=Sources)

    @property
    def described(self) -> bool:
        """Whether the text of the study is followed."""
        return self.variant == "as-described"


Maker = Callable[[Choice], Controller]


@dataclass(frozen=True)
class Entry:
    """One controller of the catalogue.

    Parameters
    ----------
    name : str
        Its name in commands.
    summary : str
        One line.
    make : callable
        From a choice to the controller.
    adaptive : bool
        Whether warm and cold start differ.
    accepts : tuple of str
        The :class:`Sources` that it reads; by default none.
    note : str
        Where not to use it; empty for most.
    described : bool
        Whether the study's figures and its text disagree, which gives two variants.
    """

    name: str
    summary: str
    make: Maker
    adaptive: bool = False
    accepts: tuple[str, ...] = ()
    note: str = ""
    described: bool = False


def changed(law: Law, values: dict[str, float], origin: Origin = "printed") -> CompiledController:
    """Make the controller of a law with some gains set."""
    compiled_controller = CompiledController(law)
    return compiled_controller.with_origin(
        **{
            name: compiled_controller.gains[name].with_value([value], origin)
            for name, value in values.items()
        }
    )


# --- The conventional and adaptive controllers of the catalogue ---

UNKNOWN_BODY = ("m_1", "m_2", "x_1", "x_2", "I_1", "I_2", "F_1", "F_2")
"""Parameters of the arm unknown at a cold start."""

MOTORS = ("J_1", "J_2")


def plain(law: Law) -> Maker:
    """Return the maker of a law without choices."""
    return lambda _choice: CompiledController(law)


def integral_action(
    gain: float, *, whole_run: bool = False, origin: Origin = "printed"
) -> CompiledController:
    """Make the integral term: five-sample sum, or the sum over the whole run."""
    values = {"K_I": gain, "whole_run": float(whole_run)}
    return changed(INTEGRAL_LAW, values, origin)


def computed_torque_of(choice: Choice) -> CompiledController:
    """Make computed torque, with friction in its law or without."""
    # The printed law has no friction term; the figures were made with one.
    without = {"model.F_1": 0.0, "model.F_2": 0.0}
    return changed(COMPUTED_TORQUE_LAW, without if choice.described else {})


def acdid(choice: Choice) -> CompiledController:
    """Return the adaptive controller, with W22 as printed or as in the theory."""
    values = (
        dict.fromkeys((f"model.{name}" for name in UNKNOWN_BODY), 0.0)
        if choice.start == "cold"
        else {}
    )
    compiled_controller = changed(ADAPTIVE_CRITICALLY_DAMPED_LAW, values)
    if choice.described:
        slip = compiled_controller.gains["velocity_in_W22"].with_value([0.0], "printed")
        return compiled_controller.with_origin(velocity_in_W22=slip)
    return compiled_controller


def mrac(choice: Choice) -> CompiledController:
    """Return model reference control, in the form of the figures or of the text."""
    unknown = (f"model.{name}" for name in (*UNKNOWN_BODY, *MOTORS))
    compiled_controller = changed(
        MODEL_REFERENCE_LAW, dict.fromkeys(unknown, 0.0) if choice.start == "cold" else {}
    )
    if choice.described:
        form = compiled_controller.gains["inertia_times_u"].with_value([1.0], "printed")
        return compiled_controller.with_origin(inertia_times_u=form)
    return compiled_controller


def with_integral(name: str, base: Maker, whole_run_gain: float | None = None) -> Maker:
    """Return the maker of a law with integral action; a whole-run sum in the adaptive rows.

    The text describes a sum over the iterations of a set point there too: of these
    rows the variants differ in the sum alone, and the rest is as printed.
    """

    def make(choice: Choice) -> Controller:
        if whole_run_gain is None:
            term = integral_action(50.0)
            return Sum([base(choice), term], name)
        if choice.described:
            term = integral_action(50.0, origin="own")
        else:
            term = integral_action(whole_run_gain, whole_run=True, origin="identified")
        return Sum([base(replace(choice, variant="as-printed")), term], name)

    return make


def _pid(_choice: Choice) -> Controller:
    return Sum([CompiledController(PD_LAW), integral_action(0.25, whole_run=True)], "pid")


def _pid_modified(_choice: Choice) -> Controller:
    return Sum([CompiledController(PD_LAW), integral_action(50.0)], "pid-modified")


DIVERGES_ON_FAST_MOVES = (
    "diverges on fast moves: where set points accelerate by more than about 2 rad/s², as on "
    "--trajectory pick-and-place --angles 80 -20 --segment 1"
)
"""Decentralised control with the identified gains: its feedback grows with the square of the
desired acceleration and with the error, and finally becomes unstable at the control period."""

FFID = plain(FEED_FORWARD_INVERSE_LAW)
CDID = plain(CRITICALLY_DAMPED_LAW)
DAC = plain(DECENTRALISED_LAW)

CONVENTIONAL = (
    Entry("pd", "proportional plus derivative", plain(PD_LAW)),
    Entry("pid", "PD plus the sum of errors over the whole run", _pid),
    Entry("pid-modified", "PD plus the sum over the iterations of a set point", _pid_modified),
    Entry("ct", COMPUTED_TORQUE_LAW.summary, computed_torque_of, described=True),
    Entry("ffid", FEED_FORWARD_INVERSE_LAW.summary, FFID),
    Entry("cdid", CRITICALLY_DAMPED_LAW.summary, CDID),
    Entry("feedforward", PURE_FEED_FORWARD_LAW.summary, plain(PURE_FEED_FORWARD_LAW)),
    Entry(
        "ct+ie",
        "ct plus integral of the error",
        with_integral("ct+ie", computed_torque_of),
        described=True,
    ),
    Entry("ffid+ie", "ffid plus integral of the error", with_integral("ffid+ie", FFID)),
    Entry("cdid+ie", "cdid plus integral of the error", with_integral("cdid+ie", CDID)),
    Entry("acdid", ADAPTIVE_CRITICALLY_DAMPED_LAW.summary, acdid, adaptive=True, described=True),
    Entry(
        "acdid+ie",
        "acdid plus integral of the error",
        with_integral("acdid+ie", acdid, 300.0),
        adaptive=True,
        described=True,
    ),
    Entry("mrac", MODEL_REFERENCE_LAW.summary, mrac, adaptive=True, described=True),
    Entry(
        "mrac+ie",
        "mrac plus integral of the error",
        with_integral("mrac+ie", mrac, 10.0),
        adaptive=True,
        described=True,
    ),
    Entry("dac", DECENTRALISED_LAW.summary, DAC, note=DIVERGES_ON_FAST_MOVES),
    Entry(
        "dac+ie",
        "dac plus integral of the error",
        with_integral("dac+ie", DAC, 50.0),
        note=DIVERGES_ON_FAST_MOVES,
        described=True,
    ),
    Entry("ie", INTEGRAL_LAW.summary, plain(INTEGRAL_LAW)),
)
"""Their entries, in the order of the list."""


# --- Shipped texts of the catalogue: fuzzy controllers, and linear ones for comparison ---
#
# Where text and figures of the study disagree, `NAME.frb` reproduces the figures and
# `NAME-as-described.frb` follows the text.


@dataclass(frozen=True)
class TextEntry:
    """A controller of the catalogue in a shipped file, read on demand.

    Parameters
    ----------
    name : str
        Its name in commands, and of the file.
    adaptive : bool
        Whether warm and cold start differ.
    note : str
        Where not to use it; empty for most.
    origin : {"printed", "own"}
        Whether its gains are the study's.
    identified : tuple of str
        Gains identified from the study's figures.
    """

    name: str
    adaptive: bool = False
    note: str = ""
    origin: Origin = "printed"
    identified: tuple[str, ...] = ()

    def file(self, variant: Variant = "as-printed") -> Path:
        """Return the file of a variant."""
        described = f"{self.name}-as-described.frb"
        if variant == "as-described" and described in shipped_names():
            return shipped(described)
        return shipped(f"{self.name}.frb")

    @property
    def described(self) -> bool:
        """Whether there are two variants."""
        return self.file("as-described") != self.file()

    @property
    def summary(self) -> str:
        """One line."""
        return self._model().description

    @property
    def accepts(self) -> tuple[str, ...]:
        """The :class:`Sources` that it reads."""
        return tuple(roles(self._model()))

    def _model(self) -> ControllerModel:
        model = parse_once(read_text(self.file())).controller
        assert model is not None
        return model

    def make(self, choice: Choice) -> Controller:
        """Make the controller."""
        law = text_controller(self.file(choice.variant), choice, self.name)
        compiled_controller = law.with_origin(
            **{
                name: replace(gain, origin="identified" if name in self.identified else self.origin)
                for name, gain in law.gains.items()
            }
        )
        compiled_controller.name = law.name
        return compiled_controller


def text_controller(
    path: str | os.PathLike[str],
    choice: Choice,
    name: str = "",
    change: Change | None = None,
    source: str | None = None,
) -> CompiledController:
    """Make the controller in a file, for the arm; `source` replaces the text of the file."""
    demand_text_file(path)
    source = read_text(path) if source is None else source
    parsed = parse_once(source, os.fspath(path))
    instead: dict[str, tuple[Sheet, ...]] = {}
    if parsed.controller is not None:
        known_roles = roles(parsed.controller)
        for role in choice.sources.given():
            if role not in known_roles:
                hint = f"it takes {', '.join(known_roles)}" if known_roles else ""
                raise SourceError(f"{name or path} takes no {role} from a file", hint=hint)
            sheets = choice.sources.sheets(role)
            instead[known_roles[role]] = sheets
            change = _both(change, by_name(known_roles[role], sheets[0]))
    text = read_controller(path, instead, change, source)
    compiled_controller = controller_of(text, choice)
    compiled_controller.name = name or compiled_controller.name
    return compiled_controller


def controller_of(text: ControllerText, choice: Choice | None = None) -> CompiledController:
    """Make a controller from its text, bound to the arm; a loop rebinds it to other plants."""
    return CompiledController(make_law(text, CatalogueLaws(choice or Choice())))


def controller_in(text: str, path: str) -> CompiledController:
    """Make the controller of a (maybe unsaved) text, for the arm.

    Parameters
    ----------
    text : str
        Of a controller; or of a rule base, which replaces that of ``fuzzy-direct``.
    path : str
        Its file; files of a controller are searched beside it.

    Raises
    ------
    RuleBaseError
        If it, or a file that it uses, has mistakes.
    SourceError
        If the rule base is not one of error and rate.
    """
    parsed = parse(text, path)
    if parsed.controller is None:
        if parsed.rulebase is None:
            raise RuleBaseError(parsed.diagnostics)
        law = controller("fuzzy-direct", sources=Sources(parsed.rulebase))
        assert isinstance(law, CompiledController)
        return law
    model, faults = with_files(parsed.controller, home_of(path), path)
    if faults:
        raise RuleBaseError(faults)
    return controller_of(replace(model, source=text))


@dataclass(frozen=True)
class CatalogueLaws:
    """The law of a partner by name; see ``FindLaw``."""

    choice: Choice

    def __call__(self, law: str) -> CompiledController:
        """Return a law of the catalogue with its gains."""
        record = CATALOGUE.get(law)
        controller = None
        if isinstance(record, Entry):
            controller = record.make(replace(self.choice, variant="as-printed", sources=NONE_GIVEN))
        if not isinstance(controller, CompiledController):
            laws = ", ".join(entry.name for entry in CONVENTIONAL if "+" not in entry.name)
            raise SourceError(
                f"no law of the catalogue is called '{law}'", hint=f"there are {laws}"
            )
        return controller


def _both(first: Change | None, second: Change) -> Change:
    return second if first is None else lambda model: second(first(model))


def roles(model: ControllerModel) -> dict[str, str]:
    """Return the name in a controller for each role of a given rule base or table.

    ``alpha`` is a rule base whose name begins so, ``rulebase`` the first other one,
    ``performance`` the performance table, ``table`` the first other one.
    """
    judges = {line.judge for _, line in model.lines() if isinstance(line, Learn)}
    kinds = {
        line.source.name: line.source.kind
        for _, line in model.lines()
        if isinstance(line, SignalLine) and line.source is not None and line.source.inputs
    }
    names: dict[str, str] = {}
    for use in model.uses:
        if use.name in judges:
            names.setdefault("performance", use.name)
        elif kinds.get(use.name) == "table":
            names.setdefault("table", use.name)
        elif use.name.startswith("alpha"):
            names.setdefault("alpha", use.name)
        else:
            names.setdefault("rulebase", use.name)
    return names


TEXTS = (
    TextEntry("fuzzy-lut"),
    TextEntry("fuzzy-lut-x10"),
    TextEntry("fuzzy-direct"),
    TextEntry("ct+fuzzy"),
    TextEntry("ffid+fuzzy"),
    TextEntry("cdid+fuzzy", identified=("K_I",)),
    TextEntry("acdid+fuzzy", adaptive=True),
    TextEntry("mrac+fuzzy", adaptive=True),
    TextEntry("dac+fuzzy", note=DIVERGES_ON_FAST_MOVES),
    TextEntry("soc-zero"),
    TextEntry("soc-table"),
    TextEntry("stfc"),
    TextEntry("hfie", identified=("K_I",)),
    TextEntry("cfaf"),
    TextEntry("fuzzy-fine", origin="own"),
    TextEntry("fuzzy-smooth", origin="own"),
    TextEntry("pd-motor", origin="own"),
    TextEntry("pd-motor-tuned", origin="own"),
    TextEntry("pid-smooth", origin="own"),
)
"""Their entries, in the order of the list."""


# --- Every controller by its name ---


class UnknownControllerError(FuzzyarmError, LookupError):
    """An unknown controller name; `near` has similar names."""

    def __init__(self, name: str, near: list[str]) -> None:
        if os.path.isdir(name):
            hint = "it is a folder: name a file in it"
        elif file_hint := missing_file_hint(name):
            hint = file_hint
        elif near:
            hint = did_you_mean(*near)
        else:
            hint = "fuzzyarm simulate --list names all"
        super().__init__(f"no controller '{name}'", hint=hint)
        self.name = name
        self.near = near


def controller(
    name: str,
    *,
    start: Start = "warm",
    variant: Variant = "as-printed",
    sources: Sources = NONE_GIVEN,
) -> Controller:
    """Make a controller by name.

    Parameters
    ----------
    name : str
        A name of the catalogue, or several with plus signs between: their sum.
    start : {"warm", "cold"}, optional
        Initial knowledge of adaptive controllers.
    variant : {"as-printed", "as-described"}, optional
        Which of the two, where the study's figures and text disagree.
    sources : Sources, optional
        Rule bases and tables in place of the shipped ones.

    Raises
    ------
    UnknownControllerError
        With near names.
    SourceError
        If a rule base or a table does not fit, or is not used.
    """
    entries = entries_of(name)
    require_taken(name, entries, sources)
    choice = Choice(start, variant, sources)
    if len(entries) == 1:
        return entries[0].make(choice)
    return Sum([entry.make(choice) for entry in entries], "+".join(e.name for e in entries))


def require_taken(name: str, entries: Sequence[Entry | TextEntry], sources: Sources) -> None:
    """Raise SourceError for a source unused by every part of `name`."""
    for role_given in sources.given():
        if not any(role_given in entry.accepts for entry in entries):
            accepted = sorted({role for entry in entries for role in entry.accepts})
            hint = f"it takes {', '.join(accepted)}" if accepted else ""
            raise SourceError(f"{name} takes no {role_given} from a file", hint=hint)


def entries_of(name: str) -> list[Entry | TextEntry]:
    """Return the entry of a name, or those of the addends of a sum."""
    names = [part.strip() for part in name.split("+")]
    name_of_sum = "+".join(names)
    if name_of_sum in CATALOGUE:
        return [CATALOGUE[name_of_sum]]
    names = [ADDENDS.get(part, part) for part in names]
    for part in names:
        if part not in CATALOGUE:
            raise UnknownControllerError(part or name, near_names(part or name))
    return [CATALOGUE[part] for part in names]


def entries_if_any(name: str) -> list[Entry | TextEntry]:
    """Return the entries of a name or a sum; none for a file."""
    try:
        return entries_of(name)
    except UnknownControllerError:
        return []


def notes_on(name: str) -> list[str]:
    """Return the notes on where not to use the controllers of a name or a sum; none for a file."""
    return [f"{entry.name} {entry.note}" for entry in entries_if_any(name) if entry.note]


def near_names(name: str) -> list[str]:
    """Return up to three similar names of the catalogue."""
    return several_nearest(name, CATALOGUE)


ADDENDS = {"fuzzy": "fuzzy-lut"}
"""Short names in a sum, as the hybrids of the study have them (``cdid+fuzzy``)."""

CATALOGUE: dict[str, Entry | TextEntry] = {entry.name: entry for entry in (*CONVENTIONAL, *TEXTS)}
"""Every controller by its name."""
