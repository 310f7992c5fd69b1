"""The servo on its motor, proved once for all tests of closed loops."""

from __future__ import annotations

import pytest

import fuzzyarm
from fuzzyarm.control.controllers import ControllerText
from fuzzyarm.proof.loop import LoopVerdict


@pytest.fixture(scope="session")
def servo() -> ControllerText:
    return fuzzyarm.load_controller(fuzzyarm.shipped("servo.frb"))


@pytest.fixture(scope="session")
def servo_verdict(servo: ControllerText) -> LoopVerdict:
    return fuzzyarm.prove(servo, "stable", plant="motor")
