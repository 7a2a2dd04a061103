import dataclasses
import json

import numpy as np
import pytest
from experiences import experience
from recorded import RULES

from coral.advisor.question import AdvisorUnavailable, Reply
from coral.advisor.rules import RuleAdvisor
from coral.contact.control.hand_controllers import PlannerLimits
from coral.contact.control.hand_plan import HandPlan
from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.cost.context import Context
from coral.contact.cost.stages import Progress
from coral.contact.cost_program import CostError
from coral.contact.cost_program.worker import CostWorker
from coral.contact.memory.memory import Memory, MemoryCfg
from coral.contact.plan.cost_plan import PlanAnswer, StageAnswer, in_process
from coral.contact.plan.imagined_run import ImaginedOutcome
from coral.contact.scene.observation import HandTarget, Transition
from coral.contact.scene.task_names import shipped_tasks
from coral.contact.scene.trial import PhysicalParameters
from coral.contact.thinker import thinker as thinking
from coral.contact.thinker.asker import Asker
from coral.contact.thinker.progress_monitor import OuterCfg, ProgressMonitor
from coral.contact.thinker.recall import RecallRun
from coral.contact.thinker.strategist import NoStrategy, PlanReport
from coral.contact.thinker.think_cfg import NoDecision, ThinkCfg
from coral.contact.thinker.thinker import Thinker
from coral.contact.world_model.parameter_estimates import ParameterEstimate
from coral.errors import InputError

NAMES = ["above", "lower", "close", "lift", "hold"]
"""Stages of the recorded plan for the box."""


class Here:
    """What stands for the confined process, in this one."""

    load = staticmethod(in_process)

    def close(self):
        pass


def thinker(one, advisor=None, memory=None, given=None, rehearsed=0, worker=None, **cfg):
    told = []
    strategist = Thinker(
        Asker(advisor or RuleAdvisor(RULES)),
        ThinkCfg(memory=MemoryCfg(rehearsed=rehearsed), **cfg),
        np.random.default_rng(0),
        worker or Here(),
        memory,
        provenance={"world": "hand", "seed": 0},
        given=given,
    )
    strategist.attach(
        strategist.asker.clock.thinking,
        lambda event, **fields: told.append((event, fields)),
        lambda: PlannerLimits(ControllerCfg(), 0.04, 0.08),
        lambda: None,
        lambda: None,
    )
    return strategist, told


def begun(one, *args, **kwargs):
    """A strategist that has given its first strategy, and its events."""
    strategist, told = thinker(one, *args, **kwargs)
    strategist.begin(one.trial, one.now, one.world)
    return strategist, told


def standing(one):
    """A control step in which nothing moves."""
    return Transition(one.now, HandTarget(one.now.tool.position, one.now.tool.quaternion, 0.08, 600.0), one.now)


def first_change(strategist, one, stage, taken=()):
    """The strategy that replaces the first one, of whose stage nothing moves on."""
    changes = (strategist.on_plan(plan_report(one, 0.1 * k, stage, 5.0, taken)) for k in range(8))
    return next((other for other in changes if other is not None), None)


SOON = OuterCfg(n_retry=2, attempt_s=0.1, refinements=1)
"""Stuck after 0.2 s, once."""


def decisions(told):
    """Event and source of every decision."""
    return [(event, fields["source"]) for event, fields in told if "decided" in fields]


def plan_report(one, t, stage, cost, taken=()):
    body = one.now.objects["box"]
    now = type(one.now)(t, one.now.tool, one.now.opening_m, one.now.wrench, one.now.objects)
    state = one.world.present(now)
    plan = HandPlan((), terms={"all": cost}, now=state)
    assert body is not None
    return PlanReport(now, plan, stage, taken, next_state=plan.now, present=plan.now)


def test_the_default_advisor_gives_a_strategy_and_is_counted(scene):
    one = scene("pick-box")
    strategist, told = thinker(one)
    strategy = strategist.begin(one.trial, one.now, one.world)
    assert [stage.name for stage in strategy.stages] == NAMES
    assert strategist.counts.advisor_calls == 3
    assert decisions(told) == [("beliefs", "advisor"), ("plan_answer", "advisor"), ("regions", "advisor")]
    assert json.dumps(told)
    assert Progress(strategy).update(one.world.present(one.now)) is False


