"""Claims about a loop: reading, writing, and the loop that they name."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from fuzzyarm.base.diagnostic import NOWHERE, RuleBaseError
from fuzzyarm.base.names import near_hint
from fuzzyarm.base.numbers import decimal, number_text
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.course import Sensor
from fuzzyarm.control.loop.reference import Signal, SignalError
from fuzzyarm.language.document import parse_document
from fuzzyarm.language.loop_claims import FOLLOWED, LoopClaimNode, claim_node
from fuzzyarm.language.model.claims import FollowedReference, LoopClaim, reference_fault
from fuzzyarm.language.rows import text_of
from fuzzyarm.language.tokens import name_text
from fuzzyarm.plant.own import trusted_plant
from fuzzyarm.plant.plant import Plant
from fuzzyarm.proof.claim.identity import controller_changes, plant_changes
from fuzzyarm.proof.claim.problem import ClaimError, LoopProblem, LoopProofError, loop_problem


class ClaimedPeriods(NamedTuple):
    """The first and last control period of a claim, counted from 0; no last one: for ever."""

    first: int
    last: int | None


def claimed_periods(claim: LoopClaim, period: float, *, jumps: bool) -> ClaimedPeriods:
    """Return the control periods of a claim: one rule for search and checker.

    Times are decimals, as printed; the k-th sample is at k periods. A claim includes both of its
    ends. An output is continuous: at a sample the period before ends where the next one begins.
    A drive jumps there, and so may an error (`jumps`): the values before and after both count, at
    both ends.
    """
    begin = decimal(claim.begin) / decimal(period)
    first = max(0, math.ceil(begin) - 1) if jumps else math.floor(begin)
    if math.isinf(claim.end):
        return ClaimedPeriods(first, None)
    end = decimal(claim.end) / decimal(period)
    last = math.floor(end) if jumps else math.ceil(end) - 1
    return ClaimedPeriods(min(first, last), last)


OPENINGS = ("stable", "on", "at", "with", "from", "while")
"""First words of a claim without ``on PLANT``."""


def read_claim(text: str, plant: str = "", argument: str = "") -> LoopClaim:
    """Return the claim in a text such as ``stable on motor``.

    Parameters
    ----------
    text : str
        As after ``prove`` in the file of a controller.
    plant : str, optional
        Name of the plant if the text leaves ``on PLANT`` out: ``stable``, ``from position in
        -0.3 .. 0.3: position in -1 .. 1``, ``position in -1 .. 1``.
    argument : str, optional
        Name of the argument with the text; an error begins with it.

    Raises
    ------
    RuleBaseError
        If it cannot be read, with the likely meaning.
    """
    words = text.strip().removeprefix("prove ").strip()
    if plant and not re.match(r"(stable\s+)?on\s", words):
        stable = re.match(r"stable\b", words)
        rest = words[stable.end() :].strip() if stable else words
        head = f"{'stable ' if stable else ''}on {name_text(plant)}"
        claimed = not rest or re.match(r"(at|with|from|while)\s|:", rest)
        words = f"{head} {rest}" if claimed else f"{head}: {rest}"
    document = parse_document(f"controller x\nprove {words}\n")
    wrong = tuple(diagnostic for diagnostic in document.diagnostics if diagnostic.line > 1)
    nodes = [s.node for s in document.statements if isinstance(s.node, LoopClaimNode)]
    if wrong or not nodes:
        subject, hint = argument or f"'{text.strip()}'", _hint(text)
        raise RuleBaseError(
            [
                replace(mistake, argument=subject, hint=mistake.hint or hint, span=NOWHERE)
                for mistake in wrong or document.diagnostics
            ]
        )
    return replace(nodes[0].claim, span=NOWHERE)


def _hint(text: str) -> str:
    """Return the likely meaning of the first word of a claim."""
    first = text.split(maxsplit=1)[0] if text.split() else ""
    return "" if first in OPENINGS else near_hint(first, OPENINGS)[0]


def claim_text(claim: LoopClaim) -> str:
    """Return a claim as written after ``prove``.

    Parameters
    ----------
    claim : LoopClaim
        The claim.
    """
    return text_of(claim_node(claim)).removeprefix("prove ")


def loop_sentence(
    claim: LoopClaim,
    sensors: Mapping[str, Sensor] | None = None,
    connect: Mapping[str, str] | None = None,
    *,
    plant: Plant | None = None,
    text: ControllerText | None = None,
    continuous: bool = False,
    duration: float = 0.0,
) -> str:
    """Return a claim with everything that sets its loop apart from the plain one.

    Included are the changes of `plant` from the one named in the claim, and of `text` from its
    file. A `duration`, s, is that of bounds, which claim nothing.
    """
    words = [claim_text(claim)]
    if duration:
        words = [f"{words[0].removeprefix('stable ')} for {number_text(duration)} s"]
    words += [] if plant is None else plant_changes(claim, plant)
    words += [] if text is None else controller_changes(text)
    words += [
        f"{name_text(name)} joined to {name_text(port)}"
        for name, port in (connect or {}).items()
        if name != port
    ]
    for name, sensor in (sensors or {}).items():
        parts = ", ".join(_sensor_words(sensor))
        if parts:
            words.append(f"sensor of {name_text(name)}: {parts}")
    if continuous:
        words.append("in continuous time")
    return "; ".join(words)


def _sensor_words(sensor: Sensor) -> Iterator[str]:
    if sensor.difference is not None:
        yield f"by difference, filter {number_text(sensor.difference)} s"
    if sensor.noise:
        yield f"noise {number_text(sensor.noise)}"
    if sensor.resolution:
        yield f"resolution {number_text(sensor.resolution)}"
    if sensor.delay:
        yield f"delay {number_text(sensor.delay)} s"


def claimed_plant(claim: LoopClaim, named: str | None = None, *, trust: bool = False) -> Plant:
    """Return the plant of a claim; a plant in a file only if its code may run.

    Code of the file `named` on the command line may run; with `trust` any code may.
    """
    return trusted_plant(claim.plant, named, trust=trust or claim.span == NOWHERE)


def require_sense(claim: LoopClaim) -> None:
    """Raise ClaimError for a meaningless claim, whatever its origin, with the part at fault."""
    for part, names in (
        ("at", [name for name, _ in claim.at]),
        ("with", [name for name, _, _ in claim.parameters]),
        ("from", [name for name, _, _ in claim.start]),
    ):
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise ClaimError(f"'{twice}' is twice after '{part}'")
    for name, value in claim.at:
        if not math.isfinite(value):
            raise ClaimError(f"the set point {name} = {value:g} is not a number")
    _require_references(claim)
    if not claim.output:
        if (
            claim.error
            or (claim.low, claim.high, claim.when) != (0.0, 0.0, "always")
            or _times(claim)
        ):
            raise ClaimError("bounds or times of no output are claimed")
        if not claim.stable:
            raise ClaimError("nothing is claimed")
        return
    if not (math.isfinite(claim.low) and math.isfinite(claim.high) and claim.low <= claim.high):
        ends = f"{claim.low:g} .. {claim.high:g}"
        raise ClaimError(f"{claim.subject} in {ends} is not an interval")
    _require_times(claim)


def _require_references(claim: LoopClaim) -> None:
    """Refuse references that no text can express."""
    fault, hint = reference_fault(claim)
    if fault:
        raise ClaimError(fault, hint=hint)
    for reference in claim.follows:
        _signal_of(reference)


def _signal_of(reference: FollowedReference) -> Signal:
    """Return the signal of a claim's reference; ClaimError if it has none."""
    if reference.kind not in FOLLOWED:
        raise ClaimError(f"'{reference.kind}' is not a reference of claims")
    try:
        signal = Signal(reference.kind, reference.numbers)
    except SignalError as error:
        raise ClaimError(str(error), hint=error.hint) from None
    # All of them: a text cannot leave one out.
    if len(signal.numbers) < (2 if signal.kind == "sine" else 3):
        raise ClaimError(f"a {signal.kind} of a claim says where it begins")
    if any(word == "AT" and number < 0.0 for word, number in signal.named):
        raise ClaimError(f"a {signal.kind} before 0 s is none of a run")
    return signal


