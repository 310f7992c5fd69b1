"""Ways from a fuzzy output to a number, one to a module.

Each module has ``one`` (a single point, plain Python) and ``many`` (arrays of points).
"""
