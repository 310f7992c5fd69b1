"""Words of commands at random, sound and not, and the files that they are asked of.

Words come from the records of the commands: a new command or option is drawn by itself. Files are
the shipped ones and those of the tests, damaged by character, line and number, swapped for
files of other kinds, empty, binary, missing, unreadable or folders.
"""

from __future__ import annotations

import argparse
import os
import random
import re
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

from fuzzyarm.apps.cli.command import Argument
from fuzzyarm.apps.cli.main import find_command
from tests.formats.mutation import mutated

ROOT = Path(__file__).resolve().parents[2]

OFTEN = {
    "check": 8, "fmt": 3, "eval": 10, "show": 6, "plot": 4, "diff": 4, "prove": 4, "compile": 10,
    "convert": 10, "simulate": 14, "sweep": 6, "compare": 1, "learn": 8, "tune": 3,
    "fit": 3, "validate": 4, "watch": 2, "new": 2, "shipped": 1, "lsp": 1,
    "reproduce": 0.5, "margins": 2, "cite": 2, "grade": 1, "demo": 0.05, "help": 1,
}  # fmt: skip
"""How often each command is drawn, in parts.

`identify` searches for minutes by its nature; `designer` serves until its end; `playground` asks
npm and compiles for another platform.
"""

ODD_NAMES = (
    "", " ", "-", "--", "e", "nan", "no such", "'", '"', "é", "💧", "\u202e", "a" * 300, "./.",
    "%", "{}", "x=1", "NAME", "\t", "\\", "x" * 5000,
)  # fmt: skip
ODD_NUMBERS = (
    "0", "-1", "1e308", "-1e308", "1e-320", "nan", "inf", "-inf", "", "x", "1,2", "0x10", "1e", "²",
    "--1", "1e-300", "0.5", "99999999999999999999", "7", "٣",
)  # fmt: skip
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

RULES, CONTROL = "rules.frb", "control.frb"
"""What the two kinds of .frb files are called here."""

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
    rows = [f"{i},{0.1 * i - 2:g},{3 - 0.2 * i:g}" for i in range(40)]
    files["samples.csv"] = "\n".join(["e,ce,u", *rows]).encode()
    files["model.json"] = b'{"input": [1, 2], "u": [null, 3.5]}'
    files["own.py"] = OWN_PLANT.encode()
    return files


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


def _mistyped(name: str, data: bytes, r: random.Random) -> bytes:
    others = [originals()[x].decode("utf-8", "replace") for x in names_of(Path(name).suffix)]
    text = data.decode("utf-8", "replace")
    return mutated(text, others or [text], r).encode("utf-8", "surrogatepass")


def _lines_changed(_name: str, data: bytes, r: random.Random) -> bytes:
    lines = data.split(b"\n")
    for _ in range(r.choice((1, 1, 3))):
        i = r.randrange(len(lines))
        lines[i : i + 1] = r.choice(([], [lines[i]] * 2, [r.choice(lines)]))
        lines = lines or [b""]
    return b"\n".join(lines)


def _numbers_changed(_name: str, data: bytes, r: random.Random) -> bytes:
    text = data.decode("utf-8", "replace")
    numbers = list(NUMBER.finditer(text))
    chosen = r.sample(numbers, min(len(numbers), r.choice((1, 1, 2, 5))))
    for at in sorted(chosen, key=lambda match: -match.start()):
        new = r.choice((*ODD_NUMBERS, str(r.randint(-9, 9)), f"{r.uniform(-9, 9):.3g}"))
        text = text[: at.start()] + new + text[at.end() :]
    return text.encode("utf-8", "surrogatepass")


def _swapped(_name: str, _data: bytes, r: random.Random) -> bytes:
    return r.choice(list(originals().values()))


def _emptied(_name: str, _data: bytes, _r: random.Random) -> bytes:
    return b""


def _noise(_name: str, _data: bytes, r: random.Random) -> bytes:
    return r.randbytes(r.choice((1, 10, 500)))


DAMAGE: tuple[Callable[[str, bytes, random.Random], bytes], ...] = (
    _mistyped, _mistyped, _lines_changed, _lines_changed, _numbers_changed, _numbers_changed,
    _numbers_changed, _swapped, _emptied, _noise,
)  # fmt: skip


