from dataclasses import replace

import numpy as np
import pytest

from coral.check_line import blocking
from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.word_judge import with_instruction
from coral.reef.pilot.checks import UnfitMeasurement
from coral.reef.sea.checklist import Equipment, StampRates, preflight_list
from coral.reef.sea.latest_reading import LatestReading, LatestShot, Shot
from coral.reef.sea.link import VehicleReport
from coral.reef.sea.safety import SafetyCfg, SailCfg
from coral.reef.sea.survey_file import SurveyArea
from coral.reef.simulation.simulator import SimulatorCfg
from coral.reef.vehicle.range_image import RangeImage
from coral.reef.vehicle.sensing import Stamped
from coral.reef.world.geometry import Frame, Pose

AREA = SurveyArea("tank", (20.0, 10.0), Pose(2.0, 5.0, 0.0), ((0, 0), (20, 0), (20, 10), (0, 10)))
GEAR = Equipment(
    vehicle="mavlink:udp:192.168.2.1:14550",
    pose_source="DVL A50",
    advisor="heuristic",
    folder="runs/tank-001",
    heading_trusted=True,
)
MISSION = MissionCfg(simulator=SimulatorCfg(sonar=SonarCfg(width=8, height=4)))
NOW = 100.0
FINE = VehicleReport(
    pose=Pose(0.0, 0.0, 0.0),
    pose_stamp_s=NOW,
    has_position=True,
    covariance=np.diag([0.0001, 0.0004, 0.01]),
    yaw_rad=0.1,
    depth_m=1.0,
    depth_stamp_s=NOW,
    velocity=(0.0, 0.0, 0.0),
    velocity_stamp_s=NOW,
    heartbeat_age_s=0.3,
    battery_fraction=0.9,
    battery_v=16.0,
    autopilot="ArduSub 4.5.3",
    mode="MANUAL",
)


class Source:
    name = "simulated, 160x120"

    def __init__(self, labelled=True, rgb=None):
        self.rgb, seen = rgb, np.zeros((6, 8), np.uint8)
        depth, instances = np.ones((6, 8), np.float32), np.full((6, 8), -1, np.int32)
        self.frame = Frame(depth, seen, instances, rgb) if labelled else None

    def read(self):
        return Shot(stamp_s=NOW, rgb=self.rgb, frame=self.frame)

    def close(self): ...


def listed(report=FINE, labelled=True, rgb=None, shots=1, sonar=None, gear=GEAR, safety=None, words=""):
    rates = StampRates()
    for k in range(21):
        rates.note(NOW - 2.0 + 0.125 * k, replace(report, pose_stamp_s=NOW - 2.0 + 0.125 * k))
    camera = LatestShot(Source(labelled, rgb), threaded=False)
    for _ in range(shots):
        camera.step()
    cfg = SailCfg(mission=with_instruction(MISSION, words, None) if words else MISSION, safety=safety or SafetyCfg())
    lines = preflight_list(NOW, report, rates, camera, AREA, cfg, gear, sonar)
    return {line.subject: line for line in lines}, lines


def test_a_line_says_source_rate_and_covariance():
    by_name, lines = listed()
    assert str(by_name["pose"]) == "  pose: DVL A50, 8 Hz, standard deviation 0.02 m"
    assert str(by_name["sonar"]) == "! sonar: none - obstacles from the camera alone"
    assert "ArduSub 4.5.3" in by_name["vehicle"].text
    assert blocking(lines) == []


def test_the_instruction_is_one_line_that_says_who_judges():
    assert "instruction" not in listed()[0]
    words = "Find the net.\nKeep off."
    assert str(listed(words=words)[0]["instruction"]) == "  instruction: Find the net. Keep off. - nobody judges it"
    judged = listed(words=words, gear=replace(GEAR, judged=True))[0]["instruction"]
    assert judged.text.endswith("judged by the truth of the simulated reef")


def test_a_height_is_told_and_missed_where_its_loss_would_act():
    assert listed(replace(FINE, altitude_m=1.24))[0]["depth"].text.endswith("1.2 m above the floor")
    missed = listed(safety=SafetyCfg(on_floor_lost="hold"))[0]["depth"]
    assert (missed.level, "its limit cannot act" in missed.text) == ("lacking", True)


def test_a_resumed_survey_says_where_the_vehicle_must_be():
    assert "map" not in listed()[0]
    told = listed(gear=replace(GEAR, resumed="runs/a, 7 landmarks"))[0]["map"]
    assert "runs/a, 7 landmarks: the vehicle must now be about (" in told.text


