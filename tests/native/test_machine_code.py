"""The machine code that was built: what it has, its bits, what is said where there is none."""

import json
import math
import os
import shutil
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm import compiled, load, shipped
from fuzzyarm.apps.native.roots import roots
from fuzzyarm.symbolic import kernels
from fuzzyarm.symbolic.evaluation import evaluate
from fuzzyarm.symbolic.kernels import NotBuiltError, address_of, bound_routine, kernel, routine
from fuzzyarm.symbolic.nodes import apply, constant, symbol
from fuzzyarm.symbolic.operations import OPERATIONS
from fuzzyarm.symbolic.programs import program_of

ROOTS = {root.key: root for root in roots()}

ROWS = [key for key in ROOTS if key.split("(")[1].startswith(("fff)", "ffff)")) and "_row" in key]
"""Norms, curved terms and hedges."""


def machine():
    return kernels._module()


def test_every_root_stands_in_every_level_and_nothing_else():
    for level in machine().levels():
        assert machine().addresses(level).keys() == ROOTS.keys()


def test_two_levels_for_x86():
    import platform

    expected = 2 if platform.machine() in {"x86_64", "AMD64"} else 1
    assert 1 <= len(machine().levels()) <= expected


def test_an_unknown_level_is_an_error():
    with pytest.raises(ValueError, match="no machine code for 'v9'"):
        machine().addresses("v9")


def arrays_of(root, seed, size):
    """Return arrays for a row function: degrees or positions, numbers, and what is filled."""
    random = np.random.default_rng(seed)
    special = np.array([0.0, 1.0, 0.5, 5e-324])
    rows = [
        np.where(random.random(size) < 0.2, random.choice(special, size), random.random(size))
        for _ in range(len(root.types) - 2)
    ]
    return [*rows, np.sort(random.uniform(-0.2, 1.2, 8)), np.zeros(size)]


@pytest.mark.parametrize("key", [key for key in ROWS if "hedged_corners" not in key])
def test_rows_have_the_bits_of_plain_python(key):
    root = ROOTS[key]
    for seed, size in enumerate((1, 7, 33, 100)):
        arrays = arrays_of(root, seed, size)
        routine(root.function, root.types, root.bindings, compiled=True)(*arrays)
        compiled = arrays[-1].copy()
        with np.errstate(all="ignore"):
            routine(root.function, root.types, root.bindings, compiled=False)(*arrays)
        np.testing.assert_array_equal(compiled, arrays[-1])
        assert (np.signbit(compiled) == np.signbit(arrays[-1]))[~np.isnan(compiled)].all()


# --- Programs of operations ---

NUMBERS = st.one_of(
    st.floats(-50.0, 50.0), st.sampled_from([0.0, -0.0, 1.0, -1.0, 2.0, math.inf, math.nan])
)


@st.composite
def expressions(draw, depth=4):
    """Draw an expression of x, y and n."""
    if depth == 0 or draw(st.integers(0, 4)) == 0:
        names = st.sampled_from("xyn").map(symbol)
        return draw(st.one_of(names, NUMBERS.map(constant)))
    name = draw(st.sampled_from([o.name for o in OPERATIONS.values() if not o.is_condition]))
    parts = [draw(expressions(depth=depth - 1)) for _ in range(OPERATIONS[name].arity)]
    if name == "where":
        comparison = draw(st.sampled_from(["less", "less_equal", "equal"]))
        other = draw(expressions(depth=depth - 1))
        parts[0] = apply(comparison, parts[0], other)
        if draw(st.booleans()):
            joined = draw(st.sampled_from(["both", "either"]))
            parts[0] = apply(joined, parts[0], apply("negation", apply("less", other, symbol("x"))))
    return apply(name, *parts)


def walked(root, x, y, n):
    """Return an expression over rows by the walker of programs."""
    address, _ = program_address(root)
    into = np.zeros(len(x))
    call_by_address(address, x, y, np.array([n]), into)
    return into


def program_address(root):
    """Return the address of an expression of x, y and n, and what must live."""

    def function():
        """Stand for a function that was printed from an expression."""

    function.__source__ = f"never built {id(root)}"
    function.__program__ = lambda: program_of([root], ("x", "y"), ("n",))
    address = address_of(function, 4, compiled=True)
    assert address % 2 == 1
    return address, function


def call_by_address(address, a, b, numbers, into):
    """Have machine code call an address with rows: the kernel of a norm under hedges does."""
    from fuzzyarm.inference.block import MAX  # any of its own norms is below 4

    assert address > MAX
    machine().walk(address, (a, b, numbers, into))


