"""Many runs: the same bits as single ones, on any executor, in any blocks; what travels."""

import os
import signal
import textwrap
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzyarm import load
from fuzzyarm.base.errors import FuzzyarmError, MissingExtraError
from fuzzyarm.control.controllers import Controller, controller, find_controller
from fuzzyarm.control.controllers.catalogue import CATALOGUE
from fuzzyarm.control.loop import Options, Sensor, Signal, SweepError, simulate, simulate_many
from fuzzyarm.control.loop.blocks import TravelError, in_order, packed, unpacked
from fuzzyarm.control.loop.many import Bench
from fuzzyarm.control.loop.metrics import METRICS
from fuzzyarm.control.loop.simulation import experiment_of
from fuzzyarm.plant import LOADED, UNLOADED, Arm, find_plant, reach_return
from fuzzyarm.plant.following import with_load
from fuzzyarm.plant.plant import with_parameters
from fuzzyarm.plant.setting import STUDY_CONVENTIONAL

SHORT = reach_return(segment=0.3, hold=0.1)

HEATER = """
rulebase steps "how to change the power"
input  e  -6 .. 6 "too cold, K"
input  ce -6 .. 6 "getting colder, scaled"
output du -1 .. 1 "change of power"
terms e, ce, du: triangles N Z P
rules du
  e \\ ce  N  Z  P
  N       N  N  Z
  Z       N  Z  P
  P       Z  P  P

controller heater
period 10 s
gain G_e  = 2  "1/K", tune 0.2 .. 20 log
gain G_ce = 200 "s/K", tune 10 .. 2000 log
gain G_du = 0.15 "%/s", tune 0.01 .. 5 log
axis room
  e     = error of temperature
  ce    = rate of e * G_ce, filter 60 s
  en    = e * G_e
  du    = rules steps(en, ce) * G_du
  power = integral of du, within 0 .. 100, start 0
  drive power = power, slew 5
"""

KILN = """
from fuzzyarm.plant import Plant, Port


def loss(p, T):
    return p * (T - 20.0)


class Kiln(Plant):
    name = "kiln"
    inputs = {"power": Port("%", 0, 100)}
    outputs = {"temperature": Port("°C")}
    states = {"T": "°C"}
    parameters = {"loss": 0.01}
    duration = 200.0

    def start(self, rng):
        return [20.0 + rng.normal()]

    def derivative(self, t, x, u, p):
        return [0.02 * u[0] - loss(p[0], x[0])]


class Oven:
    name = "oven"
    axis = "chamber"
    inputs = {"power": Port("%", 0, 100)}
    outputs = {"temperature": Port("°C")}
    states = {"T": "°C"}
    parameters = {"loss": 0.01}
    duration = 200.0

    def derivative(self, t, x, u, p):
        return [0.02 * u[0] - loss(p[0], x[0])]
"""


@pytest.fixture
def heater(tmp_path, monkeypatch):
    """Write a controller and two plants into a folder and go there."""
    (tmp_path / "heater.frb").write_text(HEATER)
    (tmp_path / "mine.py").write_text(KILN)
    monkeypatch.chdir(tmp_path)
    return "heater.frb"


def same(first, second):
    return np.array_equal(first.values, second.values, equal_nan=True) and np.array_equal(
        first.diverged, second.diverged, equal_nan=True
    )


# --- The same as single runs ---


def test_seeds_equal_single_runs_to_the_last_bit():
    seeds = [3, 5, 8]
    options = Options(disturbance=6e-8)
    made = controller("soc-zero")
    many = simulate_many(made, SHORT, {"seed": seeds}, payload=True, options=options)
    for i, seed in enumerate(seeds):
        one = simulate(made, SHORT, payload=True, options=Options(disturbance=6e-8, seed=seed))
        np.testing.assert_array_equal(many.rms[i], one.rms)
        np.testing.assert_array_equal(many.final[i], one.final)
        np.testing.assert_array_equal(many.maximum[i], one.maximum)
        for name, metrics in one.metrics.items():
            for metric, value in metrics.to_dict().items():
                found = many[metric][i, many.outputs.index(name)]
                assert found == value or (value is None and np.isnan(found))
    assert np.isnan(many.diverged).all()
    assert many.seeds.tolist() == seeds