def write_file(path: Path, data: bytes, r: random.Random, whole: float) -> None:
    """Write a file, or what may stand in its place; `whole` is the share that stays sound."""
    chance = r.random()
    if path.exists() or chance < 0.03:
        return
    if chance < 0.06:
        path.mkdir()
    elif path.suffix == ".py" or r.random() < whole:
        path.write_bytes(data)
    else:
        path.write_bytes(r.choice(DAMAGE)(path.name, data, r))
        if chance < 0.09:
            path.chmod(0)


def lay_out(folder: Path, r: random.Random, command: str) -> dict[str, list[str]]:
    """Write some files into a folder, whole and damaged; return their names by kind."""
    names: dict[str, list[str]] = {}
    whole = r.choice((0.3, 0.6, 1.0))
    for kind in (RULES, RULES, CONTROL, ".lut", ".csv", ".fis", ".fll", ".fcl", ".json", ".py"):
        if kind in (".fll", ".fcl", ".py") and r.random() < 0.5:
            continue
        name = r.choice(names_of(kind))
        if command == "learn" and kind == CONTROL:
            name = r.choice(("soc-zero.frb", "soc-table.frb"))
        write_file(folder / name, originals()[name], r, whole)
        names.setdefault(kind, []).append(name)
    # Controllers use the files beside them.
    for name in ("pd7.frb", "alpha7.frb", "fine7.frb", "thesis-6.1.lut"):
        if not (folder / name).exists() and r.random() < 0.8:
            (folder / name).write_bytes(originals()[name])
    return names


# --- Words ---

FILES = frozenset({"FILE", "IN", "MODEL", "A", "B", "CONTROLLER", "DATA"})
"""What values are called that are files to be read."""

OUTPUTS = {
    "OUT": (".lut", ".h", ".st", ".c", ".mjs", ".json", ".csv", ".npz", ".tex"),
    "FIG": (".svg", ".svg", ".svg", ".png"),
    "FILE.csv": (".csv",),
    "FILE.frb": (".frb",),
}
"""What values are called that are files to be written, with their usual suffixes."""

PORTS = (
    "step:1", "ramp:0.5", "sine:1,0.5", "quintic:1,2", "samples.csv", "step:", "3ms", "12bit",
    "0.001", "-5..5", "-5..5,100", "5..-5", "position", "velocity", "noise:1", "step:1,0.1", "0",
    "-1", "nan", "1e9",
)  # fmt: skip
WORDS = {
    "DIR": ("made", ".", "pd7.frb", "no/such"),
    "PLANT": (
        "arm", "motor", "cartpole", "tanks", "ball-and-beam", "room", "nothing", "own.py:Own",
        "own.py",
    ),
    "TIME": ("10ms", "0.1s", "0.1", "200ms", "1", "0", "-1s", "nan", "1x"),
    "A1,A2": ("30,-10", "45,45", "1e9,0", "1", "a,b", "nan,1", "0,0"),
    "SPEC": (
        "49", "-6 .. 6 step 1", "e = 9, ce = 5", "e -6..6 NB ZE PB", "u 0..1 A B", "0", "2",
        "-6 .. 6 count 0", "x", "e = -6 .. 6 step 0", "1e9", "e 6..-6 A", "u", "5", "9",
    ),
    "HOW": (
        "centroid(101)", "centroid", "bisector(10, joined)", "tsukamoto", "x", "mean-of-maximum",
        "weighted-average", "centroid(0)", "karnik-mendel",
    ),
    "LINE": ("peaks e, ce mirrored", "gain Ke 0.1 .. 10 times", "x", "keep u"),
    "COST": ("rms", "rms + chatter", "x", "max(rms, 1", "1/0", "rms^2"),
    "NAME": ("u", "e", "rms", "max", "overshoot", "u", "v", "motor", *ODD_NAMES),
    "WORD": ("zero", "table", "thesis-6.1.lut", "yamazaki", "procyk-mamdani", "x"),
    "WHAT": ("linear", "nearest", "bins", "thesis-6.1.lut", "x"),
    "N,N,...": ("2", "2,3", "0", "3,3,3", "x"),
    "N[..N]": ("3", "2..4", "0", "4..2", "x"),
    "X,Y": ("Ke,Ku", "x,y", "Ke"),
    "A,B,...": ("e", "e,ce", "x", "u"),
}  # fmt: skip
"""Values by what they are called on the help pages."""

