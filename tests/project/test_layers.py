"""The architecture: every import goes down, and the bottom is light."""

import ast
import importlib
import re
import subprocess
import sys
from functools import cache

import pytest
from sources import MODULES, SOURCE, nodes_of, tree

ORDER = (
    "interrupts",
    "version",
    "base",
    "symbolic",
    "language",
    "requests",
    "inference",
    "table",
    "plant",
    "control",
    "proof",
    "learning",
    "exchange",
    "apps",
)
"""The rooms: each imports only those before it."""

FLOOR = {package: floor for floor, package in enumerate(ORDER)}

HEAVY = (
    "numpy", "numba", "scipy", "skfuzzy", "sklearn", "matplotlib", "rich", "pygls", "textual",
    "starlette", "uvicorn",
)  # fmt: skip


def package_of(path):
    first = path.relative_to(SOURCE).parts[0]
    return first.removesuffix(".py")


@cache
def imports_of(path):
    """Return the import statements of a file: node, whether in a function, whether for types."""
    found, waiting = [], [(tree(path), False, False)]
    while waiting:
        node, inside, typing = waiting.pop()
        if isinstance(node, ast.Import | ast.ImportFrom):
            found.append((node, inside, typing))
        inside |= isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        typing |= isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)
        waiting += [(child, inside, typing) for child in ast.iter_child_nodes(node)]
    return found


def imported_modules(path):
    """Yield (module, whether at import time) for every import in a file."""
    for node, inside, typing in imports_of(path):
        early = not (inside or typing)
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name, early
        else:
            assert node.level == 0, f"{path} imports relatively"
            yield node.module, early
            if node.module == "fuzzyarm":
                for alias in node.names:
                    yield f"fuzzyarm.{alias.name}", early


def test_every_package_has_its_floor():
    packages = {package_of(path) for path in MODULES}
    assert packages - {"__init__", "__main__"} <= set(ORDER)


def imports_upwards(path):
    """Yield what a module imports of its own floor's other packages, or of one above."""
    home = package_of(path)
    if home in ("__init__", "__main__"):
        return
    for module, _ in imported_modules(path):
        parts = module.split(".")
        if parts[0] != "fuzzyarm" or len(parts) == 1 or parts[1] not in FLOOR:
            continue
        if parts[1] != home and FLOOR[parts[1]] >= FLOOR[home]:
            yield f"{path.relative_to(SOURCE)} imports {module}"


@pytest.mark.slow
def test_imports_go_down():
    assert [offender for path in MODULES for offender in imports_upwards(path)] == []


@pytest.mark.slow
def test_nothing_names_what_stands_above_it_by_string():
    """A name in a string, for an import at run time, goes down as well."""
    offenders = []
    for path in MODULES:
        home = package_of(path)
        if home in ("__init__", "__main__"):
            continue
        for node in nodes_of(path):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                name = re.fullmatch(r"fuzzyarm\.(\w+)(\.\w+)*", node.value)
                if name and name[1] in FLOOR and FLOOR[name[1]] > FLOOR[home]:
                    offenders.append((str(path.relative_to(SOURCE)), node.lineno, node.value))
    assert offenders == []


