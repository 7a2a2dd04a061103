"""A vehicle in a process of its own: our dynamics and painted pictures behind topics, and nothing of the truth.

Usage: python vehicle_node.py WORLD NAMESPACE [--stamps-off S]
"""

import argparse
import array
import math

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import BatteryState, CameraInfo, Image

from coral.reef.rehearsal.simulated_camera import SimulatedCamera
from coral.reef.rehearsal.simulated_link import SimulatedLink
from coral.reef.sea.survey_file import SurveyArea
from coral.reef.simulation.frame_painter import make_painter
from coral.reef.simulation.simulator import SimulatorCfg
from coral.reef.vehicle.collision import clearance
from coral.reef.world.generated import find_world
from coral.reef.world.scene import Scene


def main():
    flags = argparse.ArgumentParser()
    flags.add_argument("world")
    flags.add_argument("namespace")
    flags.add_argument("--stamps-off", type=float, default=0.0)
    told = flags.parse_args()
    rclpy.init()
    node = rclpy.create_node("vehicle", namespace=told.namespace)
    world, cfg = find_world(told.world), SimulatorCfg()
    scene = Scene.from_world(world)
    outlines = scene.footprints()
    link = SimulatedLink(
        cfg.vehicle, SurveyArea.of_world(world).start, depth_m=1.0, contact=lambda x, y: clearance(outlines, x, y)
    )
    painter = make_painter(scene, cfg.camera, cfg.picture_water(), cfg.painter, world.seed)
    camera = SimulatedCamera(scene, cfg.camera, lambda: (0.0, link.true_pose()), painter=painter, sleep=lambda s: None)
    odom, battery = node.create_publisher(Odometry, "odom", 1), node.create_publisher(BatteryState, "battery", 1)
    image, info = (
        node.create_publisher(Image, "camera/image_raw", 1),
        node.create_publisher(CameraInfo, "camera/camera_info", 1),
    )
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

    node.create_subscription(Twist, "cmd_vel", hear, 1)
    node.create_timer(0.05, navigate)
    node.create_timer(0.1, photograph)
    print("ready", flush=True)
    rclpy.spin(node)


if __name__ == "__main__":
    main()
