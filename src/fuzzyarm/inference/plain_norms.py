"""T-norms and s-norms of two floats; the array twins are in `tnorms` and `snorms`."""

from fuzzyarm.rulebase.norms import SNORMS, TNORMS, Norm

__all__ = ["SNORMS", "TNORMS", "Norm"]
