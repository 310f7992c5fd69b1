"""Make docs/schemas/*.json and docs/reference/json.md: `python tools/make_schemas.py`.

What ``--json`` prints is said once, property by property; the JSON Schemas (draft 2020-12) and the
page are two readings of it. Of a record of results that is printed as it is (`record_of`), types
are those of its fields, and words those of its docstring; what a command puts together stands here.
`tests/cli/test_json_schemas.py` holds what commands print to them, and them to what commands print:
a property that is never printed is found.
"""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Mapping
from dataclasses import is_dataclass
from itertools import chain
from pathlib import Path
from types import MappingProxyType, NoneType
from typing import Any, ClassVar, NamedTuple, get_args, get_origin, get_type_hints

import fuzzyarm.requests
from fuzzyarm.apps.show.diagram import Diagram, DiagramBlock, DiagramWire
from fuzzyarm.apps.show.diff import Change
from fuzzyarm.apps.study.identify import Identified
from fuzzyarm.base.files import write_atomically
from fuzzyarm.inference.trace import ConsequentTrace, FuzzyValue, OutputTrace, RuleTrace, Trace
from fuzzyarm.language.model.controller import Axes, ControllerModel, GainModel
from fuzzyarm.language.model.rulebase import Input, Rule, RuleBase, RuleBlock, Shape, Term
from fuzzyarm.language.model.rulebase import Output as OutputVariable
from fuzzyarm.learning.validation import Bin, Region, RuleUse, Validation
from fuzzyarm.proof.loop.margins import Margins
from fuzzyarm.proof.map.controllers import DriveGain, DriveProof, DriveSector
from fuzzyarm.requests import Request
from fuzzyarm.requests.schema import schema_of as schema_of_request

DOCS = Path(__file__).parents[1] / "docs"
Schema = dict[str, Any]

# --- Words for schemas ---


def text(about: str, *words: str) -> Schema:
    """Return the schema of a text, maybe one of some words."""
    return {"type": "string", "description": about} | ({"enum": list(words)} if words else {})


def number(about: str, *, null: str = "") -> Schema:
    """Return the schema of a number; `null` says when it is none."""
    return {"type": "number", "description": about} | _or_null("number", about, null)


def whole(about: str, *, null: str = "") -> Schema:
    """Return the schema of a whole number."""
    return {"type": "integer", "description": about} | _or_null("integer", about, null)


def _or_null(kind: str, about: str, null: str) -> Schema:
    return {"type": [kind, "null"], "description": f"{about}; null {null}"} if null else {}


def truth(about: str) -> Schema:
    """Return the schema of true or false."""
    return {"type": "boolean", "description": about}


def rows(item: Schema, about: str, *, length: int | None = None) -> Schema:
    """Return the schema of a list."""
    fixed = {} if length is None else {"minItems": length, "maxItems": length}
    return {"type": "array", "items": item, "description": about} | fixed


def numbers(about: str, *, null: str = "") -> Schema:
    """Return the schema of a list of numbers."""
    return rows({"type": ["number", "null"] if null else "number"}, about)


def names(about: str) -> Schema:
    """Return the schema of a list of texts."""
    return rows({"type": "string"}, about)


def by_name(item: Schema, about: str) -> Schema:
    """Return the schema of an object whose keys are somebody's names."""
    return {"type": "object", "additionalProperties": item, "description": about}


def record(about: str, optional: str = "", **properties: Schema) -> Schema:
    """Return the schema of an object; `optional` names what may be missing."""
    maybe = set(optional.split())
    assert maybe <= set(properties), maybe
    return {
        "type": "object",
        "description": about,
        "properties": {name.rstrip("_"): schema for name, schema in properties.items()},
        "required": [name.rstrip("_") for name in properties if name not in maybe],
        "additionalProperties": False,
    }


POINT = by_name({"type": "number"}, "values by the names of the inputs")

# --- Records of results, by their fields and docstrings ---

_PLAIN = {str: "string", int: "integer", float: "number", bool: "boolean"}
_SECTION = re.compile(
    r"^(?:Attributes|Parameters)\n-+\n(.*?)(?=^\w+\n-+\n|\Z)", re.DOTALL | re.MULTILINE
)
_ENTRY = re.compile(r"^(\w[\w, ]*?)(?: : [^\n]*)?\n((?:(?:[ ]+[^\n]*)?\n)*)", re.MULTILINE)
_ROLE = re.compile(r":\w+:`~?(?:[\w.]*\.)?(\w+)`")


def record_of(
    kind: type,
    about: str,
    parts: Mapping[type, Schema] = MappingProxyType({}),
    /,
    *,
    left_out: str = "",
    optional: str = "",
    types: Mapping[str, list[str]] = MappingProxyType({}),
    **more: Schema,
) -> Schema:
    """Return the schema of a data class or a named tuple that is printed with its fields.

    Parameters
    ----------
    kind : type
        With an entry of its numpydoc for each field.
    about : str
        What it is.
    parts : mapping of type to dict
        The schemas of records in its fields; any other record is an object without more words.
    left_out, optional : str
        Fields that are not printed, or not always.
    types : mapping of str to list of str
        What a number may be besides, by field; ``*`` stands for all numbers.
    **more
        Properties that are printed with them; one with the name of a field says more of that.
    """
    words, gone = _words_of(kind), {"span", *left_out.split()}
    properties: dict[str, Schema] = {}
    for name, hint in get_type_hints(kind).items():
        if get_origin(hint) is not ClassVar and name not in gone:
            reader = _Types(parts, types.get(name) or types.get("*") or ["number"])
            own = more.pop(name, {})
            properties[name] = reader.schema(hint) | {"description": words[name]} | own
    return record(about, optional, **more, **properties)


