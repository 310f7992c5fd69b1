"""The check of a certificate, without a search: its files, its loop, its proof, and the words."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.numbers import inward_interval, number_text, outward_text
from fuzzyarm.base.shown import Shown, one_line
from fuzzyarm.control.controllers.text import ControllerText, read_controller
from fuzzyarm.language.loop_claims import stretch_text
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.language.tokens import name_text
from fuzzyarm.plant.own import PLANTS, plant_files, trusted_plant
from fuzzyarm.plant.plant import Plant, parameter, with_actuators
from fuzzyarm.proof.check.certificate import (
    Certificate,
    CertificateError,
    fingerprints_of,
    read_certificate,
)
from fuzzyarm.proof.check.numbers import exact, float_below
from fuzzyarm.proof.check.theorem import CheckedProof, demand_proved, rest_words
from fuzzyarm.proof.claim.identity import gain_words, loop_digests
from fuzzyarm.proof.claim.text import loop_sentence, problem_of
from fuzzyarm.proof.stop import Stop

if TYPE_CHECKING:
    from fuzzyarm.requests.prove import ProveRequest

PROVED, UNDECIDED = "proved", "undecided"


@json_properties(
    "property=statement verdict region start_region rest rests fall continuous uncertain"
    " certificate=certificate.seal evidence=words seconds reason"
)
@dataclass(frozen=True, repr=False, kw_only=True)
class Checked(Shown):
    """The result of a check.

    Attributes
    ----------
    statement : str
        The sentence proved or refused.
    certificate : Certificate
        The certificate.
    reason : str
        Why the proof fails; empty if it holds.
    files : dict of str to str
        SHA-256 of the files read, by name.
    loop : tuple of str
        The derived loop, in words.
    theorems : tuple of str
        The regions, sectors and bounds used.
    region : dict of str to (float, float)
        Bounds of each state and memory in the first region; empty without one. Of several parts
        of the parameters, the rests and the least reach around any.
    start_region : dict of str to float
        Largest deviation at the start along each state of the plant alone.
    rest : dict of str to float
        The equilibrium.
    rests : dict of str to (float, float)
        Bounds of the equilibrium, for states whose rest depends on parameters.
    fall : float
        Least relative fall of V in each period.
    continuous : bool
        Whether only the loop in continuous time is proved.
    uncertain : tuple of str
        Unknown gains.
    boxes : int
        Number of boxes of starts followed.
    coverage : float
        Of a map: their share of the window, rounded down.
    seconds : float
        Time taken.
    proof : CheckedProof or None
        The loop and its regions; None if nothing is proved.
    """

    statement: str
    certificate: Certificate
    reason: str = ""
    files: Mapping[str, str] = field(default_factory=dict)
    loop: tuple[str, ...] = ()
    theorems: tuple[str, ...] = ()
    region: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    start_region: Mapping[str, float] = field(default_factory=dict)
    rest: Mapping[str, float] = field(default_factory=dict)
    rests: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    fall: float = 0.0
    continuous: bool = False
    uncertain: tuple[str, ...] = ()
    boxes: int = 0
    coverage: float = 0.0
    seconds: float = field(default=0.0, compare=False)
    proof: CheckedProof | None = field(default=None, compare=False)

    @property
    def proved(self) -> bool:
        """Whether the statement holds."""
        return not self.reason

    @property
    def verdict(self) -> str:
        """``proved`` or ``undecided``."""
        return PROVED if self.proved else UNDECIDED

    @property
    def claim(self) -> LoopClaim:
        """The claim, with the path of its plant relative to the working folder."""
        claim = self.certificate.claim
        return replace(claim, plant=self.certificate.place(claim.plant))

    @property
    def words(self) -> tuple[str, ...]:
        """Inputs, derivations and facts used, a line each."""
        files = [f"read {name}, SHA-256 {digest}" for name, digest in self.files.items()]
        return (*files, *self.loop, *(f"theorem: {words}" for words in self.theorems))

    def __repr__(self) -> str:
        return one_line(self, f"{self.verdict}: {self.statement}")

    def __str__(self) -> str:
        lines = [f"{self.verdict}: {self.statement}"]
        if self.region:
            lines += region_lines(
                self.region, self.start_region, rests=self.rests, continuous=self.continuous,
                parts=len(self.certificate.parts),
            )  # fmt: skip
        return "\n".join([*lines, *(f"  {x}" for x in (self.reason, *self.words) if x)])


def region_lines(
    region: Mapping[str, tuple[float, float]],
    start_region: Mapping[str, float],
    *,
    rests: Mapping[str, tuple[float, float]] | None = None,
    continuous: bool = False,
    arrival: bool = False,
    parts: int = 0,
) -> Iterator[str]:
    """Yield a heading for a region and its reach, a line for each state."""
    if not arrival:
        how = "in continuous time" if continuous else "as sampled"
        each = f", in {parts} parts of its parameters" if parts else ""
        least = " at least" if parts else ""
        yield f"  {how}{each}, from everywhere in an ellipsoid around rest that reaches{least} to"
    for name, (low, high) in region.items():
        alone = start_region.get(name)
        words = ""
        if alone is not None:
            words = f" (± {outward_text(alone, up=False, digits=4)} with the others at rest)"
        if arrival:  # the region where all runs stay from then on, not that of starts
            ends = outward_text(low, up=False, digits=4), outward_text(high, up=True, digits=4)
            yield f"    {name} in {' .. '.join(ends)}{words}"
        else:
            yield f"    {name} {_reach_words(low, high, (rests or {}).get(name), 4)}{words}"
    if not arrival and not start_region:
        yield "  these are its farthest points; what memory starts as counts as well"


def _reach_words(low: float, high: float, rests: tuple[float, float] | None, digits: int) -> str:
    """Return the reach of an ellipsoid in words, around each rest if parameters move it."""
    if rests is None:
        return f"in {inward_interval(low, high, digits)}"
    far = float_below((exact(high) - exact(low) - exact(rests[1]) + exact(rests[0])) / 2)
    reach = outward_text(far, up=False, digits=digits)
    return f"± {reach} around where it rests, {rest_words(rests, digits)}"


def check_certificate(
    certificate: Certificate | str,
    text: ControllerText | None = None,
    plant: Plant | None = None,
    *,
    named: str | None = None,
    trust: bool = False,
    budget: float = math.inf,
) -> Checked:
    """Check a certificate, without any search.

    Parameters
    ----------
    certificate : Certificate or str
        The certificate or its path.
    text : ControllerText, optional
        The controller; by default its file is read. Paths in a certificate are relative to its
        folder.
    plant : Plant, optional
        In place of the plant named in the claim.
    named : str, optional
        A plant whose code may run, in place of the file named in the claim.
    trust : bool, optional
        Whether code of the claim's plant may run.
    budget : float
        Seconds until the verdict is undecided.

    Raises
    ------
    CertificateError
        If it is not a certificate, or belongs to other files.
    PlantError
        If the code of its plant may not run.
    """
    begun, stop = time.monotonic(), Stop(budget)
    if isinstance(certificate, str):
        certificate = read_certificate(certificate)
    text = _controller(certificate) if text is None else text
    _require_files(certificate, text)
    # The plant is compared with the one of its name, relative to the working folder.
    claim = replace(certificate.claim, plant=certificate.place(certificate.claim.plant))
    if named is not None and not {named, claim.plant} & set(PLANTS):  # a file in another folder
        claim = replace(claim, plant=named)
    plant = trusted_plant(claim.plant, named, trust=trust) if plant is None else plant
    plant = with_actuators(plant, {}, certificate.delays) if certificate.delays else plant
    statement = loop_sentence(
        claim, certificate.sensors, certificate.connect, plant=plant, text=text,
        continuous=certificate.continuous,
    )  # fmt: skip
    _require_loop(certificate, text, plant)
    checked = Checked(statement=statement, certificate=certificate)
    try:
        with stop:
            problem = problem_of(
                text, claim,
                plant=plant, sensors=certificate.sensors, connect=certificate.connect,
            )  # fmt: skip
            proof = demand_proved(problem, certificate)
    except FuzzyarmError as error:
        reason = f"the certificate does not prove it: {error}"
        return replace(checked, reason=reason, seconds=time.monotonic() - begun)
    if certificate.window:
        statement += f"; {coverage_words(certificate, proof)}"
    return replace(
        checked, statement=statement, loop=proof.loop,
        files={**certificate.fingerprints, **plant_files(plant)},
        theorems=proof.theorems, boxes=sum(len(each.tubes) for each in certificate.proofs),
        coverage=float_below(exact(proof.coverage)),
        seconds=time.monotonic() - begun, proof=proof,
        **proof.facts,
    )  # fmt: skip


def check_of(request: ProveRequest, text: ControllerText | None) -> Checked:
    """Check the certificate of a request."""
    return check_certificate(
        request.check or "", text, named=request.plant, trust=request.trust,
        budget=request.budget or math.inf,
    )  # fmt: skip


def proof_words(checked: Checked, text: ControllerText, plant: Plant) -> str:
    """Return a certificate's claim, region and numbers, for the header of a program."""
    words = [checked.statement + ("" if checked.continuous else ", as sampled")]
    if checked.region and not (checked.claim.start or checked.certificate.tubes):
        reach = [
            f"{name} {_reach_words(low, high, checked.rests.get(name), 6)}"
            for name, (low, high) in checked.region.items()
        ]
        words.append(f"for starts in an ellipsoid that reaches to {', '.join(reach)}")
    gains = [f"{gain.name} = {gain_words(gain)}" for gain in text.model.gains]
    stated = {name for name, _, _ in checked.claim.parameters}
    numbers = [
        f"{name} = {number_text(parameter(plant, name).value)}"
        for name in plant.parameters
        if name not in stated
    ]
    words += [f"gains {', '.join(gains)}"] * bool(gains)
    words += [f"parameters {', '.join(numbers)}"] * bool(numbers)
    return "; ".join([*words, f"certificate {checked.certificate.seal}"])


