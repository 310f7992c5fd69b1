"""Kernels in other languages: read from their own source, printed for a target.

:mod:`fuzzyarm.translation.functions` reads a kernel and finds the type of every name; a
:class:`~fuzzyarm.translation.targets.Target` says how a language spells what was read.
"""
