"""Describing functions and phase portraits against closed forms and python-control."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from fuzzyarm import load, shipped
from fuzzyarm.apps.cli import main
from fuzzyarm.control.loop import (
    AnalysisError,
    Signal,
    describing_function,
    nonlinearity,
    phase_portrait,
)
from fuzzyarm.control.loop.course import OptionError, require_points
from fuzzyarm.control.loop.metrics import metrics_of
from fuzzyarm.language import parse
from fuzzyarm.plant import find_plant

SATURATION = parse("""rulebase limited
input e -1 .. 1
output u -3 .. 3
terms e: triangles N Z P
terms u: singletons N Z P
inference and product, implication product, aggregation sum, defuzzifier weighted-average
rule if e is N then u is N
rule if e is Z then u is Z
rule if e is P then u is P
""").rulebase
"""u = 3 e, and ± 3 beyond 1."""

LINEAR = load(shipped("roompi.frb"))
"""(e + ce) / 2 within ± 1."""


def saturated(amplitude):
    """The textbook's describing function of a saturation at 1."""
    share = min(1.0, 1.0 / amplitude)
    return 2.0 / math.pi * (math.asin(share) + share * math.sqrt(1.0 - share * share))


@pytest.mark.parametrize("amplitude", [0.2, 1.0, 1.3, 4.0, 100.0])
def test_a_saturation_has_the_describing_function_of_the_textbook(amplitude):
    found = describing_function(SATURATION, amplitude)
    assert found.shape == ()
    assert complex(found) == pytest.approx(3.0 * saturated(amplitude), rel=1e-4)


def test_an_error_and_its_rate_lead_in_phase():
    found = describing_function(LINEAR, [0.1, 0.3], frequency=2.0)
    np.testing.assert_allclose(found, 0.5 + 1.0j, rtol=1e-12)


def test_a_controller_counts_its_gains_and_limits():
    servo = load(shipped("servo.frb"))
    gains = {"e": 16.0, "ce": 0.7, "u": 4.5}
    pd7 = load(shipped("pd7.frb"))
    # As a rule base sees it: e = 16 A sin, ce = 0.7 ω A cos, a frequency of 0.7 ω / 16.
    alone = describing_function(pd7, [gains["e"] * 0.1], 10.0 * gains["ce"] / gains["e"])
    found = describing_function(servo, [0.1], 10.0)
    np.testing.assert_allclose(found, alone * gains["e"] * gains["u"], rtol=1e-4)


@pytest.mark.slow
def test_python_control_takes_it_and_finds_the_limit_cycle():
    control = pytest.importorskip("control", reason="python-control is not installed")
    ours = nonlinearity(SATURATION)
    theirs = control.saturation_nonlinearity(ub=1.0)
    sizes = np.array([0.5, 1.5, 4.0])
    np.testing.assert_allclose(
        control.describing_function(ours, sizes, zero_check=False),
        3.0 * control.describing_function(theirs, sizes), rtol=1e-4, atol=1e-9,
    )  # fmt: skip
    plant = control.tf([8.0], [1.0, 3.0, 3.0, 1.0])
    response = control.describing_function_response(plant, ours, np.linspace(0.5, 10.0, 60))
    ((amplitude, frequency),) = response.intersections
    # The plant turns by 180° at √3 rad/s, where its gain is one.
    assert frequency == pytest.approx(math.sqrt(3.0), rel=1e-3)
    assert 3.0 * saturated(amplitude) == pytest.approx(1.0, rel=1e-2)


def test_a_rule_base_on_a_double_integrator_moves_as_the_linear_system():
    portrait = phase_portrait(LINEAR, starts=[(0.3, 0.2)], duration=4.0)
    exact = expm(np.array([[0.0, 1.0], [-0.5, -0.5]]) * 4.0) @ [0.3, 0.2]
    np.testing.assert_allclose(portrait.paths[0][-1], exact, atol=1e-6)
    _, _, along, up = portrait.field
    assert (along.shape, up[0, 0]) == ((25, 25), 1.0)


