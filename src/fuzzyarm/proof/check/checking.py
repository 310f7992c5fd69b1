"""A certificate checked, without a search: which files, loop and theorem, and what follows."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.jsonable import json_properties
from fuzzyarm.base.numbers import number_text
from fuzzyarm.base.shown import Shown, one_line
from fuzzyarm.control.controllers.text import ControllerText, read_controller
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.plant.own import trusted_plant
from fuzzyarm.plant.plant import Plant, parameter
from fuzzyarm.proof.check.certificate import (
    Certificate,
    CertificateError,
    TubeProof,
    fingerprints_of,
    read_certificate,
)
from fuzzyarm.proof.check.numbers import Number, exact, float_above, float_below
from fuzzyarm.proof.check.region import accepted, outside, region_facts, verified
from fuzzyarm.proof.check.rules import RuleSurfaces
from fuzzyarm.proof.check.tube import Arrival, Follower, Haven, covered
from fuzzyarm.proof.claim.identity import gain_words, loop_digests
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.claim.text import claimed_in, loop_sentence, problem_of
from fuzzyarm.proof.stop import Stop

if TYPE_CHECKING:
    from fuzzyarm.requests.prove import ProveRequest

__all__ = [
    "Checked",
    "check_certificate",
    "check_of",
    "follow_box",
    "proof_words",
    "region_lines",
]

PROVED, UNDECIDED = "proved", "undecided"

OF_REGIONS = (
    "V = z'Pz falls in each control period for all gains between the proved ones (Lyapunov,"
    " S-procedure), so that no run leaves V <= 1 and all go to rest"
)
OF_TUBES = "sets hold all runs from one sample to the next (mean value theorem)"
OF_MAPS = "each box leads into a region or into boxes before it (induction)"


@json_properties(
    "property=statement verdict region start_region rest fall continuous uncertain"
    " certificate=certificate.seal evidence=words seconds reason"
)
@dataclass(frozen=True, repr=False, kw_only=True)
class Checked(Shown):
    """What a certificate proves.

    Attributes
    ----------
    statement : str
        The sentence that follows.
    certificate : Certificate
        Which.
    reason : str
        Why it does not; empty where it does.
    files : dict of str to str
        SHA-256 of the files that were read, by name.
    loop : tuple of str
        The loop that was derived, in words.
    theorems : tuple of str
        What was used.
    region : dict of str to (float, float)
        Where each state and each memory can be in the first region; empty where there is none.
    start_region : dict of str to float
        By state of the plant, how far from rest the loop may start along it alone.
    rest : dict of str to float
        Where the loop rests.
    fall : float
        By what share V falls in each period at least.
    continuous : bool
        Whether it is of the loop in continuous time only.
    uncertain : tuple of str
        What was taken as an unknown gain.
    boxes : int
        How many boxes of starts were followed.
    seconds : float
        How long it took.
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
    fall: float = 0.0
    continuous: bool = False
    uncertain: tuple[str, ...] = ()
    boxes: int = 0
    seconds: float = field(default=0.0, compare=False)

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
        """What is claimed."""
        return self.certificate.claim

    @property
    def words(self) -> tuple[str, ...]:
        """What was read, derived and used, a line each."""
        files = [f"read {name}, SHA-256 {digest}" for name, digest in self.files.items()]
        return (*files, *self.loop, *(f"theorem: {words}" for words in self.theorems))

    def __repr__(self) -> str:
        return one_line(self, f"{self.verdict}: {self.statement}")

    def __str__(self) -> str:
        lines = [f"{self.verdict}: {self.statement}"]
        if self.region:
            lines += region_lines(self.region, self.start_region, continuous=self.continuous)
        return "\n".join([*lines, *(f"  {x}" for x in (self.reason, *self.words) if x)])


