"""Machine code of the kernels: which are built, how they are compiled, and the module for Python.

:mod:`fuzzyarm.native.roots` lists the kernels, :mod:`fuzzyarm.native.build` prints them in C
(:mod:`fuzzyarm.translation`) and compiles them with ``module.c``, when fuzzyarm itself is built. A
running fuzzyarm needs nothing of this package; :mod:`fuzzyarm.kernels` loads what it made.
"""
