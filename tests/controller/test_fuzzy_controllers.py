"""Fuzzy controllers against the same controllers written in plain Python, and their files."""

import importlib.util
import math
from pathlib import Path

import numpy as np
import pytest
from needs import requires

from fuzzyarm.base.shipped_files import shipped
from fuzzyarm.control.controllers import Controller, SourceError, Sources, controller
from fuzzyarm.control.controllers.catalogue import Choice, text_controller
from fuzzyarm.control.controllers.kernel import zoom
from fuzzyarm.control.loop import Options, simulate
from fuzzyarm.language import RuleBaseError, load_rulebase
from fuzzyarm.plant import PLAIN, STUDY_TABLES, Clock, Reference, State, pick_and_place
from fuzzyarm.plant.setting import RunArithmetic
from fuzzyarm.table import Axis, LookupTable, read_table
from tests.interpreted import interpreted

SHORT = pick_and_place(segment=0.4)
INTERPRETED = Options(compiled=False)


def shipped_rulebase(name):
    return load_rulebase(shipped(name))


def shipped_table(name):
    return read_table(shipped(name))


def edited(name, folder, *changes):
    """Return a shipped controller with some words of its text changed."""
    text = shipped(name).read_text()
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    file = folder / name
    file.write_text(text)
    return text_controller(file, Choice())


def motor(control, velocity, ratio):
    return (20.0 * control / 6.0 - 0.066 * velocity * ratio) * 0.066 / 2.32 * ratio


class Written(Controller):
    """A fuzzy controller by its description: `decide` gives the control of one joint."""

    def __init__(self, decide, error_gain):
        self.decide = decide
        self.gain = error_gain / math.pi

    def torque(self, reference, state, clock):
        out = []
        for joint, ratio in ((0, 80.0), (1, 70.0)):
            e = (reference.position[joint] - state.position[joint]) * self.gain
            ce = (reference.velocity[joint] - state.velocity[joint]) * (10.8 / math.pi)
            out.append(motor(self.decide(joint, e, ce), state.velocity[joint], ratio))
        return out


def same(made, written, tolerance=1e-9):
    ours = simulate(made, SHORT, payload=True)
    theirs = simulate(written, SHORT, payload=True)
    np.testing.assert_allclose(ours.error_matrix, theirs.error_matrix, atol=tolerance)


def test_lookup_table_control():
    table = shipped_table("thesis-6.1.lut")
    same(controller("fuzzy-lut"), Written(lambda _j, e, ce: table.lookup(e, ce), 108.0), 1e-6)


def test_a_table_that_is_interpolated():
    table = shipped_table("thesis-6.1.lut")
    smooth = LookupTable(table.axes, "u", table.values, low=-6, high=6, mode="linear")
    made = controller("fuzzy-lut-x10", sources=Sources(table=smooth))
    same(made, Written(lambda _j, e, ce: smooth.lookup(e, ce), 1080.0))


@pytest.mark.slow
def test_one_table_for_each_joint_and_any_order_of_its_axes():
    first, second = shipped_table("thesis-6.1.lut"), shipped_table("performance-yamazaki.lut")
    tables = (first, second)
    joint = Axis("joint", (1, 2))
    both = LookupTable((joint, *first.axes), "u", np.stack([first.values, second.values]))
    turned = LookupTable(
        (both.axes[2], both.axes[0], both.axes[1]), "u", np.transpose(both.values, (2, 0, 1))
    )
    written = Written(lambda j, e, ce: tables[j].lookup(e, ce), 108.0)
    for given in (tables, both, turned):
        same(controller("fuzzy-lut", sources=Sources(table=given)), written, 1e-6)


@pytest.mark.slow
def test_direct_control_of_one_rule_base_and_of_one_with_the_joint_as_an_input(tmp_path):
    rulebase = shipped_rulebase("pd7-study.frb")
    exact = interpreted(rulebase)
    same(
        controller("fuzzy-direct"),
        Written(lambda _j, e, ce: exact.evaluate({"e": e, "ce": ce})["u"], 1080.0),
    )
    file = tmp_path / "joints.frb"
    file.write_text(
        "rulebase joints\ninput joint 1 .. 2\ninput e -6 .. 6\noutput u -6 .. 6\n"
        "terms joint: triangles ONE TWO\nterms e, u: triangles N Z P\n"
        "rule if joint is ONE and e is P then u is P\nrule if joint is ONE and e is N then u is N\n"
        "rule if e is Z then u is Z\nrule if joint is TWO and e is P then u is Z\n"
        "rule if joint is TWO and e is N then u is N\n"
    )
    other = load_rulebase(file)
    own = interpreted(other)
    same(
        controller("fuzzy-direct", sources=Sources(rulebase=other)),
        Written(lambda j, e, _ce: own.evaluate({"joint": j + 1.0, "e": e})["u"], 1080.0),
    )


