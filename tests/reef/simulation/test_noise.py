import math

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.simulation.noise import PoseDrift, SensorNoise, SensorNoiseCfg
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Frame, Label, Pose

CAMERA = CameraCfg()
SHAPE = (CAMERA.height, CAMERA.width)


def flat(label=Label.SEABED, depth=2.0, instance=-1):
    return Frame(np.full(SHAPE, depth, np.float32), np.full(SHAPE, label, np.uint8), np.full(SHAPE, instance, np.int32))


def spoil(frame, seed=0, **settings):
    return SensorNoise(SensorNoiseCfg(**settings), np.random.default_rng(seed), CAMERA).apply(frame)


def test_off_returns_the_same_frame_and_pose_and_draws_nothing():
    rng = np.random.default_rng(5)
    before = rng.bit_generator.state
    frame, pose = flat(), Pose(1, 2, 3)
    assert SensorNoise(SensorNoiseCfg(), rng).apply(frame) is frame
    assert PoseDrift(SensorNoiseCfg(), rng).step(pose, 0.1) is pose
    assert rng.bit_generator.state == before


def test_same_seed_same_picture_and_the_input_is_left_alone():
    settings = {"depth_sigma": 0.1, "dropout": 0.1, "visibility_m": 3.0, "oyster_false": 0.2}
    frame = flat()
    a, b, c = spoil(frame, 1, **settings), spoil(frame, 1, **settings), spoil(frame, 2, **settings)
    np.testing.assert_array_equal(a.depth, b.depth)
    np.testing.assert_array_equal(a.labels, b.labels)
    assert (a.depth != c.depth).any()
    assert (frame.depth == 2.0).all()
    assert (frame.labels == Label.SEABED).all()
    assert (a.depth.dtype, a.labels.dtype, a.instances.dtype) == (np.float32, np.uint8, np.int32)


@pytest.mark.parametrize(
    ("settings", "sigma"),
    [
        ({"depth_sigma": 0.02}, 0.06),
        ({"depth_sigma_square": 0.02}, 0.18),
        ({"depth_sigma": 0.02, "depth_sigma_square": 0.02}, 0.24),
    ],
)
def test_depth_noise_grows_with_depth(settings, sigma):
    error = spoil(flat(depth=3.0), **settings).depth - 3.0
    assert error.std() == pytest.approx(sigma, rel=0.03)
    assert abs(error.mean()) < 4 * sigma / math.sqrt(error.size)


def test_depth_noise_leaves_water_alone_and_never_turns_negative():
    out = spoil(flat(Label.WATER, np.inf), depth_sigma=0.1)
    assert np.isinf(out.depth).all()
    assert spoil(flat(), depth_sigma=2.0).depth.min() > 0.0


def test_dropout_loses_its_share_of_pixels():
    out = spoil(flat(Label.OYSTER, instance=4), dropout=0.3)
    lost = np.isinf(out.depth)
    assert lost.mean() == pytest.approx(0.3, abs=0.02)
    assert (out.labels[lost] == Label.WATER).all()
    assert (out.instances[lost] == -1).all()
    assert (out.labels[~lost] == Label.OYSTER).all()


def test_turbid_water_hides_what_is_far_along_the_ray():
    fx, fy, cx, cy = CAMERA.intrinsics
    u, v = np.meshgrid(np.arange(CAMERA.width), np.arange(CAMERA.height))
    reach = 2.0 * np.sqrt(1 + ((u - cx) / fx) ** 2 + ((v - cy) / fy) ** 2)
    lost = np.isinf(spoil(flat(depth=2.0), visibility_m=4.0, visibility_falloff=0.5).depth)
    assert not lost[reach < 2.0 + 1e-3].any()
    assert lost[reach > 4.0].all()
    middle = (reach > 2.8) & (reach < 3.2)
    assert lost[middle].mean() == pytest.approx(0.5, abs=0.06)


@pytest.mark.parametrize(
    ("field", "before", "after"),
    [
        ("oyster_missed", Label.OYSTER, Label.SEABED),
        ("obstacle_missed", Label.OBSTACLE, Label.SEABED),
        ("oyster_false", Label.SEABED, Label.OYSTER),
        ("obstacle_false", Label.SEABED, Label.OBSTACLE),
    ],
)
def test_masks_are_wrong_at_their_rate_and_only_so(field, before, after):
    noise = SensorNoise(SensorNoiseCfg(**{field: 0.2}), np.random.default_rng(0), CAMERA)
    wrong = []
    for _ in range(20):
        labels = noise.apply(flat(before)).labels
        assert set(np.unique(labels)) <= {before, after}
        wrong.append((labels == after).mean())
    assert np.mean(wrong) == pytest.approx(0.2, abs=0.02)
    for other in set(Label) - {before}:
        assert (noise.apply(flat(other)).labels == other).all()


def test_masks_err_in_patches():
    wrong = spoil(flat(), oyster_false=0.1, patch_px=8).labels == Label.OYSTER
    # Inside 8 px patches 7 of 8 right neighbours agree; independent pixels would agree with 10 % of theirs.
    assert (wrong[:, :-1] & wrong[:, 1:]).sum() / wrong[:, :-1].sum() > 0.8


def test_drift_is_a_random_walk():
    cfg, end = SensorNoiseCfg(drift_xy=0.02, drift_theta=0.01), []
    for seed in range(400):
        drift = PoseDrift(cfg, np.random.default_rng(seed))
        for _ in range(25):
            pose = drift.step(Pose(1.0, 2.0, 0.0), 0.4)
        end.append(pose)
        assert pose.x - 1.0 == pytest.approx(drift.error[0])
    spread = np.std(end, axis=0)
    np.testing.assert_allclose(spread, np.array([0.02, 0.02, 0.01]) * math.sqrt(10.0), rtol=0.12)
    np.testing.assert_allclose(np.mean(end, axis=0), [1.0, 2.0, 0.0], atol=0.015)


def test_drifting_heading_stays_wrapped():
    drift = PoseDrift(SensorNoiseCfg(drift_theta=0.5), np.random.default_rng(0))
    for _ in range(200):
        assert abs(drift.step(Pose(0, 0, 3.1), 1.0).theta) <= math.pi


def test_false_positives_cannot_exceed_the_seabed():
    with pytest.raises(InputError, match=r"oyster_false \+ obstacle_false"):
        SensorNoiseCfg(oyster_false=0.7, obstacle_false=0.7)
