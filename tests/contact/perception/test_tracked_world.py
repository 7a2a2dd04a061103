import dataclasses
import json

import numpy as np
import pytest
from episodes import COARSE, ObedientWorld, make_trial, strategy

from coral.contact.episode import episode as module
from coral.contact.episode.episode import Episode
from coral.contact.perception.camera import RgbdCameraCfg, RgbdFrame
from coral.contact.perception.tracked_cfg import TrackedCfg, make_camera
from coral.contact.perception.tracked_world import TrackedWorld
from coral.contact.scene.observation import HandTarget
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.strategist import FixedStrategist
from coral.contact.worlds.hand_world import HandWorld
from coral.contact.worlds.robot_world import WorldError
from coral.errors import InputError

SMALL = TrackedCfg(camera=RgbdCameraCfg(width=160, height=120))


class Scripted:
    """The usual camera, but some pictures do not come, or do not show any object."""

    def __init__(self, world, trial, cfg, off=lambda k: False, covered=lambda k: False, hidden=None):
        self._hidden = hidden
        self._camera, self._off, self._covered, self.taken = make_camera(world.model, trial, cfg), off, covered, 0

    def take(self, data, rng):
        self.taken += 1
        frame: RgbdFrame = self._camera.take(data, rng)
        if self._off(self.taken):
            return None
        if self._hidden and self._hidden[1](self.taken):
            return dataclasses.replace(frame, instance=np.where(frame.mask(self._hidden[0]), 0, frame.instance))
        blank = np.zeros_like(frame.instance)
        return dataclasses.replace(frame, instance=blank) if self._covered(self.taken) else frame


def tracked(cfg=SMALL, seed=0, task="pick-box", **script):
    trial = sample_trial(load_task(task) if isinstance(task, str) else task, seed)
    world = HandWorld(trial)
    made = TrackedWorld(world, trial, cfg, np.random.default_rng(seed))
    made._eye = Scripted(world, trial, cfg, **script)
    return made


def rest(now):
    return HandTarget(now.tool.position, now.tool.quaternion, now.opening_m, 600.0)


def rest_until(world, now, time_s):
    while now.time_s < time_s:
        now = world.step(rest(now))


def test_objects_are_found_and_stay_where_they_are():
    world = tracked()
    now = world.reset()
    for _ in range(10):
        now = world.step(rest(now))
    seen = world.compare(now, world.truth())["box"]
    assert (seen.off_m < 0.004, seen.off_rad < 0.06, seen.lost) == (True, True, False)
    assert not now.objects["box"].velocity.any()
    assert world.news() == []


def test_poses_are_late_and_carried_on():
    world = tracked()
    now = world.reset()
    joint = world.simulation.model.joint("box_free")
    places = []
    for _ in range(25):
        world.simulation.data.qvel[joint.dofadr[0]] = 0.2  # slides at an even speed, whatever friction says
        now = world.step(rest(now))
        places.append(world.truth().objects["box"].position[0])
    speed = (places[-1] - places[-11]) / 0.2
    assert speed > 0.1
    assert now.objects["box"].velocity[0] == pytest.approx(speed, abs=0.04)
    assert abs(now.objects["box"].position[0] - places[-1]) < 0.03 * speed  # pictures alone are 40 to 60 ms late


def test_a_covered_object_stays_where_it_was_and_is_found_again():
    world = tracked(covered=lambda k: 6 <= k <= 10)
    now = world.reset()
    before = now.objects["box"].position
    said = []
    for _ in range(40):
        now = world.step(rest(now))
        said += world.news()
        assert now.lost == ({"box"} if said and said[-1]["lost"] else set())
        assert now.unseen == frozenset()
        assert np.linalg.norm(now.objects["box"].position - before) < 0.005
    assert [(one["object"], one["lost"]) for one in said] == [("box", True), ("box", False)]
    assert said[0]["reason"] == "not seen"
    assert said[1]["after_s"] == pytest.approx(0.2, abs=0.021)


def test_the_hand_retreats_for_a_while_from_what_it_may_cover():
    cfg = dataclasses.replace(SMALL, retreat_after_s=0.2, retreat_s=0.1)
    world = tracked(cfg, covered=lambda k: k >= 4)
    now = world.reset()
    up = []
    for _ in range(30):
        target = world.retreat(rest(now), now)
        up.append(bool(target.position[2] > now.tool.position[2]))
        now = world.step(rest(now))
    assert not any(up[:12])
    assert 4 <= sum(up) <= 12
    assert not up[up.index(True) + 6]