def _require_times(claim: LoopClaim) -> None:
    """Refuse times outside a run, or times that the word before them does not take."""
    begin, end = number_text(claim.begin), number_text(claim.end)
    if claim.when == "always" and _times(claim):
        raise ClaimError(f"a claim that holds always has no times, such as {begin} .. {end} s")
    if claim.when == "after" and claim.begin < 0.0:
        raise ClaimError(f"'after {begin} s' is before a run begins, at 0 s")
    if claim.when == "after" and not (0.0 <= claim.begin < math.inf and math.isinf(claim.end)):
        raise ClaimError(f"not a claim for all time: 'after {begin} s' with an end at {end} s")
    if claim.when == "during" and not (0.0 <= claim.begin <= claim.end < math.inf and claim.end):
        raise ClaimError(
            f"not a time of a run: during {begin} .. {end} s", hint="as in during 0 .. 1 s"
        )


def _times(claim: LoopClaim) -> bool:
    return claim.begin != 0.0 or claim.end != math.inf


def problem_of(
    text: ControllerText,
    claim: LoopClaim,
    *,
    plant: Plant | None = None,
    connect: Mapping[str, str] | None = None,
    sensors: Mapping[str, Sensor] | None = None,
    inside: bool = False,
) -> LoopProblem:
    """Return the loop of a meaningful claim; `inside` as in `loop_problem`."""
    require_sense(claim)
    problem = loop_problem(
        text,
        plant if plant is not None else claimed_plant(claim),
        start={name: (low, high) for name, low, high in claim.start},
        parameters={name: (low, high) for name, low, high in claim.parameters},
        set_point={**dict(claim.at), **{each.port: _signal_of(each) for each in claim.follows}},
        sensors=sensors,
        connect=connect,
        inside=inside,
    )
    if claim.output:
        claimed_port(problem, claim)
    if claim.error:
        problem = problem.with_error(problem.site.interface.port(claim.output))
    _require_one_meaning(problem, claim)
    if claim.output or claim.start:
        problem.require_known_start()
    return problem


