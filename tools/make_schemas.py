"""Make docs/schemas/*.json and docs/reference/json.md: `python tools/make_schemas.py`.

What ``--json`` prints is a record, see `fuzzyarm.base.jsonable`. JSON Schemas (draft 2020-12) and
the page follow from the types and the words of its class; only the table of commands stands here.
`tests/cli/test_json_schemas.py` holds what commands print to the schemas, and them to what commands
print: a property that is never printed is found.
"""

from __future__ import annotations

import ast
import inspect
import json
import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from enum import StrEnum
from fractions import Fraction
from functools import cache, cached_property
from importlib import import_module
from pathlib import Path
from types import FunctionType, NoneType, UnionType
from typing import Any, Literal, NamedTuple, Union, get_args, get_origin, get_type_hints

import numpy as np

import fuzzyarm.requests
from fuzzyarm.apps.cli.cite import Cited
from fuzzyarm.apps.cli.convert import Conversion, ScriptConversion
from fuzzyarm.apps.cli.learn import Learned
from fuzzyarm.apps.cli.start import ShippedFile
from fuzzyarm.apps.cli.sweep import SweepComparison, SweepReport
from fuzzyarm.apps.dossier import ExportReport
from fuzzyarm.apps.grading import Grade, HiddenLine
from fuzzyarm.apps.show.controller_diff import ControllerDiff
from fuzzyarm.apps.show.diagram import Diagram
from fuzzyarm.apps.show.diff import RuleBaseDiff
from fuzzyarm.apps.study.comparison import Compared
from fuzzyarm.apps.study.cost import Operations
from fuzzyarm.apps.study.identify import Identified
from fuzzyarm.apps.study.published import PublishedRow
from fuzzyarm.apps.study.reproduce import Reproduced
from fuzzyarm.base.diagnostic import Diagnostic
from fuzzyarm.base.files import write_atomically
from fuzzyarm.base.jsonable import JsonProperty, properties_of
from fuzzyarm.control.controllers.law import Gain
from fuzzyarm.control.loop.recorded import Replay
from fuzzyarm.control.loop.run import Run
from fuzzyarm.exchange.export import Exported, ExportedController
from fuzzyarm.exchange.export.arduino import BoardFolder
from fuzzyarm.inference.trace import Trace
from fuzzyarm.language.model.controller import ControllerModel
from fuzzyarm.language.model.rulebase import RuleBase
from fuzzyarm.learning.report import FitReport
from fuzzyarm.learning.tuning.result import Tuned
from fuzzyarm.learning.validation import Validation
from fuzzyarm.proof.loop.margins import DriveMargins
from fuzzyarm.proof.loop.start_map import StartMap
from fuzzyarm.proof.loop.tube import Tube
from fuzzyarm.proof.loop.verdicts import LoopVerdict
from fuzzyarm.proof.map.bounds import TABLE_ERROR, Bounds
from fuzzyarm.proof.map.controllers import DriveProof
from fuzzyarm.proof.map.sector import Sector
from fuzzyarm.proof.map.verdicts import Verdict
from fuzzyarm.requests import Request
from fuzzyarm.requests.schema import schema_of as schema_of_request
from fuzzyarm.table.axis import TableHeader
from fuzzyarm.table.diff import TableDiff
from fuzzyarm.table.fidelity import CompileReport

DOCS = Path(__file__).parents[1] / "docs"
Schema = dict[str, Any]

# --- Types and words of records ---

_PLAIN = {str: "string", int: "integer", bool: "boolean", Path: "string", Fraction: "number"}
_SECTION = re.compile(
    r"^(?:Attributes|Parameters)\n-+\n(.*?)(?=^\w+\n-+\n|\Z)", re.DOTALL | re.MULTILINE
)
_ENTRY = re.compile(r"^(\w[\w, ]*?)(?: : [^\n]*)?\n((?:(?:[ ]+[^\n]*)?\n)*)", re.MULTILINE)
_CODE = (property, cached_property, FunctionType)
_ROLE = re.compile(r":\w+:`~?(?:[\w.]*\.)?(\w+)`")


@cache
def _names_in(module: str) -> dict[str, Any]:
    """Return the names of a module, with those that it imports for its types only."""
    names = dict(vars(sys.modules[module]))
    tree = ast.parse(inspect.getsource(sys.modules[module]))
    for block in (node for node in tree.body if isinstance(node, ast.If)):
        for node in (each for each in block.body if isinstance(each, ast.ImportFrom)):
            found = vars(import_module(node.module or ""))
            names |= {alias.name: found[alias.name] for alias in node.names if alias.name in found}
    return names


