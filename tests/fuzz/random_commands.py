"""Random commands on damaged files: whatever is asked of whatever, a command answers.

    python tests/fuzz/random_commands.py --seed 1 --count 12000

Words come from the records of the commands, options and values valid and not; files are the
shipped ones, damaged by character, line and number, swapped for files of other kinds, empty,
binary, missing, unreadable or folders. A finding is a traceback, a command that takes longer than
``--limit`` seconds, an exit status that is not of those promised, one that is not 0 without a
sentence on the standard error, output that is not what was asked for (JSON that is not JSON, a
rule base that cannot be read).
"""

from __future__ import annotations

import argparse
import json
import os
import random
import re
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "fuzz")]

from workers import HUNG, Outcome, Worker  # noqa: E402

from fuzzyarm.cli.command import Argument  # noqa: E402
from fuzzyarm.cli.main import COMMANDS, find_command  # noqa: E402
from fuzzyarm.language import parse  # noqa: E402
from tests.formats.mutation import mutated  # noqa: E402

OFTEN = {
    "check": 8, "fmt": 3, "eval": 10, "show": 6, "plot": 4, "diff": 4, "prove": 4, "compile": 10,
    "convert": 10, "corpus": 1, "simulate": 14, "sweep": 6, "compare": 1, "learn": 8, "tune": 3,
    "fit": 3, "validate": 4, "designer": 6, "watch": 2, "new": 2, "shipped": 1, "lsp": 1,
    "reproduce": 0.5, "studio": 0.5, "demo": 0.05, "help": 1,
}  # fmt: skip
"""How often each command is drawn, in parts; `identify` searches for minutes by its nature."""

DIVERGES = {"simulate", "sweep", "compare", "learn", "tune", "reproduce", "demo"}
"""Commands with a loop, which may end with 3."""

UNDECIDED = {"prove", "check", "demo"}
"""Commands that may end with 4."""

ODD_NAMES = (
    "", " ", "-", "--", "e", "nan", "no such", "'", '"', "é", "💧", "\u202e", "a" * 300, "..", "/",
    "%", "{}", "x=1", "NAME", "\t", "\\",
)  # fmt: skip
ODD_NUMBERS = (
    "0", "-1", "1e308", "-1e308", "1e-320", "nan", "inf", "-inf", "", "x", "1,2", "0x10", "1e", "²",
    "--1", "1e-300", "0.5", "99999999999999999999", "7", "٣",
)  # fmt: skip
PLANTS = ("arm", "motor", "cartpole", "tanks", "ball-and-beam", "room", "nothing", "own.py:Own")
SUFFIXES = (
    ".frb", ".lut", ".fis", ".fll", ".fcl", ".csv", ".json", ".npz", ".h", ".c", ".st", ".mjs",
    ".html", ".svg", ".png", ".pdf", ".tex", ".fmu", ".txt", "", ".FRB",
)  # fmt: skip
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?")

OWN_PLANT = """\
from fuzzyarm.plant import Plant, Port, State


class Own(Plant):
    name = "own"
    inputs = (Port("drive", -1, 1, "V"),)
    outputs = (Port("level", 0, 5, "m"),)
    states = (State("level"),)
    duration = 1.0

    def derivative(self, t, x, u, p, dx):
        dx[0] = u[0] - x[0]
"""


# --- Files ---


@cache
def originals() -> dict[str, bytes]:
    """Return the shipped files and those of the tests, by name."""
    homes = (
        ROOT / "rulebases",
        ROOT / "examples" / "elsewhere",
        ROOT / "examples" / "controllers",
        ROOT / "tests" / "formats" / "data",
    )
    files = {
        path.name: path.read_bytes()
        for home in homes
        for path in sorted(home.iterdir())
        if path.is_file()
    }
    rows = [(i, 0.1 * i - 2, 3 - 0.2 * i) for i in range(40)]
    files["samples.csv"] = ("e,ce,u\n" + "\n".join("%g,%g,%g" % row for row in rows)).encode()
    files["model.json"] = b'{"input": [1, 2], "u": [null, 3.5]}'
    files["own.py"] = OWN_PLANT.encode()
    return files