@dataclass(frozen=True)
class GivenLoop:
    """Controller and plant of a proof: the arguments of `problem_of`."""

    text: ControllerText
    plant: Plant | None
    connect: Mapping[str, str] | None
    sensors: Mapping[str, Sensor] | None

    def problem(self, claim: LoopClaim) -> LoopProblem:
        """Return the loop of a claim."""
        return problem_of(
            self.text, claim, plant=self.plant, connect=self.connect, sensors=self.sensors
        )

    def sentence(self, claim: LoopClaim, *, continuous: bool = False) -> str:
        """Return the statement of a claim about this loop."""
        return loop_sentence(
            claim, self.sensors, self.connect, plant=self.plant, text=self.text,
            continuous=continuous,
        )  # fmt: skip


def _require_one_meaning(problem: LoopProblem, claim: LoopClaim) -> None:
    """Refuse a name that is both a state of the plant and an output of another value."""
    used = {name for name, _, _ in claim.start} | {claim.output.rpartition(".")[2]}
    named = {port for _, port in problem.site.interface.outputs} & set(problem.states) & used
    if not named:
        return
    try:
        equations = problem.equations
    except LoopProofError:  # outputs unknown: nothing gets proved either
        return
    for (_, port), root in zip(problem.site.interface.outputs, equations.outputs, strict=True):
        if port in named:
            state = equations.states[problem.states.index(port)]
            if getattr(root, "name", "") != state:
                name = problem.plant.name
                raise ClaimError(
                    f"'{port}' is a state of {name}, and an output of {name} of another value",
                    hint="rename one of both in the plant",
                )


def claimed_in(problem: LoopProblem, claim: LoopClaim) -> ClaimedPeriods:
    """Return the control periods of a claim in its loop."""
    interface = problem.site.interface
    port = interface.port(claim.output) if claim.output else ("", "")
    jumps = port in interface.inputs
    if claim.error and port in problem.moved:
        jumps = problem.moved[port].signal.jump is not None
    return claimed_periods(claim, problem.period, jumps=jumps)


def claimed_port(problem: LoopProblem, claim: LoopClaim) -> str:
    """Return the claimed output, error or drive by its name in tubes and runs."""
    interface = problem.site.interface
    label = interface.label(interface.port(claim.output))
    return error_label(label) if claim.error else label


def error_label(output: str) -> str:
    """Return the name of an output's error in tubes and runs."""
    return f"error of {output}"
