"""Folders for Arduino and PlatformIO: built, run and counted on the processor."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from avr_programs import (
    STRICT,
    TARGET,
    build,
    cycles_by_eighths,
    need_avr,
    run_sketch,
    run_sketch_text,
)

from fuzzyarm import shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.exchange.export import avr, routines_of
from fuzzyarm.exchange.export.avr import clock_of
from fuzzyarm.exchange.export.boards import BOARDS
from fuzzyarm.language import load_rulebase

PD7 = str(shipped("pd7.frb"))
TIPPER2 = str(shipped("tipper2.frb"))


@pytest.fixture
def tipper(tmp_path, monkeypatch):
    """The tipper as a file of MATLAB, in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    assert main(["convert", str(shipped("tipper.frb")), "tipper.fis"]) == 0
    return tmp_path


def figures(readme: str) -> dict[str, list[int]]:
    """Return the numbers of each line of a list, by its first word."""
    lines = re.findall(r"^- ([\w ]+?)(?: of a call)?: (.*)$", readme, re.MULTILINE)
    return {
        word: [int(x) for x in re.findall(r"(?<![\d.])\d+(?![\d.])", rest)] for word, rest in lines
    }


def test_a_fis_becomes_a_library_that_the_processor_runs_as_stated(tipper, capsys):
    need_avr()
    assert main(["compile", "tipper.fis", "--for", "arduino", "-o", "tip"]) == 0
    said = capsys.readouterr().out
    assert "the self-test passes" in said
    readme = Path("tip/README.md").read_text("utf-8")
    stated = figures(readme)
    assert "- self-test: passes" in readme
    source = Path("tip/src").resolve()
    build(source, *TARGET, *STRICT, "-std=gnu11", "-c", "tipper.c", "-o", tipper / "own.o")
    words = subprocess.run(
        ["avr-size", tipper / "own.o"], capture_output=True, text=True, check=True
    )
    text, data, bss = map(int, words.stdout.splitlines()[1].split()[:3])
    assert stated["object file of the library"] == [text]
    assert (data, bss) == (0, 0), "tables stay in flash"
    assert stated["RAM"][0] == 0
    (routine,) = routines_of(load_file("tipper.fis"), precision="float32")
    points = list(zip(*(x.tolist() for x in routine.pieces().inputs), strict=True))  # fit its RAM
    counted = cycles_by_eighths(source, "tipper.h", "float", "tipper_tip", points)
    low, high, over = stated["cycles"][:3]
    assert over < len(counted) == len(points)
    # The slowest of those that were measured stands for all points in and between pieces.
    assert max(counted) / 1.03 < high < 1.03 * max(counted)
    assert low < min(counted) + 100  # less far outside the ranges


def load_file(path):
    from fuzzyarm import load

    return load(path)


@pytest.mark.slow
def test_the_sketches_run_with_the_arduino_core(tipper, tmp_path_factory):
    need_avr(core=True)
    assert main(["compile", "tipper.fis", "--for", "arduino", "-o", "tip"]) == 0
    room, library = tmp_path_factory.mktemp("core"), Path("tip").resolve()
    examples = library / "examples"
    said = run_sketch(library, examples / "tipper_test" / "tipper_test.ino", room)
    assert "the same" in said
    assert "not the same" not in said
    said = run_sketch(library, examples / "tipper_example" / "tipper_example.ino", room)
    (routine,) = routines_of(load_file("tipper.fis"), precision="float32")
    shown = float(re.search(r"tip ([\d.]+)", said)[1].rstrip("."))
    assert shown == pytest.approx(float(routine.evaluate(0.0, 0.0)), abs=6e-4)
    # Names that are macros of the core or registers of the chip.
    Path("names.frb").write_text(
        "rulebase names\ninput SP 0 .. 1\ninput B1 0 .. 1\ninput PI 0 .. 1\noutput DDRB 0 .. 1\n"
        "terms SP, B1, PI, DDRB: triangles LO HI\n"
        "rule if SP is LO and B1 is LO and PI is LO then DDRB is HI\n"
        "rule if SP is HI then DDRB is LO\n"
    )
    assert main(["compile", "names.frb", "--for", "arduino", "-o", "names"]) == 0
    library = Path("names").resolve()
    run_sketch(library, library / "examples" / "names_example" / "names_example.ino", room)
    turn = str(shipped("servo.frb"))
    assert main(["compile", turn, "--for", "arduino", "-o", "servo", "--table"]) == 0
    library = Path("servo").resolve()
    said = run_sketch(library, library / "examples" / "servo_test" / "servo_test.ino", room)
    assert "the same" in said
    run_sketch(library, library / "examples" / "servo_example" / "servo_example.ino", room)


