"""Inference as machine code: a rule base becomes numbers, one kernel evaluates them all."""