def test_what_is_given_is_believed_and_not_asked_for(scene):
    one = scene("pick-box")
    truth = one.trial.objects["box"].physical
    strategist, told = begun(one, given={"box": PhysicalParameters(2.0, 0.9)})
    assert one.world.beliefs[0]["box"] == PhysicalParameters(2.0, 0.9)
    assert one.trial.objects["box"].physical == truth
    assert decisions(told) == [("plan_answer", "advisor"), ("regions", "advisor")]
    assert (told[0][0], told[0][1]["source"], told[0][1]["box"]) == ("beliefs", "given", [2.0, 0.9])
    assert strategist.counts.advisor_calls == 2


def test_what_is_given_of_some_objects_leaves_the_rest_to_the_advisor(scene):
    one = scene("pick-clutter")
    name, other = list(one.sizes)[:2]
    advisor = RuleAdvisor({"physical-parameters": RULES["physical-parameters"]}, "parameters-only")
    strategist, told = thinker(one, advisor, given={name: PhysicalParameters(2.0, 0.9)})
    with pytest.raises(NoStrategy):
        strategist.begin(one.trial, one.now, one.world)
    assert one.world.beliefs[0][name] == PhysicalParameters(2.0, 0.9)
    assert one.world.beliefs[0][other].mass_kg < 2.0
    assert decisions(told)[0] == ("beliefs", "advisor")


def test_without_regions_nothing_guides_the_samples(scene):
    one = scene("pick-box")
    strategist, _ = thinker(one, regions=False)
    strategy = strategist.begin(one.trial, one.now, one.world)
    assert not any(stage.guides for stage in strategy.stages)


class Gone:
    name = "gone"

    async def answer(self, question, rejections):
        raise AdvisorUnavailable("no-network", "there is none", final=True)


class PlansOnly(RuleAdvisor):
    """Answers the questions about plans, and no other."""

    def __init__(self):
        super().__init__({"cost-function": RULES["cost-function"]}, "plans-only")


def test_without_an_answer_what_is_believed_stands_and_the_record_says_so(scene):
    one = scene("pick-box")
    before = one.world.beliefs[0]["box"]
    strategist, told = thinker(one, PlansOnly())
    assert strategist.begin(one.trial, one.now, one.world).stages
    fell = [(fields["what"], fields["because"], fields["by"]) for event, fields in told if event == "fallback"]
    assert fell == [("parameters", "no-rule", "the prior beliefs"), ("regions", "no-rule", "no regions")]
    assert one.world.beliefs[0]["box"] == before
    assert {source for _, source in decisions(told)} == {"fallback", "advisor"}


def test_without_any_plan_there_is_no_strategy(scene):
    one = scene("pick-box")
    strategist, _ = thinker(one, Gone())
    with pytest.raises(NoStrategy, match="no plan"):
        strategist.begin(one.trial, one.now, one.world)


@pytest.mark.parametrize(
    ("policy", "reason"), [("hold", "no-decision: parameters"), ("fail", "advisor failed: no-network")]
)
def test_without_an_answer_nobody_takes_over_who_was_not_chosen(scene, policy, reason):
    one = scene("pick-box")
    strategist, told = thinker(one, Gone(), fallback=policy)
    with pytest.raises(NoDecision) as end:
        strategist.begin(one.trial, one.now, one.world)
    assert end.value.end_reason == reason
    assert decisions(told) == [("fallback", "fallback")]


def test_what_others_decided_is_not_remembered_as_the_advisors(scene, tmp_path):
    one = scene("pick-box")
    for advisor, kept in ((PlansOnly(), 0), (None, 1)):
        memory = Memory(tmp_path / f"{kept}.sqlite")
        strategist, _ = begun(one, advisor, memory)
        strategist.on_end("success")
        assert len(memory.all()) == kept


class OneFunction:
    """Answers as the paper's models do: one function, first with a name that the state does not have."""

    name = "one-function"

    def __init__(self):
        self.heard = []

    async def answer(self, question, rejections):
        self.heard += [rejection.reason for rejection in rejections]
        if question.kind != "cost-function":
            return Reply(value=RULES[question.kind](question.facts, rejections), raw="")
        target = "box_pos" if rejections else "cup_pos"
        return Reply(
            value=PlanAnswer(code=f"def state_cost(self):\n    return 5 * norm(self.ee_pos - self.{target})"), raw=""
        )


def test_a_models_refused_cost_is_mended_by_the_reason(scene):
    one = scene("pick-box")
    advisor = OneFunction()
    strategist, _ = thinker(one, advisor, regions=False)
    assert [stage.name for stage in strategist.begin(one.trial, one.now, one.world).stages] == ["task"]
    assert "cup_pos" in advisor.heard[0]


