import numpy as np
import pytest

from coral.contact.plan.sampled_states import sample_states


@pytest.mark.parametrize("task", ["pick-box", "push-force"])
def test_states_lie_far_and_near_and_touch_the_object(scene, task):
    one = scene(task)
    states = sample_states(one.world, one.now, one.sizes)
    (name,) = one.sizes
    away = np.linalg.norm(states.ee_pos - states[f"{name}_pos"], axis=-1)
    assert away.min() < 0.05
    assert away.max() > 0.2
    assert 0.0 < np.mean(states[f"{name}_hand_contact"] > 0) < 1.0


def test_every_call_samples_the_same_states(scene):
    one = scene("pick-clutter")
    first, second = (sample_states(one.world, one.now, one.sizes) for _ in range(2))
    assert np.array_equal(first.ee_pos, second.ee_pos)
