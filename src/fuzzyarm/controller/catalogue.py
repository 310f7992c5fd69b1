"""Every controller by its name.

The values here are those of the study where it prints them; the others were identified
from its figures (``fuzzyarm identify``) and say so. Where text and figures disagree a
controller exists in two variants: ``as-printed`` gives the published figures and is the
default, ``as-described`` follows the text.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from fuzzyarm.controller.adaptive import (
    ADAPTIVE_CRITICALLY_DAMPED_LAW,
    DECENTRALISED_LAW,
    MODEL_REFERENCE_LAW,
)
from fuzzyarm.controller.controller import CompiledController, Controller, Sum
from fuzzyarm.controller.conventional import (
    COMPUTED_TORQUE_LAW,
    CRITICALLY_DAMPED_LAW,
    FEED_FORWARD_INVERSE_LAW,
    INTEGRAL_LAW,
    PD_LAW,
    PURE_FEED_FORWARD_LAW,
)
from fuzzyarm.controller.fuzzy import coarse_fine_law, direct_law, fuzzy_table_law, self_tuning_law
from fuzzyarm.controller.law import Law, Origin
from fuzzyarm.controller.self_organizing import self_organizing_law
from fuzzyarm.controller.sources import (
    NONE_GIVEN,
    SourceError,
    Sources,
    shipped_rulebase,
    shipped_table,
)
from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.plant.setting import STUDY_CONVENTIONAL, STUDY_DIRECT, STUDY_TABLES, Conventions
from fuzzyarm.table import LookupTable

# --- What an entry of the catalogue is, and what its maker is asked for ---

Start = Literal["warm", "cold"]
Variant = Literal["as-printed", "as-described"]


@dataclass(frozen=True)
class Choice:
    """Which of the controllers of one name.

    Parameters
    ----------
    start : {"warm", "cold"}, optional
        What adaptive controllers know at the start.
    variant : {"as-printed", "as-described"}, optional
        By the study's figures or by its text, where they disagree.
    sources : Sources, optional
        Rule bases and tables in place of the shipped ones.
    """

    start: Start = "warm"
    variant: Variant = "as-printed"
    sources: Sources = field(default_factory=Sources)

    @property
    def described(self) -> bool:
        """Whether the text is followed."""
        return self.variant == "as-described"


Maker = Callable[[Choice], Controller]


@dataclass(frozen=True)
class Entry:
    """One controller of the catalogue.

    Parameters
    ----------
    name : str
        As commands take it.
    summary : str
        One line.
    make : callable
        From a choice to the controller.
    conventions : Conventions
        How the study counted where it used this controller.
    adaptive : bool
        Whether warm and cold start differ.
    takes : tuple of str
        Which of the :class:`Sources` it reads.
    """

    name: str
    summary: str
    make: Maker
    conventions: Conventions = STUDY_CONVENTIONAL
    adaptive: bool = False
    takes: tuple[str, ...] = ()


def changed(law: Law, values: dict[str, float], origin: Origin = "printed") -> CompiledController:
    """Make the controller of a law with some gains set."""
    made = CompiledController(law)
    return made.with_origin(
        **{name: made.gains[name].with_value([value], origin) for name, value in values.items()}
    )


# --- The conventional and adaptive controllers of the catalogue ---

UNKNOWN_BODY = ("m_1", "m_2", "x_1", "x_2", "I_1", "I_2", "F_1", "F_2")
"""What a cold start does not know of the arm."""

MOTORS = ("J_1", "J_2")


def plain(law: Law) -> Maker:
    """Return the maker of a law that knows no choice."""
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
    """Make the adaptive controller, with W22 as printed or as in theory."""
    values = (
        dict.fromkeys((f"model.{name}" for name in UNKNOWN_BODY), 0.0)
        if choice.start == "cold"
        else {}
    )
    made = changed(ADAPTIVE_CRITICALLY_DAMPED_LAW, values)
    if choice.described:
        slip = made.gains["velocity_in_W22"].with_value([0.0], "printed")
        return made.with_origin(velocity_in_W22=slip)
    return made


def mrac(choice: Choice) -> CompiledController:
    """Make model reference control, in the form of the figures or of the text."""
    unknown = (f"model.{name}" for name in (*UNKNOWN_BODY, *MOTORS))
    made = changed(
        MODEL_REFERENCE_LAW, dict.fromkeys(unknown, 0.0) if choice.start == "cold" else {}
    )
    if choice.described:
        form = made.gains["inertia_times_u"].with_value([1.0], "printed")
        return made.with_origin(inertia_times_u=form)
    return made


def with_integral(name: str, base: Maker, whole_run_gain: float | None = None) -> Maker:
    """Add integral action; the adaptive rows were made with a whole-run sum.

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


