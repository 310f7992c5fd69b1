"""Change the source a little in many ways, and see whether a test notices.

    python tools/mutants.py                    a sample of 300 of all packages, by a seed
    python tools/mutants.py --count 20 --only inference/point
    python tools/mutants.py --record FILE      goes on where an interrupted run ended
    python tools/mutants.py --full             all of them (days)

A mutant is one operator, comparison, number or name changed in one file of a copy of the source.
The tests of its package (see `TESTS`) run without any mutant first, which tells what each of them
calls. Then a mutant is tried by those that call its function: first by what noticed another one
of the file, then by what calls little else. In the first round these are quick tests of its
package, in the second quick ones of other packages that have run by then, in the third those that
take long. What nobody notices is printed, and is either a missing test or a change without a
meaning.
"""

from __future__ import annotations

import argparse
import ast
import hashlib
import json
import random
import sys
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from forked_tests import (
    LONGEST,
    PACKAGE,
    ROOT,
    SourceCopy,
    TestRun,
    TracedRun,
    import_what_is_heavy,
    name_of,
)

_DEFINITIONS = ["norms", "definitions", "facts"]
_LOOKUP = ["table", "compiled_lookup", "lookup_definition"]
_PLANTS = ["any_plant", "own_controllers"]
TESTS = {
    "kernels.py": ["tests/project/test_kernels.py", "tests/native"],
    "plant/equations.py": ["tests/plant/test_equations.py", "tests/loop/test_any_plant.py"],
    "plant/own.py": [f"tests/loop/test_{name}.py" for name in _PLANTS],
    "plant/plain_python.py": ["tests/plant/test_own_mistakes.py", "tests/loop/test_any_plant.py"],
    "cli/boards.py": ["tests/export/test_boards.py", "tests/cli"],
    "cli/compare.py": ["tests/study/test_comparison.py", "tests/cli"],
    "cli/compile.py": ["tests/cli", "tests/export", "tests/show/test_table_commands.py"],
    "cli/convert.py": ["tests/cli", "tests/formats/test_convert.py", "tests/formats/test_trees.py"],
    "cli/fit.py": ["tests/learning/test_fit.py", "tests/cli"],
    "cli/grade.py": ["tests/grading", "tests/cli"],
    "cli/learn.py": ["tests/learning/test_learn_command.py", "tests/cli"],
    "cli/playground.py": ["tests/playground/test_folder.py", "tests/cli"],
    "cli/prove": ["tests/cli", "tests/proof", "tests/closed_loop/test_claims_in_text.py"],
    "cli/show.py": ["tests/show", "tests/cli"],
    "cli/simulate.py": ["tests/cli", "tests/loop"],
    "cli/study.py": ["tests/study", "tests/cli"],
    "cli/tune.py": ["tests/tuning", "tests/cli"],
    "cli/validate.py": ["tests/learning/test_validation.py", "tests/cli"],
    "loop/program.py": [f"tests/loop/test_{name}.py" for name in _PLANTS],
    "expression/sources.py": ["tests/controller/test_sources.py"],
    "expression/norms.py": [f"tests/expression/test_{each}.py" for each in _DEFINITIONS],
    "expression/formulas.py": ["tests/expression/test_formulas.py"],
    "expression/": ["tests/expression"],
    **{
        f"inference/{name}": [f"tests/inference/test_{each}.py" for each in ("compiled", "engines")]
        for name in ("kernel", "firing_strengths", "closed_form")
    },
    **{
        f"inference/{name}": ["tests/proof/test_soundness.py", "tests/inference"]
        for name in ("centroid_bounds", "place_bounds")
    },
    "inference/": ["tests/inference", "tests/expression/test_norms.py"],
    "table/lookup.py": [f"tests/table/test_{each}.py" for each in _LOOKUP],
    "table/": ["tests/table"],
    "live/skfuzzy.py": ["tests/formats/test_skfuzzy_bridge.py"],
    "formats/fml.py": ["tests/formats/test_fml.py"],
    "live/": [
        f"tests/formats/test_{name}.py"
        for name in ("live_objects", "programs", "functions_of_pyit2fls", "skfuzzy_bridge")
    ]
    + ["tests/cli/test_convert_scripts.py"],
    "formats/": ["tests/formats"],
    "model/": ["tests/language", "tests/inference", "tests/python"],
    "text/": ["tests/text", "tests/language", "tests/cli"],
    "translation/": ["tests/native", "tests/expression"],
    "native/": ["tests/native", "tests/project/test_kernels.py"],
    "controller/": ["tests/controller", "tests/loop", "tests/study"],
    "closed_loop/call.py": ["tests/python", "tests/proof", "tests/closed_loop"],
    "plant/": ["tests/plant", "tests/loop"],
    "loop/": ["tests/loop", "tests/controller"],
    "sklearn.py": ["tests/learning/test_sklearn.py"],
    "api.py": ["tests/python", "tests/lsp"],
    "builder/": ["tests/python"],
    "notebook.py": ["tests/python"],
    "requests/": [
        "tests/requests", "tests/cli/test_json_schemas.py", "tests/cli/test_slips_of_users.py",
        "tests/designer/test_designer_forms.py", "tests/tuning", "tests/learning", "tests/loop",
    ],
    "show/figures/": ["tests/show", "tests/study", "tests/tuning", "tests/learning"],
    "show/": ["tests/show", "tests/cli", "tests/watch"],
    "shipped_files.py": ["tests/text", "tests/cli"],
    "extras.py": ["tests/project"],
    "picture.py": ["tests/show", "tests/plant"],
    "figure_files.py": ["tests/show", "tests/cli"],
    "grading.py": ["tests/grading"],
    "errors.py": ["tests/project", "tests/language"],
    "lazy.py": ["tests/project"],
    "__init__.py": ["tests/project"],
    "__main__.py": ["tests/cli"],
    "version.py": ["tests/project"],
    "interrupts.py": ["tests/cli/test_streams.py"],
    **{
        f"{package}/": [f"tests/{package}"]
        for package in (
            "cli", "closed_loop", "designer", "dossier", "export", "language", "learning", "lsp",
            "playground", "proof", "study", "tuning", "watch",
        )
    },
}  # fmt: skip
"""The narrow tests of each file: of the first part here that its name begins with."""

