"""Pictures: what they show, and that nothing but scene, water, pose and time is in them."""

import dataclasses

import numpy as np
import pytest

from coral.reef.paint import painter as painter_module
from coral.reef.paint.painter import Painter, expose, noise_seed, srgb_table
from coral.reef.paint.water_kernels import attenuate, transmission_table
from coral.reef.simulation.daylight import PainterCfg
from coral.reef.vehicle.camera import Camera, CameraCfg, T_world_camera
from coral.reef.world.geometry import Label, Pose
from coral.reef.world.scene import Scene
from coral.reef.world.water_types import find_water
from coral.reef.world.world import load_world

CLEAR = find_water("clear")
SMALL = CameraCfg(width=80, height=60)
HERE = Pose(5.3, 4.4, 0.6)
SCENE = Scene.from_world(load_world("s1"))
QUIET = PainterCfg(photons=1e12, read_noise=0.0, vignette=0.0)


def painted(water="clear", pose=HERE, t=0.0, seed=1, **keys):
    frame = Camera(SCENE, SMALL).render(pose)
    return frame, Painter(SCENE, SMALL, water, PainterCfg(**keys), seed).paint(frame, pose, t=t)


def test_a_picture_is_decided_by_seed_pose_and_time():
    _, first = painted()
    _, again = painted()
    assert first.dtype == np.uint8
    assert first.shape == (60, 80, 3)
    assert np.array_equal(first, again)
    for other in (painted(t=0.1), painted(seed=2), painted(pose=Pose(5.4, 4.4, 0.6)), painted("bay")):
        assert not np.array_equal(first, other[1])


def test_water_is_blue_in_the_ocean_and_green_at_the_coast():
    frame, ocean = painted("clear", white_balance=0.0)
    _, coast = painted("bay", white_balance=0.0)
    water = frame.labels == Label.WATER
    assert ocean[water].mean(axis=0).argmax() == 2
    assert coast[water].mean(axis=0).argmax() == 1


def test_murky_water_hides_what_is_far_away():
    frame, clear = painted("clear")
    _, hard = painted("hard", photons=1e9, read_noise=0.0)
    ranges = np.where(np.isfinite(frame.depth), frame.depth, 0.0)
    near, far = (ranges > 0) & (ranges < 1.5), ranges > 6.0

    def contrast(picture, where):
        gray = picture.astype(float).mean(axis=2)[where]
        return gray.std() / gray.mean()

    assert contrast(hard, far) < 0.25 * contrast(clear, far)
    assert contrast(hard, near) > 2.0 * contrast(hard, far)


def test_classes_do_not_leak_into_colours():
    """The same solids painted with other labels of the sea floor's neighbours give the same light."""
    frame = Camera(SCENE, SMALL).render(HERE)
    painter = Painter(SCENE, SMALL, "clear", PainterCfg(), 1)
    wrong = dataclasses.replace(frame, labels=np.where(frame.labels == Label.OYSTER, Label.OBSTACLE, frame.labels))
    assert np.array_equal(
        painter.light(frame, HERE),
        painter.light(wrong.__class__(frame.depth, wrong.labels.astype(np.uint8), frame.instances), HERE),
    )


