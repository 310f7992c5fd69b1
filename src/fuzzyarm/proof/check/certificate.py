"""The one format of certificates: invariant regions, and tubes that lead into them.

A certificate names its claim and its loop, and holds the results of the search: for a region
P, multipliers and the gains of rule bases; for a tube a box of starts, its number of periods and
its destination. A file may come from anyone. So reading converts no types: a number of the proof
is the text of a rational, as ``"-3/4"``.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pathlib import Path
from typing import Any, Literal, NamedTuple, NoReturn, cast, get_args

from fuzzyarm.base.files import write_atomically
from fuzzyarm.base.protected import note_source
from fuzzyarm.control.controllers.text import ControllerText, sheet_files
from fuzzyarm.control.loop.course import Sensor
from fuzzyarm.language.model.claims import FollowedReference, LoopClaim, Stretch, When
from fuzzyarm.plant.own import beside, is_relative_file
from fuzzyarm.plant.plant import Plant, PlantError
from fuzzyarm.proof.claim.identity import loop_digests
from fuzzyarm.proof.claim.problem import ClaimError, LoopProblem, LoopProofError
from fuzzyarm.proof.claim.text import require_sense

FORMAT = "fuzzyarm-proof 2"

Matrix = tuple[tuple[Fraction, ...], ...]
Pair = tuple[Fraction, Fraction]


class CertificateError(LoopProofError):
    """A file is not a certificate, or belongs to another controller."""


# ── records ──────────────────────────────────────────────────────────────────────────


class Gains(NamedTuple):
    """Claim about an output of a rule base or table, for inputs in a region."""

    region: Mapping[str, Pair]  # of the moving inputs
    between: Pair  # bounds of the output there
    # Of the inputs in σ, where the output is σ times one gain; empty: it has slopes
    weights: Mapping[str, Fraction]
    gains: Mapping[str, Pair]  # the gain along σ, by ``""``; or the slopes, by input


@dataclass(frozen=True)
class Evidence:
    """A certificate's claims about a loop near its equilibrium, to be checked."""

    # Symbol of the program for each row of P; without states of the plant
    memory: Mapping[str, str]
    # Midpoint and radius of an interval around the rest, by row of P
    rest: Mapping[str, Pair]
    gains: tuple[Gains, ...]  # in the order of the program
    # Entries of the plant's matrix that are uncertain gains, with their bounds
    spread: tuple[tuple[int, int, Fraction, Fraction], ...]
    grip: Fraction  # least share of a deviation that passes a limit; 1: no limit is reached
    # Largest deviation from rest by state, for a plant that is not affine
    box: Mapping[str, Fraction]


class Fall(NamedTuple):
    """Multipliers that show the fall of V from one cone to another."""

    multipliers: tuple[Fraction, ...]  # of the blocks
    sides: Matrix  # for products of the signals that bound both cones


class Cone(NamedTuple):
    """A cone of the state space, with some inputs of rule bases on one side of their rest."""

    # In the order of the program; an input with a side has a region that ends at rest
    gains: tuple[Gains, ...]
    p: Matrix  # of V in this part
    falls: tuple[Fall, ...]  # to each cone, in their order; one alone: to any


@dataclass(frozen=True)
class RegionProof:
    """A region of attraction V = zᵀPz ≤ 1; without cones it is invariant."""

    evidence: Evidence  # facts about the loop used in the proof
    continuous: bool  # whether the loop is taken in continuous time
    p: Matrix  # of V
    multipliers: tuple[Fraction, ...]  # of the blocks
    rate: Fraction  # least relative fall of V in each period
    states: tuple[str, ...]  # names of the rows of P
    # Cones with their own functions, below V; then `multipliers` is empty
    cones: tuple[Cone, ...] = ()
    # Largest ratio of zᵀPz at any sample to zᵀPz at the start; 1 without cones
    growth: Fraction = Fraction(1)


class TubeProof(NamedTuple):
    """A box of starts, followed sample by sample."""

    box: tuple[Pair, ...]  # of each state of the plant; memory has its initial values
    periods: int  # most control periods
    # Destination: the region of a number (``regions``), or after exactly these periods the union of
    # the boxes of all ``tubes`` below a number; ``("", 0)`` for a claim of bounded time
    into: tuple[Literal["regions", "tubes", ""], int] = ("", 0)


class Part(NamedTuple):
    """A part of a claim's parameters, and its proof."""

    parameters: tuple[Stretch, ...]  # replace those of the claim, by name
    regions: tuple[RegionProof, ...]
    tubes: tuple[TubeProof, ...]


