"""Proofs of a controller together with its plant: stable, inside, reached.

:func:`prove` takes a rule base or a controller; of a controller a claim about its loop, of which
:func:`check_certificate` checks the certificate.
"""

from typing import TYPE_CHECKING

from fuzzyarm.closed_loop.call import prove
from fuzzyarm.closed_loop.certificate import Certificate, CertificateError
from fuzzyarm.closed_loop.claims import claim_text, read_claim
from fuzzyarm.closed_loop.enclosure import EnclosureError
from fuzzyarm.closed_loop.problem import LoopProofError, loop_problem
from fuzzyarm.closed_loop.timed import loop_tube
from fuzzyarm.closed_loop.tube import Demand, Tube, tube
from fuzzyarm.closed_loop.tube_certificate import (
    TubeCertificate,
    certify_tube,
    read_certificate,
    write_certificate,
)
from fuzzyarm.closed_loop.verdicts import LoopVerdict, check_certificate, prove_loop
from fuzzyarm.lazy import lazily

__all__ = [
    "Certificate",
    "CertificateError",
    "Demand",
    "EnclosureError",
    "LoopProofError",
    "LoopVerdict",
    "Tube",
    "TubeCertificate",
    "certify_tube",
    "check_certificate",
    "claim_text",
    "loop_problem",
    "loop_tube",
    "prove",
    "prove_loop",
    "read_certificate",
    "read_claim",
    "tube",
    "write_certificate",
]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