def test_textures_are_anchored_to_the_world():
    """A camera that moves 0.2 m ahead sees the same sand where it looks at the same spot."""
    camera = CameraCfg(width=160, height=120, pitch_down_deg=60.0, hfov_deg=60.0)
    cfg = PainterCfg(wave_slope=0.0, lens_blur_px=0.0, forward_blur_deg=0.0, snow=0.0)
    painter = Painter(SCENE, camera, CLEAR, cfg, 1)
    seen = {}
    for pose in (Pose(1.0, 14.0, 0.0), Pose(1.2, 14.0, 0.0)):
        frame = Camera(SCENE, camera).render(pose)
        floor = frame.labels.ravel() == Label.SEABED
        light = painter.light(frame, pose)
        transform = T_world_camera(pose, camera)
        fx, fy, cx, cy = camera.intrinsics
        v, u = np.mgrid[:120, :160]
        rays = np.stack([(u - cx) / fx, (v - cy) / fy, np.ones(u.shape)], axis=-1) @ transform[:3, :3].T
        spots = transform[:2, 3] + frame.depth[..., None] * rays[..., :2]
        keys = np.floor(spots / 0.02).astype(int).reshape(-1, 2)[floor].tolist()
        for key, value in zip(keys, light[..., 1].ravel()[floor], strict=True):
            seen.setdefault(tuple(key), {}).setdefault(pose.x, []).append(value)
    both = np.array([[np.mean(values) for values in found.values()] for found in seen.values() if len(found) == 2])
    assert len(both) > 300
    assert np.corrcoef(both.T)[0, 1] > 0.9


@pytest.mark.parametrize("water", ["jerlov-IB", "jerlov-3C", "jerlov-5C"])
def test_a_gray_card_fades_by_the_law_of_beer_and_lambert(water):
    """A wall of one gray at 1, 3 and 6 m: what it sends minus what a black wall sends, per channel.

    Straight and forward-scattered light together fall by a + b / 2; straight light alone by c = a + b.
    """
    found = find_water(water)
    camera = CameraCfg(width=40, height=30, hfov_deg=20.0, pitch_down_deg=0.0)
    shape, light = (30, 40), {}
    p = (np.arange(40) - 19.5) / camera.intrinsics[0]
    q = (np.arange(30) - 14.5) / camera.intrinsics[0]
    lengths = np.sqrt(1.0 + p[None, :] ** 2 + q[:, None] ** 2)
    for distance in (1.0, 3.0, 6.0):
        depth = (distance / lengths).astype(np.float32)
        table = np.empty((1024, 6), np.float32)
        transmission_table(found.beam, found.lost, 12.0, table)
        for gray in (0.0, 0.18):
            direct, forward = np.empty((*shape, 3), np.float32), np.empty((*shape, 3), np.float32)
            attenuate(
                np.eye(3), p, q, 12.0, 80.0, 4.0, depth, np.full((*shape, 3), gray, np.float32), table, found.lost,
                found.diffuse, (0.1, 0.1, 0.1), (0.1, 0.1, 0.1), (0.0, 0.0, 1.0), (0.3, 0.2, 0.1), direct, forward,
            )  # fmt: skip
            light[distance, gray] = direct.astype(float), forward.astype(float)
        straight = (light[distance, 0.18][0] - light[distance, 0.0][0]).mean(axis=(0, 1))
        astray = light[distance, 0.18][1].mean(axis=(0, 1))
        np.testing.assert_allclose(straight, 0.18 * np.exp(-np.array(found.beam) * distance), rtol=2e-3, atol=1e-7)
        np.testing.assert_allclose(straight + astray, 0.18 * np.exp(-np.array(found.lost) * distance), rtol=2e-3)


def henyey(cosine, g=0.7):
    return (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * cosine) ** 1.5)