@pytest.mark.slow
@pytest.mark.parametrize("smooth", [0.0, 1.0])
def test_self_tuning_with_a_zoom(smooth, tmp_path):
    rules = interpreted(shipped_rulebase("pd7-study.frb"))
    factor = interpreted(shipped_rulebase("alpha7-study.frb"))

    def decide(_joint, e, ce):
        size = max(abs(e), abs(ce))
        zoom = 2.0 if size <= 3.0 else 1.0
        if smooth and 1.5 < size < 3.0:
            zoom = 3.0 / size
        point = {"e": zoom * e, "ce": zoom * ce}
        return 3.0 * rules.evaluate(point)["u"] * factor.evaluate(point)["alpha"]

    edge = ("inside window", "inside window, edge wait" if smooth else "inside window")
    same(edited("cfaf.frb", tmp_path, edge), Written(decide, 1080.0))


@pytest.mark.parametrize(
    ("e", "ce", "zoomed"),
    [
        (3.0, 1.0, True),
        (-1.0, -3.0, True),
        (math.nextafter(3.0, 4.0), 1.0, False),
        (1.0, math.nextafter(-3.0, -4.0), False),
    ],
)
def test_the_window_of_the_zoom_includes_its_edge(e, ce, zoomed):
    # Section 6.6: "checks if the position and velocity errors are both within [-3 3]. If they
    # are, then both the position and velocity error are doubled".
    rules = interpreted(shipped_rulebase("pd7-study.frb"))
    factor = interpreted(shipped_rulebase("alpha7-study.frb"))
    point = {"e": 2.0 * e, "ce": 2.0 * ce} if zoomed else {"e": e, "ce": ce}
    control = 3.0 * rules.evaluate(point)["u"] * factor.evaluate(point)["alpha"]
    # Gains of 1 make the scaled errors exact.
    made = controller("cfaf").with_gains({"G_e": [1.0], "G_ce": [1.0]})
    reference = Reference((e, 0.0), (ce, 0.0), (0.0, 0.0))
    torque = made.torque(reference, State((0.0, 0.0), (0.0, 0.0)), Clock(0.0006, False, False))
    assert torque[0] == pytest.approx(motor(control, 0.0, 80.0), rel=1e-9)


def test_smooth_zoom_has_no_jump_and_the_abrupt_one_has():
    sizes = np.linspace(0.0, 6.0, 6001)

    def zoomed(size, smooth):
        cells = np.array([2.0, 3.0, size])
        zoom(np.array([0, 1, int(smooth), 2]), cells, 0, 1)
        return cells[2]

    seen = {smooth: np.array([zoomed(s, smooth) for s in sizes]) for smooth in (0.0, 1.0)}
    assert np.abs(np.diff(seen[1.0])).max() < 0.0021
    assert (np.diff(seen[1.0]) >= -1e-12).all()
    assert np.diff(seen[0.0]).min() < -2.9


@pytest.mark.slow
def test_an_edit_of_the_rule_base_shows(tmp_path):
    text = Path(__file__).parents[2].joinpath("rulebases", "pd7.frb").read_text()
    file = tmp_path / "pd7.frb"
    results = []
    for edited in (text, text.replace("ZE      NB  NM  NS  ZE", "ZE      NB  NM  NS  PS")):
        file.write_text(edited)
        made = controller("fuzzy-direct", sources=Sources(rulebase=load_rulebase(file)))
        results.append(simulate(made, SHORT, options=INTERPRETED).rms)
    assert (np.abs(results[0] - results[1]) > 1e-3).all()


