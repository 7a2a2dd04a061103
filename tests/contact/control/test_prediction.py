import numpy as np

from coral.contact.control.prediction import observation_of, state_after, states_under
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


def test_every_control_step_on_the_way_is_a_state(scene):
    one = scene("pick-box")
    up = one.now.tool.position + np.array([0.0, 0.0, 0.05])
    targets = [HandTarget(up, one.now.tool.quaternion, one.now.opening_m, 600.0)] * 4
    states = states_under(one.world, one.now, targets, 0)
    assert states.shape == (1, 4)
    heights = [observation_of(states, one.now, k).tool.position[2] for k in range(4)]
    assert heights == sorted(heights)
    last = state_after(one.world, one.now, targets, 0)
    np.testing.assert_array_equal(observation_of(states, one.now).tool.position, last.tool.position)
    assert heights[-1] == last.tool.position[2]
