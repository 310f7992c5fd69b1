"""Whom to cite for a file: ``fuzzyarm cite``."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from fuzzyarm.apps.cli.command import WordError, argument, command, json_of, print_json, say
from fuzzyarm.base.jsonable import entry, json_properties
from fuzzyarm.base.sources import SOURCES, Publication
from fuzzyarm.exchange.files import load
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.version import __version__

_CITE = """Print BibTeX for the methods that a rule base or a controller uses, and for fuzzyarm.

A comment above each entry names its method. Methods without a verified first publication have
no entry, so the output can be copied into a bibliography. For a controller its structure is
cited as well, if it is recognised; for a compiled table the rule base beside it.

  fuzzyarm cite rulebases/tipper2.frb > methods.bib
"""

_SELF = Publication(
    "misc",
    {
        "author": "{The fuzzyarm developers}",
        "title": "fuzzyarm",
        "note": f"Version {__version__}, Python package",
    },
)


@json_properties("key kind=publication.kind fields=publication.fields of")
@dataclass(frozen=True)
class Cited:
    """A publication."""

    publication: Publication
    key: str = entry("of the entry")
    of: Sequence[str] = entry("the methods that it is the source of")


def _run(arguments: argparse.Namespace) -> int:
    methods = _methods(arguments.file)
    if arguments.json:
        rows = [Cited(SOURCES[key], key, of) for key, of in methods.items()]
        print_json({"fuzzyarm": _SELF.fields, "sources": rows}, 2)
        return 0
    say("% the program", *_SELF.bibtex("fuzzyarm").splitlines())
    for key, of in methods.items():
        say("", f"% {', '.join(of)}", *SOURCES[key].bibtex(key).splitlines())
    return 0


def _methods(path: str) -> dict[str, list[str]]:
    """Return the sources of a file: of a controller's structure, and of its rule bases."""
    from fuzzyarm.control.controllers.text import ControllerText
    from fuzzyarm.language.model.methods import methods_of, structures_of

    model = load(path)
    merged: dict[str, list[str]] = {}
    if isinstance(model, ControllerText):
        merged = structures_of(model.model)
        sheets = [sheet for listed in model.sheets.values() for sheet in listed]
        rulebases = [sheet for sheet in sheets if isinstance(sheet, RuleBase)]
    elif isinstance(model, RuleBase):
        rulebases = [model]
    else:
        rulebases = [_compiled_from(path, dict(model.provenance))]
    for rulebase in rulebases:
        for key, of in methods_of(rulebase).items():
            names = merged.setdefault(key, [])
            names += [name for name in of if name not in names]
    return merged


def _compiled_from(path: str, provenance: Mapping[str, str]) -> RuleBase:
    """Return the rule base behind a table, if unchanged."""
    from fuzzyarm.language import write

    source = provenance.get("source", "")
    if provenance.get("made") != "compiled" or not source:
        raise WordError(f"{path} is a table, without a record of its methods")
    beside = Path(path).parent / Path(source).name
    if not beside.is_file():
        raise WordError(f"{path} was compiled from {source}, which is not beside it")
    rulebase = load(beside)
    if not isinstance(rulebase, RuleBase) or sha256(
        write(rulebase).encode()
    ).hexdigest() != provenance.get("sha256"):
        raise WordError(f"{path} was compiled from {source}, which has changed since")
    return rulebase


COMMANDS = (
    command(
        "cite",
        _CITE,
        _run,
        argument("file FILE", "a rule base (.frb, .fll, .fcl, .fis), a controller or a table"),
        json_of("the entries"),
    ),
)
