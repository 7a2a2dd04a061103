import dataclasses

import pytest
from contact_bench import make_trial, plain, seen

from coral.advisor.prompt import render
from coral.contact.control.hand_controllers import PlannerLimits
from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.quantities import task_schema_of
from coral.contact.plan.plan_check import OPENING_M
from coral.contact.scene.trial import PhysicalParameters
from coral.contact.thinker.scene_facts import scene_facts
from coral.contact.thinker.scene_text import condition_text, planner_text, scene_text, success_text, world_prompt
from coral.contact.thinker.think_cfg import ThinkCfg
from coral.mppi.knots import KnotMppiCfg

BOX = plain()["objects"][0]
REPAIR = {"attempts": 3, "code": "pass"} | dict.fromkeys(
    ("stage", "diagnosis", "evidence", "corrected", "earlier", "advice", "regions", "history", "terms"), ""
)
REPAIR |= {"explanation": "", "error": ""}
AT = {"object": "box", "kind": "at", "place": "goal", "point": None, "tolerance_m": 0.02, "axes": "xy"}


def text(beliefs=None, **changes):
    trial = make_trial(**changes)
    return scene_text(scene_facts(trial, seen(trial), beliefs))


def test_conditions_of_success_have_all_their_values_and_what_they_ask_for():
    said = condition_text(AT)
    assert said.startswith("at (object box, place goal, tolerance_m 0.02, axes xy): The object's centre")
    assert condition_text(AT, brief=True) == "at (object box, place goal, tolerance_m 0.02, axes xy)"


def test_a_condition_of_an_unknown_kind_has_its_values():
    assert condition_text({"kind": "levitating", "height_m": 2.0}) == "levitating (height_m 2)"


def test_the_scene_tells_which_way_the_axes_point():
    assert "x points away from the robot" in text()
    assert "left means larger y" in text()


def test_success_tells_its_time_and_its_hold():
    assert success_text({"goals": []}, 0.5, 30.0) == ["Success, within 30 s: all of these at once, for 0.5 s:"]


@pytest.mark.parametrize("strategy", [True, False])
def test_a_prompt_tells_as_much_as_it_is_configured_to(strategy):
    trial = make_trial()
    facts = scene_facts(trial, seen(trial), {"box": PhysicalParameters(1.5, 0.4)})

    def shown(prompt):
        cfg = ThinkCfg(prompt=prompt, strategy=strategy)
        return render("cost-function", world_prompt(facts, trial.task, task_schema_of(trial.task), cfg, LIMITS))[0]

    paper, words, full = shown("paper"), shown("words"), shown("full")
    thresholds, hand, stages = "Success, within", "The hand: two fingers", "`stages`: a list"
    assert [thresholds in one for one in (paper, words, full)] == [False, False, True]
    assert [hand in one for one in (paper, words, full)] == [False, True, True]
    assert [stages in one for one in (paper, words, full)] == [False, strategy, strategy]
    assert '"box": {"label": "box", "mass_kg": 1.5' in paper
    assert '"goal": [' in paper
    assert all(trial.task.instruction in one for one in (paper, words, full))


def test_beliefs_are_shown_once_there_are_any():
    assert "believed mass" not in text()
    assert "believed mass 1.5 kg, friction 0.4" in text({"box": PhysicalParameters(1.5, 0.4)})


def test_parts_are_shown_where_they_are_more_than_the_bounding_box():
    assert "part [" not in text(objects=[BOX])
    two = [{"size": [0.06, 0.04, 0.02]}, {"size": [0.02, 0.02, 0.02], "position": [0.04, 0.0, 0.0]}]
    assert text(objects=[BOX | {"parts": two}]).count("part [") == 2


def test_numbers_are_told_to_the_millimetre_and_small_ones_to_three_digits():
    said = text({"box": PhysicalParameters(0.0123456, 0.45678)})
    assert "believed mass 0.0123 kg, friction 0.457" in said


