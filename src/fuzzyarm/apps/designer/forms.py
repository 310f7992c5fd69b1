"""The forms of a page: the fields of a request in each.

All else of a form follows from the request: name of a field, help, unit, choices, default, and the
sentence about an invalid value. The page draws all forms by one function (``page/form.js``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, cast

from fuzzyarm.apps.designer.grounds import (
    FieldError,
    at_field,
    check_words,
    form_of,
    signal_of,
)
from fuzzyarm.apps.designer.messages import FormField
from fuzzyarm.apps.designer.records import MessageError
from fuzzyarm.apps.designer.requests import FormValues
from fuzzyarm.base.folders import EXPORTS, NETWORK
from fuzzyarm.requests.experiment import AROUND as FOLDED
from fuzzyarm.requests.experiment import ExperimentRequest
from fuzzyarm.requests.fields import AnyRequest
from fuzzyarm.requests.learn import FitRequest, LearnRequest
from fuzzyarm.requests.making import ExportRequest
from fuzzyarm.requests.margins import MarginsRequest
from fuzzyarm.requests.prove import ProveRequest
from fuzzyarm.requests.runs import SweepRequest
from fuzzyarm.requests.schema import form_fields
from fuzzyarm.requests.tune import TuneRequest

if TYPE_CHECKING:
    from fuzzyarm.apps.designer.stage import Plants

SIGNALS = ("reference", "disturb")
"""Fields whose words may name a file."""


@dataclass(frozen=True)
class RequestForm(Generic[AnyRequest]):
    """The fields of a request in a page.

    Attributes
    ----------
    kind : type
        Of the request.
    first : tuple of str
        The visible fields, in order.
    more : tuple of str
        The folded fields, under the group of most of them on the help page.
    open : str
        The field for the open file; a page does not fill it in.
    title : str
        Title of the folded fields.
    """

    kind: type[AnyRequest]
    first: tuple[str, ...]
    more: tuple[str, ...] = ()
    open: str = ""
    title: str = FOLDED

    def fields(self, **defaults: Any) -> list[FormField]:
        """Return the fields for the page, some with another default than the command has."""
        fields = []
        for field in form_fields(self.kind, *self.first, *self.more):
            name = field["name"]
            folded = {"group": self.title if name in self.more else ""}
            changed = {"default": defaults[name]} if name in defaults else {}
            fields.append(field | folded | changed)
        return cast(list[FormField], fields)

    def request(self, values: FormValues, folder: Path, **others: Any) -> AnyRequest:
        """Return the request filled in on a page."""
        fields = {name: values[name] for name in (*self.first, *self.more) if name in values}
        for name in SIGNALS:
            if name in fields:
                value: Any = fields[name] or ()
                words = value.split() if isinstance(value, str) else value
                with at_field(name):
                    fields[name] = tuple(signal_of(folder, word) for word in words)
        return form_of(self.kind, **fields, **others)


AROUND = (
    "connect", "noise", "quantise", "sensor_delay", "difference", "actuator",
    "actuator_delay", "disturb", "interpolate",
)  # fmt: skip

RUN = RequestForm(
    ExperimentRequest,
    ("plant", "trajectory", "payload", "reference", "duration"),
    (*AROUND, "seed"),
)
LEARN = RequestForm(
    LearnRequest,
    ("controller", "plant", "trajectory", "payload", "reference", "duration", "begin", "passes",
     "rate", "delay", "freeze"),
)  # fmt: skip
TUNE = RequestForm(
    TuneRequest,
    ("plant", "reference", "duration", "trajectory", "payload", "data", "test", "target", "cost",
     "scenarios", "vary", "over", "evals", "time", "unseen", "seed", "digits", "method", "linear",
     "tune"),
    AROUND,
    open="file",
)  # fmt: skip
SWEEP = RequestForm(
    SweepRequest,
    ("against", "plant", "reference", "duration", "trajectory", "payload", "sweep", "random",
     "metric", "map", "seed"),
    AROUND,
    open="controller",
)  # fmt: skip
FIT = RequestForm(
    FitRequest,
    ("data", "target", "inputs", "test", "series", "name", "rules", "words", "time"),
    ("start", "terms", "shrink", "move", "merge", "digits", "outside", "folds", "nested", "seed"),
    title="the model, and the search",
)  # fmt: skip

PROVE = RequestForm(
    ProveRequest,
    ("range", "slope", "sector", "table", "output", "along", "tolerance", "budget", "exact"),
)
PROVE_LOOP = RequestForm(
    ProveRequest,
    ("claim", "plant", "stable", "map", "over", "duration", "from", "with", "at", "sector",
     "continuous", "budget"),
    ("connect", "quantise", "sensor_delay", "actuator_delay"),
    title="connections, sensors, actuators",
)  # fmt: skip
"""Of a rule base, and of a controller in its loop."""

MARGINS = RequestForm(
    MarginsRequest,
    ("plant", "at", "with", "share", "budget"),
    ("connect", "sensor_delay", "actuator_delay"),
    open="file",
    title="connections, sensors, actuators",
)

WRITTEN_TABLES = (".lut", ".csv", ".tex")
PICTURES = (".png", ".svg")


def export_form(suffix: str, kind: str) -> RequestForm[ExportRequest]:
    """Return the form of an export."""
    makings = () if kind == "table" else ("levels",)
    output = ("output",) if kind == "rules" else ()
    if suffix == ".fmu":
        whole = ("q",) if kind == "controller" else ()
        return RequestForm(ExportRequest, (*makings, *output, "mode", *whole, "fmi"))
    if suffix == NETWORK:
        levels = () if kind == "table" else ("levels",)
        return RequestForm(ExportRequest, (*levels, *output, "precision"))
    if suffix in EXPORTS:
        return RequestForm(ExportRequest, (*makings, *output, "mode", "q", "precision", "name"))
    if suffix in WRITTEN_TABLES and kind != "table":
        return RequestForm(ExportRequest, ("output", "levels", "mode", "tolerance", "round"))
    return RequestForm(ExportRequest, output if suffix in PICTURES else ())


FORMS: Mapping[str, RequestForm[Any]] = {
    "run": RUN,
    "learn": LEARN,
    "tune": TUNE,
    "sweep": SWEEP,
    "fit": FIT,
    "prove": PROVE,
    "prove-loop": PROVE_LOOP,
    "margins": MARGINS,
}
"""Forms, by their work."""


def judged(form: str, values: FormValues, folder: Path, plants: Plants) -> dict[str, Any]:
    """Return the mistake in a form and its field; None for a valid form.

    Parameters
    ----------
    form : str
        One of `FORMS`.
    values : mapping
        The values of the form.
    folder : Path
        Folder of the open file.
    plants : Plants
        Those of the designer.
    """
    if form not in FORMS:
        raise MessageError("is not a form", "form")
    try:
        form_record = FORMS[form]
        request = form_record.request(
            values, folder, **({form_record.open: "x.frb"} if form_record.open else {})
        )
        if isinstance(request, ExperimentRequest) and request.plant in plants.by_name:
            check_words(request, plants.by_name[request.plant])
    except FieldError as error:
        return {"field": error.field, "message": str(error)}
    return {}
