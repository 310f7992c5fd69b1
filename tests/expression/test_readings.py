"""Every reading of an expression agrees with the floats, for every kind."""

import ctypes
import math
import struct
import subprocess

import numpy as np
import pytest
from budget import cases
from hypothesis import given, settings
from hypothesis import strategies as st
from needs import program, requires

from fuzzyarm.symbolic import kinds, op
from fuzzyarm.symbolic.evaluation import (
    bounds,
    derivative,
    evaluate,
    evaluate_arrays,
    gradient,
    specialise,
)
from fuzzyarm.symbolic.functions import python_function, row_function, row_source
from fuzzyarm.symbolic.nodes import Apply, postorder, replace, symbol, trace
from fuzzyarm.symbolic.operations import OPERATIONS
from fuzzyarm.symbolic.printing import (
    PYTHON,
    STRUCTURED_TEXT,
    NotPrintableError,
    c_language,
    printed,
    statements,
    variables,
)

CORRECTLY_ROUNDED = {"add", "subtract", "multiply", "divide", "sqrt", "absolute"}
POINTS = 2_000


def all_kinds():
    for registry in (kinds.SHAPES, kinds.TNORMS, kinds.SNORMS, kinds.HEDGES):
        for kind in registry.values():
            if kind.function is not None:
                yield pytest.param(kind, id=f"{registry.sort} {kind.name}".replace(" ", "-"))


EVERY = list(all_kinds())


def is_exact(root):
    """Whether an expression has the same bits wherever it is evaluated."""
    operations = {node.operation for node in postorder(root) if isinstance(node, Apply)}
    return all(OPERATIONS[name].exact or name in CORRECTLY_ROUNDED for name in operations)


def draw(kind, count, seed=1):
    """Return `count` points of a kind, as rows of its symbols, corners and ties among them."""
    rng = np.random.default_rng(seed)
    if kind.arguments != ("x",):
        degrees = rng.random((count, len(kind.arguments)))
        special = np.array([0.0, 1.0, 0.5, 5e-324, 1.0 - 2**-53, 1e-9])
        chosen = rng.random(degrees.shape) < 0.3
        degrees[chosen] = rng.choice(special, chosen.sum())
        exponents = rng.uniform(0.2, 4.0, (count, len(kind.parameters)))
        return np.hstack([degrees, exponents])
    width = len(kind.parameters)
    parameters = np.where(
        rng.random((count, width)) < 0.4,
        rng.integers(-2, 3, (count, width)).astype(float),
        rng.uniform(-3.0, 3.0, (count, width)),
    )
    if kind.ordered:
        parameters.sort(axis=1)
    for i, name in enumerate(kind.parameters):
        if name in kind.positive or name in {"width", "slope"}:
            parameters[:, i] = np.abs(parameters[:, i]) + 0.05
    if kind.name == "concave":
        parameters[:, 1] += 0.01
    x = rng.uniform(-4.0, 4.0, count)
    if width:
        at_corner = rng.random(count) < 0.3
        x[at_corner] = parameters[at_corner, 0]
    return np.column_stack([x, parameters])


def bits(values):
    return np.asarray(values, dtype=float).view(np.int64)


@pytest.mark.parametrize("kind", EVERY)
def test_the_function_of_floats_is_the_walk_over_the_graph(kind):
    for point in draw(kind, 300).tolist():
        walked = evaluate(kind.expression, dict(zip(kind.symbols, point, strict=True)))
        assert struct.pack("d", kind.scalar(*point)) == struct.pack("d", walked)


@pytest.mark.parametrize("kind", EVERY)
def test_arrays_are_floats(kind):
    points = draw(kind, POINTS)
    many = np.broadcast_to(kind.array(*points.T), len(points))
    one = [kind.scalar(*point) for point in points.tolist()]
    np.testing.assert_array_equal(bits(many), bits(one))
    np.testing.assert_allclose(  # without the functions of the library, which take longer
        evaluate_arrays(kind.expression, dict(zip(kind.symbols, points.T, strict=True))),
        one, rtol=1e-13, atol=1e-15,
    )  # fmt: skip