RULES, CONTROL = "rules.frb", "control.frb"
"""What the two kinds of .frb files are called here."""


@cache
def names_of(kind: str) -> list[str]:
    """Return the names of the files with a suffix, or of `RULES` or `CONTROL`."""
    if kind not in (RULES, CONTROL):
        return [name for name in originals() if name.endswith(kind)]
    return [
        name
        for name, data in originals().items()
        if name.endswith(".frb") and (b"\ncontroller " in b"\n" + data) == (kind == CONTROL)
    ]


def damaged(name: str, data: bytes, r: random.Random) -> bytes:
    """Return a file with some damage: by character and word, by line, by number, or another."""
    others = [originals()[x].decode("utf-8", "replace") for x in names_of(Path(name).suffix)]
    text = data.decode("utf-8", "replace")
    match r.randrange(10):
        case 0 | 1:
            return mutated(text, others or [text], r).encode("utf-8", "surrogatepass")
        case 2 | 3:
            lines = text.split("\n")
            for _ in range(r.choice((1, 1, 3))):
                i = r.randrange(len(lines))
                lines[i : i + 1] = r.choice(([], [lines[i]] * 2, [r.choice(lines)]))
                lines = lines or [""]
            return "\n".join(lines).encode("utf-8", "surrogatepass")
        case 4 | 5 | 6:
            numbers = list(NUMBER.finditer(text))
            for at in r.sample(numbers, min(len(numbers), r.choice((1, 1, 2, 5)))):
                new = r.choice((*ODD_NUMBERS, str(r.randint(-9, 9)), f"{r.uniform(-9, 9):.3g}"))
                text = text[: at.start()] + new + text[at.end() :]
            return text.encode("utf-8", "surrogatepass")
        case 7:
            return r.choice(list(originals().values()))
        case 8:
            return b""
        case _:
            return bytes(r.randrange(256) for _ in range(r.choice((1, 10, 500))))


def lay_out(folder: Path, r: random.Random, command: str) -> dict[str, list[str]]:
    """Write some files into a folder, whole and damaged; return their names by suffix."""
    names: dict[str, list[str]] = {}
    whole = r.choice((0.3, 0.6, 1.0))
    for suffix in (
        RULES, RULES, CONTROL, ".lut", ".csv", ".fis", ".fll", ".fcl", ".json", ".py",
    ):  # fmt: skip
        if not names_of(suffix) or (suffix in (".fll", ".fcl", ".py") and r.random() < 0.5):
            continue
        name = r.choice(names_of(suffix))
        if command == "learn" and suffix == CONTROL:
            name = r.choice(("soc-zero.frb", "soc-table.frb"))
        path, data = folder / name, originals()[name]
        if r.random() < 0.03:
            path.mkdir(exist_ok=True)
        elif path.is_dir() or r.random() < 0.03:
            pass
        elif suffix == ".py" or r.random() < whole:
            path.write_bytes(data)
        else:
            path.write_bytes(damaged(name, data, r))
            if r.random() < 0.03:
                path.chmod(0)
        names.setdefault(suffix, []).append(name)
    # Controllers use the files beside them.
    for name in ("pd7.frb", "alpha7.frb", "fine7.frb", "thesis-6.1.lut"):
        if not (folder / name).exists() and r.random() < 0.8:
            (folder / name).write_bytes(originals()[name])
    return names


# --- Words ---


