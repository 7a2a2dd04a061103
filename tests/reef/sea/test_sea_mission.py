import csv
import errno
import json
import math
import os
from dataclasses import replace

import numpy as np
import pytest
from voyage import WORLD, Voyage

from coral.advisor.clock import WallClock
from coral.reef.decide.answers import Mark, MissionAnswer
from coral.reef.drive.pd import PdController
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.map.localization import LocalizationCfg
from coral.reef.mission.metrics import DEFINITIONS, OWN_MAP, TRUTH
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.word_judge import instructed
from coral.reef.recordings.find_recording import find_recording
from coral.reef.sea.saved_survey import load_survey
from coral.reef.sea.survey_file import SurveyArea
from coral.reef.simulation.noise import PoseDrift, SensorNoiseCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.world import ReefWorld
from coral.runs import read_events, read_rows
from reference import texts


def events(folder, *names):
    return [event for event in read_events(folder / "events.jsonl") if event["event"] in names]


@pytest.fixture(scope="module")
def surveyed(tmp_path_factory):
    """A survey of 20 s, and its result; read only."""
    folder = tmp_path_factory.mktemp("surveyed") / "run"
    voyage = Voyage(folder)
    return folder, voyage, voyage.run()


def test_a_survey_drives_covers_and_leaves_a_run_folder(surveyed):
    folder, voyage, result = surveyed
    assert result["clusters_covered"] >= 1
    assert (result["collisions"], result["late_ticks"], result["judged_by"]) == (0, 0, TRUTH)
    assert result["distance_m"] > 5.0
    stored = json.loads((folder / "metrics.json").read_text())
    assert stored["ticks"] == result["ticks"] >= 199
    assert {"config.yaml", "world.yaml", "trajectory.csv", "judge.csv"} <= {p.name for p in folder.iterdir()}
    assert set(stored) <= set(DEFINITIONS)
    for event in read_events(folder / "events.jsonl"):
        assert [
            key
            for key in event
            if key not in ("step", "t", "event") and f"`{key}`" not in texts.SURVEY_EVENTS[event["event"]]
        ] == []
    assert voyage.link.report().mode == "POSHOLD"
    assert voyage.link.report().armed  # never disarmed unless asked
    assert voyage.camera.attitude() == CameraAttitude(height=1.0)  # eyes would be told what is measured


def test_the_age_of_pictures_is_told(tmp_path):
    voyage = Voyage(tmp_path / "run", time_limit_s=3.0)
    voyage.camera.late_s = 0.08  # eyes take their time
    assert voyage.run()["picture_age_ms_median"] == pytest.approx(80.0, abs=0.1)


def test_time_of_answers_counts_from_the_surveys_beginning(tmp_path):
    voyage = Voyage(tmp_path / "run", time_limit_s=1.0)
    voyage.mission.clock = WallClock()
    voyage.mission.clock._start_s -= 100.0
    voyage.run()
    assert voyage.mission.clock.now() < 50.0


def test_the_same_seed_gives_the_same_voyage(surveyed, tmp_path):
    Voyage(tmp_path / "run", time_limit_s=5.0).run()
    again = (tmp_path / "run" / "trajectory.csv").read_bytes()
    assert again.count(b"\n") > 40
    assert (surveyed[0] / "trajectory.csv").read_bytes().startswith(again)


def test_without_truth_the_vehicles_own_map_judges(tmp_path):
    voyage = Voyage(tmp_path / "run", known=False, time_limit_s=8.0)
    result = voyage.run()
    assert (result["judged_by"], result["collisions"]) == (OWN_MAP, None)
    near = [track for track in voyage.mission.belief.tracks if not track.far]
    assert result["clusters_total"] == len(near) > 0
    assert result["clusters_covered"] == sum(track.visited for track in near)
    assert (result["inspected"], result["position_error_m"], result["odometry_error_m"]) == (None, None, None)
    assert (result["corrected_m"], result["position_sigma_m"]) == (0.0, 0.0)
    with open(tmp_path / "run" / "trajectory.csv") as lines:
        assert "est_x" not in next(csv.reader(lines))


def test_a_vehicle_that_is_called_home_ends_at_the_start(tmp_path):
    voyage = Voyage(tmp_path / "run", time_limit_s=120.0, known=False)
    away = []
    start = voyage.area.start

    def call():
        away.append(math.dist(voyage.link.true_pose()[:2], start[:2]))
        voyage.words.say("home", "ROS 2")

    result = voyage.on(120, call).run()
    assert result["end_reason"] == "back at the start: the operator's word (ROS 2)"
    assert away[0] > 2.0
    assert math.dist(voyage.link.true_pose()[:2], start[:2]) < 1.5
    assert [event["source"] for event in events(tmp_path / "run", "goal")][-1] == "home"
    assert voyage.link.report().mode == "POSHOLD"


