"""Claims about intervals of parameters, proved part by part.

A region has one function for all parameters of its claim, so that wide intervals have a small
region or none. If the whole is undecided and its midpoint is proved, the parameters are halved; the
parts together are the claim.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from fuzzyarm.base.numbers import number_text
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.course import Sensor
from fuzzyarm.language.loop_claims import stretch_text
from fuzzyarm.language.model.claims import LoopClaim, Stretch
from fuzzyarm.language.tokens import name_text
from fuzzyarm.plant.plant import Plant
from fuzzyarm.proof.check.certificate import Certificate, Part
from fuzzyarm.proof.check.theorem import demand_proved
from fuzzyarm.proof.claim.text import GivenLoop, claimed_plant
from fuzzyarm.proof.loop.verdicts import PROVED, REFUTED, UNDECIDED, LoopVerdict, Tell, judged
from fuzzyarm.proof.stop import LOOP_BUDGET, TUBE_BUDGET, Stop, default_budget

MOST_HALVINGS = 6
"""Most halvings of a parameter's interval."""


def prove_loop(
    text: ControllerText,
    claim: LoopClaim,
    *,
    plant: Plant | None = None,
    connect: Mapping[str, str] | None = None,
    sensors: Mapping[str, Sensor] | None = None,
    budget: float = math.inf,
    continuous: bool = False,
    tell: Tell | None = None,
) -> LoopVerdict:
    """Prove or refute a claim about a controller in its loop.

    Parameters
    ----------
    text : ControllerText
        The controller.
    claim : LoopClaim
        The claim.
    plant : Plant, optional
        In place of the plant named in the claim, which is loaded only if it is shipped, or if the
        claim is not from a file: else its code would run.
    connect : mapping of str to str, optional
        Port of the plant for each name of the controller that differs.
    sensors : mapping of str to Sensor, optional
        By port; exact ones by default.
    budget : float
        Processor seconds until the verdict is undecided; infinite: two minutes of a claim for a
        bounded time, else five.
    continuous : bool
        Prove the loop in continuous time, without a period.
    tell : callable, optional
        Called with the claim, the number of attempts and NaN.

    Returns
    -------
    LoopVerdict
        With its certificate or its evidence.

    Raises
    ------
    PlantError
        If there is no such plant, or it has no such port.
    ClaimError
        If the claim has an unknown state or parameter, or ends in the wrong order.
    """
    plant = claimed_plant(claim) if plant is None else plant
    return _Halving(GivenLoop(text, plant, connect, sensors), claim, budget, tell,
                    continuous=continuous).verdict()  # fmt: skip


def joined(claim: LoopClaim, parts: Sequence[Certificate]) -> Certificate:
    """Return the certificate of a claim, composed of those of its parts."""
    return replace(
        parts[0], claim=claim, regions=(), tubes=(),
        parts=tuple(Part(each.claim.parameters, each.regions, each.tubes) for each in parts),
    )  # fmt: skip


