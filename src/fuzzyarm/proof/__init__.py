"""Proofs: of a rule base at every point, of a closed loop from every start.

Read :mod:`.map.prover` first, then :mod:`.claim.problem` and :mod:`.check`. Every
number that enters a verdict is rounded outward.

map
    A rule base or table: bounds, slopes, symmetry, sectors.
check
    The checker of certificates, which imports nothing of the search.
claim
    Claims about a loop: their text, and the loop that they name.
loop
    A controller with its plant: invariant regions, tubes, and their certificates.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

if TYPE_CHECKING:
    from fuzzyarm.proof import loop as loop
    from fuzzyarm.proof import map as map  # noqa: A004

__all__ = ["loop", "map"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, (), __all__)
