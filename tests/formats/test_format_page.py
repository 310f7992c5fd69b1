"""The page on formats knows every finding by name."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
CALL = re.compile(r"\b(?:error|warn|info|loss|unknown|duplicate)\(\s*\"([a-z0-9-]+)\"")


def test_every_finding_is_explained() -> None:
    page = (ROOT / "docs" / "reference" / "formats.md").read_text(encoding="utf-8")
    explained = set(re.findall(r"`([a-z0-9-]+)`", page.partition("## Findings by name")[2]))
    sources = (ROOT / "src" / "fuzzyarm" / "exchange" / "formats").rglob("*.py")
    names = {n for path in sources for n in CALL.findall(path.read_text(encoding="utf-8"))}
    assert len(names) > 60
    assert names - explained == set()
