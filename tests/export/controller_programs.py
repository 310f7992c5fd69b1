"""Controllers to export, signals to try them with, and their C run over these signals."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from c_programs import compile_c, execute

from fuzzyarm import load, shipped
from fuzzyarm.control.controllers.text import with_files
from fuzzyarm.exchange.export.c_files import controller_c
from fuzzyarm.language import parse
from fuzzyarm.symbolic.identifiers import identifier

SHIPPED = (
    "fuzzy-direct", "fuzzy-direct-as-described", "stfc", "stfc-as-described", "cfaf",
    "cfaf-as-described", "hfie", "hfie-as-described", "soc-zero", "soc-table", "fuzzy-fine",
    "fuzzy-lut", "fuzzy-lut-x10",
)  # fmt: skip
"""Every shipped controller without a partner."""

EVERYTHING = """
rulebase steps "how to change the power"
input  e  -6 .. 6
input  ce -6 .. 6
output du -1 .. 1
terms e, ce, du: triangles N Z P
rules du
  e \\ ce  N  Z  P
  N       N  N  Z
  Z       N  Z  P
  P       Z  P  P

controller heater "every source, every limit"
period 10 s
set-point every 4
gain G_e  = 2  "1/K", tune 0.2 .. 20 log
gain G_ce = 200 "s/K", tune 10 .. 2000 log
gain G_du = 0.15 "%/s", tune 0.01 .. 5 log
gain b    = 0.7
axis room
  e     = error of temperature
  w     = error of temperature, weight b
  r     = reference temperature
  m     = measured temperature
  ce    = rate of e * G_ce, filter 60 s
  en    = e * G_e
  zoom en, ce by 2 inside 3, edge wait
  du    = rules steps(en, ce) * G_du
  slow  = lag of du, time 20 s
  still = deadband of slow, width b
  loose = hysteresis of e, width 0.1
  step  = change of slow
  back  = integral of e, within -100 .. 100, anti-windup back 30 s
  held  = integral of e, within -100 .. 100, anti-windup hold, start 1
  s     = sum of error of temperature, cleared each set-point
  all   = sum of error of temperature
  mode  = slow where w > b and not (e < -1 or m >= 40) else 0.5
  kept  = integral of e, within -10 .. 10, follows mode where w <= 0 or ce > b
  power = integral of du, within 0 .. 100, start 0
  drive power = power + 0.1 * step + back - held + 0.01 * w + still + loose, within 0 .. 90, slew 5
  drive power = mode * 0.1 + kept * 0.01
  drive power = s * 0.1 + all / 1000
  drive 'cooling air' = -m + r / 2