def region_lines(
    region: Mapping[str, tuple[float, float]],
    start_region: Mapping[str, float],
    *,
    continuous: bool = False,
    arrival: bool = False,
) -> Iterator[str]:
    """Yield the reach of a region, a line for each state, below what it is."""
    if not arrival:
        how = "in continuous time" if continuous else "as sampled"
        yield f"  {how}, from everywhere in an ellipsoid around rest that reaches to"
    for name, (low, high) in region.items():
        alone = start_region.get(name)
        words = "" if alone is None else f" (± {alone:.4g} with the others at rest)"
        yield f"    {name} in {low:.4g} .. {high:.4g}{words}"
    if not arrival and not start_region:
        yield "  these are its farthest points; what memory starts as counts as well"


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
        Or its file.
    text : ControllerText, optional
        The controller; by default its file is read, from the folder at hand or from that of the
        certificate.
    plant : Plant, optional
        In place of the one that the claim names.
    named : str, optional
        A plant whose code may run, where the claim names the same one.
    trust : bool, optional
        Whether the plant of the claim may be code, which is run.
    budget : float
        Seconds after which it stays undecided.

    Raises
    ------
    CertificateError
        If it is not a certificate, or one of other files.
    PlantError
        If its plant is code that may not run.
    """
    begun, stop, folder = time.monotonic(), Stop(budget), Path(".")
    if isinstance(certificate, str):
        folder = Path(certificate).parent
        certificate = read_certificate(certificate)
    text = _controller(certificate, folder) if text is None else text
    _require_files(certificate, text)
    claim = certificate.claim
    statement = loop_sentence(
        claim, certificate.sensors, certificate.connect, plant=plant, text=text,
        continuous=certificate.continuous,
    )  # fmt: skip
    plant = trusted_plant(claim.plant, named, trust=trust) if plant is None else plant
    _require_loop(certificate, text, plant)
    checked = Checked(statement=statement, certificate=certificate)
    try:
        with stop:
            problem = problem_of(
                text, claim,
                plant=plant, sensors=certificate.sensors, connect=certificate.connect,
            )  # fmt: skip
            proof = _Proof(problem, certificate)
    except FuzzyarmError as error:
        reason = f"the certificate does not prove it: {error}"
        return replace(checked, reason=reason, seconds=time.monotonic() - begun)
    if proof.is_map:
        statement += f"; from all starts in {_boxes_words(problem, certificate.tubes)}"
    return replace(
        checked, statement=statement, files=certificate.fingerprints, loop=proof.loop,
        theorems=proof.theorems, boxes=len(certificate.tubes), seconds=time.monotonic() - begun,
        **proof.facts,
    )  # fmt: skip


def check_of(request: ProveRequest, text: ControllerText | None) -> Checked:
    """Check the certificate of a request."""
    return check_certificate(
        request.check or "", text, named=request.plant, trust=request.trust,
        budget=request.budget or math.inf,
    )  # fmt: skip


def proof_words(checked: Checked, text: ControllerText, plant: Plant) -> str:
    """Return what a certificate proves, where, and of which numbers, for the head of a program."""
    words = [checked.statement + ("" if checked.continuous else ", as sampled")]
    if checked.region and not (checked.claim.start or checked.certificate.tubes):
        reach = [
            f"{name} in {low:.6g} .. {high:.6g}" for name, (low, high) in checked.region.items()
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


class _Proof:
    """A proof of a certificate's claim; LoopProofError where it is none."""

    def __init__(self, problem: LoopProblem, certificate: Certificate) -> None:
        self.problem, self.claim = problem, certificate.claim
        self.surfaces = RuleSurfaces()
        regions, tubes = certificate.regions, certificate.tubes
        self.facts: dict[str, Any] = {}
        self.is_map = bool(tubes) and not (self.claim.start or self.claim.output)
        if not tubes:
            if len(regions) != 1:
                raise LoopProofError("it has no region, or several and no tube")
            against, self.facts, loop = verified(problem, self.claim, regions[0], self.surfaces)
            if against or loop is None:
                raise LoopProofError(against)
            havens = [Haven(loop, regions[0])]
        else:
            if certificate.continuous:
                raise LoopProofError("tubes are of the loop as sampled")
            havens = [Haven(accepted(problem, r, self.surfaces), r) for r in regions]
            self.facts = region_facts(problem, *havens[0]) if havens else {}
            self._follow(havens, tubes)
        self.loop = tuple(_loop_words(haven) for haven in havens)
        self.theorems = (
            *((OF_REGIONS,) if regions else ()),
            *((OF_TUBES,) if tubes else ()),
            *((OF_MAPS,) if self.is_map else ()),
        )

    def _follow(self, havens: Sequence[Haven], tubes: Sequence[TubeProof]) -> None:
        """Follow all boxes; a claim of starts needs all of them in the boxes."""
        problem, claim = self.problem, self.claim
        follower = Follower(problem, havens, self.surfaces)
        for number in range(len(tubes)):
            try:
                follow_box(follower, claim, tubes, number)
            except (LoopProofError, IndexError, ValueError, ZeroDivisionError) as error:
                raise LoopProofError(f"box {number + 1}: {error}") from error
        if claim.start or claim.output:
            start = [(exact(span.low), exact(span.high)) for span in problem.start.values()]
            boxes = [[(exact(a), exact(b)) for a, b in tube.box] for tube in tubes]
            if not covered(start, boxes):
                raise LoopProofError("its boxes are not all of the starts")