def test_a_controller_comes_from_everywhere_to_its_set_point():
    wanted = {"position": Signal("step", (0.2,))}
    portrait = phase_portrait(load(shipped("ball-and-beam.frb")), find_plant("ball-and-beam"),
                              reference=wanted, duration=8.0)  # fmt: skip
    assert (portrait.x, portrait.y) == ("position, m", "velocity, m/s")
    assert portrait.target == (0.2, 0.0)
    assert len(portrait.paths) == 12
    stayed = [path for path in portrait.paths if len(path) == 800]
    assert len(stayed) >= 9  # the others begin so fast that the ball leaves the beam
    for path in stayed:
        np.testing.assert_allclose(path[-1], portrait.target, atol=1e-3)


@pytest.mark.parametrize(
    ("use", "said"),
    [
        (lambda: describing_function(load(shipped("thermostat.frb")), 1.0), "3 inputs"),
        (lambda: describing_function(load(shipped("heater.frb")), 1.0), "it has 'rate of'"),
        (lambda: describing_function(load(shipped("soc-zero.frb")), 1.0), "learns"),
        (lambda: describing_function(LINEAR, [1.0, -1.0]), "positive"),
        (lambda: phase_portrait(load(shipped("servo.frb"))), "needs a plant"),
        (lambda: phase_portrait(LINEAR, find_plant("motor")), "no plant can be driven by"),
        (lambda: phase_portrait(SATURATION), "1 inputs"),
        (
            lambda: phase_portrait(load(shipped("heater.frb")), find_plant("room")),
            "not have two outputs",
        ),
    ],
)
def test_what_cannot_be_had_is_said(use, said):
    with pytest.raises(AnalysisError, match=said):
        use()


@pytest.mark.slow
def test_the_command_draws_both(tmp_path, capsys):
    for name, what in (("pd7.frb", "describing-function"), ("roompi.frb", "phase")):
        path = tmp_path / f"{what}.svg"
        assert main(["plot", str(shipped(name)), "-o", str(path), "--what", what]) == 0
        assert path.stat().st_size > 5_000
    assert main(["plot", str(shipped("servo.frb")), "-o", str(path), "--what", "phase"]) == 1
    assert "needs a plant" in capsys.readouterr().err
    assert main(["plot", str(shipped("pd7.frb")), "-o", str(path), "--plant", "motor"]) == 2


# ── figures of a run ─────────────────────────────────────────────────────────────────


def test_integrals_of_a_constant_error_have_their_closed_forms():
    count, period, size = 50, 0.02, -0.5
    time = period * np.arange(count)
    drives = np.array([[3.0, -3.0][i % 2] for i in range(count)])[:, None]
    errors = np.full(count, size)
    figures = metrics_of(time, np.ones(count), errors, drives, [(-4.0, 3.0)], period)
    assert figures.ise == pytest.approx(size**2 * count * period)
    assert figures.iae == pytest.approx(abs(size) * count * period)
    assert figures.itae == pytest.approx(abs(size) * period**2 * count * (count - 1) / 2)
    assert figures.rms == pytest.approx(abs(size))
    assert figures.effort == pytest.approx(3.0)
    assert figures.variation == pytest.approx(6.0 * (count - 1) / (count * period))
    assert figures.saturated == 0.5
    idle = metrics_of(time, np.ones(count), errors, np.zeros((count, 0)), [], period)
    assert (idle.effort, idle.variation, idle.saturated) == (0.0, 0.0, 0.0)


def test_a_run_without_end_has_no_number_of_set_points():
    assert require_points(1.0, 0.01) == 100
    for duration in (math.inf, 1e9, 0.0):
        with pytest.raises(OptionError, match="is out of range"):
            require_points(duration, 0.01)
