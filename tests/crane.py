"""Plants of a user's own as files: one with trajectories and a load, with its controller."""

CRANE = '''
from fuzzyarm.plant import Plant, Port, through


def lift(segment=1.0, hold=0.5):
    return through([(1.0,)], segment, hold, name="lift")


class Crane(Plant):
    """A hook on a rope: a mass with friction, which picks up a load."""

    name = "crane"
    axis = "hook"
    inputs = {"force": Port("N", -80, 80)}
    outputs = {"height": Port("m", -5, 5), "speed": Port("m/s", -10, 10, rate_of="height")}
    states = {"height": "m", "speed": "m/s"}
    parameters = {"m": 2.0, "c": 4.0}
    longest_step = 0.005
    trajectories = {"lift": lift, "swing": through([(0.5,), (-0.25,)], 0.8, name="swing")}
    loaded_parameters = {"m": 5.0}

    def derivative(self, t, x, u, p):
        return [x[1], (u[0] - p[1] * x[1]) / p[0]]
'''

SLEDGE = """
from fuzzyarm.plant import Plant, Port

class Sledge(Plant):
    axis = "cart"
    inputs = {"force": Port("N", -30, 30)}
    outputs = {"x": Port("m", -2, 2)}
    states = {"x": "m"}

    def derivative(self, t, x, u, p):
        return [u[0]]
"""
"""It has the axis of a shipped plant, and a drive of another name."""

HOOK = """
controller hook "PD control of a hook"

period 5 ms

gain K_p = 60 "N/m", tune 10 .. 400 log
gain K_d = 20 "N s/m", tune 1 .. 100 log

axis hook
  e  = error of height
  de = error of speed
  drive force = e * K_p + de * K_d
"""


def write_crane(folder):
    """Write both files; return their names."""
    (folder / "crane.py").write_text(CRANE)
    (folder / "hook.frb").write_text(HOOK)
    return str(folder / "crane.py"), str(folder / "hook.frb")


def errors_of_crane(segments, masses, *, step=0.005, gains=(60.0, 20.0), friction=4.0, forces=None):
    """Return the errors of the hook at the set points, written out in plain Python.

    `segments` are (start, end, duration); each has the mass that is moved in it. What is driven is
    added to `forces`.
    """
    x = [segments[0][0], 0.0]
    errors = []
    for (start, end, duration), mass in zip(segments, masses, strict=True):
        for k in range(round(duration / step) + 1):
            s = k * step / duration
            way = end - start
            wanted = start + way * s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
            rate = way / duration * s * s * (30.0 - 60.0 * s + 30.0 * s * s)
            errors.append(wanted - x[0])
            force = gains[0] * (wanted - x[0]) + gains[1] * (rate - x[1])
            force = min(max(force, -80.0), 80.0)
            if forces is not None:
                forces.append(force)
            x = runge_kutta(x, lambda y, f=force, m=mass: (y[1], (f - friction * y[1]) / m), step)
    return errors


def runge_kutta(x, slope, h):
    """Advance by one classical fourth-order step."""
    k1 = slope(x)
    k2 = slope([a + 0.5 * h * b for a, b in zip(x, k1, strict=True)])
    k3 = slope([a + 0.5 * h * b for a, b in zip(x, k2, strict=True)])
    k4 = slope([a + h * b for a, b in zip(x, k3, strict=True)])
    rows = zip(x, k1, k2, k3, k4, strict=True)
    return [a + h / 6.0 * (b + 2.0 * c + 2.0 * d + e) for a, b, c, d, e in rows]