@pytest.mark.parametrize("kind", EVERY)
def test_rows_for_a_compiler_are_floats(kind):
    points = draw(kind, 200)
    rows = kind.symbols[: len(kind.arguments)]
    source = row_source(kind.expression, rows, kind.symbols[len(rows) :], "row")
    function = row_function(source, "row")
    for point in points:
        into = np.empty(1)
        arguments = [point[i : i + 1] for i in range(len(rows))]
        with np.errstate(all="ignore"):
            function(*arguments, point[len(rows) :], into)
        np.testing.assert_allclose(into[0], kind.scalar(*point.tolist()), rtol=1e-14, atol=1e-300)


@pytest.mark.parametrize("kind", EVERY)
def test_degrees_stay_degrees(kind):
    values = [kind.scalar(*point) for point in draw(kind, POINTS, seed=2).tolist()]
    most = 2.0 if kind.name == "sum" else 1.0
    assert min(values) >= 0.0
    assert max(values) <= most


@pytest.mark.parametrize("registry", [kinds.TNORMS, kinds.SNORMS], ids=["T", "S"])
@settings(deadline=None)
@given(data=st.data())
def test_norms_map_degrees_to_degrees_exactly(registry, data):
    near = [0.0, 5e-324, 2**-53, 0.5, 1.0 - 2**-53, 1.0]
    degree = st.one_of(st.sampled_from(near), st.floats(0.0, 1.0))
    a, b = data.draw(degree), data.draw(degree)
    for kind in registry.values():
        if kind.name == "sum":
            continue
        assert 0.0 <= kind.scalar(a, b) <= 1.0
        assert kind.scalar(a, b) == kind.scalar(b, a)
        neutral = 1.0 if registry is kinds.TNORMS else 0.0
        assert kind.scalar(a, neutral) == pytest.approx(a, rel=1e-15, abs=4e-16)


def test_duals_are_duals():
    for kind in kinds.TNORMS.values():
        other = kinds.SNORMS[kind.dual]
        for i in range(11):
            for j in range(11):
                a, b = i / 10, j / 10
                if abs(a + b - 1.0) < 1e-9 and kind.name == "nilpotent":
                    continue  # both jump where a + b = 1, by rounding on either side
                dual = 1.0 - other.scalar(1.0 - a, 1.0 - b)
                assert kind.scalar(a, b) == pytest.approx(dual, abs=1e-12)
        assert other.dual == kind.name


def smooth_at(kind, point, step):
    """Whether nothing of a kind switches within `step` of a point: no corner, no edge."""
    names = kind.symbols
    around = {name: (value - step, value + step) for name, value in zip(names, point, strict=True)}
    return all(
        bounds(node, around) != (0.0, 1.0)
        for node in postorder(kind.expression)
        if isinstance(node, Apply) and OPERATIONS[node.operation].is_condition
    )


@pytest.mark.parametrize("kind", EVERY)
def test_derivatives_are_differences(kind):
    slopes = gradient(kind.expression, kind.symbols)
    checked = 0
    for point in draw(kind, cases(150, 400), seed=3).tolist():
        if not smooth_at(kind, point, 1e-3):
            continue
        values = dict(zip(kind.symbols, point, strict=True))
        for name, slope in zip(kind.symbols, slopes, strict=True):
            above, below = ({**values, name: values[name] + d} for d in (1e-6, -1e-6))
            rise = evaluate(kind.expression, above) - evaluate(kind.expression, below)
            expected = evaluate(slope, values)
            if not math.isfinite(expected) or abs(expected) > 1e3 or math.isnan(rise):
                continue
            kinks = [n for n in postorder(slope) if isinstance(n, Apply) and n.operation == "where"]
            if any(_switches(n.arguments[0], values) for n in kinks):
                continue
            assert rise / 2e-6 == pytest.approx(expected, rel=1e-4, abs=1e-5)
            checked += 1
    assert checked > 20