def test_gains_loads_and_parameters():
    runs = [
        {"K_P": [100.0, 50.0], "K_D": 20.0, "payload": 0.0},
        {"K_P": [200.0, 80.0], "payload": 1.0},
        {"payload": 2.0, "m_2": 2.5, "seed": 9},
        {},
    ]
    seen = []
    many = simulate_many("pd", SHORT, runs, workers=2, watch=seen.append)
    assert sum(seen) == len(many) == 4
    pd = controller("pd")
    heavy = with_load(Arm(), 2.0).arm.with_values(m_2=2.5)
    light = UNLOADED.with_values(m_2=2.5)
    single = [
        simulate(pd.with_gains({"K_P": [100.0, 50.0], "K_D": [20.0]}), SHORT),
        simulate(pd.with_gains({"K_P": [200.0, 80.0]}), SHORT, payload=True),
        simulate(pd, SHORT, schedule=[vars(heavy if each else light) for each in SHORT.loaded]),
    ]
    for i, one in enumerate(single):
        np.testing.assert_array_equal(many.rms[i], one.rms)
    assert many.seeds.tolist() == [1, 2, 9, 4]
    assert list(many.columns())[:4] == ["K_P[1]", "K_P[2]", "K_D", "payload"]


def test_a_run_that_says_no_load_has_that_of_all():
    many = simulate_many("pd", SHORT, [{"payload": 0.0}, {}], payload=True)
    np.testing.assert_array_equal(many.rms[0], simulate("pd", SHORT).rms)
    np.testing.assert_array_equal(many.rms[1], simulate("pd", SHORT, payload=True).rms)


@given(st.floats(0.0, 3.0))
def test_the_load_is_scaled_between_the_two_arms(load):
    arm = with_load(Arm(), load).arm
    assert arm.m_1 == pytest.approx(2.0 + load)
    assert pytest.approx(0.09 + 1.41 * load) == arm.I_1
    assert arm.l_1 == pytest.approx(UNLOADED.l_1)
    assert [with_load(Arm(), share).arm for share in (0.0, 1.0)] == [UNLOADED, LOADED]


def test_conventions_of_the_study():
    many = simulate_many("pd", SHORT, [{}], payload=True, conventions=STUDY_CONVENTIONAL)
    one = simulate("pd", SHORT, payload=True, conventions=STUDY_CONVENTIONAL)
    np.testing.assert_array_equal(many.maximum[0], one.maximum)
    assert one.metrics["joint1"].max == one.maximum[0]


def test_a_plant_its_parameters_and_its_sensors(heater):
    options = Options(sensors={"temperature": Sensor(resolution=0.1)})
    wanted = {"temperature": Signal("step", (25.0,))}
    runs = [
        {"noise.temperature": 0.5, "G_e": 3.0},
        {"noise.temperature": 0.0, "seed": 4},
    ]
    room = find_plant("room")
    name = next(iter(room.parameters))
    runs.append({name: 1.1 * _value(room, name), "delay.temperature": 30.0})
    many = simulate_many(heater, room, runs, reference=wanted, duration=3600.0, options=options)
    made = find_controller(heater)
    own = [
        (made.with_gains({"G_e": [3.0]}), room, Sensor(noise=0.5, resolution=0.1), 1),
        (made, room, Sensor(resolution=0.1), 4),
        (
            made,
            with_parameters(room, {name: 1.1 * _value(room, name)}),
            Sensor(resolution=0.1, delay=30.0),
            3,
        ),
    ]
    for i, (chosen, plant, sensor, seed) in enumerate(own):
        options = Options(sensors={"temperature": sensor}, seed=seed)
        one = simulate(chosen, plant, reference=wanted, duration=3600.0, options=options)
        np.testing.assert_array_equal(many.rms[i], one.rms)
    assert many.outputs == ("room",)
    assert many.units == ("°C",)


def _value(plant, name):
    given = plant.parameters[name]
    return getattr(given, "value", given)


