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
    from nav_msgs.msg import OccupancyGrid
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from std_msgs.msg import String

    rclpy.init()
    node = rclpy.create_node("operator", namespace="/rov")
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.events, node.grids = [], []
    node.create_subscription(String, "coral/events", lambda m: node.events.append(json.loads(m.data)), 100)
    node.create_subscription(OccupancyGrid, "coral/map", node.grids.append, latched)
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


def sail(*words):
    return [sys.executable, *SAIL, "--vehicle", "ros2:/rov", *words]


@contextmanager
def started(command):
    """Start a survey; it is gone at the end, whatever the test found."""
    process = subprocess.Popen(command, stdin=subprocess.PIPE)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def test_a_survey_by_topics_alone_begins_and_ends_by_service(tmp_path):
    words = ["--out", str(tmp_path / "run"), "--no-preflight", "--cfg.record.no-report", "--sonar", "ros2:/rov/ranges"]
    with vehicle(), operator() as node, started(sail(*words)) as process:
        call(node, "start")
        spin(node, lambda: any(event["event"] == "goal" for event in node.events), 60.0)
        spin(node, lambda: node.grids and {0, 100} <= set(node.grids[-1].data), 60.0)
        call(node, "stop")
        assert process.wait(60.0) == 0
    metrics = json.loads((tmp_path / "run/metrics.json").read_text())
    assert metrics["end_reason"] == "stopped by the operator (ROS 2)"
    assert metrics["collisions"] == 0
    assert node.grids[-1].info.resolution == pytest.approx(MapCfg().cell_m)


def checked():
    return subprocess.run(sail("--check"), capture_output=True, text=True, timeout=300.0)


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
