"""Parsers of binary files, datagrams and requests, with an example of each, for `fuzz_parsers.py`."""

from __future__ import annotations

import asyncio
import io
import json
import sqlite3
import struct
import tempfile
from collections.abc import Callable, Hashable
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from coral.errors import InputError

Given = tuple[Callable[[Path], object], tuple[bytes, ...], tuple[type[Exception], ...], str]
"""A reader of a file, valid examples, documented exceptions, the suffix of the file."""
KEPT = 60_000
"""Bytes of the large examples."""


class Line:
    """A line to a vehicle on which one piece of bytes comes."""

    sender: Hashable = None

    def __init__(self, data: bytes) -> None:
        self.data = data

    def answer(self, peer: Hashable) -> None:
        """Talk to one peer."""

    def receive(self, timeout_s: float) -> bytes:
        """Return what came."""
        data, self.data = self.data, b""
        return data

    def send(self, data: bytes) -> None:
        """Drop it."""

    def close(self) -> None:
        """Nothing is open."""


def binary_parsers(home: Path) -> dict[str, Given]:
    """Return the parsers by name.

    Args:
        home: Folder of the package.
    """
    from coral.contact.franka.object_poses import parse_poses
    from coral.contact.libero.object_model import read_model
    from coral.contact.memory.memory import Memory
    from coral.contact.real_scenes.masks.colour_masks import make_colour_masks
    from coral.foreign_file import decode_picture, read_arrays, read_log_lines
    from coral.onnx_file import open_onnx
    from coral.reef.map.belief import BeliefCfg
    from coral.reef.map.mapping import MapCfg
    from coral.reef.recordings.autopilot_log import read_log
    from coral.reef.sea.saved_survey import load_survey
    from coral.reef.vehicle.camera import CameraCfg
    from coral.run_files import SurveyFiles

    refused = (InputError,)
    event = b'{"step": 0, "t": 1.0, "event": "decision", "goal": [1.0, 2.0]}\n' * 20
    colour = np.random.default_rng(0).integers(0, 255, (24, 32, 3), np.uint8)
    pictures = tuple(cv2.imencode(form, colour)[1].tobytes() for form in (".png", ".jpg", ".webp", ".tiff", ".bmp"))
    pose = {"position": [0.1, 0.2, 0.3], "quaternion": [1, 0, 0, 0]}
    poses = json.dumps({"objects": {"box": pose, "lid": pose | {"in": "tool"}}}).encode()

    def saved(path: Path) -> object:
        (path.parent / SurveyFiles.SAVED).write_bytes(path.read_bytes())
        return load_survey(path.parent, (3.0, 3.0), CameraCfg(), MapCfg(), BeliefCfg())

    def remembered(path: Path) -> object:
        return Memory(path).all()

    return {
        "log": (lambda path: list(read_log_lines(path)), (event,), refused, ".jsonl"),
        "arrays": (read_arrays, (an_archive(),), (ValueError,), ".npz"),
        "saved survey": (saved, (a_survey(),), refused, ".npz"),
        "picture": (lambda path: decode_picture(path.read_bytes()), pictures, (ValueError,), ""),
        "network": (open_onnx, ((home / "reef/eyes/weights/reef_net.onnx").read_bytes()[:KEPT],), refused, ".onnx"),
        "memory": (remembered, (a_memory(),), refused, ".sqlite"),
        "colours": (lambda path: make_colour_masks(str(path), None, {}), (COLOURS,), refused, ".yaml"),
        "object model": (read_model, (MODEL,), refused, ".xml"),
        "poses of a tracker": (lambda path: parse_poses(path.read_bytes()), (poses,), (), ""),
        "MAVLink": (vehicle_link, (heartbeats(),), (), ""),
        "telemetry log": (read_log, (b"".join(bytes(8) + frame for frame in frames_of_a_vehicle()),), refused, ".tlog"),
        "dataflash log": (read_log, (a_dataflash_log(),), refused, ".BIN"),
        "request": (request, (b'{"answer": {"index": 3}, "operator": "Ann"}',), (web_error(),), ""),
        "headers": (headers, (HEAD,), (), ""),
        **bag_parsers(refused),
    }  # fmt: skip


COLOURS = b"objects:\n  box: {hue_deg: [0, 20], saturation: [0.4, 1.0], value: [0.2, 1.0]}\n"
HEAD = b"GET /?token=abc HTTP/1.1\r\nHost: 127.0.0.1:8765\r\nCookie: coral_8765=x\r\n"
MODEL = b"""<mujoco><worldbody><body><body name="object">
<geom type="box" size="0.1 0.1 0.1" pos="0 0 0" quat="1 0 0 0" density="100" group="0"/>
</body></body></worldbody></mujoco>
"""


def an_archive() -> bytes:
    """Make an .npz file."""
    out = io.BytesIO()
    np.savez_compressed(out, a=np.arange(60, dtype=np.uint16).reshape(6, 10), b=np.ones((3, 2), order="F"))
    return out.getvalue()


def a_survey() -> bytes:
    """Make a small saved survey."""
    from coral.reef.map.belief import Belief
    from coral.reef.map.landmark_map import LandmarkMap
    from coral.reef.map.landmarks import Sighting
    from coral.reef.map.mapping import OccupancyMap
    from coral.reef.sea.saved_survey import save_survey
    from coral.reef.vehicle.camera import CameraCfg
    from coral.reef.world.geometry import Pose
    from coral.run_files import SurveyFiles

    with tempfile.TemporaryDirectory() as folder:
        seen = LandmarkMap().extended(Sighting(-0.1, 0.1, 1.0, 0.2), Pose(1.0, 1.0, 0.0), 1.0)
        save_survey(Path(folder), Belief(OccupancyMap((3.0, 3.0), CameraCfg())), seen)
        return (Path(folder) / SurveyFiles.SAVED).read_bytes()


