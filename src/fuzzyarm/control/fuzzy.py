"""The fuzzy controllers of the catalogue, alone and in sums with others.

Rules and tables come from files: shipped ones, or those of the caller. Where text and
figures of the study disagree, ``as-printed`` has what gives the figures: sets and a
transposed table that follow from them, an inexact model, an integral that the text does
not mention. ``as-described`` has evenly spread sets and the tables as they are printed.
"""

from __future__ import annotations

from dataclasses import replace

from fuzzyarm.arm.conventions import STUDY_DIRECT, STUDY_TABLES
from fuzzyarm.control import (
    critically_damped,
    decentralised,
    feed_forward_inverse,
)
from fuzzyarm.control.controller import CompiledController, Controller, Sum
from fuzzyarm.control.conventional import acdid, computed_torque_of, integral_action, mrac
from fuzzyarm.control.entry import Choice, Entry, Maker, changed
from fuzzyarm.control.fuzzy_rules import coarse_fine_law, direct_law, self_tuning_law
from fuzzyarm.control.fuzzy_table import fuzzy_table_law
from fuzzyarm.control.law import Law
from fuzzyarm.control.self_organizing import self_organizing_law
from fuzzyarm.control.sources import shipped_rulebase, shipped_table
from fuzzyarm.lut import LookupTable
from fuzzyarm.rulebase import RuleBase

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
    return changed(feed_forward_inverse.LAW, {} if choice.described else wrong, "identified")


def _cdid(_choice: Choice) -> Controller:
    return CompiledController(critically_damped.LAW)


def _mrac_without_gravity(choice: Choice) -> Controller:
    if choice.described:
        return mrac(choice)
    gone = {"gravity": 0.0, "acceleration_in_v": 0.0}
    made = mrac(choice)
    return made.with_origin(
        **{name: made.gains[name].with_value([value], "identified") for name, value in gone.items()}
    )


def _dac(_choice: Choice) -> Controller:
    return CompiledController(decentralised.LAW)


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
