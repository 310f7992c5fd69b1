"""A robot in a MuJoCo model (MJCF or URDF) as a plant: torques in, positions and velocities out.

A joint is an axis with the ports of the study's arm: `position`, `velocity`, `torque` (`force` of a
sliding joint). The actuators of the file limit the torques. Its servos are left out, since the
controller takes their place. An actuator named ``AXIS.PORT`` is a port of its own, as the voltage
of a motor.
"""

from __future__ import annotations

import math
import os
import sys
import threading
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cache, partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fuzzyarm.base.errors import demand_extra
from fuzzyarm.base.names import near_hint
from fuzzyarm.base.picture import Drawing, Line, Mark, Part
from fuzzyarm.base.protected import note_source
from fuzzyarm.plant.drawings import PlantScene
from fuzzyarm.plant.driven_arm import ERROR_BOUND, SPEED_BOUND
from fuzzyarm.plant.plant import Address, Parameter, Plant, PlantError, Port, parameter
from fuzzyarm.plant.setting import RunArithmetic
from fuzzyarm.plant.trajectory import Trajectory, pick_and_place, reach, reach_return

Vector = NDArray[np.float64]

LOAD = "load"
"""The site that carries the load, and the parameter of its mass; a numeric field of this name in
the file is the full load."""

FACTOR = "masses"
"""The parameter that scales all masses and inertias, which controllers do not know."""

MOVE, SLIDE = 20.0, 0.1
"""Default move of each joint: degrees; of a sliding one m."""