def test_the_table_of_pd7_in_eight_bits_is_small(tmp_path, monkeypatch, capsys):
    need_avr()
    monkeypatch.chdir(tmp_path)
    words = ["compile", PD7, "--for", "arduino", "-o", "pd7", "--q", "7", "--json"]
    assert main(words) == 0
    measured = json.loads(capsys.readouterr().out)["measured"]
    assert measured["flash"] < 1024
    assert measured["ram"] + measured["stack"] < 100
    assert measured["self_test"] is True
    assert max(measured["cycles"]) < 400
    readme = Path("pd7/README.md").read_text("utf-8")
    assert figures(readme)["flash"][0] == measured["flash"]
    assert figures(readme)["cycles"][:2] == [min(measured["cycles"]), max(measured["cycles"])]


def test_without_a_compiler_the_page_says_how_to_measure(tipper, monkeypatch, capsys):
    monkeypatch.setattr(avr.shutil, "which", lambda name: None)
    assert main(["compile", "tipper.fis", "--for", "arduino", "-o", "tip"]) == 0
    assert "not measured here" in capsys.readouterr().out
    readme = " ".join(Path("tip/README.md").read_text("utf-8").split())
    assert f"apt-get install {avr.TOOLS}" in readme


def test_a_project_for_platformio_has_its_board(tipper):
    words = ["--for", "platformio", "--board", "pico", "-o", "project"]
    assert main(["compile", "tipper.fis", *words]) == 0
    project = Path("project")
    assert "board = pico" in (project / "platformio.ini").read_text()
    library = json.loads((project / "lib" / "tipper" / "library.json").read_text())
    assert library["name"] == "tipper"
    assert library["platforms"] == "raspberrypi"
    assert "double" in (project / "lib" / "tipper" / "src" / "tipper.c").read_text()
    main_text = (project / "src" / "main.cpp").read_text()
    assert main_text.startswith("#include <Arduino.h>")
    assert "tipper_tip(service, food)" in main_text


def test_properties_are_what_the_ide_demands(tipper):
    assert main(["compile", "tipper.fis", "--for", "arduino", "-o", "tip"]) == 0
    text = Path("tip/library.properties").read_text()
    pairs = dict(line.split("=", 1) for line in text.splitlines())
    assert set(pairs) >= {
        "name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url",
        "architectures",
    }  # fmt: skip
    assert re.fullmatch(r"[A-Za-z0-9][\w .-]*", pairs["name"])
    for line in Path("tip/keywords.txt").read_text().splitlines():
        assert re.fullmatch(r"\w+\tKEYWORD[123]", line)
    for path in Path("tip/examples").iterdir():
        assert (path / f"{path.name}.ino").is_file(), "a sketch lies in a folder of its name"


