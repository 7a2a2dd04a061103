"""One mission of a campaign: what it returns and what its folder keeps."""

import dataclasses
import json

import pytest

from coral.advisor.question import Picture
from coral.errors import RunError
from coral.reef.mission.campaign_episode import run_episode
from coral.reef.mission.metrics import compute_metrics
from coral.reef.mission.mission_cfg import MissionCfg

pytestmark = pytest.mark.wing("coral.erring")

CFG = MissionCfg(time_limit_s=10.0, latency="fixed:1")
NAMED = {"variant": "full", "advisor": "sloppy:malformed=0.7:heuristic", "seed": 4}


@pytest.fixture(scope="module")
def episode(pond, tmp_path_factory):
    folder = tmp_path_factory.mktemp("campaign") / "run"
    return run_episode(pond, CFG, folder, **NAMED), folder


def test_the_result_holds_what_the_tables_need(pond, episode):
    result, folder = episode
    metrics = compute_metrics(folder)
    assert {key: result[key] for key in metrics} == metrics
    assert "wall_time_s" in result
    assert (result["topology"], result["fallback"]) == (pond.topology, CFG.pilot.fallback)
    assert len(result["covered_at_s"]) == result["clusters_covered"] > 0
    assert result["covered_at_s"] == sorted(result["covered_at_s"])


def test_no_pictures_or_report_are_kept_and_of_the_frames_the_final_map_alone(episode):
    _, folder = episode
    kept = {path.name for path in folder.iterdir()}
    assert {"metrics.json", "events.jsonl", "trajectory.csv", "world.yaml", "config.yaml"} <= kept
    assert [path.name[6:] for path in (folder / "frames").iterdir()] == ["_map.png"]
    assert not kept & {"pictures", "report.html", "map.png", "mission.mp4"}


def test_an_advisor_with_eyes_gets_pictures_that_are_kept_with_the_question(pond, tmp_path):
    drawn = Picture(name="map", png=b"\x89PNG of the map")
    run_episode(
        pond, dataclasses.replace(CFG, time_limit_s=2.0), tmp_path / "run", draw=lambda belief: (drawn,), **NAMED
    )
    (kept,) = (tmp_path / "run" / "pictures").iterdir()
    assert kept.read_bytes() == drawn.png
    lines = (tmp_path / "run" / "events.jsonl").read_text().splitlines()
    shown = [e["pictures"] for e in map(json.loads, lines) if e["event"] == "question"]
    assert shown
    assert all(digests == [drawn.digest] for digests in shown)


def test_an_interrupted_mission_is_no_result(pond, tmp_path):
    def interrupted(belief):
        raise KeyboardInterrupt

    with pytest.raises(RunError, match="stopped by the operator"):
        run_episode(pond, CFG, tmp_path / "run", draw=interrupted, **NAMED)
    last = (tmp_path / "run" / "events.jsonl").read_text().splitlines()[-1]
    assert json.loads(last)["reason"] == "stopped by the operator"
