"""A FoundationPose server without FoundationPose: an estimator that is told the answers."""

import contextlib
import threading

import numpy as np

from coral.contact.perception.foundationpose_server import Sessions, serve


class Oracle:
    """Has the verbs of FoundationPose's estimator; `answer` is what it finds, or a function that knows."""

    answer = np.eye(4)
    calls: list = []

    def __init__(self, vertices, faces, symmetry):
        self.vertices, self.faces, self.symmetry = vertices, faces, symmetry
        Oracle.last = self

    def register(self, K, rgb, depth, ob_mask, iteration):
        assert rgb.dtype == np.uint8
        assert ob_mask.any()
        Oracle.calls.append(("register", iteration))
        return self.found()

    def track_one(self, rgb, depth, K, iteration):
        Oracle.calls.append(("track", iteration))
        return self.found()

    @classmethod
    def found(cls):
        return cls.answer() if callable(cls.answer) else cls.answer


@contextlib.contextmanager
def serving(estimator=Oracle):
    """A running server and its sessions."""
    Oracle.calls = []
    sessions = Sessions(estimator)
    server = serve(sessions, "127.0.0.1", 0)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True)
    thread.start()
    server.url, server.sessions = f"http://127.0.0.1:{server.server_port}", sessions
    try:
        yield server
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
