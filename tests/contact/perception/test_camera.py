import mujoco
import numpy as np
import pytest

from coral.contact.perception.camera import RayCamera, RgbdCameraCfg, look_at
from coral.contact.perception.depth_noise import DepthNoise, DepthNoiseCfg
from coral.contact.perception.gl_colours import GlColours
from coral.contact.perception.noise_kernels import disturb
from coral.errors import InputError

WALL = """<mujoco><worldbody><geom type="box" size="2 .1 2" pos="0 1.1 0"/>
<body name="ball" pos="0 .8 0"><geom type="sphere" size=".1" rgba="1 0 0 1"/></body></worldbody></mujoco>"""


def scene(**more):
    model = mujoco.MjModel.from_xml_string(WALL)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return RayCamera(
        model, RgbdCameraCfg(width=160, height=120), look_at((0, 0, 0), (0, 1, 0)), {1: "ball"}, **more
    ), data


def test_a_wall_one_metre_away_and_a_ball_before_it():
    camera, data = scene()
    frame = camera.take(data)
    assert frame.depth[0, 0] == pytest.approx(1.0)
    assert frame.depth[60, 80] == pytest.approx(0.7, abs=1e-3)
    # A ball of radius 0.1 at 0.8 m covers a disc of f * 0.1 / sqrt(0.8^2 - 0.1^2).
    radius = camera.cfg.lens[0] * 0.1 / np.sqrt(0.63)
    assert frame.mask("ball").sum() == pytest.approx(np.pi * radius**2, rel=0.03)
    with pytest.raises(KeyError):
        frame.mask("wall")


def test_world_points_project_where_they_are_seen():
    T = look_at((0.4, -0.3, 0.5), (0.0, 0.1, 0.0))
    np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-12)
    target = np.linalg.inv(T) @ [0.0, 0.1, 0.0, 1.0]
    np.testing.assert_allclose(target[:2], 0.0, atol=1e-12)
    assert target[2] > 0
    above = np.linalg.inv(T) @ [0.0, 0.1, 0.1, 1.0]
    assert above[1] < 0  # y points down


def test_noise_has_the_spread_of_the_formula_and_is_the_seed_s():
    plain = DepthNoise(DepthNoiseCfg(uneven_m=0.0, disparity_step_px=0.0, hole=0.0))
    camera, data = scene(noise=plain)
    first = camera.take(data, np.random.default_rng(3))
    again = camera.take(data, np.random.default_rng(3))
    np.testing.assert_array_equal(first.depth, again.depth)
    corner = first.depth[:30, :40]  # straight on enough, and away from the ball
    assert np.std(corner) == pytest.approx(0.0012 + 0.0019 * 0.6**2, rel=0.1)
    with pytest.raises(ValueError, match="random"):
        camera.take(data)