def test_the_water_equals_its_numpy_twin():
    """Every pixel of a tilted camera, with the sun and the sky by their angles, as arrays."""
    rng, water = np.random.default_rng(0), find_water("bay")
    turn = T_world_camera(Pose(0.0, 0.0, 0.7), SMALL, roll=0.1, pitch=-0.2)[:3, :3].copy()
    fx, _, cx, cy = SMALL.intrinsics
    p, q = (np.arange(80) - cx) / fx, (np.arange(60) - cy) / fx
    depth = rng.uniform(0.2, 5.0, (60, 80)).astype(np.float32)
    surface = rng.uniform(0.0, 0.2, (60, 80, 3)).astype(np.float32)
    sun, mix, veil = (0.3, -0.2, 0.933), (0.2, 0.1, 0.02), np.array([0.1, 0.3, 0.2])
    table = np.empty((4096, 6), np.float32)
    transmission_table(water.beam, water.lost, 25.0, table)
    direct, forward = np.empty((60, 80, 3), np.float32), np.empty((60, 80, 3), np.float32)
    attenuate(
        turn, p, q, 25.0, 80.0, 4.0, depth, surface, table, water.lost, water.diffuse, tuple(veil), (0.0, 0.0, 0.0),
        sun, mix, direct, forward,
    )  # fmt: skip
    rays = np.stack([*np.meshgrid(p, q), np.ones((60, 80))], axis=-1)
    length = np.linalg.norm(rays, axis=-1, keepdims=True)
    way, r = (rays / length) @ turn.T, depth[..., None] * length
    rise = way[..., 2:]
    sky = 0.479 * np.sqrt(1.0 - rise**2) + 0.878 * rise
    phase = mix[0] * henyey((way * sun).sum(axis=-1, keepdims=True)) + mix[1] * henyey(sky) + mix[2]
    rate = np.array(water.lost) - np.array(water.diffuse) * rise
    straight = np.exp(-np.array(water.beam) * r)
    np.testing.assert_allclose(direct, surface * straight + phase * veil * (1 - np.exp(-rate * r)) / rate, rtol=2e-4)
    np.testing.assert_allclose(forward, surface * (np.exp(-np.array(water.lost) * r) - straight), rtol=2e-3, atol=1e-6)


def test_the_veil_is_the_integral_along_the_ray():
    """Straight up the closed form equals a sum of small steps through water that grows brighter."""
    found, phase = find_water("bay"), 0.2
    p = q = np.zeros(2)
    up = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 0.6, 0.8]])  # rises by 0.8 for every metre
    table = np.zeros((8, 6), np.float32)
    direct, forward = np.empty((2, 2, 3), np.float32), np.empty((2, 2, 3), np.float32)
    depth = np.full((2, 2), 3.0, np.float32)
    attenuate(
        up, p, q, 12.0, 80.0, 9.0, depth, np.zeros((2, 2, 3), np.float32), table, found.lost, found.diffuse,
        (1.0, 1.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, phase), direct, forward,
    )  # fmt: skip
    s = (np.arange(30000) + 0.5) * 1e-4
    for k in range(3):
        steps = phase * np.exp((0.8 * found.diffuse[k] - found.lost[k]) * s) * 1e-4
        assert direct[0, 0, k] == pytest.approx(steps.sum(), rel=1e-4)


@pytest.mark.parametrize("size", [(20, 15)])
def test_kernels_equal_their_python_twins(size):
    """Compiled and interpreted, the kernels give the same picture: no shortcut of the compiler shows."""
    camera = CameraCfg(width=size[0], height=size[1])
    frame = Camera(SCENE, camera).render(HERE)
    compiled = Painter(SCENE, camera, "bay", PainterCfg(), 1).light(frame, HERE, t=1.0, velocity=(0.6, 0.1, 0.5))
    kernels = ("shade", "attenuate", "transmission_table", "draw_snow", "blur_motion")
    with pytest.MonkeyPatch.context() as patch:
        for name in kernels:
            patch.setattr(painter_module, name, getattr(painter_module, name).py_func)
        with np.errstate(over="ignore"):
            painter = Painter(SCENE, camera, "bay", PainterCfg(), 1)
            plain = painter.light(frame, HERE, t=1.0, velocity=(0.6, 0.1, 0.5))
    np.testing.assert_allclose(compiled, plain, rtol=2e-3, atol=2e-5)


def test_turning_blurs_the_picture_along_its_rows():
    frame = Camera(SCENE, SMALL).render(HERE)
    painter = Painter(SCENE, SMALL, CLEAR, PainterCfg(shutter_s=0.1), 1)
    still, turning = (painter.light(frame, HERE, velocity=(0.0, 0.0, rate)) for rate in (0.0, 1.0))
    across, along = (lambda image, axis=axis: np.abs(np.diff(image, axis=axis)).mean() for axis in (0, 1))
    assert along(turning) < 0.75 * along(still)
    assert across(turning) > across(still) * along(turning) / along(still)


