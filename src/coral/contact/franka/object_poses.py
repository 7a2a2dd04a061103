"""The objects' poses from any tracker: JSON datagrams on a UDP port."""

from __future__ import annotations

import json
import math
import socket
from collections import deque
from collections.abc import Collection, Iterable, Mapping
from typing import Any

import numpy as np

from coral.contact.scene.geometry import conjugate, multiply, rotate, to_rotvec
from coral.contact.scene.observation import BodyState
from coral.errors import MALFORMED, InputError
from coral.foreign_file import parse_json

SMOOTHING_S = 0.1
"""Time constant of the velocity, which is a difference of noisy poses."""
LARGEST = 8_192
"""Bytes of a datagram: the poses of thirty objects."""
TAKEN, PARSED = 100, 10
"""Datagrams that are taken from the port at once, and the newest of them that are read: a flood of the largest ones,
which take 1 ms each, must not hold the stream up."""
FRAMES = {"world": False, "tool": True}


class ObjectPoses:
    """Receives poses and keeps the newest of each object, with its age.

    A datagram is `{"objects": {"NAME": {"position": [x, y, z], "quaternion": [w, x, y, z]}}}`, in metres and the world
    frame, or with `"in": "tool"` in the tool's: such an object moves with the hand until the next datagram. It may name
    some of the objects only. A datagram that is anything else is ignored. Port 0 takes a free
    one.

    Raises:
        InputError: The port cannot be used.
    """

    def __init__(self, names: Iterable[str], host: str, port: int) -> None:
        self.names = tuple(names)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        try:
            self._socket.bind((host, port))
        except OSError as error:
            self._socket.close()
            raise InputError("--cfg", "franka.poses_port", f"{host}:{port} ({error.strerror})", "a free port") from None
        self.port: int = self._socket.getsockname()[1]
        self.poses: dict[str, BodyState] = {}
        """The newest pose of every object that was ever seen."""
        self._held: dict[str, BodyState] = {}
        self._seen: dict[str, float] = {}

    def update(self, now_s: float, tool: BodyState | None = None) -> None:
        """Take in all datagrams that have arrived; never waits. The tool, in the world, carries what is held."""
        self._receive(now_s)
        if tool is not None:
            self.poses |= {name: _carried(pose, tool) for name, pose in self._held.items()}

    def _receive(self, now_s: float) -> None:
        waiting: deque[bytes] = deque(maxlen=PARSED)
        for _ in range(TAKEN):
            try:
                waiting.append(self._socket.recv(LARGEST + 1))
            except OSError:  # nothing more is waiting
                break
        for data in waiting:
            found = (parse_poses(data) if len(data) <= LARGEST else None) or {}
            for name in self.names:
                pose, held = found.get(name, (None, False))
                if pose is not None and held:
                    self._held[name], self._seen[name] = pose, now_s
                elif pose is not None:
                    self._held.pop(name, None)
                    self._take(name, pose, now_s)

    def _take(self, name: str, pose: BodyState, now: float) -> None:
        before = self.poses.get(name)
        if before is not None:
            passed = now - self._seen[name]
            if passed < 1e-3:  # two datagrams were waiting: their distance in time is unknown
                pose = BodyState(pose.position, pose.quaternion, before.velocity, before.angular_velocity)
            else:
                share = 1.0 - math.exp(-passed / SMOOTHING_S)
                turned = to_rotvec(multiply(pose.quaternion, conjugate(before.quaternion)))
                velocity = before.velocity + share * ((pose.position - before.position) / passed - before.velocity)
                spin = before.angular_velocity + share * (turned / passed - before.angular_velocity)
                pose = BodyState(pose.position, pose.quaternion, velocity, spin)
        self.poses[name], self._seen[name] = pose, now

    def age_s(self, name: str, now_s: float) -> float:
        """Return the time since an object's newest pose; infinity if it was never seen."""
        return now_s - self._seen[name] if name in self._seen else math.inf

    def oldest(self, now_s: float) -> tuple[str, float]:
        """Return the object whose pose is oldest, and its age (s)."""
        ages = ((name, self.age_s(name, now_s)) for name in self.names)
        return max(ages, key=lambda found: found[1], default=("", 0.0))

    def close(self) -> None:
        """Close the port."""
        self._socket.close()


def parse_poses(data: bytes) -> Mapping[str, tuple[BodyState, bool]] | None:
    """Parse a datagram: poses, and whether they are in the tool's frame instead of the world's; None if malformed."""
    try:
        return {
            str(name): (_pose(value), FRAMES[value.get("in", "world")])
            for name, value in parse_json(data)["objects"].items()
        }
    except MALFORMED:
        return None


def _pose(value: Any) -> BodyState:
    position, quaternion = (np.asarray(value[key], float) for key in ("position", "quaternion"))
    length = float(np.linalg.norm(quaternion))
    if position.shape != (3,) or quaternion.shape != (4,) or not np.isfinite(position).all() or not 0.9 < length < 1.1:
        raise ValueError("not a pose")
    return BodyState(position, quaternion / length)


def _carried(pose: BodyState, tool: BodyState) -> BodyState:
    """Return the pose and velocity in the world of what rests in the tool's frame."""
    lever = rotate(tool.quaternion, pose.position)
    velocity = tool.velocity + np.cross(tool.angular_velocity, lever)
    return BodyState(tool.position + lever, multiply(tool.quaternion, pose.quaternion), velocity, tool.angular_velocity)


def poses_datagram(poses: Mapping[str, BodyState], held: Collection[str] = ()) -> bytes:
    """Return the datagram with these poses; those of the objects in `held` are in the tool's frame."""
    objects: dict[str, dict[str, Any]] = {}
    for name, pose in poses.items():
        frame = {"in": "tool"} if name in held else {}
        objects[name] = {"position": pose.position.tolist(), "quaternion": pose.quaternion.tolist(), **frame}
    return json.dumps({"objects": objects}).encode()