PATIENCE = 25.0
"""Seconds of tests, as long as they take without a mutant, by which it is tried in a round."""

ROUNDS = ("quick tests of its package", "quick tests of others", "long tests of its package")

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
    scope: int = 0
    """The first line of its function, with decorators; 0 of a module."""

    def applied(self, source: bytes) -> bytes:
        """Return the source with the change."""
        return source[: self.start] + self.new.encode() + source[self.end :]


def told(mutant: Mutant) -> tuple[str, str, str]:
    """Return the place of a mutant, and its line before and after."""
    source = (ROOT / mutant.file).read_bytes()
    begin = source.rfind(b"\n", 0, mutant.start) + 1
    stop = source.find(b"\n", mutant.end)
    changed = mutant.applied(source)
    before, after = source[begin:stop], changed[begin : stop + len(changed) - len(source)]
    place = f"{mutant.file}:{mutant.line}:{mutant.start - begin + 1}"
    return place, before.decode().strip(), after.decode().strip()


def shown(mutant: Mutant) -> str:
    """Return that in three lines."""
    place, before, after = told(mutant)
    return f"{place}\n  - {before}\n  + {after}"


class _Finder(ast.NodeVisitor):
    """Collects the mutants of one file; annotations and names of modules are left alone."""

    def __init__(self, file: str, source: bytes) -> None:
        self.file, self.source = file, source
        self.starts = [0]
        for line in source.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))
        self.found: list[Mutant] = []
        self.scope = 0

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
        self.found.append(Mutant(self.file, line, start, end, new, self.scope))

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
        for part in node.args.defaults:
            self.visit(part)
        first = min((node.lineno, *(mark.lineno for mark in node.decorator_list)))
        self._inside(first, node.body)

    def visit_Lambda(self, node: ast.Lambda) -> None:
        self._inside(node.lineno, [node.body])

    def _inside(self, scope: int, parts: Sequence[ast.AST]) -> None:
        outside, self.scope = self.scope, scope
        for part in parts:
            self.visit(part)
        self.scope = outside

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


class Calls(NamedTuple):
    """What a test calls: for each file the first lines of functions, 0 for the module itself."""

    seconds: list[float]
    lines: dict[str, set[int]]

    def reaches(self, file: str, scope: int) -> bool:
        """Whether it calls a function; of a module anything."""
        lines = self.lines.get(file, set())
        return scope in lines or (scope == 0 and bool(lines))

    def share(self, file: str) -> float:
        """Return which part of what it calls is in a file."""
        return len(self.lines.get(file, ())) / max(1, sum(map(len, self.lines.values())))


