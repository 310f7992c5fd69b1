"""A watched file: its text, its findings and its last good scene."""

from __future__ import annotations

import os
from pathlib import Path

from fuzzyarm.apps.lsp.session import Session
from fuzzyarm.apps.lsp.tables import TableText
from fuzzyarm.apps.watch.scenes import RulebaseScene, TableScene, WatchScene
from fuzzyarm.base.diagnostic import Diagnostic
from fuzzyarm.base.errors import FuzzyarmError
from fuzzyarm.base.folders import READABLE
from fuzzyarm.base.names import typed
from fuzzyarm.language import read_text

SUFFIXES = (".frb", ".lut")


class NotShownError(FuzzyarmError, ValueError):
    """A file of a kind that cannot be watched.

    Attributes
    ----------
    path : str
        The file.
    """

    def __init__(self, path: str) -> None:
        foreign = Path(path).suffix.lower() in READABLE
        converted = f"{Path(path).stem}.frb"
        hint = f"fuzzyarm convert {typed(path)} {typed(converted)} brings it in" if foreign else ""
        super().__init__(f"{path} is neither a .frb nor a .lut file", hint=hint)
        self.path = path


class WatchedFile:
    """A file, its findings and its scene.

    Parameters
    ----------
    path : path-like
        A ``.frb`` or ``.lut`` file.

    Attributes
    ----------
    session : Session
        The text and its findings, as in the language server.
    scene : WatchScene or None
        Of the last text without errors; None until there has been one.
    is_current : bool
        Whether `scene` is that of the present text.

    Raises
    ------
    NotShownError
        If the file is neither.
    OSError, RuleBaseError
        If it cannot be read.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = os.fspath(path)
        if Path(self.path).suffix.lower() not in SUFFIXES:
            raise NotShownError(self.path)
        self.scene: WatchScene | None = None
        self.is_current = False
        self.session = Session(self.path, read_text(self.path))
        self.update(self.session.text)

    @property
    def text(self) -> str:
        """The present text."""
        return self.session.text

    @property
    def findings(self) -> tuple[Diagnostic, ...]:
        """The findings of `fuzzyarm check`."""
        return self.session.review().diagnostics

    @property
    def summary(self) -> str:
        """How many findings there are of each severity."""
        return self.session.review().summary

    @property
    def broken(self) -> bool:
        """Whether the text has errors."""
        return self.session.review().failed

    def update(self, text: str) -> None:
        """Set a new text; a sound one has a new scene."""
        self.session.replace(text)
        scene = self._scene()
        self.is_current = scene is not None
        self.scene = scene or self.scene

    def _scene(self) -> WatchScene | None:
        reading = self.session.reading
        if isinstance(reading, TableText):
            from fuzzyarm.table import LookupTable

            plain = reading.parsed.table
            if plain is None:
                return None
            return TableScene(LookupTable.from_plain(plain), self.scene)
        rulebase = self.session.review().rulebase
        # Contradictions and failed expectations are errors, but the rules can be shown.
        if rulebase is None or not rulebase.inputs:
            return None
        return RulebaseScene(rulebase, self.scene, self.session.verdicts)
