"""Data of the time slider: complete, bounded in size, safe inside a page."""

import base64
import json
import shutil

import cv2
import numpy as np
import pytest

from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.pictures.questions import question_pictures
from coral.reef.world.world import Cluster, Oyster, ReefWorld, Start
from coral.view import time_slider
from coral.view.decisions import decisions
from coral.view.run import RunFolder


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Twelve seconds before a bed of oysters."""
    oysters = tuple(
        Oyster(x=6.0 + 0.3 * k, y=5.0, z=0.05, radii=(0.12, 0.09, 0.06), rpy=(0.0, 0.0, 0.0)) for k in range(5)
    )
    world = ReefWorld(
        name="</script><b>",
        size_m=(12.0, 10.0),
        start=Start(x=2.0, y=5.0, theta=0.0),
        clusters=(Cluster(name="bed", oysters=oysters),),
    )
    folder = tmp_path_factory.mktemp("slider") / "run"
    cfg = MissionCfg(time_limit_s=12.0, latency="fixed:2", stop_when_covered=False)
    Mission(world, cfg, RuleAdvisor(REEF_RULES), folder, draw=question_pictures).run()
    return RunFolder.read(folder)


def test_the_data_follow_the_run_and_end_no_script(run):
    made = decisions(run)
    text = time_slider.script_data(run, made, {})
    assert "<" not in text
    data = json.loads(text)
    assert data["end"] == pytest.approx(12.0, abs=0.11)
    assert len(data["t"]) == len(data["x"]) == len(data["gx"])
    assert [d["n"] for d in data["decisions"]] == [d.number for d in made]
    assert data["frames"][-1]["t"] <= data["end"]
    assert all(value.startswith("data:image/png") for f in data["frames"] for key, value in f.items() if key != "t")


def test_fewer_snapshots_are_kept_when_the_page_would_grow_too_large(run, monkeypatch):
    every = json.loads(time_slider.script_data(run, [], {}))["frames"]
    largest = max(sum(len(v) for v in frame.values() if isinstance(v, str)) for frame in every)
    monkeypatch.setattr(time_slider, "FRAME_BUDGET", 3 * largest)
    few = json.loads(time_slider.script_data(run, [], {}))["frames"]
    assert 1 <= len(few) < len(every)
    assert few[-1]["t"] == every[-1]["t"]


def test_pictures_shrink_until_they_fit(run, monkeypatch):
    def widths(pictures):
        data = [base64.b64decode(url.split(",")[1]) for url in pictures.values()]
        return [cv2.imdecode(np.frombuffer(one, np.uint8), cv2.IMREAD_COLOR).shape[1] for one in data]

    made = decisions(run)
    large = time_slider.shown_pictures(run, made)
    assert large
    monkeypatch.setattr(time_slider, "PICTURE_BUDGET", sum(map(len, large.values())) // 3)
    small = time_slider.shown_pictures(run, made)
    assert max(widths(small)) < max(widths(large))


def test_colours_are_in_the_page_where_the_run_kept_them(run, tmp_path):
    copied = tmp_path / "run"
    shutil.copytree(run.path, copied)
    step = run.frame_steps[0]
    cv2.imwrite(str(copied / "frames" / f"{step:06d}_rgb.jpg"), np.full((12, 16, 3), 90, np.uint8))
    frames = json.loads(time_slider.script_data(RunFolder.read(copied), [], {}))["frames"]
    assert frames[0]["rgb"].startswith("data:image/webp")
    assert "rgb" not in frames[-1]
