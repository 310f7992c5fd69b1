"""Claims about a loop: their text, their loop, and its identity.

Read :mod:`.problem` first, then :mod:`.own_start`. Search and checker share this room, and
nothing else.
"""

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily
from fuzzyarm.proof.claim.problem import LoopProblem, LoopProofError, loop_problem
from fuzzyarm.proof.claim.text import claim_text, read_claim

__all__ = ["LoopProblem", "LoopProofError", "claim_text", "loop_problem", "read_claim"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
