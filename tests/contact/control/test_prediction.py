import numpy as np

from coral.contact.control.prediction import observation_of, state_after
from coral.contact.scene.observation import HandTarget


def test_a_state_comes_back_as_an_observation(scene):
    one = scene("pick-box")
    now = observation_of(one.world.present(one.now), one.now)
    np.testing.assert_allclose(now.tool.position, one.now.tool.position, atol=1e-3)
    np.testing.assert_allclose(now.objects["box"].position, one.now.objects["box"].position, atol=1e-3)
    assert abs(now.opening_m - one.now.opening_m) < 2e-3
    assert now.wrench.shape == (6,)


def test_the_hand_will_be_on_its_way_to_its_targets(scene):
    one = scene("pick-box")
    up = one.now.tool.position + np.array([0.0, 0.0, 0.05])
    target = HandTarget(up, one.now.tool.quaternion, one.now.opening_m, 600.0)
    later = state_after(one.world, one.now, [target] * 5, 0)
    assert 0.005 < later.tool.position[2] - one.now.tool.position[2] < 0.05
    assert later.tool.velocity[2] > 0.02
    assert round(later.time_s - one.now.time_s, 6) == round(5 * one.world.cfg.step_s, 6)
    assert state_after(one.world, one.now, [], 0) is one.now
