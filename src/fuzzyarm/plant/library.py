"""The shipped plants besides the arm: servo, cart-pole, coupled tanks, ball and beam, room.

Equations and sources are in ``docs/reference/plants.md``. Every equation is a kernel and runs as
machine code; `x` holds the states, `u` the inputs and `p` the parameters, in the order of the
mappings.

To add a plant
--------------
Add a class with ports, states, parameters and a ``derivative`` that is a kernel, and its name to
``LIBRARY``. ``longest_step`` is a fraction of the shortest time constant; ``bound`` is the limit
of divergence. Its picture is a function of :mod:`fuzzyarm.plant.drawings`; pushing it by hand in
the designer is defined in ``apps/designer/stage.py``. Add a controller to ``rulebases/``;
conserved quantities, its equations derived independently, and the figures of its controller to
``tests/plant/test_library.py``; equations and source to ``docs/reference/plants.md``. A plant of
another package is a module beside this one (``environments.py``, ``fmu.py``) and a prefix in
``find_plant``. Abilities of one plant (trajectories, loads) are declared by the plant itself.

A switch (a stop, a weir, a diode) is best written with ``max``, ``min`` or ``abs``: then the
equations are traced, and proofs read them. An ``if`` on a state runs, too, but no proof reads it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fuzzyarm.plant.drawings import draw_beam, draw_cartpole, draw_motor, draw_room, draw_tanks
from fuzzyarm.plant.plant import Parameter, Plant, Port, parameter
from fuzzyarm.symbolic.kernels import kernel


class Motor(Plant):
    """A DC servo: armature with inductance, inertia with viscous friction, a load torque.

    ``J ω' = k i - b ω - T``, ``L i' = V - R i - k ω``.
    """

    name = "motor"
    summary = "DC servo: voltage to shaft position"
    axis = "shaft"
    inputs = {"voltage": Port("V", -24.0, 24.0)}
    outputs = {
        "position": Port("rad", -2 * math.pi, 2 * math.pi, bound=200 * math.pi),
        "velocity": Port("rad/s", -60.0, 60.0, rate_of="position", bound=1e5),
        "current": Port("A", -12.0, 12.0, bound=1e5),
    }
    states = {"position": "rad", "velocity": "rad/s", "current": "A"}
    parameters = {
        "J": Parameter(0.01, "kg m²", "inertia of rotor and load"),
        "b": Parameter(0.02, "N m s/rad", "viscous friction"),
        "k": Parameter(0.35, "N m/A", "torque and back-EMF constant"),
        "R": Parameter(2.0, "Ω", "resistance of the armature"),
        "L": Parameter(0.004, "H", "inductance of the armature"),
        "T": Parameter(0.0, "N m", "load torque against positive rotation"),
    }
    duration = 2.0
    longest_step = 0.001  # half of the electrical time constant L/R
    draw = draw_motor

    @staticmethod
    @kernel
    def derivative(t: float, x: list[float], u: list[float], p: list[float]) -> tuple[float, ...]:
        """Return velocity, acceleration and the rate of the current."""
        # x: position, velocity, current; u: voltage; p: J, b, k, R, L, T.
        acceleration = (p[2] * x[2] - p[1] * x[1] - p[5]) / p[0]
        return x[1], acceleration, (u[0] - p[3] * x[2] - p[2] * x[1]) / p[4]


class CartPole(Plant):
    """A pole hinged on a cart, upright at ``theta = 0``; no friction.

    Barto, Sutton and Anderson, "Neuronlike adaptive elements that can solve difficult learning
    control problems", IEEE Transactions on Systems, Man, and Cybernetics 13(5), 1983.
    """

    name = "cartpole"
    summary = "pole on a cart: force to position and angle, unstable"
    axis = "cart"
    inputs = {"f": Port("N", -10.0, 10.0)}
    outputs = {
        "x": Port("m", -2.4, 2.4, bound=10.0),
        "v": Port("m/s", -3.0, 3.0, rate_of="x", bound=1e3),
        # Beyond a quarter turn the pole lies on the track.
        "theta": Port("rad", -0.5, 0.5, bound=math.pi / 2),
        "omega": Port("rad/s", -3.0, 3.0, rate_of="theta", bound=1e3),
    }
    states = {"x": "m", "v": "m/s", "theta": "rad", "omega": "rad/s"}
    parameters = {
        "M": Parameter(1.0, "kg", "mass of the cart"),
        "m": Parameter(0.1, "kg", "mass of the pole"),
        "l": Parameter(0.5, "m", "half the length of the pole"),
        "g": Parameter(9.8, "m/s²", "gravity"),
        "theta_0": Parameter(0.05, "rad", "angle at the start"),
    }
    duration = 10.0
    longest_step = 0.005
    draw = draw_cartpole

    def start(self, rng: np.random.Generator) -> Sequence[float]:
        """Return a slightly tilted start."""
        return [0.0, 0.0, parameter(self, "theta_0").value, 0.0]

    @staticmethod
    @kernel
    def derivative(t: float, x: list[float], u: list[float], p: list[float]) -> tuple[float, ...]:
        """Return the rates of both positions and both velocities."""
        # x: x, v, theta, omega; u: f; p: M, m, l, g. The paper's equations without friction;
        # 4/3 m l² is the moment of inertia of a uniform rod about its end (its length is 2 l).
        sine, cosine = math.sin(x[2]), math.cos(x[2])
        total = p[0] + p[1]
        force = (u[0] + p[1] * p[2] * x[3] * x[3] * sine) / total
        angular = (p[3] * sine - cosine * force) / (
            p[2] * (4.0 / 3.0 - p[1] * cosine * cosine / total)
        )
        return x[1], force - p[1] * p[2] * angular * cosine / total, x[3], angular


class Tanks(Plant):
    """Two tanks, one below the other: a pump fills the upper one, each drains by a hole.

    ``A h1' = k V - a sqrt(2 g h1)``, ``A h2' = a sqrt(2 g h1) - a sqrt(2 g h2)`` (Torricelli).
    """

    name = "tanks"
    summary = "two coupled tanks: pump voltage to levels"
    axis = "tanks"
    inputs = {"pump": Port("V", 0.0, 12.0)}
    outputs = {
        "level1": Port("m", 0.0, 0.3, bound=10.0),
        "level2": Port("m", 0.0, 0.3, bound=10.0),
    }
    states = {"level1": "m", "level2": "m"}
    parameters = {
        "A": Parameter(0.0015, "m²", "section of each tank"),
        "a": Parameter(1.8e-5, "m²", "section of each hole"),
        "k": Parameter(4.5e-6, "m³/(V s)", "flow of the pump"),
        "g": Parameter(9.81, "m/s²", "gravity"),
    }
    duration = 600.0
    longest_step = 0.5
    draw = draw_tanks

    @staticmethod
    @kernel
    def derivative(t: float, x: list[float], u: list[float], p: list[float]) -> tuple[float, ...]:
        """Return the rates of both levels."""
        # x: both levels; u: pump; p: A, a, k, g.
        # An empty tank has no outflow; a step of the integrator may probe slightly below empty.
        first = p[1] * math.sqrt(2.0 * p[3] * max(x[0], 0.0))
        second = p[1] * math.sqrt(2.0 * p[3] * max(x[1], 0.0))
        return (p[2] * u[0] - first) / p[0], (first - second) / p[0]


class BallAndBeam(Plant):
    """A ball rolling on a beam; the turning rate of the beam is driven.

    ``(1 + 2/5) r'' = r θ'² - g sin θ`` for a solid ball (Hauser, Sastry and Kokotović, IEEE
    Transactions on Automatic Control 37(3), 1992), with the sign of the angle chosen so that a
    positive one rolls the ball to positive positions.
    """

    name = "ball-and-beam"
    summary = "ball on a beam: rate of the beam to position, a triple integrator"
    axis = "beam"
    inputs = {"angle_rate": Port("rad/s", -2.0, 2.0)}
    outputs = {
        "position": Port("m", -0.5, 0.5, bound=0.5),
        "velocity": Port("m/s", -1.0, 1.0, rate_of="position", bound=1e3),
        "angle": Port("rad", -0.5, 0.5, bound=math.pi / 2),
    }
    states = {"position": "m", "velocity": "m/s", "angle": "rad"}
    parameters = {
        "g": Parameter(9.81, "m/s²", "gravity"),
        "inertia": Parameter(0.4, "1", "moment of inertia of the ball over m r²"),
    }
    duration = 20.0
    longest_step = 0.01
    draw = draw_beam

    @staticmethod
    @kernel
    def derivative(t: float, x: list[float], u: list[float], p: list[float]) -> tuple[float, ...]:
        """Return velocity, acceleration and the rate of the angle."""
        # x: position, velocity, angle; u: rate of the angle; p: g, inertia.
        gained = x[0] * u[0] * u[0] + p[0] * math.sin(x[2])
        return x[1], gained / (1.0 + p[1]), u[0]


class Room(Plant):
    """A heated room: air and walls as two heat capacities, cold outside.

    ``C_a T' = P - (T - W)/R_w - (T - out)/R_l``, ``C_w W' = (T - W)/R_w - (W - out)/R_o``.
    """

    name = "room"
    summary = "heated room: power to temperature, slow"
    axis = "room"
    inputs = {"power": Port("%", 0.0, 100.0)}
    outputs = {"temperature": Port("°C", -20.0, 60.0, bound=1e3)}
    states = {"temperature": "°C", "wall": "°C"}
    parameters = {
        "P": Parameter(2000.0, "W", "power of the heater at 100 %"),
        "C_a": Parameter(2.5e5, "J/K", "heat capacity of air and furniture"),
        "C_w": Parameter(4.0e6, "J/K", "heat capacity of the walls"),
        "R_w": Parameter(0.008, "K/W", "resistance from air to walls"),
        "R_o": Parameter(0.02, "K/W", "resistance from walls to outside"),
        "R_l": Parameter(0.05, "K/W", "resistance of windows and leaks"),
        "outside": Parameter(5.0, "°C", "temperature outside"),
        "T_0": Parameter(15.0, "°C", "temperature at the start"),
    }
    duration = 14400.0
    longest_step = 60.0
    draw = draw_room

    def start(self, rng: np.random.Generator) -> Sequence[float]:
        """Start with air and walls at one temperature."""
        return [parameter(self, "T_0").value] * 2

    @staticmethod
    @kernel
    def derivative(t: float, x: list[float], u: list[float], p: list[float]) -> tuple[float, ...]:
        """Return the rates of both temperatures."""
        # x: air, walls; u: power in %; p: P, C_a, C_w, R_w, R_o, R_l, outside.
        to_wall = (x[0] - x[1]) / p[3]
        lost = (x[0] - p[6]) / p[5]
        heated = 0.01 * p[0] * u[0]
        return (heated - to_wall - lost) / p[1], (to_wall - (x[1] - p[6]) / p[4]) / p[2]


LIBRARY: dict[str, type[Plant]] = {
    plant.name: plant for plant in (Motor, CartPole, Tanks, BallAndBeam, Room)
}
"""The plants of this module by name."""