class _Types(NamedTuple):
    """What is known of types: the schemas of some records, and what a number may be."""

    parts: Mapping[type, Schema]
    number: list[str]

    def schema(self, hint: Any) -> Schema:
        """Return the schema of a type, without words."""
        inner, origin = get_args(hint), get_origin(hint)
        if hint is float:
            return {"type": self.number if len(self.number) > 1 else self.number[0]}
        if hint in _PLAIN:
            return {"type": _PLAIN[hint]}
        if origin is tuple:
            return self._list(*inner)
        if origin is Mapping:
            return {"type": "object", "additionalProperties": self.schema(inner[1])}
        if inner:
            return self._one_of(inner)
        return self.parts.get(hint, {"type": "object" if is_dataclass(hint) else "array"})

    def _list(self, first: Any, *others: Any) -> Schema:
        items = {"type": "array", "items": self.schema(first)}
        if others == (Ellipsis,):
            return items
        if any(other is not first for other in others):
            return {"type": "array"}
        return items | {"minItems": 1 + len(others), "maxItems": 1 + len(others)}

    def _one_of(self, kinds: tuple[Any, ...]) -> Schema:
        """Return the schema of a union; of several records, only that it is one."""
        schemas = [self.schema(kind) for kind in kinds if kind is not NoneType]
        words = [[word] if isinstance(word := each["type"], str) else word for each in schemas]
        types = list(dict.fromkeys(chain(*words, ["null"] if NoneType in kinds else [])))
        one = schemas[0] if len(schemas) == 1 else {}
        return one | {"type": types if len(types) > 1 else types[0]}


def _words_of(kind: type) -> dict[str, str]:
    """Return what the docstrings of a record and of its bases say of each field, as plain text."""
    words: dict[str, str] = {}
    for base in reversed(kind.__mro__):
        for section in _SECTION.findall(inspect.cleandoc(base.__doc__ or "") + "\n"):
            for names_, body in _ENTRY.findall(section):
                words |= dict.fromkeys(names_.split(", "), _plain_text(body))
    return words


def _plain_text(body: str) -> str:
    """Return an entry of numpydoc as words behind a name: no markup, no capital, no full stop."""
    text_ = _ROLE.sub(r"`\1`", " ".join(body.split())).replace("``", "`").removesuffix(".")
    text_ = re.sub(r"\b(?:None|NaN)\b", "null", text_)  # as it is printed
    return text_[:1].lower() + text_[1:] if text_[1:2].islower() or text_[1:2] == " " else text_


# --- Findings ---

_FINDING = {
    "name": text("what sort of finding it is; docs/reference/checks.md has a line for each"),
    "severity": text("how bad it is", "error", "warning", "info"),
    "message": text("what is wrong, in a sentence"),
    "hint": text("what to do, or empty"),
    "line": whole("from 1; 0 where the finding is about the whole file"),
    "column": whole("from 1"),
}
FINDING = record(
    "a finding",
    **_FINDING,
    path=text("the file"),
    end_line=whole("where what is meant ends"),
    end_column=whole("the column behind its last character"),
    related=rows(
        record(
            "another place",
            message=text("what is there"), line=whole("from 1"), column=whole("from 1"),
        ),
        "other places that it is about",
    ),
)  # fmt: skip
SHORT_FINDING = record("a finding", **_FINDING)

# --- Proofs ---

_BOUND = {
    "pieces": whole("into how many pieces the inputs were cut"),
    "way": text("widened: in floats, rounded outward", "exact", "widened", "boxes"),
}
BOUNDS = record(
    "proved bounds",
    low=number("the lower bound", null="where it has none"),
    high=number("the upper bound", null="where it has none"),
    at_low=by_name({"type": "number"}, "a point near the lowest value"),
    at_high=by_name({"type": "number"}, "a point near the highest value"),
    hole=text("where the output has no value, or why that is open; empty where it always has one"),
    **_BOUND,
)
WORST = record(
    "the proved error of a table",
    worst=number("no error is larger"),
    reached=number("an error that is reached"),
    at=POINT, **_BOUND,
)  # fmt: skip
VERDICT = record(
    "the verdict on a `prove` line",
    "file",
    file=text("where several files were given: whose"),
    property=text("the line, without `prove`"),
    verdict=text("what came out", "proved", "refuted", "undecided"),
    bound={"description": "what was proved all the same: one number, two, or null"},
    evidence=names("lines that can be pasted: `expect` of where it fails"),
    pieces=_BOUND["pieces"],
    seconds=number("how long it took"),
    way=_BOUND["way"],
    reason=text("why it is undecided, or empty"),
    line=whole("of the file"),
)