@dataclass(frozen=True)
class Certificate:
    """A proof of a claim about a loop, if the checker accepts it.

    Attributes
    ----------
    claim : LoopClaim
        The claim.
    controller : str
        Path of the controller.
    fingerprints : dict of str to str
        SHA-256 of the controller's file and of the files it uses, by name.
    regions : tuple of RegionProof
        Each proved by itself.
    tubes : tuple of TubeProof
        Each leads into a region, or into boxes of earlier tubes.
    sensors : dict of str to Sensor
        By port, axis and name; exact ones are left out.
    connect : dict of str to str
        Port of the plant for each name of the controller that differs.
    digests : dict of str to str
        SHA-256 of controller and plant, as they were in memory.
    window : tuple of (str, float, float)
        Of a map: the window around the boxes of its tubes, by state.
    delays : dict of str to float
        Dead times of actuators by input, s; zeros are left out.
    folder : str
        Base folder of the paths in it (`controller`, the plant of `claim`): that of its own file;
        empty for the working folder.
    parts : tuple of Part
        Parts of the parameters, together the whole, in place of `regions` and `tubes`.
    """

    claim: LoopClaim
    controller: str
    fingerprints: Mapping[str, str]
    regions: tuple[RegionProof, ...] = ()
    tubes: tuple[TubeProof, ...] = ()
    sensors: Mapping[str, Sensor] = field(default_factory=dict)
    connect: Mapping[str, str] = field(default_factory=dict)
    digests: Mapping[str, str] = field(default_factory=dict)
    window: tuple[Stretch, ...] = ()
    delays: Mapping[str, float] = field(default_factory=dict)
    folder: str = field(default="", compare=False)
    parts: tuple[Part, ...] = ()

    def place(self, name: str) -> str:
        """Return a path in the certificate relative to the working folder."""
        return beside(name, self.folder)

    def moved_to(self, folder: str) -> Certificate:
        """Return the certificate with paths relative to another folder."""

        def moved(name: str) -> str:
            if not is_relative_file(name):
                return name
            # Only folders are resolved: a file may be a link, and `..` of a linked folder is not
            # the folder before it in the path.
            above, own = os.path.split(self.place(name))
            with suppress(ValueError):  # on another drive
                above = os.path.relpath(os.path.realpath(above), os.path.realpath(folder))
            return os.path.normpath(os.path.join(above, own)).replace(os.sep, "/")

        claim = replace(self.claim, plant=moved(self.claim.plant))
        return replace(self, claim=claim, controller=moved(self.controller), folder=folder)

    @property
    def region(self) -> RegionProof:
        """The first region."""
        return self.regions[0]

    @property
    def proofs(self) -> tuple[Certificate | Part, ...]:
        """The holders of its regions and tubes: itself, and its parts."""
        return (self, *self.parts)

    @property
    def by_part(self) -> tuple[Certificate, ...]:
        """The certificates of its parts; itself where it has none."""
        return tuple(
            replace(self, claim=replace(self.claim, parameters=part.parameters),
                    regions=part.regions, tubes=part.tubes, parts=())
            for part in self.parts
        ) or (self,)  # fmt: skip

    @property
    def continuous(self) -> bool:
        """Whether the loop is taken in continuous time."""
        return any(region.continuous for each in self.proofs for region in each.regions)

    def as_data(self) -> dict[str, Any]:
        """Return the certificate as plain data, sealed."""
        data = {
            "format": FORMAT,
            "claim": _claim_data(self.claim),
            "sensors": {
                port: {name: _text(getattr(sensor, name)) for name in SENSOR}
                for port, sensor in self.sensors.items()
            },
            "delays": {name: _text(delay) for name, delay in self.delays.items()},
            "connect": _plain(self.connect),
            "controller": self.controller,
            "sha256": _plain(self.fingerprints),
            "proved": _plain(self.digests),
            "window": _rows(self.window),
            **_proof_data(self),
        }  # fmt: skip
        if self.parts:
            data["parts"] = [
                {"parameters": _rows(part.parameters), **_proof_data(part)} for part in self.parts
            ]
        return sealed(data)

    @property
    def seal(self) -> str:
        """SHA-256 of the contents."""
        return str(self.as_data()["seal"])


# ── writing ──────────────────────────────────────────────────────────────────────────


SENSOR = ("delay", "resolution", "difference")
"""Properties of a sensor in a certificate."""