FFID = plain(FEED_FORWARD_INVERSE_LAW)
CDID = plain(CRITICALLY_DAMPED_LAW)
DAC = plain(DECENTRALISED_LAW)

CONVENTIONAL = (
    Entry("pd", "proportional plus derivative", plain(PD_LAW)),
    Entry("pid", "PD plus the sum of errors over the whole run", _pid),
    Entry("pid-modified", "PD plus the sum over the iterations of a set point", _pid_modified),
    Entry("ct", COMPUTED_TORQUE_LAW.summary, computed_torque_of),
    Entry("ffid", FEED_FORWARD_INVERSE_LAW.summary, FFID),
    Entry("cdid", CRITICALLY_DAMPED_LAW.summary, CDID),
    Entry("feedforward", PURE_FEED_FORWARD_LAW.summary, plain(PURE_FEED_FORWARD_LAW)),
    Entry("ct+ie", "ct plus integral of the error", with_integral("ct+ie", computed_torque_of)),
    Entry("ffid+ie", "ffid plus integral of the error", with_integral("ffid+ie", FFID)),
    Entry("cdid+ie", "cdid plus integral of the error", with_integral("cdid+ie", CDID)),
    Entry("acdid", ADAPTIVE_CRITICALLY_DAMPED_LAW.summary, acdid, adaptive=True),
    Entry(
        "acdid+ie",
        "acdid plus integral of the error",
        with_integral("acdid+ie", acdid, 300.0),
        adaptive=True,
    ),
    Entry("mrac", MODEL_REFERENCE_LAW.summary, mrac, adaptive=True),
    Entry(
        "mrac+ie",
        "mrac plus integral of the error",
        with_integral("mrac+ie", mrac, 10.1),
        adaptive=True,
    ),
    Entry("dac", DECENTRALISED_LAW.summary, DAC),
    Entry("dac+ie", "dac plus integral of the error", with_integral("dac+ie", DAC, 50.0)),
    Entry("ie", INTEGRAL_LAW.summary, plain(INTEGRAL_LAW)),
)
"""Their entries, in the order of the list."""


# --- The fuzzy controllers of the catalogue, alone and in sums with others ---
#
# Rules and tables come from files: shipped ones, or those of the caller. Where text and
# figures of the study disagree, `as-printed` has what gives the figures: sets and a
# transposed table that follow from them, an inexact model, an integral that the text does
# not mention. `as-described` has evenly spread sets and the tables as they are printed.

TABLE = "thesis-6.1.lut"
PERFORMANCE = "performance-yamazaki.lut"

FINE_ERROR = {"G_e": 1080.0}
"""Error gain from section 6.3 on, ten times that of 6.1."""

PROGRAM_A3 = {"supply": 24.0, "full_scale": 5.6}
"""Supply and full scale in the one hybrid program that is printed."""


def table_of(choice: Choice) -> LookupTable:
    """Return the table of the control."""
    return choice.sources.table or shipped_table(TABLE)


def rules_of(choice: Choice) -> RuleBase:
    """Return the rule base of the control."""
    shipped = "pd7.frb" if choice.described else "pd7-study.frb"
    return choice.sources.rulebase or shipped_rulebase(shipped)


def alpha_of(choice: Choice) -> RuleBase:
    """Return the rule base of the factor on the control."""
    shipped = "alpha7.frb" if choice.described else "alpha7-study.frb"
    return choice.sources.alpha or shipped_rulebase(shipped)


def fuzzy_table(choice: Choice, values: dict[str, float] | None = None) -> CompiledController:
    """Make control by a table, with some gains set."""
    return changed(fuzzy_table_law(table_of(choice)), values or {})


def _fuzzy_lut(choice: Choice) -> Controller:
    return fuzzy_table(choice)


def _fuzzy_lut_x10(choice: Choice) -> Controller:
    return _renamed(fuzzy_table(choice, FINE_ERROR), "fuzzy-lut-x10")


def _renamed(made: CompiledController, name: str) -> CompiledController:
    return CompiledController(replace(made.law, name=name), made.gains)


