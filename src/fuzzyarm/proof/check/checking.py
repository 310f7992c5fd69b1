"""The check of a certificate, without a search: its files, loop, theorems and conclusion."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

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
    Pair,
    TubeProof,
    fingerprints_of,
    read_certificate,
)
from fuzzyarm.proof.check.numbers import exact, float_above, float_below
from fuzzyarm.proof.check.region import (
    ROUNDED,
    accepted,
    outside,
    region_facts,
    rests_of,
    verified,
)
from fuzzyarm.proof.check.rules import RuleSurfaces
from fuzzyarm.proof.check.tube import Followed, Follower, Haven, Task, covered
from fuzzyarm.proof.claim.identity import gain_words, loop_digests
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError
from fuzzyarm.proof.claim.text import claimed_in, loop_sentence, problem_of
from fuzzyarm.proof.stop import Stop

if TYPE_CHECKING:
    from fuzzyarm.requests.prove import ProveRequest

PROVED, UNDECIDED = "proved", "undecided"

MOST_CELLS = 1 << 26
"""Most cells of a window cut at the sides of all boxes of its map."""

MOST_EXACT_CELLS = 1 << 16
"""Most cells that are added up as rationals; the share of more is rounded down by floats."""

OF_REGIONS = (
    "V = z'Pz falls in each control period for all gains between the proved ones (Lyapunov,"
    " S-procedure), so that no run leaves V <= 1 and all go to rest"
)
OF_CONES = (
    "in each cone of states, by the sides of the inputs of rule bases, V = z'Pz is another, and in"
    " each control period it falls from one to the next (S-procedure), so that all runs go to rest"
)
OF_TUBES = "sets hold all runs from one sample to the next (mean value theorem)"
OF_MAPS = "each box leads into a region or into boxes before it (induction)"
OF_PARTS = "its parts are all of the parameters, and each is proved by itself"


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
    return f"± {reach} around where it rests, {_rest_words(rests, digits)}"


def _rest_words(rests: tuple[float, float], digits: int) -> str:
    ends = (
        outward_text(end, up=up, digits=digits)
        for end, up in zip(rests, (False, True), strict=True)
    )
    return f"{' .. '.join(ends)} by its parameters"


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


def demand_proved(
    problem: LoopProblem, certificate: Certificate, surfaces: RuleSurfaces | None = None
) -> CheckedProof:
    """Return the proof of a certificate's claim; LoopProofError if it fails."""
    surfaces = surfaces or RuleSurfaces()
    if certificate.parts:
        return _proof_by_parts(problem, certificate, surfaces)
    return _proof_of(problem, certificate, surfaces)


@dataclass(frozen=True)
class CheckedProof:
    """A proof of a certificate's claim.

    Attributes
    ----------
    problem : LoopProblem
        The loop.
    havens : tuple of Haven
        Its proved regions.
    facts : dict of str to object
        Facts of the first region, or of the regions of all parts, as fields of a verdict.
    loop, theorems : tuple of str
        In words.
    coverage : Fraction
        Of a map: proved share of its window, rounded down.
    """

    problem: LoopProblem
    havens: tuple[Haven, ...]
    facts: Mapping[str, Any]
    loop: tuple[str, ...]
    theorems: tuple[str, ...]
    coverage: Fraction = Fraction(0)