def _switches(condition, values):
    around = {name: (value - 1e-3, value + 1e-3) for name, value in values.items()}
    return bounds(condition, around) == (0.0, 1.0)


@pytest.mark.parametrize("kind", EVERY)
def test_bounds_hold_every_value(kind):
    """A hundred boxes of a thousand points: 100,000 for each kind."""
    rng = np.random.default_rng(4)
    for corner in draw(kind, 100, seed=4):
        widths = rng.choice([0.0, 1e-9, 0.1, 1.0], corner.size)
        widths[len(kind.arguments) :] *= 0.1
        if getattr(kind, "ordered", False) or kind.name == "concave":
            widths[1:] = 0.0
        if kind.arguments != ("x",):
            widths = np.minimum(widths, np.maximum(1.0 - corner, 0.0))
        ranges = dict(zip(kind.symbols, zip(corner, corner + widths, strict=True), strict=True))
        low, high = bounds(kind.expression, ranges)
        points = corner + widths * rng.random((1000, corner.size))
        points = np.minimum(points, corner + widths)
        values = np.broadcast_to(kind.array(*points.T), 1000)
        assert low <= values.min()
        assert values.max() <= high


COMPILER = program("C compiler")


@requires("C compiler")
@pytest.mark.slow
@pytest.mark.parametrize("real", ["double", "float"])
def test_c_is_the_floats(real, tmp_path):
    language = c_language(real)
    helpers = "\n".join(
        f"static {real} {name}({real} a, {real} b) {{ return b {sign} a ? b : a; }}"
        for name, sign in (("minimum", "<"), ("maximum", ">"))
    )
    parts = ["#include <math.h>", helpers]
    for i, parameter in enumerate(EVERY):
        kind = parameter.values[0]
        lines, result = printed(kind.expression, language, reserved=kind.symbols)
        arguments = ", ".join(f"{real} {name}" for name in kind.symbols)
        body = "\n    ".join([*lines, f"return {result};"])
        parts.append(f"{real} kind{i}({arguments}) {{\n    {body}\n}}")
    source, library = tmp_path / "kinds.c", tmp_path / "kinds.so"
    source.write_text("\n".join(parts))
    flags = ["-std=c99", "-O1", "-ffp-contract=off", "-Wall", "-Werror", "-Wno-unused"]
    command = [COMPILER, *flags, "-shared", "-fPIC", str(source), "-o", str(library), "-lm"]
    subprocess.run(command, check=True)
    loaded = ctypes.CDLL(str(library))
    kind_of_number = ctypes.c_double if real == "double" else ctypes.c_float
    for i, parameter in enumerate(EVERY):
        kind = parameter.values[0]
        function = loaded[f"kind{i}"]
        function.restype = kind_of_number
        function.argtypes = [kind_of_number] * len(kind.symbols)
        for point in draw(kind, 500, seed=5).astype("f4" if real == "float" else "f8").tolist():
            found = function(*point)
            if real == "double" and is_exact(kind.expression):
                assert struct.pack("d", found) == struct.pack("d", kind.scalar(*point)), kind.name
            elif real == "double":
                assert found == pytest.approx(kind.scalar(*point), rel=1e-13, abs=1e-300)
            else:
                values = {
                    name: np.float32(value) for name, value in zip(kind.symbols, point, strict=True)
                }
                expected = evaluate_arrays(kind.expression, values, np.float32)
                tolerance = 0.0 if is_exact(kind.expression) else 1e-6
                assert found == pytest.approx(float(expected), rel=tolerance, abs=tolerance)


def as_python(text):
    """Return Structured Text as Python, which it is but for its words."""
    lines = []
    for line in text:
        if line.strip() == "END_IF;":
            continue
        if "IF " in line:  # the one statement in which = compares
            head, condition = line.split("IF ")
            condition = condition.removesuffix(" THEN").replace(" = ", " == ")
            line = f"{head}if {condition}:"  # noqa: PLW2901
        words = {" := ": " = ", ";": "", "ELSE": "else:", " OR ": " or ", " AND ": " and "}
        for old, new in words.items():
            line = line.replace(old, new)  # noqa: PLW2901
        lines.append(f"    {line}\n")
    return "".join(lines)