class Drawing:
    """One command while it is drawn."""

    def __init__(self, r: random.Random, folder: Path) -> None:
        self.r = r
        self.named: list[str] = []
        self.oddity = r.choice((0.0, 0.3, 1.0))
        self.command = r.choices(list(OFTEN), list(OFTEN.values()))[0]
        self.files = lay_out(folder, r, self.command)
        self.folder = folder

    def words(self) -> list[str]:
        """Return a command."""
        r, name = self.r, self.command
        if name == "help":
            return [r.choice(("--help", "help", "--version", "--print-completion", "chekc", ""))]
        arguments = find_command(name).arguments
        positional = [each for each in arguments if not each.names[0].startswith("-")]
        options = [each for each in arguments if each.names[0].startswith("-")]
        words: list[str] = []
        for each in positional:
            words += self.positional(name, each)
        count = r.choice((0, 0, 1, 1, 2, 3, 5))
        chosen = r.sample(options, min(count, len(options)))
        chosen += [x for x in options if x.options.get("required") and x not in chosen]
        if name == "designer" and all("--export" not in x.names for x in chosen):
            chosen += [x for x in options if "--export" in x.names]
        for each in chosen:
            words += self.option(name, each)
        return [name, *words, *self.short(name, words)]

    def short(self, name: str, words: list[str]) -> list[str]:
        """Return what keeps a command short that takes long by its nature, or never ends."""
        always = {
            "tune": ["--evals", "6", "--unseen", "2", "--workers", "1", "--time", "3s"],
            "prove": ["--budget", "1"],
            "reproduce": ["--runs", "1"],
            "watch": ["--once"],
            "fit": ["--rules", "4", "--folds", "2"],
            "sweep": ["--workers", "1", "--random", "2", "-o", "sweep.csv"],
            "convert": ["--seconds", "5"],
        }.get(name, [])
        if name in ("simulate", "sweep", "learn", "tune", "compare"):
            always = [*always, "--segment", "0.2"]
        if name in ("simulate", "sweep", "learn", "tune") and "--plant" in words:
            always = [*always, "--for", "200ms"]
        if name in ("simulate", "sweep", "learn", "tune"):
            always = [*always, "--hold", "0.1"] if self.r.random() < 0.7 else always
        return always

    def positional(self, name: str, each: Argument) -> list[str]:
        """Return the values of a positional argument."""
        r = self.r
        nargs = each.options.get("nargs")
        if name == "reproduce":
            return [r.choice(("7.1.1/cdid+ie", "pd", "7.1.2/fuzzy-direct", *ODD_NAMES))]
        count = {None: 1, "?": int(r.random() < 0.9), "*": int(r.random() < 0.9), "+": 1}[nargs]
        if nargs in ("*", "+") and r.random() < 0.1:
            count += r.choice((1, 2))
        if name == "eval" and each.names[0] == "inputs":
            return [f"{x}={self.number()}" for x in self.inputs() if r.random() < 0.95]
        return [self.value(name, each, str(each.options.get("metavar"))) for _ in range(count)]

    def option(self, name: str, each: Argument) -> list[str]:
        """Return an option and its values."""
        r = self.r
        word = r.choice(each.names)
        options = each.options
        if word in ("--dask", "--tcp", "--python"):
            return []
        if options.get("action") in ("store_true", argparse.BooleanOptionalAction):
            return [word]
        if options.get("choices") is not None:
            choices = [str(x) for x in options["choices"]]
            odd = [r.choice(ODD_NAMES)] if r.random() < 0.25 * self.oddity else []
            return [word, r.choice(odd or choices)]
        metavar = options.get("metavar", "NAME")
        metavars = list(metavar) if isinstance(metavar, tuple) else [str(metavar)]
        if options.get("nargs") == "+":
            metavars *= r.choice((1, 1, 2, 3))
        values = [self.value(name, each, x) for x in metavars]
        # A value that begins with a dash is one of an option only behind an equals sign.
        if len(values) == 1 and word.startswith("--") and r.random() < 0.7:
            return [f"{word}={values[0]}"]
        return [word, *values]

    def value(self, name: str, each: Argument, metavar: str) -> str:
        """Return a value by what it is called on the help page."""
        r = self.r
        if r.random() < 0.05 * self.oddity:
            return r.choice(ODD_NAMES)
        option = each.names[0]
        match metavar:
            case "FILE" | "IN" | "MODEL" | "A" | "B" | "CONTROLLER" | "DATA":
                if option in ("--csv", "--journal", "--animate"):
                    return "out" + r.choice((*SUFFIXES, ".csv", ".csv", ".jsonl"))
                return self.file(name, option, metavar)
            case "OUT" | "FIG" | "PAGE" | "FILE.csv" | "FILE.frb":
                usual = {
                    "OUT": (".lut", ".h", ".st", ".c", ".mjs", ".json", ".csv", ".npz", ".tex"),
                    "FIG": (".svg", ".svg", ".svg", ".png"),
                    "PAGE": (".html",),
                    "FILE.csv": (".csv",),
                    "FILE.frb": (".frb",),
                }[metavar]
                if metavar == "OUT":
                    usual = (".frb", ".fis", ".fcl", ".fll") if name == "convert" else usual
                suffix = r.choice(SUFFIXES) if r.random() < 0.2 * self.oddity else r.choice(usual)
                home = r.choice(("", "", "", "", "", "", "", "", "no such folder/", "/dev/null/"))
                return f"{home}out{suffix}"
            case "DIR":
                return r.choice(("made", ".", "pd7.frb", "no/such"))
            case "PLANT":
                return r.choice(PLANTS)
            case "NAME=VALUE" | "NAME=VALUE,..." | "GAIN=V[,V]" | "NAME=W,...":
                names = self.inputs() or ["e"]
                if metavar == "GAIN=V[,V]":
                    names = ["K_P", "Ke", "Ku", *names]
                parts = [f"{x}={self.number()}" for x in names if r.random() < 0.9]
                return ",".join(parts) if "..." in metavar else r.choice(parts or ["e"])
            case "NAME=A..B" | "NAME=A..B:N":
                low, high = sorted((r.uniform(-5, 5), r.uniform(-5, 5)))
                name = r.choice(["Ke", "Ku", "K_P", "T", "position", *self.inputs()])
                odd = r.choice((f"{low:.3g}..{high:.3g}", "1..", "2..1", "0..0", "nan..1"))
                return f"{name}={odd}" + (":2" if metavar.endswith("N") else "")
            case (
                "NAME=PORT"
                | "PORT=SIGNAL"
                | "INPUT=SIGNAL"
                | "PORT=DEVIATION"
                | "PORT=STEP"
                | ("PORT=TIME")
                | "INPUT=LOW..HIGH"
            ):
                port = r.choice(("position", "voltage", "angle", "level2", "level", "drive", "q"))
                what = r.choice((
                    "step:1", "ramp:0.5", "sine:1,0.5", "quintic:1,2", "samples.csv", "step:",
                    "3ms", "12bit", "0.001", "-5..5", "-5..5,100", "5..-5", "position", "velocity",
                    "noise:1", "step:1,0.1", "0", "-1", "nan", "1e9",
                ))  # fmt: skip
                return f"{port}={what}"
            case "SECONDS" | "S":
                return r.choice(("0.1", "0.2", "1", "1")) if r.random() < 0.8 else self.number()
            case "TIME":
                return r.choice(("10ms", "0.1s", "0.1", "200ms", "1", "0", "-1s", "nan", "1x"))
            case "A1,A2":
                return r.choice(("30,-10", "45,45", "1e9,0", "1", "a,b", "nan,1", "0,0"))
            case "SPEC":
                return r.choice((
                    "49", "-6 .. 6 step 1", "e = 9, ce = 5", "e -6..6 NB ZE PB", "u 0..1 A B", "0",
                    "2", "-6 .. 6 count 0", "x", "e = -6 .. 6 step 0", "1e9", "e 6..-6 A", "u",
                ))  # fmt: skip
            case "HOW":
                return r.choice((
                    "centroid(101)", "centroid", "bisector(10, joined)", "tsukamoto", "x",
                    "mean-of-maximum", "weighted-average", "centroid(0)", "karnik-mendel",
                ))  # fmt: skip
            case "LINE":
                return r.choice(("peaks e, ce mirrored", "gain Ke 0.1 .. 10 times", "x", "keep u"))
            case "COST":
                return r.choice(("rms", "rms + chatter", "x", "max(rms, 1", "1/0", "rms^2"))
            case "NAME":
                return r.choice((
                    "u", "e", "rms", "max", "overshoot", "u", "v", "motor", *ODD_NAMES,
                ))  # fmt: skip
            case "N" | "T" | "V" | "H" | "VALUE" | "STEP" | "R" | "L" | "A1" | "A2" | "T1" | "T2":
                return self.number(whole=metavar == "N")
            case _:
                return r.choice((self.number(), *ODD_NAMES))

    def file(self, name: str, option: str, metavar: str) -> str:
        """Return a file of the folder, mostly of a kind that fits."""
        r = self.r
        suffix = CONTROL if metavar == "CONTROLLER" or name == "tune" else RULES
        if metavar == "DATA" or (option in ("--data", "--test")):
            suffix = r.choice((".csv", ".csv", ".csv", ".lut", RULES))
        elif option in ("--table", "--performance"):
            suffix = ".lut"
        elif name == "convert":
            suffix = r.choice((RULES, RULES, ".fis", ".fll", ".fcl", ".lut", ".py"))
        elif name == "designer":
            suffix = r.choice((RULES, RULES, RULES, RULES, CONTROL, ".lut"))
        elif metavar in ("FILE", "A", "B", "IN") and name != "tune":
            usual = (CONTROL, ".lut", ".fis", ".fll", ".fcl", ".json")
            suffix = r.choice((RULES, RULES, RULES, RULES, r.choice(usual)))
        if r.random() < 0.04:
            suffix = r.choice(list(self.files))
        if metavar == "CONTROLLER" and r.random() < 0.3:
            return r.choice(("pd", "fuzzy-direct", "soc-zero", "pd+stfc", "acdid", "hfie", "lut"))
        chosen = r.choice(self.files.get(suffix, ["no such.frb"]))
        self.named.append(chosen)
        return chosen

    def inputs(self) -> list[str]:
        """Return the inputs that the file asked for names, or another of the folder."""
        names: list[str] = []
        for each in (*self.named, *self.files.get(RULES, [])):
            path = self.folder / each
            if path.is_file() and os.access(path, os.R_OK):
                names += re.findall(r"^input\s+(\S+)", path.read_text("utf-8", "replace"), re.M)
            if names:
                break
        return list(dict.fromkeys(names))[:4]

    def number(self, *, whole: bool = False) -> str:
        """Return a number, mostly a sound one."""
        r = self.r
        if r.random() < 0.25 * self.oddity:
            # Of what is counted, a number that is sound and large takes as long as it says.
            return r.choice([x for x in ODD_NUMBERS if not (whole and x.isdigit() and len(x) > 2)])
        return str(r.randint(0, 5)) if whole else f"{r.uniform(-3, 3):.3g}"


