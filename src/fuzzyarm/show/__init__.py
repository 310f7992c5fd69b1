"""Drawings of models, in the terminal and as figures."""