def test_a_success_is_remembered_and_used_at_the_next_start(scene, tmp_path):
    memory = Memory(tmp_path / "m.sqlite")
    one = scene("pick-box")
    strategist, _ = begun(one, memory=memory)
    strategist.on_end("timeout")
    assert memory.all() == []
    strategist, _ = begun(one, memory=memory)
    strategist.on_end("success")
    again, told = begun(one, memory=memory)
    assert again.counts.memory_hit
    assert again.counts.advisor_calls == 1  # the masses and frictions; plan and regions are remembered
    assert [fields["refused"] for event, fields in told if event == "recall"] == [""]
    again.on_end("success")
    assert (memory.all()[0].used, memory.all()[0].helped) == (1, 1)


@pytest.mark.parametrize("task", shipped_tasks())
def test_what_succeeded_in_a_shipped_task_is_used_when_the_same_trial_comes_again(scene, tmp_path, task):
    memory = Memory(tmp_path / "m.sqlite")
    one = scene(task)
    memory.add(experience(one))
    strategist, told = begun(one, memory=memory)
    assert [fields["refused"] for event, fields in told if event == "recall"] == [""]
    assert strategist.counts.memory_hit
    strategist.on_end("timeout")


@pytest.fixture
def remembering(scene, tmp_path):
    """A scene, and a memory in which the rules' own plan for it is."""
    one = scene("pick-box")
    memory = Memory(tmp_path / "m.sqlite")
    strategist, _ = begun(one, memory=memory)
    strategist.on_end("success")
    return one, memory


def test_what_is_remembered_runs_in_the_confined_process_until_the_episode_ends(remembering):
    one, memory = remembering
    worker = CostWorker()
    strategist, _ = thinker(one, memory=memory, worker=worker)
    strategy = strategist.begin(one.trial, one.now, one.world)
    assert strategist.counts.memory_hit
    assert worker.pid is not None
    direct, _ = thinker(one)
    context = one.samples
    expected = direct.begin(one.trial, one.now, one.world).stages[0].cost(context)
    found = strategy.stages[0].cost(context)
    assert all((found[name] == expected[name]).all() for name in expected)
    strategist.on_end("timeout")
    assert worker.pid is None


def test_what_is_remembered_is_tried_without_regions_too(remembering, monkeypatch):
    one, memory = remembering
    run = RecallRun(ImaginedOutcome(True, 1.0, 1.0, 1.0), 2.5, "")
    monkeypatch.setattr("coral.contact.thinker.recall.try_recalled", lambda *_: run)
    strategist, told = begun(one, memory=memory, regions=False, rehearsed=1)
    assert [fields["outcome"]["succeeded"] for event, fields in told if event == "recall"] == [1]
    assert strategist.counts.memory_hit
    strategist.on_end("timeout")


def test_a_remembered_plan_that_was_replaced_did_not_help_and_the_one_that_did_is_kept(remembering):
    one, memory = remembering
    strategist, _ = begun(one, memory=memory)
    assert strategist.on_cost_error(CostError("runtime", "no"), "above", one.now) is not None
    strategist.on_end("success")
    first, other = memory.all()
    assert (first.used, first.helped) == (1, 0)
    assert other.experience.plan == first.experience.plan
    assert len(other.experience.then) == 1


def test_a_plan_that_needed_a_repair_is_followed_with_it_and_nobody_is_asked(remembering):
    one, memory = remembering
    strategist, _ = begun(one, memory=memory)
    strategist.on_cost_error(CostError("runtime", "no"), "above", one.now)
    strategist.on_end("success")
    memory.forget(1)

    again, told = begun(one, memory=memory)
    asked = again.counts.advisor_calls
    assert again.on_cost_error(CostError("runtime", "no"), "above", one.now) is not None
    assert again.counts.advisor_calls == asked
    assert decisions(told)[-1] == ("recall_repair", "memory")
    assert again.on_cost_error(CostError("runtime", "no"), "above", one.now) is not None
    assert again.counts.advisor_calls > asked  # there is no second one
    again.on_end("timeout")