def test_what_is_said_of_a_field_that_is_not_set_is_left_out():
    lifted = {"object": "box", "kind": "lifted", "height_m": 0.05, "most_m": None}
    assert "most_m" not in condition_text(lifted)
    assert "With `most_m`" in condition_text({**lifted, "most_m": 0.3})


def test_conditions_inside_a_condition_are_explained_once():
    slid = {"object": "box", "kind": "slid", "thing": "table", "distance_m": 0.06}
    trial = make_trial()
    facts = scene_facts(trial, seen(trial))
    goals = [{"object": "box", "kind": "sequence", "events": [[slid], [AT]], "for_s": 0.1}, AT]
    said = "\n".join(success_text({**facts, "goals": goals}, 0.5, 30.0))
    assert "slid: The hand slid the object" in said
    assert said.count("is within `tolerance_m` of a place") == 1


def test_a_condition_on_several_objects_is_told_once():
    said = success_text({"goals": [AT, {**AT, "object": "cup"}, {**AT, "tolerance_m": 0.3}]}, 0.5, 30.0)
    assert said[2] == "2. The same of cup."
    assert said[3].startswith("3. at (object box, place goal, tolerance_m 0.3")


LIMITS = PlannerLimits(ControllerCfg(horizon=25, speed_m_s=0.7, mppi=KnotMppiCfg(samples=64)), 0.04, 0.08)


def test_the_planner_tells_its_horizon_its_speeds_and_its_force():
    said = planner_text(dataclasses.replace(LIMITS, press_n=20.0))
    for words in (
        "64 futures of 1 s",
        "anew every 0.08 s.",
        "0.7 m/s",
        "presses with 20 N",
        "its target 6 cm ahead",
        "x -0.35 to 0.4",
    ):
        assert words in said
    assert "avoids pressing with more than 10 N on table and fixed things" in said
    free = dataclasses.replace(LIMITS.controller, press_weight=0.0)
    assert "avoids" not in planner_text(dataclasses.replace(LIMITS, controller=free))


def test_the_planner_tells_that_its_plans_are_late():
    assert "follows the one before" not in planner_text(LIMITS)
    assert "a plan takes 0.12 s, in which the hand follows" in planner_text(
        dataclasses.replace(LIMITS, late_s=0.1200001)
    )


def test_the_planner_tells_its_reach_and_the_base_and_limits_of_an_arm_where_there_is_one():
    flying, arm = planner_text(LIMITS), planner_text(dataclasses.replace(LIMITS, arm=True))
    clip = "The wrist 0.103 m behind it stays within 0.855 m of [-0.5, 0, 0.333]"
    assert f"{clip}. " in flying
    assert "Panda" not in flying
    assert f"{clip} (shoulder of a Panda based at [-0.5, 0, 0], whose joint limits and links exclude more). " in arm
    unbound = dataclasses.replace(LIMITS.controller, reach_m=0.0)
    assert "wrist" not in planner_text(dataclasses.replace(LIMITS, controller=unbound))


@pytest.mark.parametrize(("kind", "more"), [("cost-function", {}), ("cost-repair", REPAIR)])
def test_a_prompt_tells_the_range_of_openings_and_where_a_plan_begins(kind, more):
    trial = make_trial()
    facts = scene_facts(trial, seen(trial), {"box": PhysicalParameters(1.5, 0.4)})
    world = world_prompt(facts, trial.task, task_schema_of(trial.task), ThinkCfg(), LIMITS)
    text = render(kind, {**world, **more})[0]
    assert f"`opening` (there, {OPENING_M[0]:g} to {OPENING_M[1]:g} m)" in text
    assert ("`begin`: the stage to go on with, if not the first" in text) == bool(more)
    assert ("Your plan goes on at `begin`, or else at its first stage" in text) == bool(more)
    assert ("Your plan begins at its first stage" in text) == (not more)
