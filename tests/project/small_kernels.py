"""The smallest kernels that are kept as programs are: by address, bound, by numba itself."""

from __future__ import annotations

from fuzzyarm.kernels import call, kernel
from fuzzyarm.plant.setting import stored_double as stored


@kernel
def doubled(x):
    return 2.0 * x


@kernel
def added(x, y):
    return doubled(x) + y


@kernel
def tripled_all(values):
    for i in range(len(values)):
        values[i] = 3.0 * values[i]


@kernel
def called_by_address(values, counts, addresses):
    counts[0] += 1
    call(addresses[0], values[1:])


@kernel
def turned(x, y):
    """So long that it stays a function of its own in the file, as the parts of a loop do."""
    x = stored(0.9 * x - 0.1 * y / (1.0 + abs(x)), True)
    y = stored(0.9 * y + 0.1 * x / (1.0 + abs(y)), True)
    x = stored(0.8 * x - 0.2 * y / (1.0 + abs(x)), True)
    y = stored(0.8 * y + 0.2 * x / (1.0 + abs(y)), True)
    x = stored(0.7 * x - 0.3 * y / (1.0 + abs(x)), True)
    y = stored(0.7 * y + 0.3 * x / (1.0 + abs(y)), True)
    x = stored(0.6 * x - 0.4 * y / (1.0 + abs(x)), True)
    y = stored(0.6 * y + 0.4 * x / (1.0 + abs(y)), True)
    x = stored(0.5 * x - 0.5 * y / (1.0 + abs(x)), True)
    y = stored(0.5 * y + 0.5 * x / (1.0 + abs(y)), True)
    return stored(x + y, True)


@kernel
def turned_all(values):
    for i in range(1, len(values)):
        values[i] = turned(turned(values[i], values[i - 1]), values[i - 1])
    values[0] = turned(values[0], 1.0)