HUGE = (
    "rulebase huge\ninput a 0 .. 1\ninput b 0 .. 1\noutput y 0 .. 1\n"
    + "".join(
        f"term {name} T{k}: triangle {k / 30 - 0.05} {k / 30} {k / 30 + 0.05}\n"
        for name in "aby"
        for k in range(31)
    )
    + "".join(
        f"rule if a is T{i} and b is T{j} then y is T{(i * j) % 31}\n"
        for i in range(0, 31, 3)
        for j in range(0, 31, 8)
    )
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "messages"),
    [
        ([str(shipped("soc-zero.frb"))], ["bytes of RAM", "Arduino Uno has 2,048", "--board mega"]),
        ([TIPPER2], ["double precision only", "Arduino Uno has no double", "--table"]),
        ([PD7, "--levels", "101"],
         ["bytes of flash", "Arduino Uno has 32,256", "--q 7", "--board due or pico or esp32"]),
        ([PD7, "--levels", "101", "--board", "mega"],
         ["has 40,804 bytes in one array", "Mega 2560 reads at most 32,767 of its 253,952",
          "--board due or pico or esp32"]),
        ([str(shipped("stfc.frb")), "--table", "--levels", "90", "--board", "mega"],
         ["bytes of constants", "Mega 2560 reads at most 64,000 of its 253,952"]),
        ([PD7, "--precision", "float64"], ["an Arduino Uno has no double"]),
        ([PD7, "--board", "una"], ["no board 'una'", "uno"]),
        ([PD7, "--ends"], ["--ends does not apply"]),
    ],
)  # fmt: skip
def test_what_a_board_cannot_hold_is_said_with_the_numbers(
    tmp_path, monkeypatch, capsys, words, messages
):
    monkeypatch.chdir(tmp_path)
    usage = "--precision" in words or "--ends" in words
    assert main(["compile", *words, "--for", "arduino", "-o", "made"]) == (2 if usage else 1)
    out, err = capsys.readouterr()
    assert out == ""
    for message in messages:
        assert message in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_too_many_rules_for_the_flash_are_counted(tmp_path, monkeypatch, capsys):
    need_avr()
    monkeypatch.chdir(tmp_path)
    Path("huge.frb").write_text(HUGE)
    assert main(["compile", "huge.frb", "--for", "arduino", "-o", "made"]) == 1
    err = capsys.readouterr().err
    size = int(re.search(r"takes ([\d,]+) bytes of flash", err)[1].replace(",", ""))
    assert 32_256 < size < BOARDS["mega"].flash
    assert "--board mega" in err
    assert not Path("made").exists()


@pytest.mark.slow
def test_what_fits_without_its_self_test_is_measured_all_the_same(tmp_path, monkeypatch, capsys):
    need_avr()
    monkeypatch.chdir(tmp_path)
    terms = " ".join(f"T{k}" for k in range(16))
    rules = (f"rule if a is T{i} and b is T{j} then y is T{(3 * i + 5 * j) % 16}\n"
             for i in range(16) for j in range(16))  # fmt: skip
    Path("large.frb").write_text(
        "rulebase large\ninput a 0 .. 1\ninput b 0 .. 1\noutput y 0 .. 1\n"
        f"terms a, b, y: triangles {terms}\ninference and product, implication product,"
        " aggregation sum, no-rule 0\n" + "".join(rules)
    )
    assert main(["compile", "large.frb", "--for", "arduino", "--direct", "-o", "made"]) == 0
    said = capsys.readouterr().out
    flash = int(re.search(r"flash ([\d,]+) of", said)[1].replace(",", ""))
    assert 29_000 < flash < 32_256  # and the self-test takes some 4,000 more
    assert "the self-test passes" in said


def test_options_for_boards_need_one(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["compile", PD7, "-o", "x.h", "--board", "uno"]) == 2
    assert "without --for" in capsys.readouterr().err


@pytest.mark.slow
def test_every_numbering_passes_its_test_on_the_chip(tmp_path, monkeypatch, capsys):
    need_avr()
    monkeypatch.chdir(tmp_path)
    for name, options in {
        "direct": ["--direct"], "bins": [], "linear": ["--mode", "linear"],
        "seven": ["--q", "7", "--mode", "linear"], "fifteen": ["--q", "15"],
    }.items():  # fmt: skip
        assert main(["compile", PD7, "--for", "arduino", "-o", name, "--json", *options]) == 0
        measured = json.loads(capsys.readouterr().out)["measured"]
        assert measured["self_test"] is True, name
        assert measured["ram"] == 0, name


