"""Proofs of a controller together with its plant."""
