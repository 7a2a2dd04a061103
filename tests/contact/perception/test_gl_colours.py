import mujoco
import numpy as np
import pytest
from ball_before_wall import scene


def test_without_opengl_the_rays_give_the_colours(monkeypatch):
    def fail(*args):
        raise RuntimeError("no display")

    monkeypatch.setattr(mujoco, "Renderer", fail)
    camera, data = scene(colours="best")
    assert camera.take(data).rgb is not None


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
    camera, data = scene(colours="best")
    assert camera.take(data).rgb.shape == (120, 160, 3)
    eye = Renderer.scene.camera[0]
    np.testing.assert_allclose(eye.forward, [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose(eye.up, [0, 0, 1], atol=1e-12)
    assert eye.frustum_top == pytest.approx(0.01 * np.tan(np.radians(22.5)))