@given(expressions(), st.lists(st.tuples(NUMBERS, NUMBERS), min_size=1, max_size=70), NUMBERS)
def test_a_program_has_the_bits_of_the_expression(root, points, n):
    x, y = (np.array(column) for column in zip(*points, strict=True))
    values = walked(root, x, y, n)
    for value, (a, b) in zip(values.tolist(), points, strict=True):
        expected = evaluate(root, {"x": a, "y": b, "n": n})
        assert value == expected or (math.isnan(value) and math.isnan(expected))


def test_a_program_of_thousands_of_operations():
    root = symbol("x")
    for k in range(6000):
        root = root + constant(float(k))
    x = np.arange(5.0)
    np.testing.assert_array_equal(walked(root, x, x, 0.0), x + sum(range(6000)))


def test_a_symbol_without_a_value_is_an_error():
    with pytest.raises(KeyError, match="z"):
        program_of([symbol("z")], ("x",))


# --- Calls ---


def test_a_routine_refuses_arrays_that_machine_code_would_misread():
    root = ROOTS["fuzzyarm.inference.row_functions.corners_row(fff)"]
    run = routine(root.function, "fff", compiled=True)
    good = np.zeros(4)
    for bad in (good.astype(np.float32), good.astype(np.int64), np.zeros(8)[::2], [1.0]):
        with pytest.raises(TypeError, match="a contiguous array of float64 is needed"):
            run(good, bad, good)
    with pytest.raises(TypeError, match="3 arrays are needed, not 2"):
        run(good, good)


def test_what_is_filled_in_must_be_writable_and_what_is_read_need_not():
    root = ROOTS["fuzzyarm.inference.row_functions.corners_row(fff)"]
    run = routine(root.function, "fff", compiled=True)
    x, corners, into = np.array([0.5]), np.array([0.0, 0.0, 1.0, 1.0]), np.zeros(1)
    for array in (x, corners, into):
        array.flags.writeable = False
    with pytest.raises(ValueError, match="an array that is filled in is read-only"):
        run(x, corners, into)
    with pytest.raises(ValueError, match="an array that is filled in is read-only"):
        bound_routine(root.function, "fff", (x, corners, into))
    assert into.tolist() == [0.0]
    into.flags.writeable = True
    run(x, corners, into)
    assert into.tolist() == [0.5]


def test_a_program_walks_over_arrays_that_fit_it_only():
    address, keep = program_address(symbol("x") + symbol("n"))
    row, numbers, into = np.zeros(3), np.zeros(1), np.zeros(3)
    machine().walk(address, (row, row, numbers, into))
    read_only = np.zeros(3)
    read_only.flags.writeable = False
    for arrays in (
        (row[:2], row, numbers, into),
        (row, row, np.zeros(2), into),
        (row, numbers, into),
        (row, row, row, numbers, into),
        (row, row, numbers, read_only),
    ):
        with pytest.raises(ValueError, match=r"do not fit it|read-only"):
            machine().walk(address, arrays)
    with pytest.raises(ValueError, match="not a program"):
        machine().walk(address + 1, (row, row, numbers, into))
    assert keep


def test_a_sweep_refuses_what_lies_outside():
    fast = compiled(load(shipped("pd7.frb")))
    sweep_arrays = fast._sweeps._sweeps_of(fast._stages[0])._sweeper(8192)
    x, into = np.zeros(10), np.zeros(10)
    assert sweep_arrays((x, x, into), 0, 10) == 0
    with pytest.raises(ValueError, match="an array ends before element 11"):
        sweep_arrays((x, x, into), 0, 11)
    with pytest.raises(ValueError, match="ends before"):
        sweep_arrays((x, x, into), -1, 10)
    with pytest.raises(TypeError, match="3 arrays are needed"):
        sweep_arrays((x, into), 0, 10)
    with pytest.raises(TypeError, match="float64 is needed"):
        sweep_arrays((x, x.astype(np.float32), into), 0, 10)
    into.flags.writeable = False
    with pytest.raises(ValueError, match="read-only"):
        sweep_arrays((x, x, into), 0, 10)


def test_a_bound_routine_keeps_its_arrays_alive():
    root = ROOTS["fuzzyarm.inference.row_functions.corners_row(fff)"]
    into = np.zeros(3)
    arrays = (np.array([0.0, 0.5, 2.0]), np.array([0.0, 0.0, 1.0, 1.0]), into)
    run = bound_routine(root.function, "fff", arrays)
    del arrays
    run()
    assert into.tolist() == [0.0, 0.5, 1.0]


@kernel
def unknown(x):
    x[0] = 1.0


def test_what_was_not_built_is_an_error_by_name():
    with pytest.raises(NotBuiltError, match=r"unknown\(f\)"):
        address_of(unknown, "f", compiled=True)