TUBE = record(
    "a tube: between what each port is in each period",
    duration=number("how far it goes, s"),
    boxes=whole("into how many boxes the starts were cut"),
    arrival=number("after which all runs are in the proved region, s; 0 where there is none"),
    ends=numbers("of the periods, s"),
    ports=by_name(
        record("of a port", low=numbers("in each period"), high=numbers("in each period")),
        "by port",
    ),
) | {"type": ["object", "null"]}
_SPAN = {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}
LOOP_VERDICT = record(
    "the verdict on a claim about a loop",
    "file",
    file=text("where several files were given: whose"),
    property=text("the claim, without `prove`"),
    verdict=text("what came out", "proved", "refuted", "undecided"),
    region=by_name(_SPAN, "the proved region, by state and memory"),
    start_region=by_name({"type": "number"}, "how far a run may start along a state alone"),
    rest=by_name({"type": "number"}, "where the loop rests"),
    fall=number("the share by which V falls in each period at least"),
    continuous=truth("whether it is of the loop in continuous time"),
    uncertain=names("what was taken as an unknown gain"),
    certificate={"type": ["string", "null"], "description": "the hash of the certificate"},
    tube=TUBE,
    evidence=names("a start and what its run did, or the box that is in the way"),
    pieces=whole("attempts of the search"),
    seconds=number("how long it took"),
    reason=text("why it is undecided, or empty"),
    line=whole("of the file; 0 for a claim of the command"),
)
START_MAP = record(
    "which starts of a loop are proved",
    property=text("of which loop"),
    window=by_name(_SPAN, "the starts, by state"),
    others=by_name({"type": "number"}, "where the other states begin"),
    proved=number("the share of the window from which every run comes to rest"),
    refuted=number("the share from which runs are lost"),
    open=number("the share of which nothing is known"),
    starts=whole("drawn starts, whose runs were simulated"),
    settled=whole("of these, those whose runs came to rest"),
    settled_proved=whole("of those, the ones that begin in proved boxes"),
    within=number("after which all proved runs are in the region around rest, s"),
    region=by_name(_SPAN, "that region, by state and memory"),
    rest=by_name({"type": "number"}, "where the loop rests"),
    boxes=rows(
        record(
            "a part of the window",
            low=numbers("its lower ends, in the order of the window"),
            high=numbers("its upper ends"),
            verdict=text("what is known of it", "proved", "refuted", "open"),
            periods=whole("control periods until all of its runs are in the region, or lost"),
            reason=text("why it is refuted or open"),
        ),
        "they fill the window",
    ),
    seconds=number("how long it took"),
    reason=text("why nothing is proved, or empty"),
)
LOOP_BOUNDS = record(
    "where all runs of a loop are",
    property=text("of which loop, from where, for how long"),
    complete=truth("whether all starts were followed to the end"),
    open=names("starts that were not"),
    tube=TUBE,
    seconds=number("how long it took"),
)

# --- Tables and source text ---

_TABLE = {
    "file": text("what was written"),
    "output": text("whose table it is"),
    "index": names("its inputs, in the order of its indices"),
    "shape": rows({"type": "integer"}, "how many levels each input has"),
    "cells": whole("how many values"),
}
_MODE = text("how values between levels are looked up", "bins", "nearest", "linear")
TABLE_REPORT = record(
    "a table",
    **_TABLE,
    default_levels=truth("whether nobody chose its levels"),
    tolerance=number("what was asked for", null="where nothing was"),
    mode=_MODE,
    errors=rows(
        record(
            "the error against the rules",
            mode=_MODE,
            worst=number("the largest error: proved, or of the samples"),
            proved=truth("whether `worst` is a proved bound"),
            sampled=number("the largest error at the samples"),
            rms=number("the root mean square at the samples"),
            at=POINT,
            points=rows({"type": "integer"}, "samples along each input"),
        ),
        "one for each way of look-up",
    ),
)
FUNCTION = record(
    "a function of the source text",
    call=text("its declaration"),
    output=text("what it returns"),
    arguments=names("what it takes"),
    type=text("its type"),
    worst=number("the largest difference from `against` at the points that were tried"),
    points=whole("how many points were tried"),
    against=text("with what it was compared"),
    proved=number("the proved error against the rules", null="where there is none"),
    operations=by_name(
        {"type": ["integer", "null"]},
        "how many operations a call takes at most, by kind; null where they are not bounded",
    ),
    stack=whole("bytes of local variables"),
)
SOURCE_REPORT = record(
    "rules or a table as source text",
    files=names("what was written"),
    functions=rows(FUNCTION, "in the order of the outputs"),
    tables=rows(TABLE_REPORT, "that were made for it"),
)
CONTROLLER_REPORT = record(
    "a controller as source text",
    files=names("what was written"),
    controller=text("its name"),
    period=number("s"),
    references=names("set points that it reads"),
    measured=names("measured values that it reads"),
    drives=names("what it drives"),
    gains=names("gains that can be set"),
    calls=names("its functions"),
    precision=text("of its numbers"),
    worst=number("the largest difference from the model in a run"),
    largest=number("the largest drive in that run"),
    periods=whole("how long that run was"),
    tables=rows(TABLE_REPORT, "that were made for it"),
)

# --- Runs ---

