"""Controllers in a Python file of the user's."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path

from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.value_kinds import wrong_kind
from fuzzyarm.control.controllers.catalogue import (
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
from fuzzyarm.control.controllers.controller import Controller, Sum
from fuzzyarm.control.controllers.files import TEXT, kind_by_suffix
from fuzzyarm.plant.equations import USERS
from fuzzyarm.plant.own import executed, failure
from fuzzyarm.plant.setting import Clock, Pair, Reference, State


class OwnControllerError(FuzzyarmError, RuntimeError):
    """A controller in a user's file cannot be loaded or failed; `path` is the file."""

    def __init__(self, message: str, *, path: str, hint: str = "") -> None:
        super().__init__(message, hint=hint)
        self.path = path


def find_controller(
    name: str | os.PathLike[str],
    *,
    start: Start = "warm",
    variant: Variant = "as-printed",
    sources: Sources = NONE_GIVEN,
) -> Controller:
    """Make a controller from a name, a file, or a sum of both.

    Parameters
    ----------
    name : str or path-like
        Names of the catalogue, ``FILE.frb``, ``FILE.py`` or ``FILE.py:CLASS``, with plus signs
        between.
    start, variant, sources
        See :func:`fuzzyarm.control.controllers.catalogue.controller`.

    Raises
    ------
    UnknownControllerError
        For an unknown name.
    SourceError
        If a rule base or a table does not fit, or is not used.
    OwnControllerError
        For a file without a usable controller.
    WrongKindError
        For a rule base or a table.
    """
    if not isinstance(name, str | os.PathLike):
        raise wrong_kind(name, "name of a controller")
    name = os.fspath(name)
    choice = Choice(start, variant, sources)
    words = [part.strip() for part in name.split("+")]
    if name in CATALOGUE or not any(map(_is_file, words)):
        return controller(name, start=start, variant=variant, sources=sources)
    # The name of a single file may contain a plus sign.
    if len(words) == 1 or Path(name).exists() or not all(map(_is_there, words)):
        return _part(name, choice)
    entries = [entry for word in words if not _is_file(word) for entry in entries_of(word)]
    if not any(map(_is_text, words)):
        require_taken(name, entries, sources)
    return Sum([_part(word, choice) for word in words])


def find_controllers(
    names: Sequence[str],
    *,
    start: Start = "warm",
    variant: Variant = "as-printed",
    sources: Sources = NONE_GIVEN,
) -> list[Controller]:
    """Make several controllers; equal names of files are made distinct."""
    controllers = [find_controller(n, start=start, variant=variant, sources=sources) for n in names]
    name_apart(names, controllers)
    return controllers


def name_apart(names: Sequence[str], controllers: Sequence[Controller]) -> None:
    """Give controllers of one name distinct names: the ends of their paths."""
    names_by_law: dict[str, set[str]] = {}
    for name, law in zip(names, controllers, strict=True):
        names_by_law.setdefault(law.name, set()).add(name)
    for name, law in zip(names, controllers, strict=True):
        others = names_by_law[law.name]
        if len(others) > 1 and name != law.name:
            law.name = f"{law.name} ({_shortest(name, others)})"


def _shortest(path: str, others: Collection[str]) -> str:
    """Return the shortest end of a path that distinguishes it from the others."""
    parts = Path(path).parts
    for count in range(1, len(parts)):
        if all(other == path or Path(other).parts[-count:] != parts[-count:] for other in others):
            return str(Path(*parts[-count:]))
    return path


def _is_file(word: str) -> bool:
    return ".py" in word or _is_text(word) or bool(kind_by_suffix(word))


def _is_text(word: str) -> bool:
    return word.lower().endswith(TEXT)


def _is_there(word: str) -> bool:
    """Whether a word can be an addend of a sum: an existing file, or not a file name."""
    return ".py" in word or not _is_file(word) or Path(word).exists()


def _part(word: str, choice: Choice) -> Controller:
    if _is_text(word) or kind_by_suffix(word):
        return text_controller(word, choice)
    return load_own(word) if ".py" in word else entries_of(word)[0].make(choice)


def load_own(place: str) -> Controller:
    """Load ``FILE.py`` or ``FILE.py:CLASS``; the file is executed."""
    path, _, class_name = place.partition(":")
    module = executed(path, _fault(path))
    # Only classes defined in the file: it may import others, such as Controller.
    classes = {
        key: value
        for key, value in vars(module).items()
        if isinstance(value, type)
        and issubclass(value, Controller)
        and value.__module__ == module.__name__
    }
    if class_name and class_name not in classes:
        names = ", ".join(classes) or "none"
        raise OwnControllerError(
            f"{path} has no controller '{class_name}'", path=path, hint=f"its controllers: {names}"
        )
    if not class_name and len(classes) != 1:
        hint = f"name one, as in {path}:{next(iter(classes))}" if classes else ""
        message = f"{path} has {len(classes) or 'no'} classes derived from Controller"
        raise OwnControllerError(message, path=path, hint=hint)
    controller = _guarded(path, classes[class_name] if class_name else next(iter(classes.values())))
    if controller.name == Controller.name:
        controller.name = Path(path).stem
    return GuardedController(controller, path)


class GuardedController(Controller):
    """A user's controller, with exceptions turned into one clear sentence."""

    def __init__(self, inner: Controller, path: str) -> None:
        # Copied: the base class would give its own defaults.
        self.inner = inner
        self.path = path
        self.name, self.period, self.every = inner.name, inner.period, inner.every

    @property
    def takes_ports(self) -> bool:
        """Whether the user's controller has a step."""
        return self.inner.takes_ports

    def step(
        self, measured: Mapping[str, float], reference: Mapping[str, float]
    ) -> Mapping[str, float] | float:
        """Call the user's controller."""
        try:
            return self.inner.step(measured, reference)
        except USERS as error:
            raise _failure(self.path, error) from error

    def start(self, single: bool = False) -> None:
        """Start the user's controller."""
        try:
            self.inner.start(single)
        except USERS as error:
            raise _failure(self.path, error) from error

    def torque(self, reference: Reference, state: State, clock: Clock) -> Pair:
        """Call the user's controller."""
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
