"""Records topics as MCAP as `ros2 bag record` does, which no wheel brings: serialized messages with the time they came.

Usage: python recorder_node.py FOLDER TOPIC=PACKAGE/msg/TYPE ...; SIGTERM ends it.
"""

import contextlib
import sys
import time
from importlib import import_module

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.qos import qos_profile_sensor_data
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore


def main():
    folder, *topics = sys.argv[1:]
    rclpy.init()
    node, store = rclpy.create_node("recorder"), get_typestore(Stores.ROS2_HUMBLE)
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        for topic, name in (words.split("=") for words in topics):
            package, _, kind = name.split("/")
            connection = writer.add_connection(topic, name, typestore=store)

            def keep(message, connection=connection):
                writer.write(connection, time.time_ns(), message)

            node.create_subscription(
                getattr(import_module(f"{package}.msg"), kind), topic, keep, qos_profile_sensor_data, raw=True
            )
        print("ready", flush=True)
        with contextlib.suppress(ExternalShutdownException):
            rclpy.spin(node)


if __name__ == "__main__":
    main()