class _Halving:
    """The proof of a claim by halving its intervals of parameters."""

    def __init__(
        self, given: GivenLoop, claim: LoopClaim, budget: float, tell: Tell | None, *,
        continuous: bool,
    ) -> None:  # fmt: skip
        self.given, self.claim, self.continuous = given, claim, continuous
        # A tube takes half of the time; a region that is searched after it, the rest.
        default = 2.0 * TUBE_BUDGET if math.isfinite(claim.end) else LOOP_BUDGET
        self.stop = Stop(default_budget(budget, default))
        self.begun, self.tell = time.monotonic(), tell
        self.pieces = 0

    def verdict(self) -> LoopVerdict:
        """Judge the claim: the whole, the midpoint of its parameters, parts."""
        widths = {name: high - low for name, low, high in self.claim.parameters if low < high}
        bounded = math.isfinite(self.claim.end)  # a tube halves parameters by itself
        if not widths or bounded or not all(map(math.isfinite, widths.values())):
            return self._judged(self.claim, self.stop.left)
        whole = self._judged(self.claim, 0.5 * self.stop.left)
        if whole.verdict != UNDECIDED or self.stop.now:
            return whole
        middle = _at_middle(self.claim)
        found = self._judged(middle, 0.5 * self.stop.left)
        if found.verdict == REFUTED:
            return self._of_all(found, evidence=(*found.evidence, f"with {_words(middle)}"))
        return self._by_parts(whole, widths) if found.verdict == PROVED else whole

    def _by_parts(self, whole: LoopVerdict, widths: Mapping[str, float]) -> LoopVerdict:
        waiting = _halves(self.claim, widths)[::-1]
        parts: list[LoopVerdict] = []
        while waiting:
            claim = waiting.pop()
            found = self._judged(claim, self.stop.left / (len(waiting) + 1.5))
            if found.verdict == PROVED:
                parts.append(found)
            elif found.verdict == REFUTED:
                return self._of_all(found, evidence=(*found.evidence, f"with {_words(claim)}"))
            elif self.stop.now or _halvings(claim, widths) == MOST_HALVINGS * len(widths):
                done = [f"proved with {_words(part.claim)}" for part in parts if part.claim]
                reason = f"with {_words(claim)}: {found.reason}"
                return self._of_all(whole, reason=reason, evidence=(*whole.evidence, *done))
            else:
                waiting += _halves(claim, widths)[::-1]
        return self._together(parts)

    def _together(self, parts: Sequence[LoopVerdict]) -> LoopVerdict:
        """Return the verdict on the claim from its proved parts."""
        certificates = [part.certificate for part in parts if part.certificate is not None]
        if len(certificates) < len(parts):  # by tubes, whose certificates are searched on demand
            return self._of_all(parts[0], **_facts_of_tubes(parts), evidence=(
                f"in {len(parts)} parts of its parameters, each by a"
                f" {'region or a ' * bool(certificates)}tube",
                *dict.fromkeys(line for part in parts for line in part.evidence),
            ))  # fmt: skip
        certificate = joined(self.claim, certificates)
        facts = demand_proved(self.given.problem(self.claim), certificate).facts
        return self._of_all(parts[0], certificate=certificate, parts=tuple(parts), **facts)

    def _judged(self, claim: LoopClaim, budget: float) -> LoopVerdict:
        found = judged(self.given, claim, budget=budget, continuous=self.continuous, tell=self.tell)
        self.pieces += found.pieces
        return found

    def _of_all(self, found: LoopVerdict, **facts: Any) -> LoopVerdict:
        """Return a verdict on the whole claim."""
        return replace(
            found, claim=self.claim, pieces=self.pieces,
            statement=self.given.sentence(self.claim, continuous=self.continuous),
            seconds=time.monotonic() - self.begun, work=self.stop.spent, **facts,
        )  # fmt: skip


def _facts_of_tubes(parts: Sequence[LoopVerdict]) -> dict[str, Any]:
    """Return the facts of a verdict by parts of which some have tubes: what all of them share."""
    rest = set.intersection(*(set(part.rest.items()) for part in parts))
    return {
        "parts": tuple(parts), "rest": {n: x for n, x in parts[0].rest.items() if (n, x) in rest},
        "fall": min(part.fall for part in parts),
        "uncertain": tuple(dict.fromkeys(word for part in parts for word in part.uncertain)),
        "region": {}, "start_region": {}, "rests": {},
        "certificate": None, "tube": None, "haven": None,
    }  # fmt: skip


def _at_middle(claim: LoopClaim) -> LoopClaim:
    middle = [(name, 0.5 * low + 0.5 * high) for name, low, high in claim.parameters]
    return replace(claim, parameters=tuple((name, x, x) for name, x in middle))


def _halvings(claim: LoopClaim, widths: Mapping[str, float]) -> int:
    """Return the number of halvings of a part's parameters."""
    return sum(_halved(each, widths) for each in claim.parameters)


def _halved(part: Stretch, widths: Mapping[str, float]) -> int:
    name, low, high = part
    return round(math.log2(widths[name] / (high - low))) if name in widths and low < high else 0


def _halves(claim: LoopClaim, widths: Mapping[str, float]) -> list[LoopClaim]:
    """Return the halves of a part, along the least halved parameter."""
    name, low, high = min(
        (each for each in claim.parameters if each[0] in widths),
        key=lambda each: _halved(each, widths),
    )
    middle = 0.5 * low + 0.5 * high
    return [
        replace(claim, parameters=tuple(
            (name, *ends) if each[0] == name else each for each in claim.parameters
        ))
        for ends in ((low, middle), (middle, high))
    ]  # fmt: skip


def _words(claim: LoopClaim) -> str:
    """Return the parameters of a claim in words."""
    return ", ".join(
        stretch_text((name, low, high)) if low < high else f"{name_text(name)} = {number_text(low)}"
        for name, low, high in claim.parameters
    )  # fmt: skip
