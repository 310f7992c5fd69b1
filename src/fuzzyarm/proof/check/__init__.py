"""The checker of certificates: independent of the search, in third-party arithmetic.

Read :mod:`.certificate` first, then :mod:`.checking`. A region goes through :mod:`.region`,
:mod:`.loop` and :mod:`.lines`, a tube through :mod:`.tube`; both through the checker's own control
period (:mod:`.walk`), pieces of rule bases (:mod:`.rules`), slopes and plant (:mod:`.slopes`,
:mod:`.motion`), in the balls and rationals of python-flint (:mod:`.numbers`).
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
