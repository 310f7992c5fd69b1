"""Whom to cite for a file: ``fuzzyarm cite``."""

from __future__ import annotations

import argparse

from fuzzyarm.api import load
from fuzzyarm.cli.command import WordError, argument, command, json_of, print_json, say
from fuzzyarm.model.rulebase import RuleBase
from fuzzyarm.text.sources import SOURCES, Source
from fuzzyarm.version import __version__

_CITE = """Print BibTeX for the methods that a rule base or a controller uses, and for fuzzyarm.

A comment above each entry says what it is the source of. Methods whose first publication
could not be verified have none: what is printed can be copied into a bibliography.

  fuzzyarm cite rulebases/tipper2.frb > methods.bib
"""

_SELF = Source(
    "misc",
    {
        "author": "{The fuzzyarm developers}",
        "title": "fuzzyarm",
        "note": f"Version {__version__}, Python package",
    },
)


def _run(arguments: argparse.Namespace) -> int:
    methods = _methods(arguments.file)
    if arguments.json:
        rows = [
            {"key": key, "kind": SOURCES[key].kind, "fields": dict(SOURCES[key].fields), "of": of}
            for key, of in methods.items()
        ]
        print_json({"fuzzyarm": dict(_SELF.fields), "sources": rows}, 2)
        return 0
    say("% the program", *_SELF.bibtex("fuzzyarm").splitlines())
    for key, of in methods.items():
        say("", f"% {', '.join(of)}", *SOURCES[key].bibtex(key).splitlines())
    return 0


def _methods(path: str) -> dict[str, list[str]]:
    """Return the sources of a file: of a controller those of the rule bases that it uses."""
    from fuzzyarm.controller.text import ControllerText
    from fuzzyarm.model.methods import methods_of

    model = load(path)
    if isinstance(model, ControllerText):
        sheets = [sheet for listed in model.sheets.values() for sheet in listed]
        rulebases = [sheet for sheet in sheets if isinstance(sheet, RuleBase)]
    elif isinstance(model, RuleBase):
        rulebases = [model]
    else:
        raise WordError(f"{path} is a table, which does not say by which methods it was made")
    merged: dict[str, list[str]] = {}
    for rulebase in rulebases:
        for key, of in methods_of(rulebase).items():
            known = merged.setdefault(key, [])
            known += [name for name in of if name not in known]
    return merged


COMMANDS = (
    command(
        "cite",
        _CITE,
        _run,
        argument("file FILE", "a rule base (.frb, .fll, .fcl, .fis) or a controller"),
        json_of("the entries"),
    ),
)
