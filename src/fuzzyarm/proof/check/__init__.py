"""The checker of certificates: independent of the search, in third-party arithmetic.

Reading order, each module after those that it needs:

- :mod:`.certificate`: the input;
- :mod:`.spans`, :mod:`.numbers`: many intervals at once; rationals and the balls of python-flint;
- :mod:`.polynomials`, :mod:`.clipped`, :mod:`.pieces`, :mod:`.rules`: a rule base on its pieces;
- :mod:`.walk`: the instructions of a controller over any number system;
- :mod:`.slopes`, :mod:`.motion`: the plant; :mod:`.lines`, :mod:`.loop`: the linear loop at rest;
- :mod:`.region`: Lyapunov functions;
- :mod:`.bands`, :mod:`.forms`, :mod:`.references`, :mod:`.tube`: sets of runs, sample by sample;
- :mod:`.theorem`: the proof of a claim from those;
- :mod:`.checking`: the check of a certificate, from its files to its words.
"""

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily
from fuzzyarm.proof.check.certificate import (
    Certificate,
    CertificateError,
    read_certificate,
    write_certificate,
)
from fuzzyarm.proof.check.checking import Checked, check_certificate

__all__ = [
    "Certificate",
    "CertificateError",
    "Checked",
    "check_certificate",
    "read_certificate",
    "write_certificate",
]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
