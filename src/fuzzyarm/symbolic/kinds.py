"""Kinds of shapes, norms, hedges and defuzzifiers, the built-in ones built-in and user-defined.

A kind is one definition; everything else follows from it::

    from fuzzyarm import kinds, op

    kinds.tnorm("yager2", lambda a, b: 1 - op.minimum(1, op.sqrt((1 - a) ** 2 + (1 - b) ** 2)))

After that ``and yager2`` works in files, in inference at a point and over arrays, compiled
and exported. For the command line a package names a module that makes such calls (or a function)
under the entry point ``fuzzyarm.kinds``; it is imported when a file uses an unknown kind.
"""

from fuzzyarm.symbolic import defuzzifiers, norms, records, shapes
from fuzzyarm.symbolic.defuzzifiers import *  # noqa: F403 - re-export
from fuzzyarm.symbolic.records import *  # noqa: F403 - re-export

__all__ = records.__all__ + defuzzifiers.__all__

shapes.register()
norms.register()