def test_the_frame():
    many = simulate_many("pd", SHORT, {"K_P": [100.0, 200.0]})
    frame = many.frame()
    assert list(frame.columns[:4]) == ["K_P", "seed", "diverged", "joint1.rms"]
    assert frame.shape == (2, 3 + 2 * len(METRICS))
    assert frame["joint2.rms"].tolist() == many.rms[:, 1].tolist()


def test_what_diverges_says_when():
    many = simulate_many("pid", SHORT, {"K_I": [0.25, 1e4]})
    assert np.isnan(many.diverged[0])
    assert many.diverged[1] > 0.0


# --- What does not fit ---


@pytest.mark.parametrize(
    ("runs", "match"),
    [
        ([], "0 runs are out of range"),
        ({"K_P": [1.0, 2.0], "seed": [1]}, "do not match: 2 of K_P, 1 of seed"),
        ([{"K_Q": 1.0}], "neither pd nor arm has 'K_Q' .did you mean 'K_P'"),
        ([{"payload": -0.5}], "a payload of -0.5 is out of range"),
        ([{"m_1": -1.0}], "m_1 = -1"),
        ([{"K_P": 1e13}], "K_P = 1.*e\\+?13|out of range"),
        ([{"noise.angle": 1.0}], "no port 'angle'"),
        ([{"K_P": np.inf}], "'K_P' is infinite"),
    ],
)
def test_runs_out_of_sense(runs, match):
    with pytest.raises(FuzzyarmError, match=match):
        simulate_many("pd", SHORT, runs)


def test_a_load_where_nothing_is_carried():
    from fuzzyarm.plant import reach

    path = reach(segment=0.3)
    path = replace(path, loaded=(False,) * len(path.loaded))
    with pytest.raises(SweepError, match="carries no load"):
        simulate_many("pd", path, [{"payload": 1.0}])


def test_no_metric_of_this_name():
    many = simulate_many("pd", SHORT, [{}])
    with pytest.raises(SweepError, match=r"no metric 'rsm'.*'rms'"):
        _ = many["rsm"]


# --- Blocks ---


@given(st.integers(0, 5), st.integers(0, 60), st.integers(1, 4), st.randoms())
def test_blocks_come_in_order_and_nothing_is_lost_or_doubled(begin, count, workers, random):
    waiting = []

    def submit(first, last):
        future = Future()
        rows = np.arange(first, last, dtype=float)[:, None]
        waiting.append((future, rows))
        # Workers end in any order.
        while len(waiting) >= 2 * workers or (waiting and last == begin + count):
            done, found = waiting.pop(random.randrange(len(waiting)))
            done.set_result((found, random.choice([0.0, 1e-3, 0.2, 5.0])))
        return future

    parts = list(in_order(submit, begin, begin + count, workers))
    told = [value for _, rows in parts for value in rows[:, 0]]
    assert told == list(range(begin, begin + count))
    assert [first for first, _ in parts] == [rows[0, 0] for _, rows in parts]


@pytest.mark.parametrize("workers", [1, 2, 3, 5])
def test_workers_do_not_change_a_bit(workers):
    runs = {"payload": np.linspace(0.0, 2.0, 23)}
    options = Options(sensors={"position": Sensor(noise=1e-3)}, disturbance=1e-6)
    first = simulate_many("soc-zero", SHORT, runs, options=options, workers=1)
    assert same(first, simulate_many("soc-zero", SHORT, runs, options=options, workers=workers))


# --- What travels ---


@pytest.mark.parametrize("name", ["pd", "cdid+ie", "acdid+fuzzy", "stfc", "soc-zero", "hfie"])
def test_controllers_travel(name):
    made = controller(name, start="cold") if CATALOGUE[name].adaptive else controller(name)
    made.prepare(Options().arithmetic(STUDY_CONVENTIONAL))
    content = packed(made)
    again = unpacked(content)
    assert len(content) < 40_000
    assert again.name == made.name
    np.testing.assert_array_equal(
        simulate(made, SHORT).error_matrix, simulate(again, SHORT).error_matrix
    )