def _hints(of: Any) -> dict[str, Any]:
    return get_type_hints(of, localns=_names_in(of.__module__))


@cache
def _words_of(kind: type) -> dict[str, str]:
    """Return the words on each attribute of a record, as plain text."""
    words: dict[str, str] = {}
    for base in reversed(kind.__mro__):
        for section in _SECTION.findall(inspect.cleandoc(base.__doc__ or "") + "\n"):
            for names, body in _ENTRY.findall(section):
                words |= dict.fromkeys(names.split(", "), body.strip())
        written = {name: value for name, value in vars(base).items() if isinstance(value, _CODE)}
        words |= {name: value.__doc__ for name, value in written.items() if value.__doc__}
    if is_dataclass(kind):
        words |= {
            each.name: each.metadata["about"] for each in fields(kind) if "about" in each.metadata
        }
    return {name: _plain_text(text) for name, text in words.items()}


def _plain_text(body: str) -> str:
    """Return an entry of numpydoc as words behind a name: no markup, no capital, no full stop."""
    text = " ".join(body.partition("\n\n")[0].split())
    text = _ROLE.sub(r"`\1`", text).replace("``", "`").removesuffix(".").removeprefix("Return ")
    text = re.sub(r"\b(?:None|NaN)\b", "null", text)  # as it is printed
    return text[:1].lower() + text[1:] if text[1:2].islower() or text[1:2] == " " else text


class _Attribute(NamedTuple):
    hint: Any
    words: str


def _attribute(kind: type, name: str) -> _Attribute:
    own = inspect.getattr_static(kind, name, None)
    getter = getattr(own, "fget", None) or (own.func if isinstance(own, cached_property) else own)
    words = _words_of(kind).get(name, "")
    if inspect.isfunction(getter):
        return _Attribute(_hints(getter)["return"], words)
    return _Attribute(_hints(kind).get(name, Any), words)


def _plain_schema(hint: Any) -> Schema:
    """Return the schema of text, a whole number, a truth value, or one of some words."""
    if get_origin(hint) is Literal:
        return {"enum": list(get_args(hint))}
    if isinstance(hint, type) and issubclass(hint, StrEnum):
        return {"enum": [str(each) for each in hint]}
    return {"type": _PLAIN[hint]} if hint in _PLAIN else {}


class Reader(NamedTuple):
    """Reads types as schemas.

    Attributes
    ----------
    infinite : bool
        Whether infinite numbers are text.
    """

    infinite: bool = False

    def schema(self, hint: Any, words: str = "", about: str = "") -> Schema:
        """Return the schema of a type; `about` says whether a number may be null."""
        inner, origin = get_args(hint), get_origin(hint)
        if hint is float:
            types = ["number"] + ["string"] * self.infinite
            types += ["null"] * bool(re.search(r"\bnull\b|\binfini", about))
            return {"type": types if len(types) > 1 else types[0]}
        if plain := _plain_schema(hint):
            return plain
        if isinstance(hint, type) and properties_of(hint, words):
            return self.record(hint, words)
        if origin in (Union, UnionType):
            return self._one_of(inner, words, about)
        return self._generic(hint, words, about)

    def _generic(self, hint: Any, words: str, about: str) -> Schema:
        """Return the schema of a mapping, a list, or an array of NumPy."""
        inner, origin = get_args(hint), get_origin(hint)
        plain = origin if isinstance(origin, type) else object
        if issubclass(plain, Mapping):
            return {"type": "object", "additionalProperties": self.schema(inner[1], words, about)}
        if issubclass(plain, tuple) and inner[1:] != (Ellipsis,):
            return {"type": "array"} | self._pair(inner)
        if issubclass(plain, Iterable) and plain is not np.ndarray:
            return {"type": "array", "items": self.schema(inner[0], words, about)}
        return {"type": "array"} if origin is not None or hasattr(hint, "_fields") else {}

    def _pair(self, inner: tuple[Any, ...]) -> Schema:
        if any(each is not inner[0] for each in inner):
            return {}
        return {"items": self.schema(inner[0]), "minItems": len(inner), "maxItems": len(inner)}

    def _one_of(self, kinds: tuple[Any, ...], words: str, about: str) -> Schema:
        """Return the schema of a union; of several records, only that it is one."""
        kinds_of = [kind for kind in kinds if kind is not NoneType]
        single = len(kinds_of) == 1
        schemas = [
            self.schema(kind, words, about)
            if single or not is_dataclass(kind)
            else {"type": "object"}
            for kind in kinds_of
        ]
        if any("type" not in each for each in schemas):
            return {"enum": [*schemas[0]["enum"], None]} if "enum" in schemas[0] else {}
        nested = [
            [each["type"]] if isinstance(each["type"], str) else each["type"] for each in schemas
        ]
        types = [*dict.fromkeys(word for each in nested for word in each)]
        types += ["null"] * (NoneType in kinds and "null" not in types)
        one = schemas[0] if len(schemas) == 1 else {}
        return one | {"type": types if len(types) > 1 else types[0]}

    def record(self, kind: type, words: str = "") -> Schema:
        """Return the schema of a record."""
        listed = properties_of(kind, words)
        head, needed = (
            _words_of(kind).get("__doc__", ""),
            [x.name for x in listed if not x.optional],
        )
        properties = {each.name: self._property(kind, each) for each in listed}
        return _object(properties, needed) | {"description": head}

    def _property(self, kind: type, each: JsonProperty) -> Schema:
        """Return the schema of a property: the type at the end of its path."""
        at: Any = kind
        words, missing = "", False
        for name in each.path:
            if name == "__len__":
                at, words = int, f"how many {each.name.replace('_', ' ')}"
                break
            at, words = _attribute(at, name)
            inner = [kind for kind in get_args(at) if kind is not NoneType]
            if name != each.path[-1] and NoneType in get_args(at):
                at, missing = inner[0], not each.optional
            elif each.optional and NoneType in get_args(at):
                at = Union[tuple(inner)]  # noqa: UP007 - of as many as there are
        hint = at | None if missing else at
        return self.schema(hint, each.words, words) | {"description": words}


