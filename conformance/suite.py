"""The cases as data: reading them, and saying in one sentence what is wrong with one."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent
CASES = FOLDER / "cases"
SCHEMA = FOLDER / "case.schema.json"


class SuiteError(ValueError):
    """A file of cases is not one, said in one sentence with its place."""


@dataclass(frozen=True)
class Case:
    """One case.

    Attributes
    ----------
    name : str
        Of its own in the whole suite.
    topic : str
        The stem of its file.
    data : mapping
        As it stands in the file.
    """

    name: str
    topic: str
    data: Mapping[str, Any]

    @property
    def span(self) -> dict[str, float]:
        """The width of the range of each output, against which differences are measured."""
        ranges = {name: out["range"] for name, out in self.data["outputs"].items()}
        return {name: float(high) - float(low) for name, (low, high) in ranges.items()}


def read(
    path: Path, number: Callable[[str], Any] | None = None, *, validated: bool = True
) -> list[Case]:
    """Return the cases of a file.

    Parameters
    ----------
    path : Path
        A file of the suite.
    number : callable, optional
        What numbers of the file become, instead of floats and integers: ``Fraction`` or ``Decimal``
        keep every digit.
    validated : bool, optional
        False for a file that is known to follow the schema: the validation takes most of the time.

    Raises
    ------
    SuiteError
        Where the file is not JSON or does not follow the schema.
    """
    try:
        text = path.read_text(encoding="utf-8")
        plain = json.loads(text)
        data = plain if number is None else json.loads(text, parse_float=number, parse_int=number)
    except OSError as error:
        raise SuiteError(f"{path.name}: cannot be read: {error.strerror}") from error
    except ValueError as error:
        raise SuiteError(f"{path.name}: not JSON: {error}") from error
    if validated:
        _demand_schema(path, plain)
    cases = [Case(entry["name"], plain["topic"], entry) for entry in data["cases"]]
    for case in cases:
        _demand_known_names(path, case)
    return cases


def _demand_schema(path: Path, plain: Any) -> None:
    """Refuse what does not follow the schema."""
    from jsonschema import Draft202012Validator
    from jsonschema.exceptions import best_match

    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    fault = best_match(Draft202012Validator(schema).iter_errors(plain))
    if fault is not None:
        raise SuiteError(
            f"{path.name}: {_place(plain, list(fault.absolute_path))}: {fault.message[:200]}"
        )


def _place(plain: Any, steps: list[Any]) -> str:
    """Return where in a file a fault is, by the name of the case."""
    if len(steps) >= 2 and steps[0] == "cases":
        entry = plain["cases"][steps[1]]
        name = entry.get("name", steps[1]) if isinstance(entry, dict) else steps[1]
        inner = "/".join(str(step) for step in steps[2:])
        return f"case {name!r}" + (f", {inner}" if inner else "")
    return "/".join(str(step) for step in steps) or "the file"


def _demand_known_names(path: Path, case: Case) -> None:
    """Refuse a rule or a point about a variable or a term that there is not."""
    data = case.data
    where = f"{path.name}: case {case.name!r}"
    for name, term in _mentioned(data["rules"]):
        if term not in data["inputs"].get(name, {"terms": {}})["terms"]:
            raise SuiteError(f"{where}: a rule asks for {name} is {term}, which is not declared")
    for rule in data["rules"]:
        for name, term in rule["then"].items():
            if term not in data["outputs"].get(name, {"terms": {}})["terms"]:
                raise SuiteError(
                    f"{where}: a rule concludes {name} is {term}, which is not declared"
                )
    for point in data["points"]:
        if set(point["inputs"]) != set(data["inputs"]):
            raise SuiteError(
                f"{where}: a point must give {', '.join(data['inputs'])} and nothing else"
            )
        if set(point["expected"]) != set(data["outputs"]):
            raise SuiteError(
                f"{where}: a point must expect {', '.join(data['outputs'])} and nothing else"
            )


def _mentioned(part: Any) -> Iterator[tuple[str, str]]:
    """Yield the variable and the term of each proposition of rules."""
    if isinstance(part, list):
        for item in part:
            yield from _mentioned(item)
    elif isinstance(part, dict):
        for word, inner in part.items():
            if word == "is":
                yield inner[0], inner[1]
            elif word in {"if", "not", "very", "and", "or"}:
                yield from _mentioned(inner)


def read_all(
    folder: Path = CASES, number: Callable[[str], Any] | None = None, *, validated: bool = True
) -> list[Case]:
    """Return the cases of all files of a folder, in the order of their names.

    Raises
    ------
    SuiteError
        Where two cases have one name, or there is no case.
    """
    paths = sorted(folder.glob("*.json"))
    cases = [case for path in paths for case in read(path, number, validated=validated)]
    names = [case.name for case in cases]
    for name in names:
        if names.count(name) > 1:
            raise SuiteError(f"{folder.name}: two cases have the name {name!r}")
    if not cases:
        raise SuiteError(f"{folder.name}: there is no case")
    return cases
