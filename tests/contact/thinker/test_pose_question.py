import dataclasses
import json

import numpy as np
import pytest
from episodes import COARSE, short_task
from recorded import RULES

from coral.advisor.consult import Outcome
from coral.advisor.rules import RuleAdvisor
from coral.contact.episode.episode import Episode
from coral.contact.episode.variants import AdvisorSetup, make_strategist
from coral.contact.perception.advisor_camera import AdvisorCameraCfg, make_advisor_camera
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.scene.geometry import rotation_of
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.pose_question import (
    ObjectPose,
    PosesAnswer,
    ask_poses,
    pose_facts,
    verify_poses,
)
from coral.contact.worlds.hand_world import HandWorld


def guess(facts):
    """Everything upright in the middle of the table."""
    one = ObjectPose(position=(0.0, 0.0, 0.05), quaternion=(1.0, 0.0, 0.0, 0.0))
    return PosesAnswer(dict.fromkeys(facts["objects"], one))


@pytest.fixture(scope="module")
def clutter():
    """A trial, the truth of where things are, and the facts of its first picture."""
    trial = sample_trial(load_task("pick-clutter"), 0)
    world = HandWorld(trial)
    first = world.reset()
    frame = make_advisor_camera(
        world, trial, TrackedCfg(), AdvisorCameraCfg(width=320, height=240), np.random.default_rng(0)
    )()
    return trial, first, pose_facts(trial, dataclasses.replace(first, objects={}), frame)


@pytest.fixture(scope="module")
def board():
    """A trial with an object whose frame is not in the middle of it, its first observation and first picture."""
    trial = sample_trial(load_task("push-pick-board"), 3)
    world = HandWorld(trial)
    first = world.reset()
    frame = make_advisor_camera(
        world, trial, TrackedCfg(), AdvisorCameraCfg(width=320, height=240), np.random.default_rng(0)
    )()
    return trial, first, frame


def middle(trial, body):
    """Centre of the board's bounding box, in the world."""
    corners = trial.corners("board")
    return body.position + rotation_of(body.quaternion) @ ((corners.min(axis=0) + corners.max(axis=0)) / 2)


def test_an_answer_is_the_middle_of_the_object_and_becomes_its_origin(board):
    trial, first, frame = board
    true = first.objects["board"]
    centre = middle(trial, true)
    assert np.linalg.norm(centre - true.position) == pytest.approx(0.055, abs=1e-6)

    class Model:
        source = "advisor"

        def ask(self, kind, schema, facts, shown, verify, pictures):
            assert shown["objects"]["board"]["points_m"]["handle"] == pytest.approx([0.0, 0.145, 0.0])
            answer = PosesAnswer({"board": ObjectPose(position=tuple(centre), quaternion=tuple(3 * true.quaternion))})
            assert verify(answer) is None
            return Outcome(answer=answer, question=None, attempts=1)

    found = ask_poses(Model(), trial, first, frame, lambda *given, **fields: None)["board"]
    np.testing.assert_allclose(found.position, true.position, atol=1e-5)
    np.testing.assert_allclose(found.quaternion, true.quaternion, atol=1e-9)


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"position": (9.0, 0.0, 0.05)}, "place"),
        ({"position": (0.0, 0.0, -0.3)}, "place"),
        ({"quaternion": (0.0, 0.0, 0.0, 0.0)}, "pose"),
        ({"position": (0.0, float("nan"), 0.0)}, "pose"),
    ],
)
def test_impossible_poses_are_refused(clutter, change, code):
    _, _, facts = clutter
    right = guess(facts)
    assert verify_poses(right, facts) is None
    name = next(iter(right.root))
    wrong = ObjectPose(**{**right.root[name].model_dump(), **change})
    assert verify_poses(PosesAnswer({**right.root, name: wrong}), facts).code == code
    assert verify_poses(PosesAnswer({name: right.root[name]}), facts).code == "objects"


class LooksOnce(RuleAdvisor):
    """Guesses a pose of everything, and otherwise answers as the recorded model did."""

    def __init__(self):
        super().__init__({**RULES, "object-poses": lambda facts, rejections: guess(facts)}, "looks-once")


def test_an_episode_without_tracking_asks_for_poses_first_and_says_so(tmp_path):
    task = short_task()
    strategist = make_strategist("no-tracking", task, AdvisorSetup(given=LooksOnce(), folder=tmp_path / "run"))
    result = Episode(
        sample_trial(task, 0), "hand", strategist, COARSE, tmp_path / "run", variant="no-tracking", advisor="looks-once"
    ).run()
    assert (result["poses"], result["end_reason"], result["advisor_calls"]) == ("guessed", "timeout", 4)
    assert result["pose_error_mm"] > 1
    kinds = [json.loads(line)["kind"] for line in (tmp_path / "run" / "attempts.jsonl").open()]
    assert kinds == ["object-poses", "physical-parameters", "cost-function", "contact-regions"]


def test_without_poses_there_is_no_episode(tmp_path):
    task = short_task()
    strategist = make_strategist("no-tracking", task, AdvisorSetup(folder=tmp_path / "run"))
    result = Episode(sample_trial(task, 0), "hand", strategist, COARSE, tmp_path / "run", variant="no-tracking").run()
    assert result["end_reason"] == "no-decision: poses"