def module_name(path):
    parts = path.relative_to(SOURCE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def import_graph(*, late, types=False):
    """Return module → modules that its imports name; `late`: in functions too, `types`: for types.

    What a package names for types is what it loads when a name is asked for: not counted.
    """
    names = {module_name(path): path for path in MODULES}
    bound = {
        name: {
            alias.asname or alias.name
            for node, _, _ in imports_of(path)
            if isinstance(node, ast.ImportFrom)
            for alias in node.names
        }
        for name, path in names.items()
        if path.name == "__init__.py"
    }
    graph = {}
    for name, path in names.items():
        found = set()
        for node, inside, typing in imports_of(path):
            if typing and not (types and path.name != "__init__.py"):
                continue
            if inside and not late:
                continue
            if isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
            else:
                for alias in node.names:
                    # A name that the package itself binds hides a module of that name.
                    whole = f"{node.module}.{alias.name}"
                    hidden = alias.name in bound.get(node.module, ())
                    found.add(whole if whole in names and not hidden else node.module)
        graph[name] = (found & set(names)) - {name}
    return graph


def circles(graph):
    """Return the sets of nodes that reach each other."""

    def reached(start):
        seen, waiting = set(), [start]
        while waiting:
            for following in graph[waiting.pop()] - seen:
                seen.add(following)
                waiting.append(following)
        return seen

    reach = {name: reached(name) for name in graph}
    return {
        frozenset({name} | {other for other in reach[name] if name in reach[other]})
        for name in graph
        if name in reach[name]
    }


@pytest.mark.slow
@pytest.mark.parametrize(
    ("late", "types"), [(False, False), (True, False), (True, True)],
    ids=["at import time", "in functions too", "for types too"],
)  # fmt: skip
def test_no_modules_import_each_other(late, types):
    assert circles(import_graph(late=late, types=types)) == set()


def test_no_packages_import_each_other():
    packages = {module_name(path) for path in MODULES if path.name == "__init__.py"}

    def package(module):
        return module if module in packages else module.rpartition(".")[0]

    graph = {name: set() for name in packages}
    for module, imported in import_graph(late=True).items():
        graph[package(module)] |= {package(name) for name in imported} - {package(module)}
    # `fuzzyarm` itself is what stands beside the packages: the version, the short way in.
    graph["fuzzyarm"] = set()
    assert not circles(graph)


def test_circles_are_found():
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"b"}, "d": {"a"}}) == {frozenset("bc")}
    assert circles({"a": {"b"}, "b": set()}) == set()


def test_the_arm_knows_nothing_of_fuzzy_sets():
    fuzzy = {"language", "exchange", "inference", "table"}
    plants = [path for path in MODULES if package_of(path) == "plant"]
    assert plants
    assert [
        f"{path.relative_to(SOURCE)} imports {module}"
        for path in plants
        for module, _ in imported_modules(path)
        if module.startswith("fuzzyarm.") and module.split(".")[1] in fuzzy
    ] == []


def test_the_language_uses_the_standard_library_only():
    """But pictures, which may hold arrays, and their files, which matplotlib draws."""
    for path in MODULES:
        drawn = path.stem in ("picture", "figure_files")
        if package_of(path) in ("base", "requests", "language") and not drawn:
            for module, _ in imported_modules(path):
                top = module.split(".")[0]
                assert top == "fuzzyarm" or top in sys.stdlib_module_names, (path, module)


@pytest.mark.parametrize(
    "statement",
    [
        "import fuzzyarm",
        "import fuzzyarm.apps.cli",
        "import fuzzyarm.exchange.files",
        "import fuzzyarm.inference",
        "from fuzzyarm.apps.cli import main; assert main(['--help']) == 0",
        "from fuzzyarm.apps.cli import main; from fuzzyarm import shipped;"
        " assert main(['check', str(shipped('pd7.frb'))]) == 0",
        "from fuzzyarm.apps.cli import main; from fuzzyarm import shipped;"
        " assert main(['check', str(shipped('thesis-6.1.lut'))]) == 0",
        "from fuzzyarm.apps.cli import main; from fuzzyarm import shipped;"
        " assert main(['fmt', '--check', str(shipped('pd7.frb'))]) == 0",
    ],
)
def test_nothing_heavy_is_loaded_for_light_work(statement):
    code = f"import sys\n{statement}\nprint([m for m in {HEAVY} if m in sys.modules])"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.splitlines()[-1] == "[]"


SLOW = (
    "pathlib",
    "hashlib",
    "fractions",
    "fuzzyarm.language.controllers",
)
"""What is slow to import beside a check of a rule base, which does not need it."""