def coverage_words(certificate: Certificate, proof: CheckedProof) -> str:
    """Return the statement of a map about its window."""
    coverage, named = proof.coverage, {name for name, _, _ in certificate.window}
    others = ", ".join(
        f"{name_text(name)} = {number_text(span.low)}"
        for name, span in proof.problem.start.items()
        if name not in named
    )
    window = ", ".join(map(stretch_text, certificate.window))
    count = len(certificate.tubes)
    boxes = f"{count} box{'es' * (count != 1)}"
    share = math.floor(coverage * 1000) / 10  # rounded down: 100 % means all of it
    begun = f", the other states at {others}," * bool(others)
    return f"from {share:g} % of {window} ({boxes}){begun} every run comes to rest"


def _controller(certificate: Certificate) -> ControllerText:
    """Read the controller of a certificate, by its path from the certificate's folder."""
    path = certificate.place(certificate.controller)
    if not Path(path).is_file():
        raise CertificateError(
            f"the controller {path} is not there: its name counts from the certificate's folder",
            hint="fuzzyarm prove --check CERTIFICATE CONTROLLER names another place",
        )
    return read_controller(path)


def _require_files(certificate: Certificate, text: ControllerText) -> None:
    """Refuse a certificate whose files are not exactly those of the controller."""
    now = fingerprints_of(text)
    if set(now) != set(certificate.fingerprints):
        expected_name = Path(certificate.controller).name
        raise CertificateError(
            f"this certificate is of {expected_name}, not of {Path(text.path).name}"
        )
    for name, fingerprint in certificate.fingerprints.items():
        if now[name] != fingerprint:
            raise CertificateError(f"{name} is not the file that was proved")


def _require_loop(certificate: Certificate, text: ControllerText, plant: Plant) -> None:
    """Refuse a certificate of another controller or plant."""
    named = {"controller": Path(certificate.controller).name, "plant": certificate.claim.plant}
    for part, digest in loop_digests(text, plant).items():
        if certificate.digests.get(part) != digest:
            raise CertificateError(
                f"{named[part]} is not the {part} that was proved", hint="prove it anew"
            )
