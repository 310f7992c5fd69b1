"""The page on authoring: its pictures are there, its configurations can be read and work."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from needs import need

from fuzzyarm import check_text

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "howto" / "authoring.md").read_text("utf-8")


def _block(language: str) -> str:
    match = re.search(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)
    assert match is not None
    return match.group(1)


def test_every_picture_is_there() -> None:
    names = re.findall(r"!\[[^]]*\]\(([^)]+)\)", PAGE)
    assert len(names) >= 7
    for name in names:
        assert (
            (ROOT / "docs" / "howto" / name)
            .read_text("utf-8")
            .lstrip()
            .startswith(("<svg", "<?xml"))
        )


def test_the_configuration_of_helix_can_be_read() -> None:
    settings = tomllib.loads(_block("toml"))
    assert settings["language-server"]["fuzzyarm"] == {"command": "fuzzyarm", "args": ["lsp"]}
    assert {n for each in settings["language"] for n in each["file-types"]} == {"frb", "lut"}


@pytest.mark.slow
def test_the_configuration_of_neovim_works_as_written(tmp_path: Path) -> None:
    need("nvim")
    (tmp_path / "init.lua").write_text(_block("lua"), "utf-8")
    damaged = (ROOT / "rulebases" / "pd7.frb").read_text("utf-8").replace("PB\n  NM", "PX\n  NM")
    damaged = damaged.replace("ZE\n  NM", "ZX\n  NM")
    (tmp_path / "damaged.frb").write_text(damaged, "utf-8")
    wait = "vim.wait(120000, function() return #vim.diagnostic.get(0) > 0 end)"
    say = "for _, d in ipairs(vim.diagnostic.get(0)) do print(d.message) end"
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        ["nvim", "--headless", "-u", "init.lua", "damaged.frb", "-c", f"lua {wait}",
         "-c", f"lua {say}", "-c", "qa!"],
        cwd=tmp_path, env={**os.environ, "PATH": path}, capture_output=True, text=True,
        check=False, timeout=300,
    )  # fmt: skip
    messages = [found.message for found in check_text(damaged).diagnostics]
    assert messages
    assert all(message in done.stdout + done.stderr for message in messages)
