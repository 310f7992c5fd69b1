"""The plug-in of docs/howto/ros2.md, compiled without ROS 2: its commands are those of Python."""

from __future__ import annotations

import math
import random
import re
import subprocess
from pathlib import Path

import pytest
from needs import need

from fuzzyarm import load_controller, shipped
from fuzzyarm.apps.cli import main

ROOT = Path(__file__).parents[2]
HERE = Path(__file__).parent / "ros2"
HEADERS = (
    "controller_interface/controller_interface.hpp",
    "pluginlib/class_list_macros.hpp",
    "realtime_tools/realtime_buffer.hpp",
    "std_msgs/msg/float64.hpp",
)


@pytest.fixture(scope="module")
def manager(tmp_path_factory):
    """The plug-in of the page and what runs it, built with g++."""
    need("C compiler", "g++")
    folder = tmp_path_factory.mktemp("ros2")
    for name in HEADERS:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text('#include "ros2_control_stub.hpp"\n')
    page = (ROOT / "docs" / "howto" / "ros2.md").read_text("utf-8")
    (plugin,) = re.findall(r"^```cpp\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    (folder / "servo_controller.cpp").write_text(plugin)
    assert main(["compile", str(shipped("servo.frb")), "-o", str(folder / "servo.c")]) == 0
    strict = ["-Wall", "-Wextra", "-Werror", "-ffp-contract=off"]
    run(folder, "cc", "-std=c99", *strict, "-c", "servo.c")
    run(
        folder, "g++", "-std=c++17", *strict, "-I.", f"-I{HERE}", "servo_controller.cpp",
        HERE / "manager.cpp", "servo.o", "-lm", "-o", "manager",
    )  # fmt: skip
    return folder / "manager"


def run(folder, *words):
    done = subprocess.run(
        [*map(str, words)], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def commands(manager, rows, rate=1000):
    text = "\n".join(" ".join(map(repr, row)) for row in rows)
    words = [str(manager), str(rate)]
    return subprocess.run(words, input=text, capture_output=True, text=True, check=False)


def test_its_commands_are_those_of_the_controller_in_python(manager):
    draw = random.Random(2)
    rows = [(1.0, draw.uniform(-1, 2), draw.uniform(-9, 9)) for _ in range(200)]
    rows[50] = (1.0, math.nan, 0.0)  # a lost sample: the command stays
    said = commands(manager, rows)
    assert said.returncode == 0, said.stderr
    names, numbers = said.stdout.split()[:3], [*map(float, said.stdout.split()[3:])]
    assert names == ["shaft/voltage", "shaft/position", "shaft/velocity"]
    python = load_controller(shipped("servo.frb")).run()
    for (wanted, position, velocity), found in zip(rows, numbers, strict=False):
        measured = {"position": position, "velocity": velocity}
        expected = python.step(measured, {"position": wanted, "velocity": 0.0})["voltage"]
        assert found == pytest.approx(expected, abs=1e-4)
    assert numbers[50] == numbers[49]
    assert numbers[200:] == [0.0]  # as it is deactivated


def test_another_rate_is_refused(manager):
    said = commands(manager, [], rate=500)
    assert said.returncode == 3
    assert "servo runs every 0.001 s" in said.stderr