def _object(properties: Schema, needed: Sequence[str]) -> Schema:
    return {
        "type": "object",
        "properties": properties,
        "required": [*needed],
        "additionalProperties": False,
    }


# --- What commands print ---


class Output(NamedTuple):
    """What a command prints with ``--json``.

    Attributes
    ----------
    name : str
        Of the file, without .json.
    command, about : str
        For the page.
    kind : type or None
        A record, or a list or a mapping of some; None where only `more` is printed.
    words : str
        Properties of the record, instead of its own.
    more : dict of str to (type, str)
        Properties beside those of the record, in front; with ``?`` not always.
    infinite : bool
        Whether infinite numbers are text.
    """

    name: str
    command: str
    about: str
    kind: Any = None
    more: Mapping[str, tuple[Any, str]] = {}
    words: str = ""
    infinite: bool = False

    @property
    def schema(self) -> Schema:
        """The schema, without its head."""
        reader = Reader(self.infinite)
        inner = {} if self.kind is None else reader.schema(self.kind, self.words)
        record = inner.get("items", inner)
        if self.more:
            more = {
                name.rstrip("?"): (
                    hint.schema if isinstance(hint, Output) else reader.schema(hint, "", about)
                )
                | {"description": about}
                for name, (hint, about) in self.more.items()
            }
            needed = [name for name in self.more if not name.endswith("?")]
            needed += record.get("required", ())
            joined = _object(more | record.get("properties", {}), needed)
            inner = {"type": "array", "items": joined} if "items" in inner else joined
        return inner | {"description": self.about}


_KIND = {"kind": (str, "of the model")}
_FILE = {"file": (str, "what was written")}
_FILES = {"file?": (str, "where several files were given: whose")}
_TABLES = {"tables": (Output("", "", "", list[CompileReport], _FILE), "that were made for it")}
_TUBE = {
    "property": (str, "of which loop, from where, for how long"),
    "complete": (bool, "whether all starts were followed to the end"),
    "open": (list[str], "starts that were not"),
    "tube": (Tube | None, "the bounds of each port in each period"),
    "seconds": (float, "how long it took"),
}
_SLOPES = {
    "low": (float, "the lowest along any input; null where it has none"),
    "high": (float, "the highest; null where it has none"),
    "inputs": (Mapping[str, Bounds], "by input"),
}
_SECTORS = {
    "sectors": (list[Sector], "along each input, or along the sum of --along"),
    "open": (list[str], "why another could not be had"),
}
_GRADES = {
    "lines": (tuple[HiddenLine, ...], "the demands"),
    "submissions": (list[Grade], "in the order of their names"),
}
_CITED = {
    "fuzzyarm": (Mapping[str, str], "fields of the entry of the program"),
    "sources": (list[Cited], "in the order in which methods are met"),
}
_TABLE_MODEL = {
    **_KIND,
    "format": (str, "of its file"),
    "version": (int, "of the format"),
}
_GAINS = {
    "controller": (str, "its name"),
    "gains": (Mapping[str, Gain], "by name"),
}
_DIAGRAM = _KIND | {"diagram": (Diagram, "its block diagram")}
_BOARD = {"folder": (str, "what was written")}
_TUNED = {"files": (list[str], "what was written")}
_COST = {
    "operations?": (Operations, "of a control period, by kind; with --operations"),
    "exported_operations?": (int | None, "of the exported C; null where there is none"),
    "seconds?": (float, "of a control period; with --time"),
}

