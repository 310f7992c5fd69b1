"""Names of a user's that generated code has for itself: in every role, in every language."""

from __future__ import annotations

import re
import subprocess
import zipfile
from pathlib import Path
from xml.etree import ElementTree as Xml

import pytest
from budget import part
from c_programs import HOST
from hostile_names import ALL, OF_RULES, of_axes, of_gains, of_ports, of_rules, of_signals
from needs import requires
from own_tests import LANGUAGES, failing, tried_once  # noqa: F401

from fuzzyarm import shipped
from fuzzyarm.apps.cli import main

FILES = {
    "signals": of_signals(ALL),
    "gains": of_gains(ALL),
    "ports": of_ports(ALL[::4]),
    "axes": of_axes(part(ALL, 3)),
    **{f"rules_{k}": of_rules(names) for k, names in enumerate(OF_RULES)},
}


def exported(folder: Path, suffix: str) -> list[Path]:
    """Return the files, exported."""
    paths = []
    for name, text in FILES.items():
        source = folder / f"{name}.frb"
        source.write_text(text, "utf-8")
        paths.append(folder / f"{name}{suffix}")
        direct = ["--direct"] if name.startswith("rules") else []
        words = ["compile", str(source), "-o", str(paths[-1]), "--precision", "float64", *direct]
        assert main(words) == 0, name
    return paths


@pytest.mark.slow(seconds=15)
@pytest.mark.usefixtures("tried_once")
def test_in_each_language(tmp_path):
    for suffix in LANGUAGES:
        assert failing(exported(tmp_path, suffix), tmp_path) == [], suffix


@pytest.mark.slow
@requires("C compiler")
def test_in_a_folder_for_a_board(tmp_path):
    for name, text in FILES.items():
        source, folder = tmp_path / f"{name}.frb", tmp_path / name
        source.write_text(text, "utf-8")
        words = ["compile", str(source), "--for", "arduino", "--board", "esp32", "-o", str(folder)]
        assert main(words) == 0, name
        sources = sorted(folder.rglob("*.c"))
        headers = "".join(path.read_text("utf-8") for path in folder.rglob("*.h"))
        (test,) = set(re.findall(r"int (\w+_self_test)\(void\)", headers))
        entry = tmp_path / f"{name}_main.c"
        entry.write_text(f"int {test}(void);\nint main(void) {{ return {test}(); }}\n")
        program = tmp_path / f"{name}_test"
        words = [HOST, "-std=c99", "-ffp-contract=off", *map(str, sources), str(entry), "-lm"]
        subprocess.run([*words, "-o", str(program)], check=True)
        assert subprocess.run([program], check=False).returncode == 0, name


@pytest.mark.slow
@requires("C compiler")
def test_in_a_unit(tmp_path):
    for name in ("signals", "gains", "ports", "axes"):
        source, unit = tmp_path / f"{name}.frb", tmp_path / f"{name}.fmu"
        source.write_text(FILES[name], "utf-8")
        assert main(["compile", str(source), "-o", str(unit)]) == 0, name
        with zipfile.ZipFile(unit) as archive:
            root = Xml.fromstring(archive.read("modelDescription.xml"))
        names = [each.get("name") for each in root.iter("ScalarVariable")]
        assert len(names) == len(set(names)) > 10


BESIDE = ("F_next", "F_visits", "F_ring", "F_values", "first", "F_2", "next", "values")


@pytest.mark.slow
def test_signals_beside_a_table_that_learns(tmp_path):
    lines = "".join(f"  {name} = change of e\n" for name in BESIDE)
    text = shipped("soc-zero.frb").read_text("utf-8")
    text = text.replace('"performance-yamazaki.lut"', f'"{shipped("performance-yamazaki.lut")}"')
    text = text.replace("  count =", f"{lines}  count =").replace("axis joint1, joint2", "axis a")
    text = text.replace("supply / 255", f"supply / 255 + {' + '.join(BESIDE)}")
    source = tmp_path / "made.frb"
    source.write_text(text)
    for suffix in LANGUAGES:
        made = tmp_path / f"made{suffix}"
        assert main(["compile", str(source), "-o", str(made), "--precision", "float64"]) == 0
        assert failing([made], tmp_path) == []