def test_a_success_is_found_again_by_the_scene_that_its_plan_began_in(remembering):
    one, memory = remembering
    strategist, _ = begun(one, memory=memory)
    box = one.now.objects["box"]
    higher = dataclasses.replace(box, position=box.position + np.array([0.0, 0.0, 0.2]))
    lifted = dataclasses.replace(one.now, objects={**one.now.objects, "box": higher})
    strategist.on_cost_error(CostError("runtime", "no"), "above", lifted)
    strategist.on_end("success")
    first, repaired = memory.all()
    assert repaired.experience.numbers == first.experience.numbers


def test_a_success_by_a_remembered_repair_is_counted_and_not_stored_again(remembering):
    one, memory = remembering
    for _ in range(2):
        strategist, _ = begun(one, memory=memory)
        strategist.on_cost_error(CostError("runtime", "no"), "above", one.now)
        strategist.on_end("success")
        if len(memory.all()) == 2 and memory.get(2).used == 0:
            memory.forget(1)
    (only,) = memory.all()
    assert (only.used, only.helped) == (1, 1)


def test_a_success_without_regions_is_not_kept(scene, tmp_path):
    one = scene("pick-box")
    memory = Memory(tmp_path / "m.sqlite")
    strategist, _ = begun(one, memory=memory, regions=False)
    strategist.on_end("success")
    assert memory.all() == []


def test_the_process_ends_though_the_memory_cannot_be_written(remembering):
    one, memory = remembering
    worker = CostWorker()
    strategist, _ = begun(one, memory=memory, worker=worker)
    memory.store.path.unlink()
    memory.store.path.mkdir()
    with pytest.raises(InputError):
        strategist.on_end("success")
    assert worker.pid is None


def test_attempts_without_progress_are_counted(scene):
    one = scene("pick-box")
    watch = ProgressMonitor(OuterCfg(n_retry=3, attempt_s=0.2), ("above", "close", "lift"))
    assert not any(watch.update(plan_report(one, 0.1 * k, "above", 10.0 - k)) for k in range(8))
    found = [watch.update(plan_report(one, 0.8 + 0.1 * k, "above", 3.0)) for k in range(8)]
    assert found[-1]
    assert not found[0]


def test_falling_back_again_and_again_is_no_progress(scene):
    one = scene("pick-box")
    watch = ProgressMonitor(OuterCfg(n_retry=5, attempt_s=0.2), ("above", "close", "lift"))
    stages = ["above", "close"] * 8
    assert any(watch.update(plan_report(one, 0.2 * k, stage, 5.0)) for k, stage in enumerate(stages))
    assert watch.returns >= 2


@pytest.mark.parametrize(("pace_m_s", "stuck"), [(0.035, False), (0.002, True)])
def test_an_object_on_its_way_is_progress_though_the_cost_stays_as_it_is(scene, pace_m_s, stuck):
    one = scene("pick-box")
    watch = ProgressMonitor(OuterCfg(), ("push",))
    seen = []
    for k in range(1, 200):
        box = one.now.objects["box"]
        moved = dataclasses.replace(box, position=box.position + np.array([pace_m_s * 0.04, 0.0, 0.0]))
        one.now = dataclasses.replace(one.now, objects={**one.now.objects, "box": moved})
        seen.append(watch.update(plan_report(one, 0.04 * k, "push", 5.0)))
    assert any(seen) == stuck


def test_an_object_that_goes_to_and_fro_is_no_progress(scene):
    one = scene("pick-box")
    watch, box = ProgressMonitor(OuterCfg(), ("push",)), one.now.objects["box"]
    seen = []
    for k in range(1, 200):
        moved = dataclasses.replace(box, position=box.position + np.array([0.03 * np.sin(k), 0.0, 0.0]))
        one.now = dataclasses.replace(one.now, objects={**one.now.objects, "box": moved})
        seen.append(watch.update(plan_report(one, 0.04 * k, "push", 5.0)))
    assert any(seen)


def test_when_stuck_the_plan_changes_and_the_diagnosis_is_kept(scene):
    one = scene("pick-box")
    strategist, told = begun(one, outer=SOON)
    assert first_change(strategist, one, "above", taken=(standing(one),)) is not None
    assert strategist.counts.repairs == 1
    stuck = next(fields for event, fields in told if event == "stuck")
    assert stuck["diagnosis"] == "not-reached"
    assert stuck["history"]
    assert stuck["evidence"][-1].startswith("Stage 'above' ends when `norm(self.ee_pos[:2] - self.box_pos[:2]) < 0.02`")
    repair = [fields for event, fields in told if event == "plan_answer"][-1]
    assert repair["kind"] == "cost-repair"
    assert repair["explanation"].startswith("Once more.")
    assert strategist.on_plan(plan_report(one, 9.0, "above", 5.0)) is None


