"""The mathematics of the language, each definition once.

A shape, norm, hedge or formula is one expression. Numbers, arrays, machine code, C,
Structured Text, derivatives and bounds are readings of it.

Reading order: :mod:`.nodes` (expressions as graphs), :mod:`.operations` (the table of operations),
:mod:`.op` (the functions in definitions), :mod:`.evaluation` (numbers, arrays, derivative,
bounds), :mod:`.printing` and :mod:`.functions` (source text, compiled functions),
:mod:`.records` (the record of a kind), :mod:`.shapes` and :mod:`.norms` (the built-in ones),
:mod:`.kinds` (all of them), :mod:`.formulas` (formulas of users).

Public are :mod:`.kinds` and :mod:`.op`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

if TYPE_CHECKING:
    from fuzzyarm.symbolic import kinds, op

__all__ = [
    "kinds",
    "op",
]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(
        __name__,
        {
            "kinds": ("kinds",),
            "op": ("op",),
        },
    )
