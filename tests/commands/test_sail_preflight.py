"""How long the sensors are watched before arming."""

from types import SimpleNamespace

import pytest

from coral.commands import sail_preflight
from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.sea.checklist import CheckLine
from coral.reef.sea.link import VehicleReport
from coral.reef.sea.safety import SafetyCfg

NO_CAMERA = CheckLine("camera", "no picture yet", "blocking")
LEAK = CheckLine("leak", "water inside the hull", "blocking")


@pytest.fixture
def watched(monkeypatch):
    """Watches with a clock that only sleep advances; returns the lines, and how long that took (s)."""

    def watch(listed):
        now = [100.0]

        def sleep(seconds):
            now[0] += seconds

        def lines(*_):
            return listed(now[0] - 100.0)

        monkeypatch.setattr(sail_preflight, "time", SimpleNamespace(monotonic=lambda: now[0], sleep=sleep))
        monkeypatch.setattr(sail_preflight, "preflight_list", lines)
        link = SimpleNamespace(report=VehicleReport)
        parts = SimpleNamespace(link=link, camera=SimpleNamespace(rate_hz=10.0), sonar=None, place=lambda: None)
        return sail_preflight.watch_sensors(parts, None, SafetyCfg(), None, SonarCfg()), now[0] - 100.0

    return watch


def test_a_sensor_that_comes_late_is_waited_for(watched):
    lines, took_s = watched(lambda t: [NO_CAMERA] if t < 15.0 else [])
    assert lines == []
    assert 15.0 <= took_s < 25.0


def test_a_sensor_that_never_comes_is_told_in_the_end(watched):
    lines, took_s = watched(lambda t: [NO_CAMERA])
    assert lines == [NO_CAMERA]
    assert 30.0 < took_s < 40.0


def test_what_waiting_does_not_mend_is_told_at_once(watched):
    lines, took_s = watched(lambda t: [LEAK])
    assert (lines, took_s < 7.0) == ([LEAK], True)