def test_snow_is_drawn_in_front_and_drifts():
    frame = Camera(SCENE, SMALL).render(HERE)
    without = Painter(SCENE, SMALL, "hard", PainterCfg(snow=0.0), 1)
    snowing = Painter(SCENE, SMALL, "hard", PainterCfg(snow=5.0), 1)
    flakes = [snowing.light(frame, HERE, t=t) - without.light(frame, HERE, t=t) for t in (0.0, 0.0, 2.0)]
    assert flakes[0].min() > -1e-5
    assert 0.001 < (flakes[0].max(axis=2) > 1e-4).mean() < 0.5
    assert np.array_equal(flakes[0], flakes[1])
    assert not np.array_equal(flakes[0], flakes[2])


@pytest.mark.parametrize("water", ["jerlov-I", "jerlov-9C"])
def test_no_water_overflows(water):
    _, picture = painted(water)
    assert 5 < picture.mean() < 200


def scene(level=1.0, tint=(1.0, 1.0, 1.0)):
    ramp = np.linspace(0.05, 1.0, 40, dtype=np.float32)
    return np.ascontiguousarray((level * ramp)[None, :, None] * np.float32(tint) * np.ones((30, 1, 1), np.float32))


def test_the_curve_is_srgb():
    table = srgb_table()
    assert table[0] == 0
    assert table[-1] == 255
    assert table[round(0.18 * 4095)] == pytest.approx(118, abs=1)  # middle gray, IEC 61966-2-1


def test_pictures_are_as_bright_in_the_dark_as_in_the_light():
    assert np.array_equal(expose(scene(1.0), QUIET, 0), expose(scene(0.125), QUIET, 0))


def test_exposure_aims_at_its_mean():
    picture = expose(np.full((30, 40, 3), 3.7, np.float32), QUIET, 0)
    assert np.unique(picture).tolist() == [int(srgb_table()[round(0.2 * 4095)])]


def test_white_balance_goes_part_of_the_way_to_gray():
    tint = (0.25, 1.0, 0.5)

    def red_share(balance):
        picture = expose(scene(tint=tint), PainterCfg(photons=1e12, read_noise=0.0, white_balance=balance), 0)
        return picture[..., 0].mean() / picture[..., 1].mean()

    assert red_share(0.0) < red_share(0.5) < red_share(1.0)
    assert red_share(1.0) == pytest.approx(1.0, abs=0.02)


def test_noise_is_stronger_in_the_dark():
    cfg = PainterCfg(vignette=0.0)
    dark, bright = (expose(np.full((60, 80, 3), level, np.float32), cfg, 1).std() for level in (1e-3, 1.0))
    assert dark > 3.0 * bright


def test_noise_is_normal_and_its_seed_decides():
    cfg = PainterCfg(vignette=0.0, photons=1e12, read_noise=0.02)
    even = np.full((120, 160, 3), 1.0, np.float32)
    picture = expose(even, cfg, 1)
    assert np.array_equal(picture, expose(even, cfg, 1))
    assert not np.array_equal(picture, expose(even, cfg, 2))
    # sRGB at 0.2 has the slope 1.055 / 2.4 * 0.2^(1 / 2.4 - 1) = 1.124.
    assert picture.std() == pytest.approx(0.02 * 255 * 1.124, rel=0.05)


def test_every_pose_and_time_has_its_own_noise():
    seeds = {noise_seed(1, Pose(1.0, y, 0.0), t) for y in (0.0, 0.1) for t in (0.0, 0.1)}
    assert len(seeds) == 4


def test_corners_are_darker():
    cfg = PainterCfg(photons=1e12, read_noise=0.0, vignette=0.5)
    picture = expose(np.full((30, 40, 3), 1.0, np.float32), cfg, 0)
    assert picture[0, 0, 0] < picture[15, 20, 0]
