"""The studio: a rule base on the left, what it means on the right, redrawn while it is typed.

The scenes (:mod:`fuzzyarm.studio.scene`) need rich alone, and ``fuzzyarm watch`` shows them
too; :mod:`fuzzyarm.studio.app` needs the extra ``fuzzyarm[studio]``.
"""