class RobotPlant(Plant):
    """A MuJoCo robot as a plant.

    The states are MuJoCo's: positions, velocities, and activations of actuators. A control period
    is divided into equal steps no longer than that of the file.

    Parameters
    ----------
    path : str
        An ``.xml`` or ``.urdf`` file.

    Raises
    ------
    PlantError
        If MuJoCo cannot read the file, or no joint can be driven.
    MissingExtraError
        If MuJoCo is not installed.
    """

    def __init__(self, path: str) -> None:
        demand_extra("mujoco", "plants", "a robot")
        self.path = str(path)
        self.name = Path(self.path).stem
        self._local = threading.local()
        robot = self._compiled({})
        self._step = float(robot.opt.timestep)
        self.joints = _driven_joints(robot)
        if not self.joints:
            raise PlantError(f"{self.path} has no hinge or slide joint to drive", name=self.name)
        at = [int(robot.joint(joint).qposadr[0]) for joint in self.joints]
        self.dofs = [int(robot.joint(joint).dofadr[0]) for joint in self.joints]
        self._observed = [*at, *(robot.nq + dof for dof in self.dofs)]
        self._positions = at
        self.outputs = _outputs(robot, self.joints)
        self._own = {name: robot.actuator(name).id for name in _named_ports(robot)}
        self.inputs = _torques(robot, self.joints) | {
            name: Port("V" if name.endswith(".voltage") else "1", *_range(robot, index))
            for name, index in self._own.items()
        }
        unlike = [f"q{i + 1}" for i in range(robot.nq)]
        for joint, place in zip(self.joints, at, strict=True):
            unlike[place] = f"{joint}.position"
        rates = [f"v{i + 1}" for i in range(robot.nv)]
        self.states = dict.fromkeys([*unlike, *rates, *(f"a{i + 1}" for i in range(robot.na))], "1")
        self.parameters = _parameters(robot)
        self._stated = tuple(parameter(self, name).value for name in self.parameters)
        full = _full_load(robot)
        if full:
            self.loaded_parameters = {LOAD: full}
        home = [float(_home(robot)[place]) for place in at]
        rest, moved = zip(*map(partial(_default_move, robot), self.joints, home), strict=True)
        moves: dict[str, Callable[..., Trajectory]] = {
            "reach-return": reach_return, "pick-and-place": pick_and_place, "reach": reach
        }  # fmt: skip
        self.trajectories = {
            name: partial(make, angles=moved, start=rest) for name, make in moves.items()
        }

    # Models belong to a thread: copies and other processes compile their own, once they run.

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name != "_local"}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        vars(self).update(state, _local=threading.local())

    # --- The model ---

    def _compiled(self, values: Mapping[str, float]) -> Any:
        """Compile the file with other masses, gravity and load."""
        mujoco = _mujoco()
        for name, value in values.items():
            if value < 0.0 or (value == 0.0 and name not in ("gravity", LOAD)):
                message = f"{name} = {value:g} of {self.name} is out of range"
                hint = "0 or more" if name in ("gravity", LOAD) else "a positive number"
                raise PlantError(message, name=name, hint=hint)
        note_source(self.path)
        Path(self.path).read_bytes()  # raises OSError
        try:
            specification = mujoco.MjSpec.from_file(self.path)
            load = values.get(LOAD, 0.0)
            if load > 0.0:
                site = next(site for site in specification.sites if site.name == LOAD)
                body = site.parent.add_body(name="_load", pos=site.pos)
                body.mass, body.inertia, body.ipos = load, [1e-9] * 3, [0.0] * 3
                body.explicitinertial = True
            robot = specification.compile()
        except ValueError as error:
            reason = ", ".join(filter(None, map(str.strip, str(error).splitlines())))
            raise PlantError(f"{self.path}: {reason}", name=self.name) from error
        for index in range(1, robot.nbody):
            name = _mass_name(robot, index)
            factor = values.get(FACTOR, 1.0)
            if name in values and robot.body_mass[index] > 0.0:
                factor *= values[name] / robot.body_mass[index]
            if robot.body(index).name != "_load":
                robot.body_mass[index] *= factor
                robot.body_inertia[index] *= factor
        if "gravity" in values:
            direction = np.array(robot.opt.gravity)
            size = float(np.linalg.norm(direction))
            down = direction / size if size else np.array([0.0, 0.0, -1.0])
            robot.opt.gravity[:] = values["gravity"] * down
        # A diverged run ends as one: without this MuJoCo begins again from the start.
        robot.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        mujoco.mj_setConst(robot, mujoco.MjData(robot))
        return robot

    def _loaded(self, values: tuple[float, ...] = ()) -> tuple[Any, Any]:
        """Return model and data of some parameters; by default those of the file."""
        mujoco = _mujoco()
        models: dict[Any, tuple[Any, Any]] = vars(self._local).setdefault("models", {})
        values = values or self._stated
        if values not in models:
            robot = self._compiled(dict(zip(self.parameters, values, strict=False)))
            # Servos of the file would work against the controller, and a motor without a drive is
            # open: it does not brake.
            powered = values[len(self.parameters) :] or [1.0] * len(self._own)
            kept = [i for i, on in zip(self._own.values(), powered, strict=True) if on]
            others = [i for i in range(robot.nu) if i not in kept]
            robot.actuator_gainprm[others] = robot.actuator_biasprm[others] = 0.0
            models[values] = robot, mujoco.MjData(robot)
        return models[values]

    # --- Running ---

    def pack(self, driven: Collection[Address], arithmetic: RunArithmetic) -> list[float]:
        """Return the parameters, then for each port of its own whether it is driven."""
        powered = [float(tuple(name.rsplit(".", 1)) in driven) for name in self._own]
        return [*(parameter(self, name).value for name in self.parameters), *powered]

    def start(self, rng: np.random.Generator) -> Sequence[float]:
        """Return the first keyframe of the file at rest, or its reference position."""
        robot, _ = self._loaded()
        return [*map(float, _home(robot)), *[0.0] * (robot.nv + robot.na)]

    def step(self, t: float, x: Any, u: Any, p: Any, dt: float) -> Sequence[float]:
        """Advance by one or several steps of MuJoCo."""
        mujoco = _mujoco()
        robot, data = self._loaded(tuple(p))
        nq, nv = robot.nq, robot.nv
        data.time = t
        data.qpos[:], data.qvel[:], data.act[:] = x[:nq], x[nq : nq + nv], x[nq + nv :]
        # Solvers start from their last solution: reset it, so that the same state gives the same
        # step.
        data.qacc_warmstart[:] = 0.0
        data.qfrc_applied[self.dofs] = u[: len(self.dofs)]
        for name, value in zip(self._own, u[len(self.dofs) :], strict=True):
            data.ctrl[self._own[name]] = value
        steps = max(1, math.ceil(dt / self._step - 1e-9))
        robot.opt.timestep = dt / steps
        mujoco.mj_step(robot, data, steps)
        return [*data.qpos.tolist(), *data.qvel.tolist(), *data.act.tolist()]

    def measure(self, t: float, x: Any, u: Any, p: Any) -> list[float]:
        """Return positions and velocities of the joints."""
        return [x[place] for place in self._observed]

    # --- The model that controllers have: the file, whatever the parameters are ---

    def inverse_dynamics(
        self, position: Vector, velocity: Vector, acceleration: Vector, along: Vector | None = None
    ) -> Vector:
        """Return ``M(q) a + C(q, v) w + D w + g(q)``, N m.

        Parameters
        ----------
        position, velocity, acceleration : ndarray, shape (n,)
            Of each joint, SI.
        along : ndarray, shape (n,), optional
            The velocity w; by default v.
        """
        mujoco = _mujoco()
        robot, data = self._loaded()
        if robot.nv != len(self.dofs):
            message = f"{self.name} has joints without a drive, so no inverse dynamics"
            raise PlantError(message, name=self.name)

        def torque(velocity: Vector, acceleration: Vector | None = None) -> Vector:
            data.qvel[self.dofs] = velocity
            mujoco.mj_comVel(robot, data)
            out = np.zeros(robot.nv)
            if acceleration is not None:
                data.qacc[self.dofs] = acceleration
            mujoco.mj_rne(robot, data, int(acceleration is not None), out)
            return out[self.dofs]

        data.qpos[self._positions] = position
        mujoco.mj_kinematics(robot, data)
        mujoco.mj_comPos(robot, data)
        w = velocity if along is None else along
        still = np.zeros(len(self.dofs))
        if along is None:
            total = torque(velocity, acceleration)
        else:
            # C(q, v) w is bilinear and symmetric in v and w (Christoffel symbols): a quarter of
            # C(q, v + w) (v + w) - C(q, v - w) (v - w). Gravity drops out of the difference.
            total = torque(still, acceleration)
            total += 0.25 * (torque(velocity + w) - torque(velocity - w))
        # RNE has the bodies alone: motors and friction are on the diagonal.
        motors, friction = robot.dof_armature[self.dofs], robot.dof_damping[self.dofs]
        return np.asarray(total + motors * acceleration + friction * w)

    # --- Pictures ---

    def _points(self, angles: Sequence[float]) -> tuple[Vector, list[tuple[int, int]]]:
        """Return the points of all bodies, projected, and the pairs of parent and child."""
        mujoco = _mujoco()
        robot, data = self._loaded()
        data.qpos[:] = _home(robot)
        data.qpos[self._positions] = angles
        mujoco.mj_kinematics(robot, data)
        ends = [*data.xpos, *data.site_xpos]
        pairs = [(int(robot.body_parentid[i]), i) for i in range(1, robot.nbody)]
        pairs += [(int(robot.site_bodyid[i]), robot.nbody + i) for i in range(robot.nsite)]
        return np.array(ends) @ _VIEW.T, pairs

    def draw(self, scene: PlantScene) -> Drawing:
        """Draw the links from body to body, seen from the front and above."""
        names = [f"{joint}.position" for joint in self.joints]
        wanted = [scene.wanted(name) for name in names]
        parts: list[Part] = []
        poses = [([scene.output(name) for name in names], "first", 5.0)]
        if all(angle is not None for angle in wanted):
            poses.insert(0, ([float(angle or 0.0) for angle in wanted], "wanted", 2.0))
        for angles, tone, width in poses:  # last that of the outputs
            points, pairs = self._points(angles)
            for parent, child in pairs:
                (x, y), (tip_x, tip_y) = points[parent], points[child]
                parts.append(Line((float(x), float(tip_x)), (float(y), float(tip_y)), tone, width))
        for parent, _ in pairs:
            parts.append(Mark(float(points[parent][0]), float(points[parent][1]), "o", 4))
        robot, _ = self._loaded()
        size = 1.1 * float(robot.stat.extent)
        middle = _VIEW @ np.array(robot.stat.center)
        left, low = float(middle[0]) - size / 2, float(middle[1]) - size / 2
        tip = points[-1]
        return Drawing((left, left + size, low, low + size), parts, (float(tip[0]), float(tip[1])))

    def picture(self, scene: PlantScene, width: int = 480, height: int = 480) -> Any:
        """Return a camera picture by MuJoCo's renderer, an array of height × width × 3 bytes.

        The view is that of the first camera of the file, or MuJoCo's free one.

        Raises
        ------
        PlantError
            If this machine has no OpenGL.
        """
        mujoco = _mujoco()
        robot, data = self._loaded()
        data.qpos[:] = _home(robot)
        data.qpos[self._positions] = [scene.output(f"{joint}.position") for joint in self.joints]
        mujoco.mj_forward(robot, data)
        try:
            renderer = vars(self._local).setdefault("renderer", {})
            if not renderer:
                renderer[0] = mujoco.Renderer(robot, height, width)
            renderer[0].update_scene(data, camera=0 if robot.ncam else -1)
            return renderer[0].render()
        except Exception as error:  # of several libraries
            message = f"no picture of {self.name}: MuJoCo has no OpenGL here"
            hint = "MUJOCO_GL=egl or MUJOCO_GL=osmesa chooses a renderer without a screen"
            raise PlantError(message, name=self.name, hint=hint) from error


