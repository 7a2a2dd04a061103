"""The page on served policies: its server serves, its tables name everything there is."""

import re
import threading
from pathlib import Path

import numpy as np
import websockets.sync.server

from coral.contact.policy.client import PolicyClient
from coral.contact.policy.libero_convention import actions_of

PAGE = (Path(__file__).parents[3] / "docs" / "reference" / "policy-server.md").read_text(encoding="utf-8")


def test_the_example_is_a_server_that_the_client_understands(monkeypatch, patient):
    [example] = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    real, started = websockets.sync.server.serve, threading.Event()
    running = []

    def serve(handle, host, port, **more):
        running.append(real(handle, host, 0, **more))
        started.set()
        return running[0]

    monkeypatch.setattr(websockets.sync.server, "serve", serve)
    thread = threading.Thread(target=exec, args=(example, {}), daemon=True)
    thread.start()
    assert started.wait(20)
    client = PolicyClient(f"ws://127.0.0.1:{running[0].socket.getsockname()[1]}", patient)
    answer = client.infer({"prompt": "sink", "observation/state": np.zeros(8)})
    assert client.metadata == {"model": "sinks slowly"}
    assert actions_of(answer).shape == (10, 7)
    client.close()
    running[0].shutdown()
    thread.join()