_METRIC = by_name(
    {"type": ["number", "null"]},
    "metrics by name (docs/reference/metrics.md); null where one has no value",
)
RUN = record(
    "a run of a closed loop; errors in the order of `outputs`, in their units",
    controller=text("its name"),
    trajectory=text("what was followed"),
    rms=numbers("root mean square of the error", null="of an output without set point"),
    max=numbers("largest error", null="as above"),
    final=numbers("error at the end", null="as above"),
    rms_periods=numbers("rms over all control periods", null="as above"),
    rms_path=numbers("rms against the path itself", null="as above"),
    samples=whole("control periods that count"),
    conventions=text("how the study is read", "plain", "study"),
    precision=text("of the numbers", "float32", "float64"),
    pi=number("the π that was used"),
    load_in_hold=truth("of the arm: whether a load stays in the hand during the hold"),
    skipped=by_name(
        {"type": "integer"},
        "control periods skipped for a value that was not a number, by axis of the controller; "
        "empty if none was",
    ),
    periods=whole("control periods of the run"),
    lost=by_name(
        {"type": "integer"},
        "samples whose error was not a number, by output; metrics are those of the others",
    ),
    diverged=number("at what time the run left its bounds, s", null="where it did not"),
    ended=number("at what time the plant ended the run by itself, s", null="where it did not"),
    compiled=truth("whether it ran as machine code"),
    plant=text("its name"),
    outputs=by_name({"type": "string"}, "units by output"),
    metrics=by_name(_METRIC, "by output"),
    seed=whole("of what is random"),
)
EXTREME = {
    "type": "object",
    "description": "a run of a sweep: its number, the value, and what was swept",
    "properties": {
        "run": whole("its number, from 0"),
        "value": number("of the metric", null="if lost"),
    },
    "required": ["run", "value"],
    "additionalProperties": {"type": ["number", "string", "boolean", "null"]},
}
SWEEP = record(
    "many runs",
    "columns rows",
    controller=text("its name"),
    plant=text("its name"),
    trajectory=text("what was followed"),
    runs=whole("how many"),
    diverged=whole("how many of them diverged"),
    sweep=rows(
        record(
            "a range",
            name=text("what is swept"), low=number("from"), high=number("to"),
            count=whole("how many values"), log=truth("whether evenly spaced as logarithms"),
        ),
        "in the order of the runs, the last one fastest",
    ),
    outputs=by_name({"type": "string"}, "units by output"),
    metric=text("whose extremes are shown"),
    extremes=by_name(record("the extremes", least=EXTREME, most=EXTREME), "by output"),
    file=text("what was written") | {"type": ["string", "null"]},
    columns=names("of `rows`; without -o"),
    rows=rows(rows({}, "a run"), "all runs; without -o"),
)  # fmt: skip
COMPARED = record(
    "a controller of the arm over both moves, each with its two links: four errors, degrees",
    "operations exported_operations seconds",
    controller=text("its name"),
    rms=numbers("root mean square at the set points", null="where it diverged"),
    rms_periods=numbers("over all control periods", null="as above"),
    rms_path=numbers("against the path", null="as above"),
    variation=numbers("of the torque, a measure of chatter", null="as above"),
    diverged=numbers("when, of each move, s", null="where it did not"),
    operations=by_name({"type": "number"}, "of a control period, by kind, with --operations"),
    exported_operations={
        "description": "of the exported C, with --operations; null where there is none"
    },
    seconds=number("of a control period, with --time"),
)

# --- Learning from samples ---

FIT = record(
    "a rule base learned from samples",
    "fidelity test",
    file=text("what was written"),
    samples=whole("how many"),
    inputs=names("columns that it reads"),
    target=text("the column that it tells"),
    classes=names("of the target, where it is not a number"),
    rules=whole("how many"),
    structure=text("terms of each input, in words"),
    shrinkage=number("λ of the ridge that the consequents were fitted with"),
    digits=whole("significant digits of the numbers in the file"),
    training=record(
        "on the samples that it was fitted to",
        error=number("root mean square, of the text as written"),
        error_of_numbers=number("the same before the numbers were rounded"),
        linear=number("of a linear model"),
    ),
    cross_validation={"description": "errors on samples that were held back; null without"},
    support=numbers("of each rule: the sum of its firing strengths over the samples"),
    interrupted=truth("whether Ctrl-C ended it"),
    fidelity={"description": "where the samples are a model: how far the rules are from it"},
    test={"description": "errors on the file of --test"},
)
_OR_NULL = {"*": ["number", "null"]}
VALIDATED = record_of(
    Validation,
    "a judgement by samples",
    {
        Bin: record_of(Bin, "samples with predictions next to each other", types=_OR_NULL),
        Region: record_of(Region, "a region", types=_OR_NULL),
        RuleUse: record_of(RuleUse, "a rule", types=_OR_NULL),
    },
    left_out="predicted observed",
    types=_OR_NULL,
    never_fired=rows({"type": "integer"}, "numbers of rules that no sample fires"),
)


REPRODUCED = record(
    "a published row, run again",
    "runs median band_low band_high lowest highest published_inside",
    row=text("its name"),
    table=text("of the study"),
    controller=text("which was run"),
    condition=text("of the load"),
    variant=text("as-printed, or which gap is filled"),
    trajectories=names("that were followed"),
    published=numbers("the printed figures"),
    reproduced=numbers("ours", null="where a run diverged"),
    difference=numbers("relative", null="where zero was printed"),
    within={"type": ["boolean", "null"], "description": "whether within its bound"},
    verdict=text("in a sentence"),
    note=text("what else there is to say"),
    diverged=numbers("when, of each trajectory, s", null="where it did not"),
    runs=whole("of a chaotic row: how many"),
    median=numbers("of the runs"),
    band_low=numbers("below which 5 % of them are"),
    band_high=numbers("above which 5 % of them are"),
    lowest=numbers("of the runs"),
    highest=numbers("of the runs"),
    published_inside=rows({"type": "boolean"}, "whether the printed figures lie in the band"),
)