_VIEW = np.array([[0.8, -0.6, 0.0], [0.2, 0.3, 0.93]])
"""From space to the plane of a drawing, seen from the front, right and above."""


def menagerie(name: str) -> RobotPlant:
    """Return a robot of MuJoCo Menagerie; the package fetches its files once."""
    if find_spec("mujoco_menagerie") is None:
        message = "a robot of MuJoCo Menagerie needs the package mujoco-menagerie"
        raise PlantError(message, name=name, hint="pip install mujoco-menagerie")
    import mujoco_menagerie

    names = mujoco_menagerie.names()
    if name not in names:
        longer = next((f"did you mean '{each}'?" for each in names if name and name in each), "")
        hint = near_hint(name, names)[0] or longer or "python -m mujoco_menagerie lists them"
        raise PlantError(f"MuJoCo Menagerie has no '{name}'", name=name, hint=hint)
    try:
        path = mujoco_menagerie.get(name).xml()
    except mujoco_menagerie.MenagerieError as error:  # it is fetched, once
        raise PlantError(f"'{name}' of MuJoCo Menagerie: {error}", name=name) from error
    plant = RobotPlant(str(path))
    plant.name = name
    return plant


@cache
def _mujoco() -> Any:
    """Import MuJoCo; without a screen its pictures come from EGL."""
    if sys.platform == "linux" and not os.environ.get("DISPLAY"):
        os.environ.setdefault("MUJOCO_GL", "egl")
    import mujoco

    # Its own handler prints, and writes a file into the working folder.
    mujoco.set_mju_user_warning(lambda _message: None)
    return mujoco


