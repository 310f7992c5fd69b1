"""Ways from a fuzzy output to a number.

Each way has a function for a single point (``…_at_point``, plain Python) and one for arrays
of points (``…_over_arrays``); :mod:`fuzzyarm.inference.defuzzify.dispatch` chooses.
"""
