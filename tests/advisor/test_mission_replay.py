"""A recorded mission, replayed, is the same mission."""

import json

import numpy as np
import pytest

from coral.advisor.registry import make_advisor
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.world.world import load_world

pytestmark = pytest.mark.wing("coral.erring")

CFG = MissionCfg(time_limit_s=14.0, latency="fixed:2", record=RecordCfg(pictures=False, frames=False))


def fly(spec, folder):
    advisor = make_advisor(spec, rules=REEF_RULES, rng=np.random.default_rng([0, 7]))
    return Mission(load_world("l1"), CFG, advisor, folder).run()


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """The folder of a mission with failures, and its result."""
    folder = tmp_path_factory.mktemp("recorded") / "first"
    return folder, fly("sloppy:malformed=0.5:heuristic", folder)


def test_a_recorded_mission_with_failures_replays_to_the_same_metrics(recorded, tmp_path):
    folder, first = recorded
    second = fly(f"replay:{folder}", tmp_path / "second")
    lines = (folder / "attempts.jsonl").read_text().splitlines()
    assert {json.loads(line)["verdict"] for line in lines} > {"accepted"}
    assert first["collisions"] == 0
    for name in ("trajectory.csv", "attempts.jsonl"):
        assert (tmp_path / "second" / name).read_bytes() == (folder / name).read_bytes()
    found, again = (json.loads((run / "metrics.json").read_text()) for run in (folder, tmp_path / "second"))
    by, by_again = found.pop("decided_by"), again.pop("decided_by")
    assert again == found
    assert by["advisor"] > 0
    assert by_again == {**by, "advisor": 0, "recording": by["advisor"]}  # whose answers they were is not forgotten
    assert second["decided_by"] == by_again


def test_a_question_that_was_not_recorded_is_named(recorded, tmp_path):
    lines = (recorded[0] / "attempts.jsonl").read_text().splitlines()
    (tmp_path / "short.jsonl").write_text("\n".join(lines[:1]) + "\n")
    result = fly(f"replay:{tmp_path / 'short.jsonl'}", tmp_path / "second")
    assert result["fallbacks"] >= 1
    assert "not-recorded" in (tmp_path / "second" / "attempts.jsonl").read_text()