_SCORE = record(
    "a score",
    cost=number("of the scenarios together", null="where one cannot be had"),
    rms=number("root mean square error, mean of the scenarios", null="where one diverged"),
    chatter=number("of the drive", null="without a plant"),
    diverged=whole("in how many scenarios the loop diverged"),
    each=numbers("the cost of each scenario", null="where it diverged"),
)
TUNED = record(
    "a tuning",
    cost=text("the formula that became small"),
    over=text("how the costs of scenarios became one", "mean", "worst"),
    method=text("of the search"),
    seed=whole("of all random draws"),
    trials=whole("of the search: how many"),
    noise=number("standard deviation of the noise of `noisy`, as a share of each range; 0 without"),
    linear_trials=whole("of the linear opponent", null="without one"),
    refused=whole("candidates that broke a line `expect` or `prove`"),
    seconds=number("how long it took"),
    interrupted=truth("whether Ctrl-C ended it"),
    digits=whole("of the numbers that are written"),
    scenarios=names("what was tuned on"),
    unseen=names("what was judged by"),
    rows=by_name(
        by_name(_SCORE, "`train`, `unseen`, `noisy`"),
        "`as in the file`, `tuned`, and a linear opponent, each on three sets of scenarios",
    ),
    claim=text("what can be said of it on what was not seen"),
    comparisons=rows(
        {
            "type": "object",
            "properties": {
                "with": text("the other row"),
                "better_on": whole("unseen scenarios on which it costs less"),
                "of": whole("unseen scenarios; 0 where the cost is one number for all of them"),
                "dearer_by": number("share of the other cost", null="where that is 0"),
            },
            "required": ["with", "better_on", "of", "dearer_by"],
            "additionalProperties": False,
        },
        "with every other row",
    ),
    remarks=names("what else is to be known"),
    faults=names("what failed; the numbers stand"),
    line={
        "type": ["object", "null"],
        "additionalProperties": {"type": "array", "items": {"type": "number"}},
        "description": "numbers of the linear opponent, one for each axis; null without one",
    },
    failed=whole("trials that ended by an error"),
    parameters=rows(
        record(
            "a parameter",
            name=text("what moved"), low=number("of its range"), high=number("of its range"),
            start=number("as in the file"),
        ),
        "what moved",
    ),
    on_a_bound=names("parameters that ended on a bound of their range"),
    changes=rows(
        record(
            "a change", what=text("of what"), old=text("in the file"), new=text("as written"),
        ),
        "in the words of the file",
    ),
    curve=numbers("the best cost after each trial", null="before the first that has one"),
    front=rows(
        record("a trial", rms=number("its error"), chatter=number("its chatter")),
        "trials that no other beats in both",
    ),
    files=names("what was written"),
)  # fmt: skip

# --- Tables that learn ---

_SNAPSHOT = {
    "pass_": whole("from 1"),
    "time": number("since the pass began, s"),
    "rms": numbers("error of each axis, in the plant's unit", null="where it diverged"),
    "complete": truth("whether the pass came to its end"),
    "diverged": number("when, s", null="where it did not"),
    "joints": rows(
        record(
            "a table",
            visited=whole("cells that were used"),
            changed=whole("cells that differ from the start"),
            never_visited=whole("cells that were not used"),
        ),
        "by axis",
    ),
}
_CELLS = {"type": "array", "description": "of each axis: a row for each level of the first input"}
LEARNED = record(
    "a training",
    "snapshots",
    passes=rows(record("a pass", **_SNAPSHOT), "those that came to their end"),
    levels=by_name(rows({"type": "number"}, "in rising order"), "levels of each input"),
    tables=_CELLS | {"description": "values of each axis, a row for each level of the first input"},
    visits=_CELLS | {"description": "how often each cell was used, in the same order"},
    file={"type": ["string", "null"], "description": "what was written; null without -o"},
    snapshots=rows(record("a moment", **_SNAPSHOT), "with --every: what was shown meanwhile"),
)

# --- Sectors ---

_WITHIN = rows({"type": "number"}, "low and high", length=2)
_FACTOR = {
    "weights": by_name({"type": "number"}, "the sum of the inputs that it bounds by"),
    "low": number("the output is at least so many times the sum"),
    "high": number("and at most so many times"),
    "slack": number("by which it may lie beside, in units of the output"),
}
SECTORS = record(
    "sectors of a rule base",
    sectors=rows(
        record(
            "a sector",
            **_FACTOR,
            at_low=by_name({"type": "number"}, "a point near the lowest multiple"),
            at_high=by_name({"type": "number"}, "a point near the highest"),
            pieces=_BOUND["pieces"],
        ),
        "along each input, or along the sum of --along",
    ),
    open=names("why another could not be had"),
)
DRIVE = record_of(
    DriveProof,
    "what is proved of a drive",
    {
        DriveGain: record_of(DriveGain, "a gain"),
        DriveSector: record_of(DriveSector, "a sector"),
    },
    left_out="axis port",
    drive=text("axis and port"),
    reached={"enum": ["never", "yes", "open", ""]},
)