@pytest.mark.parametrize(("goal", "retreats"), [(0, True), (1, False)])
def test_it_retreats_only_from_what_the_goal_is_about(goal, retreats):
    task = load_task("pick-box")
    items = tuple(task.objects[0].model_copy(update={"name": f"box{k}", "y": (0.2 * k, 0.2 * k)}) for k in (0, 1))
    success = task.success.model_copy(update={"conditions": (_lifted(task, f"box{goal}"),)})
    world = tracked(
        dataclasses.replace(SMALL, retreat_after_s=0.04),
        task=task.model_copy(update={"objects": items, "success": success}),
        hidden=("box0", lambda k: k >= 4),
    )
    now = world.reset()
    for _ in range(9):
        now = world.step(rest(now))
    assert [one["object"] for one in world.news()] == ["box0"]
    assert bool(world.retreat(rest(now), now).position[2] > now.tool.position[2]) is retreats


def test_what_is_not_found_at_first_ends_the_episode():
    world = tracked(covered=lambda k: True)
    with pytest.raises(WorldError, match="box \\(not seen\\)") as caught:
        world.reset()
    assert caught.value.code == "not-found"


def test_what_is_hidden_at_first_has_a_guessed_pose_until_a_picture_shows_it():
    task = load_task("pick-box")
    items = tuple(task.objects[0].model_copy(update={"name": f"box{k}", "y": (0.2 * k, 0.2 * k)}) for k in (0, 1))
    success = task.success.model_copy(update={"conditions": (_lifted(task, "box1"),)})
    world = tracked(
        dataclasses.replace(SMALL, search_s=0.1, retreat_after_s=0.04),
        task=task.model_copy(update={"objects": items, "success": success}),
        hidden=("box1", lambda k: k < 12),
    )
    now = world.reset()
    assert now.unseen == {"box1"}
    assert now.objects["box1"].position[1] == pytest.approx(0.2)
    for _ in range(30):
        now = world.step(rest(now))
    assert now.unseen == frozenset()
    assert [(one["object"], one["lost"]) for one in world.news()] == [("box1", True), ("box1", False)]


def _lifted(task, name):
    return task.success.conditions[0].model_copy(update={"object": name})


def test_the_hand_waits_for_an_object_that_is_found_late():
    now = tracked(covered=lambda k: k < 12).reset()
    assert 0.0 < now.time_s < 1.0


def test_a_camera_without_pictures_is_off():
    world = tracked(off=lambda k: k > 5)
    now = world.reset()
    with pytest.raises(WorldError, match=r"no picture since 0\.08 s") as caught:
        rest_until(world, now, 0.75)
    assert caught.value.code == "camera-off"


def test_a_missing_picture_is_no_loss():
    world = tracked(off=lambda k: k % 3 == 0)
    now = world.reset()
    for _ in range(20):
        now = world.step(rest(now))
    assert world.news() == []


def test_a_world_of_which_no_pictures_can_be_made_is_refused():
    trial = make_trial()
    with pytest.raises(InputError, match="ground-truth"):
        TrackedWorld(ObedientWorld(trial), trial, SMALL, np.random.default_rng(0))


def test_the_same_seed_gives_the_same_files(tmp_path):
    cfg = dataclasses.replace(COARSE, poses="tracked", tracked=SMALL)
    results = []
    for name in ("first", "second"):
        one = Episode(make_trial(0.2), "hand", FixedStrategist(strategy()), cfg, tmp_path / name, variant="expert")
        results.append(one.run())
    for name in ("metrics.json", "events.jsonl", "trajectory.csv"):
        assert (tmp_path / "first" / name).read_bytes() == (tmp_path / "second" / name).read_bytes()
    assert results[0]["poses"] == "tracked"
    assert results[0]["track_lost"] == 0
    assert 0.0 < results[0]["pose_error_mm"] < 5.0


def test_an_episode_tells_what_was_not_found(tmp_path, monkeypatch):
    cfg = dataclasses.replace(COARSE, poses="tracked", tracked=dataclasses.replace(SMALL, search_s=0.0))

    def covered(world, trial, *given):
        made = TrackedWorld(world, trial, *given)
        made._eye = Scripted(world, trial, SMALL, covered=lambda k: True)
        return made

    monkeypatch.setattr(module, "TrackedWorld", covered)
    result = Episode(
        make_trial(0.2), "hand", FixedStrategist(strategy()), cfg, tmp_path / "run", variant="expert"
    ).run()
    assert (result["success"], result["end_reason"], result["poses"]) == (False, "not-found", "tracked")
    last = json.loads((tmp_path / "run" / "events.jsonl").read_text().splitlines()[-1])
    assert "box (not seen)" in last["detail"]
