"""What the base was placed for: grasps from above all over the table, and the pinch of an overhanging board."""

import numpy as np
import pytest
from inverse_kinematics import Reach, ReachCfg, rotation_vector, tool_rotation

from coral.contact.control.hand_model import FLANGE_TO_TOOL_M
from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.scene.geometry import from_rotvec, multiply, rotation_of

DOWN = (0.0, 0.0, -1.0)


@pytest.fixture(scope="module")
def reach(panda):
    return Reach(panda.model)


@pytest.mark.parametrize("yaw_deg", [0, 60, 120])
def test_grasps_from_above_reach_all_over_the_table(reach, yaw_deg):
    yaw = np.radians(yaw_deg)
    for x in (-0.2, 0.0, 0.2):
        for y in (-0.25, 0.25):
            found = reach.find(np.array([x, y, 0.12]), tool_rotation(DOWN, (np.sin(yaw), -np.cos(yaw), 0)))
            assert found is not None, (x, y)
            assert found.limit_margin_rad > 0.05


def test_the_pinch_of_an_overhanging_board_keeps_clear_of_the_table(panda):
    clear = Reach(panda.model, ReachCfg(clearance_m=0.015))
    across = tool_rotation((0.87, -0.5, 0.0), (0.0, 0.0, 1.0))
    found = clear.find(np.array([-0.1, 0.345, 0.006]), across, opening_m=0.06)
    assert found is not None
    assert found.limit_margin_rad > 0.3


def test_what_is_found_takes_the_pose(panda, reach):
    import mujoco

    from coral.contact.worlds.panda.names import JOINTS, SITE, TOOL_IN_SITE

    position, rotation = np.array([0.1, -0.15, 0.2]), tool_rotation((0.3, 0.0, -1.0), (0.2, -1.0, 0.0))
    found = reach.find(position, rotation)
    assert found is not None
    data = mujoco.MjData(panda.model)
    data.qpos[[panda.model.joint(name).qposadr[0] for name in JOINTS]] = found.joints
    mujoco.mj_kinematics(panda.model, data)
    np.testing.assert_allclose(data.site(SITE).xpos, position, atol=1e-3)
    turned = data.site(SITE).xmat.reshape(3, 3) @ TOOL_IN_SITE
    assert np.linalg.norm(rotation_vector(turned @ rotation.T)) < 1e-2


@pytest.mark.parametrize(
    ("position", "pointing", "opening"),
    [
        ([1.0, 0.0, 0.1], DOWN, (0, 1, 0)),  # too far
        ([0.0, 0.0, -0.03], DOWN, (0, 1, 0)),  # inside the table
        ([0.0, 0.0, 0.02], (1, 0, 0), (0, 1, 0)),  # the hand lies in the table
    ],
)
def test_what_cannot_be_reached_is_not_found(reach, position, pointing, opening):
    assert reach.find(np.array(position), tool_rotation(pointing, opening)) is None


def test_nothing_is_reachable_beyond_where_the_planner_leads_the_wrist(panda, reach):
    cfg, rng = ControllerCfg(), np.random.default_rng(0)
    assert panda.data.body("robot0_link2").xpos == pytest.approx(cfg.shoulder_m, abs=1e-6)
    beyond = []
    while len(beyond) < 6:
        place = rng.uniform(cfg.workspace_low_m, cfg.workspace_high_m)
        turn = rotation_of(multiply([0.0, 1.0, 0.0, 0.0], from_rotvec(0.4 * rng.normal(size=3))))
        if np.linalg.norm(place - FLANGE_TO_TOOL_M * turn[:, 2] - cfg.shoulder_m) > cfg.reach_m:
            beyond.append(reach.find(place, turn))
    assert beyond == [None] * 6