def test_the_noise_kernel_against_numpy():
    rng = np.random.default_rng(0)
    shape = height, width = 30, 40
    depth = np.where(rng.random(shape) < 0.1, np.inf, 0.8 + 0.3 * (np.arange(width) > 20) + 0.001 * rng.random(shape))
    normal = rng.normal(size=(*shape, 3)) * [0.8, 0.8, 1.0]
    normal[..., 2] = -np.abs(normal[..., 2])
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    instance = rng.integers(0, 4, shape).astype(np.uint8)
    lens = np.array([35.0, 35.0, 19.5, 14.5])
    lateral, wavy = (rng.standard_normal((2, *shape), np.float32) for _ in range(2))
    axial, uneven = (rng.standard_normal(shape, np.float32) for _ in range(2))
    chance = rng.random(shape, np.float32)
    amounts = np.array([0.4, 0.5, 0.0012, 0.0019, 0.001, 400.0, 0.14, 0.3, 0.01, 0.03])
    measured, labels = np.empty(shape), np.empty(shape, np.uint8)
    disturb(depth, normal, instance, lens, lateral, wavy, axial, uneven, chance, amounts, measured, labels)

    shift = np.rint(0.4 * lateral + 0.5 * wavy).astype(int)
    rows = (np.arange(height)[:, None] + shift[0]).clip(0, height - 1)
    columns = (np.arange(width) + shift[1]).clip(0, width - 1)
    np.testing.assert_array_equal(labels, instance[rows, columns])
    seen = np.minimum(depth, 99.0)
    jump = np.abs(seen[rows, columns] - seen) > 0.03
    z = np.where(jump, seen[rows, columns], seen)
    jump[:, 1:] |= np.abs(np.diff(seen, axis=1)) > 0.03
    jump[1:] |= np.abs(np.diff(seen, axis=0)) > 0.03
    p, q = (np.arange(width) - 19.5) / 35.0, (np.arange(height)[:, None] - 14.5) / 35.0
    facing = -(normal[..., 0] * p + normal[..., 1] * q + normal[..., 2]) / np.sqrt(1 + p**2 + q**2)
    hole = (z > 98) | (chance < np.where(jump, 0.3, 0.01)) | (facing < 0.14)
    tilt = np.minimum(np.arccos(facing.clip(-1, 1)), 1.5)
    spread = 0.0012 + 0.0019 * (z - 0.4) ** 2 + 1e-4 / np.sqrt(z) * (tilt / (np.pi / 2 - tilt)) ** 2
    z = z + spread.clip(0, 0.05) * axial + 0.001 * z**2 * uneven
    expected = np.where(hole, np.inf, 400.0 / np.rint(400.0 / z))
    np.testing.assert_allclose(measured, expected, rtol=1e-9)
    assert 0.1 < np.isinf(measured).mean() < 0.9


def test_outlines_are_jagged_and_full_of_holes():
    camera, data = scene(noise=DepthNoise())
    clean, _ = scene()
    frame, truth = camera.take(data, np.random.default_rng(0)), clean.take(data)
    wrong = frame.mask("ball") != truth.mask("ball")
    assert 0 < wrong.sum() < 0.2 * truth.mask("ball").sum()
    assert (frame.depth == 0)[55:65, 60:100].sum() > 0


def test_colours_are_those_of_the_geoms():
    camera, data = scene(colours="shaded")
    rgb = camera.take(data).rgb
    assert rgb[60, 80, 0] > 150
    assert rgb[60, 80, 1] == 0
    assert abs(int(rgb[5, 5, 0]) - int(rgb[5, 5, 1])) < 2


def test_without_opengl_the_rays_give_the_colours(monkeypatch):
    def fail(*args):
        raise RuntimeError("no display")

    monkeypatch.setattr(mujoco, "Renderer", fail)
    camera, data = scene(colours="best")
    assert camera.take(data).rgb is not None
    with pytest.raises(InputError, match="no display"):
        GlColours(mujoco.MjModel.from_xml_string(WALL), 16, 12, (0,))


def test_opengl_is_asked_for_the_camera_s_own_view(monkeypatch):
    class Eye:
        frustum_near = 0.01

    class Renderer:
        scene = type("Scene", (), {"camera": [Eye(), Eye()]})()

        def __init__(self, model, height, width):
            self.shape = (height, width, 3)

        def update_scene(self, data, **options):
            pass

        def render(self):
            return np.zeros(self.shape, np.uint8)

        def close(self):
            pass

    monkeypatch.setattr(mujoco, "Renderer", Renderer)
    camera, data = scene(colours="opengl")
    assert camera.take(data).rgb.shape == (120, 160, 3)
    eye = Renderer.scene.camera[0]
    np.testing.assert_allclose(eye.forward, [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose(eye.up, [0, 0, 1], atol=1e-12)
    assert eye.frustum_top == pytest.approx(0.01 * np.tan(np.radians(22.5)))


@pytest.mark.parametrize("bad", [{"width": 4}, {"vfov_deg": 180.0}, {"near_m": 0.0}, {"far_m": 0.05}])
def test_a_bad_camera_is_named(bad):
    with pytest.raises(InputError, match=next(iter(bad))):
        RgbdCameraCfg(**bad)
