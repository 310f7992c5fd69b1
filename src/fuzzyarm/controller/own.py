"""Controllers in a Python file of the user's."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from fuzzyarm.controller.catalogue import (
    CATALOGUE,
    NONE_GIVEN,
    Choice,
    Sources,
    Start,
    Variant,
    controller,
    entries_of,
    require_taken,
    text_controller,
)
from fuzzyarm.controller.controller import Controller, Sum
from fuzzyarm.errors import FuzzyarmError
from fuzzyarm.plant.own import USERS, executed, failure
from fuzzyarm.plant.setting import Clock, Pair, Reference, State


class OwnControllerError(FuzzyarmError, RuntimeError):
    """A controller in a user's file cannot be loaded or failed; `path` is the file."""

    def __init__(self, message: str, *, path: str, hint: str = "") -> None:
        super().__init__(message, hint=hint)
        self.path = path


def find_controller(
    name: str,
    *,
    start: Start = "warm",
    variant: Variant = "as-printed",
    sources: Sources = NONE_GIVEN,
) -> Controller:
    """Make a controller from a name, a file, or a sum of both.

    Parameters
    ----------
    name : str
        Names of the catalogue, ``FILE.frb``, ``FILE.py`` or ``FILE.py:CLASS``, with plus signs
        between.
    start, variant, sources
        See :func:`fuzzyarm.controller.catalogue.controller`.

    Raises
    ------
    UnknownControllerError
        For a name that is none.
    SourceError
        If a rule base or a table does not serve, or nothing reads it.
    OwnControllerError
        For a file without a usable controller.
    """
    choice = Choice(start, variant, sources)
    if name.endswith(".frb"):
        return text_controller(name, choice)
    if name in CATALOGUE or not _is_file(name):
        return controller(name, start=start, variant=variant, sources=sources)
    words = [part.strip() for part in name.split("+")]
    known = [entry for word in words if not _is_file(word) for entry in entries_of(word)]
    if not any(word.endswith(".frb") for word in words):
        require_taken(name, known, sources)
    parts = [_part(word, choice) for word in words]
    return parts[0] if len(parts) == 1 else Sum(parts)


def _is_file(word: str) -> bool:
    return ".py" in word or ".frb" in word


def _part(word: str, choice: Choice) -> Controller:
    if word.endswith(".frb"):
        return text_controller(word, choice)
    return load_own(word) if ".py" in word else entries_of(word)[0].make(choice)


def load_own(place: str) -> Controller:
    """Load ``FILE.py`` or ``FILE.py:CLASS``; the file is executed.

    Raises
    ------
    OwnControllerError
        If the file cannot be read or run, or has no such controller.
    """
    path, _, wanted = place.partition(":")
    module = executed(path, _fault(path))
    found = {
        key: value
        for key, value in vars(module).items()
        if isinstance(value, type)
        and issubclass(value, Controller)
        and value.__module__ == module.__name__
    }
    if wanted and wanted not in found:
        names = ", ".join(found) or "none"
        raise OwnControllerError(
            f"{path} has no controller '{wanted}'", path=path, hint=f"its controllers: {names}"
        )
    if not wanted and len(found) != 1:
        hint = f"name one, as in {path}:{next(iter(found))}" if found else ""
        message = f"{path} has {len(found) or 'no'} classes derived from Controller"
        raise OwnControllerError(message, path=path, hint=hint)
    made = _guarded(path, found[wanted] if wanted else next(iter(found.values())))
    if made.name == Controller.name:
        made.name = Path(path).stem
    return Guarded(made, path)


class Guarded(Controller):
    """A user's controller whose exceptions become one clear sentence."""

    def __init__(self, inner: Controller, path: str) -> None:
        self.inner = inner
        self.path = path
        self.name = inner.name

    def start(self, single: bool = False) -> None:
        """Start the user's controller."""
        try:
            self.inner.start(single)
        except USERS as error:
            raise _failure(self.path, error) from error

    def torque(self, reference: Reference, state: State, clock: Clock) -> Pair:
        """Ask the user's controller."""
        try:
            first, second = self.inner.torque(reference, state, clock)
            return float(first), float(second)
        except USERS as error:
            raise _failure(self.path, error) from error


def _fault(path: str) -> Callable[[str], OwnControllerError]:
    return lambda message: OwnControllerError(message, path=path)


def _guarded(path: str, kind: type[Controller]) -> Controller:
    try:
        return kind()
    except USERS as error:
        raise _failure(path, error) from error


def _failure(path: str, error: BaseException) -> OwnControllerError:
    return OwnControllerError(failure(path, error), path=path)
