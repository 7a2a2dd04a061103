"""An arm over real DDS: the robot is another process, and only topics and services lie between; `make test-ros2`."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest

from contact.franka import ros_robot
from coral.contact.franka.double import cfg_for_double
from coral.contact.scene.observation import HandTarget
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.franka_cfg import FrankaCfg
from coral.contact.worlds.robot_world import WorldError

pytestmark = pytest.mark.ros2
TRIAL = sample_trial(load_task("pick-box"), 0, "pick-box")


@pytest.mark.parametrize("task", ["pick-box", "push-gently"])
def test_a_task_succeeds_by_topics_alone(task):
    found = ros_robot.attempt(task, 0)
    assert found["end_reason"] == "success"
    assert found["peak_hand_force_n"] < FrankaCfg().limits.contact_force_n


@pytest.fixture
def operator():
    """Make a node that calls services in the robot's namespace, before anything waits for it."""
    import rclpy
    from std_srvs.srv import Trigger

    rclpy.init()
    node = rclpy.create_node("operator", namespace=ros_robot.NAMESPACE)

    def call(name):
        client = node.create_client(Trigger, name)
        assert client.wait_for_service(timeout_sec=20.0)
        answer = client.call_async(Trigger.Request())
        rclpy.spin_until_future_complete(node, answer, timeout_sec=10.0)
        assert answer.result().success

    yield call
    node.destroy_node()
    rclpy.shutdown()


@pytest.fixture
def moving():
    """A world whose arm moves, the node that plays the robot, and the way on."""
    arm = cfg_for_double(replace(FrankaCfg(), poses_port=0))
    with ros_robot.world_over_ros(TRIAL, arm, 0.5) as (world, node):
        start = world.reset().tool

        ways = iter(np.minimum(0.003 * np.arange(1000), 0.3))

        def lead(steps):
            for _, way in zip(range(steps), ways, strict=False):
                place = np.add(start.position, [0.0, way, 0.0])
                world.step(HandTarget(place, start.quaternion, 0.08, 600.0))

        lead(30)
        assert np.linalg.norm(world.truth().tool.velocity) > 0.05
        yield world, node, lead


def at_rest(world):
    """Return whether the arm rests within 10 s of the machine's time."""
    for _ in range(100):
        if np.linalg.norm(world.double.truth().tool.velocity) < 0.005:
            return True
        time.sleep(0.1)
    return False


@pytest.mark.parametrize(
    ("service", "code", "told"),
    [("coral/stop", "arm-fault", "stopped by the service coral/stop"), ("cover", "poses-lost", "box was not seen")],
)
def test_a_stop_by_service_and_lost_poses_end_the_motion(operator, moving, service, code, told):
    world, _, lead = moving
    operator(service)
    with pytest.raises(WorldError, match=told) as caught:
        lead(200)
    assert caught.value.code == code
    assert at_rest(world)


def test_a_robot_whose_node_dies_is_a_lost_link(moving):
    world, node, lead = moving
    node.kill()
    with pytest.raises(WorldError) as caught:
        lead(200)
    assert caught.value.code == "link-lost"
    assert at_rest(world)


def test_without_the_program_the_controller_holds_the_last_equilibrium(moving):
    world, _, lead = moving
    before = world.truth().tool.position
    os.kill(world.stream.child.process.pid, signal.SIGKILL)
    with pytest.raises(WorldError, match="has ended"):
        lead(200)
    assert at_rest(world)
    assert np.linalg.norm(world.double.truth().tool.position - before) < 0.1


def test_the_command_looks_at_the_arm_and_commands_nothing(tmp_path):
    arm = cfg_for_double(FrankaCfg())
    patient = ["--cfg.franka.link-timeout-s", "6", "--cfg.franka.watchdog-s", "6", "--cfg.franka.poses-port", "0"]
    command = [sys.executable, "-m", "coral", "contact", "run", "pick-box", "--world", "franka", *patient]
    command += ["--robot", f"ros2:{ros_robot.NAMESPACE}", "--dry-run", "--out", str(tmp_path / "run")]
    with ros_robot.robot(TRIAL, arm, 0.5) as (double, _):
        before = double.truth().tool.position
        told = subprocess.run(command, capture_output=True, text=True, timeout=300.0, stdin=subprocess.DEVNULL)
        assert np.linalg.norm(double.truth().tool.position - before) < 0.01
    assert "ok   box is seen within reach" in told.stderr
    assert "(not sent)" in told.stderr