# --- What is wrong with what came out ---


class Fault(NamedTuple):
    """A command that did something wrong: its number, of what class, and what came out."""

    number: int
    sort: str
    outcome: Outcome


def faults(outcome: Outcome, folder: Path, before: set[str]) -> Iterator[str]:
    """Yield what is wrong, by class."""
    name = outcome.words[0] if outcome.words else ""
    status = outcome.status
    if outcome.trace and status != HUNG:
        last = outcome.trace.rstrip().splitlines()[-1].split(":")[0]
        place = re.findall(r'File "[^"]*?(fuzzyarm/[^"]+)", line (\d+)', outcome.trace)
        yield f"{last} at {':'.join(place[-1]) if place else '?'}"
        return
    if status == HUNG:
        place = re.findall(r'File "[^"]*?(src/fuzzyarm/[^"]+)", line \d+ in (\w+)', outcome.trace)
        yield f"longer than the limit: {name} in {' < '.join(w for _, w in place[:4])}"
        return
    allowed = {0, 1, 2}
    allowed |= {3} if name in DIVERGES else set()
    allowed |= {4} if name in UNDECIDED else set()
    if status not in allowed:
        yield f"status {status} of {name}"
        return
    if status != 0 and not outcome.err.strip():
        yield f"status {status} of {name} without a word"
    for text in (outcome.out, outcome.err):
        if "Traceback (most recent call last)" in text or "a fault of the program" in text:
            yield f"{name} prints a traceback"
    if status == 0 and re.search(r"^fuzzyarm: error|: error\[", outcome.err, re.M):
        yield f"status 0 of {name} with an error"
    if "Warning:" in outcome.err:
        yield f"{name} warns of itself: {outcome.err[outcome.err.index('Warning:') :][:80]}"
    if "--json" in outcome.words and status in (0, 3) and name not in ("lsp", "studio"):
        yield from _json_faults(outcome, name)
    for path in folder.iterdir():
        if path.name in before or path.name.startswith(".std"):
            continue
        if path.name.startswith(".") or path.suffix == ".tmp":
            yield f"{name} leaves {path.suffix or path.name} behind"
        elif path.suffix == ".frb" and path.is_file() and name != "shipped":
            errors = [x for x in parse(path.read_text("utf-8")).diagnostics if x.is_error]
            if errors:
                yield f"{name} writes what cannot be read: {errors[0].message}"
        elif path.suffix == ".json" and path.is_file():
            if (fault := _json_fault(path.read_text("utf-8"))) is not None:
                yield f"{name} writes JSON that is none: {fault}"


