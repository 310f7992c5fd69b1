"""Change the source a little in many ways, and see whether a test notices.

    python tools/mutants.py                    a sample of 300 of all packages, by a seed
    python tools/mutants.py --count 20 --only inference/point
    python tools/mutants.py --full             all of them (days)

A mutant is one operator, comparison, number or name changed in one file of a copy of the
source. The narrow tests of its package run against the copy; those that nobody notices are
printed with the line, and are either missing tests or changes without a meaning.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = Path("src") / "fuzzyarm"

_DEFINITIONS = ["norms", "definitions", "facts"]
_LOOKUP = ["table", "compiled_lookup", "lookup_definition"]
_FORMATS = [
    "orders_of_numbers", "format_readers", "fis_of_others", "format_references",
    "format_roundtrips",
]  # fmt: skip
_LIVE = [f"tests/formats/test_{each}.py" for each in ("live_objects", "programs")]
_PLANTS = ["any_plant", "own_controllers"]
TESTS = {
    "kernels.py": ["tests/project/test_kernels.py", "tests/native"],
    "plant/equations.py": ["tests/plant/test_equations.py", "tests/loop/test_any_plant.py"],
    "plant/own.py": [f"tests/loop/test_{name}.py" for name in _PLANTS],
    "plant/plain_python.py": ["tests/plant/test_own_mistakes.py", "tests/loop/test_any_plant.py"],
    "loop/program.py": [f"tests/loop/test_{name}.py" for name in _PLANTS],
    "expression/sources.py": ["tests/controller/test_sources.py"],
    "expression/norms.py": [f"tests/expression/test_{each}.py" for each in _DEFINITIONS],
    "expression/formulas.py": ["tests/expression/test_formulas.py"],
    "expression/": ["tests/expression"],
    **{
        f"inference/{name}": [f"tests/inference/test_{each}.py" for each in ("compiled", "engines")]
        for name in ("kernel", "firing_strengths", "closed_form")
    },
    "inference/": ["tests/inference", "tests/expression/test_norms.py"],
    "table/lookup.py": [f"tests/table/test_{each}.py" for each in _LOOKUP],
    "table/": ["tests/table"],
    "live/skfuzzy.py": ["tests/formats/test_skfuzzy_bridge.py"],
    "formats/fml.py": ["tests/formats/test_fml.py"],
    "live/": _LIVE,
    "formats/": [f"tests/formats/test_{each}.py" for each in _FORMATS],
    "model/": ["tests/language", "tests/inference"],
    "text/": ["tests/text", "tests/language", "tests/cli"],
    "translation/": ["tests/native", "tests/expression"],
    "native/": ["tests/native", "tests/project/test_kernels.py"],
    "controller/": ["tests/controller", "tests/loop"],
    "plant/": ["tests/plant", "tests/loop"],
    "loop/": ["tests/loop", "tests/controller"],
    "control.py": ["tests/controller", "tests/export/test_exported_controllers.py"],
    "sklearn.py": ["tests/learning/test_sklearn.py"],
    "dossier/": ["tests/dossier"],
    "api.py": ["tests/python", "tests/lsp"],
    "builder/": ["tests/python"],
    "notebook.py": ["tests/python"],
    "show/": ["tests/show", "tests/cli"],
    "shipped_files.py": ["tests/text", "tests/cli"],
    "extras.py": ["tests/project"],
    "picture.py": ["tests/show", "tests/plant"],
    "figure_files.py": ["tests/show", "tests/cli"],
    "frozen.py": ["tests/python", "tests/language"],
    "grading.py": ["tests/grading"],
    "errors.py": ["tests/project", "tests/language"],
    "lazy.py": ["tests/project"],
    "__init__.py": ["tests/project"],
    "__main__.py": ["tests/cli"],
    "version.py": ["tests/project"],
    **{
        f"{package}/": [f"tests/{package}"]
        for package in (
            "cli", "closed_loop", "designer", "dossier", "export", "language", "learning", "lsp",
            "playground", "proof", "requests", "study", "tuning", "watch",
        )
    },
}  # fmt: skip
"""The narrow tests of each file: of the first part here that its name begins with."""

LONGEST = 400
"""Seconds until the tests of a mutant are taken to hang, which somebody would notice."""

_COMPARISONS: dict[type[ast.cmpop], tuple[str, tuple[str, ...]]] = {
    ast.Lt: ("<", ("<=", ">")),
    ast.LtE: ("<=", ("<", ">")),
    ast.Gt: (">", (">=", "<")),
    ast.GtE: (">=", (">", "<")),
    ast.Eq: ("==", ("!=",)),
    ast.NotEq: ("!=", ("==",)),
    ast.In: ("in", ("not in",)),
    ast.Is: ("is", ("is not",)),
}
_OPERATORS: dict[type[ast.operator], tuple[str, tuple[str, ...]]] = {
    ast.Add: ("+", ("-",)),
    ast.Sub: ("-", ("+",)),
    ast.Mult: ("*", ("/",)),
    ast.Div: ("/", ("*",)),
    ast.FloorDiv: ("//", ("*",)),
    ast.Pow: ("**", ("*",)),
    ast.Mod: ("%", ("*",)),
}
_NAMES = {
    "min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum",
    "bisect_left": "bisect_right", "bisect_right": "bisect_left",
    "any": "all", "all": "any", "floor": "ceil", "ceil": "floor",
}  # fmt: skip


class Mutant(NamedTuple):
    """A change of some bytes of one file."""

    file: str
    line: int
    start: int
    end: int
    new: str

    def applied(self, source: bytes) -> bytes:
        """Return the source with the change."""
        return source[: self.start] + self.new.encode() + source[self.end :]

    def shown(self, source: bytes) -> str:
        """Return the line before and after, with its place."""
        begin = source.rfind(b"\n", 0, self.start) + 1
        stop = source.find(b"\n", self.end)
        before = source[begin:stop].decode()
        after = self.applied(source)[begin : stop + len(self.applied(source)) - len(source)]
        return f"{self.file}:{self.line}\n  - {before.strip()}\n  + {after.decode().strip()}"


class _Finder(ast.NodeVisitor):
    """Collects the mutants of one file; annotations and names of modules are left alone."""

    def __init__(self, file: str, source: bytes) -> None:
        self.file, self.source = file, source
        self.starts = [0]
        for line in source.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))
        self.found: list[Mutant] = []

    def _start(self, node: ast.expr) -> int:
        return self.starts[node.lineno - 1] + node.col_offset

    def _end(self, node: ast.expr) -> int:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        return self.starts[node.end_lineno - 1] + node.end_col_offset

    def _between(self, left: ast.expr, right: ast.expr, old: str, news: Sequence[str]) -> None:
        low, high = self._end(left), self._start(right)
        gap = self.source[low:high]
        at = gap.find(old.encode())
        if at < 0 or b"#" in gap:
            return
        for new in news:
            self._add(left.end_lineno or 0, low + at, low + at + len(old), new)

    def _add(self, line: int, start: int, end: int, new: str) -> None:
        self.found.append(Mutant(self.file, line, start, end, new))

    def visit_Compare(self, node: ast.Compare) -> None:
        sides = [node.left, *node.comparators]
        for left, sign, right in zip(sides, node.ops, sides[1:], strict=False):
            if type(sign) in _COMPARISONS:
                self._between(left, right, *_COMPARISONS[type(sign)])
        self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        text = isinstance(node.left, ast.Constant) and isinstance(node.left.value, str)
        if type(node.op) in _OPERATORS and not text:
            self._between(node.left, node.right, *_OPERATORS[type(node.op)])
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        old, new = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
        for left, right in zip(node.values, node.values[1:], strict=False):
            self._between(left, right, old, [new])
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        if isinstance(node.op, ast.Not | ast.USub):
            self._add(node.lineno, self._start(node), self._start(node.operand), "")
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        value = node.value
        if isinstance(value, bool):
            self._add(node.lineno, self._start(node), self._end(node), str(not value))
        elif isinstance(value, int | float):
            for new in {value + 1, -value if value not in (0, 1) else 2} - {value}:
                self._add(node.lineno, self._start(node), self._end(node), f"({new!r})")

    def visit_Call(self, node: ast.Call) -> None:
        name = node.func.attr if isinstance(node.func, ast.Attribute) else ""
        name = node.func.id if isinstance(node.func, ast.Name) else name
        if name in _NAMES:
            end = self._end(node.func)
            self._add(node.lineno, end - len(name), end, _NAMES[name])
        self.generic_visit(node)

    def visit_keyword(self, node: ast.keyword) -> None:
        if node.arg != "strict":  # of zip: a check of what holds anyway
            self.generic_visit(node)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.visit(node.value)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        for part in (*node.args.defaults, *node.body):
            self.visit(part)

    def visit_If(self, node: ast.If) -> None:
        if not (isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"):
            self.generic_visit(node)


def mutants_of(file: Path) -> list[Mutant]:
    """Return all mutants of a file of the source."""
    source = (ROOT / file).read_bytes()
    finder = _Finder(str(file), source)
    finder.visit(ast.parse(source))
    return finder.found


def all_mutants(only: str) -> Iterator[Mutant]:
    """Yield the mutants of every file, or of those with a part in their name."""
    for path in sorted((ROOT / PACKAGE).rglob("*.py")):
        file = path.relative_to(ROOT)
        if only in str(file):
            yield from mutants_of(file)


def tests_of(file: str) -> list[str]:
    """Return the tests that ought to notice a mutant of a file."""
    name = Path(file).relative_to(PACKAGE).as_posix()
    return next(tests for part, tests in TESTS.items() if name.startswith(part))


def package_of(mutant: Mutant) -> str:
    """Return the package of a mutant, or the module beside the packages."""
    return Path(mutant.file).relative_to(PACKAGE).parts[0]


class Copy:
    """A copy of the source in which one mutant lives at a time."""

    def __init__(self, home: Path) -> None:
        self.home = home
        shutil.copytree(ROOT / "src", home / "src", ignore=shutil.ignore_patterns("__pycache__"))
        for name in ("rulebases", "examples", "docs"):  # which the package looks for beside it
            (home / name).symlink_to(ROOT / name)

    def passes(self, tests: Sequence[str], marks: str) -> bool:
        """Whether the tests pass against the copy; False where they fail or hang."""
        environment = {
            **os.environ,
            "PYTHONPATH": str(self.home / "src"),
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        words = [sys.executable, "-m", "pytest", "-x", "-q", "-n0", "-m", marks, *tests]
        try:
            done = subprocess.run(
                words, cwd=ROOT, env=environment, capture_output=True, timeout=LONGEST, check=False
            )
        except subprocess.TimeoutExpired:
            return False
        return done.returncode in (0, 5)  # 5: none of them has these marks

    def survives(self, mutant: Mutant, marks: Sequence[str]) -> bool:
        """Whether no test notices a mutant."""
        target = self.home / mutant.file
        source = (ROOT / mutant.file).read_bytes()
        target.write_bytes(mutant.applied(source))
        try:
            return all(self.passes(tests_of(mutant.file), each) for each in marks)
        finally:
            target.write_bytes(source)


def look(chosen: Sequence[Mutant], jobs: int, marks: Sequence[str]) -> list[Mutant]:
    """Try mutants, some at a time; print and return those that survive."""
    survivors = []
    with tempfile.TemporaryDirectory() as home:
        copies = [Copy(Path(home) / str(k)) for k in range(jobs)]
        for tests in {tuple(tests_of(mutant.file)) for mutant in chosen}:
            if not all(copies[0].passes(tests, each) for each in marks):
                sys.exit(f"without any mutant, {' '.join(tests)} must pass")

        def tried(mutant: Mutant) -> tuple[Mutant, bool]:
            copy = copies.pop()
            try:
                return mutant, copy.survives(mutant, marks)
            finally:
                copies.append(copy)

        with ThreadPoolExecutor(jobs) as pool:
            for number, (mutant, survived) in enumerate(pool.map(tried, chosen), 1):
                if survived:
                    survivors.append(mutant)
                    source = (ROOT / mutant.file).read_bytes()
                    print(f"[{number}/{len(chosen)}] {mutant.shown(source)}", flush=True)
    return survivors


def main() -> int:
    """Run as a script; the survivors are what it prints, not a failure."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--full", action="store_true", help="every mutant")
    parser.add_argument("--only", default="", metavar="PART", help="of the name of a file")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--fast", action="store_true", help="without the tests marked slow")
    parser.add_argument("--list", action="store_true", help="print the mutants, try none")
    arguments = parser.parse_args()
    mutants = list(all_mutants(arguments.only))
    count = len(mutants) if arguments.full else min(arguments.count, len(mutants))
    chosen = random.Random(arguments.seed).sample(mutants, count)
    if arguments.list:
        for mutant in chosen:
            print(mutant.shown((ROOT / mutant.file).read_bytes()))
        print(f"{len(mutants):,} mutants in all")
        return 0
    start = time.monotonic()
    # What is fast notices most, and what is slow need not run then.
    marks = ["not slow"] if arguments.fast else ["not slow", "slow"]
    survivors = look(chosen, arguments.jobs, marks)
    for package, count in sorted(Counter(map(package_of, chosen)).items()):
        print(f"{package:16} {count:4}, {sum(map(package.__eq__, map(package_of, survivors))):3}")
    print(
        f"{len(chosen)} mutants of {len(mutants):,}, {len(survivors)} unnoticed, "
        f"{time.monotonic() - start:.0f} s"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
