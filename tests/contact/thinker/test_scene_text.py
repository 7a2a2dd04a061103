from contact_bench import make_trial, plain, seen

from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.scene.trial import PhysicalParameters
from coral.contact.thinker.scene_facts import scene_facts
from coral.contact.thinker.scene_text import condition_text, planner_text, scene_text

BOX = plain()["objects"][0]
AT = {"object": "box", "kind": "at", "place": "goal", "point": None, "tolerance_m": 0.02, "axes": "xy"}


def text(beliefs=None, **changes):
    trial = make_trial(**changes)
    return scene_text(scene_facts(trial, seen(trial), beliefs), 0.5, 30.0)


def test_conditions_of_success_have_all_their_values_and_what_they_ask_for():
    said = condition_text(AT)
    assert said.startswith("at (object box, place goal, tolerance_m 0.02, axes xy): The object's centre")
    assert condition_text(AT, brief=True) == "at (object box, place goal, tolerance_m 0.02, axes xy)"


def test_a_condition_of_an_unknown_kind_has_its_values():
    assert condition_text({"kind": "levitating", "height_m": 2.0}) == "levitating (height_m 2)"


def test_the_scene_tells_which_way_the_axes_point_and_what_success_is():
    said = text()
    for words in ("x points away from the robot", "left means larger y", "Success, within 30 s", "for 0.5 s"):
        assert words in said


def test_beliefs_are_shown_once_there_are_any():
    assert "believed mass" not in text()
    assert "believed mass 1.5 kg, friction 0.4" in text({"box": PhysicalParameters(1.5, 0.4)})


def test_parts_are_shown_where_they_are_more_than_the_bounding_box():
    assert "part [" not in text(objects=[BOX])
    two = [{"size": [0.06, 0.04, 0.02]}, {"size": [0.02, 0.02, 0.02], "position": [0.04, 0.0, 0.0]}]
    assert text(objects=[BOX | {"parts": two}]).count("part [") == 2


def test_the_planner_tells_its_horizon_and_its_speeds():
    said = planner_text(ControllerCfg(horizon=25, speed_m_s=0.7), 0.04)
    for words in ("1 s ahead", "steps of 0.04 s", "0.7 m/s", "x -0.35 to 0.4"):
        assert words in said