# --- Contents of a model file ---


def _driven_joints(robot: Any) -> list[str]:
    """Return the joints with an actuator; all hinges and slides of a file without any."""
    mujoco = _mujoco()
    kinds = {int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)}
    named = [i for i in range(robot.njnt) if robot.joint(i).name]
    moved = [i for i in named if int(robot.jnt_type[i]) in kinds]
    acted = {int(robot.actuator_trnid[i, 0]) for i in range(robot.nu) if _is_of_joint(robot, i)}
    return [robot.joint(i).name for i in moved if i in acted or not robot.nu]


def _is_of_joint(robot: Any, actuator: int) -> bool:
    mujoco = _mujoco()
    return int(robot.actuator_trntype[actuator]) == int(mujoco.mjtTrn.mjTRN_JOINT)


def _named_ports(robot: Any) -> list[str]:
    """Return the actuators named as ports."""
    return [robot.actuator(i).name for i in range(robot.nu) if "." in robot.actuator(i).name]


def _outputs(robot: Any, joints: Sequence[str]) -> dict[str, Port]:
    """Return positions, then velocities, of the joints."""
    positions, velocities = {}, {}
    for name in joints:
        joint = robot.joint(name)
        turns = _turns(robot, name)
        unit, bound = ("rad", ERROR_BOUND) if turns else ("m", 1e3)
        low, high = map(float, joint.range) if robot.jnt_limited[joint.id] else (-bound, bound)
        positions[f"{name}.position"] = Port(
            unit, low, high, bound=math.inf if turns else 1e3, error_bound=bound
        )
        velocities[f"{name}.velocity"] = Port(
            f"{unit}/s", -10.0, 10.0, rate_of="position", bound=SPEED_BOUND
        )
    return positions | velocities


