"""A controller and a rule base whose names are those that generated code has for itself."""

from __future__ import annotations

from collections.abc import Sequence

from fuzzyarm.language.tokens import name_text

NAMES = tuple(
    """
    first self step s d e E last k t t1 t_1 T1 t_2 x T X part part_0 value bound rate cell
    responsible room pair found found_2 blend clamp made_least made_greatest made_test made_state
    sin exp expf
    within reference measured drive drives gains given expected failed tested points passed
    huge state init save load periods_left set_point_ends until_set_point u_held held F
    F_next F_visits F_ring F_values F_start ring next visits values low high middle index
    total weighted area moment least greatest controller Controller self_test array math min
    max abs pow sqrt float int len range print return lambda None True False class def
    global nonlocal import is del and or not if else double const static struct void
    unsigned char for while bool NAN NULL isnan fabs main inline IF THEN WHILE VAR FALSE
    REAL LREAL DINT BOOL FUNCTION_BLOCK EXIT function var let delete typeof this new await
    yield arguments eval undefined Math K0 G_e PI
    """.split()  # noqa: SIM905
)
"""Words of the languages, names of generated variables, and names that differ in case only."""

ODD = ("a-b", "a b", "größe", "ß", "Ω", "2nd", "_x", "x__y", "y" * 64, "y" * 63 + "z")

ALL = tuple(dict.fromkeys((*NAMES, *ODD)))


OF_RULES = (
    ("part", "e", "u", "0", "1", "2"), ("e", "s", "part", "0", "1", "2"),
    ("x", "total", "weighted", "0", "1", "2"), ("ß", "area", "bool", "eval", "del", "part"),
    ("or", "DINT", "min", "ß", "self", "void"), ("area", "is", "index", "first", "int", "e"),
    ("self", "struct", "this", "huge", "new", "a b"), ("NULL", "K0", "math", "array", "Math", "x"),
    ("y" * 64, "y" * 63 + "z", "size", "größe", "a-b", "last"),
)  # fmt: skip
"""Of rule bases: two inputs, an output, and three terms of each of them."""


def of_signals(names: Sequence[str]) -> str:
    """Return a controller with signals of these names."""
    lines = [f"  {name_text(name)} = lag of in, time {k + 1} s" for k, name in enumerate(names)]
    total = " + ".join(map(name_text, names))
    return _controller(
        ["axis a", "  in = error of y", "  ce = rate of in", *lines, f"  drive u = {total} + ce"]
    )


def of_gains(names: Sequence[str]) -> str:
    """Return a controller with gains of these names."""
    gains = [f"gain {name_text(name)} = {k + 1}" for k, name in enumerate(names)]
    total = " + ".join(f"in * {name_text(name)}" for name in names)
    return _controller([*gains, "axis a", "  in = error of y", f"  drive u = {total}"])


def of_ports(names: Sequence[str]) -> str:
    """Return a controller with ports of these names."""
    lines = []
    for k, word in enumerate(map(name_text, names)):
        lines += [f"  in{k} = measured {word}", f"  r{k} = reference {word}"]
        lines += [f"  drive {word} = in{k} * {k + 1} - r{k}, within 1 .. 5"]
    return _controller(["axis a", *lines])


def of_axes(names: Sequence[str]) -> str:
    """Return a controller with axes of these names."""
    axes = ", ".join(map(name_text, names))
    lines = ["  in = error of y", "  c = change of in", "  drive u = c, within 1 .. 5"]
    return _controller([f"axis {axes}", *lines])


def _controller(lines: Sequence[str]) -> str:
    return "\n".join(["controller made", "period 100 ms", *lines]) + "\n"


def of_rules(names: Sequence[str]) -> str:
    """Return a rule base whose inputs, output and terms have six names."""
    first, second, output, *terms = map(name_text, names)
    lines = [f"input {name} -1 .. 1" for name in (first, second)]
    lines += [f"output {output} -1 .. 1"]
    lines += [f"terms {name}: triangles {' '.join(terms)}" for name in (first, second, output)]
    rules = [
        f"rule if {first} is {a} and {second} is {b} then {output} is {a}"
        for a in terms
        for b in terms
    ]
    return "\n".join(["rulebase made", *lines, *rules]) + "\n"
