"""The words that start a line of a ``.lut`` file."""

KEYWORDS: dict[str, str] = {
    "fuzzyarm-table": "the format and its version",
    "input": "an input, its range and what it is",
    "output": "the output, its range and what it is",
    "index": "which input is the row and which the column (and the page)",
    "levels": "the sample points of the inputs",
    "bins": "thresholds between the cells",
    "round": "the step that the values were rounded to",
    "mode": "how the table is looked up: bins, nearest or linear",
    "origin": "something about the making of the table",
    "grid": "the values",
}
"""Keyword → one line for help."""
