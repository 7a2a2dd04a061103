"""What a survey finds and decides as topics, and the operator's words as services, while it runs.

In the namespace of the vehicle, for RViz and Foxglove, as the reference lists them; frame `map` is the
survey's own.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.advisor.log import plain_json
from coral.errors import InputError
from coral.reef.map.mapping import FREE, OBSTACLE, TARGET
from coral.reef.recordings.frame_tree import MAP
from coral.reef.ros.ros_link import RosLink
from coral.reef.sea.frames import LocalFrame
from coral.reef.sea.operator import WORDS, OperatorWords
from coral.reef.sea.sea_mission import SeaMission
from coral.reef.world.geometry import Pose
from coral.ros.ros_node import RosNode, ros_type

PERIOD_S = 1.0
START = {"arm": "start"}
"""The services are called as the operator's words, but for this one: `start` begins the survey."""
OK, WARN, ERROR = b"\x00", b"\x01", b"\x02"


def grid_values(cells: NDArray[np.uint8]) -> NDArray[np.int8]:
    """Return the values of an occupancy grid for a map's cells, row by row from the south-west. Shape=(NY * NX,)."""
    values = np.full(cells.shape, -1, np.int8)
    values[cells == FREE], values[cells == TARGET], values[cells == OBSTACLE] = 0, 50, 100
    return values.ravel()


class SurveyTopics:
    """Publishes a survey; it reads the mission between two ticks and changes nothing of it.

    `place` is the vehicle's namespace, or a file of ROS parameters; services put the operator's words into `words`.
    instruct(words, by) changes the instruction of a mission in words; None without one.
    """

    def __init__(
        self,
        place: str,
        words: OperatorWords,
        instruct: Callable[[str, str], bool] | None = None,
        node: RosNode | None = None,
    ) -> None:
        self._ros = ros = node or RosNode("coral_survey", place, "--vehicle")
        self._words, self._instruct, self._due_s = words, instruct, 0.0
        self._told = ""
        """The instruction that was published last."""
        self._trail: list[Pose] = []
        self._listening = False
        make = ros.node.create_publisher
        latched = ros.qos("latched")
        self._map = make(ros_type("nav_msgs.msg.OccupancyGrid"), "coral/map", latched)
        self._path = make(ros_type("nav_msgs.msg.Path"), "coral/path", latched)
        self._oysters = make(ros_type("visualization_msgs.msg.MarkerArray"), "coral/oysters", latched)
        self._goal = make(ros_type("geometry_msgs.msg.PoseStamped"), "coral/goal", latched)
        self._transform = MapTransform(ros)
        self._events = make(ros_type("std_msgs.msg.String"), "coral/events", 100)
        self._health = make(ros_type("diagnostic_msgs.msg.DiagnosticArray"), "diagnostics", 10)
        if instruct is not None:
            self._instruction = make(ros_type("std_msgs.msg.String"), "coral/instruction", latched)
            ros.node.create_subscription(ros_type("std_msgs.msg.String"), "coral/instruct", self._change, 10)
        trigger = ros_type("std_srvs.srv.Trigger")
        for word in WORDS:
            ros.node.create_service(trigger, f"coral/{START.get(word, word)}", partial(self._say, word))

    def waiting(self, lines: tuple[str, ...]) -> None:
        """Publish the preflight list."""
        self._report("waiting", lines=list(lines))

    def tick(self, run: SeaMission) -> None:
        """Publish events at once, the rest once a second."""
        if not self._listening:
            self._listening = True
            run.record.listeners.append(self._event)
        if run.instruction != self._told:
            self._told = run.instruction
            self._instruction.publish(ros_type("std_msgs.msg.String")(data=self._told))
        if run.pose is not None:
            self._trail.append(run.pose)
            if run.report.pose is not None and isinstance(run.crew.link, RosLink):
                self._transform.publish(run.crew.link.odom_frame, run.report.pose, run.pose)
        if time.monotonic() < self._due_s and not run.end_reason:
            return
        self._due_s = time.monotonic() + PERIOD_S
        self._publish_map(run)
        self._publish_path()
        self._publish_oysters(run)
        self._publish_goal(run)
        self._publish_health(run)

    def stop_requested(self) -> str:
        """Return "": the operator's words end a survey."""
        return ""

    def close(self) -> None:
        """End the node."""
        self._ros.close()

    def _say(self, word: Any, _: Any, answer: Any) -> Any:
        self._words.say(word, "ROS 2")
        answer.success, answer.message = True, f"told to {word}"
        return answer

    def _change(self, message: Any) -> None:
        """Change the instruction; what is refused is told, for a topic has no answer."""
        try:
            assert self._instruct is not None
            self._instruct(str(message.data), "ROS 2")
        except InputError as error:
            self._report("instruction_refused", reason=str(error))

    def _report(self, event: str, **fields: Any) -> None:
        self._event({"event": event, **fields})

    def _event(self, event: dict[str, Any]) -> None:
        self._events.publish(ros_type("std_msgs.msg.String")(data=plain_json(event)))

    def _headed(self, name: str) -> Any:
        message = ros_type(name)()
        message.header.frame_id, message.header.stamp = MAP, self._ros.stamp()
        return message

    def _publish_map(self, run: SeaMission) -> None:
        cells, message = run.belief.map.cells(), self._headed("nav_msgs.msg.OccupancyGrid")
        message.info.resolution = float(run.belief.map.cfg.cell_m)
        message.info.height, message.info.width = cells.shape
        message.info.origin.orientation.w = 1.0
        message.data = grid_values(cells).tolist()
        self._map.publish(message)

    def _publish_path(self) -> None:
        message = self._headed("nav_msgs.msg.Path")
        message.poses = [self._posed(*pose) for pose in self._trail[::10]]
        self._path.publish(message)

    def _posed(self, x: float, y: float, theta: float) -> Any:
        posed = self._headed("geometry_msgs.msg.PoseStamped")
        posed.pose.position.x, posed.pose.position.y = float(x), float(y)
        posed.pose.orientation.z, posed.pose.orientation.w = math.sin(theta / 2.0), math.cos(theta / 2.0)
        return posed

    def _publish_oysters(self, run: SeaMission) -> None:
        markers = []
        for track in run.belief.tracks:
            marker = self._headed("visualization_msgs.msg.Marker")
            marker.ns, marker.id, marker.type = "oysters", int(track.index), 3  # a cylinder
            marker.pose.position.x, marker.pose.position.y = float(track.x), float(track.y)
            marker.pose.orientation.w = 1.0
            marker.scale.x = marker.scale.y = max(0.3, float(track.length_m))
            marker.scale.z = 0.2
            marker.color.g, marker.color.a = 0.8, 0.6 if track.visited else 0.9
            marker.color.r = 0.0 if track.visited else 0.9
            markers.append(marker)
        self._oysters.publish(ros_type("visualization_msgs.msg.MarkerArray")(markers=markers))

    def _publish_goal(self, run: SeaMission) -> None:
        if run.belief.goal is not None:
            self._goal.publish(self._posed(*run.belief.goal, 0.0))

    def _publish_health(self, run: SeaMission) -> None:
        states, status = run.states, ros_type("diagnostic_msgs.msg.DiagnosticStatus")()
        state = states.state.value
        status.name, status.hardware_id = "coral: survey", run.area.name
        status.level = ERROR if run.end_reason else OK if state == "surveying" else WARN
        status.message = run.end_reason or (f"{state}: {states.reason}" if states.reason else state)
        ticks = run.ticks
        told = {"ticks": ticks.done, "late ticks": ticks.late, "covered": f"{run.coverage:.0%}", "notice": run.notice}
        told["tf"] = self._transform.told
        status.values = [
            ros_type("diagnostic_msgs.msg.KeyValue")(key=key, value=str(value)) for key, value in told.items()
        ]
        message = ros_type("diagnostic_msgs.msg.DiagnosticArray")(status=[status])
        message.header.stamp = self._ros.stamp()
        self._health.publish(message)


