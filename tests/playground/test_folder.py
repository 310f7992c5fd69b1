"""The folder of a playground, and what it refuses."""

import ast
import gzip
import io
import json
import shutil
import zipfile
from collections.abc import Iterator

import pytest

from fuzzyarm.apps.cli import playground as command
from fuzzyarm.apps.cli.main import main
from fuzzyarm.apps.playground import folder as written
from fuzzyarm.apps.playground import memory
from fuzzyarm.apps.playground.folder import BEGIN_WITH, FILES, archive, write_playground
from fuzzyarm.apps.playground.memory import python_memory


@pytest.fixture
def pyodide(tmp_path):
    """Something that looks like Pyodide."""
    folder = tmp_path / "pyodide"
    folder.mkdir()
    for name in FILES:
        (folder / name).write_text(name, encoding="utf-8")
    (folder / "package.json").write_text('{"version": "314.0.7"}', encoding="utf-8")
    return folder


@pytest.mark.slow
def test_the_folder_has_all_that_the_page_asks_for(tmp_path, pyodide):
    made = write_playground(
        tmp_path / "site", pyodide=pyodide, kernels=lambda: b"wasm", memory=lambda _parts: b"all"
    )
    files = {path.relative_to(made.folder).as_posix() for path in made.folder.rglob("*.*")}
    assert made.count == len(files)
    assert {
        "index.html",
        "playground.js",
        "page.css",
        "python.js",
        "start.js",
        "offline.js",
    } <= files
    python = {f"python/{name}" for name in (*FILES, "fuzzyarm.zip", "_kernels.so", "memory.bin")}
    assert python <= files
    assert gzip.decompress((made.folder / "python/memory.bin").read_bytes()) == b"all"
    page = (made.folder / "index.html").read_text(encoding="utf-8")
    start = json.loads(page.split('id="start">')[1].split("</script>")[0])
    assert sorted(start["texts"]) == sorted(BEGIN_WITH)
    assert start["python"] == {"kernels": True, "numpy": "", "memory": 3}
    assert "default-src &#x27;none&#x27;" in page
    offline = (made.folder / "offline.js").read_text(encoding="utf-8")
    listed = json.loads(offline.split("/** @type {any} */ (")[2].split(");")[0])
    assert set(listed) == files - {"offline.js"} | {"./"}


@pytest.mark.slow
def test_the_same_sources_make_the_same_folder(tmp_path, pyodide):
    folders = [tmp_path / "one", tmp_path / "two"]
    for folder in folders:
        write_playground(folder, pyodide=pyodide)
    names = [path.relative_to(folders[0]) for path in folders[0].rglob("*.*")]
    assert all((folders[0] / n).read_bytes() == (folders[1] / n).read_bytes() for n in names)


def test_a_wheel_of_numpy_beside_pyodide_is_taken(tmp_path, pyodide):
    (pyodide / "numpy-2.4.6-cp314-cp314-pyemscripten_2026_0_wasm32.whl").write_bytes(b"")
    made = write_playground(tmp_path / "site", pyodide=pyodide, memory=python_memory)
    assert len(list(made.folder.glob("python/numpy-*.whl"))) == 1
    assert made.no_memory == "a memory of Python cannot hold NumPy's machine code"
    assert "python/numpy-2.4.6" in (made.folder / "index.html").read_text(encoding="utf-8")


def test_the_archive_has_what_a_page_runs_and_no_machine_code():
    names = zipfile.ZipFile(io.BytesIO(archive())).namelist()
    assert {"fuzzyarm/apps/playground/host.py", "fuzzyarm/shipped/pd7.frb"} <= set(names)
    assert not [name for name in names if name.startswith("fuzzyarm/apps/cli/") or ".so" in name]


def test_files_of_ones_own_are_what_a_visitor_finds(tmp_path, pyodide, capsys, monkeypatch):
    monkeypatch.setattr(written, "wasm_kernels", lambda: None)
    monkeypatch.setattr(written, "why_it_does_not_load", lambda _archive: "")
    mine = tmp_path / "mine.frb"
    mine.write_text('rulebase mine "</script>"\n', encoding="utf-8")
    words = ["playground", "-o", str(tmp_path / "site"), "--pyodide", str(pyodide), str(mine)]
    assert main(words) == 0
    said = capsys.readouterr()
    assert "python -m http.server --directory" in said.out
    assert "without machine code" in said.err
    page = (tmp_path / "site/index.html").read_text(encoding="utf-8")
    assert "mine.frb" in page
    assert page.count("</script>") == 2


