"""Generated variations of tasks: what moves together, what is scaled, what stays."""

import numpy as np
import pytest

from coral.contact.scene.judge import Judge
from coral.contact.scene.task_file import every_task
from coral.contact.scene.trial import sample_trial
from coral.contact.scene.variation import BYSTANDER_M, split_variation, vary_task
from coral.contact.tasks import load_task
from coral.contact.worlds.hand_world import HandWorld, HandWorldCfg
from coral.errors import InputError


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("push-gently~2", ("push-gently", 2)),
        ("my/task.yaml~12", ("my/task.yaml", 12)),
        ("push-gently", ("push-gently", 0)),
        ("~/task.yaml", ("~/task.yaml", 0)),
        ("push-gently~0", ("push-gently~0", 0)),
    ],
)
def test_a_variation_is_named_by_its_number(text, parts):
    assert split_variation(text) == parts


def test_the_number_makes_the_variation():
    task = load_task("stack-blocks")
    assert vary_task(task, 1) == load_task("stack-blocks~1")
    assert vary_task(task, 1) != vary_task(task, 2)
    with pytest.raises(InputError, match="stack-blocks~0"):
        load_task("stack-blocks~0")


@pytest.mark.parametrize("name", every_task())
def test_every_task_has_variations_that_can_be_drawn(name):
    for number in (1, 2):
        assert "bystander" in sample_trial(load_task(f"{name}~{number}"), 0).objects


def test_the_scene_moves_as_a_whole():
    task, varied = load_task("drag-card-out"), load_task("drag-card-out~1")
    shift = np.subtract(varied.places["goal"], task.places["goal"])
    assert 0 < np.linalg.norm(shift) < 0.06
    assert shift[2] == 0
    for before, after in zip(task.fixtures, varied.fixtures, strict=True):
        np.testing.assert_allclose(np.subtract(after.position, before.position), shift, atol=1e-9)
    np.testing.assert_allclose(np.subtract(varied.table.center, task.table.center), shift[:2], atol=1e-9)
    card = varied.object("card")
    np.testing.assert_allclose(np.subtract(card.x, task.object("card").x), shift[0], atol=1e-9)
    region, moved = (one.success.conditions[0] for one in (task, varied))
    np.testing.assert_allclose(np.subtract(moved.low, region.low), shift, atol=1e-9)
    np.testing.assert_allclose(np.subtract(moved.high, region.high), shift, atol=1e-9)
    assert varied.instruction == task.instruction


def test_regions_in_a_sequence_move_too():
    board, varied = load_task("push-pick-board"), load_task("push-pick-board~1")
    shift = np.subtract(varied.table.center, board.table.center)
    lows = [
        next(
            part.low
            for one in task.success.conditions
            if one.kind == "sequence"
            for part in one.events[0]
            if part.kind == "inside"
        )
        for task in (board, varied)
    ]
    np.testing.assert_allclose(np.subtract(lows[1], lows[0])[:2], shift, atol=1e-9)


def test_free_objects_are_scaled_and_symmetric_ones_stay_symmetric():
    for number in range(1, 6):
        peg = load_task(f"insert-peg~{number}").object("peg")
        assert peg.scale[0] == peg.scale[1]
        assert all(0.9 <= low == high <= 1.1 for low, high in peg.scale)
    assert load_task("open-drawer~1").object("drawer").scale == load_task("open-drawer").object("drawer").scale


def test_what_stands_on_another_object_stays_on_it():
    trial = sample_trial(load_task("unstack-blocks~1"), 0)
    top, base = (trial.objects[name].pose.position for name in ("top", "base"))
    assert np.linalg.norm((top - base)[:2]) < 0.02
    assert top[2] > base[2] + 0.03


def test_the_cube_stands_clear_and_at_rest():
    trial = sample_trial(load_task("pull-from-under-block~1"), 0)
    world = HandWorld(trial, HandWorldCfg())
    at = world.reset().objects["bystander"].position
    assert at[2] == pytest.approx(BYSTANDER_M / 2, abs=2e-3)
    others = [one.pose.position for name, one in trial.objects.items() if name != "bystander"]
    assert min(np.linalg.norm(at - other) for other in others) > 0.15
    assert not Judge(trial).success(world.truth())
    world.close()
