"""Publications behind the methods, by key, with BibTeX.

Records of methods name these keys (`sources` of :class:`fuzzyarm.symbolic.records.Kind`). Every
entry was checked: authors, volume, year and pages.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Publication:
    """One publication.

    Attributes
    ----------
    kind : str
        BibTeX type: ``article``, ``incollection``, ``book``.
    fields : mapping of str to str
        Fields in printing order.
    """

    kind: str
    fields: Mapping[str, str]

    def bibtex(self, key: str) -> str:
        """Return the BibTeX entry under a key."""
        width = max(map(len, self.fields))
        lines = [f"  {name:{width}} = {{{value}}}," for name, value in self.fields.items()]
        return "\n".join([f"@{self.kind}{{{key},", *lines, "}"])


def _article(
    author: str, title: str, journal: str, volume: str, year: str, pages: str, number: str = ""
) -> Publication:
    issue = {"number": number} if number else {}
    fields = {"author": author, "title": title, "journal": journal, "volume": volume}
    return Publication("article", {**fields, **issue, "pages": pages, "year": year})


_SMC = "IEEE Transactions on Systems, Man, and Cybernetics"

SOURCES: Mapping[str, Publication] = {
    "zadeh1965": _article(
        "Zadeh, Lotfi A.", "Fuzzy sets", "Information and Control", "8", "1965", "338--353", "3"
    ),
    "mamdani1975": _article(
        "Mamdani, E. H. and Assilian, S.",
        "An experiment in linguistic synthesis with a fuzzy logic controller",
        "International Journal of Man-Machine Studies",
        "7",
        "1975",
        "1--13",
        "1",
    ),
    "takagi1985": _article(
        "Takagi, Tomohiro and Sugeno, Michio",
        "Fuzzy identification of systems and its applications to modeling and control",
        _SMC,
        "SMC-15",
        "1985",
        "116--132",
        "1",
    ),
    "tsukamoto1979": Publication(
        "incollection",
        {
            "author": "Tsukamoto, Y.",
            "title": "An approach to fuzzy reasoning method",
            "booktitle": "Advances in Fuzzy Set Theory and Applications",
            "editor": "Gupta, M. M. and Ragade, R. K. and Yager, R. R.",
            "publisher": "North-Holland",
            "address": "Amsterdam",
            "pages": "137--149",
            "year": "1979",
        },
    ),
    "mudi1999": _article(
        "Mudi, Rajani K. and Pal, Nikhil R.",
        "A robust self-tuning scheme for PI- and PD-type fuzzy controllers",
        "IEEE Transactions on Fuzzy Systems",
        "7",
        "1999",
        "2--16",
        "1",
    ),
    "karnik2001": _article(
        "Karnik, Nilesh N. and Mendel, Jerry M.",
        "Centroid of a type-2 fuzzy set",
        "Information Sciences",
        "132",
        "2001",
        "195--220",
        "1--4",
    ),
}
"""Publications by keys."""