OUTPUTS = (
    Output("grade", "grade DIR", "the passed demands of each submission", None, _GRADES),
    Output("cite", "cite FILE", "publications of the methods of a file", None, _CITED),
    Output("check", "check FILE…", "findings of all files", list[Diagnostic]),
    Output("eval", "eval FILE NAME=VALUE…",
           "every output by its name; of interval type 2 with both ends; null where there is none",
           Mapping[str, float | list[float] | None]),
    Output("eval-explain", "eval FILE NAME=VALUE… --explain", "one inference, step by step",
           Trace),
    Output("show", "show FILE.frb", "a rule base; several files give a list", RuleBase, _KIND,
           infinite=True),
    Output("show-table", "show FILE.lut", "a table; several files give a list", TableHeader,
           _TABLE_MODEL | {"values": (list[Any], "lists in lists, one level for each input")}),
    Output("show-controller", "show CONTROLLER", "a controller; several files give a list",
           ControllerModel, _DIAGRAM, infinite=True),
    Output("prove", "prove FILE…", "verdicts on the lines of the files", list[Verdict], _FILES),
    Output("prove-range", "prove FILE --range", "bounds of an output", Bounds),
    Output("prove-slope", "prove FILE --slope", "bounds of its slopes", None, _SLOPES),
    Output("prove-table", "prove FILE --table WHAT", "the error of a table", Bounds,
           words=TABLE_ERROR),
    Output("prove-sector", "prove FILE --sector", "multiples of the inputs", None, _SECTORS),
    Output("prove-drives", "prove CONTROLLER --sector", "statements about its drives",
           list[DriveProof]),
    Output("margins", "margins FILE --plant P", "how far a loop is from instability",
           list[DriveMargins]),
    Output("prove-loop", "prove FILE --plant P --stable", "a claim about a loop", LoopVerdict,
           _FILES),
    Output("prove-tube", "prove FILE --plant P --for TIME", "a tube", None, _TUBE),
    Output("prove-map", "prove FILE --plant P --map", "a map of starts", StartMap),
    Output("compile", "compile FILE -o OUT.lut", "a table that was made", CompileReport, _FILE),
    Output("compile-source", "compile FILE -o OUT.c", "source text of rules and tables", Exported,
           _TABLES),
    Output("compile-controller", "compile CONTROLLER -o OUT.c", "source text of a controller",
           ExportedController, _TABLES),
    Output("compile-report", "compile FILE -o OUT.c --report DIR", "the same as DIR/report.json",
           ExportReport),
    Output("convert", "convert IN OUT", "the findings and the written file", Conversion),
    Output("compile-board", "compile FILE --for arduino -o DIR", "a folder for a board",
           BoardFolder, _BOARD),
    Output("convert-script", "convert SCRIPT.py", "the systems that a script makes",
           ScriptConversion),
    Output("diff-tables", "diff A.lut B.lut", "the differences of two tables", TableDiff),
    Output("diff-rules", "diff A.frb B.frb", "the differences of two rule bases", RuleBaseDiff),
    Output("diff-controllers", "diff A.frb B.frb (controllers)",
           "the differences of two controllers", ControllerDiff),
    Output("simulate", "simulate CONTROLLER", "a run; several controllers give a list of them",
           Run),
    Output("simulate-list", "simulate --list", "the controllers of the catalogue",
           Mapping[str, str]),
    Output("simulate-gains", "simulate CONTROLLER --show-gains", "the gains of a controller", None,
           _GAINS),
    Output("sweep", "sweep CONTROLLER --sweep NAME=A..B:N", "many runs", SweepReport),
    Output("sweep-controllers", "sweep CONTROLLER OTHER… --sweep NAME=A..B:N",
           "the same many runs of several controllers", SweepComparison),
    Output("compare", "compare CONTROLLER…", "controllers on the arm", list[Compared], _COST),
    Output("compare-runs", "compare CONTROLLER… --reference …",
           "runs of controllers along the same references", list[Run]),
    Output("tune", "tune FILE -o OUT.frb", "the result of tuning", Tuned, _TUNED),
    Output("learn", "learn CONTROLLER", "tables that a controller learned", Learned),
    Output("fit", "fit SAMPLES -o OUT.frb", "a rule base learned from samples", FitReport),
    Output("validate", "validate FILE SAMPLES", "a rule base judged by samples", Validation),
    Output("validate-log", "validate FILE LOG --columns …", "a recorded run, replayed", Replay),
    Output("reproduce", "reproduce ROW…", "published rows, run again", list[Reproduced]),
    Output("reproduce-list", "reproduce --list", "the published rows", list[PublishedRow]),
    Output("identify", "identify", "gains fitted to published errors", list[Identified]),
    Output("shipped", "shipped", "the files that come with fuzzyarm", list[ShippedFile]),
)  # fmt: skip


