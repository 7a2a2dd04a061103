"""An inbox with a question in it, a server beside it, and a client that says what it means."""

import asyncio
import http.client
import json
import math
import threading
from contextlib import contextmanager
from types import SimpleNamespace

import numpy as np
import pytest
from pydantic import BaseModel, Field

from coral.advisor.question import Picture, Question, Rejection
from coral.desk.advisor import DeskAdvisor
from coral.desk.inbox import Inbox
from coral.desk.server import DeskServer
from coral.reef.decide.answers import CentroidChoice, MissionAnswer, WaypointChoice
from coral.reef.pictures.mapview import MapScene, draw_map, png
from coral.reef.world.geometry import Pose, to_robot

POSE = Pose(3.0, 5.0, math.pi / 2)
ARRIVAL = Pose(3.5, 5.5, 0.3)
"""Where the robot will be when it needs the answer: what the places in the facts are measured from."""
ANSWERS = {"reef-centroid": CentroidChoice, "reef-waypoint": WaypointChoice, "reef-mission": MissionAnswer}
DOTS = {4: (3.0, 9.0), 7: (6.0, 7.0), 12: (4.0, 2.0)}


class Pick(BaseModel):
    index: int = Field(ge=0, le=3)
    reason: str = Field(default="", max_length=40)


def facts():
    """What the robot believes; its +X points up the map."""
    places = {k: to_robot(ARRIVAL, *point) for k, point in DOTS.items()}
    return {
        "robot": POSE._asdict(),
        "arrival": {"pose": ARRIVAL._asdict(), "in_s": 4.0},
        "centroids": [{"index": k, "forward_m": f, "left_m": s, "visited": k == 12} for k, (f, s) in places.items()],
    }


def drawn_map():
    cells = np.ones((240, 240), np.uint8)
    return draw_map(
        MapScene(
            cells=cells,
            cell_m=0.05,
            pose=POSE,
            centroids=np.array(list(DOTS.values())),
            indices=list(DOTS),
            visited=[k == 12 for k in DOTS],
        )
    )


def reef_question(kind="reef-centroid"):
    drawn = drawn_map()
    frame = ((drawn.scale, 0.0, drawn.left_px), (0.0, -drawn.scale, drawn.bottom_px))
    return Question(
        kind=kind,
        prompt="Which dot?\nThe best one.",
        facts=facts(),
        answer_type=ANSWERS[kind],
        pictures=(Picture(name="map", png=png(drawn.rgb), caption="from above", pixel_from_world=frame),),
    )


def pick_question():
    return Question(
        kind="pick",
        prompt="Which?",
        answer_type=Pick,
        facts={"n": 3},
        pictures=(Picture(name="map", png=png(np.zeros((8, 12, 3), np.uint8)), caption="black"),),
    )


class Asking:
    """A question that waits for its answer on a thread, as in a mission."""

    def __init__(self, inbox, question, rejections=()):
        self.reply = self.error = None
        self._posted = threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._ask(inbox, question, rejections)), daemon=True)
        self._thread.start()
        assert self._posted.wait(30)
        self.id = max(path.name for path in inbox.iterdir() if path.name[0].isdigit())

    async def _ask(self, inbox, question, rejections):
        self._loop = asyncio.get_running_loop()
        self._task = self._loop.create_task(DeskAdvisor(inbox, poll_s=0.01).answer(question, rejections))
        # One turn of the loop posts the question: it is there before anything else happens.
        await asyncio.sleep(0)
        self._posted.set()
        try:
            self.reply = await self._task
        except (asyncio.CancelledError, Exception) as error:
            self.error = error

    def withdraw(self):
        self._loop.call_soon_threadsafe(self._task.cancel)
        self._thread.join(30)

    def result(self):
        self._thread.join(30)
        assert self.reply is not None, self.error
        return self.reply.value


@pytest.fixture
def ask(tmp_path):
    asked = []

    def one(question=None, rejections=()):
        asked.append(Asking(tmp_path / "inbox", question or pick_question(), rejections))
        return asked[-1]

    yield one
    for asking in asked:
        if asking.reply is None and asking.error is None:
            asking.withdraw()


def refused(reason="behind you"):
    return [Rejection(code="backward", reason=reason, details={"index": 1})]


class Client:
    def __init__(self, server):
        self.port = server.access.port
        self.token = {"Authorization": f"Bearer {server.access.token}"}

    def __call__(self, method, path, body=None, headers=None, raw=False):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        connection.request(method, path, body, {**self.token, **(headers or {})})
        response = connection.getresponse()
        content = response.read()
        connection.close()
        if raw:
            return response, content
        return response.status, json.loads(content) if content else None

    def answer(self, question_id, answer, operator="", **headers):
        content = {"answer": answer, "operator": operator}
        return self.post(f"/api/questions/{question_id}/answer", content, **headers)

    def post(self, path, content, **headers):
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        headers = {"Content-Type": "application/json", "X-Coral": "1", **named}
        return self("POST", path, json.dumps(content), headers)


@contextmanager
def serving(inbox, **options):
    with DeskServer(Inbox(inbox), port=0, **options) as server:
        yield server


@pytest.fixture
def server(tmp_path):
    with serving(tmp_path / "inbox") as server:
        yield server


@pytest.fixture
def client(server):
    return Client(server)


@pytest.fixture(scope="session")
def case():
    """What the tests build questions and servers from."""
    return SimpleNamespace(
        pick_question=pick_question,
        reef_question=reef_question,
        refused=refused,
        drawn_map=drawn_map,
        serving=serving,
        client=Client,
        dots=DOTS,
    )