def _json_faults(outcome: Outcome, name: str) -> Iterator[str]:
    if (fault := _json_fault(outcome.out)) is not None:
        yield f"{name} --json prints what is none: {fault}"


def _json_fault(text: str) -> str | None:
    """Return why a text is not JSON; `NaN` and `Infinity` are not."""

    def refuse(word: str) -> Any:
        raise ValueError(f"the word {word}")

    try:
        json.loads(text, parse_constant=refuse)
    except ValueError as error:
        return str(error)
    return None


# --- The search ---


def search(
    seed: int, count: int, first: int = 0, limit: float = 20.0, told: Any = None
) -> Iterator[Fault]:
    """Yield the faults of commands `first` to `first + count`."""
    # A cache of machine code for each case would be compiled anew: the home stays the same.
    with Worker(limit, {"FUZZYARM_PROGRESS": "0"}) as worker:
        for number in range(first, first + count):
            r = random.Random(f"{seed} {number}")
            folder = Path(tempfile.mkdtemp(prefix="commands"))
            try:
                words = Drawing(r, folder).words()
                before = {path.name for path in folder.iterdir()}
                stdin = r.choice((b"", b"y\n", originals()["pd7.frb"], b"\xff\x00"))
                outcome = worker.run(words, folder, stdin)
                if told is not None:
                    told(number, outcome)
                for sort in faults(outcome, folder, before):
                    yield Fault(number, sort, outcome)
            finally:
                shutil.rmtree(folder, ignore_errors=True)


