"""The conventional and adaptive controllers of the catalogue.

The values are those of the study where it prints them; the others were identified from
its figures (``fuzzyarm identify``) and say so.
"""

from __future__ import annotations

from dataclasses import replace

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
from fuzzyarm.control.entry import Choice, Entry, Maker, changed
from fuzzyarm.control.gains import Origin
from fuzzyarm.control.law import Law

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
    return changed(integral.LAW, values, origin)


def computed_torque_of(choice: Choice) -> CompiledController:
    """Make computed torque, with friction in its law or without."""
    # The printed law has no friction term; the figures were made with one.
    without = {"model.F_1": 0.0, "model.F_2": 0.0}
    return changed(computed_torque.LAW, without if choice.described else {})


def acdid(choice: Choice) -> CompiledController:
    """Make the adaptive controller, with W22 as printed or as in theory."""
    values = (
        dict.fromkeys((f"model.{name}" for name in UNKNOWN_BODY), 0.0)
        if choice.start == "cold"
        else {}
    )
    made = changed(adaptive_critically_damped.LAW, values)
    if choice.described:
        slip = made.gains["velocity_in_W22"].with_value([0.0], "printed")
        return made.with_origin(velocity_in_W22=slip)
    return made


def mrac(choice: Choice) -> CompiledController:
    """Make model reference control, in the form of the figures or of the text."""
    unknown = (f"model.{name}" for name in (*UNKNOWN_BODY, *MOTORS))
    made = changed(
        model_reference.LAW, dict.fromkeys(unknown, 0.0) if choice.start == "cold" else {}
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
    return Sum([CompiledController(pd.LAW), integral_action(0.25, whole_run=True)], "pid")


def _pid_modified(_choice: Choice) -> Controller:
    return Sum([CompiledController(pd.LAW), integral_action(50.0)], "pid-modified")


FFID = plain(feed_forward_inverse.LAW)
CDID = plain(critically_damped.LAW)
DAC = plain(decentralised.LAW)

CONVENTIONAL = (
    Entry("pd", "proportional plus derivative", plain(pd.LAW)),
    Entry("pid", "PD plus the sum of errors over the whole run", _pid),
    Entry("pid-modified", "PD plus the sum over the iterations of a set point", _pid_modified),
    Entry("ct", computed_torque.LAW.summary, computed_torque_of),
    Entry("ffid", feed_forward_inverse.LAW.summary, FFID),
    Entry("cdid", critically_damped.LAW.summary, CDID),
    Entry("feedforward", pure_feed_forward.LAW.summary, plain(pure_feed_forward.LAW)),
    Entry("ct+ie", "ct plus integral of the error", with_integral("ct+ie", computed_torque_of)),
    Entry("ffid+ie", "ffid plus integral of the error", with_integral("ffid+ie", FFID)),
    Entry("cdid+ie", "cdid plus integral of the error", with_integral("cdid+ie", CDID)),
    Entry("acdid", adaptive_critically_damped.LAW.summary, acdid, adaptive=True),
    Entry(
        "acdid+ie",
        "acdid plus integral of the error",
        with_integral("acdid+ie", acdid, 300.0),
        adaptive=True,
    ),
    Entry("mrac", model_reference.LAW.summary, mrac, adaptive=True),
    Entry(
        "mrac+ie",
        "mrac plus integral of the error",
        with_integral("mrac+ie", mrac, 10.1),
        adaptive=True,
    ),
    Entry("dac", decentralised.LAW.summary, DAC),
    Entry("dac+ie", "dac plus integral of the error", with_integral("dac+ie", DAC, 50.0)),
    Entry("ie", integral.LAW.summary, plain(integral.LAW)),
)
"""Their entries, in the order of the list."""
