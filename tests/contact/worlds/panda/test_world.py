"""The Panda as the planner believes it to be: a hand on a spring, whose wrist feels what it touches."""

import numpy as np
import pytest
from inverse_kinematics import tool_rotation

from coral.contact.scene.observation import HandTarget
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.panda.world import PandaWorld
from coral.contact.worlds.robot_world import WorldError


def test_it_begins_with_the_hand_above_the_table_and_the_objects_at_rest(world):
    observed = world.reset()
    assert observed.time_s == 0.0
    assert 0.2 < observed.tool.position[2] < 0.35
    assert observed.opening_m == pytest.approx(0.079, abs=1e-3)
    np.testing.assert_allclose(observed.objects["box"].position, [-0.1, 0.1, 0.03], atol=5e-4)
    assert np.linalg.norm(observed.objects["box"].velocity) < 1e-2


def test_a_reset_brings_back_the_same_episode_bit_for_bit(world):
    def episode():
        seen = [world.reset()]
        for x in np.linspace(-0.1, 0.1, 30):
            seen.append(world.step(HandTarget(np.array([x, 0.1, 0.05]), np.array([0.0, 1.0, 0.0, 0.0]), 0.0, 500.0)))
        return np.array([[*o.tool.position, *o.tool.quaternion, *o.wrench, *o.objects["box"].position] for o in seen])

    first = episode()
    np.testing.assert_array_equal(episode(), first)


@pytest.mark.parametrize(
    ("position", "pointing", "opening"),
    [
        ([0.1, 0.2, 0.15], (0, 0, -1), (0, -1, 0)),
        ([-0.1, -0.2, 0.25], (0, 0, -1), (1, -1, 0)),
        ([-0.1, 0.35, 0.15], (0.87, -0.5, 0), (0, 0, 1)),
    ],
)
def test_the_hand_comes_to_rest_within_5_mm_of_its_target(go, position, pointing, opening):
    import mujoco

    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, tool_rotation(pointing, opening).ravel())
    tool = go(position, 110, quaternion=quaternion).tool
    assert np.linalg.norm(tool.position - position) < 5e-3
    assert abs(tool.quaternion @ quaternion) > np.cos(0.02)
    assert np.linalg.norm(tool.velocity) < 5e-3


def test_a_hand_that_moves_freely_feels_nothing(world, go):
    forces = [np.linalg.norm(go([0.05, 0.2, 0.15], 1).wrench[:3]) for _ in range(40)]
    assert max(forces) < 0.1


@pytest.mark.parametrize("stiffness", [200.0, 800.0])
def test_pressing_with_a_spring_gives_stiffness_times_displacement(world, go, stiffness):
    over = np.array([0.1, -0.1, 0.13])
    go(over, 60, opening=0.0)
    for depth in (0.01, 0.03):
        target = np.array([0.1, -0.1, 0.1 - depth])
        observed = go(target, 60, opening=0.0, stiffness=stiffness)
        wanted = stiffness * (observed.tool.position[2] - target[2])
        assert observed.wrench[2] == pytest.approx(wanted, rel=0.1, abs=0.3)
        (on_block,) = (
            sum(c.force[2] for c in world.truth().contacts if c.first == "block" and c.second in ("left", "right")),
        )
        assert on_block == pytest.approx(wanted, rel=0.1, abs=0.3)  # the block pushes the fingers up


def test_a_force_fed_forward_arrives_at_what_the_hand_touches(go):
    go([0.1, -0.1, 0.13], 60, opening=0.0)
    rest = go([0.1, -0.1, 0.1], 60, opening=0.0, stiffness=300.0)
    pressed = go([0.1, -0.1, 0.1], 60, opening=0.0, stiffness=300.0, force=(0, 0, -8.0))
    assert pressed.wrench[2] - rest.wrench[2] == pytest.approx(8.0, rel=0.1)


def test_the_gripper_holds_a_box_and_the_wrist_feels_its_weight(world, go):
    go([-0.1, 0.1, 0.12], 50)
    go([-0.1, 0.1, 0.03], 50)
    go([-0.1, 0.1, 0.03], 40, opening=0.0)
    observed = go([-0.1, 0.1, 0.18], 90, opening=0.0)
    assert observed.opening_m == pytest.approx(0.04, abs=2e-3)
    assert observed.objects["box"].position[2] > 0.15
    assert observed.wrench[2] == pytest.approx(-0.3 * 9.81, rel=0.03)
    touching = {(c.first, c.second): c for c in world.truth().contacts}
    assert set(touching) == {("box", "left"), ("box", "right")}
    # The left finger is at +y of the tool, which is -y of the world here: the box pushes it further that way.
    assert touching["box", "left"].force[1] == pytest.approx(-20.0, abs=2.0)
    assert touching["box", "right"].force[1] == pytest.approx(20.0, abs=2.0)


def test_a_target_that_is_no_number_is_refused(world):
    tool = world.reset().tool
    with pytest.raises(ValueError, match="no pose"):
        world.step(HandTarget(np.array([np.nan, 0, 0]), tool.quaternion, 0.08, 600.0))


def test_the_judge_is_told_of_the_hands_force_on_the_box(world, go):
    assert world.truth().hand_forces == {}
    go((-0.1, 0.1, 0.15), 40, opening=0.0)
    assert world.truth().hand_forces["box"].mean is None
    go((-0.1, 0.1, 0.05), 60, opening=0.0)
    pressed = world.truth().hand_forces["box"]
    assert pressed.mean[2] < -3
    assert pressed.peak >= np.linalg.norm(pressed.mean)


def test_a_lid_stays_open_on_its_hinge():
    trial = sample_trial(load_task("close-lid"), 0)
    world = PandaWorld(trial)
    lid = world.reset().objects["lid"]
    assert trial.joint_position("lid", lid) == pytest.approx(trial.objects["lid"].joint_start, abs=1e-3)
    assert np.linalg.norm(lid.velocity) < 1e-3
    world.close()


def fault_of(go, *arguments, **options):
    with pytest.raises(WorldError) as caught:
        go(*arguments, **options)
    return caught.value


def test_a_divergence_is_a_fault_and_leaves_no_file(world, go, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    world.data.qvel[world.model.body("box").dofadr[0]] = 1e12
    assert fault_of(go, [0.0, 0.0, 0.2], 5).code == "diverged"
    assert not list(tmp_path.iterdir())


def test_an_object_that_falls_over_the_edge_is_none(world, go):
    place = world.model.joint("box_free").qposadr[0]
    world.data.qpos[place : place + 3] = (0.0, 0.4, 0.1)
    observed = go([0.0, 0.0, 0.25], 60)
    assert observed.objects["box"].position[2] < -0.3


def test_a_target_out_of_reach_is_a_fault_once_the_hand_rests(go):
    fault = fault_of(go, [1.2, 0.0, 0.3], 400)
    assert fault.code == "unreachable"
    assert "1.2" in str(fault)


def test_pressing_on_something_never_counts_as_out_of_reach(go):
    go([0.1, -0.1, 0.13], 60, opening=0.0)
    observed = go([0.1, -0.1, 0.05], 150, opening=0.0)
    assert observed.wrench[2] > 20.0