@pytest.fixture(scope="module")
def interrupted(tmp_path_factory):
    """A survey that is held by the operator from 6 s to 10 s, blind from 15 s to 19 s and cut off from 24 s to 27 s."""
    folder = tmp_path_factory.mktemp("interrupted") / "run"
    voyage = Voyage(folder, time_limit_s=31.0)
    voyage.on(60, lambda: voyage.words.say("hold", "page")).on(100, lambda: voyage.words.say("resume", "page"))
    voyage.on(150, lambda: setattr(voyage.camera, "blind", True))
    voyage.on(190, lambda: setattr(voyage.camera, "blind", False))
    report = voyage.link.report
    frozen = {}

    def cut():
        frozen["report"] = report()
        voyage.link.report = lambda: frozen["report"]

    voyage.on(240, cut).on(270, lambda: setattr(voyage.link, "report", report))
    voyage.run()
    return folder, voyage.states


def test_the_operators_hold_stops_within_a_second_and_resume_goes_on(interrupted):
    folder, states = interrupted
    assert (states[59], states[60], states[105]) == ("surveying", "holding", "surveying")
    rows = list(read_rows(folder / "trajectory.csv"))
    assert all(abs(float(row["u"])) < 0.03 for row in rows[70:99])
    assert float(rows[115]["u"]) > 0.1


YARD = ReefWorld.model_validate(
    {
        "name": "yard",
        "size_m": [14.0, 10.0],
        "start": {"x": 2.0, "y": 5.0},
        "things": [{"name": "tyre", "kind": "tyre", "x": 6.0, "y": 5.0}],
        "mission": {
            "instruction": "Inspect the tyre and say what it is.",
            "time_s": 40.0,
            "conditions": [{"kind": "inspected", "of": ["tyre"]}, {"kind": "answered", "right": ["tyre"]}],
        },
    }
)


def to_the_tyre(told):
    def rules(facts, rejections):
        told.append(facts["mission"]["instruction"])
        dots = facts["centroids"]
        if any(dot["visited"] for dot in dots):
            return MissionAnswer(done=True, answer="a tyre", marks=(Mark(dot=dots[0]["index"], label="tyre"),))
        if dots and dots[0]["path_m"] is not None:
            return MissionAnswer(selected_centroid_index=dots[0]["index"])
        return MissionAnswer(waypoint={"forward_m": 2, "left_m": 0})

    return {"reef-mission": rules}


def yard(folder, told, **more):
    return Voyage(folder, world=YARD, rules=to_the_tyre(told), cfg=instructed(MissionCfg(), YARD.mission), **more)


def test_a_mission_in_words_is_judged_in_a_simulated_reef(tmp_path):
    told = []
    result = yard(tmp_path / "run", told, time_limit_s=40.0).run()
    assert result["success"], result["conditions"]
    assert (result["answer"], set(told)) == ("a tyre", {YARD.mission.instruction})
    assert [e["text"] for e in events(tmp_path / "run", "instruction")] == [YARD.mission.instruction]


def test_an_instruction_changed_at_sea_is_in_the_next_question_and_nobody_judges_it(tmp_path):
    told = []
    voyage = yard(tmp_path / "run", told, time_limit_s=40.0)
    result = voyage.on(20, lambda: voyage.mission.pilot.instruct("Say what lies there.", "keyboard")).run()
    assert told[-1] == "Say what lies there."
    assert (result["success"], result["answer"]) == (None, "a tyre")
    assert [e["by"] for e in events(tmp_path / "run", "instruction")] == ["start", "keyboard"]


def test_a_survey_without_an_instruction_has_none_to_change(tmp_path):
    voyage = Voyage(tmp_path / "run", time_limit_s=1.0)
    assert not voyage.mission.pilot.instruct("Find the net.", "keyboard")
    voyage.run()


def test_the_configured_driver_drives(tmp_path):
    voyage = Voyage(tmp_path / "run", time_limit_s=8.0, cfg=MissionCfg(driver="pd"))
    result = voyage.run()
    assert isinstance(voyage.mission.robot.driver.driver, PdController)
    assert result["distance_m"] > 2.0


def test_a_baseline_decides_in_place_of_the_advisor(tmp_path):
    voyage = Voyage(tmp_path / "run", time_limit_s=4.0, cfg=MissionCfg(decider="nearest"))
    assert voyage.mission.pilot.consultation.advisor.name == "nearest"
    voyage.run()


