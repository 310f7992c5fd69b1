"""The accuracy of exported inference is measured in bounded memory, whatever the inputs."""

import tracemalloc

import pytest

from fuzzyarm import parse
from fuzzyarm.exchange.export import routines_of


@pytest.mark.slow
@pytest.mark.parametrize("count", [9, 12, 20, 32])
def test_many_inputs_are_measured_at_some_points(count):
    names = [f"x{i}" for i in range(count)]
    text = "rulebase many\n" + "".join(f"input {name} 0 .. 1\n" for name in names)
    text += (
        "output y 0 .. 1\n" + f"terms {', '.join(names)}, y: triangles L H\ninference no-rule 0\n"
    )
    text += f"rule if {' and '.join(f'{name} is L' for name in names)} then y is L\n"
    text += "rule if x0 is H or x1 is H then y is H\n"
    tracemalloc.start()
    (routine,) = routines_of(parse(text).rulebase)
    accuracy = routine.accuracy
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 500e6
    assert accuracy.points > 10_000
    assert accuracy.worst < 1e-6