def follow_box(
    follower: Follower, claim: LoopClaim, tubes: Sequence[TubeProof], number: int
) -> Arrival:
    """Follow the box of a tube to where it arrives; LoopProofError where that is not shown."""
    box, periods, (kind, indices) = tubes[number]
    if kind == "tubes":
        if claim.output or any(index >= number for index in indices):
            raise LoopProofError("it leads into boxes that are not known to arrive")
        return follower.arrival(box, periods, into=(), boxes=[tubes[k].box for k in indices])
    if kind == "regions":
        if len(indices) != 1:
            raise LoopProofError("it does not lead into one region")
        haven = follower.havens[indices[0]]

        def holds_from(period: int, level: Number) -> bool:
            return not claim.output or not outside(
                follower.problem, haven.loop, claim, haven.proof, level, period
            )

        return follower.arrival(box, periods, claim=claim, into=indices, arrived=holds_from)
    last = claimed_in(follower.problem, claim).last if claim.output else None
    if last is None or claim.stable:
        raise LoopProofError("it ends before the claim does")
    return follower.arrival(box, last + 1, claim=claim, into=())


def _loop_words(haven: Haven) -> str:
    loop = haven.loop
    rest = ", ".join(f"{name} = {float(x):.6g}" for name, x in loop.rest.items())
    gains = f", unknown gains: {'; '.join(loop.words)}" if loop.words else ""
    return f"derived a loop of {loop.size} states at rest where {rest}{gains}"


def _boxes_words(problem: LoopProblem, tubes: Sequence[TubeProof]) -> str:
    spans = []
    for k, name in enumerate(problem.states):
        low = min(tube.box[k][0] for tube in tubes)
        high = max(tube.box[k][1] for tube in tubes)
        spans.append(f"{name} in {float_above(exact(low)):g} .. {float_below(exact(high)):g}")
    return f"{len(tubes)} box{'es' * (len(tubes) != 1)} within {', '.join(spans)}"


def _controller(certificate: Certificate, folder: Path) -> ControllerText:
    """Return the controller of a certificate, from the folder at hand or that of its file."""
    given = Path(certificate.controller)
    for path in (given, folder / given, folder / given.name):
        if path.is_file():
            return read_controller(str(path))
    raise CertificateError(f"the controller {certificate.controller} is not there")


def _require_files(certificate: Certificate, text: ControllerText) -> None:
    """Refuse a certificate of other files than those of a controller, or of more or fewer."""
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
    """Refuse a certificate of another controller or plant than those at hand."""
    named = {"controller": Path(certificate.controller).name, "plant": certificate.claim.plant}
    for part, digest in loop_digests(text, plant).items():
        if certificate.digests.get(part) != digest:
            raise CertificateError(
                f"{named[part]} is not the {part} that was proved", hint="prove it anew"
            )
