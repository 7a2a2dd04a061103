import threading
from types import SimpleNamespace

import pytest

from coral.contact.franka import child_process


class Thread(threading.Thread):
    def kill(self):
        pass


@pytest.fixture
def in_threads(monkeypatch):
    """Threads stand for the processes, which take seconds to start."""
    monkeypatch.setattr(child_process, "get_context", lambda method: SimpleNamespace(Process=Thread))