def test_the_model_is_what_the_self_test_holds():
    """What passes on the chip is the arithmetic of single precision to the tolerance stated."""
    (routine,) = routines_of(load_rulebase(PD7), precision="float32")
    vectors = routine.vectors()
    assert vectors.expected.dtype == np.float32
    assert vectors.tolerance < 1e-3


def test_a_folder_is_replaced_and_what_is_not_ours_is_left_alone(tipper, capsys):
    words = ["compile", "tipper.fis", "--for", "arduino", "-o", "tip"]
    assert main(words) == 0
    (tipper / "tip" / "notes.txt").write_text("mine")
    assert main([*words, "--table", "--levels", "5"]) == 0
    assert (tipper / "tip" / "notes.txt").read_text() == "mine"
    capsys.readouterr()
    sketch = tipper / "tip" / "examples" / "tipper_example" / "tipper_example.ino"
    sketch.write_text(sketch.read_text() + "// mine\n")
    before = {path: path.read_bytes() for path in tipper.rglob("*") if path.is_file()}
    assert main(words) == 1
    assert "files that were changed" in capsys.readouterr().err
    (tipper / "other").mkdir()
    (tipper / "other" / "thesis.tex").write_text("mine")
    assert main([*words[:-1], "other"]) == 1
    assert "not of fuzzyarm: it has thesis.tex" in capsys.readouterr().err
    assert main([*words[:-1], "tipper.fis"]) == 1
    assert "is a file, not a folder" in capsys.readouterr().err
    before[tipper / "other" / "thesis.tex"] = b"mine"
    assert {path: path.read_bytes() for path in tipper.rglob("*") if path.is_file()} == before


