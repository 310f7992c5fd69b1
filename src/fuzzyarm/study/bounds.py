"""How near a reproduced row has to be, and what is known where it is not."""

from __future__ import annotations

from dataclasses import dataclass

from fuzzyarm.study.published import MAXIMUM_ON, Eight, PublishedRow


@dataclass(frozen=True)
class Bound:
    """Largest allowed differences of a row.

    Parameters
    ----------
    rms : float
        Of every RMS figure, relative.
    mean_rms : float or None, optional
        Of the mean over the RMS figures, relative; not bounded by default.
    final : bool, optional
        Whether every final error has to be within 0.001 degree or 0.5 %.
    """

    rms: float
    mean_rms: float | None = None
    final: bool = True


FINAL_ABSOLUTE = 0.001
"""Degrees."""

FINAL_RELATIVE = 0.005

_DEFAULT = Bound(0.005)
_BOUNDS = {
    "acdid+ie": Bound(0.01, final=False),
    "mrac": Bound(0.01, final=False),
    "mrac+ie": Bound(0.01, final=False),
    "7.1.1/mrac+ie": Bound(0.04, final=False),
    "dac": Bound(0.05, mean_rms=0.02, final=False),
    "dac+ie": Bound(0.05, mean_rms=0.02, final=False),
}

_NOTES = {
    "4.2.5.1/pid": (
        "the final error of link 1 on the first trajectory is 0.0013° where 0.0 was printed: a "
        "slow swing of the integral has not died out (double precision leaves 0.0024°)"
    ),
    "acdid": "the maximum of link 2 is a difference of nearly cancelling terms (chaotic)",
    "acdid+ie": "the maximum of link 2 is a difference of nearly cancelling terms (chaotic)",
    "dac": "the gains are not unique; final errors are small differences of large terms",
    "dac+ie": "the gains are not unique; final errors are small differences of large terms",
}


@dataclass(frozen=True)
class Judgement:
    """Whether a row came out.

    Attributes
    ----------
    within : bool
        Inside the bounds.
    worst_rms, mean_rms : float
        Largest and mean relative difference of the four RMS figures.
    bound : Bound
        That applied.
    faults : tuple of str
        What is outside, in words.
    note : str
        What is known about the row.
    """

    within: bool
    worst_rms: float
    mean_rms: float
    bound: Bound
    faults: tuple[str, ...]
    note: str

    @property
    def sentence(self) -> str:
        """One line of verdict."""
        bound = f"bound {100 * self.bound.rms:g} %"
        if self.bound.mean_rms is not None:
            bound += f", mean {100 * self.mean_rms:.2f} % of {100 * self.bound.mean_rms:g} %"
        head = "agrees" if self.within else "DIFFERS"
        text = f"{head}: RMS within {100 * self.worst_rms:.2f} % ({bound})"
        return "; ".join([text, *self.faults])


def judge(row: PublishedRow, figures: Eight) -> Judgement:
    """Compare reproduced figures with the published ones.

    Parameters
    ----------
    row : PublishedRow
        What was published.
    figures : tuple of float
        The eight numbers that came out, degrees.
    """
    bound = _BOUNDS.get(row.identifier, _BOUNDS.get(row.controller, _DEFAULT))
    apart = [abs(figures[i] / row.figures[i] - 1.0) for i in (0, 2, 4, 6)]
    worst, mean = max(apart), sum(apart) / 4
    faults = []
    if worst > bound.rms or (bound.mean_rms is not None and mean > bound.mean_rms):
        faults.append("RMS outside")
    for i in (1, 3, 5, 7):
        if row.trajectories[i // 4] == MAXIMUM_ON or not bound.final:
            continue
        difference = abs(figures[i] - row.figures[i])
        allowed = max(FINAL_ABSOLUTE, FINAL_RELATIVE * abs(row.figures[i]))
        if difference > allowed:
            faults.append(f"a final error is {difference:.4f}° off")
    note = _NOTES.get(row.identifier, _NOTES.get(row.controller, ""))
    return Judgement(not faults, worst, mean, bound, tuple(faults), note)
