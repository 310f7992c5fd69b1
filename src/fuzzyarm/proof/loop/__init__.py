"""Proofs of a controller together with its plant: stable, inside, reached.

:func:`prove` takes a rule base or a controller, the latter with a claim about its loop;
:func:`check_certificate` checks the certificate of such a proof.
"""

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily
from fuzzyarm.proof.check.certificate import (
    Certificate,
    CertificateError,
    read_certificate,
    write_certificate,
)
from fuzzyarm.proof.claim.problem import LoopProofError, loop_problem
from fuzzyarm.proof.claim.text import claim_text, read_claim
from fuzzyarm.proof.loop.boxes import certify_tube
from fuzzyarm.proof.loop.call import prove
from fuzzyarm.proof.loop.enclosure import EnclosureError
from fuzzyarm.proof.loop.follower import Demand
from fuzzyarm.proof.loop.map_search import MapSearch, map_starts
from fuzzyarm.proof.loop.margins import DriveMargins, Margins, margins
from fuzzyarm.proof.loop.parts import prove_loop
from fuzzyarm.proof.loop.start_map import MappedBox, StartMap
from fuzzyarm.proof.loop.timed import loop_tube
from fuzzyarm.proof.loop.tube import Tube, tube
from fuzzyarm.proof.loop.verdicts import LoopVerdict

__all__ = [
    "Certificate",
    "CertificateError",
    "Demand",
    "DriveMargins",
    "EnclosureError",
    "LoopProofError",
    "LoopVerdict",
    "MapSearch",
    "MappedBox",
    "Margins",
    "StartMap",
    "Tube",
    "certify_tube",
    "claim_text",
    "loop_problem",
    "loop_tube",
    "map_starts",
    "margins",
    "prove",
    "prove_loop",
    "read_certificate",
    "read_claim",
    "tube",
    "write_certificate",
]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
