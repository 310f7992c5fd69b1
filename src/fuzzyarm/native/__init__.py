"""Kernels in other languages: printed from their own source, and compiled when fuzzyarm is built.

A kernel is plain Python over scalars and arrays (:mod:`fuzzyarm.kernels`).
:mod:`fuzzyarm.native.translation` reads its source and finds the type of every name; a
:class:`~fuzzyarm.native.targets.Target` says how a language spells what was read.
:mod:`fuzzyarm.native.roots` lists the kernels that are built, :mod:`fuzzyarm.native.build` writes
and compiles them.
"""
