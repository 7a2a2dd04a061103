"""A policy server on this machine that does what a test tells it to."""

import threading

import numpy as np
import pytest
from websockets.sync.server import serve as websocket_server

from coral.contact.episode.policy_cfg import ClientCfg
from coral.contact.policy.wire import decode, encode

PATIENT = ClientCfg(connect_s=5.0, answer_s=5.0, attempts=2, wait_s=0.0)
HASTY = ClientCfg(connect_s=1.0, answer_s=1.0, attempts=2, wait_s=0.0)  # a busy machine answers in that time, too


class Server:
    """Answers the k-th question of all with `answer(k, observation)`: a message, or None for no answer at all.

    A message is a map (sent as openpi's servers do), bytes, a text, or an exception class to hang up.
    """

    def __init__(self, answer, greeting):
        self.answer, self.greeting, self.asked, self.connections = answer, greeting, [], 0
        self._over = threading.Event()
        self._server = websocket_server(self._handle, "127.0.0.1", 0, compression=None, max_size=None)
        self.url = f"ws://127.0.0.1:{self._server.socket.getsockname()[1]}"
        self._thread = threading.Thread(target=self._server.serve_forever, daemon=True)
        self._thread.start()

    def close(self):
        self._over.set()
        self._server.shutdown()
        self._thread.join()

    def _handle(self, line):
        self.connections += 1
        if self.greeting is None:
            self._over.wait()
            return
        line.send(self.greeting if isinstance(self.greeting, str | bytes) else encode(self.greeting))
        for question in line:
            self.asked.append(decode(question))
            message = self.answer(len(self.asked), self.asked[-1])
            if message is None:
                self._over.wait()
                return
            if message is ConnectionError:
                return
            line.send(message if isinstance(message, str | bytes) else encode(message))


def still(k, observation):
    return {"actions": np.zeros((10, 7), np.float32)}


@pytest.fixture
def serve():
    """Start servers; they end with the test."""
    running = []

    def start(answer=still, greeting=()):
        running.append(Server(answer, dict(greeting) if isinstance(greeting, tuple) else greeting))
        return running[-1]

    yield start
    for server in running:
        server.close()


@pytest.fixture
def patient():
    return PATIENT


@pytest.fixture
def hasty():
    return HASTY