_MARGINS = record_of(Margins, "margins", types={"*": ["number", "null"]})
MARGINS = rows(
    record(
        "a drive at which the loop is opened",
        drive=text("axis and port"),
        nominal=_MARGINS | {"description": "at rest; null for what has no limit"},
        worst=_MARGINS
        | {"type": ["object", "null"], "description": "over all gains; null without bounds"},
        gains=rows(
            record(
                "a gain of the rules",
                of=text("what it is"),
                low=number("its proved lower bound"),
                high=number("its proved upper bound"),
            ),
            "gains that are not one number",
        ),
        where=by_name({"type": "array", "items": {"type": "number"}}, "by margin, its gains"),
    ),
    "in the order of the drives",
)

EVALUATED = by_name(
    {"type": ["number", "null", "array"]},
    "values; of interval type 2 with both ends; null where there is none",
)

# --- Models, as `show` prints them ---

_NOTHING = {"type": ["object", "null"]}
_OR_TEXT = {"*": ["number", "string"]}
"""Infinite numbers are the texts ``inf`` and ``-inf``: null would not say which."""
_SHAPE = record_of(Shape, "a shape", types=_OR_TEXT)
_TERM = record_of(Term, "a term", {Shape: _SHAPE})
_RULE_BLOCK = record_of(
    RuleBlock, "a block of rules", {Rule: record_of(Rule, "a rule", types=_OR_TEXT)}, types=_OR_TEXT
)
RULE_BASE = record_of(
    RuleBase,
    "a rule base; several files give a list of models",
    {
        Input: record_of(Input, "an input", {Term: _TERM}, types=_OR_TEXT),
        OutputVariable: record_of(
            OutputVariable,
            "an output",
            {Term: _TERM},
            types=_OR_TEXT,
            no_rule={"type": ["number", "string", "null"]},
        ),
        RuleBlock: _RULE_BLOCK,
    },
    kind=text("rulebase", "rulebase"),
)
TABLE = record(
    "a table; several files give a list of models",
    kind=text("table", "table"),
    format=text("of its file"),
    version=whole("of the format"),
    output=record(
        "what it gives",
        name=text("its name"),
        low=number("lower end of its range", null="where it has none"),
        high=number("upper end", null="where it has none"),
        bounded=truth("whether values lie in this range"),
        description=text("in the words of the file"),
    ),
    index=names("its inputs, in the order of its indices"),
    axes=rows(
        record(
            "an input",
            name=text("its name"),
            low=number("lower end of its range", null="where it has none"),
            high=number("upper end", null="where it has none"),
            description=text("in the words of the file"),
            levels=numbers("at which it has values"),
            bins={"type": ["array", "null"], "description": "thresholds between its cells"},
        ),
        "in the order of `index`",
    ),
    round={"type": ["number", "null"], "description": "values are multiples of it"},
    mode={"type": ["string", "null"], "description": "how it is looked up, where the file says so"},
    provenance=rows({"type": "array", "items": {"type": "string"}}, "key and words, line by line"),
    values={"type": "array", "description": "lists in lists, one level for each input"},
)
CONTROLLER = record_of(
    ControllerModel,
    "a controller; several files give a list of models",
    {Axes: record_of(Axes, "axes that share lines"), GainModel: record_of(GainModel, "a gain")},
    kind=text("controller", "controller"),
    diagram=record_of(
        Diagram,
        "its block diagram",
        {
            DiagramBlock: record_of(
                DiagramBlock, "a block", line=whole("of the text that it comes from")
            ),
            DiagramWire: record_of(DiagramWire, "a wire"),
        },
    ),
)

# --- One inference, step by step ---

_ENDLESS = {name: ["number", "null"] for name in ("low", "high", "value")}
_LOWER = {"type": "number"}  # there only where it is one
TRACE = record_of(
    Trace,
    "one inference; `lower`, `left` and `right` are there with interval type 2 only",
    {
        FuzzyValue: record_of(FuzzyValue, "an input", optional="lower"),
        RuleTrace: record_of(RuleTrace, "a rule", optional="lower", lower=_LOWER),
        OutputTrace: record_of(
            OutputTrace,
            "an output",
            {
                ConsequentTrace: record_of(
                    ConsequentTrace,
                    "an asserted term",
                    optional="lower lower_value lower_curve",
                    lower=_LOWER,
                    lower_value=_LOWER,
                )
            },
            optional="lower_aggregate left right",
            types=_ENDLESS,
            left=_LOWER,
            right=_LOWER,
        ),
    },
)
_CHANGE = record_of(Change, "a change", kind={"enum": ["renamed", "added", "removed", "changed"]})
_SYSTEM = record(
    "a system of a script",
    name=text("its name"),
    producer=text("the library"),
    target=text("the file"),
    written=truth("whether it was"),
    diagnostics=rows(SHORT_FINDING, "what differs"),
)


class Output(NamedTuple):
    """What a command prints with ``--json``."""

    name: str  # of the file, without .json
    command: str
    about: str
    schema: Schema


CITED = record(
    "the entries",
    fuzzyarm=by_name({"type": "string"}, "fields of the entry of the program"),
    sources=rows(
        record(
            "a publication",
            key=text("of the entry"),
            kind=text("of BibTeX: article, incollection …"),
            fields=by_name({"type": "string"}, "its fields, in their order"),
            of=names("what it is the source of"),
        ),
        "in the order in which methods are met",
    ),
)