@pytest.mark.slow
def test_the_compiler_is_asked_for_and_installed(tmp_path, pyodide, capsys, monkeypatch):
    words = ["playground", "-o", str(tmp_path / "site"), "--pyodide", str(pyodide)]
    installed, asked = [], []
    monkeypatch.setattr(written, "wasm_kernels", lambda: b"wasm" if installed else None)
    monkeypatch.setattr(command, "find_spec", lambda name: None)
    monkeypatch.setattr(command, "install", lambda missing: installed.append(missing) or "")
    monkeypatch.setattr(command, "installed_program", lambda name: name == "node" or None)
    assert main(words) == 0  # nobody is there to be asked
    assert "without machine code" in capsys.readouterr().err
    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    monkeypatch.setattr("builtins.input", lambda text: asked.append(text) or "n")
    assert main(words) == 0
    assert installed == []
    monkeypatch.setattr("builtins.input", lambda text: asked.append(text) or "y")
    assert main(words) == 0
    assert (len(asked), installed) == (2, [[command.ZIG]])
    assert '"kernels":true' in (tmp_path / "site/index.html").read_text(encoding="utf-8")
    assert main([*words, "--install"]) == 0
    assert (len(asked), len(installed)) == (2, 2)
    monkeypatch.setattr(command, "install", lambda missing: "no network")
    assert main([*words, "--install"]) == 1
    assert "ziglang: not installed: no network" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["a.fis"], "a.fis is neither a .frb nor a .lut file"),
        (["a.frb"], "a.frb"),
        (["x.frb", "sub/x.frb"], "two files are called x.frb"),
        (["binary.frb"], "binary.frb"),
    ],
)
def test_files_that_are_not_taken_are_said(words, said, tmp_path, pyodide, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sub").mkdir()
    for name in ("x.frb", "sub/x.frb"):
        (tmp_path / name).write_text("rulebase x\n", encoding="utf-8")
    (tmp_path / "binary.frb").write_bytes(b"\xff\xfe\x00\x80" * 9)
    assert main(["playground", "-o", "site", "--pyodide", str(pyodide), *words]) == 1
    err = capsys.readouterr().err
    assert said in err
    assert "Traceback" not in err
    assert not (tmp_path / "site").exists()


def test_a_folder_without_pyodide_is_said(tmp_path, pyodide, capsys):
    empty = tmp_path / "empty"
    (empty / "node_modules").mkdir(parents=True)
    pyodide.rename(empty / "node_modules/pyodide")
    assert main(["playground", "-o", str(tmp_path / "s"), "--pyodide", str(empty)]) == 1
    err = capsys.readouterr().err
    assert "does not have pyodide.mjs of Pyodide" in err
    assert "node_modules/pyodide" in err


def test_an_old_pyodide_is_said(tmp_path, pyodide, capsys):
    (pyodide / "package.json").write_text('{"version": "0.26.4"}', encoding="utf-8")
    assert main(["playground", "-o", str(tmp_path / "s"), "--pyodide", str(pyodide)]) == 1
    assert "has Pyodide 0.26; at least 314.0 is needed" in capsys.readouterr().err


def test_without_npm_a_copy_is_asked_for(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(written, "installed_program", lambda name: None)
    assert main(["playground", "-o", str(tmp_path / "s")]) == 1
    assert capsys.readouterr().err == (
        "fuzzyarm: Pyodide is fetched by npm, which is not installed (--install brings it,"
        " --pyodide FOLDER uses an existing copy)\n"
    )


@pytest.mark.parametrize(
    ("programs", "fetches", "missing"),
    [
        (set(), True, [command.ZIG, command.NODE]),
        ({"node"}, True, [command.ZIG, command.NODE]),
        ({"node"}, False, [command.ZIG]),
        ({"node", "npm"}, True, [command.ZIG]),
    ],
)
def test_node_is_installed_where_it_or_the_npm_that_is_needed_is_missing(
    programs, fetches, missing, monkeypatch
):
    monkeypatch.setattr(command, "find_spec", lambda name: None)
    monkeypatch.setattr(command, "installed_program", lambda name: name in programs or None)
    assert command._missing(fetches=fetches) == missing


@pytest.mark.parametrize("node", [None, shutil.which("false")])
def test_without_node_a_page_starts_its_own_python(node, tmp_path, pyodide, capsys, monkeypatch):
    monkeypatch.setattr(memory, "installed_program", lambda name: node)
    monkeypatch.setattr(written, "wasm_kernels", lambda: b"wasm")
    assert main(["playground", "-o", str(tmp_path / "s"), "--pyodide", str(pyodide)]) == 0
    assert "the page takes longer to start: " in capsys.readouterr().err
    assert '"memory":0' in (tmp_path / "s/index.html").read_text(encoding="utf-8")
    assert not (tmp_path / "s/python/memory.bin").exists()


@pytest.mark.slow
def test_a_page_that_could_not_load_fuzzyarm_is_not_written(tmp_path, pyodide, capsys, monkeypatch):
    monkeypatch.setattr(written, "APART", written.APART | {"apps/designer/jobs.py"})
    assert main(["playground", "-o", str(tmp_path / "s"), "--pyodide", str(pyodide)]) == 1
    words = "the page could not load fuzzyarm: ModuleNotFoundError: No module named"
    assert f"{words} 'fuzzyarm.apps.designer.jobs'" in capsys.readouterr().err
    assert not (tmp_path / "s").exists()


@pytest.mark.slow
def test_why_node_fails_is_said_by_its_error(tmp_path, pyodide, capsys, monkeypatch):
    node = tmp_path / "node"
    lines = ["file:///x/start.js:1", "const memory = 3", "RangeError: no memory", "Node.js v20"]
    script = "#!/bin/sh\n" + "".join(f"echo '{line}' >&2\n" for line in lines) + "exit 1\n"
    node.write_text(script, encoding="utf-8")
    node.chmod(0o755)
    monkeypatch.setattr(memory, "installed_program", lambda name: str(node))
    monkeypatch.setattr(written, "wasm_kernels", lambda: b"wasm")
    assert main(["playground", "-o", str(tmp_path / "s"), "--pyodide", str(pyodide)]) == 0
    assert f"{node} failed: RangeError: no memory" in capsys.readouterr().err


def test_a_file_in_the_place_of_the_folder_is_said(tmp_path, pyodide, capsys):
    (tmp_path / "s").write_text("", encoding="utf-8")
    assert main(["playground", "-o", str(tmp_path / "s"), "--pyodide", str(pyodide)]) == 1
    assert "is not a folder" in capsys.readouterr().err


def test_a_folder_that_cannot_be_made_is_said_before_the_work(tmp_path, capsys, monkeypatch):
    (tmp_path / "s").write_text("", encoding="utf-8")
    monkeypatch.delattr("fuzzyarm.apps.playground.folder.pyodide_folder")
    assert main(["playground", "-o", str(tmp_path / "s" / "site"), "--pyodide", "nowhere"]) == 1
    assert "Not a directory" in capsys.readouterr().err


def imported_at_once(tree: ast.Module) -> Iterator[str]:
    """Yield the modules that a module imports when it is loaded, by their names."""
    for node in tree.body:
        if isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
        elif isinstance(node, ast.Import):
            yield from (each.name for each in node.names)


@pytest.mark.slow
def test_what_the_page_imports_of_fuzzyarm_is_in_its_archive() -> None:
    with zipfile.ZipFile(io.BytesIO(archive())) as file:
        texts = {name: file.read(name) for name in file.namelist() if name.endswith(".py")}
    there = {name.removesuffix(".py").removesuffix("/__init__").replace("/", ".") for name in texts}
    # Begin at what the page runs and follow what that loads; the rest is only there.
    waiting, seen, missing = ["fuzzyarm.apps.playground.host"], set(), set()
    while waiting:
        module = waiting.pop()
        if module in seen or not module.startswith("fuzzyarm"):
            continue
        seen.add(module)
        if module not in there:
            missing.add(module)
            continue
        path = module.replace(".", "/")
        text = texts.get(f"{path}.py") or texts[f"{path}/__init__.py"]
        waiting += imported_at_once(ast.parse(text))
        waiting += [module.rpartition(".")[0]] if "." in module else []
    assert len(seen) > 100
    assert missing == set()