SHORT = {
    "tune": ["--evals", "6", "--unseen", "2", "--workers", "1", "--time", "3s"],
    "prove": ["--budget", "1"],
    "margins": ["--budget", "1"],
    "reproduce": ["--runs", "1"],
    "watch": ["--once"],
    "fit": ["--rules", "4", "--folds", "2"],
    "sweep": ["--workers", "1", "--random", "2", "-o", "sweep.csv"],
    "convert": ["--seconds", "5"],
}
"""What keeps commands short that take long by their nature, or never end."""

IN_LOOPS = frozenset({"simulate", "sweep", "learn", "tune"})

ELSEWHERE = frozenset({"--dask", "--tcp", "--python"})
"""Options that leave this machine, or this Python."""


class Drawing:
    """One command while it is drawn, and its files in a folder."""

    def __init__(self, r: random.Random, folder: Path, often: dict[str, float]) -> None:
        self.r = r
        self.named: list[str] = []
        self.oddity = r.choice((0.0, 0.3, 1.0))
        self.command = r.choices(list(often), list(often.values()))[0]
        self.files = lay_out(folder, r, self.command)
        self.folder = folder

    def words(self) -> list[str]:
        """Return a command."""
        r, name = self.r, self.command
        if name == "help":
            return [r.choice(("--help", "help", "--version", "--print-completion", "chekc", ""))]
        arguments = find_command(name).arguments
        options = [each for each in arguments if each.names[0].startswith("-")]
        words: list[str] = []
        for each in arguments:
            if each not in options:
                words += self._positional(each)
        chosen = r.sample(options, min(r.choice((0, 0, 1, 1, 2, 3, 5)), len(options)))
        for each in options:
            if each not in chosen and each.options.get("required"):
                chosen.append(each)
        for each in chosen:
            words += self._option(each)
        return [name, *words, *self._short(words)]

    def _short(self, words: Sequence[str]) -> list[str]:
        always = list(SHORT.get(self.command, []))
        if self.command in IN_LOOPS | {"compare"}:
            always += ["--segment", "0.2"]
        if self.command in IN_LOOPS:
            always += ["--for", "200ms"] if any("--plant" in each for each in words) else []
            always += ["--hold", "0.1"] if self.r.random() < 0.7 else []
        return always

    def _positional(self, each: Argument) -> list[str]:
        r, nargs = self.r, each.options.get("nargs")
        if self.command == "reproduce":
            return [r.choice(("7.1.1/cdid+ie", "pd", "7.1.2/fuzzy-direct", *ODD_NAMES))]
        if self.command == "eval" and each.names[0] == "inputs":
            return [f"{x}={self._number()}" for x in self._inputs() if r.random() < 0.95]
        count = int(r.random() < 0.9) if nargs in ("?", "*") else 1
        if nargs in ("*", "+") and r.random() < 0.1:
            count += r.choice((1, 2))
        return [self._value(each, str(each.options.get("metavar"))) for _ in range(count)]

    def _option(self, each: Argument) -> list[str]:
        r, options = self.r, each.options
        word = r.choice(each.names)
        if word in ELSEWHERE:
            return []
        if options.get("action") in ("store_true", argparse.BooleanOptionalAction):
            return [word]
        if options.get("choices") is not None:
            odd = [r.choice(ODD_NAMES)] if r.random() < 0.25 * self.oddity else []
            return [word, str(r.choice(odd or options["choices"]))]
        metavar = options.get("metavar", "NAME")
        metavars = list(metavar) if isinstance(metavar, tuple) else [str(metavar)]
        if options.get("nargs") == "+":
            metavars *= r.choice((1, 1, 2, 3))
        values = [self._value(each, x) for x in metavars]
        # A value that begins with a dash is one of an option only behind an equals sign.
        if len(values) == 1 and word.startswith("--") and r.random() < 0.7:
            return [f"{word}={values[0]}"]
        return [word, *values]

    def _value(self, each: Argument, metavar: str) -> str:
        """Return a value by what it is called on the help page."""
        r = self.r
        if r.random() < 0.05 * self.oddity:
            return r.choice(ODD_NAMES)
        if metavar in FILES:
            return self._file(each.names[0], metavar)
        if metavar in OUTPUTS:
            return self._output(metavar)
        if "=" in metavar:
            return self._assignment(metavar)
        if metavar in WORDS:
            return r.choice(WORDS[metavar])
        return self._number(whole=metavar == "N")

    def _output(self, metavar: str) -> str:
        r, usual = self.r, OUTPUTS[metavar]
        if metavar == "OUT" and self.command == "convert":
            usual = (".frb", ".fis", ".fcl", ".fll")
        suffix = r.choice(SUFFIXES if r.random() < 0.2 * self.oddity else usual)
        odd = r.random() < 0.1 * self.oddity
        return f"{r.choice(('no such folder/', '/dev/null/')) if odd else ''}out{suffix}"

    def _assignment(self, metavar: str) -> str:
        r, names = self.r, self._inputs() or ["e"]
        if ".." in metavar and "..." not in metavar:
            low, high = sorted((r.uniform(-5, 5), r.uniform(-5, 5)))
            name = r.choice(["Ke", "Ku", "K_P", "T", "position", *names])
            ends = r.choice((f"{low:.3g}..{high:.3g}", "1..", "2..1", "0..0", "nan..1"))
            return f"{name}={ends}" + (":2" if metavar.endswith("N") else "")
        if "PORT" in metavar or "INPUT" in metavar:
            port = r.choice(("position", "voltage", "angle", "level2", "level", "drive", "q"))
            return f"{port}={r.choice(PORTS)}"
        if metavar.startswith("GAIN"):
            names = ["K_P", "Ke", "Ku", *names]
        parts = [f"{x}={self._number()}" for x in names if r.random() < 0.9]
        return ",".join(parts) if "..." in metavar else r.choice(parts or ["e"])

    def _file(self, option: str, metavar: str) -> str:
        """Return a file of the folder, mostly of a kind that fits."""
        r = self.r
        if option in ("--csv", "--journal", "--animate"):
            return "out" + r.choice((*SUFFIXES, ".csv", ".csv", ".jsonl"))
        if metavar == "CONTROLLER" and r.random() < 0.3:
            return r.choice(("pd", "fuzzy-direct", "soc-zero", "pd+stfc", "acdid", "hfie", "lut"))
        kind = r.choice(self._kinds(option, metavar))
        if r.random() < 0.06:
            kind = r.choice(list(self.files))
        chosen = r.choice(self.files.get(kind, ["no such.frb"]))
        self.named.append(chosen)
        return chosen

    def _kinds(self, option: str, metavar: str) -> Sequence[str]:
        """Return the kinds of files that an option takes."""
        if metavar == "DATA" or option in ("--data", "--test"):
            return (".csv", ".csv", ".csv", ".lut", RULES)
        if option in ("--table", "--performance"):
            return (".lut",)
        if metavar == "CONTROLLER" or self.command == "tune":
            return (*[CONTROL] * 9, RULES)
        if self.command == "convert":
            return (RULES, RULES, ".fis", ".fll", ".fcl", ".lut", ".py")
        others = (CONTROL, ".lut", ".fis", ".fll", ".fcl", ".json")
        return (RULES, RULES, RULES, RULES, self.r.choice(others))

    def _inputs(self) -> list[str]:
        """Return the inputs that the file asked for names, or another of the folder."""
        names: list[str] = []
        for each in (*self.named, *self.files.get(RULES, [])):
            path = self.folder / each
            if path.is_file() and os.access(path, os.R_OK):
                text = path.read_text("utf-8", "replace")
                names += re.findall(r"^input\s+(\S+)", text, re.MULTILINE)
            if names:
                break
        return list(dict.fromkeys(names))[:4]

    def _number(self, *, whole: bool = False) -> str:
        """Return a number, mostly a sound one."""
        r = self.r
        if r.random() < 0.25 * self.oddity:
            # Of what is counted, a number that is sound and large takes as long as it says.
            return r.choice([x for x in ODD_NUMBERS if not (whole and x.isdigit() and len(x) > 2)])
        return str(r.randint(0, 5)) if whole else f"{r.uniform(-3, 3):.3g}"
