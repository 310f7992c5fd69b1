"""A controller of your own: PD with gravity compensation, in plain Python.

Run it beside any other:

    fuzzyarm simulate examples/own_controller.py --payload
    fuzzyarm simulate examples/own_controller.py+ie --payload
"""

import math

from fuzzyarm.control.controllers import Controller
from fuzzyarm.plant import UNLOADED

STIFFNESS = (300.0, 200.0)  # N m/rad
DAMPING = (50.0, 40.0)  # N m s/rad


class GravityCompensation(Controller):
    """Carries the weight of the arm that it knows, and pulls the rest like a spring."""

    def torque(self, reference, state, clock):
        """Return both torques, N m."""
        arm = UNLOADED
        forearm = arm.g * arm.m_2 * arm.x_2 * math.cos(sum(state.position))
        upper = arm.g * (arm.m_1 * arm.x_1 + arm.m_2 * arm.l_1) * math.cos(state.position[0])
        weight = (upper + forearm, forearm)
        return [
            weight[joint]
            + STIFFNESS[joint] * (reference.position[joint] - state.position[joint])
            + DAMPING[joint] * (reference.velocity[joint] - state.velocity[joint])
            for joint in (0, 1)
        ]
