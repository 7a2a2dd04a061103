from dataclasses import replace

import numpy as np
import pytest

from coral.contact.perception.camera import RgbdCameraCfg
from coral.contact.perception.model_tracker import ModelTracker
from coral.contact.perception.object_model import from_trial
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.perception.tracked_object import MotionFilter, MotionFilterCfg
from coral.contact.real_scenes.posed_scene import PosedScene, scene_at_start
from coral.contact.scene.geometry import body_to_matrix, matrix_to_body, pose_matrix, rotation_about
from coral.contact.scene.observation import BodyState

CFG = TrackedCfg(camera=RgbdCameraCfg(width=240, height=180))


@pytest.fixture(scope="module")
def stage(trial):
    return PosedScene(trial, CFG)


@pytest.fixture(scope="module")
def at_rest(trial):
    return scene_at_start(trial)


def box_at(state, T_world_box, time_s=0.0):
    """Return the state with the box elsewhere."""
    return replace(state, time_s=time_s, objects={**state.objects, "box": matrix_to_body(T_world_box)})


def error(tracker, estimate, truth):
    shift, turn = tracker.model.symmetry.difference(estimate.T_world_object, truth)
    return 1e3 * shift, np.degrees(turn)


def test_a_mask_of_something_else_is_noticed_and_forgotten(stage, at_rest, trial):
    rng = np.random.default_rng(0)
    tracker = ModelTracker(from_trial(stage.model, trial, "box"))
    frame = stage.take(at_rest, rng)
    first = tracker.register(frame, frame.mask("box"))
    wrong = tracker.track(frame, frame.instance == 0)
    assert wrong.lost
    assert wrong.reason == "does not fit"
    np.testing.assert_array_equal(wrong.T_world_object, first.T_world_object)
    found = tracker.track(frame, frame.mask("box"))
    assert not found.lost
    assert error(tracker, found, body_to_matrix(at_rest.objects["box"]))[0] < 5


def test_a_narrow_strip_beside_the_hand_is_called_covered(stage, at_rest, trial):
    tracker = ModelTracker(from_trial(stage.model, trial, "box"))
    frame = stage.take(at_rest, np.random.default_rng(0))
    tracker.register(frame, frame.mask("box"))
    mask = frame.mask("box")
    columns = np.flatnonzero(mask.any(0))
    hidden = mask.copy()
    hidden[:, columns[0] : columns[0] + 3] = False
    depth = np.where(hidden, 0.4, frame.depth).astype(np.float32)
    covered = type(frame)(depth, frame.instance, frame.names, frame.lens, frame.T_world_camera)
    estimate = tracker.track(covered, mask & ~hidden)
    assert estimate.lost
    assert estimate.reason in ("covered", "not seen")


def test_a_jump_within_one_picture_is_found_again(stage, at_rest, trial):
    rng = np.random.default_rng(0)
    tracker = ModelTracker(from_trial(stage.model, trial, "box"))
    frame = stage.take(at_rest, rng)
    tracker.register(frame, frame.mask("box"))
    here = body_to_matrix(at_rest.objects["box"])
    there = pose_matrix(rotation_about(np.array([0, 0, 1.0]), 0.9) @ here[:3, :3], here[:3, 3] + [-0.05, -0.15, 0.05])
    frame = stage.take(box_at(at_rest, there), rng)
    estimate = tracker.track(frame, frame.mask("box"))
    assert not estimate.lost
    assert error(tracker, estimate, there)[0] < 5


def test_an_object_that_is_carried_past_the_hand_is_followed(stage, at_rest, trial):
    tracker = ModelTracker(from_trial(stage.model, trial, "box"))
    here, rng = body_to_matrix(at_rest.objects["box"]), np.random.default_rng(0)
    for share in np.linspace(0.0, 1.0, 16):
        lift = [0.15 * share, 0.1 * share, 0.14 * share]
        there = pose_matrix(rotation_about(np.array([0.3, 0, 1.0]), 0.7 * share) @ here[:3, :3], here[:3, 3] + lift)
        held = BodyState(there[:3, 3] + [0.0, 0.0, 0.02], at_rest.tool.quaternion)
        frame = stage.take(replace(box_at(at_rest, there), tool=held), rng)
        estimate = tracker.track(frame, frame.mask("box"))
        shift_mm, turn_deg = error(tracker, estimate, there)
        assert not estimate.lost
        assert shift_mm < 5
        assert turn_deg < 5


