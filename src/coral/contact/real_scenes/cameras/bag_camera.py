"""A ROS 2 bag or MCAP file as a camera: colour, aligned depth and camera_info."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.contact.real_scenes.cameras.rgbd_camera import bare_frame
from coral.contact.real_scenes.cameras.undistortion import Undistortion
from coral.contact.scene.observation import Array
from coral.errors import InputError, nearest
from coral.lens import check_lens
from coral.ros.bag_reader import Bag, stamp_of
from coral.ros.camera_pictures import colours_in, lens_of, values_in

IMAGES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage")
INFO = "sensor_msgs/msg/CameraInfo"
ROLES = ("depth", "color", "info")
TOGETHER_S = 0.05
"""Colours that are older than this when depth arrives belong to another picture."""


class BagRgbdCamera:
    """Plays the pictures of a bag, one for each picture of depth.

    Topics are found by type and name: images with "depth" in their name, aligned ones first; other images with "color"
    or "rgb"; the CameraInfo beside the depth. `#depth=/TOPIC,color=/TOPIC,info=/TOPIC` names them instead. By default
    the camera's frame is the world's.

    Raises:
        InputError: It is no bag, or a topic is missing.
    """

    live = False

    def __init__(self, rest: str, T_world_camera: Array | None = None) -> None:
        file, _, asked = rest.partition("#")
        self.path, self.name = Path(file), f"bag:{rest}"
        self._placed = np.eye(4) if T_world_camera is None else T_world_camera
        if not file or not self.path.exists():
            raise InputError("--camera", "", self.name, "a ROS 2 bag or an MCAP file")
        self._bag = Bag(self.path)
        self.topics = _choose_topics(self.path, self._bag.message_types(), asked)
        self._frames: Iterator[RgbdFrame] = iter(())
        self._next: RgbdFrame | None = None

    def start(self) -> None:
        """See `RgbdCamera.start`."""
        self._frames = self._read()
        self._next = next(self._frames, None)
        if self._next is None:
            raise InputError(str(self.path), self.topics["depth"], "no picture", "depth after a message of camera_info")

    def newest(self) -> RgbdFrame | None:
        """Return the next picture; None after the last one.

        Raises:
            InputError: A message is damaged.
        """
        found = self._next
        if found is not None:
            self._next = next(self._frames, None)
        return found

    def close(self) -> None:
        """See `RgbdCamera.close`."""
        self._frames, self._next = iter(()), None

    def _read(self) -> Iterator[RgbdFrame]:
        removal: Undistortion | None = None
        colours: deque[tuple[float, NDArray[np.uint8]]] = deque(maxlen=3)
        waiting: tuple[float, NDArray[np.float32]] | None = None
        for topic, message in self._bag.read_messages(set(self.topics.values())):
            if topic == self.topics["info"]:
                if removal is None:
                    removal = self._read_lens(message)
            elif topic == self.topics.get("color"):
                colours.append((stamp_of(message), colours_in(message, str(self.path))))
            elif removal is not None:
                stamp = stamp_of(message)
                if waiting is not None:
                    if stamp <= waiting[0]:
                        found = f"a stamp of {stamp:.3f} s after {waiting[0]:.3f} s" if stamp else "no time stamps"
                        expected = "pictures with the times at which they were taken"
                        raise InputError(str(self.path), topic, found, expected)
                    yield self._pair(*waiting, colours, removal)
                # Its colours may be the next message.
                waiting = stamp, _depth(message, self.path, topic)
        if waiting is not None and removal is not None:
            yield self._pair(*waiting, colours, removal)

    def _read_lens(self, message: Any) -> Undistortion:
        found = check_lens(lens_of(message, self.topics["depth"]), f"{self.path}: {self.topics['info']}")
        lens, bent = np.array([found.fx, found.fy, found.cx, found.cy]), np.array(found.distortion or (0.0,) * 4)
        return Undistortion(lens, bent, (found.height, found.width), fisheye=found.model == "equidistant")

    def _pair(
        self,
        time_s: float,
        depth: NDArray[np.float32],
        colours: Iterable[tuple[float, NDArray[np.uint8]]],
        removal: Undistortion,
    ) -> RgbdFrame:
        near = min(colours, key=lambda one: abs(one[0] - time_s), default=None)
        rgb = near[1] if near is not None and abs(near[0] - time_s) <= TOGETHER_S else None
        if rgb is not None and rgb.shape[:2] != depth.shape:
            (height, width), (rows, columns) = depth.shape, rgb.shape[:2]
            found = f"{width} x {height} pixels beside colours of {columns} x {rows}"
            raise InputError(str(self.path), self.topics["depth"], found, "depth aligned to the colours")
        rgb = None if rgb is None else removal.apply(rgb)
        return bare_frame(removal.apply(depth), rgb, removal.lens, self._placed, time_s)


def _choose_topics(path: Path, types: dict[str, str], asked: str) -> dict[str, str]:
    """Choose the topics of depth, color and info; color may be missing."""
    chosen: dict[str, str] = {}
    for part in filter(None, asked.split(",")):
        role, _, topic = part.partition("=")
        if role not in ROLES:
            raise InputError("--camera", part, repr(role), f"{' or '.join(ROLES)}{nearest(role, ROLES)}")
        if topic not in types:
            raise InputError("--camera", part, "no such topic", f"one of {', '.join(sorted(types))}")
        chosen[role] = topic
    images = sorted(topic for topic, kind in types.items() if kind in IMAGES)
    depths = [topic for topic in images if "depth" in topic]
    colours = [topic for topic in images if "depth" not in topic and ("color" in topic or "rgb" in topic)]
    infos = sorted(topic for topic, kind in types.items() if kind == INFO)
    if "depth" not in chosen:
        chosen["depth"] = _only(path, "depth", [t for t in depths if "aligned" in t] or depths, types)
    if "color" not in chosen and colours:
        chosen["color"] = _only(path, "color", colours, types)
    if "info" not in chosen:
        folder = chosen["depth"].rpartition("/image")[0] or chosen["depth"].rpartition("/")[0]
        beside = [topic for topic in infos if topic.rpartition("/")[0] == folder]
        chosen["info"] = _only(path, "info", beside or infos, types)
    return chosen


def _only(path: Path, role: str, found: list[str], types: dict[str, str]) -> str:
    if len(found) == 1:
        return found[0]
    what = ", ".join(found) if found else f"no topic of {role} among {', '.join(sorted(types)) or 'no topics'}"
    raise InputError(str(path), role, what, f"one topic, or --camera bag:{path}#{role}=/TOPIC")


def _depth(message: Any, path: Path, topic: str) -> NDArray[np.float32]:
    """Return the depth of a message, Shape=(H, W) m (REP 118: millimetres in 16 bits, metres in 32)."""
    found = values_in(message, str(path), topic)
    if found.ndim != 2 or found.dtype not in (np.uint16, np.float32):
        kind = f"{found.dtype} in {found.shape[2:] or 1} channels"
        raise InputError(str(path), topic, kind, "millimetres in 16 bits or metres in 32, one channel")
    return np.asarray(found * np.float32(0.001) if found.dtype == np.uint16 else found, np.float32)