def _proof_of(
    problem: LoopProblem, certificate: Certificate, surfaces: RuleSurfaces
) -> CheckedProof:
    """Return the proof of a certificate without parts."""
    claim, regions, tubes = certificate.claim, certificate.regions, certificate.tubes
    facts: Mapping[str, Any] = {}
    coverage = _coverage(problem, certificate) if certificate.window else Fraction(0)
    if tubes and not (claim.start or claim.output or certificate.window):
        raise LoopProofError("it has tubes, and claims nothing of starts")
    if not tubes:
        if len(regions) != 1:
            raise LoopProofError("it has no region, or several and no tube")
        against, facts, loop = verified(problem, claim, regions[0], surfaces)
        if against or loop is None:
            raise LoopProofError(against)
        havens = [Haven(loop, regions[0])]
    else:
        if certificate.continuous:
            raise LoopProofError("tubes are of the loop as sampled")
        havens = [Haven(accepted(problem.at_rest, r, surfaces), r) for r in regions]
        facts = region_facts(problem, *havens[0]) if havens else {}
        _follow(Follower(problem, havens, surfaces), claim, tubes)
    if certificate.window and not coverage:
        raise LoopProofError("none of its boxes is in its window")
    theorems = (
        *((OF_REGIONS,) if any(not region.cones for region in regions) else ()),
        *((OF_CONES,) if any(region.cones for region in regions) else ()),
        *((OF_TUBES,) if tubes else ()),
        *((OF_MAPS,) if certificate.window else ()),
    )
    words = tuple(map(_loop_words, havens))
    return CheckedProof(problem, tuple(havens), facts, words, theorems, coverage)


def _proof_by_parts(
    problem: LoopProblem, certificate: Certificate, surfaces: RuleSurfaces
) -> CheckedProof:
    """Return the proof of a claim from proofs for parts of its parameters."""
    if certificate.window or certificate.regions or certificate.tubes:
        raise LoopProofError("beside its parts it has a map, regions or tubes")
    parts = certificate.by_part
    if len({part.continuous for part in parts}) > 1:
        raise LoopProofError("its parts are of the loop as sampled and in continuous time")
    _require_all_parameters(certificate)
    proofs = [
        _proof_of(
            problem_of(
                problem.text, part.claim, plant=problem.given or problem.plant,
                sensors=certificate.sensors, connect=certificate.connect,
            ),
            part, surfaces,
        )
        for part in parts
    ]  # fmt: skip
    return CheckedProof(
        problem,
        tuple(haven for proof in proofs for haven in proof.havens),
        {} if any(part.tubes for part in parts) else _facts_of_parts(proofs),
        tuple(words for proof in proofs for words in proof.loop),
        tuple(dict.fromkeys(
            (*(theorem for proof in proofs for theorem in proof.theorems), OF_PARTS)
        )),
    )  # fmt: skip


def _require_all_parameters(certificate: Certificate) -> None:
    """Refuse parts that do not cover the claim's parameters."""
    names = [name for name, _, _ in certificate.claim.parameters]
    boxes = [{name: (a, b) for name, a, b in part.parameters} for part in certificate.parts]
    if any(len(part.parameters) != len(names) or set(box) != set(names)
           for part, box in zip(certificate.parts, boxes, strict=True)):  # fmt: skip
        raise LoopProofError("its parts are of other parameters than its claim")
    ends = np.array([[box[name] for name in names] for box in boxes])
    whole = [(low, high) for _, low, high in certificate.claim.parameters]
    if not (names and np.isfinite(ends).all() and covered(whole, ends[..., 0], ends[..., 1])):
        raise LoopProofError("its parts are not all of the parameters")