@pytest.mark.parametrize("plant", ["mine.py:Kiln", "mine.py:Oven"])
def test_a_plant_of_a_file_travels_as_its_text(heater, plant, tmp_path):
    runs = {"loss": np.linspace(0.005, 0.02, 5)}
    more = {"reference": {"temperature": Signal("step", (40.0,))}}
    first = simulate_many(heater, plant, runs, workers=1, **more)
    bench = Bench(experiment_of(heater, plant, **more), ["loss"])
    content = packed((bench.experiment, ("loss",)))
    (tmp_path / "mine.py").unlink()
    (tmp_path / "heater.frb").unlink()
    rows, _ = Bench(*unpacked(content)).rows(0, runs, 5)
    np.testing.assert_array_equal(rows[:, 1:], first.values.reshape(5, -1))


def test_a_controller_of_a_file_travels_as_its_text(tmp_path):
    file = tmp_path / "own.py"
    file.write_text(
        textwrap.dedent(
            """
            from fuzzyarm.control.controllers import Controller


            class Mine(Controller):
                def torque(self, reference, state, clock):
                    return 50.0 * (reference.position[0] - state.position[0]), 0.0
            """
        )
    )
    made = find_controller(str(file))
    content = packed(made)
    file.unlink()
    short = reach_return(segment=0.05, hold=0.01)
    np.testing.assert_array_equal(
        simulate(made, short).error_matrix, simulate(unpacked(content), short).error_matrix
    )


def test_what_was_used_travels_as_well(heater):
    # Of what was computed on the way, such as a compiled formula, nothing goes along.
    from fuzzyarm.learning.tuning.cost import Cost

    cost = Cost("rms + 0.5*max(0, overshoot - 1)")
    values = {"rms": 2.0, "overshoot": 3.0}
    fresh = packed(cost)
    assert cost.of(values) == 3.0
    assert packed(cost) == fresh
    assert unpacked(fresh).of(values) == 3.0
    text = load(heater)
    simulate(text, "room", reference={"temperature": Signal("step", (20.0,))}, duration=100.0)
    again = unpacked(packed(text))
    assert again.model == text.model


def test_a_file_that_was_loaded_twice_travels_and_so_do_two_of_one_name(heater, tmp_path):
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "mine.py").write_text(KILN.replace("0.02 * u", "0.04 * u"))
    names = ("mine.py:Kiln", "other/mine.py:Kiln", "mine.py:Kiln")
    plants = [find_plant(name) for name in names]
    content = [packed(plant) for plant in plants]
    for name in names:
        Path(name).unlink(missing_ok=True)
    given = {"reference": {"temperature": Signal("step", (40.0,))}, "duration": 100.0}
    made = find_controller(heater)
    for plant, packet in zip(plants, content, strict=True):
        again = unpacked(packet)
        np.testing.assert_array_equal(
            simulate(made, plant, **given).error_matrix, simulate(made, again, **given).error_matrix
        )
    slow, fast = (simulate(made, plant, **given).final[0] for plant in plants[:2])
    assert slow != fast


ODD = """
import threading
from functools import cached_property

from fuzzyarm.plant import Plant, Port


class Keeps(Plant):
    inputs = {"power": Port("%", 0, 100)}
    outputs = {"temperature": Port("°C")}
    states = {"T": "°C"}
    parameters = {"loss": 0.01}
    duration = 200.0

    def __init__(self):
        self.loss = lambda p, T: p * (T - 20.0)
        self.lock = threading.Lock()

    @cached_property
    def other(self):
        return threading.Lock()

    def start(self, rng):
        with self.other:
            return [20.0]

    def derivative(self, t, x, u, p):
        with self.lock:
            return [0.02 * u[0] - self.loss(p[0], x[0])]


def made(share):
    class Within(Keeps):
        def derivative(self, t, x, u, p):
            return [share * rate for rate in super().derivative(t, x, u, p)]

    return Within


Within = made(0.5)
oven = Within()
"""