def test_a_folder_that_is_not_there_is_told_before_the_work(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    words = ["compile", PD7, "--for", "arduino", "-o", "nofolder/ard2"]
    assert main(words) == 1
    assert capsys.readouterr().err == "fuzzyarm: no such folder: 'nofolder'\n"


@pytest.mark.slow
def test_the_architectures_are_those_that_the_ide_knows(tipper):
    # "espressif32" is PlatformIO's word; the IDE warns of a library for it on every ESP32.
    architectures = {"due": "sam", "pico": "rp2040,mbed_rp2040", "esp32": "esp32"}
    assert architectures.keys() == {board.name for board in BOARDS.values() if not board.avr}
    for board, architecture in architectures.items():
        command = ["compile", "tipper.fis", "--for", "arduino", "--board", board, "-o", board]
        assert main(command) == 0
        text = Path(board, "library.properties").read_text()
        assert f"\narchitectures={architecture}\n" in text


# --- The period ---


SERVO = str(shipped("servo.frb"))


def servo_of(period: str) -> str:
    """Write the servo with another period; return the name of its file."""
    text = Path(SERVO).read_text("utf-8")
    assert "\nperiod 1 ms\n" in text
    Path("servo.frb").write_text(text.replace("\nperiod 1 ms\n", f"\nperiod {period}\n"), "utf-8")
    for used in re.findall(r"'?([\w-]+\.frb)'?", text):
        if (other := Path(SERVO).with_name(used)).is_file() and used != "servo.frb":
            Path(used).write_bytes(other.read_bytes())
    return "servo.frb"


def test_a_period_that_a_call_does_not_fit_into_is_refused_with_what_fits(
    tmp_path, monkeypatch, capsys
):
    need_avr()
    monkeypatch.chdir(tmp_path)
    words = ["compile", servo_of("1 ms"), "--for", "arduino", "-o", "made"]
    assert main(words) == 1
    err = capsys.readouterr().err
    found = re.search(r"takes ([\d.]+) ms a call and 224 µs .* of its period of 1 ms", err)
    assert found, err
    assert 1.2 < float(found[1]) < 1.6
    longer = re.search(r"a period of ([\d.]+ ms) holds it", err)[1]
    assert not Path("made").exists()
    # Both ways that are named hold, and a slightly shorter period does not.
    assert "with --table it takes" in err
    assert main([*words, "--table"]) == 0
    assert main(["compile", servo_of(longer), "--for", "arduino", "-o", "slower"]) == 0
    shorter = f"{float(longer.split()[0]) - 0.1:.3g} ms"
    assert main(["compile", servo_of(shorter), "--for", "arduino", "-o", "shorter"]) == 1


@pytest.mark.slow
def test_without_a_compiler_the_period_is_told_to_be_unchecked(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for board in ("uno", "pico"):
        with monkeypatch.context() as patch:
            patch.setattr(avr.shutil, "which", lambda name: None)
            words = ["--for", "arduino", "--board", board, "-o", board]
            assert main(["compile", servo_of("1 ms"), *words]) == 0
        said = "Not checked: whether a call fits into the period of 1 ms"
        assert said in capsys.readouterr().out
        assert said in " ".join(Path(board, "README.md").read_text("utf-8").split())


@pytest.mark.parametrize(
    ("period", "clock"),
    [
        ("1 ms", ("micros", 1_000)),
        ("0.0003333333333 s", ("micros", 333)),
        ("0.0010019999 s", ("micros", 1_002)),  # cut in single precision: 1,001
        ("1 h", ("millis", 3_600_000)),
        ("2147 s", ("micros", 2_147_000_000)),
    ],
)
def test_a_period_is_counted_in_whole_units_of_a_clock_that_holds_it(
    tmp_path, monkeypatch, period, clock
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(avr.shutil, "which", lambda name: None)
    assert main(["compile", servo_of(period), "--for", "arduino", "-o", "made"]) == 0
    sketch = next(Path("made").rglob("servo_example.ino")).read_text("utf-8")
    function, count = clock
    assert f"unsigned long period = {count}UL;" in sketch
    assert f"passed = {function}() - began" in sketch


def test_every_whole_number_of_microseconds_is_rounded_to_itself():
    periods = [*range(100, 2_000), *range(10_000, 1_000_000, 9_001)]
    assert [clock_of(micros * 1e-6).count for micros in periods] == periods


@pytest.mark.parametrize("period", ["1e-9 s", "0.00009 s"])
def test_a_period_below_what_a_board_counts_is_refused(tmp_path, monkeypatch, capsys, period):
    monkeypatch.chdir(tmp_path)
    assert main(["compile", servo_of(period), "--for", "arduino", "-o", "made"]) == 1
    assert (
        "too short for a board, which counts microseconds: at least 100 µs (period 100 us; or"
        " plain C, as in -o law.c, called by a timer interrupt)" in capsys.readouterr().err
    )
    assert not Path("made").exists()


_SET_OFF = """
#define SECONDS(x) ((x) * 976.5625) /* overflows of timer 0: 1,024 µs each */
extern volatile unsigned long timer0_overflow_count;
static unsigned long first, steps;
static void report(unsigned long last)
{
    Serial.print("steps "); Serial.print(steps); Serial.print(" us "); Serial.print(last - first);
    Serial.print(" late "); Serial.println(overruns);
    Serial.flush(); cli(); sleep_enable(); sleep_cpu();
}
"""


def turned(
    library: Path, folder: Path, *, steps: int, jump: str = "", idle: float = 0.0
) -> tuple[int, int]:
    """Run a controller so many steps in simavr; return the microseconds and the overruns.

    The clock wraps round on the way, and `jump` is done once, halfway. Before each step the clock
    skips so many idle seconds.
    """
    name = library.name
    sketch = library / "examples" / f"{name}_example" / f"{name}_example.ino"
    text = sketch.read_text("utf-8")
    text = text.replace("\nvoid setup()", f"{_SET_OFF}\nvoid setup()")
    wrapping = "timer0_overflow_count = 4194304UL - 60; // 61 ms before micros() wraps\n    "
    text = text.replace(f"    {name}_init(", f"    {wrapping}{name}_init(")
    skipped = f"cli(); timer0_overflow_count += (unsigned long)SECONDS({idle}); sei();"
    counted = (
        "    if (steps == 0) { first = micros(); }\n"
        f"    if (++steps == {steps}) {{ report(micros()); }}\n"
        f"    if (steps == {steps // 2}) {{ {jump} }}\n"
        f"    {skipped if idle else ''}\n"
    )
    text = text.replace(f"    {name}_step(", f"{counted}    {name}_step(")
    said = run_sketch_text(library, f"#include <Arduino.h>\n#include <avr/sleep.h>\n{text}", folder)
    found = re.search(r"steps (\d+) us (\d+) late (\d+)", said)
    assert found, said
    assert int(found[1]) == steps
    return int(found[2]), int(found[3])


@pytest.mark.slow
def test_in_simavr_a_period_is_kept_or_its_overruns_are_counted(
    tmp_path, monkeypatch, tmp_path_factory
):
    need_avr(core=True)
    monkeypatch.chdir(tmp_path)
    room = tmp_path_factory.mktemp("core")
    for name, period in (("kept", "2 ms"), ("lost", "1 ms")):
        Path(name).mkdir()
        with monkeypatch.context() as patch:
            patch.setattr(avr.shutil, "which", lambda name: None)
            out = f"{name}/servo"
            assert main(["compile", servo_of(period), "--for", "arduino", "-o", out]) == 0
    kept, lost = Path("kept", "servo").resolve(), Path("lost", "servo").resolve()
    micros, late = turned(kept, room, steps=301)
    assert late == 0
    assert abs(micros - 300 * 2_000) < 2_000
    # 1.65 ms a turn in a period of 1 ms: no turn is idle, and every other one is a period late.
    micros, late = turned(lost, room, steps=301)
    assert 300 * 1_400 < micros < 300 * 1_900
    assert late in range(140, 161)
    # A delay of 36 minutes, over half of what the clock counts: one overrun, and on it goes.
    jump = "cli(); timer0_overflow_count += (unsigned long)SECONDS(2200.0); sei();"
    micros, late = turned(kept, room, steps=301, jump=jump)
    assert late == 1
    assert abs(micros - 2_200_000_000 - 300 * 2_000) < 6_000


EXAMPLES = Path(__file__).parents[2] / "examples" / "controllers"


@pytest.mark.slow(seconds=15)
@pytest.mark.parametrize(
    ("name", "period", "steps"),
    [("smith-heater", 30.0, 41), ("manual-heater", 10.0, 41), ("cascade-servo", 0.0006, 501)],
)
def test_the_everyday_examples_run_on_an_uno_at_their_period(
    tmp_path, monkeypatch, capsys, tmp_path_factory, name, period, steps
):
    need_avr(core=True)
    monkeypatch.chdir(tmp_path)
    text = (EXAMPLES / f"{name}.frb").read_text("utf-8").replace("period 0.2 ms", "period 0.6 ms")
    stem = name.replace("-", "_")
    Path(f"{stem}.frb").write_text(text, "utf-8")
    assert main(["compile", f"{stem}.frb", "--for", "arduino", "-o", stem, "--json"]) == 0
    measured = json.loads(capsys.readouterr().out)["measured"]
    assert measured["self_test"] is True  # all that it remembers, over 24 periods
    library, idle = Path(stem).resolve(), max(0.0, period - 0.02)
    micros, late = turned(library, tmp_path_factory.mktemp("core"), steps=steps, idle=idle)
    assert late == 0
    assert abs(micros - (steps - 1) * period * 1e6) < 2_000


def test_a_cascade_that_an_uno_is_too_slow_for_is_refused(tmp_path, monkeypatch, capsys):
    need_avr()
    monkeypatch.chdir(tmp_path)
    cascade = str(EXAMPLES / "cascade-servo.frb")
    assert main(["compile", cascade, "--for", "arduino", "-o", "cascade"]) == 1
    assert "a period of 560 µs holds it" in capsys.readouterr().err