class MapTransform:
    """Sends the transform from `map` to the frame of the odometry, unless the parameter `publish_tf` is false."""

    def __init__(self, ros: RosNode) -> None:
        self.told = "not yet"
        """What is sent, or why nothing is."""
        self._ros = ros
        if ros.parameter("publish_tf", "true").lower() == "false":
            self.told = "off: publish_tf"
            return
        try:
            self._message = ros_type("tf2_msgs.msg.TFMessage")
        except InputError as error:
            self.told = f"off: {error.found}"
            return
        self._stamped = ros_type("geometry_msgs.msg.TransformStamped")
        self._publisher = ros.node.create_publisher(self._message, "/tf", 10)

    def publish(self, frame: str, odometry: Pose, pose: Pose) -> None:
        """Send the transform, by one pose in the odometry's frame and in the map."""
        if self.told.startswith("off"):
            return
        if frame in ("", MAP):
            self.told = f"not needed: the odometry is in {frame!r}"
            return
        at, message = LocalFrame.from_start(odometry, pose, trust_heading=False), self._stamped()
        message.header.stamp = self._ros.stamp()
        message.header.frame_id, message.child_frame_id = MAP, frame
        message.transform.translation.x, message.transform.translation.y = float(at.x), float(at.y)
        message.transform.rotation.z = math.sin(at.turn / 2.0)
        message.transform.rotation.w = math.cos(at.turn / 2.0)
        self._publisher.publish(self._message(transforms=[message]))
        self.told = f"{MAP} -> {frame}"