def _with_table(
    name: str, base: Maker, printed: dict[str, float], whole_run: float | None = None
) -> Maker:
    """Add control by a table; as described always with the gains of the printed program."""

    def make(choice: Choice) -> Controller:
        values = PROGRAM_A3 if choice.described else printed
        addends: list[Controller] = [base(choice), fuzzy_table(choice, values)]
        if whole_run is not None and not choice.described:
            addends.append(integral_action(whole_run, whole_run=True, origin="identified"))
        return Sum(addends, name)

    return make


def _ffid(choice: Choice) -> Controller:
    # The figures need the model of the rows with wrong masses.
    wrong = {"model.m_1": 1.8, "model.m_2": 1.8}
    return changed(FEED_FORWARD_INVERSE_LAW, {} if choice.described else wrong, "identified")


def _cdid(_choice: Choice) -> Controller:
    return CompiledController(CRITICALLY_DAMPED_LAW)


def _mrac_without_gravity(choice: Choice) -> Controller:
    if choice.described:
        return mrac(choice)
    gone = {"gravity": 0.0, "acceleration_in_v": 0.0}
    made = mrac(choice)
    return made.with_origin(
        **{name: made.gains[name].with_value([value], "identified") for name, value in gone.items()}
    )


def _dac(_choice: Choice) -> Controller:
    return CompiledController(DECENTRALISED_LAW)


def _soc(name: str, *, from_table: bool) -> Maker:
    def make(choice: Choice) -> Controller:
        start = choice.sources.table
        if start is None and from_table:
            start = shipped_table(TABLE)
        performance = choice.sources.performance or shipped_table(PERFORMANCE)
        law = self_organizing_law(start, performance)
        return _renamed(changed(law, FINE_ERROR), name)

    return make


def _direct(choice: Choice) -> Controller:
    return CompiledController(direct_law(rules_of(choice)))


def _fine(choice: Choice) -> Controller:
    rules = choice.sources.rulebase or shipped_rulebase("fine7.frb")
    return _renamed(CompiledController(direct_law(rules)), "fuzzy-fine")


def _hfie(choice: Choice) -> Controller:
    # The printed program has 6000; the figures were made with 1500.
    gain = 6000.0 if choice.described else 1500.0
    term = integral_action(gain, origin="printed" if choice.described else "identified")
    return Sum([CompiledController(direct_law(rules_of(choice))), term], "hfie")


def _ruled(law: Law) -> Controller:
    return CompiledController(law)


FUZZY = (
    Entry(
        "fuzzy-lut",
        "fuzzy control by a lookup table, through motors with back-EMF",
        _fuzzy_lut,
        STUDY_TABLES,
        takes=("table",),
    ),
    Entry(
        "fuzzy-lut-x10",
        "fuzzy-lut with ten times the error gain",
        _fuzzy_lut_x10,
        STUDY_TABLES,
        takes=("table",),
    ),
    Entry(
        "fuzzy-direct",
        "direct fuzzy control: the rules evaluated at every step",
        _direct,
        STUDY_DIRECT,
        takes=("rulebase",),
    ),
    Entry(
        "ct+fuzzy",
        "ct plus fuzzy-lut",
        _with_table("ct+fuzzy", computed_torque_of, PROGRAM_A3),
        STUDY_TABLES,
        takes=("table",),
    ),
    Entry(
        "ffid+fuzzy",
        "ffid plus fuzzy-lut",
        _with_table("ffid+fuzzy", _ffid, {}),
        STUDY_TABLES,
        takes=("table",),
    ),
    Entry(
        "cdid+fuzzy",
        "cdid plus fuzzy-lut",
        _with_table("cdid+fuzzy", _cdid, {}, whole_run=50.0),
        STUDY_TABLES,
        takes=("table",),
    ),
    Entry(
        "acdid+fuzzy",
        "acdid plus fuzzy-lut",
        _with_table("acdid+fuzzy", acdid, PROGRAM_A3),
        STUDY_TABLES,
        adaptive=True,
        takes=("table",),
    ),
    Entry(
        "mrac+fuzzy",
        "mrac plus fuzzy-lut",
        _with_table("mrac+fuzzy", _mrac_without_gravity, {}),
        STUDY_TABLES,
        adaptive=True,
        takes=("table",),
    ),
    Entry(
        "dac+fuzzy",
        "dac plus fuzzy-lut",
        _with_table("dac+fuzzy", _dac, PROGRAM_A3),
        STUDY_TABLES,
        takes=("table",),
    ),
    Entry(
        "soc-zero",
        "self-organizing control from a table of zeros",
        _soc("soc-zero", from_table=False),
        STUDY_TABLES,
        takes=("table", "performance"),
    ),
    Entry(
        "soc-table",
        "self-organizing control from the table of fuzzy-lut",
        _soc("soc-table", from_table=True),
        STUDY_TABLES,
        takes=("table", "performance"),
    ),
    Entry(
        "stfc",
        "self-tuning fuzzy control: a second rule base scales the output",
        lambda choice: _ruled(self_tuning_law(rules_of(choice), alpha_of(choice))),
        STUDY_DIRECT,
        takes=("rulebase", "alpha"),
    ),
    Entry(
        "hfie",
        "fuzzy-direct plus integral of the error",
        _hfie,
        STUDY_DIRECT,
        takes=("rulebase",),
    ),
    Entry(
        "cfaf",
        "coarse/fine fuzzy control: stfc with small errors magnified",
        lambda choice: _ruled(coarse_fine_law(rules_of(choice), alpha_of(choice))),
        STUDY_DIRECT,
        takes=("rulebase", "alpha"),
    ),
    Entry(
        "fuzzy-fine",
        "fuzzy-direct with narrow sets; not of the study",
        _fine,
        STUDY_TABLES,
        takes=("rulebase",),
    ),
)
"""Their entries, in the order of the list."""


