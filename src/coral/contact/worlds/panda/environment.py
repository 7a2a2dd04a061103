"""A robosuite environment: a Franka Panda behind the task's table, stepped by robosuite's own loop.

robosuite composes the robot (arm, gripper, mount) and runs the physics. An XML processor adds the scene, and a callback
in `_pre_action` sets the arm's torques at every physics step.
"""

from __future__ import annotations

import logging
from collections import OrderedDict
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np

from coral.config import whole_steps
from coral.contact.control.hand_model import MAX_OPENING_M
from coral.contact.scene.mujoco_scene import FINGER_FRICTION, FINGER_PRIORITY, ROLLING, TORSION
from coral.contact.worlds.panda.names import FLOOR, JOINTS, PAD_GEOMS
from coral.errors import RunError

_LOGGER = logging.getLogger(__name__)
MISSING = (
    "the Panda world needs robosuite: `make setup` installs it; elsewhere `pip install -e '.[contact]'` and "
    "then `pip install --no-deps robosuite==1.5.2` (its own requirements would replace numpy and OpenCV)"
)
MOUNT_HEIGHT_M = 0.912  # from the floor to the arm's foot, on robosuite's pedestal
BASE_M = (-0.5, 0.0, 0.0)
"""Foot of the arm (link 0), world frame. Chosen by a study of inverse kinematics, which is kept as a test."""
START_RAD = (0.0, -0.1, 0.0, -2.35, 0.0, 2.25, np.pi / 4)
"""Joints at reset: hand pointing down over the near half of the table, elbow up, mid-range."""
MOTOR_INERTIA_KG_M2 = 0.1
"""Inertia of rotor and gear at each joint; robosuite has 5 to 0.7."""
LINK_INERTIA_FACTOR = 0.1
"""Scales robosuite's rotational inertias of links and hand, which would fit bodies three times as long (0.3 kg m^2
for a link of 3 kg)."""
PHYSICS_DT_S = 0.002
"""Physics step; robosuite's 2 ms keep a stiff grasp stable."""


def _robosuite() -> Any:
    logging.disable(logging.WARNING)  # it warns about unused macros, models and a controller
    try:
        import robosuite
        from robosuite.environments.manipulation.manipulation_env import ManipulationEnv
        from robosuite.models.arenas import EmptyArena
        from robosuite.models.tasks import ManipulationTask
    except ImportError as error:
        raise RunError(f"{MISSING} ({error})") from None
    finally:
        logging.disable(logging.NOTSET)
    logging.getLogger("robosuite_logs").setLevel(logging.ERROR)
    return robosuite, ManipulationEnv, EmptyArena, ManipulationTask


def make_environment(
    add_scene: Callable[[mujoco.MjSpec], None],
    control_period_s: float,
    before_physics_step: Callable[[Any], None],
) -> Any:
    """Make a robosuite environment with the Panda and our scene.

    `add_scene` adds table, fixtures and objects to a model in world coordinates. `before_physics_step` is called with
    the action at every physics step once positions and velocities are known (`mj_step1`); it writes `data.ctrl`.

    Raises:
        InputError: The control period is not a whole number of physics steps.
        RunError: robosuite is not installed.
    """
    whole_steps(control_period_s, PHYSICS_DT_S, "panda", "physics_step_s")
    _, manipulation_env, empty_arena, manipulation_task = _robosuite()

    class PandaAtTable(manipulation_env):  # type: ignore[misc, valid-type]
        """The Panda in front of a table; no reward, cameras or observables: the world reads the state itself."""

        def _load_model(self) -> None:
            super()._load_model()
            floor = BASE_M[2] - MOUNT_HEIGHT_M
            self.robots[0].robot_model.set_base_xpos([BASE_M[0], BASE_M[1], floor])
            self.robots[0].init_qpos = np.array(START_RAD)
            arena = empty_arena()
            arena.set_origin([0.0, 0.0, floor])
            self.model = manipulation_task(
                mujoco_arena=arena, mujoco_robots=[robot.robot_model for robot in self.robots], mujoco_objects=[]
            )
            self.set_xml_processor(_processor(add_scene))

        def initialize_time(self, control_freq: float) -> None:
            super().initialize_time(control_freq)
            self.model_timestep = PHYSICS_DT_S
            self.control_timestep = control_period_s * (1.0 + 1e-9)  # robosuite truncates the ratio to an integer

        def _setup_observables(self) -> OrderedDict[str, Any]:
            return OrderedDict()

        def _pre_action(self, action: Any, policy_step: bool = False) -> None:
            before_physics_step(action)

        def reward(self, action: Any = None) -> float:
            return 0.0

        def _check_success(self) -> bool:
            return False

    mujoco.set_mju_user_warning(_LOGGER.debug)  # MuJoCo would write a file into the working directory
    logging.disable(logging.WARNING)
    try:
        return PandaAtTable(
            robots="Panda",
            initialization_noise=None,
            use_camera_obs=False,
            has_renderer=False,
            has_offscreen_renderer=False,
            control_freq=1.0 / control_period_s,
            ignore_done=True,
            hard_reset=False,
            seed=0,
        )
    finally:
        logging.disable(logging.NOTSET)


def _processor(add_scene: Callable[[mujoco.MjSpec], None]) -> Callable[[str], str]:
    def process(xml: str) -> str:
        spec = mujoco.MjSpec.from_string(xml)
        spec.option.timestep = PHYSICS_DT_S
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        spec.option.impratio = 10
        spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)  # a reset would hide a divergence
        for marker in ("left_eef_target", "right_eef_target"):
            spec.delete(spec.body(marker))
        for geom in spec.geoms:
            if geom.name.startswith("wall_"):  # the room's walls; cameras would see them
                spec.delete(geom)
        spec.geom("floor").name = FLOOR
        for name in JOINTS:
            spec.joint(name).armature = MOTOR_INERTIA_KG_M2
        for body in spec.bodies:
            if body.name.startswith(("robot0_", "gripper0_")):
                body.inertia = body.inertia * LINK_INERTIA_FACTOR
        for name in PAD_GEOMS:
            pad = spec.geom(name)
            pad.priority, pad.friction = FINGER_PRIORITY, [FINGER_FRICTION, TORSION, ROLLING]
            pad.solref = [0.01, 1.0]
        for finger in spec.actuators:
            if "finger" in finger.name:  # squeezing: commanded further than closed
                finger.ctrlrange = [-MAX_OPENING_M / 2, MAX_OPENING_M / 2]
        add_scene(spec)
        spec.compile()
        return str(spec.to_xml())

    return process
