import importlib.util
from pathlib import Path

import pytest
from pydantic_ai import models

_spec = importlib.util.spec_from_file_location("advisor_stub", Path(__file__).with_name("stub.py"))
stub_module = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(stub_module)


@pytest.fixture(autouse=True)
def _no_provider(monkeypatch):
    """No test of this folder reaches a provider, whatever keys the environment holds."""
    for key in ("OPENAI_API_KEY", "ANTHROPIC_API_KEY", "GOOGLE_API_KEY", "GEMINI_API_KEY"):
        monkeypatch.delenv(key, raising=False)
    monkeypatch.setattr(models, "ALLOW_MODEL_REQUESTS", False)


@pytest.fixture
def stub():
    """Makes local servers that answer with `stub.completion`, `stub.error`, `stub.DROP` and `stub.SILENCE`."""
    servers = []

    class Make:
        completion = staticmethod(stub_module.completion)
        error = staticmethod(stub_module.error)
        DROP, SILENCE = stub_module.DROP, stub_module.SILENCE

        def __call__(self, *replies):
            servers.append(stub_module.Stub(*replies))
            return servers[-1]

    with models.override_allow_model_requests(True):
        yield Make()
    for server in servers:
        server.close()
