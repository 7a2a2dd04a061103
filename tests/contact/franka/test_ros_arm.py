"""An arm behind ROS 2's topics, without ROS 2: what is read, what is sent, and what it takes for a reason to stop."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from arms import DOWN, START, TOOL

from coral.contact.franka import ros_arm, ros_poses, ros_topics
from coral.contact.franka.arm import ArmError
from coral.contact.scene.geometry import from_rotvec, multiply
from coral.contact.scene.observation import HandTarget
from coral.contact.worlds.franka_cfg import FrankaCfg
from coral.errors import InputError
from reef.ros.fake_ros import FakeNode, message

EQUILIBRIUM = "cartesian_impedance_controller/equilibrium_pose"
JOINTS, POSE, WRENCH = (ros_topics.ROWS[part][0] for part in ("joint_states", "current_pose", "wrench"))
NAMES = [f"fr3_joint{k}" for k in range(1, 8)]


def posed(position, quaternion=(1.0, 0.0, 0.0, 0.0)):
    x, y, z = position
    w, i, j, k = quaternion
    return {"position": {"x": x, "y": y, "z": z}, "orientation": {"x": i, "y": j, "z": k, "w": w}}


def header(seconds, frame="fr3_link0"):
    return {"stamp": {"sec": int(seconds), "nanosec": round(1e9 * (seconds % 1))}, "frame_id": frame}


class Messages:
    """Types of messages: a pose that can be filled in, and plain values."""

    def __new__(cls, name, flag=""):
        if name.endswith("PoseStamped"):
            return lambda: message(header=header(0.0), pose=posed((0.0, 0.0, 0.0)))
        return SimpleNamespace(Request=lambda: None) if name.endswith("Trigger") else lambda **fields: message(**fields)


class Robot(FakeNode):
    """A node that hears a state as soon as everything is made."""

    def __init__(self):
        super().__init__()
        self.publishers = {EQUILIBRIUM: 1}
        self.asked_to_stop, self.has_stop = 0, True

    def tell(self, seconds, position=TOOL, quaternion=DOWN, speeds=(0.0,) * 7, force=0.0):
        joints = [*zip(NAMES, START, speeds, strict=True)][::-1]  # in any order
        names, places, rates = map(list, zip(*joints, strict=True))
        self.heard[JOINTS](message(header=header(seconds), name=names, position=places, velocity=rates))
        self.heard[POSE](message(header=header(seconds), pose=posed(position, quaternion)))
        zero = {"x": 0.0, "y": 0.0, "z": 0.0}
        wrench = {"force": zero | {"z": force}, "torque": zero}
        self.heard[WRENCH](message(header=header(seconds), wrench=wrench))
        fingers = ["fr3_finger_joint1", "fr3_finger_joint2"]
        self.heard["franka_gripper/joint_states"](
            message(header=header(seconds), name=fingers, position=[0.02, 0.021], velocity=[])
        )

    def create_timer(self, period_s, tick):
        super().create_timer(period_s, tick)
        self.tell(100.0)

    def create_client(self, kind, name):
        def call(request):
            self.asked_to_stop += 1

        return SimpleNamespace(service_is_ready=lambda: self.has_stop, call_async=call)

    @property
    def targets(self):
        return [m for topic, m in self.sent if topic == EQUILIBRIUM]


@pytest.fixture
def node(monkeypatch):
    for module in (ros_arm, ros_poses):
        monkeypatch.setattr(module, "ros_type", Messages)
    return Robot()


@pytest.fixture
def arm(node):
    return ros_arm.RosArm("ros2:/robot", FrankaCfg(), ("box",), node=node)


def at(target):
    place = target.pose.position
    return np.array([place.x, place.y, place.z])


def test_the_state_is_read_by_the_arms_own_clock(arm, node):
    node.tell(100.25, speeds=np.arange(7) / 10, force=4.0)
    state = arm.read()
    assert state.time_s == pytest.approx(0.25)
    assert state.joints == pytest.approx(START)
    assert state.joint_speeds == pytest.approx(np.arange(7) / 10)
    assert state.position == pytest.approx(TOOL)
    assert state.wrench == pytest.approx([0, 0, 4.0, 0, 0, 0])
    assert (state.opening_m, state.fault) == (pytest.approx(0.041), "")


def test_the_tools_speed_is_that_of_its_pose(arm, node):
    rates, moment = np.array([0.3, -0.2, 0.1, 0.2, -0.1, 0.3, 0.5]), 1e-6
    node.tell(101.0, speeds=rates)
    before, after = (ros_arm.tool_pose(START + k * moment * rates)[0] for k in (-1, 1))
    assert arm.read().twist[:3] == pytest.approx((after - before) / (2 * moment), abs=1e-3)


def test_the_tool_in_the_start_posture_is_where_the_simulated_arm_has_it():
    position, quaternion = ros_arm.tool_pose(START)
    assert position == pytest.approx(TOOL, abs=1e-3)
    assert abs(quaternion @ DOWN) == pytest.approx(1.0)


@pytest.mark.parametrize("silent", [JOINTS, POSE, WRENCH])
def test_the_clock_stands_still_when_one_part_falls_silent(arm, node, silent):
    node.heard[silent] = lambda m: None
    node.tell(103.0)
    assert arm.read().time_s == 0.0


def test_states_without_stamps_or_of_no_orientation_are_none(arm, node):
    node.tell(0.0)
    node.tell(104.0, quaternion=(0.0, 0.0, 0.0, 0.0))
    assert arm.read().time_s == 0.0


def test_a_target_is_the_equilibrium_in_the_arms_frame(arm, node):
    arm.follow(HandTarget(np.add(TOOL, [0.02, 0, 0]), DOWN, 0.08, 600.0))
    sent = node.targets[-1]
    assert at(sent) == pytest.approx(np.add(TOOL, [0.02, 0, 0]))
    assert sent.header.frame_id == "fr3_link0"
    assert abs(np.dot([getattr(sent.pose.orientation, k) for k in "wxyz"], DOWN)) == pytest.approx(1.0)


def test_a_stiffer_controller_pulls_with_the_force_that_is_wanted(node):
    node.parameter = lambda name, usual: {"stiffness_n_m": "1200", "stiffness_n_m_rad": "60"}.get(name, usual)
    arm = ros_arm.RosArm("ros2:/robot", FrankaCfg(), node=node)
    turned = multiply(from_rotvec([0.0, 0.0, 0.2]), DOWN)
    arm.follow(HandTarget(np.add(TOOL, [0.02, 0, 0]), turned, 0.08, 600.0))
    assert at(node.targets[-1]) == pytest.approx(np.add(TOOL, [0.01, 0, 0]))  # 12 N at both stiffnesses
    half = multiply(from_rotvec([0.0, 0.0, 0.1]), DOWN)
    orientation = node.targets[-1].pose.orientation
    assert abs(np.dot([orientation.w, orientation.x, orientation.y, orientation.z], half)) == pytest.approx(1.0)


def test_it_goes_straight_and_slowly_to_the_start(arm, node):
    start = ros_arm.tool_pose(START)[0]
    place = np.add(start, [0.0, 0.2, 0.1])
    node.tell(101.0, position=place)
    arm.go_to(START)
    seen = []
    for k in range(1, 200):
        if arm.arrived():
            break
        seen.append(at(node.targets[-1]))
        node.tell(101.0 + 0.02 * k, position=seen[-1])
    steps = np.linalg.norm(np.diff(seen, axis=0), axis=1)
    assert steps.max() <= 0.02 * ros_arm.START_M_S + 1e-9
    assert at(node.targets[-1]) == pytest.approx(start, abs=1e-6)
    assert len(seen) > 100


def test_an_arm_that_does_not_come_along_is_told(arm, node):
    node.tell(101.0, position=np.add(TOOL, [0.0, 0.2, 0.0]))
    arm.go_to(START)
    node.tell(102.5, position=np.add(TOOL, [0.0, 0.2, 0.0]))
    with pytest.raises(ArmError, match=r"does not follow: it is 1\d cm behind"):
        arm.arrived()


def test_the_service_stops(arm, node):
    answer = node.services["coral/stop"](None, SimpleNamespace())
    assert answer.success
    assert arm.read().fault == "stopped by the service coral/stop"
    with pytest.raises(ArmError, match="coral/stop"):
        arm.follow(HandTarget(TOOL, DOWN, 0.08, 600.0))


def test_a_stop_leaves_no_pull_and_asks_the_arms_own_service(arm, node):
    node.tell(101.0, position=np.add(TOOL, [0.0, 0.1, 0.0]))
    arm.stop()
    assert at(node.targets[-1]) == pytest.approx(np.add(TOOL, [0.0, 0.1, 0.0]))
    assert node.asked_to_stop == 1


@pytest.mark.parametrize(
    ("listeners", "senders", "told"), [(0, 1, "nobody listens to"), (1, 3, "2 other nodes may publish")]
)
def test_a_controller_that_left_and_another_that_commands_are_faults(arm, node, listeners, senders, told):
    node.subscribers, node.publishers[EQUILIBRIUM] = listeners, senders
    node.timers[0]()
    assert told in arm.read().fault


def test_an_arm_that_says_nothing_is_named_with_its_topics(node, monkeypatch):
    monkeypatch.setattr(ros_arm, "FIRST_S", 0.0)
    node.tell = lambda seconds: None
    with pytest.raises(InputError, match=rf"--robot: found ros2:/robot \(nothing on {JOINTS}, {POSE}"):
        ros_arm.RosArm("ros2:/robot", FrankaCfg(), node=node)
    assert node.closed


def test_openings_are_sent_within_the_grippers_range(arm, node):
    for opening in (0.05, 0.2, -0.04):
        arm.open_to(opening)
    assert [m.data for where, m in node.sent if where == "franka_gripper/opening"] == [0.05, 0.08, 0.0]


def test_every_topic_has_a_row():
    folder = Path(ros_arm.__file__).parent
    text = "".join((folder / f"{name}.py").read_text("utf-8") for name in ("ros_arm", "ros_poses"))
    asked = set(re.findall(r'topic\(\s*\w+, "([\w.]+)"', text)) | {*ros_arm._PARTS, "gripper_joint_states"}
    assert asked | {"-"} == set(ros_topics.ROWS)
    assert '"coral/stop"' in text
