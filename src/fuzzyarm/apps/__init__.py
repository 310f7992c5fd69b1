"""User-facing programs and drawings. Nothing imports this room.

Read ``cli/main.py`` first (a command is a record), then ``designer/__init__.py``.

cli
    The command ``fuzzyarm``, a module for each command.
designer, playground, lsp
    The page with a server, the page without one, the server for editors.
show, watch, notebook
    Drawings in terminal, figures and notebooks; a terminal that follows a file.
builder, estimators
    Rule bases written in Python; estimators of scikit-learn.
study, dossier, grading
    The published experiments, the safety case, marks for exercises.
native
    Builds the machine code of the kernels.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily

if TYPE_CHECKING:
    from fuzzyarm.apps import builder as builder
    from fuzzyarm.apps import designer as designer
    from fuzzyarm.apps import estimators as estimators
    from fuzzyarm.apps import grading as grading
    from fuzzyarm.apps import notebook as notebook
    from fuzzyarm.apps import show as show
    from fuzzyarm.apps import study as study

__all__ = ["builder", "designer", "estimators", "grading", "notebook", "show", "study"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, (), __all__)
