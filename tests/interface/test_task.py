import asyncio
import json
from typing import Literal

import numpy as np
import pytest

import coral
from coral.cli import main
from coral.contact.control.hand_plan import HandPlan
from coral.contact.control.mppi_controller import Controller
from coral.contact.scene.condition import BaseCondition
from coral.contact.scene.observation import HandTarget
from coral.contact.scene.state_conditions import Lifted
from coral.errors import InputError
from coral.interface.task import with_conditions

COARSE = {"controller.horizon": 8, "planning.threads": 1}
QUICK = {"world": "hand", "samples": 6, "cfg": COARSE}


def reach(state):
    return {"reach": np.linalg.norm(state.ee_pos - state.box_pos, axis=-1)}


class Elapsed(BaseCondition):
    """Holds from the start: the object exists."""

    kind: Literal["elapsed"] = "elapsed"

    def monitor(self, trial):
        return lambda truth: self.object in truth.objects


def test_a_numpy_function_is_followed_inside_a_running_loop(short_task, tmp_path):
    async def cell():
        return coral.run_task(short_task, cost=reach, out=tmp_path / "run", report=False, **QUICK)

    result = asyncio.run(cell())
    assert (result.end_reason, result.success, result.metrics["strategy"]) == ("timeout", False, "reach")
    assert result.trajectory.num_rows == result.metrics["steps"] + 1
    assert (tmp_path / "run" / "cost.py").read_text().startswith("def reach(state):")
    assert json.loads(json.dumps(result.events[0]))["variant"] == "own-cost"


def test_it_is_the_same_episode_as_on_the_command_line(short_task, tmp_path, capsys):
    import yaml

    (tmp_path / "short.yaml").write_text(yaml.safe_dump(short_task.model_dump(mode="json")))
    result = coral.run_task(tmp_path / "short.yaml", **QUICK)
    words = ["--samples", "6", "--cfg.controller.horizon", "8", "--cfg.planning.threads", "1", "--quiet"]
    words += ["--cfg.record.no-report", "--world", "hand", "--out", str(tmp_path / "run")]
    assert main(["contact", "run", str(tmp_path / "short.yaml"), *words]) == 0
    capsys.readouterr()
    stored = json.loads((tmp_path / "run" / "metrics.json").read_text())
    assert {key: result.metrics[key] for key in stored} == stored


def test_conditions_of_ones_own_judge_the_task(short_task):
    result = coral.run_task(short_task, cost=reach, conditions=[Elapsed(object="box")], **QUICK)
    assert result.success


def test_a_controller_of_ones_own_plans(short_task):
    made = []

    def controller(world, cfg, rng):
        made.append(cfg.horizon)
        return Controller(world, cfg, rng)

    coral.run_task(short_task, cost=reach, controller=controller, **QUICK)
    assert made == [8]


class Waits:
    """The least that a controller of the hand needs: it commands the pose in which the hand is."""

    def __init__(self, world, cfg, rng):
        self.horizon, self.resets, self.told = cfg.horizon, 0, []

    def reset(self, now):
        self.resets += 1

    def plan(self, now, stage, step, since=None, target=None, executed=0):
        self.told.append((step, executed, target.opening_m))
        return HandPlan((HandTarget(now.tool.position, now.tool.quaternion, now.opening_m, 600.0),) * self.horizon)


@pytest.mark.parametrize("latency", ["0", "fixed:0.04"])
def test_plan_and_reset_are_all_that_a_controller_needs(short_task, latency, tmp_path):
    made = []

    def controller(*setup):
        made.append(Waits(*setup))
        return made[0]

    quick = {**QUICK, "cfg": {**COARSE, "planning.latency": latency}}
    result = coral.run_task(short_task, cost=reach, controller=controller, out=tmp_path / "run", **quick)
    assert made[0].resets == 1
    assert [executed for _, executed, _ in made[0].told][:3] == [0, 2, 2]
    assert result.metrics["end_reason"] == "timeout"
    assert result.metrics["plans"] == len(made[0].told)
    assert result.metrics["path_length_m"] < 0.05
    assert (tmp_path / "run" / "report.html").is_file()


@pytest.mark.parametrize(
    ("task", "wrong", "said"),
    [
        ("pick-bx", {}, "did you mean 'pick-box'"),
        ("pick-box", {"advisor": "recorded", "cost": reach}, "a cost of your own asks nobody"),
        ("pick-box", {"cost": reach, "variant": "expert"}, "also --variant expert"),
        ("pick-box", {"cost": lambda state: state.bocks_pos}, "no quantity 'bocks_pos'"),
        ("pick-box", {"controller": "mpi"}, "did you mean 'mppi'"),
        ("pick-box", {"cfg": {"controller.horizn": 3}}, "did you mean 'horizon'"),
        ("pick-box", {"conditions": []}, "one or more conditions"),
        ("pick-box", {"conditions": [Lifted(object="bocks", height_m=0.1)]}, "did you mean 'box'"),
    ],
)
def test_it_refuses_what_the_command_line_refuses(task, wrong, said, tmp_path):
    settings = {"cfg": {"planning.threads": 1}, "world": "hand", **wrong}
    with pytest.raises(InputError, match=said):
        coral.run_task(task, out=tmp_path / "run", **settings)
    assert not (tmp_path / "run").exists()


def test_a_task_changed_in_python_is_checked_like_a_file(short_task):
    with pytest.raises(InputError, match=r"hold_s: found 0\.04 s"):
        coral.run_task(short_task.model_copy(update={"time_limit_s": 0.02}), **QUICK)


def test_a_condition_of_ones_own_is_written_whole(short_task):
    changed = with_conditions(short_task, [Elapsed(object="box")])
    assert changed.model_dump(mode="json")["success"]["conditions"] == [{"object": "box", "kind": "elapsed"}]