GRADED = record(
    "the rows",
    lines=rows(
        record(
            "a demand",
            text=text("an expect or prove line"),
            points=whole("what it is worth"),
            about_=text("what a student is told of it"),
        ),
        "in the order of the file",
    ),
    submissions=rows(
        record(
            "a submission",
            name=text("its file, without the suffix"),
            points=whole("the sum of what passed"),
            fault=text("why it cannot be read; empty where it can"),
            results=rows(
                record(
                    "what became of a demand",
                    verdict=text("on it", "passed", "failed", "undecided"),
                    says=text("why; empty where it passed"),
                ),
                "one for each demand; none where the submission cannot be read",
            ),
        ),
        "in the order of their names",
    ),
)

_REPORT_FILE = record(
    "a file",
    file=text("its name"),
    sha256=text("of its bytes"),
    bytes=whole("how many"),
)
_REPORT_LINE = record("a line", line=whole("its number"), text=text("what stands there"))

OUTPUTS = (
    Output("grade", "grade DIR", "who passes what", GRADED),
    Output("cite", "cite FILE", "publications of the methods of a file", CITED),
    Output(
        "check", "check FILE…", "findings of all files", rows(FINDING, "in the order of the files")
    ),
    Output("eval", "eval FILE NAME=VALUE…", "every output by its name", EVALUATED),
    Output("eval-explain", "eval FILE NAME=VALUE… --explain", "one inference, step by step", TRACE),
    Output("show", "show FILE.frb", "a rule base", RULE_BASE),
    Output("show-table", "show FILE.lut", "a table", TABLE),
    Output("show-controller", "show CONTROLLER", "a controller", CONTROLLER),
    Output(
        "prove",
        "prove FILE…",
        "verdicts on the lines of the files",
        rows(VERDICT, "in the order of the lines"),
    ),
    Output("prove-range", "prove FILE --range", "bounds of an output", BOUNDS),
    Output(
        "prove-slope",
        "prove FILE --slope",
        "bounds of its slopes",
        record(
            "the slopes of an output",
            low=number("the lowest along any input"),
            high=number("the highest"),
            inputs=by_name(BOUNDS, "by input"),
        ),
    ),
    Output("prove-table", "prove FILE --table WHAT", "the error of a table", WORST),
    Output("prove-sector", "prove FILE --sector", "multiples of the inputs", SECTORS),
    Output(
        "prove-drives",
        "prove CONTROLLER --sector",
        "what holds of its drives",
        rows(DRIVE, "in the order of the axes"),
    ),
    Output("margins", "margins FILE --plant P", "how far a loop is from instability", MARGINS),
    Output("prove-loop", "prove FILE --plant P --stable", "a claim about a loop", LOOP_VERDICT),
    Output("prove-tube", "prove FILE --plant P --for TIME", "a tube", LOOP_BOUNDS),
    Output("prove-map", "prove FILE --plant P --map", "a map of starts", START_MAP),
    Output("compile", "compile FILE -o OUT.lut", "a table that was made", TABLE_REPORT),
    Output(
        "compile-source", "compile FILE -o OUT.c", "source text of rules and tables", SOURCE_REPORT
    ),
    Output(
        "compile-controller",
        "compile CONTROLLER -o OUT.c",
        "source text of a controller",
        CONTROLLER_REPORT,
    ),
    Output(
        "compile-report",
        "compile FILE -o OUT.c --report DIR",
        "what stands in DIR/report.json, too",
        record(
            "a report on an export",
            format=whole("of this description"),
            engine=text("which fuzzyarm"),
            source=_REPORT_FILE,
            used=rows(_REPORT_FILE, "what it reads beside itself"),
            settings={"type": "object", "description": "every option of the export"},
            written=rows(_REPORT_FILE, "the export"),
            functions=rows(
                record(
                    "a function",
                    call=text("its prototype"),
                    worst=number("largest difference to what it is compared with"),
                    against=text("what that is"),
                    points=whole("over how many points"),
                    proved=number("worst error against the rules", null="where none is proved"),
                    operations=by_name(
                        {"type": ["integer", "null"]},
                        "most of a call, by their sort; null where they are not bounded",
                    ),
                    stack=whole("bytes of local variables", null="of a controller"),
                ),
                "in order",
            ),
            findings=rows(
                record(
                    "a finding",
                    name=text("its sort"),
                    severity=text("how bad", "error", "warning", "info"),
                    message=text("in words"),
                    line=whole("of the file"),
                ),
                "of the check",
            ),
            proofs=rows(
                record(
                    "a statement about all points",
                    statement=text("in words"),
                    verdict=text("what is known", "proved", "refuted", "undecided"),
                    reason=text("why, or empty"),
                ),
                "by `prove` lines and certificates",
            ),
            self_test=record(
                "the self-test",
                compiler=text("and its version"),
                flags=names("of it"),
                passed=truth("whether every point does"),
                rows=rows(
                    record(
                        "a point, or a period",
                        function=text("which is called"),
                        inputs=numbers("that go in", null="where it is not a number"),
                        expected=numbers("of the model", null="where it is not a number"),
                        computed=numbers("by the C", null="where it is not a number"),
                        tolerance=number("of a difference"),
                        passed=truth("whether it is met"),
                    ),
                    "in order",
                ),
            ),
            coverage=record(
                "of the exported code by the self-test",
                statements=rows({"type": "integer"}, "reached, and in all", length=2),
                branches=rows({"type": "integer"}, "taken, and in all", length=2),
                missed=rows(_REPORT_LINE, "that no point reaches"),
                untaken=rows(_REPORT_LINE, "with a branch that no point takes"),
            ),
            sizes=rows(
                record(
                    "bytes of the functions alone",
                    processor=text("for which"),
                    compiler=text("and its version"),
                    flags=names("of it"),
                    flash=whole("bytes"),
                    ram=whole("bytes of static variables"),
                ),
                "by the cross compilers that are installed",
            ),
        ),
    ),
    Output(
        "convert",
        "convert IN OUT",
        "what was found and written",
        record(
            "a conversion",
            "sources",
            source=text("IN"),
            target=text("OUT"),
            producer=text("the program IN was read as one of"),
            written=truth("whether OUT was"),
            diagnostics=rows(SHORT_FINDING, "what differs"),
            sources={"type": "array", "description": "of several that are connected: all of them"},
        ),
    ),
    Output(
        "compile-board",
        "compile FILE --for arduino -o DIR",
        "a folder for a board",
        record(
            "a folder",
            folder=text("what was written"),
            files=names("in it"),
            functions=names("prototypes"),
            board=text("for which it is"),
            constants=whole("bytes of tables"),
            state=whole("bytes that it remembers"),
            measured=_NOTHING | {"description": "flash, ram, stack, cycles where avr-gcc is there"},
        ),
    ),
    Output(
        "convert-script",
        "convert SCRIPT.py",
        "the systems that a script makes",
        record(
            "a conversion",
            source=text("the script"),
            diagnostics=rows(SHORT_FINDING, "of the script as a whole"),
            systems=rows(_SYSTEM, "in the order in which they were made"),
        ),
    ),
    Output(
        "diff-tables",
        "diff A.lut B.lut",
        "what differs between two tables",
        record(
            "a difference",
            same=truth("whether nothing differs"),
            comparable=truth("whether they have the same cells"),
            transposed=truth("whether one is the other with its inputs exchanged"),
            header={"type": "array", "description": "what differs beside the values"},
            cells={"type": "array", "description": "cells that differ"},
        ),
    ),
    Output(
        "diff-rules",
        "diff A.frb B.frb",
        "what differs between two rule bases",
        record(
            "a difference",
            same=truth("whether both mean the same, however their rules are written down"),
            **{
                word: rows(_CHANGE, f"changes of {word}") for word in ("rules", "terms", "settings")
            },
        ),
    ),
    Output(
        "diff-controllers",
        "diff A.frb B.frb (controllers)",
        "what differs between two controllers",
        record(
            "a difference",
            same=truth("whether nothing differs"),
            **{
                word: rows(_CHANGE, f"changes of {word}") for word in ("settings", "gains", "lines")
            },
            order=names("axes whose lines stand in another order"),
            rulebases=by_name({"type": "object"}, "as of two rule bases, by their name here"),
            tables=by_name({"type": "object"}, "as of two tables"),
        ),
    ),
    Output(
        "simulate", "simulate CONTROLLER", "a run; several controllers give a list of them", RUN
    ),
    Output(
        "simulate-list",
        "simulate --list",
        "the controllers of the catalogue",
        by_name({"type": "string"}, "what each is, by name"),
    ),
    Output(
        "simulate-gains",
        "simulate CONTROLLER --show-gains",
        "the gains of a controller",
        record(
            "gains",
            controller=text("its name"),
            gains=by_name(
                record(
                    "a gain",
                    value=numbers("one, or one for each axis"),
                    unit=text("may be empty"),
                    origin=text("where its value comes from"),
                    meaning=text("may be empty"),
                ),
                "by name",
            ),
        ),
    ),
    Output("sweep", "sweep CONTROLLER --sweep NAME=A..B:N", "many runs", SWEEP),
    Output(
        "compare",
        "compare CONTROLLER…",
        "controllers on the arm",
        rows(COMPARED, "in the order in which they were named"),
    ),
    Output(
        "compare-runs",
        "compare CONTROLLER… --reference …",
        "runs of controllers along the same references",
        rows(RUN, "in the order in which they were named"),
    ),
    Output("tune", "tune FILE -o OUT.frb", "what tuning came to", TUNED),
    Output("learn", "learn CONTROLLER", "tables that a controller learned", LEARNED),
    Output("fit", "fit SAMPLES -o OUT.frb", "a rule base learned from samples", FIT),
    Output("validate", "validate FILE SAMPLES", "a rule base judged by samples", VALIDATED),
    Output(
        "reproduce",
        "reproduce ROW…",
        "published rows, run again",
        rows(REPRODUCED, "in the order of the study"),
    ),
    Output(
        "reproduce-list",
        "reproduce --list",
        "the published rows",
        rows(
            record(
                "a row",
                identifier=text("its name"),
                row=text("the controller, as the table has it"),
                condition=text("with a load or without"),
            ),
            "in the order of the study",
        ),
    ),
    Output(
        "identify",
        "identify",
        "gains fitted to published errors",
        rows(
            record_of(Identified, "a controller"),
            "in the order in which they were named",
        ),
    ),
    Output(
        "shipped",
        "shipped",
        "the files that come with fuzzyarm",
        rows(
            record(
                "a file",
                name=text("its name"),
                kind=text("what it is"),
                description=text("its own words"),
            ),
            "by name",
        ),
    ),
)


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
        lines += _table(inner, inside)
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
