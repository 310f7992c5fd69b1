"""Interpreted and compiled kernels, laziness, and the cache on disk."""

import json
import os
import subprocess
import sys

import pytest

from fuzzyarm import kernels
from fuzzyarm.kernels import build, jit_wanted, kernel


@kernel
def doubled(x):
    return 2.0 * x


@kernel
def added(x, y):
    return doubled(x) + y


def test_bindings_replace_functions_deep_down():
    @kernel
    def tripled(x):
        return 3.0 * x

    assert build(added, compiled=False)(2.0, 1.0) == 5.0
    assert build(added, {"doubled": tripled}, compiled=False)(2.0, 1.0) == 7.0
    assert added(2.0, 1.0) == 5.0


@pytest.mark.slow
def test_compiled_equals_interpreted():
    assert build(added, compiled=True)(0.1, 0.2) == added(0.1, 0.2)


@pytest.mark.parametrize(
    ("value", "wanted"), [("0", False), ("off", False), ("1", True), (None, True)]
)
def test_environment_switches_compilation(monkeypatch, value, wanted):
    if value is None:
        monkeypatch.delenv(kernels.SWITCH, raising=False)
    else:
        monkeypatch.setenv(kernels.SWITCH, value)
    assert jit_wanted() is wanted


def in_new_process(code, **environment):
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout)


def test_importing_does_not_load_numba_or_scipy_or_matplotlib():
    code = (
        "import sys, json, fuzzyarm.plant, fuzzyarm.controller, fuzzyarm.loop, fuzzyarm.study, "
        "fuzzyarm.study.identify, fuzzyarm.study.figures;"
        "heavy = ('numba', 'scipy', 'matplotlib', 'rich');"
        "print(json.dumps([m for m in heavy if m in sys.modules]))"
    )
    assert in_new_process(code) == []


def test_interpreted_run_does_not_load_numba():
    code = (
        "import sys, json;from fuzzyarm.plant import reach;"
        "from fuzzyarm.controller import *;from fuzzyarm.loop import *;"
        "run = simulate(controller('pd'), reach(segment=0.1));"
        "print(json.dumps([run.compiled, 'numba' in sys.modules]))"
    )
    assert in_new_process(code, FUZZYARM_JIT="0") == [False, False]


def test_digest_tells_bindings_apart_that_live_in_one_file():
    from fuzzyarm.loop.loop import run_loop
    from fuzzyarm.plant.setting import kept, rounded

    digests = {kernels._digest(run_loop, {"stored": each}) for each in (kept, rounded)}
    assert len(digests) == 2


@pytest.mark.slow
def test_second_process_loads_machine_code_from_disk(tmp_path):
    code = (
        "import json;from fuzzyarm.plant import reach;from fuzzyarm.controller import *;"
        "from fuzzyarm.loop import run as module, simulate;"
        "simulate(controller('cdid'), reach(segment=0.1));"
        "stats = module.loop_of_laws(True, False).stats;"
        "print(json.dumps([sum(stats.cache_hits.values()), sum(stats.cache_misses.values())]))"
    )
    # A folder of its own stands for a package folder that cannot be written.
    environment = {"NUMBA_CACHE_DIR": str(tmp_path), "FUZZYARM_JIT": "1"}
    assert in_new_process(code, **environment) == [0, 1]
    assert in_new_process(code, **environment) == [1, 0]


def test_digest_covers_every_kernel_file(monkeypatch, tmp_path):
    from fuzzyarm.controller.dispatch import summed_torque
    from fuzzyarm.loop.loop import run_loop

    read = []
    real = kernels.Path.read_bytes

    def watched(path):
        read.append(path.name)
        return real(path)

    monkeypatch.setattr(kernels.Path, "read_bytes", watched)
    kernels._digest(run_loop, {"control": summed_torque})
    wanted = {"loop.py", "arm.py", "setting.py", "dispatch.py", "conventional.py", "adaptive.py"}
    laws = {"fuzzy.py", "self_organizing.py", "sources.py", "fuzzy_kernel.py"}
    assert wanted | laws | {"kernels.py"} <= set(read)


@pytest.mark.slow
def test_without_any_writable_folder_it_compiles_anew(monkeypatch):
    from numba.core.caching import CompileResultCacheImpl

    monkeypatch.setattr(CompileResultCacheImpl, "_locator_classes", [])
    assert build(added, compiled=True)(0.1, 0.2) == added(0.1, 0.2)