"""


def shipped_text(name):
    """Return a shipped controller."""
    return load(shipped(f"{name}.frb"))


def text_of(text, sheets=None):
    """Return the controller in a text."""
    parsed = parse(text)
    assert parsed.controller is not None, parsed.diagnostics
    whole, faults = with_files(parsed.controller, Path.cwd(), instead=sheets or {})
    assert faults == []
    return whole


def ports(steps):
    """Return references and measured ports, in the order in which C is given them."""
    return [*steps.of_sort("reference"), *steps.of_sort("measured")]


def recorded(text, steps, periods=2_000, *, single=False):
    """Run a controller on masses that its drives push to smooth references; return both sides.

    Rows of what it is given, and of what it drives.
    """
    run = text.run(single=single)
    outside = np.float32 if single else np.float64
    period, axes = text.model.period, text.model.axis_names
    drives = steps.of_sort("drive")
    position, velocity = dict.fromkeys(axes, 0.0), dict.fromkeys(axes, 0.0)
    rows, results = np.empty((periods, len(ports(steps)))), np.empty((periods, len(drives)))
    length = periods * period
    for k in range(periods):
        x = min(1.25 * k * period / length, 1.0)
        wanted = {
            "position": x**3 * (10 - 15 * x + 6 * x * x),
            "velocity": 30 * x * x * (1 - x) ** 2 * 1.25 / length * (x < 1.0),
        }
        for column, port in enumerate(ports(steps)):
            sign = -0.5 if axes.index(port.axis) else 1.0
            if port.sort == "reference":
                value = sign * wanted[port.name]
            else:
                value = (position if port.name == "position" else velocity)[port.axis]
            rows[k, column] = outside(value)
        given = {sort: {} for sort in ("measured", "reference")}
        for value, port in zip(rows[k].tolist(), ports(steps), strict=True):
            given[port.sort][steps.port_name(port)] = value
        found = run.step(*given.values())
        results[k] = [found[steps.port_name(port)] for port in drives]
        for axis in axes:
            force = sum(found[steps.port_name(p)] for p in drives if p.axis == axis)
            velocity[axis] += period * (2.0 * force - 30.0 * velocity[axis])
            position[axis] += period * velocity[axis]
    return rows, results


def driver(steps, name):
    """Return the C of a function that runs a controller over rows of a file."""
    given, drives = ports(steps), steps.of_sort("drive")
    sorts = [s for s in ("reference", "measured", "drive") if steps.of_sort(s)]
    kinds = {"reference": "reference", "measured": "measured", "drive": "drives"}

    def member(port):
        path = "" if len(steps.model.axis_names) == 1 else f"{identifier(port.axis)}."
        return f"{port.sort}.{path}{identifier(port.name)}"

    sets = "".join(f"        {member(p)} = (real)row[{i}];\n" for i, p in enumerate(given))
    gets = "".join(f"        out[{i}] = (double){member(p)};\n" for i, p in enumerate(drives))
    declared = "".join(f"    {name}_{kinds[sort]} {sort};\n" for sort in sorts)
    called = ", ".join(["&s", *(f"&{sort}" for sort in sorts)])
    real = "float" if steps.single else "double"
    return (
        f"static int run_{name}(FILE *in, FILE *to, long count)\n{{\n"
        f"    typedef {real} real;\n    static {name}_state s;\n{declared}"
        f"    double row[{len(given)}], out[{len(drives)}];\n    long k;\n"
        f"    {name}_init(&s);\n    for (k = 0; k < count; k++) {{\n"
        f"        if (fread(row, sizeof row, 1, in) != 1) {{\n            return 1;\n        }}\n"
        f"{sets}        {name}_step({called});\n{gets}"
        f"        if (fwrite(out, sizeof out, 1, to) != 1) {{\n            return 1;\n        }}\n"
        "    }\n    return 0;\n}\n"
    )


def run_in_c(programs, folder, *flags):
    """Run several controllers in one C program.

    Parameters
    ----------
    programs : dict
        By the name of the program, steps and rows.

    Returns
    -------
    dict
        The drives of each, row by row.
    """
    parts, calls, data = [], [], b""
    for name, (steps, rows) in programs.items():
        made = controller_c(steps, name, name, ".h", None, ["for a test"])
        (folder / f"{name}.h").write_text(made.files[".h"])
        parts += [f'#include "{name}.h"', driver(steps, name)]
        calls.append(
            f"    if (run_{name}(in, to, {len(rows)}L) != 0) {{\n        return 1;\n    }}"
        )
        data += np.ascontiguousarray(rows, np.float64).tobytes()
    (folder / "in.bin").write_bytes(data)
    main = [
        "int main(int argc, char **argv)", "{", "    FILE *in, *to;",
        "    if (argc != 3) {", "        return 2;", "    }",
        '    in = fopen(argv[1], "rb");', '    to = fopen(argv[2], "wb");',
        "    if (in == NULL || to == NULL) {", "        return 3;", "    }",
        *calls, "    fclose(in);", "    return fclose(to);", "}",
    ]  # fmt: skip
    source = folder / "all.c"
    source.write_text("\n".join(["#include <stdio.h>", *parts, *main, ""]))
    compile_c([source], folder / "all", "gcc", "-pedantic", "-ffp-contract=off", *flags)
    assert execute(folder / "all", "gcc", str(folder / "in.bin"), str(folder / "to.bin")) == 0
    data, found = (folder / "to.bin").read_bytes(), {}
    for name, (steps, rows) in programs.items():
        width = len(steps.of_sort("drive"))
        size = 8 * width * len(rows)
        found[name] = np.frombuffer(data[:size]).reshape(len(rows), width)
        data = data[size:]
    assert data == b""
    return found


def scattered(steps, periods=300):
    """Return rows of errors of every size; see `fuzzyarm.exchange.export.trial.trial`."""
    from fuzzyarm.exchange.export.trial import trial

    rows = [[given[p.symbol] for p in ports(steps)] for given in trial(steps, periods)]
    return np.array(rows)


def model_drives(text, steps, rows, *, single=False):
    """Return what the controller itself drives over rows."""
    run = text.run(single=single)
    found = []
    for row in rows.tolist():
        given = {"measured": {}, "reference": {}}
        for value, port in zip(row, ports(steps), strict=True):
            given[port.sort][steps.port_name(port)] = value
        drives = run.step(*given.values())
        found.append([drives[steps.port_name(p)] for p in steps.of_sort("drive")])
    return np.array(found)
