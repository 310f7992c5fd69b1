"""What each format calls the norms of the model, and back."""

from __future__ import annotations

FLL_CONJUNCTIONS = {
    "Minimum": "min",
    "AlgebraicProduct": "product",
    "BoundedDifference": "bounded",
    "DrasticProduct": "drastic",
    "HamacherProduct": "hamacher",
    "EinsteinProduct": "einstein",
    "NilpotentMinimum": "nilpotent",
}
"""Class names of fuzzylite's T-norms."""

FLL_DISJUNCTIONS = {
    "Maximum": "max",
    "AlgebraicSum": "probor",
    "BoundedSum": "bounded",
    "DrasticSum": "drastic",
    "HamacherSum": "hamacher",
    "EinsteinSum": "einstein",
    "NilpotentMaximum": "nilpotent",
    "UnboundedSum": "sum",
    "NormalizedSum": "normalized",
}
"""Class names of fuzzylite's S-norms."""

FIS_CONJUNCTIONS = {
    "min": "min",
    "prod": "product",
    "bounded_difference": "bounded",
    "drastic_product": "drastic",
    "hamacher_product": "hamacher",
    "einstein_product": "einstein",
    "nilpotent_minimum": "nilpotent",
}
"""MATLAB has the first two, Octave all but the last, fuzzylite all."""

FIS_DISJUNCTIONS = {
    "max": "max",
    "probor": "probor",
    "sum": "sum",
    "bounded_sum": "bounded",
    "drastic_sum": "drastic",
    "hamacher_sum": "hamacher",
    "einstein_sum": "einstein",
    "nilpotent_maximum": "nilpotent",
    "normalized_sum": "normalized",
}
"""MATLAB has the first three, Octave all but the last two, fuzzylite all."""

FCL_CONJUNCTIONS = {
    "MIN": "min",
    "PROD": "product",
    "BDIF": "bounded",
    "DPROD": "drastic",
    "DMIN": "drastic",
    "HPROD": "hamacher",
    "HAMACHER": "hamacher",
    "EPROD": "einstein",
    "NMIN": "nilpotent",
    "NIPMIN": "nilpotent",
}
"""The words of IEC 61131-7, fuzzylite and jFuzzyLogic together; no word has two meanings."""

FCL_DISJUNCTIONS = {
    "MAX": "max",
    "ASUM": "probor",
    "PROBOR": "probor",
    "BSUM": "bounded",
    "DSUM": "drastic",
    "DMAX": "drastic",
    "HSUM": "hamacher",
    "ESUM": "einstein",
    "EINSTEIN": "einstein",
    "NMAX": "nilpotent",
    "NIPMAX": "nilpotent",
    "NSUM": "normalized",
    "SUM": "sum",
}
"""As above, for OR and ACCU."""

JFUZZYLOGIC_PAIRS = {
    "min": "max",
    "product": "probor",
    "bounded": "bounded",
    "drastic": "drastic",
    "nilpotent": "nilpotent",
    "hamacher": "einstein",
}
"""jFuzzyLogic sets OR by AND and AND by OR: T-norm → the S-norm that goes with it."""


def reverse(table: dict[str, str], prefer: tuple[str, ...] = ()) -> dict[str, str]:
    """Return model name → format's word; of several words the first, or one of `prefer`."""
    back: dict[str, str] = {}
    for word, name in table.items():
        if name not in back or word in prefer:
            back[name] = word
    return back
