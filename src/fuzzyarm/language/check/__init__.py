"""Checks with knowledge of fuzzy control: legal but probably unintended."""

from typing import TYPE_CHECKING

from fuzzyarm.base.lazy import lazily
from fuzzyarm.language.check.registry import CHECKS, Check, check, judged

__all__ = ["CHECKS", "Check", "check", "judged"]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily(__name__, {}, __all__)
