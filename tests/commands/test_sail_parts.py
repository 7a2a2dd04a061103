import math
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from coral.check_line import CheckLine
from coral.commands import sail_parts
from coral.commands.reef_sail import ReefSail
from coral.commands.sail_parts import open_camera, open_parts, read_area, warm_up, watch_sensors
from coral.errors import InputError
from coral.reef.eyes.reef_net import ReefNetEyes
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.resolution import with_sonar
from coral.reef.sea.link import VehicleReport
from coral.reef.vehicle.camera import CameraCfg

SURVEY = "format: coral-survey/1\nname: tank\nsize_m: [22, 22]\nstart: {x: 4, y: 5}\ndepth_m: 2.5\n"


@pytest.fixture
def survey(tmp_path):
    def write(more=""):
        path = tmp_path / "tank.yaml"
        path.write_text(SURVEY + more)
        return str(path)

    return write


def test_a_world_is_its_own_area():
    area, world, depth = read_area("s1")
    assert (area.name, world.name, depth) == ("s1", "s1", 1.0)


def test_a_survey_file_may_name_a_reef_to_rehearse_in(survey):
    area, world, depth = read_area(survey("rehearse: s1\n"))
    assert (area.name, world.name, depth) == ("tank", "s1", 2.5)
    assert read_area(survey())[1] is None


def test_a_rehearsal_needs_a_reef_of_the_same_size(survey):
    with pytest.raises(InputError, match=r"rehearse: found l1"):
        read_area(survey("rehearse: l1\n"))


@contextmanager
def opened(flags, cfg=None):
    area, world, depth = read_area(flags.area)
    with ExitStack() as stack:
        cfg, camera = open_camera(flags, cfg or MissionCfg(), stack)
        yield open_parts(flags, area, world, cfg, depth, stack, camera)


def test_the_simulated_vehicle_begins_where_the_area_does_and_sees_the_reef():
    with opened(ReefSail(area="s1")) as parts:
        assert parts.proven_simulation
        parts.place()
        pose, start = parts.true_pose(), parts.area.start
        assert math.dist(pose[:2], start[:2]) < 0.05  # a current moves it while it is disarmed
        assert parts.camera.source.read().frame is not None


@pytest.mark.parametrize(
    ("flags", "where"),
    [
        ({"vehicle": "mavlink:carrier:pigeon"}, "--vehicle"),
        ({"vehicle": "bluerov"}, "--vehicle"),
        ({"sonar": "/nowhere/dive.sonar"}, "--sonar"),
        ({"sonar": "udp:fast"}, "--sonar"),
        ({"sonar": "udp:70000"}, "--sonar"),
        ({"camera": "/nowhere/video.mp4"}, "--camera"),
        ({"truth": "mavlink:tcp:127.0.0.1:1"}, "--truth"),
    ],
)
def test_a_wrong_name_is_one_line_with_its_flag(flags, where):
    with pytest.raises(InputError) as error, opened(ReefSail(area="s1", **flags)):
        pass
    assert error.value.where == where


@pytest.mark.parametrize(
    ("vehicle", "place"), [("ros2:sim.yaml", "sim.yaml"), ("ros2:/rov", "/rov"), ("ros2", ""), ("simulated", "")]
)
def test_camera_and_sonar_of_ros_get_the_vehicles_parameters(monkeypatch, vehicle, place):
    given = {}

    def part(group, name, flag):
        def make(*told):
            given[name] = told[3 if name == "camera" else 2]
            return SimpleNamespace(read=lambda: None, close=lambda: None, name=name, view=CameraCfg())

        return make

    link = SimpleNamespace(close=lambda: None)
    monkeypatch.setattr(sail_parts, "has_plugin", lambda group, name: True)
    monkeypatch.setattr(sail_parts, "named_plugin", lambda group, name, flag: lambda place: link)
    real = sail_parts.our_part
    monkeypatch.setattr(sail_parts, "our_part", lambda *told: part(*told) if told[0] == "ros2" else real(*told))
    with opened(ReefSail(area="s1", vehicle=vehicle, camera="ros2:/image", sonar="ros2:/ranges")):
        assert given == {"camera": place, "sonar": place}


def test_the_lens_of_a_real_camera_is_that_of_its_file_or_else_the_one_that_is_found(monkeypatch, tmp_path):
    given = []

    def make(topic, latency_s, view, place, known):
        given.append((view, known))
        found = CameraCfg(width=32, height=24) if known is None else known.view
        return SimpleNamespace(view=found, read=lambda: None, close=lambda: None, name=topic)

    monkeypatch.setattr(sail_parts, "our_part", lambda *told: make)
    file = tmp_path / "camera.yaml"
    file.write_text("width: 64\nheight: 48\nhfov_deg: 70\n")
    with ExitStack() as stack:
        cfg, camera = open_camera(ReefSail(area="s1", camera="ros2:/image"), MissionCfg(), stack)
        assert (cfg.simulator.camera.width, camera.source.name) == (32, "/image")
        cfg, _ = open_camera(ReefSail(area="s1", camera="ros2:/image", lens=file), MissionCfg(), stack)
        assert cfg.simulator.camera.hfov_deg == 70.0
        assert given[0] == (CameraCfg(), None)
        assert given[1][0] == given[1][1].view == cfg.simulator.camera
        assert open_camera(ReefSail(area="s1"), MissionCfg(), stack) == (MissionCfg(), None)


def test_the_configured_network_looks_at_the_cameras_pictures():
    with opened(ReefSail(area="s1"), MissionCfg(perception="painted")) as parts:
        assert isinstance(parts.camera.eyes, ReefNetEyes)
        assert parts.camera.source.read().frame.rgb is not None  # painted, for there is no other way to see


@pytest.mark.parametrize("eyes", ["exact", "rgb"])
def test_what_finds_oysters_in_real_pictures_is_warmed_up_as_well(eyes, monkeypatch):
    monkeypatch.setattr(sail_parts, "WARM_UP_S", 0.3)
    warm_up(replace(MissionCfg(), perception=eyes))


def test_a_survey_without_a_reef_has_nothing_to_simulate(survey):
    with pytest.raises(InputError, match="rehearse: WORLD"), opened(ReefSail(area=survey())):
        pass


def test_a_simulated_sonar_hears_the_reef():
    with opened(ReefSail(area="s1", sonar="simulated"), with_sonar(MissionCfg())) as parts:
        parts.place()
        for _ in range(200):
            if parts.sonar.latest is not None:
                break
            parts.sonar._closing.wait(0.01)
        assert np.isfinite(parts.sonar.latest.value.ranges).any()
    with opened(ReefSail(area="s1")) as parts:
        assert parts.sonar is None


def test_a_real_sonar_is_listened_to_on_its_port():
    pytest.importorskip("wlsonar")
    with opened(ReefSail(area="s1", sonar="udp:127.0.0.1:0")) as parts:
        assert parts.sonar.source.port > 0
        assert parts.sonar.latest is None


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

        monkeypatch.setattr(sail_parts, "time", SimpleNamespace(monotonic=lambda: now[0], sleep=sleep))
        monkeypatch.setattr(sail_parts, "preflight_list", lines)
        link = SimpleNamespace(report=VehicleReport)
        parts = SimpleNamespace(
            link=link, camera=SimpleNamespace(rate_hz=10.0), sonar=None, area=None, place=lambda: None
        )
        return watch_sensors(parts, None, None), now[0] - 100.0

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
