"""Every controller by its name.

The values here are those of the study where it prints them; the others were identified
from its figures (``fuzzyarm identify``) and say so. Where text and figures disagree a
controller exists in two variants: ``as-printed`` gives the published figures and is the
default, ``as-described`` follows the text.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from fuzzyarm.arm.conventions import STUDY_CONVENTIONAL, Conventions
from fuzzyarm.control import (
    adaptive_critically_damped,
    computed_torque,
    critically_damped,
    decentralised,
    feed_forward_inverse,
    integral,
    model_reference,
    pd,
    pure_feed_forward,
)
from fuzzyarm.control.controller import CompiledController, Controller, Sum
from fuzzyarm.control.gains import Origin
from fuzzyarm.control.law import Law
from fuzzyarm.errors import FuzzyarmError

Start = Literal["warm", "cold"]
Variant = Literal["as-printed", "as-described"]

UNKNOWN_BODY = ("m_1", "m_2", "x_1", "x_2", "I_1", "I_2", "F_1", "F_2")
"""What a cold start does not know of the arm."""

MOTORS = ("J_1", "J_2")


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
        From start and variant to the controller.
    conventions : Conventions
        How the study counted where it used this controller.
    adaptive : bool
        Whether warm and cold start differ.
    """

    name: str
    summary: str
    make: Callable[[Start, Variant], Controller]
    conventions: Conventions = STUDY_CONVENTIONAL
    adaptive: bool = False


def controller(name: str, *, start: Start = "warm", variant: Variant = "as-printed") -> Controller:
    """Make a controller by name.

    Parameters
    ----------
    name : str
        A name of the catalogue, or several with plus signs between: their sum.
    start : {"warm", "cold"}, optional
        What adaptive controllers know at the start.
    variant : {"as-printed", "as-described"}, optional
        Which of the two, where the study's figures and text disagree.

    Raises
    ------
    UnknownControllerError
        With near names.
    """
    if name in CATALOGUE:
        return CATALOGUE[name].make(start, variant)
    names = [part.strip() for part in name.split("+")]
    joined = "+".join(names)
    if joined != name and joined in CATALOGUE:
        return CATALOGUE[joined].make(start, variant)
    for part in names:
        if part not in CATALOGUE:
            raise UnknownControllerError(part or name, near_names(part or name))
    return Sum([CATALOGUE[part].make(start, variant) for part in names], joined)


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


def _plain(law: Law) -> Callable[[Start, Variant], Controller]:
    return lambda _start, _variant: CompiledController(law)


def _changed(law: Law, values: dict[str, float], origin: Origin = "printed") -> CompiledController:
    made = CompiledController(law)
    return made.with_origin(
        **{name: made.gains[name].with_value([value], origin) for name, value in values.items()}
    )


def integral_action(
    gain: float, *, whole_run: bool = False, origin: Origin = "printed"
) -> CompiledController:
    """Make the integral term: five-sample sum, or the sum over the whole run."""
    values = {"K_I": gain, "whole_run": float(whole_run)}
    return _changed(integral.LAW, values, origin)


def _computed_torque(_start: Start, variant: Variant) -> Controller:
    # The printed law has no friction term; the figures were made with one.
    without = {"model.F_1": 0.0, "model.F_2": 0.0}
    return _changed(computed_torque.LAW, without if variant == "as-described" else {})


def _acdid(start: Start, variant: Variant) -> CompiledController:
    values = (
        dict.fromkeys((f"model.{name}" for name in UNKNOWN_BODY), 0.0) if start == "cold" else {}
    )
    made = _changed(adaptive_critically_damped.LAW, values)
    if variant == "as-described":
        slip = made.gains["velocity_in_W22"].with_value([0.0], "printed")
        return made.with_origin(velocity_in_W22=slip)
    return made


def _mrac(start: Start, variant: Variant) -> CompiledController:
    unknown = (f"model.{name}" for name in (*UNKNOWN_BODY, *MOTORS))
    made = _changed(model_reference.LAW, dict.fromkeys(unknown, 0.0) if start == "cold" else {})
    if variant == "as-described":
        form = made.gains["inertia_times_u"].with_value([1.0], "printed")
        return made.with_origin(inertia_times_u=form)
    return made


def _dac(_start: Start, _variant: Variant) -> CompiledController:
    return CompiledController(decentralised.LAW)


def _with_integral(
    name: str, base: Callable[[Start, Variant], Controller], whole_run_gain: float | None = None
) -> Callable[[Start, Variant], Controller]:
    """Add integral action; the adaptive rows were made with a whole-run sum.

    The text describes a sum over the iterations of a set point there too: of these
    rows the variants differ in the sum alone, and the rest is as printed.
    """

    def make(start: Start, variant: Variant) -> Controller:
        if whole_run_gain is None:
            term = integral_action(50.0)
            return Sum([base(start, variant), term], name)
        if variant == "as-described":
            term = integral_action(50.0, origin="own")
        else:
            term = integral_action(whole_run_gain, whole_run=True, origin="identified")
        return Sum([base(start, "as-printed"), term], name)

    return make


def _pid(_start: Start, _variant: Variant) -> Controller:
    return Sum([CompiledController(pd.LAW), integral_action(0.25, whole_run=True)], "pid")


def _pid_modified(_start: Start, _variant: Variant) -> Controller:
    return Sum([CompiledController(pd.LAW), integral_action(50.0)], "pid-modified")


_FFID = _plain(feed_forward_inverse.LAW)
_CDID = _plain(critically_damped.LAW)

_ENTRIES = (
    Entry("pd", "proportional plus derivative", _plain(pd.LAW)),
    Entry("pid", "PD plus the sum of errors over the whole run", _pid),
    Entry("pid-modified", "PD plus the sum over the iterations of a set point", _pid_modified),
    Entry("ct", computed_torque.LAW.summary, _computed_torque),
    Entry("ffid", feed_forward_inverse.LAW.summary, _FFID),
    Entry("cdid", critically_damped.LAW.summary, _CDID),
    Entry("feedforward", pure_feed_forward.LAW.summary, _plain(pure_feed_forward.LAW)),
    Entry("ct+ie", "ct plus integral of the error", _with_integral("ct+ie", _computed_torque)),
    Entry("ffid+ie", "ffid plus integral of the error", _with_integral("ffid+ie", _FFID)),
    Entry("cdid+ie", "cdid plus integral of the error", _with_integral("cdid+ie", _CDID)),
    Entry("acdid", adaptive_critically_damped.LAW.summary, _acdid, adaptive=True),
    Entry(
        "acdid+ie",
        "acdid plus integral of the error",
        _with_integral("acdid+ie", _acdid, 300.0),
        adaptive=True,
    ),
    Entry("mrac", model_reference.LAW.summary, _mrac, adaptive=True),
    Entry(
        "mrac+ie",
        "mrac plus integral of the error",
        _with_integral("mrac+ie", _mrac, 10.1),
        adaptive=True,
    ),
    Entry("dac", decentralised.LAW.summary, _dac),
    Entry("dac+ie", "dac plus integral of the error", _with_integral("dac+ie", _dac, 50.0)),
    Entry("ie", integral.LAW.summary, _plain(integral.LAW)),
)

CATALOGUE: dict[str, Entry] = {entry.name: entry for entry in _ENTRIES}
"""Every controller by its name."""