def main() -> int:
    """Be a script; print a finding of each sort."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="number of the first command")
    parser.add_argument("--limit", type=float, default=20.0, help="seconds for a command")
    parser.add_argument("--every", type=int, default=0, help="say where it is after so many")
    chosen = parser.parse_args()
    start, sorts = time.monotonic(), dict[str, list[Fault]]()
    statuses: dict[str, int] = {}

    def told(number: int, outcome: Outcome) -> None:
        key = f"{outcome.words[0] if outcome.words else ''} {outcome.status}"
        statuses[key] = statuses.get(key, 0) + 1
        if chosen.every and (number + 1) % chosen.every == 0:
            print(f"... {number + 1}, {time.monotonic() - start:.0f} s", flush=True)

    for fault in search(chosen.seed, chosen.count, chosen.first, chosen.limit, told):
        if fault.sort not in sorts:
            print(f"=== {fault.sort}\n--- command {fault.number}: {list(fault.outcome.words)}")
            print(f"{fault.outcome.seconds:.1f} s, status {fault.outcome.status}")
            print("\n".join(fault.outcome.trace.rstrip().splitlines()[-6:]), flush=True)
        sorts.setdefault(fault.sort, []).append(fault)
    print("\n".join(f"{len(alike):5} {sort}" for sort, alike in sorted(sorts.items())))
    print("; ".join(f"{key}: {n}" for key, n in sorted(statuses.items())))
    total = sum(map(len, sorts.values()))
    seconds = time.monotonic() - start
    print(f"{chosen.count} commands, {total} findings of {len(sorts)} sorts, {seconds:.0f} s")
    return int(bool(sorts))


if __name__ == "__main__":
    sys.exit(main())
