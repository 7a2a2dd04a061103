"""Records topics as MCAP as `ros2 bag record` does, which no wheel brings: serialized messages with the time they came.

Usage: python recorder_node.py FOLDER TOPIC=PACKAGE/msg/TYPE ...; SIGTERM ends it.
"""

import signal
import sys
import threading
import time
from importlib import import_module

import rclpy
from rclpy.qos import qos_profile_sensor_data
from rclpy.signals import SignalHandlerOptions
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore


def main():
    folder, *topics = sys.argv[1:]
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)  # its own would leave the file without its end
    ended = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: ended.set())
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
        while not ended.is_set():
            rclpy.spin_once(node, timeout_sec=0.2)


if __name__ == "__main__":
    main()
