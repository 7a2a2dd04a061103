"""LIBERO's own environment behind our interface, without LIBERO: a stand-in answers as its program does."""

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from coral.contact.scene.observation import HandTarget
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.evaluation_world import WorldError

PALM_DOWN = np.diag([1.0, -1.0, -1.0])


@pytest.fixture(scope="module")
def inside():
    folder = str(Path(__file__).parents[2] / "benchmarks")
    sys.path.insert(0, folder)
    try:
        import libero_inside

        yield libero_inside
    finally:
        sys.path.remove(folder)
        for name in ("libero", "libero_inside"):
            sys.modules.pop(name, None)


class StandIn:
    """Answers with a hand that does not move and two objects, of which the task knows one."""

    def __init__(self, inside):
        axes = PALM_DOWN @ inside.TOOL_IN_SITE.T
        self.asked = []
        self.state = {
            "time_s": 0.0,
            "position": [-0.05, 0.0, 0.3],
            "axes": axes.tolist(),
            "velocity": [0.0, 0.0, 0.0],
            "spin": [0.0, 0.0, 0.0],
            "fingers": [0.04, -0.04],
            "force": [0.0, 0.0, -9.81],
            "solved": False,
            "objects": {"box_1": [[0.1, 0.0, 0.03], [1, 0, 0, 0]], "plate_1": [[0.2, 0.2, 0.0], [1, 0, 0, 0]]},
            "camera": {
                "lens": [200.0, 200.0, 79.5, 59.5],
                "position": [1.0, 0.0, 1.0],
                "axes": np.eye(3).tolist(),
                "names": ["box_1", "plate_1", "robot"],
            },
        }

    def ask(self, do, **fields):
        self.asked.append((do, fields))
        return self.state


@pytest.fixture
def link(inside):
    return StandIn(inside)


@pytest.fixture
def scene(inside, link):
    trial = sample_trial(load_task("pick-box"), 0)
    package = SimpleNamespace(problem=lambda task: f"{task}.bddl", states=lambda task: f"{task}.npz")
    return inside.LiberoScene(link, trial, package, "soup", 7)


def target(scene, offset=(0.0, 0.0, 0.0), opening=0.08):
    tool = scene.reset().tool
    return HandTarget(tool.position + offset, tool.quaternion, opening, 600.0)


def test_it_makes_the_task_in_the_state_that_was_asked_for(scene, link):
    do, fields = link.asked[0]
    assert do == "make"
    assert (fields["problem"], fields["states"], fields["state"], fields["wait"]) == ("soup.bddl", "soup.npz", 7, 10)


def test_what_it_sees_is_in_our_frame_and_of_the_task_only(scene):
    now = scene.reset()
    assert now.tool.position == pytest.approx([0.05, 0.0, 0.3])
    assert list(now.objects) == ["box"]
    assert now.objects["box"].position == pytest.approx([0.2, 0.0, 0.03])
    assert now.wrench == pytest.approx(np.zeros(6))


def test_a_target_where_the_hand_is_asks_for_no_motion(scene, link):
    scene.step(target(scene))
    assert link.asked[-1][1]["action"] == pytest.approx([0.0] * 7, abs=1e-9)


def test_an_action_accelerates_the_hand_as_the_spring_would(scene, link, inside):
    scene.step(target(scene, (0.01, 0.0, -0.005)))
    action = np.array(link.asked[-1][1]["action"][:3])
    spring = 600.0 / scene._hand.mass_kg * np.array([0.01, 0.0, -0.005])
    assert inside.KP * inside.STEP_M * action == pytest.approx(spring)


def test_a_far_target_keeps_its_direction_within_the_actions_bounds(scene, link):
    scene.step(target(scene, (0.4, 0.0, -0.2)))
    assert link.asked[-1][1]["action"][:3] == pytest.approx([1.0, 0.0, -0.5])


def test_fingers_close_a_centimetre_a_step_and_hold_on(scene, link):
    for _ in range(10):
        scene.step(target(scene, opening=-0.04))
        assert link.asked[-1][1]["action"][6] == 1.0
    for expected in (-1.0, -1.0, 0.0):
        scene.step(target(scene, opening=0.02))
        assert link.asked[-1][1]["action"][6] == expected


def test_the_verdict_is_liberos_own(scene, link, inside):
    referee = inside.LiberoReferee(scene)
    state = scene.truth()
    assert referee.end_reason(state, time_left=True) == ""
    assert referee.end_reason(state, time_left=False) == "timeout"
    link.state["solved"] = True
    assert referee.end_reason(state, time_left=True) == "success"


def test_a_program_that_has_ended_is_a_lost_link(inside, tmp_path):
    package = SimpleNamespace(root=tmp_path)
    link = inside.Link(Path("/bin/true"), package)
    with pytest.raises(WorldError) as lost:
        link.ask("picture")
    assert lost.value.code == "link-lost"
    link.close()


def test_a_trial_that_a_stopped_run_left_begins_anew(inside, tmp_path):
    left = tmp_path / "runs" / "task"
    left.mkdir(parents=True)
    (left / "events.jsonl").write_text("{}\n")
    assert inside.cleared(left) == left
    assert not left.exists()
    assert inside.cleared(left) == left
