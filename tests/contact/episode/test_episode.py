import dataclasses
import json

import numpy as np
import pytest
import yaml
from episodes import COARSE, ObedientWorld, make_trial, stay, strategy

from coral.contact.control.reactive import ReactiveCfg
from coral.contact.cost.stages import Stage, Strategy
from coral.contact.cost_program.errors import CostError
from coral.contact.episode import episode as module
from coral.contact.episode.episode import Episode, as_perceived
from coral.contact.episode.trial_log import END_REASONS
from coral.contact.scene.observation import BodyState
from coral.contact.scene.trial import prior_beliefs, sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.strategist import FixedStrategist, StrategistCounts
from coral.contact.worlds.robot_world import WorldError
from coral.errors import InputError


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Run an episode in an obedient world; returns result, folder and world."""

    def start(strategist=None, cfg=COARSE, seconds=0.2, observers=(), **world):
        trial = make_trial(seconds)
        made = ObedientWorld(trial, **world)
        monkeypatch.setattr(module, "make_world", lambda name, trial, period: made)
        folder = tmp_path / "run"
        one = Episode(trial, "obedient", strategist or FixedStrategist(strategy()), cfg, folder, variant="expert")
        return one.run(observers), folder, made

    return start


def events(folder, *names):
    lines = [json.loads(line) for line in (folder / "events.jsonl").read_text().splitlines()]
    return [line for line in lines if not names or line["event"] in names]


def lifted_from(step):
    return lambda k, box: BodyState(box.position + np.array([0, 0, 0.12]), box.quaternion) if k >= step else box


def test_time_runs_out(run):
    result, folder, world = run()
    assert (result["success"], result["end_reason"]) == (False, "timeout")
    assert (result["sim_time_s"], result["steps"]) == (0.2, 10)
    assert result["plans"] == 5  # two steps from each
    assert world.closed
    assert events(folder)[-1]["event"] == "end"


def test_success_needs_all_conditions_held_long_enough(run):
    result, _, _ = run(seconds=2.0, script=lifted_from(5))
    assert (result["success"], result["end_reason"], result["sim_time_s"]) == (True, "success", 0.6)


def test_a_lift_that_ends_too_soon_is_no_success(run):
    result, _, _ = run(seconds=0.7, script=lambda k, box: lifted_from(5)(k, box) if k < 20 else box)
    assert (result["success"], result["end_reason"]) == (False, "timeout")


def test_an_object_that_falls_ends_the_episode(run):
    fallen = BodyState(np.array([2.0, 0.0, -0.5]), np.array([1.0, 0, 0, 0]))
    result, _, _ = run(script=lambda k, box: fallen if k >= 3 else box)
    assert (result["success"], result["end_reason"], result["steps"]) == (False, "dropped: box", 3)


@pytest.mark.parametrize("code", ["diverged", "tunnelling", "unreachable", "camera-off"])
def test_a_fault_of_the_world_is_named_and_no_success(run, code):
    result, folder, _ = run(script=lifted_from(0), fault=(3, WorldError(code, "it broke")))
    assert (result["success"], result["end_reason"], result["steps"]) == (False, code, 2)
    assert events(folder, "end")[0]["detail"] == "it broke"
    assert code in END_REASONS


def test_a_cost_that_cannot_be_evaluated_ends_the_episode_with_its_reason(run):
    def broken(state):
        raise CostError("not_finite", "the term is nan")

    result, folder, _ = run(FixedStrategist(strategy(broken)))
    assert (result["end_reason"], result["steps"]) == ("cost-error", 0)
    assert "the term is nan" in events(folder, "end")[0]["detail"]


def test_a_cost_whose_process_dies_before_the_first_plan_ends_the_episode_with_its_reason(run):
    class Unlucky(FixedStrategist):
        def begin(self, *_):
            raise CostError("killed", "the process of the cost died")

    result, folder, _ = run(Unlucky(strategy()))
    assert (result["end_reason"], result["steps"]) == ("cost-error", 0)
    assert "the process of the cost died" in events(folder, "end")[0]["detail"]


def test_steps_that_do_not_fill_a_control_step_are_refused_before_a_folder_is_made(run, tmp_path):
    cfg = dataclasses.replace(COARSE, planning=dataclasses.replace(COARSE.planning, physics_dt_s=0.03))
    with pytest.raises(InputError, match=r"physics_dt_s: found 0\.03 s, expected a whole number of them in"):
        run(cfg=cfg)
    assert not (tmp_path / "run").exists()


class Mender(FixedStrategist):
    """Has another cost ready when one fails."""

    def __init__(self, first, second):
        super().__init__(first)
        self.second, self.heard = second, []

    def on_cost_error(self, error, stage, now):
        self.heard.append((error.code, stage, now.time_s))
        return self.second


def test_a_cost_that_cannot_be_evaluated_goes_to_the_strategist_before_the_episode_ends(run):
    def broken(state):
        raise CostError("not_finite", "the term is nan")

    strategist = Mender(strategy(broken), strategy())
    result, folder, _ = run(strategist)
    assert (result["end_reason"], strategist.heard) == ("timeout", [("not_finite", "stay", 0.0)])
    assert len(events(folder, "strategy")) == 2


def test_without_a_usable_rollout_the_episode_ends_long_before_its_time(run, monkeypatch):
    def nothing(state):
        return {"nothing": np.full(state.shape, np.nan)}

    monkeypatch.setattr(module, "PATIENCE_PLANS", 3)
    result, _, _ = run(FixedStrategist(strategy(nothing)), seconds=60.0)
    assert (result["end_reason"], result["steps"]) == ("no-plan", 4)


def test_an_error_in_the_program_is_not_swallowed_and_leaves_a_readable_run(run, tmp_path):
    def broken(state):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        run(FixedStrategist(strategy(broken)))
    assert events(tmp_path / "run")[-1]["reason"] == "failed"


def test_an_observer_stops_the_episode(run):
    class Impatient:
        def tick(self, episode):
            pass

        def stop_requested(self):
            return "stopped by the operator"

    result, _, _ = run(observers=[Impatient()], seconds=30.0)
    assert (result["end_reason"], result["steps"]) == ("stopped by the operator", 2)


def test_stages_are_told_as_they_change(run):
    stages = Strategy("two", (Stage("first", stay, until=lambda now: True), Stage("second", stay)))
    result, folder, _ = run(FixedStrategist(stages))
    assert [(e["before"], e["stage"]) for e in events(folder, "stage")] == [(None, "first"), ("first", "second")]
    assert result["stages"] == 1
    assert [e["stage"] for e in events(folder, "plan")] == ["first"] + ["second"] * 4


def test_a_strategist_may_change_its_strategy(run):
    class Second(FixedStrategist):
        counts = StrategistCounts(advisor_calls=2, repairs=1, memory_hit=True)
        reports = 0

        def on_plan(self, report):
            self.reports += 1
            return Strategy("other", (Stage("other", stay),)) if self.reports == 3 else None

    result, folder, _ = run(Second(strategy()))
    assert [e["name"] for e in events(folder, "strategy")] == ["stay", "other"]
    counted = [result[key] for key in ("strategy", "advisor_calls", "repairs", "memory_hit")]
    assert counted == ["other", 2, 1, True]
    assert [e["stage"] for e in events(folder, "plan")] == ["stay"] * 3 + ["other"] * 2


@pytest.mark.parametrize("latency", [False, True])
def test_a_strategist_sees_the_state_that_the_conditions_read(run, latency):
    class Watching(FixedStrategist):
        seen = ()

        def on_plan(self, report):
            self.seen = (*self.seen, report.present)

    read = []
    stages = Strategy("two", (Stage("first", stay, until=lambda now: read.append(now)), Stage("second", stay)))
    strategist = Watching(stages)
    run(strategist, cfg=late() if latency else COARSE)
    assert len(read) > 1
    assert all(one is other for one, other in zip(read, strategist.seen, strict=True))


def test_a_strategist_is_not_told_the_true_masses_and_frictions(run):
    class Curious(FixedStrategist):
        def begin(self, trial, first, world):
            self.told = trial
            return super().begin(trial, first, world)

    strategist = Curious(strategy())
    run(strategist)
    assert strategist.told.objects["box"].physical == prior_beliefs(strategist.told)["box"]


def test_a_strategist_is_told_the_limits_of_this_run_s_planner(run):
    class Author(FixedStrategist):
        def attach(self, thinking, emit, limits, look, above):
            self.limits = limits

    author = Author(strategy())
    controller = dataclasses.replace(COARSE.controller, horizon=8, speed_m_s=0.2)
    planning = dataclasses.replace(COARSE.planning, latency="fixed:0.1")
    reactive = dataclasses.replace(COARSE.reactive, force_limit_n=20.0)
    run(author, dataclasses.replace(COARSE, controller=controller, planning=planning, reactive=reactive))
    limits = author.limits()
    step_s = COARSE.planning.step_s
    assert (limits.horizon_s, limits.replan_s, limits.late_s) == pytest.approx((8 * step_s, 0.1, 0.1))
    assert (limits.controller, limits.press_n) == (controller, 20.0)


def test_commands_stay_within_the_force_limit(run):
    def away(state):
        return {"away": -10.0 * state.ee_pos[..., 0]}

    cfg = dataclasses.replace(COARSE, reactive=ReactiveCfg(force_limit_n=3.0))
    _, _, world = run(FixedStrategist(strategy(away)), cfg)
    here = np.array([0.0, 0.0, 0.25])
    for command in world.commands:
        assert np.linalg.norm(command.position - here) * command.stiffness <= 3.0 + 1e-9
        here = command.position


def test_a_run_folder_tells_what_was_run(run):
    result, folder, _ = run()
    config = yaml.safe_load((folder / "config.yaml").read_text())
    assert (config["system"], config["task"], config["seed"]) == ("contact", "pick-box", 0)
    assert config["episode"]["controller"]["horizon"] == 8
    assert yaml.safe_load((folder / "task.yaml").read_text())["name"] == "pick-box"
    plan = events(folder, "plan")[0]
    assert plan["cost"] == pytest.approx(sum(plan["terms"].values()), abs=1e-4)
    written = json.loads((folder / "metrics.json").read_text()) | json.loads((folder / "timing.json").read_text())
    assert written == result


def test_a_folder_that_holds_something_is_left_alone(run, tmp_path):
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "mine.txt").write_text("x")
    with pytest.raises(InputError, match="not empty"):
        run()


def test_the_same_seed_gives_the_same_files_whatever_the_number_of_threads(tmp_path):
    folders = []
    for threads in (1, 2):
        cfg = dataclasses.replace(COARSE, planning=dataclasses.replace(COARSE.planning, threads=threads))
        folders.append(tmp_path / str(threads))
        Episode(make_trial(0.3), "hand", FixedStrategist(strategy()), cfg, folders[-1], variant="expert").run()
    for name in ("metrics.json", "events.jsonl", "trajectory.csv", "states.csv", "task.yaml"):
        assert (folders[0] / name).read_bytes() == (folders[1] / name).read_bytes()


def test_what_fails_at_the_end_does_not_cost_the_record(run, tmp_path):
    class Forgetful(FixedStrategist):
        def on_end(self, reason):
            raise InputError("memory.sqlite", "", "read-only", "a file that can be written")

    with pytest.raises(InputError, match="read-only"):
        run(Forgetful(strategy()))
    assert json.loads((tmp_path / "run" / "metrics.json").read_text())["end_reason"] == "timeout"
    assert events(tmp_path / "run")[-1]["event"] == "end"


def late(seconds="fixed:0.08"):
    return dataclasses.replace(COARSE, planning=dataclasses.replace(COARSE.planning, latency=seconds))


def test_with_latency_the_hand_holds_still_until_the_first_plan_and_follows_each_plan_until_the_next(run):
    result, folder, world = run(cfg=late(), seconds=0.4)
    assert result["plans"] == 5  # every 0.08 s, four steps each
    plans = events(folder, "plan")
    assert [event["ahead_s"] for event in plans] == [0.08] * 5
    assert result["plan_late_ms_median"] == 80.0
    assert [round(event["t"], 6) for event in plans] == [0.0, 0.08, 0.16, 0.24, 0.32]
    first = np.array([command.position for command in world.commands[:4]])
    assert np.ptp(first, axis=0).max() == 0.0
    assert np.ptp([command.position for command in world.commands[4:8]], axis=0).max() > 0.0


def test_without_latency_a_plan_is_followed_at_once(run):
    _, folder, world = run(seconds=0.2)
    assert "ahead_s" not in events(folder, "plan")[0]
    assert np.ptp([command.position for command in world.commands[:2]], axis=0).max() > 0.0


def test_with_latency_conditions_read_the_commanded_opening(run):
    read = []

    def until(now):
        read.append(float(now.gripper_target[0, 0]))
        return False

    close = Stage("close", lambda state: {"close": 20.0 * (state.gripper_target + 0.04)}, until=until)
    _, _, world = run(FixedStrategist(Strategy("close", (close, Stage("stay", stay)))), cfg=late(), seconds=0.4)
    assert read[-1] == pytest.approx(world.commands[15].opening_m)  # the last one before the plan at 0.32 s
    assert read[-1] < 0.0795  # the measured one stays 0.08


def test_the_planner_does_not_know_what_is_hidden(tmp_path):
    trial = sample_trial(load_task("wipe-over-step").model_copy(update={"time_limit_s": 0.1}), 0)
    one = Episode(trial, "hand", FixedStrategist(strategy()), COARSE, tmp_path / "run", variant="expert")
    one.run()
    assert one.planner.fixed_names == ("table",)
    assert as_perceived(trial, one.now).task.things == ("table",)
    assert one.now.objects["sponge"].position[2] == pytest.approx(0.023, abs=0.001)  # it lies on the slab
