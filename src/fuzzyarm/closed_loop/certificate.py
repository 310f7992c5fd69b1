"""Certificates as files: what was chosen and found, all numbers as rationals, and a seal.

A certificate says nothing that is believed: it names the controller, the plant and the claim, says
of the loop where it rests and which gains its rule bases have
(:class:`~fuzzyarm.closed_loop.evidence.Evidence`), and has P, the multipliers and the rate.
:mod:`fuzzyarm.closed_loop.checked_loop` derives the loop from the files and checks all of that.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any

from fuzzyarm.closed_loop.evidence import Evidence, Gains
from fuzzyarm.closed_loop.problem import LoopProofError
from fuzzyarm.controller.text import ControllerText, sheet_files
from fuzzyarm.loop.course import Sensor
from fuzzyarm.model.claims import LoopClaim
from fuzzyarm.text.files import write_atomically

__all__ = [
    "Certificate",
    "CertificateError",
    "fingerprints_of",
    "read_certificate",
    "write_certificate",
]

FORMAT = "fuzzyarm-certificate 3"

Matrix = tuple[tuple[Fraction, ...], ...]


class CertificateError(LoopProofError):
    """A file is not a certificate, or not of this controller."""


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
        What is said of the loop.
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

    def as_data(self) -> dict[str, Any]:
        """Return it as plain data, sealed."""
        data = {
            "format": FORMAT,
            **loop_data(self.claim, self.sensors, self.connect),
            "controller": self.controller,
            "sha256": dict(self.fingerprints),
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
            "p": [[str(x) for x in row] for row in self.p],
            "multipliers": [str(x) for x in self.multipliers],
            "rate": str(self.rate),
        }
        return {**data, "seal": _seal(data)}

    @property
    def seal(self) -> str:
        """SHA-256 of all that it says."""
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
            "to": None if claim.end == float("inf") else _text(claim.end),
        },
        "sensors": {
            port: [_text(s.delay), None if s.difference is None else _text(s.difference)]
            for port, s in sensors.items()
        },
        "connect": dict(connect),
    }


def _text(value: float) -> str:
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


def _pairs(data: Any) -> dict[str, tuple[Fraction, Fraction]]:
    return {str(name): _pair(pair) for name, pair in data.items()}


def _pair(data: Any) -> tuple[Fraction, Fraction]:
    low, high = map(Fraction, data)
    return low, high


def _gains(data: Any) -> Gains:
    weights = {str(name): Fraction(weight) for name, weight in data["weights"].items()}
    return Gains(_pairs(data["region"]), _pair(data["between"]), weights, _pairs(data["gains"]))


def _evidence(data: Any) -> Evidence:
    return Evidence(
        {str(name): str(symbol) for name, symbol in data["memory"].items()},
        _pairs(data["rest"]),
        tuple(_gains(gains) for gains in data["gains"]),
        tuple((int(k), int(j), *_pair(ends)) for k, j, *ends in data["spread"]),
        Fraction(data["grip"]),
        {str(name): Fraction(half) for name, half in data["box"].items()},
    )


def _seal(data: Mapping[str, Any]) -> str:
    text = json.dumps(data, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()


def fingerprints_of(text: ControllerText, path: str) -> dict[str, str]:
    """Return the SHA-256 of the file of a controller and of those that it uses, by name."""
    files = [Path(path), *sheet_files(text)]
    return {
        file.name: hashlib.sha256(file.read_bytes()).hexdigest()
        for file in dict.fromkeys(files)
        if file.is_file()
    }


def write_certificate(certificate: Certificate, path: str) -> None:
    """Write a certificate.

    Parameters
    ----------
    certificate : Certificate
        Which.
    path : str
        The file, replaced as a whole.
    """
    text = json.dumps(certificate.as_data(), indent=1, ensure_ascii=False)
    write_atomically(path, (text + "\n").encode())


def read_certificate(path: str) -> Certificate:
    """Read a certificate; whether it proves anything is not asked.

    Parameters
    ----------
    path : str
        The file.

    Raises
    ------
    OSError
        If it cannot be read.
    CertificateError
        If it is not a certificate, or is damaged.
    """
    return _certificate(read_sealed(path, FORMAT), path)


def read_sealed(path: str, wanted: str) -> dict[str, Any]:
    """Return the data of a sealed file of a format, without its seal.

    Raises
    ------
    OSError
        If it cannot be read.
    CertificateError
        If it is not of that format, or is damaged.
    """
    try:
        data = json.loads(Path(path).read_text("utf-8"))
    except ValueError as error:
        raise CertificateError(f"{path} is not a certificate: {error}") from error
    found = data.get("format") if isinstance(data, dict) else None
    if found != wanted:
        older = isinstance(found, str) and found.startswith("fuzzyarm-certificate")
        what = f"of another version ({found}): prove it anew" if older else "not a certificate"
        raise CertificateError(f"{path} is {what}")
    seal = data.pop("seal", None)
    if seal != sealed(data)["seal"]:
        raise CertificateError(f"{path} is damaged: its seal is not that of its contents")
    return dict(data)


def sealed(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return data with the SHA-256 of all that it says."""
    return {**data, "seal": _seal(data)}


@contextmanager
def refused(path: str) -> Iterator[None]:
    """Say of what is not there, or not of its kind, that the file is not a certificate."""
    try:
        yield
    except CertificateError:
        raise
    except (KeyError, TypeError, ValueError, ZeroDivisionError, AttributeError) as error:
        raise CertificateError(f"{path} is not a certificate: {error}") from error


def _certificate(data: Mapping[str, Any], path: str) -> Certificate:
    with refused(path):
        return _from_data(data)


def _from_data(data: Mapping[str, Any]) -> Certificate:
    return Certificate(
        claim_of(data),
        str(data["controller"]),
        dict(data["sha256"]),
        _evidence(data["loop"]),
        bool(data["loop"]["continuous"]),
        tuple(tuple(Fraction(x) for x in row) for row in data["p"]),
        tuple(Fraction(x) for x in data["multipliers"]),
        Fraction(data["rate"]),
        tuple(data["states"]),
        sensors_of(data),
        {str(name): str(port) for name, port in data["connect"].items()},
    )


def claim_of(data: Mapping[str, Any]) -> LoopClaim:
    """Return the claim of a certificate's data."""
    claim = data["claim"]
    low, high = map(_number, claim["between"])
    return LoopClaim(
        str(claim["plant"]),
        bool(claim["stable"]),
        tuple((str(n), _number(x)) for n, x in claim["at"]),
        _stretches(claim["parameters"]),
        _stretches(claim["start"]),
        str(claim["output"]),
        low,
        high,
        claim["when"],
        _number(claim["from"]),
        float("inf") if claim["to"] is None else _number(claim["to"]),
    )


def sensors_of(data: Mapping[str, Any]) -> dict[str, Sensor]:
    """Return the sensors of a certificate's data."""
    return {
        str(port): Sensor(delay=_number(late), difference=None if d is None else _number(d))
        for port, (late, d) in data["sensors"].items()
    }


def _number(text: str) -> float:
    if text in ("inf", "-inf"):
        return float(text)
    return float(Fraction(text))


def _stretches(rows: Any) -> tuple[tuple[str, float, float], ...]:
    return tuple((str(n), _number(a), _number(b)) for n, a, b in rows)
