"""Copies of bags with something changed."""

from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore


def copy_bag(source, path, change):
    """Copy a bag; `change(topic, seconds, message)` returns a message in place of each, or None to leave it out."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    with (
        AnyReader([source], default_typestore=store) as reader,
        Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer,
    ):
        added = {
            one.topic: writer.add_connection(one.topic, one.msgtype, typestore=store) for one in reader.connections
        }
        for connection, t, raw in reader.messages():
            message = change(connection.topic, t * 1e-9, reader.deserialize(raw, connection.msgtype))
            if message is not None:
                writer.write(added[connection.topic], t, store.serialize_cdr(message, connection.msgtype))
    return path