def schema_of(output: Output) -> Schema:
    """Return the whole schema of what a command prints."""
    head = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": f"fuzzyarm {output.command} --json",
    }
    return head | output.schema


def schema_text(output: Output) -> str:
    """Return a schema as it stands in its file."""
    return json.dumps(schema_of(output), indent=1, ensure_ascii=False) + "\n"


PAGE_HEAD = """# JSON

What commands print with `--json`, property by property; the links are JSON Schemas (draft 2020-12).
Results go to the standard output, and nothing else does: messages and progress go to the standard
error, so that a pipe reads JSON or nothing. What is not a finite number is `null`. The exit status
is that of the command without `--json`.

A property may be added in a minor version; none changes its meaning or goes without a major one.
"""


def page() -> str:
    """Return docs/reference/json.md."""
    parts = [PAGE_HEAD]
    for output in OUTPUTS:
        parts.append(f"## {output.command}\n")
        parts.append(
            f"{output.about[0].upper()}{output.about[1:]}"
            f" ([schema](../schemas/{output.name}.json)).\n"
        )
        lines = list(_table(output.schema, ""))
        if lines:
            parts.append("\n".join(["| property | |", "|---|---|", *lines]) + "\n")
    links = (f"[`{kind.__name__}`](../schemas/{request_name(kind)}.json)" for kind in requests())
    parts.append(PAGE_END.format(", ".join(links)))
    return "\n".join(parts)


PAGE_END = """## What is asked for

What a command takes is a record of `fuzzyarm.requests`, from which its options are made; calls from
Python take one, too: `fuzzyarm.tune(TuneRequest(file="servo.frb", evals=100))`. As JSON Schemas:
{}.
"""


DEEPEST = 2
"""Records in records that the page goes into."""


def _table(schema: Schema, path: str) -> list[str]:
    """Return a line for each property of a record, those inside others behind their path."""
    if schema.get("type") == "array" and "items" in schema:
        return _table(schema["items"], f"{path}[]" if path else "")
    if "additionalProperties" in schema and isinstance(schema["additionalProperties"], dict):
        return _table(schema["additionalProperties"], f"{path}.NAME" if path else "NAME")
    lines = []
    for name, inner in schema.get("properties", {}).items():
        inside = f"{path}.{name}" if path else name
        lines.append(f"| `{inside}` | {inner.get('description', '')} |")
        lines += _table(inner, inside) if inside.count(".") < DEEPEST else []
    return lines


# --- What is asked for ---


def requests() -> list[type[Request]]:
    """Return the records of all jobs."""
    kinds = (getattr(fuzzyarm.requests, name) for name in fuzzyarm.requests.__all__)
    jobs = (kind for kind in kinds if kind is not Request and issubclass(kind, Request))
    return sorted(jobs, key=lambda kind: kind.__name__)


def request_name(kind: type[Request]) -> str:
    """Return the name of the file with the schema of a request: ``request-tune``."""
    return f"request-{kind.__name__.removesuffix('Request').lower()}"


def request_text(kind: type[Request]) -> str:
    """Return the schema of a request as it stands in its file."""
    return json.dumps(schema_of_request(kind), indent=1, ensure_ascii=False) + "\n"


def main() -> None:
    """Write the schemas and the page."""
    folder = DOCS / "schemas"
    folder.mkdir(exist_ok=True)
    for output in OUTPUTS:
        write_atomically(folder / f"{output.name}.json", schema_text(output))
    for kind in requests():
        write_atomically(folder / f"{request_name(kind)}.json", request_text(kind))
    write_atomically(DOCS / "reference" / "json.md", page())


if __name__ == "__main__":
    main()