class Regrouper:
    """One stage at first, two after a repair."""

    name = "regrouper"

    async def answer(self, question, rejections):
        if question.kind == "cost-function":
            code = "def state_cost(self):\n    return norm(self.ee_pos - self.box_pos)"
            return Reply(value=PlanAnswer(code=code), raw="")
        return Reply(value=RULES[question.kind](question.facts, rejections), raw="")


def test_after_a_repair_places_to_touch_are_asked_for_the_new_stages(scene):
    one = scene("pick-box")
    strategist, told = begun(one, Regrouper(), outer=SOON)
    other = first_change(strategist, one, "task")
    assert [stage.name for stage in other.stages] == NAMES
    regions = [fields for event, fields in told if event == "regions"]
    assert [(fields["failure"], fields["refused"]) for fields in regions] == [("", [])] * 2
    assert {region["stage"] for region in regions[1]["regions"]["box"]["regions"]} <= set(NAMES)


class Silent(Regrouper):
    """Has one plan, and no answer to a repair."""

    async def answer(self, question, rejections):
        if question.kind == "cost-repair":
            raise AdvisorUnavailable("no-network", "there is none", final=True)
        return Reply(value=RULES[question.kind](question.facts, rejections), raw="")


def test_a_plan_that_stays_keeps_the_places_that_it_was_made_for(scene):
    one = scene("pick-box")
    strategist, told = thinker(one, Silent(), outer=SOON)
    before = strategist.begin(one.trial, one.now, one.world)
    other = first_change(strategist, one, "above")
    assert [event for event, _ in told].count("regions") == 1
    assert [len(stage.guides) for stage in other.stages] == [len(stage.guides) for stage in before.stages]


def test_without_refinement_nothing_changes(scene):
    one = scene("pick-box")
    strategist, _ = begun(one, refine=False, outer=OuterCfg(n_retry=1, attempt_s=0.1))
    assert first_change(strategist, one, "above") is None
    assert strategist.counts.repairs == 0


@pytest.mark.parametrize("reason", ["success", "timeout"])
def test_without_memory_nothing_is_kept(scene, reason):
    one = scene("pick-box")
    strategist, told = begun(one)
    strategist.on_end(reason)
    assert "remembered" not in [event for event, _ in told]
    assert isinstance(one.world.beliefs[0]["box"], PhysicalParameters)


FRAGILE = (
    "def state_cost(self):\n    gap = norm(self.ee_pos - self.box_pos)\n"
    "    return {{'{term}': gap + 1.0 / max(0.0, {limit} - self.time)}}"
)


class Fragile:
    """Of its two stages the second has a cost that fails after five seconds, the repaired one after nine."""

    name = "fragile"

    def __init__(self):
        self.prompts = []

    async def answer(self, question, rejections):
        if question.kind not in ("cost-function", "cost-repair"):
            return Reply(value=RULES[question.kind](question.facts, rejections), raw="")
        self.prompts.append(question.prompt)
        limits = {"first": 99.0, "second": 5.0 if question.kind == "cost-function" else 9.0}
        stages = [
            StageAnswer(name=name, code=FRAGILE.format(term=name, limit=limit), done="self.box_pos[2] > 0.1")
            for name, limit in limits.items()
        ]
        return Reply(value=PlanAnswer(stages=stages), raw="")


def evaluated(one, stage, t):
    """Names of the terms of the stage's cost at a time."""
    state = one.world.present(one.now)
    values = {name: state[name] for name in state.names()}
    return list(stage.cost(Context({**values, "time": np.full((1, 1), t)}, (1, 1))))


@pytest.fixture
def fragile(scene):
    one, advisor = scene("pick-box"), Fragile()

    def make(**cfg):
        strategist, told = thinker(one, advisor, regions=False, **cfg)
        return one, advisor, strategist, told, strategist.begin(one.trial, one.now, one.world).stages

    return make


def test_a_cost_that_fails_in_use_is_repaired_with_the_reason_and_its_line(fragile):
    one, advisor, strategist, told, stages = fragile()
    with pytest.raises(CostError) as caught:
        evaluated(one, stages[1], 6.0)
    other = strategist.on_cost_error(caught.value, "second", one.now)
    assert "in stage 'second', line 3" in advisor.prompts[1].partition("did not even run")[2]
    assert evaluated(one, other.stages[1], 6.0) == ["second"]
    assert [fields["stage"] for event, fields in told if event == "cost_error"] == ["second"]


