"""A report on one export for a safety case: provenance and tests."""

from typing import TYPE_CHECKING

from fuzzyarm.apps.dossier.contents import ExportReport, report_of, write_report
from fuzzyarm.base.lazy import lazily

__all__ = ["ExportReport", "report_of", "write_report"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