def _default_move(robot: Any, joint: str, home: float) -> tuple[float, float]:
    """Return start and target of a joint, within its range; of a hinge in degrees."""
    turns, index = _turns(robot, joint), robot.joint(joint).id
    scale, move = (180.0 / math.pi, MOVE) if turns else (1.0, SLIDE)
    low, high = (float(x) * scale for x in robot.jnt_range[index])
    rest = round(home * scale, 9)
    if not robot.jnt_limited[index] or rest + move <= high:
        return rest, rest + move
    return rest, rest - move if rest - move >= low else round(0.5 * (rest + high), 9)


def _turns(robot: Any, joint: str) -> bool:
    mujoco = _mujoco()
    return int(robot.jnt_type[robot.joint(joint).id]) == int(mujoco.mjtJoint.mjJNT_HINGE)


def _torques(robot: Any, joints: Sequence[str]) -> dict[str, Port]:
    """Return the torque port of each joint with the limits of its actuators."""
    ports = {}
    for name in joints:
        index = robot.joint(name).id
        limits = [
            _effort(robot, i)
            for i in range(robot.nu)
            if _is_of_joint(robot, i)
            and robot.actuator_trnid[i, 0] == index
            and "." not in robot.actuator(i).name
        ]
        low = max((pair[0] for pair in limits), default=-math.inf)
        high = min((pair[1] for pair in limits), default=math.inf)
        port, unit = ("torque", "N m") if _turns(robot, name) else ("force", "N")
        ports[f"{name}.{port}"] = Port(unit, low, high)
    return ports


def _range(robot: Any, actuator: int) -> tuple[float, float]:
    if not robot.actuator_ctrllimited[actuator]:
        return -math.inf, math.inf
    low, high = map(float, robot.actuator_ctrlrange[actuator])
    return low, high


def _effort(robot: Any, actuator: int) -> tuple[float, float]:
    """Return the torques of an actuator at its joint: of its force, or a motor's control."""
    mujoco = _mujoco()
    gear = abs(float(robot.actuator_gear[actuator, 0]))
    if robot.actuator_forcelimited[actuator]:
        low, high = map(float, robot.actuator_forcerange[actuator])
        return gear * low, gear * high
    if int(robot.actuator_biastype[actuator]) != int(mujoco.mjtBias.mjBIAS_NONE):
        return -math.inf, math.inf  # a servo, whose control is not a torque
    gain = gear * abs(float(robot.actuator_gainprm[actuator, 0]))
    low, high = _range(robot, actuator)
    return gain * low, gain * high


def _mass_name(robot: Any, body: int) -> str:
    return f"mass_{robot.body(body).name or body}"


def _parameters(robot: Any) -> dict[str, Parameter | float]:
    """Return gravity, masses and the load as parameters."""
    values: dict[str, Parameter | float] = {
        FACTOR: Parameter(1.0, "1", "factor on all masses and inertias"),
        "gravity": Parameter(float(np.linalg.norm(robot.opt.gravity)), "m/s²", "of the world"),
    }
    if any(robot.site(i).name == LOAD for i in range(robot.nsite)):
        values[LOAD] = Parameter(0.0, "kg", "a point mass at the site of this name")
    for index in range(1, robot.nbody):
        if robot.body_mass[index] > 0.0:
            mass = float(robot.body_mass[index])
            values[_mass_name(robot, index)] = Parameter(mass, "kg", "with inertia in proportion")
    return values


def _full_load(robot: Any) -> float:
    names = [robot.numeric(i).name for i in range(robot.nnumeric)]
    return float(robot.numeric(LOAD).data[0]) if LOAD in names else 0.0


def _home(robot: Any) -> Vector:
    """Return the positions of the first keyframe, or those of reference."""
    return np.array(robot.key_qpos[0] if robot.nkey else robot.qpos0, float)