@pytest.mark.parametrize(
    ("change", "subject"),
    [
        ({"has_position": False}, "pose"),
        ({"pose_stamp_s": NOW - 3.0}, "pose"),
        ({"heartbeat_age_s": float("inf")}, "vehicle"),
        ({"velocity": None}, "velocity"),
        ({"depth_m": None}, "depth"),
        ({"leak": True}, "leak"),
        ({"battery_fraction": 0.1}, "battery"),
    ],
)
def test_what_makes_a_survey_impossible_blocks_it(change, subject):
    _, lines = listed(replace(FINE, **change))
    assert [line.subject for line in blocking(lines)] == [subject]


@pytest.mark.parametrize(
    ("change", "subject", "told"),
    [
        ({"battery_fraction": None, "battery_v": None}, "battery", "cannot act"),
        ({"yaw_rad": 1.5}, "heading", "compass"),
    ],
)
def test_what_is_missing_is_told_with_its_meaning(change, subject, told):
    by_name, lines = listed(replace(FINE, **change))
    assert by_name[subject].level == "lacking"
    assert told in by_name[subject].text
    assert blocking(lines) == []


def test_a_real_camera_without_eyes_arms_nothing_and_says_what_helps():
    by_name, lines = listed(labelled=False)
    assert [line.subject for line in blocking(lines)] == ["labels"]
    assert "add --perception rgb or FILE.onnx" in by_name["labels"].text


def test_a_black_picture_arms_nothing():
    by_name, lines = listed(rgb=np.zeros((6, 8, 3), np.uint8))
    assert blocking(lines) == [by_name["camera"]]
    assert "black (hardly a pixel is brighter than 0 of 255) - is the lens covered" in by_name["camera"].text


def test_a_rate_that_is_not_known_is_no_slow_one():
    camera = LatestShot(Source(), threaded=False)
    camera.step()
    lines = preflight_list(NOW, FINE, StampRates(), camera, AREA, SailCfg(), GEAR)
    by_name = {line.subject: str(line) for line in lines}
    assert by_name["pose"] == "  pose: DVL A50, rate not known, standard deviation 0.02 m"
    assert "rate not known" in by_name["camera"]
    assert "0 Hz" not in "".join(by_name.values())


def test_a_burst_after_a_gap_is_no_rate():
    rates = StampRates()
    for k in range(40):
        rates.note(NOW + 0.0003 * k, replace(FINE, velocity_stamp_s=NOW + 0.0003 * k))
    assert rates.rate_hz("velocity") is None


def test_a_camera_without_pictures_blocks():
    _, lines = listed(shots=0)
    assert [line.subject for line in blocking(lines)] == ["camera"]


class Echoes:
    name = "Sonar 3D-15 at UDP port 4747, from 192.168.2.96"

    def __init__(self, *found):
        self.found = list(found)

    def read(self):
        found = self.found.pop(0)
        if isinstance(found, Exception):
            raise found
        return found

    def close(self): ...


def listening(*found, period_s=0.2):
    times = iter(NOW + period_s * k for k in range(10))
    sonar = LatestReading(Echoes(*found), "sonar", clock=lambda: next(times), threaded=False)
    for _ in found:
        sonar.step()
    return sonar


def echo(width=8):
    return Stamped(NOW - 0.1, RangeImage(np.full((4, width), 2.0, np.float32), 90.0, 40.0))


def test_the_sonar_says_sender_size_rate_age_and_what_was_refused():
    by_name, lines = listed(sonar=listening(echo(), UnfitMeasurement("wrong checksum"), *[echo()] * 5))
    assert str(by_name["sonar"]) == (
        "  sonar: Sonar 3D-15 at UDP port 4747, from 192.168.2.96, 8x4, 90 by 40 degrees, 5 Hz, last image 0.1 s old; "
        "refused: wrong checksum 1"
    )
    assert blocking(lines) == []


@pytest.mark.parametrize(
    ("sonar", "told"),
    [
        (listening(), "no image - will not arm"),
        (listening(echo(16), echo(16)), "wrong size"),
    ],
)
def test_a_sonar_that_was_asked_for_and_does_not_fit_blocks(sonar, told):
    by_name, lines = listed(sonar=sonar)
    assert [line.subject for line in blocking(lines)] == ["sonar"]
    assert told in by_name["sonar"].text


def test_a_slow_sonar_is_told():
    by_name, _ = listed(sonar=listening(echo(), echo(), echo(), period_s=0.5))
    assert by_name["sonar"].level == "lacking"
    assert "slow" in by_name["sonar"].text