# --- Every controller by its name ---


class UnknownControllerError(FuzzyarmError, LookupError):
    """No controller has this name; `name` is the one asked for, `near` the likely ones."""

    def __init__(self, name: str, near: list[str]) -> None:
        if near:
            hint = "did you mean " + " or ".join(f"'{each}'" for each in near) + "?"
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
        What adaptive controllers know at the start.
    variant : {"as-printed", "as-described"}, optional
        Which of the two, where the study's figures and text disagree.
    sources : Sources, optional
        Rule bases and tables in place of the shipped ones.

    Raises
    ------
    UnknownControllerError
        With near names.
    SourceError
        If a rule base or a table does not serve, or nothing reads it.
    """
    entries = entries_of(name)
    require_taken(name, entries, sources)
    choice = Choice(start, variant, sources)
    if len(entries) == 1:
        return entries[0].make(choice)
    return Sum([entry.make(choice) for entry in entries], "+".join(e.name for e in entries))


def require_taken(name: str, entries: Sequence[Entry], sources: Sources) -> None:
    """Raise SourceError if nothing in `entries`, which make up `name`, reads a given source."""
    for given in sources.given():
        if not any(given in entry.takes for entry in entries):
            taken = sorted({each for entry in entries for each in entry.takes})
            hint = f"it takes {', '.join(taken)}" if taken else ""
            raise SourceError(f"{name} takes no {given} from a file", hint=hint)


def entries_of(name: str) -> list[Entry]:
    """Return the entry of a name, or those of the addends of a sum.

    Raises
    ------
    UnknownControllerError
        With near names.
    """
    names = [part.strip() for part in name.split("+")]
    joined = "+".join(names)
    if joined in CATALOGUE:
        return [CATALOGUE[joined]]
    names = [ADDENDS.get(part, part) for part in names]
    for part in names:
        if part not in CATALOGUE:
            raise UnknownControllerError(part or name, near_names(part or name))
    return [CATALOGUE[part] for part in names]


def near_names(name: str) -> list[str]:
    """Return up to three names of the catalogue that look like `name`."""
    import difflib

    return difflib.get_close_matches(name.lower(), list(CATALOGUE), n=3, cutoff=0.5)


def study_conventions(name: str) -> Conventions:
    """Return how the study counted for a controller, or for the first part of a sum."""
    for part in (name, *name.split("+")):
        if part.strip() in CATALOGUE:
            return CATALOGUE[part.strip()].conventions
    return STUDY_CONVENTIONAL


ADDENDS = {"fuzzy": "fuzzy-lut"}
"""Short names in a sum, as the hybrids of the study have them (``cdid+fuzzy``)."""

CATALOGUE: dict[str, Entry] = {entry.name: entry for entry in (*CONVENTIONAL, *FUZZY)}
"""Every controller by its name."""
