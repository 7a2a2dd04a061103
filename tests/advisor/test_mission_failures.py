"""A whole reef mission against a server that fails in every way: it ends normally, and the log names each failure."""

import base64
import json
from dataclasses import replace
from urllib.parse import quote

import pytest

from coral.advisor.model_cfg import ModelCfg
from coral.advisor.models import ModelAdvisor
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.world.world import load_world

NO_RECORD = RecordCfg(pictures=False, frames=False)
HASTY = ModelCfg(attempt_timeout_s=0.3, deadline_s=0.6, max_retries=0, format_repairs=0, backoff_s=0.01, pictures=False)

WRONG = {"forward_m": "far", "left_m": 0, "selected_centroid_index": "the left one"}
FAR_OFF = {"forward_m": 60, "left_m": 0, "selected_centroid_index": 99}


def attempts(folder):
    return [json.loads(line) for line in (folder / "attempts.jsonl").read_text().splitlines()]


def any_answer(stub):
    """A server's good answer to whichever question it is asked, ahead of the robot."""

    def reply(body):
        text = json.dumps(body["messages"])
        index = 0 if "selected_centroid_index" in text else None
        good = (
            {"forward_m": 4, "left_m": 0, "reason": "on"}
            if index is None
            else {"selected_centroid_index": 1, "reason": "on"}
        )
        return stub.completion(json.dumps(good))

    return reply


@pytest.fixture(scope="module")
def reef():
    return load_world("l1")


@pytest.mark.slow
def test_a_mission_survives_every_failure_in_turn(stub, reef, tmp_path):
    huge = stub.completion("x" * 10_000_000)
    server = stub(
        stub.completion("{nonsense"),
        stub.completion(""),
        stub.completion(json.dumps(WRONG)),
        stub.completion(json.dumps(FAR_OFF)),
        stub.error(429),
        stub.error(500),
        stub.DROP,
        stub.SILENCE,
        huge,
        any_answer(stub),
    )
    cfg = MissionCfg(latency="fixed:2", time_limit_s=60.0, stop_when_covered=False, record=NO_RECORD)
    mission = Mission(reef, cfg, ModelAdvisor.local(server.url, "stub", HASTY), tmp_path / "run")
    result = mission.run()
    assert result["end_reason"] in ("coverage complete", "time limit")
    assert result["collisions"] == 0
    assert result["fallbacks"] >= 1
    codes = [a["code"] for a in attempts(tmp_path / "run")]
    assert codes[:2] == ["not-json", "empty"]
    assert codes[2] == "wrong-type"
    assert codes[3] in ("out-of-range", "no-such-centroid")
    assert codes[4:9] == ["http-429", "http-500", "connection", "timeout", "too-large"]
    assert any(a["verdict"] == "accepted" for a in attempts(tmp_path / "run"))


def test_control_goes_on_at_10_hz_while_a_request_hangs(stub, reef, tmp_path):
    server = stub(stub.SILENCE)
    cfg = MissionCfg(latency="measured", time_limit_s=2.0, record=NO_RECORD)
    slow = replace(HASTY, attempt_timeout_s=30.0, deadline_s=30.0)
    mission = Mission(reef, cfg, ModelAdvisor.local(server.url, "stub", slow), tmp_path / "run")
    open_ticks = []

    class Watch:
        def tick(self, mission):
            open_ticks.append((mission.step, mission.pilot.pending))

        def stop_requested(self):
            return ""

    result = mission.run([Watch()])
    # The first question is put after a second of looking about; from then on it is open.
    assert open_ticks == [(k, k > 10) for k in range(1, 21)]
    assert result["distance_m"] > 0.2


def test_no_file_of_a_run_holds_a_key_that_the_server_echoes(stub, reef, tmp_path, monkeypatch):
    key = "sw/ord+fish=1234"
    forms = [key, quote(key, safe=""), base64.b64encode(key.encode()).decode().rstrip("=")]
    monkeypatch.setenv("CORAL_LOCAL_API_KEY", key)

    def echo(body):
        good = json.loads(json.loads(any_answer(stub)(body)[2])["choices"][0]["message"]["content"])
        text = json.dumps({**good, "reason": f"you sent {' '.join(forms)}"})
        return stub.completion(text.replace("sw/", "sw\\/"))

    server = stub(
        stub.completion(f"{forms}"),
        stub.completion(json.dumps({"forward_m": key, "left_m": 0, "selected_centroid_index": key})),
        stub.error(400, f"Incorrect key {key}"),
        stub.error(500, f"Bearer {key}"),
        echo,
    )
    cfg = MissionCfg(time_limit_s=12.0, latency="0", record=RecordCfg(frames=False))
    Mission(reef, cfg, ModelAdvisor.local(server.url, "m", HASTY), tmp_path / "run").run()
    verdicts = [(one["verdict"], one["raw"].count("***")) for one in attempts(tmp_path / "run")]
    assert ("accepted", 3) in verdicts
    assert {verdict for verdict, _ in verdicts} >= {"accepted", "malformed", "unavailable"}
    for file in (path for path in (tmp_path / "run").rglob("*") if path.is_file()):
        for form in forms:
            assert form.encode() not in file.read_bytes(), file.name