# --- Without it ---

ALL_WAYS = """
import hashlib, json, sys
import numpy as np
from fuzzyarm import compiled, load, shipped
from fuzzyarm.control.controllers import controller
from fuzzyarm.control.loop import simulate
from fuzzyarm.plant import reach
from fuzzyarm.table import lookup, read_table
lookup.WORTH_CALLING = 0
x = np.linspace(-6.0, 6.0, 7)
motion = reach(segment=0.1, hold=0.1)
runs = [simulate(controller(name), motion) for name in ("pd", "mrac", "soc-table", "fuzzy-direct")]
control = [compiled(load(shipped(f"{name}.frb")))(e=x, ce=x[::-1])["u"] for name in ("pd7",)]
tip = compiled(load(shipped("tipper2.frb")))(service=x + 6.0, food=5.0)["tip"]
table = read_table(shipped("thesis-6.1.lut"))
looked_up = [table.lookup(x, x[::-1], mode=mode) for mode in ("nearest", "linear")]
values = [list(run.rms) for run in runs], [v.tolist() for v in (*control, tip, *looked_up)]
print(json.dumps(values))
"""


def in_new_process(code, **environment):
    return subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, **environment}, capture_output=True, text=True, check=True,
    )  # fmt: skip


@pytest.mark.slow
def test_levels_and_plain_python_have_the_same_numbers():
    best, baseline, plain = (
        in_new_process(ALL_WAYS, FUZZYARM_NATIVE=way) for way in ("1", "baseline", "0")
    )
    assert json.loads(best.stdout) == json.loads(baseline.stdout) == json.loads(plain.stdout)
    assert best.stderr == baseline.stderr == ""


def test_where_none_was_built_one_line_says_that_it_is_slow(monkeypatch):
    monkeypatch.setitem(sys.modules, "fuzzyarm._kernels", None)
    kernels._module.cache_clear()
    try:
        with pytest.warns(RuntimeWarning, match="no machine code was built: fuzzyarm runs"):
            assert not kernels.has_machine_code()
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            assert not kernels.has_machine_code()
    finally:
        kernels._module.cache_clear()


def test_machine_code_of_other_sources_is_not_used(monkeypatch):
    monkeypatch.setattr(kernels, "digest_of_c", lambda: "0" * 64)
    kernels._module.cache_clear()
    try:
        with pytest.warns(RuntimeWarning, match="of other sources; `make native`"):
            assert not kernels.has_machine_code()
    finally:
        kernels._module.cache_clear()


@pytest.mark.slow
def test_the_digest_is_of_the_c_and_not_of_the_text_it_is_printed_from(tmp_path):
    source = Path(kernels.__file__).parents[1]
    package = tmp_path / "fuzzyarm"
    skipped = shutil.ignore_patterns("__pycache__", "_kernels.*", "page", "files")
    shutil.copytree(source, package, ignore=skipped)
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "FUZZYARM_NATIVE": "0"}

    def noted():
        command = [sys.executable, "-m", "fuzzyarm.apps.native.build", "--note"]
        subprocess.run(command, env=environment, check=True)
        return (package / "_kernels.digest").read_text(encoding="ascii").split()

    def edit(old, new):
        module = package / "inference" / "kernel.py"
        text = module.read_text(encoding="utf-8")
        assert old in text
        module.write_text(text.replace(old, new, 1), encoding="utf-8")

    text, c = noted()
    assert c == machine().SOURCES
    edit('"""Return the mean from', '"""Give the mean from')
    other_text, same_c = noted()
    assert (other_text != text, same_c) == (True, c)
    edit("return centre + moment / total", "return centre - moment / total")
    assert noted()[1] != c


@pytest.mark.parametrize(
    ("files", "wanted"),
    [
        ({}, 8),
        ({"cpu.max": "max 100000"}, 8),
        ({"cpu.max": "150000 100000"}, 2),
        ({"cpu.max": "50000 100000"}, 1),
        ({"quota": "-1", "period": "100000"}, 8),
        ({"quota": "300000", "period": "100000"}, 3),
    ],
)
def test_processors_are_those_that_a_process_may_keep_busy(tmp_path, monkeypatch, files, wanted):
    for name, text in files.items():
        (tmp_path / name).write_text(text + "\n", encoding="ascii")
    names = (("cpu.max", ""), ("quota", "period"))
    paths = tuple(tuple(str(tmp_path / name) if name else "" for name in pair) for pair in names)
    monkeypatch.setattr(kernels, "_QUOTA_FILES", paths)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(8)), raising=False)
    assert kernels.processors.__wrapped__() == wanted