def test_an_object_out_of_view_is_lost_at_once_and_found_elsewhere(stage, at_rest, trial):
    tracker = ModelTracker(from_trial(stage.model, trial, "box"))
    here, rng = body_to_matrix(at_rest.objects["box"]), np.random.default_rng(0)
    gone = pose_matrix(here[:3, :3], here[:3, 3] - [0.0, 0.0, 5.0])
    turn = rotation_about(np.array([0.0, 0.0, 1.0]), np.radians(40.0))
    there = pose_matrix(turn @ here[:3, :3], here[:3, 3] + [0.08, 0.0, 0.0])
    lost = []
    for T_world_box in (here, gone, gone, there):
        frame = stage.take(box_at(at_rest, T_world_box), rng)
        estimate = tracker.track(frame, frame.mask("box"))
        lost.append(estimate.reason)
    assert lost == ["", "not seen", "not seen", ""]
    assert error(tracker, estimate, there)[0] < 5
    assert error(tracker, estimate, there)[1] < 3


def test_the_first_pose_is_the_expected_one_among_equals(stage, at_rest, trial):
    model = from_trial(stage.model, trial, "box")
    frame = stage.take(at_rest, np.random.default_rng(0))
    truth = body_to_matrix(at_rest.objects["box"])
    expected = truth @ pose_matrix(rotation_about(np.array([0, 0, 1.0]), np.pi), np.zeros(3))
    estimate = ModelTracker(model, expected=expected).register(frame, frame.mask("box"))
    assert np.trace(expected[:3, :3].T @ estimate.T_world_object[:3, :3]) > 2.9


def test_before_anything_is_seen_the_object_is_lost_where_expected(stage, at_rest, trial):
    tracker = ModelTracker(from_trial(stage.model, trial, "box"))
    frame = stage.take(at_rest, np.random.default_rng(0))
    estimate = tracker.track(frame, np.zeros(frame.depth.shape, bool))
    assert estimate.lost
    np.testing.assert_array_equal(estimate.T_world_object, np.eye(4))
    with pytest.raises(ValueError, match="mask of shape"):
        tracker.track(frame, np.zeros((3, 3), bool))


def test_the_same_pictures_give_the_same_poses(stage, at_rest, trial):
    frame = stage.take(at_rest, np.random.default_rng(5))
    model = from_trial(stage.model, trial, "can")
    first, second = (ModelTracker(model).register(frame, frame.mask("can")) for _ in range(2))
    np.testing.assert_array_equal(first.T_world_object, second.T_world_object)


def test_objects_tracked_together_have_the_velocities_of_their_motions(trial, at_rest):
    stage = PosedScene(trial, replace(CFG, noise=False))
    trackers = {name: ModelTracker(from_trial(stage.model, trial, name)) for name in trial.objects}
    here, rng, filters = body_to_matrix(at_rest.objects["box"]), np.random.default_rng(0), {}
    for k in range(20):
        time_s = 0.04 * k
        turn = rotation_about(np.array([0, 0, 1.0]), 0.5 * time_s)
        there = pose_matrix(turn @ here[:3, :3], here[:3, 3] + [0.1 * time_s, 0, 0])
        frame = stage.take(box_at(at_rest, there, time_s), rng)
        for name, tracker in trackers.items():
            estimate = tracker.track(frame, frame.mask(name))
            assert not estimate.lost
            if name not in filters:
                filters[name] = MotionFilter(MotionFilterCfg(), estimate.T_world_object, time_s)
            filters[name].update(estimate.T_world_object, time_s)
    np.testing.assert_allclose(filters["box"].velocity, [0.1, 0, 0], atol=0.02)
    np.testing.assert_allclose(filters["box"].spin, [0, 0, 0.5], atol=0.08)
    assert filters["can"].resting
