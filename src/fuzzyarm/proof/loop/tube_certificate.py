"""Certificates of claims for a bounded time, as files: sets of all runs, sample by sample."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from fuzzyarm.base.files import write_atomically
from fuzzyarm.control.controllers.text import ControllerText
from fuzzyarm.control.loop.course import Sensor
from fuzzyarm.language.model.claims import LoopClaim
from fuzzyarm.plant.plant import Plant
from fuzzyarm.proof.claim.identity import loop_digests
from fuzzyarm.proof.claim.problem import LoopProofError
from fuzzyarm.proof.claim.text import claimed_port, problem_of
from fuzzyarm.proof.loop.certificate import (
    Certificate,
    certificate_of,
    claim_of,
    fingerprints_of,
    loop_data,
    sealed,
    sensors_by_name,
    sensors_of,
    texts_of,
    unsealed,
)
from fuzzyarm.proof.loop.certificate_fields import Field, read_fields
from fuzzyarm.proof.loop.timed import TUBE_BUDGET
from fuzzyarm.proof.loop.tube_checker import BoxProof, TubeLoop, TubeSet, tube_refutation
from fuzzyarm.proof.loop.tube_maker import proof_boxes
from fuzzyarm.proof.stop import Stop, TimeOverError

__all__ = ["TubeCertificate", "certify_tube", "read_certificate", "write_certificate"]

FORMAT = "fuzzyarm-tube 3"


@dataclass(frozen=True)
class TubeCertificate:
    """What proves a claim for a bounded time, if the checker says so.

    Attributes
    ----------
    claim, controller, fingerprints, sensors, connect, digests
        As a :class:`fuzzyarm.proof.loop.Certificate` has them.
    boxes : tuple of BoxProof
        Parts of the starts, each with its sets.
    """

    claim: LoopClaim
    controller: str
    fingerprints: Mapping[str, str]
    boxes: tuple[BoxProof, ...]
    sensors: Mapping[str, Sensor] = field(default_factory=dict)
    connect: Mapping[str, str] = field(default_factory=dict)
    digests: Mapping[str, str] = field(default_factory=dict)

    def as_data(self) -> dict[str, Any]:
        """Return it as plain data, sealed."""
        return sealed(
            {
                "format": FORMAT,
                **loop_data(self.claim, self.sensors, self.connect),
                "controller": self.controller,
                "sha256": dict(self.fingerprints),
                "proved": dict(self.digests),
                "boxes": [
                    {
                        # The halvings that lead to the box: along which dimension, and whether to
                        # its upper half.
                        "path": [[dimension, upper] for dimension, upper in box.path],
                        "sets": [
                            {
                                "centre": _texts(tube_set.centre),
                                "rows": [_texts(r) for r in tube_set.rows],
                            }
                            for tube_set in box.sets
                        ],
                    }
                    for box in self.boxes
                ],
            }
        )

    @property
    def seal(self) -> str:
        """SHA-256 of its contents."""
        return str(self.as_data()["seal"])

    def refutation(self, text: ControllerText, plant: Plant | None = None) -> str:
        """Return why it does not prove its claim; empty where it does.

        Parameters
        ----------
        text : ControllerText
            The controller.
        plant : Plant, optional
            In place of the one that the claim names.
        """
        if not self.claim.output or math.isinf(self.claim.end):
            return "it is of a claim without an end"
        if self.claim.stable:
            return "sets for a time do not show that the loop is stable"
        problem = problem_of(
            text, self.claim, plant=plant, sensors=self.sensors, connect=self.connect
        )
        port = claimed_port(problem, self.claim)
        try:
            return tube_refutation(TubeLoop(problem), self.claim, port, self.boxes)
        # A file may hold anything: numbers that do not fit the loop prove nothing.
        except (LoopProofError, KeyError, ValueError, IndexError) as error:
            return str(error)


def _texts(values: tuple[Fraction, ...]) -> list[str]:
    return [str(value) for value in values]


def certify_tube(
    text: ControllerText,
    claim: LoopClaim,
    *,
    plant: Plant | None = None,
    connect: Mapping[str, str] | None = None,
    sensors: Mapping[str, Sensor] | None = None,
    budget: float = TUBE_BUDGET,
    tell: Callable[[int, float], None] | None = None,
) -> TubeCertificate:
    """Make a certificate of a claim for a bounded time.

    Parameters
    ----------
    text, claim, plant, connect, sensors
        As for :func:`fuzzyarm.proof.loop.prove_loop`.
    budget : float
        s.
    tell : callable, optional
        Called with the number of sets so far, and NaN.

    Raises
    ------
    LoopProofError
        If none was found: a tube may prove what the simpler sets of a certificate do not.
    """
    if not claim.output or math.isinf(claim.end):
        raise LoopProofError("a tube is certified of a claim with an end", hint="during 0 .. 1 s")
    if claim.stable:
        raise LoopProofError("a tube does not show that a loop is stable")
    problem = problem_of(text, claim, plant=plant, sensors=sensors, connect=connect)
    stop = Stop(budget, tell)
    try:
        with stop:
            loop = TubeLoop(problem, stop)
            boxes = proof_boxes(loop, claim, claimed_port(problem, claim), stop)
    except TimeOverError as error:
        boxes = str(error)
    if isinstance(boxes, str):
        raise LoopProofError(f"no certificate was found: {boxes}")
    return TubeCertificate(
        claim,
        text.path,
        fingerprints_of(text),
        boxes,
        sensors_by_name(problem),
        dict(connect or {}),
        loop_digests(text, problem.plant),
    )


def write_certificate(certificate: Certificate | TubeCertificate, path: str) -> None:
    """Write a certificate of a region or of a tube.

    Parameters
    ----------
    certificate : Certificate or TubeCertificate
        Which.
    path : str
        The file, replaced as a whole.
    """
    data = json.dumps(certificate.as_data(), indent=1, ensure_ascii=False)
    write_atomically(path, (data + "\n").encode())


def read_certificate(path: str) -> Certificate | TubeCertificate:
    """Read a certificate of a region or of a tube, without checking its proof.

    Parameters
    ----------
    path : str
        The file.

    Raises
    ------
    OSError
        If it cannot be read.
    CertificateError
        If it is not a certificate, or is damaged.
    """
    whole = read_fields(path)
    if whole.value.get("format") != FORMAT:
        return certificate_of(whole)
    data = unsealed(whole, FORMAT)
    return TubeCertificate(
        claim_of(data),
        data["controller"].text,
        texts_of(data["sha256"]),
        tuple(map(_box, data["boxes"])),
        sensors_of(data),
        texts_of(data["connect"]),
        texts_of(data["proved"]),
    )


def _box(box: Field) -> BoxProof:
    halvings = (halving.row(2) for halving in box["path"])
    return BoxProof(
        tuple((dimension.index, upper.flag) for dimension, upper in halvings),
        tuple(
            TubeSet(
                tuple(x.rational for x in record["centre"]),
                tuple(tuple(x.rational for x in row) for row in record["rows"]),
            )
            for record in box["sets"]
        ),
    )
