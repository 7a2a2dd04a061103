"""A vehicle in a process of its own: our dynamics and painted pictures behind topics, and nothing of the truth.

Usage: python vehicle_node.py WORLD NAMESPACE [--stamps-off S [--clock]]. SIGTERM: it tells what it has truly seen and
touched. Its stamps are behind ours by S seconds; --clock publishes the clock that they are of.
"""

import argparse
import array
import json
import math
import signal
import sys
import tempfile
import threading
from pathlib import Path

import numpy as np
import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.signals import SignalHandlerOptions
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import BatteryState, CameraInfo, Image, PointCloud2, PointField

from coral.reef.map.sonar_3d15 import Sonar3d15, SonarCfg, sonar_attitude
from coral.reef.rehearsal.simulated_link import SimulatedLink
from coral.reef.rehearsal.simulated_sensors import simulated_camera
from coral.reef.sea.survey_file import SurveyArea
from coral.reef.simulation.simulator import SimulatorCfg
from coral.reef.simulation.stills import make_painter
from coral.reef.vehicle.collision import clearance
from coral.reef.world.find_world import find_world
from coral.reef.world.scene import Scene

sys.path.insert(0, str(Path(__file__).parents[2]))
from autopilot.camera import Judge


def main():
    flags = argparse.ArgumentParser()
    flags.add_argument("world")
    flags.add_argument("namespace")
    flags.add_argument("--stamps-off", type=float, default=0.0)
    flags.add_argument("--clock", action="store_true")
    told = flags.parse_args()
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    ended = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: ended.set())
    node = rclpy.create_node("vehicle", namespace=told.namespace)
    world, cfg = find_world(told.world), SimulatorCfg()
    scene = Scene.from_world(world)
    outlines = scene.footprints()
    link = SimulatedLink(
        cfg.vehicle, SurveyArea.of_world(world).start, depth_m=1.0, contact=lambda x, y: clearance(outlines, x, y)
    )
    painter = make_painter(scene, cfg.camera, cfg.picture_water(), cfg.painter, world.seed)
    camera = simulated_camera(scene, cfg.camera, lambda: (0.0, link.true_pose()), painter=painter, sleep=lambda s: None)
    odom, battery = node.create_publisher(Odometry, "odom", 1), node.create_publisher(BatteryState, "battery", 1)
    image, info = (
        node.create_publisher(Image, "camera/image_raw", 1),
        node.create_publisher(CameraInfo, "camera/camera_info", 1),
    )
    ranges = node.create_publisher(PointCloud2, "ranges", 1)
    sonar = Sonar3d15(scene.resting, SonarCfg(), np.random.default_rng(0))
    mount = sonar_attitude(0.0, 0.0, 0.0, sonar.cfg.pitch_down_deg)
    fields = [PointField(name=name, offset=4 * k, datatype=7, count=1) for k, name in enumerate("xyz")]
    judge = Judge(world, cfg, Path(tempfile.mkdtemp()))
    link.arm()

    def hear(twist):
        link.command(twist.linear.x, twist.angular.z, 1.0)

    def stamp():
        now = node.get_clock().now()
        return (now - rclpy.duration.Duration(seconds=told.stamps_off)).to_msg()

    def navigate():
        report = link.report()
        message = Odometry()
        message.header.stamp, message.header.frame_id, message.child_frame_id = stamp(), "odom", "base_link"
        at, way = message.pose.pose, message.twist.twist
        at.position.x, at.position.y, at.position.z = report.pose.x, report.pose.y, -report.depth_m
        at.orientation.z, at.orientation.w = math.sin(report.pose.theta / 2), math.cos(report.pose.theta / 2)
        way.linear.x, way.linear.y, way.angular.z = map(float, report.velocity)
        odom.publish(message)
        battery.publish(BatteryState(voltage=report.battery_v, percentage=report.battery_fraction))

    def photograph():
        judge.follow(link.true_pose())
        rgb = camera.read().frame.rgb
        height, width = rgb.shape[:2]
        message = Image(
            height=height, width=width, step=3 * width, encoding="rgb8", data=array.array("B", rgb.tobytes())
        )
        message.header.stamp = stamp()
        image.publish(message)
        focal = 0.5 * width / math.tan(math.radians(cfg.camera.hfov_deg) / 2)
        k = [focal, 0.0, width / 2, 0.0, focal, height / 2, 0.0, 0.0, 1.0]
        info.publish(CameraInfo(height=height, width=width, k=k))

    def listen():
        image = sonar.image(link.true_pose(), cfg.camera.altitude_m)
        heard = np.isfinite(image.ranges)
        points = (image.directions()[heard] * image.ranges[heard][:, None] @ mount.T).astype("<f4")
        message = PointCloud2(height=1, width=len(points), point_step=12, row_step=12 * len(points), fields=fields)
        message.header.stamp, message.header.frame_id = stamp(), "base_link"
        message.data = array.array("B", points.tobytes())
        ranges.publish(message)

    node.create_subscription(Twist, "cmd_vel", hear, 1)
    node.create_timer(0.2, listen)
    node.create_timer(0.05, navigate)
    node.create_timer(0.1, photograph)
    if told.clock:
        clock = node.create_publisher(Clock, "/clock", 1)
        node.create_timer(0.02, lambda: clock.publish(Clock(clock=stamp())))
    print("ready", flush=True)
    while not ended.is_set():
        rclpy.spin_once(node, timeout_sec=0.2)
    print(json.dumps(judge.verdict()), flush=True)


if __name__ == "__main__":
    main()
