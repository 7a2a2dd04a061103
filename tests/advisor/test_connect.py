import asyncio

import pytest

from coral.advisor.connect import KEYS, connect
from coral.advisor.model_cfg import ModelCfg

SECRET = "k" * 20


async def connected(provider, url=""):
    model, client = connect(provider, "some-model", url, ModelCfg())
    await client.aclose()
    return model


@pytest.mark.parametrize("provider", [*KEYS, "local"])
def test_a_model_is_connected_without_sending_anything(monkeypatch, provider):
    for names in KEYS.values():
        monkeypatch.setenv(names[0], SECRET)
    model = asyncio.run(connected(provider, "http://127.0.0.1:1/v1"))
    assert model.model_name == "some-model"


@pytest.mark.parametrize("provider", ["openai", "anthropic", "local"])
def test_the_client_library_retries_nothing_by_itself(monkeypatch, provider):
    for names in KEYS.values():
        monkeypatch.setenv(names[0], SECRET)
    assert asyncio.run(connected(provider, "http://127.0.0.1:1/v1")).client.max_retries == 0
