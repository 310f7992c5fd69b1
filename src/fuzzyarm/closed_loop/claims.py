"""Claims about a loop: from text, to text, and the loop that they are about."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

from fuzzyarm.closed_loop.problem import ClaimError, LoopProblem, loop_problem
from fuzzyarm.controller.text import ControllerText
from fuzzyarm.language.document import parse_document
from fuzzyarm.language.loop_claims import LoopClaimNode, claim_node
from fuzzyarm.language.rows import text_of
from fuzzyarm.language.tokens import name_text
from fuzzyarm.loop.course import Sensor
from fuzzyarm.model.claims import LoopClaim
from fuzzyarm.plant.own import find_plant
from fuzzyarm.plant.plant import Plant
from fuzzyarm.text.diagnostic import NOWHERE, RuleBaseError
from fuzzyarm.text.names import near_hint

__all__ = ["claim_text", "claimed_port", "problem_of", "read_claim"]


OPENINGS = ("stable", "on", "at", "with", "from")
"""Words that a claim may begin with, where its plant is known."""


def read_claim(text: str, plant: str = "", argument: str = "") -> LoopClaim:
    """Return the claim in a text such as ``stable on motor``.

    Parameters
    ----------
    text : str
        As after ``prove`` in the file of a controller.
    plant : str, optional
        Its name, where the text leaves ``on PLANT`` out: ``stable``, ``from position in
        -0.3 .. 0.3: position in -1 .. 1``, ``position in -1 .. 1``.
    argument : str, optional
        As what the text was given; an error begins with it.

    Raises
    ------
    RuleBaseError
        With what is wrong with it, and what was probably meant.
    """
    words = text.strip().removeprefix("prove ").strip()
    if plant and not re.match(r"(stable\s+)?on\s", words):
        stable = re.match(r"stable\b", words)
        rest = words[stable.end() :].strip() if stable else words
        head = f"{'stable ' if stable else ''}on {name_text(plant)}"
        claimed = not rest or re.match(r"(at|with|from)\s|:", rest)
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
    """Return what the first word of a claim probably means."""
    first = text.split(maxsplit=1)[0] if text.split() else ""
    return "" if first in OPENINGS else near_hint(first, OPENINGS)[0]


def claim_text(claim: LoopClaim) -> str:
    """Return a claim as it stands after ``prove``.

    Parameters
    ----------
    claim : LoopClaim
        Which.
    """
    return text_of(claim_node(claim)).removeprefix("prove ")


def problem_of(
    text: ControllerText,
    claim: LoopClaim,
    *,
    plant: Plant | None = None,
    connect: Mapping[str, str] | None = None,
    sensors: Mapping[str, Sensor] | None = None,
) -> LoopProblem:
    """Return the loop of a claim."""
    problem = loop_problem(
        text,
        plant if plant is not None else find_plant(claim.plant),
        start={name: (low, high) for name, low, high in claim.start},
        parameters={name: (low, high) for name, low, high in claim.parameters},
        set_point=dict(claim.at),
        sensors=sensors,
        connect=connect,
    )
    if claim.output:
        claimed_port(problem, claim)
        if not claim.low <= claim.high:
            ends = f"{claim.low:g} .. {claim.high:g}"
            raise ClaimError(f"{claim.output} in {ends} is not an interval")
    return problem


def claimed_port(problem: LoopProblem, claim: LoopClaim) -> str:
    """Return the output or the drive that is claimed of, as tubes and runs call it."""
    interface = problem.site.interface
    return interface.label(interface.port(claim.output))