@pytest.mark.parametrize("name", ["Keeps", "Within", "oven"])
def test_a_plant_that_keeps_what_does_not_travel(name, heater, tmp_path):
    (tmp_path / "odd.py").write_text(ODD)
    plant = with_parameters(find_plant(f"odd.py:{name}"), {"loss": 0.02})
    given = {"reference": {"temperature": Signal("step", (40.0,))}}
    text = (tmp_path / "heater.frb").read_text().replace("axis room", "axis " + plant.name)
    (tmp_path / "heater.frb").write_text(text)
    made = find_controller(heater)
    before = simulate(made, plant, **given)
    content = [packed(plant), packed(find_plant(f"odd.py:{name}"))]
    (tmp_path / "odd.py").unlink()
    changed, fresh = map(unpacked, content)  # the one does not change the other
    np.testing.assert_array_equal(
        before.error_matrix, simulate(made, changed, **given).error_matrix
    )
    assert (changed.parameters["loss"], fresh.parameters["loss"]) == (0.02, 0.01)
    assert packed(changed)


def test_errors_travel():
    class OwnError(FuzzyarmError, ValueError):
        def __init__(self, message, place, *, hint=""):
            super().__init__(f"{message} at {place}", hint=hint)
            self.place = place

    error = OwnError("nothing", 3, hint="look there").at("run 2")
    again = unpacked(packed(error))
    assert (str(again), again.place) == ("run 2: nothing at 3 (look there)", 3)
    missing = unpacked(packed(MissingExtraError("cma", "CMA-ES")))
    assert (str(missing), missing.extra) == (str(MissingExtraError("cma", "CMA-ES")), "cma")


def test_what_a_plant_raises_says_in_which_run(heater, tmp_path):
    (tmp_path / "mine.py").write_text(
        KILN.replace("return [0.02", "return [float(1 / p[0]) * 0.02")
    )
    with pytest.raises(FuzzyarmError, match=r"^run 1: plant kiln failed: .*mine.py:21: ZeroDiv"):
        simulate_many(heater, "mine.py:Kiln", {"loss": [0.1, 0.0]}, workers=1)


def test_seeds_are_not_negative():
    for call in (
        lambda: simulate_many("pd", SHORT, {"seed": [3.0, -1.0]}),
        lambda: Options(seed=-1),
    ):
        with pytest.raises(FuzzyarmError, match="a seed of -1 is out of range"):
            call()


def test_what_cannot_travel_says_so():
    class Mine(Controller):
        def __init__(self):
            self.lock = __import__("threading").Lock()

    with pytest.raises(TravelError, match=r"cannot go to another process.*workers=1"):
        packed(Mine())


def test_a_pool_of_threads_as_executor():
    runs = {"payload": np.linspace(0.0, 2.0, 9)}
    with ThreadPoolExecutor(3) as pool:
        many = simulate_many("stfc", SHORT, runs, executor=pool)
    assert same(many, simulate_many("stfc", SHORT, runs, workers=1))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["loky", "concurrent.futures"])
def test_processes_as_executor(kind, heater):
    if kind == "loky":
        pool = pytest.importorskip("loky", reason="loky is an extra").ProcessPoolExecutor(2)
    else:
        from multiprocessing import get_context

        pool = ProcessPoolExecutor(2, get_context("spawn"))
    runs = {"loss": np.linspace(0.005, 0.02, 7)}
    with pool:
        many = simulate_many(heater, "mine.py:Kiln", runs, executor=pool)
    assert same(many, simulate_many(heater, "mine.py:Kiln", runs, workers=1))


@pytest.mark.slow
def test_dask_loses_a_worker_and_no_run():
    distributed = pytest.importorskip("distributed", reason="Dask is an extra")
    runs = {"payload": np.linspace(0.0, 2.0, 24), "K_P": np.linspace(100.0, 150.0, 24)}
    here = simulate_many("pd", SHORT, runs)
    told = []
    with (
        distributed.LocalCluster(2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster, set_as_default=False) as client,
    ):
        workers = client.run(os.getpid)

        def watch(count):
            told.append(count)
            if len(told) == 2:  # in mid-run
                os.kill(next(iter(workers.values())), signal.SIGKILL)

        # As plain Python a run takes long enough for a worker to be killed in it.
        slow = Options(compiled=False)
        many = simulate_many(
            "pd", SHORT, runs, options=slow, executor=client.get_executor(), workers=2, watch=watch
        )
    assert sum(told) == len(many) == 24
    assert len(told) > 2
    assert same(many, here)
