"""Who may judge what, and what an episode knows where nobody knows the truth."""

import csv
import dataclasses
import json

import numpy as np
import pytest
from episodes import COARSE, SLIDE, ObedientRobot, ObedientWorld, make_trial, strategy

from coral.contact.episode.episode import Episode
from coral.contact.episode.referee import make_referee, measured_state
from coral.contact.episode.trial_log import END_REASONS
from coral.contact.scene.observation import BodyState
from coral.contact.scene.task import Task
from coral.contact.scene.trial import sample_trial
from coral.contact.thinker.strategist import FixedStrategist
from coral.contact.worlds.robot_world import WorldError
from coral.errors import InputError

SLIDE_TRIAL = sample_trial(Task.model_validate({**SLIDE, "time_limit_s": 0.4}), 0)


def judged_by(who):
    return dataclasses.replace(COARSE, judged_by=who)


def seen_at_the_mark_from(step):
    return lambda k, crate: BodyState(np.array([0.1, 0.0, 0.04]), crate.quaternion) if k >= step else crate


def run(tmp_path, trial, world, who, **more):
    folder = tmp_path / "run"
    episode = Episode(trial, world, FixedStrategist(strategy()), judged_by(who), folder, variant="own", **more)
    return episode.run(), folder


def start_event(folder):
    return json.loads((folder / "events.jsonl").read_text().splitlines()[0])


def test_a_robot_is_judged_by_its_perception(tmp_path):
    robot = ObedientRobot(SLIDE_TRIAL, seen_at_the_mark_from(4))
    result, folder = run(tmp_path, SLIDE_TRIAL, robot, "perception")
    assert (result["end_reason"], result["judged_by"], result["poses"]) == ("success", "perception", "measured")
    assert result["sim_time_s"] == pytest.approx(0.18)  # seen there from 0.08 s, for 0.1 s
    assert start_event(folder)["judged_by"] == "perception"
    with open(folder / "trajectory.csv") as file:
        rows = list(csv.DictReader(file))
    assert {row["crate_hand_force"] for row in rows} == {""}
    assert float(rows[-1]["crate_x"]) == 0.1


def test_an_episode_stops_its_robot_once_before_it_lets_go(tmp_path):
    robot = ObedientRobot(SLIDE_TRIAL)
    run(tmp_path, SLIDE_TRIAL, robot, "perception")
    assert robot.calls == ["step"] * 20 + ["stop", "close"]


def test_a_robot_is_stopped_when_the_program_fails(tmp_path):
    class Broken(FixedStrategist):
        def on_plan(self, report):
            raise ZeroDivisionError

    robot = ObedientRobot(SLIDE_TRIAL)
    episode = Episode(SLIDE_TRIAL, robot, Broken(strategy()), judged_by("perception"), tmp_path / "run", variant="own")
    with pytest.raises(ZeroDivisionError):
        episode.run()
    assert robot.calls == ["stop", "close"]


def test_a_robot_that_cannot_go_on_ends_the_episode_with_its_reason(tmp_path):
    class Unplugged(ObedientRobot):
        def step(self, target):
            raise WorldError("camera-off", "no picture")

    robot = Unplugged(SLIDE_TRIAL)
    result, _ = run(tmp_path, SLIDE_TRIAL, robot, "perception")
    assert (result["end_reason"], robot.calls) == ("camera-off", ["stop", "close"])


@pytest.mark.parametrize(("said", "reason"), [("success", "success"), ("failure", "operator-failure")])
def test_the_operator_ends_the_episode(tmp_path, said, reason):
    words = iter(["", "", said])
    trial = make_trial(seconds=1.0)
    result, _ = run(tmp_path, trial, ObedientRobot(trial), "operator", operator_verdict=lambda: next(words))
    assert (result["end_reason"], result["steps"], result["judged_by"]) == (reason, 3, "operator")
    assert result["success"] == (said == "success")
    assert reason in END_REASONS


def test_an_operator_who_says_nothing_lets_the_time_run_out(tmp_path):
    trial = make_trial()
    result, _ = run(tmp_path, trial, ObedientRobot(trial), "operator", operator_verdict=lambda: "")
    assert (result["success"], result["end_reason"]) == (False, "timeout")


def test_perception_in_simulation_is_not_told_the_truth(tmp_path):
    world = ObedientWorld(SLIDE_TRIAL, seen_at_the_mark_from(0))  # the crate is there, but is not seen there
    assert run(tmp_path, SLIDE_TRIAL, world, "perception")[0]["end_reason"] == "timeout"


def test_a_wrong_pose_is_no_tunnelling():
    referee = make_referee("perception", ObedientRobot(SLIDE_TRIAL), SLIDE_TRIAL, None)
    now = ObedientRobot(SLIDE_TRIAL).reset()
    below = dataclasses.replace(now, objects={"crate": BodyState(np.array([0.0, 0.0, -0.1]), np.array([1.0, 0, 0, 0]))})
    assert referee.end_reason(measured_state(below), True) == ""
    gone = dataclasses.replace(now, objects={"crate": BodyState(np.array([2.0, 0.0, -0.5]), np.array([1.0, 0, 0, 0]))})
    assert referee.end_reason(measured_state(gone), True) == "dropped: crate"


def test_a_referee_who_cannot_judge_is_refused_before_a_folder_is_made(tmp_path):
    trial = make_trial()
    for who, found in (
        ("truth", r"judged-by: found truth, expected perception or operator"),
        ("perception", r"judged-by: found perception, expected operator or truth.*'lifted'"),
        ("operator", r"judged-by: found operator, expected truth or perception"),
    ):
        with pytest.raises(InputError, match=found):
            run(tmp_path, trial, ObedientRobot(trial), who)
    assert not (tmp_path / "run").exists()


def test_a_world_of_another_period_is_refused(tmp_path):
    robot = ObedientRobot(SLIDE_TRIAL)
    robot.control_period_s = 0.05
    with pytest.raises(InputError, match=r"planning\.step_s: found 0\.02, expected 0\.05 s"):
        run(tmp_path, SLIDE_TRIAL, robot, "perception")


class UnhurriedRobot(ObedientRobot):
    """Its time goes on while a plan is computed."""

    in_real_time = True


def test_a_robot_does_not_wait_for_plans(tmp_path):
    """Steps are taken while a plan is computed, and none is lost. This robot takes them all during the first plan."""
    trial, robot = make_trial(0.4), UnhurriedRobot(make_trial(0.4))
    planning = dataclasses.replace(COARSE.planning, latency="measured")
    cfg = dataclasses.replace(judged_by("operator"), planning=planning)
    episode = Episode(
        trial, robot, FixedStrategist(strategy()), cfg, tmp_path / "run", variant="own", operator_verdict=lambda: ""
    )
    result = episode.run()
    assert result["end_reason"] == "timeout"
    assert robot.calls.count("step") == result["steps"] == 20


def test_a_robot_whose_plans_would_take_no_time_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"planning.latency.*measured or fixed:SECONDS"):
        run(tmp_path, make_trial(), UnhurriedRobot(make_trial()), "operator", operator_verdict=lambda: "")
    assert not (tmp_path / "run").exists()


def test_the_truth_is_enough_to_judge_by():
    """A simulated robot may know the truth although no MuJoCo simulation can be looked into."""

    class TruthfulRobot(ObedientRobot):
        def truth(self):
            return self._inner.truth()

    trial = make_trial()
    assert make_referee("truth", TruthfulRobot(trial), trial, None).name == "truth"