def test_a_check_of_a_rule_base_loads_little():
    """It takes less than five times as long as `import argparse`."""
    code = (
        "import sys; before = set(sys.modules); from fuzzyarm.apps.cli import main;"
        "from fuzzyarm import shipped; main(['check', '--quiet', str(shipped('pd7.frb'))]);"
        f"print([m for m in {SLOW} if m in sys.modules and m not in before])"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.splitlines()[-1] == "['pathlib']"  # by `shipped`


def test_only_the_command_line_prints():
    for path in MODULES:
        if path.is_relative_to(SOURCE / "apps" / "cli"):
            continue
        text = path.read_text()
        if "print(" not in text:
            continue
        calls = [n for n in nodes_of(path) if isinstance(n, ast.Call)]
        printed = [n for n in calls if isinstance(n.func, ast.Name) and n.func.id == "print"]
        assert not printed, path


# --- The arm is a plant ---

OF_THE_ARM = {
    "control/controllers/adaptive.py": "laws of the study have models of the arm",
    "control/controllers/conventional.py": "laws of the study have models of the arm",
    "control/controllers/law.py": "laws of the study have models of the arm",
    "control/controllers/on_plant.py": "laws of the study ask for its ports and its pose",
    "apps/cli/study.py": "rows of the study are on its trajectories",
    "apps/designer/stage.py": "a table of how a hand pushes each shipped plant",
}
"""Modules above the plants that name the arm, and why; all others ask a plant what it has."""

WORDS = re.compile(r"arm|joint[12](\.\w+)?|reach|reach-return|pick-and-place")
NAMES = re.compile(r"(?i)(^|_)(arms?|armparameters)($|_)")
OWN = {
    "Arm",
    "ArmParameters",
    "LOADED",
    "UNLOADED",
    "ESTIMATE",
    "INEXACT",
    "TRAJECTORIES",
    "JOINTS",
}
OWN |= {"reach", "reach_return", "pick_and_place"}


def named_of_the_arm(path):
    """Yield the line and the words by which a module knows the arm."""
    for node in nodes_of(path):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            if WORDS.fullmatch(node.value):
                yield node.lineno, node.value
        elif isinstance(node, ast.Name | ast.arg | ast.FunctionDef | ast.ClassDef | ast.Attribute):
            kinds = ("id", "arg", "name", "attr")
            name = next(getattr(node, kind) for kind in kinds if hasattr(node, kind))
            if NAMES.search(name):
                yield node.lineno, name
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("fuzzyarm.plant"):
            if node.module in ("fuzzyarm.plant.arm", "fuzzyarm.plant.driven_arm"):
                yield node.lineno, node.module
            yield from ((node.lineno, each.name) for each in node.names if each.name in OWN)


ABOVE = [
    path
    for path in MODULES
    if not path.is_relative_to(SOURCE / "plant") and "study" not in path.parts
]


@pytest.mark.slow
def test_only_named_modules_know_the_arm():
    """What the arm has and other plants lack a plant says of itself: any may have it."""
    found = {str(path.relative_to(SOURCE)): [*named_of_the_arm(path)] for path in ABOVE}
    knowing = {name: words for name, words in found.items() if words}
    others = {name: words for name, words in knowing.items() if name not in OF_THE_ARM}
    assert not others
    assert set(knowing) == set(OF_THE_ARM)  # no exception that is none any more


def test_the_pages_know_no_plant_by_its_name():
    from fuzzyarm.plant import PLANTS

    names = "|".join(PLANTS)
    for path in SOURCE.glob("apps/designer/page/*.js"):
        assert not re.findall(rf"""(?:===|!==|==)\s*["'`](?:{names})["'`]""", path.read_text()), (
            path
        )


BENCHMARKS = sorted((SOURCE.parents[1] / "benchmarks").glob("*.py"))


@pytest.mark.parametrize("path", BENCHMARKS, ids=lambda path: path.name)
def test_benchmarks_import_what_is_there(path):
    """No test runs them, and a name that has moved would be missed when somebody measures."""
    for node in ast.parse(path.read_text()).body:  # not what stands below a `try`
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("fuzzyarm"):
            module = importlib.import_module(node.module)
            for each in node.names:
                assert hasattr(module, each.name), f"{node.module} has no {each.name}"


def test_every_error_that_is_raised_has_a_builtin_behind_it():
    """`FuzzyarmError` itself is only a base: whoever catches ValueError catches what we say."""
    assert [
        f"{path.relative_to(SOURCE)}:{node.lineno}"
        for path in MODULES
        for node in nodes_of(path)
        if isinstance(node, ast.Raise)
        and isinstance(node.exc, ast.Call)
        and getattr(node.exc.func, "id", "") == "FuzzyarmError"
    ] == []