def test_the_localizer_corrects_a_drifting_position(tmp_path):
    """The same drift with and without it; the guard and the map get the corrected poses."""

    def errors(known, time_limit_s):
        drift = PoseDrift(SensorNoiseCfg(drift_xy=0.06, drift_theta=0.004), np.random.default_rng(5))
        folder = tmp_path / f"{known.drift_xy}"
        result = Voyage(folder, time_limit_s=time_limit_s, cfg=MissionCfg(localization=known), drift=drift).run()
        return result["position_error_m"], result["odometry_error_m"]

    left_alone = errors(LocalizationCfg(), 8.0)
    assert left_alone[0] == pytest.approx(left_alone[1], abs=0.01)
    corrected = errors(LocalizationCfg(drift_xy=0.06, drift_theta=0.004), 30.0)
    assert corrected[0] < 0.75 * corrected[1]


def test_the_survey_ends_when_the_truth_is_covered_unless_told_otherwise(tmp_path):
    for stops in (True, False):
        cfg = MissionCfg(stop_when_covered=stops)
        voyage = Voyage(tmp_path / str(stops), time_limit_s=4.0, cfg=cfg)
        voyage.on(20, lambda truth=voyage.mission.record.truth: truth.judge.covered.update(range(len(WORLD.clusters))))
        result = voyage.run()
        assert result["end_reason"] == ("coverage complete" if stops else "time limit")


def test_a_stop_ends_the_survey_holding(tmp_path):
    voyage = Voyage(tmp_path / "run")
    result = voyage.on(30, lambda: voyage.words.say("stop", "SIGTERM")).run()
    assert result["end_reason"] == "stopped by the operator (SIGTERM)"
    assert voyage.link.report().mode == "POSHOLD"


def test_a_blind_camera_stops_the_vehicle_within_a_second_and_it_recovers(interrupted):
    _, states = interrupted
    assert (states[149], states[159], states[205]) == ("surveying", "holding", "surveying")


def test_a_lost_link_holds_and_the_survey_goes_on_when_it_is_back(interrupted):
    folder, states = interrupted
    assert (states[239], states[249], states[305]) == ("surveying", "holding", "surveying")
    told = [event["ends_when"] for event in events(folder, "awaited") if event["state"] == "holding"]
    assert told[-1:] == ["continues when the cause has been gone for 2 s, or on your word"]


@pytest.mark.parametrize("turns", [0.9, -0.9])
def test_a_twisted_tether_is_unwound_before_it_holds_the_vehicle(tmp_path, turns):
    voyage = Voyage(tmp_path / "run", time_limit_s=18.0, tether_turns=1.0)
    voyage.on(20, lambda: setattr(voyage.link, "_turned", turns * math.tau))
    twists = {}
    for tick in (25, 150):
        voyage.on(tick, lambda tick=tick: twists.update({tick: voyage.link.report().tether_turns}))
    voyage.run()
    assert 0.4 < abs(twists[25]) < 0.95
    assert abs(twists[150]) < 0.4
    assert [event["turns"] for event in events(tmp_path / "run", "unwind")] == [pytest.approx(turns, abs=0.05)]
    assert "holding" not in voyage.states


def test_the_way_home_leads_back_to_the_start(tmp_path):
    voyage = Voyage(tmp_path / "run", time_limit_s=60.0)
    report = voyage.link.report
    voyage.on(70, lambda: setattr(voyage.link, "report", lambda: replace(report(), battery_fraction=0.1)))
    result = voyage.run()
    assert result["end_reason"] == "back at the start: battery at 10%"
    start, here = voyage.area.start, voyage.link.true_pose()
    assert np.hypot(here.x - start.x, here.y - start.y) < 1.2
    assert all(event["t"] < 7.5 for event in events(tmp_path / "run", "question"))


def test_the_vehicle_keeps_out_of_where_it_must_not_go(tmp_path):
    start = WORLD.start
    x, y = start.x + 3.0, start.y
    wall = ((x, y - 1.5), (x + 1.0, y - 1.5), (x + 1.0, y + 1.5), (x, y + 1.5))
    border = SurveyArea.of_world(WORLD)
    area = SurveyArea("fenced", WORLD.size_m, Pose(start.x, start.y, start.theta), border.fence, (("wall", wall),))
    voyage = Voyage(tmp_path / "run", area=area, time_limit_s=15.0)
    result = voyage.run()
    rows = list(read_rows(tmp_path / "run" / "trajectory.csv"))
    assert all(not area.breach(float(row["x"]), float(row["y"])) for row in rows)
    assert result["distance_m"] > 4.0
    assert events(tmp_path / "run", "limit") == []


