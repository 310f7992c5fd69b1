"""Fuzzy control from a text file to a robot arm.

The packages stand on each other in one direction::

    rulebase, formats  →  inference  →  lut  →  arm  →  control  →  study, show  →  cli, lsp

:mod:`fuzzyarm.rulebase` reads, checks and prints rule files; :mod:`fuzzyarm.inference`
evaluates them; :mod:`fuzzyarm.lut` compiles them to lookup tables; :mod:`fuzzyarm.arm` is
the plant; :mod:`fuzzyarm.control` has the controllers; :mod:`fuzzyarm.study` has the
published experiments; :mod:`fuzzyarm.show` draws. Importing this page is instant: what a
name needs is loaded when the name is used.
"""

__version__ = "0.1.0"
