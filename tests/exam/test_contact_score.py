import math

import pytest

from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.thinker.pose_question import PosesAnswer
from coral.contact.world_model.parameter_correction import ParametersAnswer
from coral.contact.world_model.parameter_estimates import ParameterEstimates
from coral.exam.contact_score import score_correction, score_estimates, score_poses, score_regions

SIZE = {"box": {"size_m": [0.1, 0.1, 0.1], "mass_kg": 2.0, "friction": 0.5}}
TRUE = {"parameters": {"box": {"mass_kg": 1.0, "friction": 0.5}}}


def estimate(mass, friction):
    return ParameterEstimates.model_validate({"box": {"mass_kg": mass, "friction_coeff": friction}})


def test_estimates_by_the_logarithm_of_the_error():
    facts = {"objects": SIZE}
    assert score_estimates(TRUE, facts, estimate(1.0, 0.5)).score == pytest.approx(1.0)
    assert score_estimates(TRUE, facts, estimate(2.0, 0.5)).score == pytest.approx(0.75 * 0.5 + 0.25)
    assert score_estimates(TRUE, facts, estimate(0.5, 0.5)).score == pytest.approx(0.75 * 0.5 + 0.25)
    assert score_estimates(TRUE, facts, estimate(4.0, 1.0)).score == pytest.approx(0.0)
    assert score_estimates(TRUE, facts, estimate(-1.0, 0.5)).why == "refused: bounds"


def correct(mass, friction):
    key = {"object": "box", "parameters": {"mass_kg": 1.0, "friction": 0.5}}
    answer = ParametersAnswer.model_validate({"objects": [{"label": "box", "mass": mass, "friction": friction}]})
    return score_correction(key, {"objects": SIZE}, answer).score


def test_a_belief_that_stays_is_worth_nothing():
    assert correct(2.0, 0.5) == 0.0
    assert correct(1.0, 0.5) == pytest.approx(1.0)
    assert correct(math.sqrt(2.0), 0.5) == pytest.approx(0.5)
    assert correct(8.0, 0.5) == 0.0


def pose(position, quaternion, symmetry="box"):
    key = {"poses": {"box": {"position": [0.0, 0.0, 0.05], "quaternion": [1, 0, 0, 0], "symmetry": symmetry}}}
    answer = PosesAnswer.model_validate({"box": {"position": position, "quaternion": quaternion}})
    return score_poses(key, {}, answer).score


def test_poses_by_place_and_turn():
    quarter, ten = math.sqrt(0.5), math.radians(10.0)
    assert pose([0, 0, 0.05], [2, 0, 0, 0]) == pytest.approx(1.0)
    assert pose([0, 0, 0.05], [0, 0, 0, 1]) == pytest.approx(1.0)  # half a turn of a box
    assert pose([0, 0, 0.05], [0, 0, 0, 1], "none") == pytest.approx(0.6)
    assert pose([0, 0, 0.05], [quarter, 0, 0, quarter]) == pytest.approx(0.6)
    assert pose([0, 0, 0.05], [quarter, 0, 0, quarter], "square-box") == pytest.approx(1.0)
    assert pose([0, 0, 0.05], [0.3, 0, 0, 0.95], "cylinder") == pytest.approx(1.0)
    assert pose([0.015, 0, 0.05], [math.cos(ten / 2), 0, 0, math.sin(ten / 2)]) == pytest.approx(0.3 + 0.2)
    assert pose([0.2, 0, 0.05], [1, 0, 0, 0]) == 0.0


def scene():
    box = {
        "label": "box",
        "size_m": [0.06, 0.1, 0.06],
        "pose": [0.0, 0.0, 0.03, 1.0, 0.0, 0.0, 0.0],
        "shapes": ["box"],
        "solid_share": 1.0,
        "parts": [{"size_m": [0.06, 0.1, 0.06], "position": [0.0, 0.0, 0.0]}],
        "points": {},
    }
    table = {"x": [-0.4, 0.4], "y": [-0.4, 0.4]}
    return {"objects": {"box": box}, "table": table, "fixtures": {}, "stages": ["go"]}


def touch(*regions):
    key = {"touches": [{"object": "box", "how": ["push", "press"], "side": [-1.0, 0.0, 0.0]}]}
    return score_regions(key, scene(), RegionsAnswer.model_validate({"box": {"regions": list(regions)}}))


def test_places_by_surface_and_side():
    behind = {"center": [-0.03, 0.0, 0.0], "normal": [-1.0, 0.0, 0.0], "approach": "push"}
    before = {"center": [0.03, 0.0, 0.0], "normal": [1.0, 0.0, 0.0], "approach": "push"}
    assert touch(behind).score == 1.0
    assert touch(before).score == 0.0
    assert touch(behind, before).score == 0.5  # naming all sides does not help
    assert touch({**behind, "center": [-0.2, 0.0, 0.0]}).why.startswith("refused")
    assert touch({**behind, "approach": "pinch"}).score == 0.0