class Reach:
    """What each test calls, of files of tests that have run without any mutant."""

    def __init__(self, copy: SourceCopy, log: Log) -> None:
        self.copy, self.log = copy, log
        self.calls: dict[tuple[str, bool], dict[str, Calls]] = {}
        self.broken: set[str] = set()
        for line in log.lines:
            self._keep(*line)

    def trace(self, file: str, *, long: bool) -> None:
        """Run a file of tests, unless it was."""
        if (file, long) in self.calls:
            return
        run = TracedRun(self.copy.home / PACKAGE, long=long)
        failed, rows = self.copy.run(run, [file], 10 * LONGEST)
        if failed:
            print(f"left out, since it fails without any mutant: {' '.join(failed)}", flush=True)
        self._keep(file, long, rows, failed)
        self.log.add([file, long, rows, failed])

    def _keep(self, file: str, long: bool, rows: Sequence[Any], broken: Sequence[str]) -> None:
        self.broken.update(broken)
        tests = self.calls[file, long] = {}
        for test, seconds, found in rows:
            calls = tests.setdefault(name_of(test), Calls([], defaultdict(set)))
            calls.seconds.append(seconds)
            for source, lines in found.items():
                calls.lines[source].update(lines)

    def near(
        self,
        mutant: Mutant,
        files: Sequence[str],
        patience: float,
        *,
        long: bool,
        everything: bool,
    ) -> list[str]:
        """Return tests that a mutant is tried by, the nearest first, as many as patience allows.

        They call its function, or are in a file with one that does: what that one had computed
        may have been kept for them. Or they are all tests of the files.
        """
        source = Path(mutant.file).relative_to(PACKAGE).as_posix()
        order = []
        for file in files:
            tests = self.calls[file, long]
            hits = {name for name, calls in tests.items() if calls.reaches(source, mutant.scope)}
            if hits or everything:
                for name, calls in tests.items():
                    hit = name in hits or "" in hits
                    order.append((not hit, -calls.share(source), name, sum(calls.seconds)))
        chosen: list[str] = []
        left = patience
        for _, _, name, seconds in sorted(order):
            if name and (not chosen or seconds <= left):
                chosen.append(name)
                left -= seconds
        return chosen


class Log:
    """Lines of JSON in a file that an interrupted run has left, if it is of the same source."""

    def __init__(self, file: Path | None) -> None:
        self.file = file
        self.lines: list[Any] = []
        if file is not None and file.exists():
            first, *self.lines = map(json.loads, file.read_text("utf-8").splitlines())
            if first != digest_of_project():
                sys.exit(f"{file} is of another source, or of other tests: remove it")
        elif file is not None:
            self.add(digest_of_project())

    def add(self, line: Any) -> None:
        """Write a line."""
        if self.file is not None:
            with self.file.open("a", encoding="utf-8") as lines:
                print(json.dumps(line, ensure_ascii=False), file=lines)


