"""The live page: a web server that shows states at a bounded rate and never blocks its caller."""

from __future__ import annotations

import errno
import socket
import sys
import threading
import time
from typing import Any

import numpy as np
import rich

from coral.errors import InputError
from coral.view.live.panel import LivePanel, PageControls
from coral.view.live.scene import LiveScene
from coral.view.live.server import HOST, GuardedServer, silent
from coral.view.live.state import LiveState

PERIOD_S = 0.33
"""Shortest wall time between two pictures."""
IDLE = 9.0
"""After a picture that took c seconds of CPU, the page rests IDLE c: it uses a tenth of one core at most."""
FOLLOW_M = 9.0
"""Initial distance of a camera that follows the robot; less if it was closer."""


class LivePage:
    """Shows the latest state to every connected browser and drops states that come too fast."""

    def __init__(self, port: int, controls: PageControls, *, label: str = "CORAL", flag: str = "--port") -> None:
        """Open the page on this machine.

        Args:
            port: Port; 0 chooses a free one.
            controls: The page's buttons.
            label: Title of the panel.
            flag: Flag of the port on the command line.

        Raises:
            InputError: The port is in use or invalid.
        """
        check_free(port, flag)
        self._server = GuardedServer(port, label)
        self.port = int(self._server.get_port())
        if port and self.port != port:
            self._stop_server()
            raise InputError(flag, "", f"port {port} in use", "a free port, or 0 for any")
        # Suppress viser's own messages in a command's output.
        rich.reconfigure(stderr=True)
        self._scene = LiveScene(self._server)
        self._panel = LivePanel(self._server, controls, self._hide, self._set_follow)
        self._lock = threading.RLock()
        self._news = threading.Condition()
        self._state: LiveState | None = None
        self._busy = self._closed = False
        self._next = 0.0
        self._newcomer = False
        self._follow = False
        self._tracked: Any = None
        self._server.on_client_connect(self._welcome)
        self._worker = threading.Thread(target=self._work, name="live page", daemon=True)
        self._worker.start()

    @property
    def url(self) -> str:
        """Return the page's URL, with the token that it requires."""
        assert self._server.access is not None
        return self._server.access.url

    def due(self, *, only_new: bool = False) -> bool:
        """Check whether a new state would be shown now: a browser is connected and the last state has been sent.

        Args:
            only_new: Check only for new browsers; nothing has changed for the others.
        """
        if self._busy or not self._server.get_clients():
            return False
        return self._newcomer or (not only_new and time.monotonic() >= self._next)

    def show(self, state: LiveState) -> None:
        """Show a state as soon as possible, unless a later one replaces it; return at once."""
        with self._news:
            self._state, self._busy, self._newcomer = state, True, False
            self._news.notify()

    def __enter__(self) -> LivePage:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Show the last state and close the page."""
        with self._news:
            self._closed = True
            self._news.notify()
        self._worker.join(timeout=10.0)
        if self._server.get_clients():
            self._server.flush()
            time.sleep(0.3)  # let the last state arrive; browsers keep it after the server has stopped
        self._stop_server()

    def _work(self) -> None:
        while True:
            with self._news:
                while self._state is None and not self._closed:
                    self._news.wait()
                state, self._state = self._state, None
            if state is None:
                return
            began = time.thread_time()
            try:
                with self._lock, self._server.atomic():
                    self._scene.show(state)
                    self._panel.show(state)
                    self._track(state)
            except Exception as error:
                print(f"coral: the live page failed: {type(error).__name__}: {error}", file=sys.stderr, flush=True)
                return
            self._next = time.monotonic() + max(PERIOD_S, IDLE * (time.thread_time() - began))
            with self._news:
                self._busy = self._state is not None

    def _welcome(self, client: Any) -> None:
        self._newcomer = True

    def _hide(self, layer: str, hidden: bool) -> None:
        with self._lock:
            self._scene.hide(layer, hidden)

    def _set_follow(self, follow: bool) -> None:
        with self._lock:
            self._follow = follow
            if follow and self._tracked is not None:
                for client in self._server.get_clients().values():
                    camera = client.camera
                    back = np.asarray(camera.position) - camera.look_at
                    distance = float(np.linalg.norm(back))
                    camera.position = self._tracked + back * (min(distance, FOLLOW_M) / max(distance, 1e-6))
                    camera.look_at = self._tracked

    def _track(self, state: LiveState) -> None:
        """Move every camera along with the followed body."""
        now = next((np.array(b.position) for b in state.bodies if b.name == state.follow), None)
        if self._follow and now is not None and self._tracked is not None and (now != self._tracked).any():
            for client in self._server.get_clients().values():
                client.camera.position = np.asarray(client.camera.position) + (now - self._tracked)
        self._tracked = now if now is not None else self._tracked

    def _stop_server(self) -> None:
        with silent():
            self._server.stop()


def check_free(port: int, flag: str) -> None:
    """Refuse a port on which no page can be opened.

    Raises:
        InputError: The port is in use or invalid.
    """
    if not 0 <= port <= 65535:
        raise InputError(flag, "", port, "a port from 0 to 65535")
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((HOST, port))
        except OSError as error:
            found = f"port {port} in use" if error.errno == errno.EADDRINUSE else f"port {port}: {error.strerror}"
            raise InputError(flag, "", found, "a free port, or 0 for any") from None
