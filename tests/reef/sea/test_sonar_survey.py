"""A survey whose range images come as real packets through UDP: blind, and then without any eyes."""

import json
import math

import numpy as np
import pytest
from voyage import Voyage

pytest.importorskip("wlsonar")


class Watched(Voyage):
    """Notes time and true speed at every tick."""

    def tick(self, mission):
        super().tick(mission)
        u, v, _ = mission.report.velocity
        self.speeds.append((mission.t, math.hypot(u, v)))

    speeds = None


@pytest.fixture
def voyage(tmp_path):
    voyage = Watched(tmp_path / "run", sonar=True, time_limit_s=16.0)
    voyage.speeds = []
    yield voyage
    voyage.sonar.close()


def events(tmp_path, kind):
    lines = (tmp_path / "run" / "events.jsonl").read_text().splitlines()
    return [event for event in map(json.loads, lines) if event["event"] == kind]


def test_obstacles_come_from_the_packets_and_the_survey_goes_on_blind(voyage, tmp_path):
    voyage.on(60, lambda: setattr(voyage.camera, "blind", True))
    result = voyage.run()
    assert voyage.sonar.reader.refused == {}
    assert np.array_equal(voyage.sonar.reader.latest.value.ranges, voyage.sonar.last_image.ranges)
    assert voyage.mission.belief.map.layer.obstacle.any()
    assert "camera" in events(tmp_path, "blind")[0]["reason"]
    assert "holding" not in voyage.states
    blind = [speed for t, speed in voyage.speeds if t > 8.0]
    assert max(blind) < 0.35
    assert sum(0.1 * speed for speed in blind) > 1.0
    assert result["collisions"] == 0


def test_without_camera_and_sonar_it_stands_within_a_second(voyage, tmp_path):
    def lose():
        voyage.camera.blind = voyage.sonar.deaf = True

    voyage.on(80, lose).run()
    lost_s = voyage.speeds[79][0]
    held = next(e for e in events(tmp_path, "state") if e["state"] == "holding")
    assert "camera" in held["reason"]
    assert "sonar" in held["reason"]
    assert held["t"] - lost_s <= 0.5
    assert voyage.speeds[79][1] > 0.45
    assert all(speed < 0.05 for t, speed in voyage.speeds if t >= lost_s + 1.0 - 1e-6)


def test_a_deaf_vehicle_with_a_camera_goes_on(voyage, tmp_path):
    voyage.on(60, lambda: setattr(voyage.sonar, "deaf", True)).run()
    assert [event["deaf"] for event in events(tmp_path, "deaf")] == [True]
    assert "holding" not in voyage.states