@pytest.mark.parametrize(
    ("name", "sources", "word"),
    [
        ("pd", {"table": "thesis-6.1.lut"}, "takes no table"),
        ("fuzzy-lut", {"rulebase": "pd7.frb"}, "takes no rulebase"),
        ("cdid+fuzzy-lut", {"performance": "performance-yamazaki.lut"}, "takes no performance"),
        ("fuzzy-direct", {"rulebase": "thermostat.frb"}, "rule base 'thermostat' has the input"),
    ],
)
def test_sources_that_do_not_serve(name, sources, word):
    given = {
        kind: shipped_table(file) if file.endswith(".lut") else shipped_rulebase(file)
        for kind, file in sources.items()
    }
    with pytest.raises(SourceError, match=word):
        controller(name, sources=Sources(**given))


def test_tables_that_do_not_serve():
    axes = (Axis("e", (-1, 0, 1)), Axis("rate", (-1, 0, 1)))
    odd = LookupTable(axes, "u", np.zeros((3, 3)))
    with pytest.raises(SourceError, match="the table has the input 'rate'"):
        controller("fuzzy-lut", sources=Sources(table=odd))
    joints = LookupTable(
        (Axis("joint", (0, 1)), Axis("e", (-1, 1)), Axis("ce", (-1, 1))), "u", np.zeros((2, 2, 2))
    )
    with pytest.raises(SourceError, match="levels 1, 2"):
        controller("fuzzy-lut", sources=Sources(table=joints)).start()


def test_a_text_and_files_that_do_not_fit(tmp_path):
    for before, after, word in (
        ("table F(e, ce)", "table F(e)", "has 2 inputs, the line gives 1"),
        ("table F(e, ce)", "rules F(e, ce)", "'F' is a table"),
        ("thesis-6.1.lut", "pd7.frb", "'F' is a rule base"),
        ("thesis-6.1.lut", "nothing.lut", "cannot read 'nothing.lut'"),
    ):
        with pytest.raises(RuleBaseError, match=word):
            edited("fuzzy-lut.frb", tmp_path, (before, after))


def test_a_hybrid_is_the_ordinary_sum():
    reference = Reference((0.3, -0.2), (0.1, 0.2), (0.5, -0.4))
    state, clock = State((0.29, -0.21), (0.12, 0.1)), Clock(0.0006, False, False)
    parts = [controller("cdid"), controller("fuzzy-lut"), controller("ie")]
    total = parts[0] + parts[1] + parts[2]
    made = controller("cdid+fuzzy")
    for each in (*parts, total, made):
        each.start()
    want = np.sum([each.torque(reference, state, clock) for each in parts], axis=0)
    np.testing.assert_allclose(made.torque(reference, state, clock), want, rtol=1e-12)
    total.start()
    np.testing.assert_allclose(total.torque(reference, state, clock), want, rtol=1e-12)


def test_the_constant_for_pi_of_a_run_scales_the_errors():
    made = controller("fuzzy-lut")
    law = made.law
    for conventions, gain in (
        (STUDY_TABLES, float(np.float32(108.0 / 3.142857))),
        (PLAIN, 108.0 / math.pi),
    ):
        arithmetic = RunArithmetic(conventions.single, conventions.pi)
        cells = law.program(arithmetic).gains["G_e"]
        assert [made.block(arithmetic).memory[cell] for cell in cells] == [gain, gain]


C_LOOPS = ["fuzzy-lut", "cdid+fuzzy", "soc-zero", "fuzzy-direct", "stfc", "cfaf", "hfie", "mrac"]


@pytest.fixture(scope="module")
def benchmark(tmp_path_factory):
    """The benchmark of the loop, and a folder with its data."""
    path = Path(__file__).parents[2] / "benchmarks" / "closed_loop.py"
    spec = importlib.util.spec_from_file_location("benchmark_of_the_loop", path)
    module = importlib.util.module_from_spec(spec)
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(path.parent))
        spec.loader.exec_module(module)
    module.REPEATS = 1
    folder = tmp_path_factory.mktemp("loops")
    module.write_data(folder)
    return module, folder


@pytest.mark.slow
@requires("C compiler")
@pytest.mark.parametrize("name", C_LOOPS)
def test_the_c_loop_of_the_benchmark_gives_the_same_errors(benchmark, name):
    module, folder = benchmark
    words = module.run_c(module.compile_c(folder, module.CONTROLS[name]))
    from fuzzyarm.plant import reach_return

    run = simulate(controller(name), reach_return(), payload=True)
    np.testing.assert_allclose(run.rms, [float(words[1]), float(words[2])], rtol=1e-5)
