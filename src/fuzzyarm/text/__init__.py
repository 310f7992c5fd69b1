"""Text of any kind: positions, diagnostics, names, numbers, and files that are replaced whole."""