def test_a_full_disk_stops_the_recording_and_not_the_vehicle(tmp_path):
    voyage = Voyage(tmp_path / "run", time_limit_s=7.0)

    def full(*values, **fields):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "trajectory.csv")

    voyage.on(30, lambda: setattr(voyage.mission.record.writer, "row", full))
    result = voyage.run()
    assert "No space left" in result["recording_failure"]
    assert result["ticks"] > 60
    assert voyage.states[60] == "surveying"
    rows = (tmp_path / "run" / "trajectory.csv").read_text().splitlines()
    assert len(rows) == 31


def test_what_the_autopilot_says_is_recorded(surveyed):
    texts = [event["text"] for event in events(surveyed[0], "vehicle_text")]
    assert "GUIDED, armed" in texts


@pytest.mark.parametrize("where", ["pilot", "link"])
def test_a_failure_of_the_loop_leaves_the_vehicle_holding(tmp_path, where):
    voyage = Voyage(tmp_path / "run")

    def broken(*_):
        raise ValueError("broken")

    target, name = {"pilot": (lambda: voyage.mission.pilot, "sense"), "link": (lambda: voyage.link, "command")}[where]
    voyage.on(20, lambda: setattr(target(), name, broken))
    with pytest.raises(ValueError, match="broken"):
        voyage.run()
    assert voyage.link.report().mode == "POSHOLD"


def test_the_map_of_a_survey_that_is_killed_under_way_is_there(tmp_path):
    class Killed(BaseException):
        pass

    def kill():
        raise Killed

    folder, cfg, areas = tmp_path / "run", MissionCfg(), []
    voyage = Voyage(folder, time_limit_s=30.0).on(40, lambda: areas.append((folder / "survey.npz").exists()))
    voyage.mission._finish = dict  # nothing is written any more
    voyage.on(80, kill)
    with pytest.raises(Killed):
        voyage.run()
    saved, _ = load_survey(folder, WORLD.size_m, cfg.simulator.camera, cfg.map, cfg.belief)
    assert areas == [False]  # nothing is due before 5 s
    assert saved.map.explored.sum() > 0.5 * voyage.mission.belief.map.explored.sum() > 0


def test_a_resumed_survey_goes_on_with_the_saved_map(tmp_path, surveyed):
    cfg = MissionCfg(localization=LocalizationCfg(drift_xy=0.06, drift_theta=0.004))
    saved, _ = load_survey(surveyed[0], WORLD.size_m, cfg.simulator.camera, cfg.map, cfg.belief)
    before, known = {track.index for track in saved.tracks if not track.far}, saved.map.explored.sum()
    voyage = Voyage(tmp_path / "run", belief=saved, cfg=cfg, time_limit_s=8.0)
    result = voyage.run()
    belief = voyage.mission.belief
    assert before <= {track.index for track in belief.tracks}
    assert belief.map.explored.sum() >= known
    assert (result["collisions"], result["position_error_m"] < 0.1) == (0, True)


@pytest.mark.parametrize("known", [True, False])
def test_a_resumed_survey_finds_itself_on_the_saved_map_or_says_that_it_did_not(tmp_path, surveyed, known):
    cfg = MissionCfg(localization=LocalizationCfg(drift_xy=0.06, drift_theta=0.004))
    saved, landmarks = load_survey(surveyed[0], WORLD.size_m, cfg.simulator.camera, cfg.map, cfg.belief)
    assert len(landmarks.centres) >= 4
    if not known:
        landmarks._state[3:] = landmarks._state[3:][::-1]  # those of another reef
    off = (0.4, -0.3, 0.1)
    voyage = Voyage(tmp_path / "run", belief=saved, landmarks=landmarks, off=off, cfg=cfg, time_limit_s=12.0)
    result = voyage.run()
    told = events(tmp_path / "run", "place")
    assert told[-1]["landmarks"] == len(landmarks.centres)
    assert (told[-1]["recognised"] > 0) is known
    assert (result["position_error_m"] < 0.2) is known
    assert told[-1]["theta"] == pytest.approx(-off[2] if known else 0.0, abs=0.05)


def test_pictures_with_poses_are_kept_so_that_the_dive_can_be_mapped_again(surveyed):
    folder = surveyed[0]
    kept = list(find_recording(folder).keyframes())
    assert len(kept) in (40, 41)  # two a second
    rows = list(read_rows(folder / "trajectory.csv"))
    true = rows[round(10 * kept[20].t)]
    assert kept[20].pose[:2] == pytest.approx((float(true["x"]), float(true["y"])), abs=0.1)