@pytest.mark.parametrize("kind", EVERY)
def test_structured_text_is_the_floats(kind):
    """Printed with the numbers of a term in place, and read back as Python."""
    rows = kind.symbols[: len(kind.arguments)]
    for point in draw(kind, 60, seed=6).tolist():
        values = dict(zip(kind.symbols, point, strict=True))
        numbers = {name: value for name, value in values.items() if name not in rows}
        root = specialise(kind.expression, numbers)
        body, result = statements(root, reserved=rows)
        assert set(variables(body)).isdisjoint(rows)
        text = [*STRUCTURED_TEXT.lines(body), f"return {STRUCTURED_TEXT.expression(result)}"]
        space = {
            "minimum": min, "maximum": max, "ABS": abs, "SQRT": OPERATIONS["sqrt"].scalar,
            "EXP": OPERATIONS["exp"].scalar, "COS": math.cos, "EXPT": OPERATIONS["power"].scalar,
        }  # fmt: skip
        exec(f"def f({', '.join(rows)}):\n{as_python(text)}", space)
        found = space["f"](*(values[name] for name in rows))
        assert struct.pack("d", found) == struct.pack("d", kind.scalar(*point))


def test_a_language_without_a_function_says_so():
    root = trace(op.sinh, ["x"])
    with pytest.raises(NotPrintableError, match=r"Structured Text has no function for 'sinh'"):
        STRUCTURED_TEXT.expression(root)


def test_what_a_condition_guards_is_not_set_before_it():
    guarded = trace(lambda x: op.where(x < 1.0, 1.0 / x + 1.0 / x, x), ["x"])
    lines, _ = printed(guarded, PYTHON)
    assert lines[0] == "if x < 1.0:"
    assert sum("1.0 / x" in line for line in lines) == 1


def test_what_both_branches_need_is_set_once():
    root = trace(lambda x: op.where(x < 1.0, op.exp(x) + 1.0, op.exp(x) - 1.0), ["x"])
    lines, _ = printed(root, PYTHON)
    assert sum("exp(" in line for line in lines) == 1


def test_a_long_sum_is_read_and_printed():
    x = symbol("x")
    root = x
    for _ in range(5_000):
        root = root + x
    assert python_function(root, ["x"])(1.0) == 5_001.0
    assert evaluate(derivative(root, "x"), {"x": 1.0}) == 5_001.0


def test_nothing_is_simplified_away():
    root = trace(lambda x: x + 0.0, ["x"])
    assert math.copysign(1.0, evaluate(replace(root, {"x": -0.0}), {})) == 1.0


def test_truth_of_an_expression_is_refused():
    with pytest.raises(TypeError, match=r"op\.where"):
        trace(lambda x: 1.0 if x < 0.0 else 0.0, ["x"])


@pytest.mark.parametrize("name", ["minimum", "maximum"])
def test_of_equal_arguments_the_first(name):
    function = getattr(op, name)
    for a, b in ((0.0, -0.0), (-0.0, 0.0), (math.nan, 1.0), (1.0, math.nan)):
        alone = struct.pack("d", function(a, b))
        assert alone == struct.pack("d", a)
        assert struct.pack("d", float(function(np.array(a), np.array(b)))) == alone


@pytest.mark.parametrize(
    "kind", [kind for kind in kinds.SHAPES.values() if kind.inverse], ids=lambda kind: kind.name
)
def test_an_inverse_finds_the_degree(kind):
    for degree in (0.05, 0.3, 0.5, 0.7, 0.95):
        position = kind.inverse(degree, -1.5, 2.25)
        assert kind.scalar(position, -1.5, 2.25) == pytest.approx(degree, abs=1e-12)
