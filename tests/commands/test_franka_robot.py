"""The flags of an arm, the list, and the operator's word."""

import dataclasses

import numpy as np
import pytest
from arms import arm_state
from episodes import make_trial

from coral.cli import main
from coral.commands.franka_robot import (
    ask_for_word,
    go_through,
    robot_cfg,
    robot_trial,
)
from coral.commands.robot_flags import RobotFlags
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.franka.stream import StreamReport
from coral.contact.scene.observation import BodyState
from coral.contact.worlds.franka_cfg import FrankaCfg
from coral.errors import RunError

ARM = RobotFlags(world="franka", robot="10.0.0.1")
BOX = BodyState(np.array([0.1, 0.0, 0.03]), np.array([1.0, 0, 0, 0]))
REPORT = StreamReport(state=arm_state(7.0), objects={"box": BOX}, ages_s={"box": 0.01})


def test_a_missing_robot_is_one_line_and_exit_code_2(capsys):
    assert main(["contact", "run", "pick-box", "--world", "franka"]) == 2
    assert "--robot: found nothing" in capsys.readouterr().err


def test_a_missing_extra_is_one_line_and_exit_code_2(capsys, monkeypatch, tmp_path):
    monkeypatch.setitem(__import__("sys").modules, "franky", None)
    words = ["contact", "run", "pick-box", "--world", "franka", "--robot", "10.0.0.1", "--cfg.judged-by", "operator"]
    assert main([*words, "--out", str(tmp_path / "run")]) == 2
    assert "expected the extra franka" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


def test_before_anything_is_started_somebody_must_be_there_to_judge(capsys):
    words = ["contact", "run", "pick-box", "--world", "franka", "--robot", "10.0.0.1"]
    assert main(words) == 2
    assert "judged-by: found truth, expected operator or perception" in capsys.readouterr().err
    dry = dataclasses.replace(ARM, dry_run=True)
    assert robot_cfg(EpisodeCfg(), dry).judged_by == "operator"


def test_an_arm_does_not_wait_for_plans_and_a_simulated_one_may_be_slow():
    cfg = EpisodeCfg(judged_by="operator")
    assert robot_cfg(cfg, ARM).planning.latency == "measured"
    assert robot_cfg(cfg, ARM).franka == cfg.franka
    slow = robot_cfg(cfg, dataclasses.replace(ARM, robot="sim")).franka
    assert (slow.link_timeout_s, slow.watchdog_s) == (2.0, 2.0)
    assert slow.joint_friction_n_m[0] == pytest.approx(0.8 * 1.137)
    own = dataclasses.replace(cfg, franka=dataclasses.replace(cfg.franka, joint_friction_n_m=(0.1,) * 7))
    assert robot_cfg(own, dataclasses.replace(ARM, robot="sim")).franka.joint_friction_n_m == (0.1,) * 7
    fixed = dataclasses.replace(cfg, planning=dataclasses.replace(cfg.planning, latency="fixed:0.1"))
    assert robot_cfg(fixed, ARM).planning.latency == "fixed:0.1"


def test_a_dry_run_is_short():
    trial = make_trial(30.0)
    assert robot_trial(trial, ARM).task.time_limit_s == 30.0
    assert robot_trial(trial, dataclasses.replace(ARM, dry_run=True)).task.time_limit_s == 3.0


class FakeStream:
    def __init__(self, *reports):
        self.reports = list(reports)

    def report(self):
        return self.reports.pop(0) if len(self.reports) > 1 else self.reports[0]


def test_the_list_is_shown_once_all_is_in_order(capsys):
    blind = dataclasses.replace(REPORT, objects={}, ages_s={})
    go_through(FakeStream(blind, blind, REPORT), FrankaCfg(), ("box",), sleep=lambda seconds: None)
    shown = capsys.readouterr().err
    assert "NO " not in shown
    assert "ok   box is seen within reach" in shown


def test_an_arm_that_is_not_in_order_does_not_move(capsys):
    blind = dataclasses.replace(REPORT, objects={}, ages_s={})
    with pytest.raises(RunError, match="the arm does not move: box is seen within reach: last pose never"):
        go_through(FakeStream(blind), FrankaCfg(), ("box",), sleep=lambda seconds: None)
    assert "NO   box is seen" in capsys.readouterr().err


@pytest.mark.parametrize("said", ["", "y\n", "yes\n", "no\n"])
def test_only_the_word_moves_the_arm(said):
    with pytest.raises(RunError, match="did not say 'move'"):
        ask_for_word(lambda: said)
    ask_for_word(lambda: "move\n")