def _facts_of_parts(proofs: Sequence[CheckedProof]) -> dict[str, Any]:
    """Return the facts common to the regions of all parts: the least reach around a rest."""
    facts, loops = [proof.facts for proof in proofs], [proof.havens[0].loop for proof in proofs]
    region, rests = dict[str, tuple[float, float]](), dict[str, tuple[float, float]]()
    for name in facts[0]["region"]:
        if not all(name in each["region"] for each in facts):
            continue
        spans = [(float_below(loop.rest[name]), float_above(loop.rest[name])) for loop in loops]
        ends = [each["region"][name] for each in facts]
        low, high = min(a for a, _ in spans), max(b for _, b in spans)
        if high - low <= ROUNDED * max(abs(low), abs(high), 1.0):
            region[name] = max(a for a, _ in ends), min(b for _, b in ends)
            continue
        rests[name] = low, high
        around = min(
            min(exact(a) - exact(x), exact(y) - exact(b))
            for (a, b), (x, y) in zip(spans, ends, strict=True)
        )
        region[name] = float_above(exact(low) - around), float_below(exact(high) + around)
    alone = {
        name: min(each["start_region"][name] for each in facts)
        for name in facts[0]["start_region"]
        if all(name in each["start_region"] for each in facts)
    }
    rest = {name: 0.5 * a + 0.5 * b for name, (a, b) in rests.items()}
    return {
        "region": region, "start_region": alone, "rest": {**facts[0]["rest"], **rest},
        "rests": rests, "fall": min(each["fall"] for each in facts),
        "continuous": any(each["continuous"] for each in facts),
        "uncertain": tuple(dict.fromkeys(word for each in facts for word in each["uncertain"])),
    }  # fmt: skip


def _follow(follower: Follower, claim: LoopClaim, tubes: Sequence[TubeProof]) -> None:
    """Follow all boxes; a claim with starts needs all starts inside the boxes."""
    for number, followed in enumerate(follow_tubes(follower, claim, tubes), 1):
        if followed.against:
            raise LoopProofError(f"box {number}: {followed.against}")
    if claim.start or claim.output:
        start = [(Fraction(x.low), Fraction(x.high)) for x in follower.problem.start.values()]
        boxes = np.array([tube.box for tube in tubes], dtype=object)
        if not covered(start, boxes[..., 0], boxes[..., 1]):
            raise LoopProofError("its boxes are not all of the starts")


def follow_tubes(
    follower: Follower, claim: LoopClaim, tubes: Sequence[TubeProof]
) -> list[Followed]:
    """Follow the boxes of tubes to their destinations; LoopProofError if one fails."""
    numbers_by_goal: dict[tuple[str, int], list[int]] = {}
    for number, tube in enumerate(tubes):
        kind, index = tube.into
        if kind == "tubes" and (claim.output or index > number):
            raise LoopProofError(
                f"box {number + 1}: it leads into boxes that are not known to arrive"
            )
        # Boxes that lead into others may lead into a region instead: all are followed together.
        goal = ("regions", 0) if kind == "tubes" else (kind, index)
        if goal[0] == "regions" and goal[1] >= len(follower.havens):
            raise LoopProofError(f"box {number + 1}: there is no region {goal[1]}")
        numbers_by_goal.setdefault(goal, []).append(number)
    results = [Followed(0)] * len(tubes)
    for (destination, index), numbers in numbers_by_goal.items():
        boxes, periods = [tubes[k].box for k in numbers], [tubes[k].periods for k in numbers]
        counts = np.array([_before(tubes[k]) for k in numbers])
        if destination == "regions":
            task = _into_region(follower, claim, index)
            if counts.any():
                task = task._replace(boxes=ends_of_boxes([tube.box for tube in tubes]))
        else:
            last = claimed_in(follower.problem, claim).last if claim.output else None
            if last is None or claim.stable:
                raise LoopProofError("it ends before the claim does")
            task, periods = Task(claim), [last + 1] * len(numbers)
        for number, followed in zip(
            numbers, follower.follow(boxes, periods, task, counts), strict=True
        ):
            results[number] = followed
    return results


def _before(tube: TubeProof) -> int:
    """Return how many of the boxes before it a box may lead into."""
    kind, count = tube.into
    return count if kind == "tubes" else 0


def _into_region(follower: Follower, claim: LoopClaim, index: int) -> Task:
    """Return the task of arrival in a region, deep enough for the claim to hold from then on."""
    haven = follower.havens[index]

    def holds_from(period: int, level: float) -> bool:
        return not outside(follower.problem, haven.loop, claim, haven.proof, exact(level), period)

    return Task(claim, (index,), arrived=holds_from if claim.output else None)


