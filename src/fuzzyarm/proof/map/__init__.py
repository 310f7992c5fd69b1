"""Properties of a rule base at every point: bounds, slopes, symmetry, errors of a table.

:func:`prove` gives a :class:`Verdict` on a statement; :class:`Prover` gives single bounds. A
rule base of piecewise linear terms, min and the exact centroid (or averages of numbers) is cut into
pieces on which the output is a quotient of polynomials; all others are bounded over boxes.
:func:`sector` and :func:`slopes_at` compare an output with a linear law;
:func:`prove_drives` does so for the drives of a controller.

Reading order: :mod:`.straight` (a rule base in straight lines), :mod:`.pieces` (its cells and
simplices), :mod:`.surface` (quotients of polynomials), :mod:`.bernstein` (their suprema),
:mod:`.search` (bounds in floats and rationals), :mod:`.prover` (statements), :mod:`.evidence` and
:mod:`.verdicts`; :mod:`.boxes` for all other rule bases.
"""

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily
from fuzzyarm.proof.map.bounds import Bounds, UnprovableError
from fuzzyarm.proof.map.prover import Prover
from fuzzyarm.proof.map.sector import NoSectorError, Sector, sector, slopes_at
from fuzzyarm.proof.map.tables import table_proof
from fuzzyarm.proof.map.verdicts import Verdict, property_text, prove, prove_all, read_property

if TYPE_CHECKING:
    from fuzzyarm.proof.map.controllers import prove_drives

__all__ = [
    "Bounds",
    "NoSectorError",
    "Prover",
    "Sector",
    "UnprovableError",
    "Verdict",
    "property_text",
    "prove",
    "prove_all",
    "prove_drives",
    "read_property",
    "sector",
    "slopes_at",
    "table_proof",
]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {"controllers": ("prove_drives",)}, __all__)