def test_a_failing_cost_is_final_where_nothing_may_be_tried(fragile):
    one, advisor, strategist, _, stages = fragile(refine=False)
    with pytest.raises(CostError) as caught:
        evaluated(one, stages[1], 6.0)
    assert strategist.on_cost_error(caught.value, "second", one.now) is None
    assert len(advisor.prompts) == 1


def test_a_unified_mind_asks_once_and_believes_what_it_hears(scene):
    one = scene("pick-box")
    strategist, told = thinker(one, unified=True)
    strategy = strategist.begin(one.trial, one.now, one.world)
    assert [stage.name for stage in strategy.stages] == NAMES
    assert strategy.stages[0].guides
    assert strategist.counts.advisor_calls == 1
    assert [event for event, _ in told if event != "verdict"] == ["beliefs", "plan_answer"]
    assert one.world.beliefs[0]["box"].mass_kg == pytest.approx(dict(told)["beliefs"]["box"][0], abs=1e-4)


class Unified:
    """Answers everything at once, first with a mass that no hand can move."""

    name = "unified"

    def __init__(self):
        self.heard, self.prompts = [], []

    async def answer(self, question, rejections):
        assert question.kind == "unified"
        self.prompts.append(question.prompt)
        self.heard += [rejection.reason for rejection in rejections]
        value = RULES["unified"](question.facts, ())
        if not rejections:
            value = value.model_copy(
                update={"parameters": {"box": ParameterEstimate(mass_kg=900.0, friction_coeff=0.5)}}
            )
        return Reply(value=value, raw="")


def test_one_wrong_part_refuses_a_unified_answer_as_a_whole(scene):
    one, advisor = scene("pick-box"), Unified()
    _, told = begun(one, advisor, unified=True)
    assert "900" in advisor.heard[0]
    assert one.world.beliefs[0]["box"].mass_kg < 20.0
    assert "regions" in advisor.prompts[0]
    assert next(fields["attempts"] for event, fields in told if event == "plan_answer") == 2


def test_a_unified_mind_that_is_stuck_asks_its_one_question_with_the_history(scene):
    one, advisor = scene("pick-box"), Unified()
    strategist, told = begun(one, advisor, unified=True, outer=SOON)
    assert first_change(strategist, one, "above", taken=(standing(one),)) is not None
    assert "What happened lately" in advisor.prompts[-1]
    assert "correction" not in [event for event, _ in told]


@pytest.fixture
def corrected(scene, monkeypatch):
    """A strategist to which a box is moved on, 5 mm in each plan of 0.1 s; the times at which it corrects are noted."""

    def run(plans, last=True, **cfg):
        one, noted = scene("pick-box"), []
        strategist, _ = thinker(one, **cfg)
        monkeypatch.setattr(thinking, "correct_beliefs", lambda asker, name, now, *_: noted.append((name, now.time_s)))
        strategist.begin(one.trial, one.now, one.world)
        box = one.now.objects["box"]
        for k in range(1, plans + 1):
            after = dataclasses.replace(box, position=box.position + np.array([0.005, 0.0, 0.0]))
            here, there = (
                dataclasses.replace(one.now, time_s=0.1 * (k - 1 + n), objects={"box": body})
                for n, body in enumerate((box, after))
            )
            step = Transition(here, HandTarget(one.now.tool.position, one.now.tool.quaternion, 0.08, 600.0), there)
            assert strategist.on_plan(plan_report(one, 0.1 * k, "above", 50.0 - k, (step,))) is None
        if last:
            strategist.on_end("timeout")
        return [name for name, _ in noted], [round(time, 3) for _, time in noted]

    return run


def test_by_default_nothing_is_corrected_that_is_not_stuck(corrected):
    assert corrected(30) == ([], [])


def test_the_world_model_is_corrected_at_intervals_and_once_at_the_end(corrected):
    names, times = corrected(25, correct_every_s=0.4)
    assert times == [0.4, 0.8, 1.2, 1.6, 2.5]
    assert set(names) == {"box"}


@pytest.mark.parametrize("off", [{"refine": False}, {"unified": True}])
def test_variants_without_corrections_have_none_at_intervals_either(corrected, off):
    assert corrected(12, correct_every_s=0.5, **off) == ([], [])
