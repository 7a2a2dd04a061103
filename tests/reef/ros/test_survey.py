"""A survey over real DDS: the vehicle is another process, the operator a node, and only topics lie between them."""

import json
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

from coral.reef.map.mapping import MapCfg

pytestmark = pytest.mark.ros2
SAIL = ["-m", "coral", "reef", "sail", "s1", "--camera", "ros2:/rov/camera/image_raw", "--perception", "painted"]


@contextmanager
def vehicle(*words):
    """Start a vehicle in a process of its own."""
    command = [sys.executable, str(Path(__file__).with_name("vehicle_node.py")), "s1", "/rov", *words]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == "ready\n"
        yield process
    finally:
        process.kill()
        process.wait()


@contextmanager
def operator():
    """Make a node that hears the survey's topics and calls its services."""
    import rclpy
    from geometry_msgs.msg import PoseStamped
    from nav_msgs.msg import OccupancyGrid
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from std_msgs.msg import String

    rclpy.init()
    node = rclpy.create_node("operator", namespace="/rov")
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.events, node.grids, node.goals = [], [], []
    node.create_subscription(String, "coral/events", lambda m: node.events.append(json.loads(m.data)), 100)
    node.create_subscription(OccupancyGrid, "coral/map", node.grids.append, latched)
    node.create_subscription(PoseStamped, "coral/goal", node.goals.append, latched)
    try:
        yield node
    finally:
        node.destroy_node()
        rclpy.shutdown()


def call(node, name):
    """Call a service of the survey as soon as it is there."""
    import rclpy
    from std_srvs.srv import Trigger

    client = node.create_client(Trigger, f"coral/{name}")
    assert client.wait_for_service(timeout_sec=240.0)
    answer = client.call_async(Trigger.Request())
    rclpy.spin_until_future_complete(node, answer, timeout_sec=10.0)
    assert answer.result().success


def spin(node, until, timeout_s):
    """Take in messages until something holds."""
    import rclpy

    end = time.monotonic() + timeout_s
    while not until():
        assert time.monotonic() < end
        rclpy.spin_once(node, timeout_sec=0.1)


def sail(*words, place="/rov"):
    return [sys.executable, *SAIL, "--vehicle", f"ros2:{place}", *words]


@contextmanager
def started(command):
    """Start a survey; it is gone at the end, whatever the test found."""
    process = subprocess.Popen(command, stdin=subprocess.PIPE)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.mark.parametrize(
    ("word", "reason"),
    [("stop", "stopped by the operator (ROS 2)"), ("home", "back at the start: the operator's word (ROS 2)")],
)
def test_a_survey_by_topics_alone_begins_and_ends_by_service(tmp_path, word, reason):
    words = ["--out", str(tmp_path / "run"), "--no-preflight", "--cfg.record.no-report", "--sonar", "ros2:/rov/ranges"]
    with vehicle(), operator() as node, started(sail(*words)) as process:
        call(node, "start")
        spin(node, lambda: any(event["event"] == "goal" for event in node.events), 60.0)
        spin(node, lambda: node.grids and {0, 100} <= set(node.grids[-1].data), 60.0)
        spin(node, lambda: any(goal.header.frame_id == "map" for goal in node.goals), 60.0)
        call(node, word)
        assert process.wait(120.0) == 0
    metrics = json.loads((tmp_path / "run/metrics.json").read_text())
    assert metrics["end_reason"] == reason
    assert metrics["collisions"] is None  # nobody here knows the truth
    assert node.grids[-1].info.resolution == pytest.approx(MapCfg().cell_m)


TOPICS = {
    "image": ("/rov/camera/image_raw", "sensor_msgs/msg/Image"),
    "camera-info": ("/rov/camera/camera_info", "sensor_msgs/msg/CameraInfo"),
    "odometry": ("/rov/odom", "nav_msgs/msg/Odometry"),
}


@contextmanager
def recorder(folder):
    """Record the vehicle's topics as MCAP."""
    told = (f"{topic}={kind}" for topic, kind in TOPICS.values())
    command = [sys.executable, str(Path(__file__).with_name("recorder_node.py")), str(folder), *told]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == "ready\n"
        yield
    finally:
        process.terminate()
        process.wait(30.0)


def made(command, *words):
    """Run a command of the reef; return its numbers."""
    told = subprocess.run(
        [sys.executable, "-m", "coral", "reef", command, *map(str, words), "--json"], check=True, capture_output=True
    )
    return json.loads(told.stdout)


def test_a_survey_recorded_as_mcap_is_mapped_again(tmp_path):
    run, dive, camera = tmp_path / "run", tmp_path / "dive", tmp_path / "camera.yaml"
    camera.write_text("width: 160\nheight: 120\nhfov_deg: 120\npitch_down_deg: 15\naltitude_m: 1\n")
    words = ["--out", run, "--no-preflight", "--cfg.record.no-report", "--sonar", "ros2:/rov/ranges"]
    with vehicle(), recorder(dive), operator() as node, started(sail(*words, "--cfg.time-limit-s", "90")) as process:
        call(node, "start")
        assert process.wait(240.0) == 0
    own = made("map", run, "--out", tmp_path / "own")
    topics = [word for name, (topic, _) in TOPICS.items() for word in (f"--topics.{name}", topic)]
    eyes = ("--perception", "painted", "--camera", camera)
    again = made("map", dive, *topics, *eyes, "--out", tmp_path / "again")
    assert again["clusters"] == own["clusters"] > 0
    assert again["oyster_area_m2"] == pytest.approx(own["oyster_area_m2"], rel=0.2)


def checked(*words, place="/rov"):
    return subprocess.run(sail("--check", *words, place=place), capture_output=True, text=True, timeout=300.0)


def test_nothing_arms_where_two_vehicles_tell_where_they_are():
    with vehicle(), vehicle():
        told = checked()
    assert told.returncode == 1
    assert "2 nodes publish" in told.stderr


def test_nothing_arms_on_stamps_of_another_clock():
    with vehicle("--stamps-off", "3600"):
        told = checked()
    assert told.returncode == 1
    assert "synchronise clocks" in told.stderr


def test_a_simulators_clock_holds_for_vehicle_camera_and_sonar(tmp_path):
    names = "".join(f"    {name}: /rov/{name}\n" for name in ("odom", "cmd_vel", "battery", "arm"))
    file = tmp_path / "vehicle.yaml"
    file.write_text(f"/**:\n  ros__parameters:\n    use_sim_time: true\n{names}")
    with vehicle("--stamps-off", "3600", "--clock"):
        told = checked("--sonar", "ros2:/rov/ranges", place=file)
    assert told.returncode == 0, told.stderr
    assert "lens of camera_info" in told.stderr
