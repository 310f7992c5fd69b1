"""Whose number is right: cases for programs that infer with fuzzy rules, and runners for them."""
