"""Checks that know fuzzy control: what is allowed but probably not meant."""

from fuzzyarm.language.check.registry import CHECKS, Check, check, judged

__all__ = ["CHECKS", "Check", "check", "judged"]
