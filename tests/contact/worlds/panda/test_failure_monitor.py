"""Ways in which an episode cannot go on, each told by name."""

import pytest

from coral.contact.worlds.robot_world import WorldError


def fault_of(go, *arguments, **options):
    with pytest.raises(WorldError) as caught:
        go(*arguments, **options)
    return caught.value


def test_a_divergence_is_a_fault_and_leaves_no_file(world, go, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    world.data.qvel[world.model.body("box").dofadr[0]] = 1e12
    assert fault_of(go, [0.0, 0.0, 0.2], 5).code == "diverged"
    assert not list(tmp_path.iterdir())


def test_an_object_that_falls_over_the_edge_is_none(world, go):
    place = world.model.joint("box_free").qposadr[0]
    world.data.qpos[place : place + 3] = (0.0, 0.4, 0.1)
    observed = go([0.0, 0.0, 0.25], 60)
    assert observed.objects["box"].position[2] < -0.3


def test_a_target_out_of_reach_is_a_fault_once_the_hand_rests(go):
    fault = fault_of(go, [1.2, 0.0, 0.3], 400)
    assert fault.code == "unreachable"
    assert "1.2" in str(fault)


def test_pressing_on_something_never_counts_as_out_of_reach(go):
    go([0.1, -0.1, 0.13], 60, opening=0.0)
    observed = go([0.1, -0.1, 0.05], 150, opening=0.0)
    assert observed.wrench[2] > 20.0
