"""An advisor that speaks ROS 2: questions and answers as topics, so that a node or a person can decide.

coral/question            std_msgs/String: JSON with id, kind, prompt, answer_schema, facts, rejections, images
coral/question/pictures   sensor_msgs/CompressedImage: its pictures as PNG; frame_id is "ID/NAME"
coral/answer              std_msgs/String: JSON with the id, and the answer as `answer`
"""

from __future__ import annotations

import array
import asyncio
import dataclasses
import json
import queue
from collections.abc import Sequence
from typing import Any, TypeVar

from pydantic import BaseModel

from coral.advisor.log import plain_json
from coral.advisor.parse import MAX_CHARS, parse_answer
from coral.advisor.question import Question, Rejection, Reply, Usage
from coral.advisor.setting import Setting
from coral.foreign_file import parse_json
from coral.ros.ros_node import RosNode, ros_type

A = TypeVar("A", bound=BaseModel)
POLL_S = 0.05


class RosAdvisor:
    """Publishes each question, and waits for the answer with its id; `place` is a namespace or a file of parameters."""

    latency = "measured"
    name = "ros2"

    def __init__(self, place: str = "", node: RosNode | None = None) -> None:
        self._ros = ros = node or RosNode("coral_advisor", place, "--advisor")
        self._string = ros_type("std_msgs.msg.String", "--advisor")
        self._image = ros_type("sensor_msgs.msg.CompressedImage", "--advisor")
        self._asked = 0
        self._answers: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._questions = ros.node.create_publisher(self._string, "coral/question", ros.qos("latched"))
        self._pictures = ros.node.create_publisher(self._image, "coral/question/pictures", 10)
        ros.node.create_subscription(self._string, "coral/answer", lambda m: self._answers.put(m.data), 10)

    async def answer(self, question: Question[A], rejections: Sequence[Rejection]) -> Reply[A]:
        """Publish the question and wait for its answer.

        Raises:
            BadAnswer: The answer does not validate.
        """
        self._asked += 1
        name = f"{self._asked:06d}-{question.kind}"
        for picture in question.pictures:
            message = self._image(format="png", data=array.array("B", picture.png))
            message.header.stamp, message.header.frame_id = self._ros.stamp(), f"{name}/{picture.name}"
            self._pictures.publish(message)
        content = {
            "id": name,
            "kind": question.kind,
            "prompt": question.prompt,
            "answer_schema": question.answer_type.model_json_schema(),
            "facts": question.facts,
            "rejections": [dataclasses.asdict(rejection) for rejection in rejections],
            "images": [picture.name for picture in question.pictures],
        }
        self._questions.publish(self._string(data=plain_json(content)))
        text = await self._wait(name)
        usage = Usage(requests=1)
        return Reply(value=parse_answer(text, question.answer_type, usage), raw=text, usage=usage)

    async def _wait(self, name: str) -> str:
        while True:
            while not self._answers.empty():
                text = answer_to(name, self._answers.get_nowait())
                if text is not None:
                    return text
            await asyncio.sleep(POLL_S)


def answer_to(name: str, message: str) -> str | None:
    """Return the answer in a message if it belongs to the question of this name; None otherwise."""
    if len(message) > MAX_CHARS:
        return None
    try:
        content: Any = parse_json(message)
    except ValueError:
        return None
    if not isinstance(content, dict) or content.get("id") != name or "answer" not in content:
        return None
    answer = content["answer"]
    return answer if isinstance(answer, str) else json.dumps(answer)


def make_ros(name: str, rest: str, setting: Setting) -> RosAdvisor:
    """Make the advisor: `ros2`, or `ros2:NAMESPACE`."""
    return RosAdvisor(rest)
