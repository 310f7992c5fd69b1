"""The language as text: tokens, statements and the syntax tree."""
