"""The architecture: every import goes down, and the bottom is light."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2] / "src" / "fuzzyarm"
MODULES = sorted(path for path in SOURCE.rglob("*.py"))

FLOORS = {
    "errors": 0,
    "files": 0,
    "kernels": 0,
    "rulebase": 1,
    "shipped_files": 1,
    "formats": 1,
    "inference": 2,
    "lut": 3,
    "api": 3,
    "arm": 4,
    "export": 4,
    "control": 5,
    "study": 6,
    "show": 6,
    "cli": 8,
    "lsp": 7,
    "studio": 7,
}
SIDEWAYS = {
    ("formats", "rulebase"),
    ("shipped_files", "rulebase"),
    ("api", "lut"),
    ("studio", "lsp"),
}
"""Imports within one floor that the design allows."""

HEAVY = ("numpy", "numba", "scipy", "skfuzzy", "matplotlib", "rich", "pygls", "textual")


def package_of(path):
    first = path.relative_to(SOURCE).parts[0]
    return first.removesuffix(".py")


def imported_modules(path):
    """Yield (module, whether at import time) for every import in a file."""
    tree = ast.parse(path.read_text())
    late = {
        id(node)
        for parent in ast.walk(tree)
        if isinstance(parent, ast.FunctionDef | ast.AsyncFunctionDef)
        or (isinstance(parent, ast.If) and "TYPE_CHECKING" in ast.dump(parent.test))
        for node in ast.walk(parent)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name, id(node) not in late
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path} imports relatively"
            yield node.module, id(node) not in late
            if node.module == "fuzzyarm":
                for alias in node.names:
                    yield f"fuzzyarm.{alias.name}", id(node) not in late


def test_every_package_has_its_floor():
    packages = {package_of(path) for path in MODULES}
    assert packages - {"__init__", "__main__"} <= set(FLOORS)


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(SOURCE)))
def test_imports_go_down(path):
    home = package_of(path)
    if home in ("__init__", "__main__"):
        return
    for module, _ in imported_modules(path):
        parts = module.split(".")
        if parts[0] != "fuzzyarm" or len(parts) == 1 or parts[1] not in FLOORS:
            continue
        target = parts[1]
        allowed = target == home or FLOORS[target] < FLOORS[home] or (home, target) in SIDEWAYS
        assert allowed, f"{path} (floor {FLOORS[home]}) imports {module}"


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(SOURCE)))
def test_the_arm_knows_nothing_of_fuzzy_sets(path):
    if package_of(path) != "arm":
        return
    fuzzy = {"rulebase", "formats", "inference", "lut", "api"}
    for module, _ in imported_modules(path):
        assert not (module.startswith("fuzzyarm.") and module.split(".")[1] in fuzzy)


def test_the_language_uses_the_standard_library_only():
    for path in MODULES:
        if package_of(path) in ("rulebase", "errors", "files", "shipped_files"):
            for module, _ in imported_modules(path):
                top = module.split(".")[0]
                assert top == "fuzzyarm" or top in sys.stdlib_module_names, (path, module)


@pytest.mark.parametrize(
    "statement",
    [
        "import fuzzyarm",
        "import fuzzyarm.cli",
        "import fuzzyarm.api",
        "import fuzzyarm.inference",
        "from fuzzyarm.cli import main; assert main(['--help']) == 0",
        "from fuzzyarm.cli import main; from fuzzyarm import shipped;"
        " assert main(['check', str(shipped('pd7.frb'))]) == 0",
        "from fuzzyarm.cli import main; from fuzzyarm import shipped;"
        " assert main(['check', str(shipped('thesis-6.1.lut'))]) == 0",
        "from fuzzyarm.cli import main; from fuzzyarm import shipped;"
        " assert main(['fmt', '--check', str(shipped('pd7.frb'))]) == 0",
    ],
)
def test_nothing_heavy_is_loaded_for_light_work(statement):
    code = f"import sys\n{statement}\nprint([m for m in {HEAVY} if m in sys.modules])"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.splitlines()[-1] == "[]"


def test_modules_are_short():
    lengths = sorted(len(path.read_text().splitlines()) for path in MODULES)
    assert lengths[-1] <= 500
    assert lengths[len(lengths) // 2] < 250


def test_only_the_command_line_prints():
    for path in MODULES:
        if package_of(path) == "cli":
            continue
        calls = [n for n in ast.walk(ast.parse(path.read_text())) if isinstance(n, ast.Call)]
        printed = [n for n in calls if isinstance(n.func, ast.Name) and n.func.id == "print"]
        assert not printed, path