def a_memory() -> bytes:
    """Make an SQLite file with the tables of a memory."""
    from coral.contact.memory.memory import Memory

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "m.sqlite"
        memory = Memory(path)
        memory.store.insert("2026-01-01T00:00:00+00:00", "{}")
        with sqlite3.connect(path) as base:
            base.execute("PRAGMA wal_checkpoint")
        base.close()
        return path.read_bytes()


def a_dataflash_log() -> bytes:
    """Make a .BIN with a few poses."""
    out = b""
    for kind, size, name, codes, columns in (
        (76, 19, b"XKF1", b"Qff", b"TimeUS,PN,PE"), (100, 17, b"ATT", b"Qccc", b"TimeUS,Roll,Pitch,Yaw"),
    ):  # fmt: skip
        out += struct.pack("<2sBBB4s16s64s", b"\xa3\x95", 128, kind, size, name, codes, columns)
    for t in range(100_000, 900_000, 100_000):
        out += struct.pack("<2sBQff", b"\xa3\x95", 76, t, 1.0, 2.0) + struct.pack(
            "<2sBQ3h", b"\xa3\x95", 100, t, 1, 2, 3
        )
    return out


def heartbeats() -> bytes:
    """Make the bytes of a vehicle."""
    return b"".join(frames_of_a_vehicle())


def frames_of_a_vehicle() -> list[bytes]:
    """Make the frames of a vehicle."""
    from coral.reef.sea.ardusub import load_dialect

    dialect = load_dialect()
    out = dialect.MAVLink(None, 1, 1)
    frames = (
        dialect.MAVLink_heartbeat_message(12, 3, 0, 0, 4, 3),
        dialect.MAVLink_attitude_message(1000, 0.0, 0.1, 0.2, 0.0, 0.0, 0.0),
        dialect.MAVLink_local_position_ned_message(1000, 1.0, 2.0, 0.5, 0.1, 0.0, 0.0),
        dialect.MAVLink_statustext_message(6, b"ArduSub V4.5.7"),
    )
    return [frame.pack(out) for frame in frames]


def vehicle_link(path: Path) -> object:
    """Let a link hear what is in a file."""
    from coral.reef.sea.mavlink_link import MavlinkLink

    link = MavlinkLink(Line(path.read_bytes()), clock=lambda: 1.0, threaded=False)
    for _ in range(3):
        link.poll()
    return link.report()


def web_error() -> type[Exception]:
    """Return the exception that ends a request with a reason."""
    from starlette.exceptions import HTTPException

    return HTTPException


def request(path: Path) -> object:
    """Read the body of a request."""
    from starlette.requests import Request

    from coral.web import read_json

    async def receive() -> Any:
        return {"type": "http.request", "body": path.read_bytes(), "more_body": False}

    scope = {"type": "http", "method": "POST", "path": "/", "headers": [
        (b"x-coral", b"1"), (b"content-type", b"application/json")]}  # fmt: skip
    return asyncio.run(read_json(Request(scope, receive)))


def headers(path: Path) -> object:
    """Ask whether a request with some headers may continue."""
    from coral.access import Access

    first, *lines = path.read_bytes().decode("latin-1").split("\r\n")
    given = dict(line.partition(": ")[::2] for line in lines)
    target = [*first.split(" "), ""][1]
    return Access("127.0.0.1", 8765, "x" * 20).refuse_or_redirect(first.partition(" ")[0], target, given)


def bag_parsers(refused: tuple[type[Exception], ...]) -> dict[str, Given]:
    """Return the parsers of bags, if rosbags is installed."""
    try:
        from rosbags.rosbag1 import Writer as Writer1
        from rosbags.rosbag2 import StoragePlugin, Writer
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        return {}
    from coral.ros.bag_reader import Bag

    def read(path: Path) -> object:
        bag = Bag(path)
        bag.count_messages()
        return list(bag.read_messages({"/odometry"}))

    def folder(path: Path) -> object:
        inside = path.parent / "bag"
        inside.mkdir(exist_ok=True)
        (inside / "x_0.db3").write_bytes(path.read_bytes())
        return read(inside)

    store2, store1 = get_typestore(Stores.ROS2_HUMBLE), get_typestore(Stores.ROS1_NOETIC)
    made = {}
    with tempfile.TemporaryDirectory() as place:
        for name, plugin in (("mcap", StoragePlugin.MCAP), ("db3", StoragePlugin.SQLITE3)):
            with Writer(Path(place) / name, version=9, storage_plugin=plugin) as writer:
                topic = writer.add_connection("/odometry", "std_msgs/msg/String", typestore=store2)
                message = store2.types["std_msgs/msg/String"](data="a" * 50)
                for k in range(3):
                    writer.write(topic, k, store2.serialize_cdr(message, "std_msgs/msg/String"))
            made[name] = next((Path(place) / name).glob(f"*.{name}")).read_bytes()
        with Writer1(Path(place) / "x.bag") as writer1:
            one = writer1.add_connection("/odometry", "std_msgs/msg/String", typestore=store1)
            word = store1.types["std_msgs/msg/String"](data="a" * 50)
            for k in range(3):
                writer1.write(one, k, store1.serialize_ros1(word, "std_msgs/msg/String"))
        made["bag"] = (Path(place) / "x.bag").read_bytes()
    return {
        "MCAP": (read, (made["mcap"],), refused, ".mcap"),
        "ROS 2 bag": (folder, (made["db3"],), refused, ".db3"),
        "ROS 1 bag": (read, (made["bag"],), refused, ".bag"),
    }
