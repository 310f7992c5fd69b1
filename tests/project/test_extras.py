"""What a missing extra does, and the line that installs it: it works where it is told."""

import json
import os
import re
import subprocess
import sys
import textwrap
import tomllib
from pathlib import Path

import pytest

import fuzzyarm
from fuzzyarm.base import extras
from fuzzyarm.base.errors import MissingExtraError, demand_extra

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
PACKAGES = (
    "cma", "control", "dask", "distributed", "fmpy", "gymnasium", "loky", "mujoco", "pandas",
    "numba", "onnx", "pyarrow", "pygls", "lsprotocol", "sklearn", "textual", "xarray",
    "ziglang",
)  # fmt: skip
"""What the extras bring, as it is imported."""

WITHOUT_EXTRAS = f"""
import sys

class Nothing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {PACKAGES}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, Nothing())
import importlib.util
find_spec = importlib.util.find_spec
importlib.util.find_spec = lambda name, package=None: (
    None if name.partition(".")[0] in {PACKAGES} else find_spec(name, package)
)
"""
"""Has a Python that knows none of them."""


def without_extras(code):
    """Return what a program prints where no extra is installed."""
    text = WITHOUT_EXTRAS + textwrap.dedent(code)
    done = subprocess.run(
        [sys.executable, "-c", text], capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_list_of_packages_is_that_of_the_extras():
    asked = {
        re.match(r"[\w.-]+", line)[0].lower()
        for lines in PROJECT["optional-dependencies"].values()
        for line in lines
    }
    named = {"scikit-learn": "sklearn"}
    assert {named.get(name, name) for name in asked} <= set(PACKAGES)


def test_a_name_without_its_extra_is_no_attribute():
    told = without_extras("""
        import fuzzyarm
        print(hasattr(fuzzyarm.apps, "estimators"), getattr(fuzzyarm.apps, "estimators", "nothing"))
        try:
            fuzzyarm.apps.estimators
        except AttributeError as error:
            print(error)
        for word in ("import fuzzyarm.apps.estimators", "from fuzzyarm.apps import estimators"):
            try:
                exec(word)
            except ImportError as error:
                print(type(error).__name__, error.extra)
    """)
    first, second, *others = told.splitlines()
    assert first == "False nothing"
    assert second == f"fuzzyarm.apps.estimators needs an extra: {extras.installing('data')}"
    assert others == ["MissingExtraError data"] * 2


def test_help_and_completion_need_no_extra():
    told = without_extras("""
        import pydoc, rlcompleter
        import fuzzyarm
        print(pydoc.plain(pydoc.render_doc(fuzzyarm)))
        complete = rlcompleter.Completer({"fuzzyarm": fuzzyarm}).complete
        print("COMPLETED", complete("fuzzyarm.infe", 0), complete("fuzzyarm.sk", 0))
    """)
    assert "Evaluate a rule base." in told
    assert len(told.splitlines()) > 80
    assert re.search(r"(?m)^COMPLETED fuzzyarm.infe", told)


def test_every_public_name_is_there_without_extras():
    """Of all packages; what lacks its extra is nowhere an error of importing."""
    told = without_extras("""
        import importlib, inspect, pkgutil
        import fuzzyarm
        lacking = []
        for name in ("fuzzyarm", *(f"fuzzyarm.{each}" for each in fuzzyarm.PACKAGES)):
            try:
                module = importlib.import_module(name)
            except ImportError as error:
                lacking.append((name, error.extra))
                continue
            inspect.getmembers(module)
            lacking += [(name, each) for each in dir(module) if not hasattr(module, each)]
        print(lacking)
    """)
    expected = [("fuzzyarm.apps", "estimators")]
    assert told.strip() == str(expected)


@pytest.mark.parametrize("ask", ["Run", "Many"])
def test_a_data_frame_names_its_extra(ask, monkeypatch):
    from fuzzyarm.control import loop

    result = object.__new__(getattr(loop, ask))
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(MissingExtraError, match="a DataFrame needs an extra"):
        result.frame()


def test_a_parquet_file_names_its_extra(monkeypatch, tmp_path):
    from fuzzyarm.learning import DataError, read_samples

    monkeypatch.setattr("importlib.util.find_spec", lambda name: name != "pyarrow" or None)
    with pytest.raises(DataError) as caught:
        read_samples(tmp_path / "x.parquet")
    assert caught.value.diagnostics[0].hint == extras.installing("data")


def test_in_a_clone_pip_is_given_the_clone(monkeypatch, tmp_path):
    monkeypatch.setattr(extras, "_pip", lambda: "pip")
    monkeypatch.chdir(ROOT)
    assert extras.installing("lsp") == 'pip install -e ".[lsp]"'
    monkeypatch.chdir(tmp_path)
    assert extras.installing("lsp") == f'pip install -e "{ROOT}[lsp]"'
    with pytest.raises(MissingExtraError, match=r"a thing needs an extra: pip install -e "):
        demand_extra("no_such_library", "lsp", "a thing")


@pytest.fixture
def elsewhere(monkeypatch, tmp_path):
    """fuzzyarm as it is in site-packages; `record` says where it was installed from."""
    monkeypatch.setattr(extras, "__file__", str(tmp_path / "site" / "fuzzyarm" / "extras.py"))
    monkeypatch.setattr(extras, "_pip", lambda: "pip")

    class Distribution:
        record = None

        def read_text(self, name):
            assert name == "direct_url.json"
            return self.record and json.dumps(self.record)

    lines = ["numpy>=2.0", "pygls>=2.0; extra == 'lsp'", 'a; extra == "two"', "b;extra=='two'"]
    monkeypatch.setattr(extras, "distribution", lambda name: Distribution())
    monkeypatch.setattr(extras, "requires", lambda name: lines)
    return Distribution


def test_what_came_from_a_clone_that_is_still_there_names_it(elsewhere, tmp_path):
    clone = tmp_path / "a clone"
    (clone / "src" / "fuzzyarm").mkdir(parents=True)
    (clone / "pyproject.toml").write_text("")
    elsewhere.record = {"url": clone.as_uri(), "dir_info": {}}
    assert extras.installing("lsp") == f'pip install "{clone}[lsp]"'
    (clone / "pyproject.toml").unlink()
    assert extras.installing("lsp") == 'pip install "pygls>=2.0"'


def test_what_came_from_an_archive_names_what_the_extra_asks_for(elsewhere):
    elsewhere.record = {"url": "file:///x.whl", "archive_info": {}}
    assert extras.installing("two") == 'pip install "a" "b"'
    elsewhere.record = None
    assert extras.installing("lsp") == 'pip install "pygls>=2.0"'


def test_pip_is_called_as_the_shell_knows_it(monkeypatch, tmp_path):
    folder = tmp_path / "env" / "bin"
    folder.mkdir(parents=True)
    monkeypatch.setattr(extras.sys, "executable", str(folder / "python"))
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    python = os.path.join("env", "bin", "python")
    monkeypatch.setattr(extras, "find_spec", lambda name: None)  # as in an environment of uv
    assert extras.installing("lsp").startswith(f"uv pip install --python {python} -e ")
    monkeypatch.setattr(extras, "find_spec", lambda name: object())
    assert extras.installing("lsp").startswith(f"{python} -m pip install -e ")
    monkeypatch.chdir(folder)
    assert extras.installing("lsp").startswith(f"{folder / 'python'} -m pip install -e ")
    (folder / "pip").write_text("")
    (folder / "pip").chmod(0o755)
    monkeypatch.setenv("PATH", str(folder))
    assert extras.installing("lsp").startswith("pip install -e ")


def test_no_hint_asks_an_index_for_fuzzyarm():
    """It is on none: pip ends in an error, or brings somebody else's program."""
    texts = [*(ROOT / "src").rglob("*.py"), *(ROOT / "src").rglob("*.js"), ROOT / "README.md"]
    texts += [*(ROOT / "docs").rglob("*.md"), *(ROOT / "editors" / "vscode").glob("*.md")]
    texts += [*(ROOT / "editors" / "vscode" / "src").glob("*.ts"), ROOT / "Makefile"]
    asks = re.compile(r"fuzzyarm\[(?!.*@ file:)|pip install ['\"]?fuzzyarm\b(?!\[)")
    asking = {str(path.relative_to(ROOT)) for path in texts if asks.search(path.read_text("utf-8"))}
    assert asking == {"src/fuzzyarm/base/extras.py"}  # which says why not


def test_the_page_on_installing_lists_all_extras():
    page = (ROOT / "docs" / "howto" / "install.md").read_text("utf-8")
    rows = re.findall(r"(?m)^\| `(\w+)` \|", page)
    assert sorted(rows) == sorted(PROJECT["optional-dependencies"])


def test_the_designer_needs_no_extra():
    needs = " ".join(PROJECT["dependencies"])
    assert all(name in needs for name in ("starlette", "uvicorn", "websockets"))
    assert PROJECT["optional-dependencies"]["designer"] == []
    locked = (ROOT / "requirements" / "run.lock").read_text("utf-8")
    names = {re.match(r"[\w.-]+", line)[0] for line in PROJECT["dependencies"]}
    assert names <= set(re.findall(r"(?m)^([\w.-]+)==", locked))


@pytest.mark.parametrize("name", ["run", "build", "dev"])
def test_a_lock_file_names_no_place(name):
    text = (ROOT / "requirements" / f"{name}.lock").read_text("utf-8")
    line = r"[\w.-]+==[\w.+!-]+( ; [^\\]+)? \\|    --hash=sha256:[0-9a-f]{64}( \\)?"
    assert [each for each in text.splitlines() if not re.fullmatch(line, each)] == []


def test_the_version_is_there_without_anything():
    assert without_extras("import fuzzyarm; print(fuzzyarm.__version__)").strip() == (
        fuzzyarm.__version__
    )