def digest_of_project() -> str:
    """Return a digest of the source and of its tests."""
    whole = hashlib.sha256()
    for folder in ("src", "tests"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            whole.update(path.read_bytes())
    return whole.hexdigest()


class Record:
    """What came of each mutant so far: what noticed it, or the rounds after which nothing had."""

    def __init__(self, log: Log) -> None:
        self.log = log
        self.noticed: dict[str, str] = {}
        self.rounds: Counter[str] = Counter()
        self.noticing: dict[str, list[str]] = defaultdict(list)
        for line in log.lines:
            self._keep(*line)

    def add(self, mutant: Mutant, number: int, by: str | None) -> None:
        """Write what came of a round."""
        line = (*told(mutant), number, by)
        self._keep(*line)
        self.log.add(line)

    def _keep(self, place: str, before: str, after: str, number: int, by: str | None) -> None:
        key = f"{place} {after}"
        self.rounds[key] = number
        if by:
            self.noticed[key] = by
            self.noticing[place.partition(":")[0]].insert(0, name_of(by))

    def is_noticed(self, mutant: Mutant) -> bool:
        """Whether a test noticed a mutant."""
        return _key(mutant) in self.noticed

    def is_open(self, mutant: Mutant, number: int) -> bool:
        """Whether a round is still to come for a mutant."""
        return not self.is_noticed(mutant) and self.rounds[_key(mutant)] < number


def _key(mutant: Mutant) -> str:
    place, _, after = told(mutant)
    return f"{place} {after}"


def attempt(
    mutant: Mutant, number: int, copy: SourceCopy, reach: Reach, favourites: Sequence[str]
) -> str | None:
    """Try a mutant in a round; return what notices it."""
    long, files = number == 3, files_of(tests_of(mutant.file))
    if number == 2:
        files = [file for file, slow in reach.calls if not slow and file not in files]
    for file in files:
        reach.trace(file, long=long)
    try:
        refusing = copy.change(mutant.file, mutant.applied((ROOT / mutant.file).read_bytes()))
        if refusing:
            return refusing
        # What runs as machine code is in no trace.
        everything = copy.machine_code.is_other and number != 2
        patience = 4 * PATIENCE if everything else PATIENCE
        tests = reach.near(mutant, files, patience, long=long, everything=everything)
        tests = in_turn(tests, favourites)
        if not tests:
            return None
        run = TestRun(tests, reach.broken, long=long)
        failed = copy.run(run, list(dict.fromkeys(map(_file, tests))), 30 + 4 * patience).failed
        return failed[0] if failed else None
    finally:
        copy.take_back(mutant.file)


def in_turn(tests: Sequence[str], favourites: Sequence[str]) -> list[str]:
    """Return tests with some of the favourites at the front, and the others file by file.

    What a file prepares for its tests is then prepared once.
    """
    first = [name for name in dict.fromkeys(favourites) if name in tests][:3]
    files = {file: rank for rank, file in enumerate(dict.fromkeys(map(_file, tests)))}
    others = [name for name in tests if name not in first]
    return [*first, *sorted(others, key=lambda name: files[_file(name)])]


def _file(test: str) -> str:
    return test.partition("::")[0]


def files_of(tests: Sequence[str]) -> list[str]:
    """Return the files of tests: themselves, or those of a folder."""
    files: list[Path] = []
    for path in map(ROOT.joinpath, tests):
        files += sorted(path.glob("test_*.py")) if path.is_dir() else [path]
    return [file.relative_to(ROOT).as_posix() for file in files]


def look(chosen: Sequence[Mutant], rounds: int, record: Record, reach_log: Log) -> None:
    """Try mutants in rounds; print those that survive one."""
    import_what_is_heavy()
    with tempfile.TemporaryDirectory() as home:
        copy = SourceCopy(Path(home))
        reach = Reach(copy, reach_log)
        for number in range(1, rounds + 1):
            left = [mutant for mutant in sorted(chosen) if record.is_open(mutant, number)]
            for count, mutant in enumerate(left, 1):
                by = attempt(mutant, number, copy, reach, record.noticing[mutant.file])
                record.add(mutant, number, by)
                if not by:
                    print(
                        f"[{ROUNDS[number - 1]}, {count}/{len(left)}] {shown(mutant)}", flush=True
                    )


def main() -> int:
    """Run as a script; the survivors are what it prints, not a failure."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--full", action="store_true", help="every mutant")
    parser.add_argument("--only", default="", metavar="PART", help="of the name of a file")
    parser.add_argument("--record", type=Path, metavar="FILE", help="keep results, and go on")
    parser.add_argument("--fast", action="store_true", help="without the tests that take long")
    parser.add_argument("--list", action="store_true", help="print the mutants, try none")
    arguments = parser.parse_args()
    mutants = list(all_mutants(arguments.only))
    count = len(mutants) if arguments.full else min(arguments.count, len(mutants))
    chosen = random.Random(arguments.seed).sample(mutants, count)
    if arguments.list:
        for mutant in chosen:
            print(shown(mutant))
        print(f"{len(mutants):,} mutants in all")
        return 0
    start = time.monotonic()
    file = arguments.record
    record = Record(Log(file))
    reach_log = Log(file and file.with_name(f"{file.name}.reach"))
    look(chosen, len(ROUNDS) - arguments.fast, record, reach_log)
    survivors = Counter(package_of(each) for each in chosen if not record.is_noticed(each))
    for package, count in sorted(Counter(map(package_of, chosen)).items()):
        print(f"{package:16} {count:4}, {survivors[package]:3}")
    print(
        f"{len(chosen)} mutants of {len(mutants):,}, {survivors.total()} unnoticed, "
        f"{time.monotonic() - start:.0f} s"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
