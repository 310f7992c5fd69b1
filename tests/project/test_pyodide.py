"""`pip install fuzzyarm` in a page: every requirement has a wheel there."""

import json
import tomllib
from importlib.metadata import distribution
from pathlib import Path

from needs import requires
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]
LOCK = ROOT / "editors/designer/node_modules/pyodide/pyodide-lock.json"
PAGE = {
    "sys_platform": "emscripten", "platform_system": "Emscripten", "os_name": "posix",
    "platform_machine": "wasm32", "implementation_name": "cpython", "extra": "",
}  # fmt: skip


def wanted():
    """Return what a page installs."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    needs = map(Requirement, project["dependencies"])
    return [need for need in needs if need.marker is None or need.marker.evaluate(PAGE)]


def is_pure(name):
    """Whether the wheel of a package serves everywhere."""
    return "Tag: py3-none-any" in (distribution(name).read_text("WHEEL") or "")


@requires("pyodide")
def test_every_requirement_has_a_wheel_in_a_page():
    known = json.loads(LOCK.read_text(encoding="utf-8"))["packages"]
    missing = []
    for need in wanted():
        package = known.get(need.name.lower())
        if package is not None:
            if not need.specifier.contains(package["version"]):
                missing.append(f"{need}: the page has {package['version']}")
            missing += [f"{need}: {each}" for each in package["depends"] if each not in known]
        elif not is_pure(need.name):
            missing.append(f"{need}: no wheel")
    assert missing == []


def test_what_serves_is_not_wanted_in_a_page():
    names = {need.name for need in wanted()}
    assert not names & {"starlette", "uvicorn", "websockets"}
    assert {"numpy", "scipy", "matplotlib", "rich"} <= names
