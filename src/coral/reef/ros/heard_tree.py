"""Where in the vehicle a sensor is: the frames on /tf and /tf_static (REP-105), below the vehicle's `base_link`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError
from coral.reef.recordings.frame_tree import FrameTree, frame_name
from coral.reef.recordings.transforms import transform_from
from coral.ros.ros_node import RosNode, ros_type

BODY = "base_link"
"""The vehicle's frame: x forward, y left, z up."""


class HeardTree:
    """Listens to the tree of frames; of a transform that comes again the newest one holds."""

    def __init__(self, ros: RosNode, where: str) -> None:
        self._tree = FrameTree()
        self.missing = ""
        """Why nothing can be heard, or ""."""
        try:
            kind = ros_type("tf2_msgs.msg.TFMessage", where)
        except InputError as error:
            self.missing = str(error.found)
        else:
            ros.node.create_subscription(kind, "/tf_static", self._hear, ros.qos("latched"))
            ros.node.create_subscription(kind, "/tf", self._hear, ros.qos("sensor"))

    def in_vehicle(self, frame: str) -> NDArray[np.float64] | None:
        """Return T_frame^base_link; None if no chain of transforms leads there. Shape=(4, 4)."""
        frame = frame_name(frame)
        body = next((each for each in (frame, *self._tree.frames()) if each.rpartition("/")[2] == BODY), BODY)
        return np.eye(4) if frame == body else self._tree.first(body, frame)

    def _hear(self, message: Any) -> None:
        for each in message.transforms:
            at, q = each.transform.translation, each.transform.rotation
            try:
                step = transform_from((at.x, at.y, at.z), (q.x, q.y, q.z, q.w))
                self._tree.add(str(each.header.frame_id), str(each.child_frame_id), step, None)
            except ValueError:
                continue  # no rotation, or a second parent: what was known stays