def _plain(value: Any) -> Any:
    """Return a value of a proof as JSON: records as objects, rationals as texts."""
    if isinstance(value, Fraction):
        return str(value)
    if isinstance(value, Mapping):
        return {name: _plain(x) for name, x in value.items()}
    names = getattr(value, "__dataclass_fields__", None) or getattr(value, "_fields", None)
    if names is not None:
        return {name: _plain(getattr(value, name)) for name in names}
    return list(map(_plain, value)) if isinstance(value, tuple | list) else value


def _text(value: float | None) -> str | None:
    # A finite double is a rational: nothing is lost. JSON has no infinity.
    if value is None:
        return None
    return str(Fraction(value)) if math.isfinite(value) else str(value)


def _rows(rows: Iterable[tuple[Any, ...]]) -> list[list[Any]]:
    """Return rows of a name and numbers."""
    return [[name, *map(_text, numbers)] for name, *numbers in rows]


def _claim_data(claim: LoopClaim) -> dict[str, Any]:
    data = {
        "plant": claim.plant,
        "stable": claim.stable,
        "at": _rows(claim.at),
        "parameters": _rows(claim.parameters),
        "start": _rows(claim.start),
        "output": claim.output,
        "between": [_text(claim.low), _text(claim.high)],
        "when": claim.when,
        "from": _text(claim.begin),
        "to": _text(None if claim.end == math.inf else claim.end),
    }
    # Only for claims that have them: the seals of others stay the same.
    if claim.follows:
        data["while"] = [[each.port, each.kind, [*map(_text, each.numbers)]]
                         for each in claim.follows]  # fmt: skip
    return {**data, "error": True} if claim.error else data


def _proof_data(proof: Certificate | Part) -> dict[str, Any]:
    return {"regions": list(map(_region_data, proof.regions)), "tubes": _plain(proof.tubes)}


def _region_data(region: RegionProof) -> dict[str, Any]:
    data: dict[str, Any] = _plain(region)
    loop = {"continuous": data.pop("continuous"), **data.pop("evidence")}
    order = ("states", "p", "multipliers", "rate", "growth", "cones")
    return {"loop": loop, **{name: data[name] for name in order}}