def ends_of_boxes(boxes: Sequence[Sequence[Pair]]) -> tuple[Any, Any]:
    """Return the lower and upper ends of boxes, as floats rounded inward."""
    lows = [[float_above(exact(low)) for low, _ in box] for box in boxes]
    highs = [[float_below(exact(high)) for _, high in box] for box in boxes]
    return np.array(lows), np.array(highs)


def _loop_words(haven: Haven) -> str:
    loop = haven.loop
    wide = rests_of(loop)
    rest = ", ".join(
        f"{name} = {_rest_words(wide[name], 6) if name in wide else f'{float(x):.6g}'}"
        for name, x in loop.rest.items()
    )
    gains = f", unknown gains: {'; '.join(loop.words)}" if loop.words else ""
    return f"derived a loop of {loop.size} states at rest where {rest}{gains}"


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


def _coverage(problem: LoopProblem, certificate: Certificate) -> Fraction:
    """Return the share of the window covered by the boxes of a map, rounded down."""
    claim, window = certificate.claim, {name: (a, b) for name, a, b in certificate.window}
    if claim.start or claim.output or len(window) < len(certificate.window):
        raise LoopProofError("a map claims that a loop is stable, of one window")
    for name, (low, high) in window.items():
        if name not in problem.states or not (math.isfinite(high - low) and low < high):
            raise LoopProofError(f"not a window: {name} in {low:g} .. {high:g}")
    problem.require_known_start()
    lows, highs = [], []
    for tube in certificate.tubes:
        if len(tube.box) != len(problem.states):
            raise LoopProofError("it is not a box of the plant's states")
        box = dict(zip(problem.states, tube.box, strict=True))
        others = [(box[n], problem.start[n].low) for n in problem.states if n not in window]
        if all(a <= x <= b for (a, b), x in others):
            lows.append([box[name][0] for name in window])
            highs.append([box[name][1] for name in window])
    if not lows:
        return Fraction(0)
    return _share_of(np.array(lows, dtype=object), np.array(highs, dtype=object), window)


def _share_of(lows: Any, highs: Any, window: Mapping[str, tuple[float, float]]) -> Fraction:
    """Return the share of a window covered by the union of boxes, rounded down, cell by cell."""
    ranges, lengths = [], []
    for axis, (low, high) in enumerate(window.values()):
        first, last = Fraction(low), Fraction(high)
        ends = {first, last, *lows[:, axis], *highs[:, axis]}
        cuts = sorted(x for x in ends if first <= x <= last)
        cell_of = {x: k for k, x in enumerate(cuts)}
        ranges.append([
            [cell_of[min(max(x, first), last)] for x in side[:, axis]] for side in (lows, highs)
        ])  # fmt: skip
        lengths.append([(b - a) / (last - first) for a, b in pairwise(cuts)])
    if math.prod(map(len, lengths)) > MOST_CELLS:
        raise LoopProofError("its boxes make too fine a grid")
    inside = np.zeros(tuple(map(len, lengths)), dtype=bool)
    for row in range(len(lows)):
        inside[tuple(slice(begin[row], end[row]) for begin, end in ranges)] = True
    if inside.all():
        return Fraction(1)
    if inside.size <= MOST_EXACT_CELLS:
        return Fraction(_weighed(inside.astype(object), lengths))
    share = float(_weighed(inside.astype(float), [list(map(float, axis)) for axis in lengths]))
    # Nothing is negative: n numbers of an axis are added with a relative error below n 2⁻⁵³, plus
    # two roundings for each length and product.
    error = 2.0**-52 * sum(len(axis) + 2 for axis in lengths)
    return Fraction(max(0.0, share * (1.0 - max(1e-9, error))))


def _weighed(cells: Any, lengths: Sequence[Sequence[Any]]) -> Any:
    """Return the volume of the counted cells: their sum, weighted with lengths axis by axis."""
    for length in reversed(lengths):
        cells = cells @ np.array(length)
    return cells


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
