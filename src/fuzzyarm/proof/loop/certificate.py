"""Certificates as files: what was chosen and found, all numbers as rationals, and a seal.

A certificate says nothing that is believed: it names the controller, the plant and the claim, says
of the loop where it rests and which gains its rule bases have
(:class:`~fuzzyarm.proof.loop.evidence.Evidence`), and has P, the multipliers and the rate.
:mod:`fuzzyarm.proof.loop.checked_loop` derives the loop from the files and checks all of that.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any, cast, get_args

from fuzzyarm.control.controllers.text import ControllerText, sheet_files
from fuzzyarm.control.loop.course import Sensor
from fuzzyarm.language.model.claims import LoopClaim, Stretch, When
from fuzzyarm.plant.plant import PlantError
from fuzzyarm.proof.claim.problem import ClaimError, LoopProblem
from fuzzyarm.proof.claim.text import require_sense
from fuzzyarm.proof.loop.certificate_fields import CertificateError, Field
from fuzzyarm.proof.loop.evidence import Evidence, Gains

__all__ = [
    "Certificate",
    "CertificateError",
    "fingerprints_of",
]

FORMAT = "fuzzyarm-certificate 5"

Matrix = tuple[tuple[Fraction, ...], ...]


@dataclass(frozen=True)
class Certificate:
    """What proves a claim about a loop, if the checker says so.

    Attributes
    ----------
    claim : LoopClaim
        What is claimed.
    controller : str
        The file of the controller, as it was given.
    fingerprints : dict of str to str
        SHA-256 of the controller's file and of those that it uses, by name.
    evidence : Evidence
        The facts about the loop that the proof uses.
    continuous : bool
        Whether the loop is taken in continuous time.
    p : matrix of Fraction
        Of V; the region is V ≤ 1.
    multipliers : tuple of Fraction
        Of the blocks.
    rate : Fraction
        By what share V falls in each period.
    states : tuple of str
        Names of the rows of P.
    sensors : dict of str to Sensor
        By port, axis and name; exact ones are not there.
    connect : dict of str to str
        From names of the controller to ports of the plant, where they differ.
    digests : dict of str to str
        SHA-256 of the controller and of the plant that were proved, as they were in memory.
    """

    claim: LoopClaim
    controller: str
    fingerprints: Mapping[str, str]
    evidence: Evidence
    continuous: bool
    p: Matrix
    multipliers: tuple[Fraction, ...]
    rate: Fraction
    states: tuple[str, ...]
    sensors: Mapping[str, Sensor] = field(default_factory=dict)
    connect: Mapping[str, str] = field(default_factory=dict)
    digests: Mapping[str, str] = field(default_factory=dict)

    def as_data(self) -> dict[str, Any]:
        """Return it as plain data, sealed."""
        data = {
            "format": FORMAT,
            **loop_data(self.claim, self.sensors, self.connect),
            "controller": self.controller,
            "sha256": dict(self.fingerprints),
            "proved": dict(self.digests),
            "loop": {
                "continuous": self.continuous,
                "memory": dict(self.evidence.memory),
                "rest": {n: _texts(pair) for n, pair in self.evidence.rest.items()},
                "gains": [_gains_data(gains) for gains in self.evidence.gains],
                "spread": [[k, j, str(low), str(high)] for k, j, low, high in self.evidence.spread],
                "grip": str(self.evidence.grip),
                "box": {name: str(half) for name, half in self.evidence.box.items()},
            },
            "states": list(self.states),
            # Rationals as text: exact, whatever reads the file.
            "p": [[str(x) for x in row] for row in self.p],
            "multipliers": [str(x) for x in self.multipliers],
            "rate": str(self.rate),
        }
        return {**data, "seal": _seal(data)}

    @property
    def seal(self) -> str:
        """SHA-256 of its contents."""
        return str(self.as_data()["seal"])


def loop_data(
    claim: LoopClaim, sensors: Mapping[str, Sensor], connect: Mapping[str, str]
) -> dict[str, Any]:
    """Return a claim, and of which loop it is, as plain data."""
    return {
        "claim": {
            "plant": claim.plant,
            "stable": claim.stable,
            "at": [[name, _text(value)] for name, value in claim.at],
            "parameters": [[n, _text(a), _text(b)] for n, a, b in claim.parameters],
            "start": [[n, _text(a), _text(b)] for n, a, b in claim.start],
            "output": claim.output,
            "between": [_text(claim.low), _text(claim.high)],
            "when": claim.when,
            "from": _text(claim.begin),
            # JSON has no infinity.
            "to": None if claim.end == float("inf") else _text(claim.end),
        },
        "sensors": {
            port: {
                "delay": _text(s.delay),
                "resolution": _text(s.resolution),
                "difference": None if s.difference is None else _text(s.difference),
            }
            for port, s in sensors.items()
        },
        "connect": dict(connect),
    }


def _text(value: float) -> str:
    # A finite double is a rational: nothing is lost.
    return str(Fraction(value)) if math.isfinite(value) else str(value)


def _texts(values: tuple[Fraction, ...]) -> list[str]:
    return [str(value) for value in values]


def _gains_data(gains: Gains) -> dict[str, Any]:
    return {
        "region": {name: _texts(pair) for name, pair in gains.region.items()},
        "between": _texts(gains.between),
        "weights": {name: str(weight) for name, weight in gains.weights.items()},
        "gains": {name: _texts(pair) for name, pair in gains.gains.items()},
    }


def _pairs(entry: Field) -> dict[str, tuple[Fraction, Fraction]]:
    return {name: pair.pair for name, pair in entry.items()}


def _rationals(entry: Field) -> dict[str, Fraction]:
    return {name: number.rational for name, number in entry.items()}


def texts_of(entry: Field) -> dict[str, str]:
    """Return texts by name."""
    return {name: text.text for name, text in entry.items()}


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


def _evidence(loop: Field) -> Evidence:
    return Evidence(
        texts_of(loop["memory"]),
        _pairs(loop["rest"]),
        tuple(map(_gains, loop["gains"])),
        tuple(map(_spread, loop["spread"])),
        _share(loop["grip"]),
        _rationals(loop["box"]),
    )


def _seal(data: Mapping[str, Any]) -> str:
    # Of the contents alone: neither the order of keys nor the layout of the file counts.
    text = json.dumps(data, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()


def fingerprints_of(text: ControllerText) -> dict[str, str]:
    """Return the SHA-256 of the file of a controller and of those that it uses, by name.

    A controller that was not read from a file has none.
    """
    if not text.path:
        return {}
    files = [Path(text.path), *sheet_files(text)]
    return {
        file.name: hashlib.sha256(file.read_bytes()).hexdigest()
        for file in dict.fromkeys(files)
        if file.is_file()
    }


def certificate_of(whole: Field) -> Certificate:
    """Return the certificate that the fields of a file are; see `read_certificate`."""
    data = unsealed(whole, FORMAT)
    return Certificate(
        claim_of(data),
        data["controller"].text,
        texts_of(data["sha256"]),
        _evidence(data["loop"]),
        data["loop"]["continuous"].flag,
        tuple(tuple(x.rational for x in row) for row in data["p"]),
        tuple(x.rational for x in data["multipliers"]),
        data["rate"].rational,
        tuple(name.text for name in data["states"]),
        sensors_of(data),
        texts_of(data["connect"]),
        texts_of(data["proved"]),
    )


def unsealed(whole: Field, kind: str) -> Field:
    """Return the data of a sealed file of a format, without its seal."""
    path = whole.file
    version = whole["format"].text
    if version != kind:
        if version.startswith(("fuzzyarm-certificate ", "fuzzyarm-tube ")):
            raise CertificateError(f"{path} is of another version ({version}): prove it anew")
        whole["format"].refuse(f'is not "{kind}"')
    data = dict(whole.value)
    seal = data.pop("seal", None)
    try:
        is_whole = seal == _seal(data)
    except (UnicodeEncodeError, RecursionError):  # half of a pair of UTF-16, nested without end
        whole.refuse("is not JSON")
    if not is_whole:
        raise CertificateError(f"{path} is damaged: its seal is not that of its contents")
    return Field(path, "", data)


def sealed(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return data with the SHA-256 of its contents."""
    return {**data, "seal": _seal(data)}


def claim_of(data: Field) -> LoopClaim:
    """Return the claim of a certificate's data."""
    claim = data["claim"]
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
    )
    try:
        require_sense(made)
    except ClaimError as error:
        claim.refuse(f"means nothing: {error}")
    return made


def sensors_by_name(problem: LoopProblem) -> dict[str, Sensor]:
    """Return the sensors of a loop as a certificate has them."""
    label = problem.site.interface.label
    return {label(port): sensor for port, sensor in problem.sensors.items()}


def sensors_of(data: Field) -> dict[str, Sensor]:
    """Return the sensors of a certificate's data."""
    return {port: _sensor(pair) for port, pair in data["sensors"].items()}


def _sensor(pair: Field) -> Sensor:
    delay, resolution = pair["delay"].number, pair["resolution"].number
    difference = pair["difference"]
    filter_time = None if difference.value is None else difference.number
    try:
        return Sensor(delay=delay, resolution=resolution, difference=filter_time)
    except PlantError as error:
        pair.refuse(f"is not a sensor: {error}")


def _stretches(rows: Field) -> tuple[Stretch, ...]:
    return tuple((n.text, a.number, b.number) for n, a, b in (row.row(3) for row in rows))