def _seal(data: Mapping[str, Any]) -> str:
    # The contents alone count: neither the order of keys nor the layout of the file.
    text = json.dumps(data, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()


def sealed(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return data together with the SHA-256 of its contents."""
    return {**data, "seal": _seal(data)}


def write_certificate(certificate: Certificate, path: str) -> str:
    """Write a certificate, and return its seal.

    Relative paths are written relative to the folder of `path`.

    Parameters
    ----------
    certificate : Certificate
        The certificate.
    path : str
        The file, replaced as a whole.
    """
    data = certificate.moved_to(os.path.dirname(path)).as_data()
    write_atomically(path, _written(data))
    return str(data["seal"])


def certificate_bytes(certificate: Certificate, folder: str) -> bytes:
    """Return the contents of a certificate's file in a folder."""
    return _written(certificate.moved_to(folder).as_data())


def _written(data: Mapping[str, Any]) -> bytes:
    return (json.dumps(data, indent=1, ensure_ascii=False) + "\n").encode()


def fingerprints_of(text: ControllerText) -> dict[str, str]:
    """Return the SHA-256 of a controller's file and of the files it uses, by name.

    A controller in memory alone has none.
    """
    if not text.path:
        return {}
    files = [Path(text.path), *sheet_files(text)]
    return {
        file.name: hashlib.sha256(file.read_bytes()).hexdigest()
        for file in dict.fromkeys(files)
        if file.is_file()
    }


def delays_by_name(plant: Plant) -> dict[str, float]:
    """Return the dead times of actuators by name, as in a certificate."""
    return {name: port.dead_time for name, port in plant.inputs.items() if port.dead_time}


def new_certificate(
    problem: LoopProblem, claim: LoopClaim, regions: Sequence[RegionProof]
) -> Certificate:
    """Return a certificate of a loop with regions, without tubes yet."""
    text, label = problem.text, problem.site.interface.label
    return Certificate(
        claim, text.path, fingerprints_of(text), tuple(regions), (),
        {label(port): sensor for port, sensor in problem.sensors.items()},
        dict(problem.site.connect), loop_digests(text, problem.given or problem.plant),
        delays=delays_by_name(problem.plant),
    )  # fmt: skip


# ── reading ──────────────────────────────────────────────────────────────────────────

_RATIONAL = re.compile(r"-?[0-9]{1,4000}(/[0-9]{1,4000})?")


@dataclass(frozen=True)
class Field:
    """A value in a certificate's file with its path there, such as ``p[0][1]``."""

    file: str
    path: str
    value: Any

    def refuse(self, what: str) -> NoReturn:
        """Refuse the file: this field is wrong."""
        where = f"'{self.path}' {what}" if self.path else f"it {what}"
        raise CertificateError(f"{self.file} is not a certificate: {where}")

    def __getitem__(self, name: str) -> Field:
        value = self._of(dict, "an object")
        path = f"{self.path}.{name}" if self.path else name
        if name not in value:
            Field(self.file, path, None).refuse("is missing")
        return Field(self.file, path, value[name])

    def has(self, name: str) -> bool:
        """Return whether an object has a field."""
        return name in self._of(dict, "an object")

    def __iter__(self) -> Iterator[Field]:
        for k, value in enumerate(self._of(list, "a list")):
            yield Field(self.file, f"{self.path}[{k}]", value)

    def items(self) -> list[tuple[str, Field]]:
        """Return the fields of an object by name."""
        return [(name, self[name]) for name in self._of(dict, "an object")]

    def row(self, size: int) -> list[Field]:
        """Return the entries of a list of the given size."""
        if len(self._of(list, "a list")) != size:
            self.refuse(f"is not a list of {size}")
        return list(self)

    @property
    def text(self) -> str:
        """As a text."""
        return str(self._of(str, "a text"))

    @property
    def flag(self) -> bool:
        """As true or false."""
        return bool(self._of(bool, "true or false"))

    @property
    def index(self) -> int:
        """As a whole number, 0 or more."""
        if isinstance(self.value, bool) or not isinstance(self.value, int) or self.value < 0:
            self.refuse("is not a whole number")
        if self.value >= 1 << 53:
            self.refuse("is too large")
        return self.value

    @property
    def rational(self) -> Fraction:
        """As a rational."""
        if not isinstance(self.value, str) or not _RATIONAL.fullmatch(self.value):
            self.refuse('is not a rational as a text, such as "3/4"')
        try:
            number = Fraction(self.value)
        except ZeroDivisionError:
            self.refuse("is a division by 0")
        try:
            is_near = bool(float(number)) == bool(number)
        except OverflowError:
            is_near = False
        if not is_near:
            self.refuse("is out of range")
        return number

    @property
    def number(self) -> float:
        """As a float, which may be infinite."""
        return float(self.value) if self.value in ("inf", "-inf") else float(self.rational)

    @property
    def pair(self) -> Pair:
        """As two rationals."""
        low, high = self.row(2)
        return low.rational, high.rational

    def one_of(self, choices: Sequence[str]) -> str:
        """As one of several texts."""
        if self.value not in choices:
            self.refuse(f"is not {', '.join(choices[:-1])} or {choices[-1]}")
        return str(self.value)

    def _of(self, kind: type, words: str) -> Any:
        if not isinstance(self.value, kind):
            self.refuse(f"is not {words}")
        return self.value


def read_certificate(path: str) -> Certificate:
    """Read a certificate, without checking its proof.

    Parameters
    ----------
    path : str
        The file.

    Raises
    ------
    OSError
        If it cannot be read.
    CertificateError
        If it is damaged or not a certificate.
    """
    data = _unsealed(_fields(path))
    return Certificate(
        _claim(data["claim"]),
        data["controller"].text,
        _texts_of(data["sha256"]),
        tuple(map(_region, data["regions"])),
        tuple(map(_tube, data["tubes"])),
        {port: _sensor(pair) for port, pair in data["sensors"].items()},
        _texts_of(data["connect"]),
        _texts_of(data["proved"]),
        _stretches(data["window"]),
        {name: delay.number for name, delay in data["delays"].items()},
        os.path.dirname(path),
        tuple(map(_part, data["parts"])) if data.has("parts") else (),
    )


def _fields(path: str) -> Field:
    note_source(path)
    try:
        value = json.loads(Path(path).read_text("utf-8"))
    except json.JSONDecodeError as error:
        Field(path, "", None).refuse(f"is not JSON at line {error.lineno}")
    except (ValueError, RecursionError):  # not UTF-8, an endless number, endless nesting
        Field(path, "", None).refuse("is not JSON")
    return Field(path, "", value)


def _unsealed(whole: Field) -> Field:
    version = whole["format"].text
    if version != FORMAT:
        if version.startswith("fuzzyarm-"):
            raise CertificateError(f"{whole.file} is of another version ({version}): prove it anew")
        whole["format"].refuse(f'is not "{FORMAT}"')
    data = dict(whole.value)
    seal = data.pop("seal", None)
    try:
        is_whole = seal == _seal(data)
    except (UnicodeEncodeError, RecursionError):  # a lone UTF-16 surrogate, endless nesting
        whole.refuse("is not JSON")
    if not is_whole:
        raise CertificateError(f"{whole.file} is damaged: its seal is not that of its contents")
    return Field(whole.file, "", data)


def _claim(claim: Field) -> LoopClaim:
    low, high = claim["between"].row(2)
    made = LoopClaim(
        claim["plant"].text,
        claim["stable"].flag,
        tuple((name.text, x.number) for name, x in (pair.row(2) for pair in claim["at"])),
        _stretches(claim["parameters"]),
        _stretches(claim["start"]),
        claim["output"].text,
        low.number,
        high.number,
        cast(When, claim["when"].one_of(get_args(When))),
        claim["from"].number,
        math.inf if claim["to"].value is None else claim["to"].number,
        follows=tuple(map(_followed, claim["while"])) if claim.has("while") else (),
        error=claim.has("error") and claim["error"].flag,
    )
    if not made.plant:
        claim["plant"].refuse("names no plant")
    try:
        require_sense(made)
    except ClaimError as error:
        claim.refuse(f"means nothing: {error}")
    return made


def _followed(row: Field) -> FollowedReference:
    port, kind, numbers = row.row(3)
    return FollowedReference(port.text, kind.text, tuple(x.number for x in numbers))


def _stretches(rows: Field) -> tuple[Stretch, ...]:
    return tuple((n.text, a.number, b.number) for n, a, b in (row.row(3) for row in rows))


def _texts_of(entry: Field) -> dict[str, str]:
    return {name: text.text for name, text in entry.items()}


def _pairs(entry: Field) -> dict[str, Pair]:
    return {name: pair.pair for name, pair in entry.items()}


def _rationals(entry: Field) -> dict[str, Fraction]:
    return {name: number.rational for name, number in entry.items()}


def _gains(entry: Field) -> Gains:
    return Gains(
        _pairs(entry["region"]),
        entry["between"].pair,
        _rationals(entry["weights"]),
        _pairs(entry["gains"]),
    )


def _spread(entry: Field) -> tuple[int, int, Fraction, Fraction]:
    k, j, low, high = entry.row(4)
    return k.index, j.index, low.rational, high.rational


def _share(entry: Field) -> Fraction:
    if not 0 <= entry.rational <= 1:
        entry.refuse("is not from 0 to 1")
    return entry.rational


def _part(data: Field) -> Part:
    return Part(
        _stretches(data["parameters"]),
        tuple(map(_region, data["regions"])),
        tuple(map(_tube, data["tubes"])),
    )


def _region(data: Field) -> RegionProof:
    loop = data["loop"]
    return RegionProof(
        Evidence(
            _texts_of(loop["memory"]),
            _pairs(loop["rest"]),
            tuple(map(_gains, loop["gains"])),
            tuple(map(_spread, loop["spread"])),
            _share(loop["grip"]),
            _rationals(loop["box"]),
        ),
        loop["continuous"].flag,
        _matrix(data["p"]),
        tuple(x.rational for x in data["multipliers"]),
        data["rate"].rational,
        tuple(name.text for name in data["states"]),
        tuple(map(_cone, data["cones"])),
        data["growth"].rational,
    )


def _matrix(rows: Field) -> Matrix:
    return tuple(tuple(x.rational for x in row) for row in rows)


def _cone(data: Field) -> Cone:
    falls = (
        Fall(tuple(x.rational for x in fall["multipliers"]), _matrix(fall["sides"]))
        for fall in data["falls"]
    )
    return Cone(tuple(map(_gains, data["gains"])), _matrix(data["p"]), tuple(falls))


def _tube(data: Field) -> TubeProof:
    kind, number = data["into"].row(2)
    into = cast(Literal["regions", "tubes", ""], kind.one_of(("regions", "tubes", "")))
    return TubeProof(
        tuple(pair.pair for pair in data["box"]),
        data["periods"].index,
        (into, number.index),
    )


def _sensor(pair: Field) -> Sensor:
    delay, resolution = pair["delay"].number, pair["resolution"].number
    difference = pair["difference"]
    filter_time = None if difference.value is None else difference.number
    try:
        return Sensor(delay=delay, resolution=resolution, difference=filter_time)
    except PlantError as error:
        pair.refuse(f"is not a sensor: {error}")
