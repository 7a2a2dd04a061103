import numpy as np
import pytest
from episodes import ObedientWorld, make_trial

from coral.contact.perception.guessed_world import GuessedWorld
from coral.contact.scene.observation import BodyState, HandTarget
from coral.contact.worlds.hand_world import HandWorld
from coral.errors import InputError

AWAY = np.array([0.03, 0.0, 0.0])


@pytest.fixture
def guessed():
    """A world in which the box is believed to be 3 cm away from where it is."""
    trial = make_trial()
    world = GuessedWorld(HandWorld(trial), trial)
    first = world.reset()
    true = world.truth().objects["box"]
    guess = {"box": BodyState(true.position + AWAY, true.quaternion)}
    return world, first, world.settle(guess, first), guess


def rest(now):
    return HandTarget(now.tool.position, now.tool.quaternion, 0.08, 600.0)


def test_before_the_guess_no_object_is_seen(guessed):
    world, first, now, guess = guessed
    assert first.objects == {}
    assert now.objects == guess
    assert world.reset().objects == {}


def test_a_guess_is_never_updated(guessed):
    world, _, now, guess = guessed
    body = world.simulation.model.joint("box_free")
    world.simulation.data.qvel[body.dofadr[0]] = 0.5
    for _ in range(5):
        after = world.step(rest(now))
    assert after.time_s == pytest.approx(0.1)
    assert after.objects == guess
    assert np.linalg.norm(world.truth().objects["box"].position - guess["box"].position + AWAY) > 0.005


def test_the_record_tells_how_far_off_the_guess_is(guessed):
    world, _, now, _ = guessed
    found = world.compare(now, world.truth())["box"]
    assert (found.off_m, found.off_rad, found.lost) == (pytest.approx(0.03), pytest.approx(0.0, abs=1e-6), False)


def test_a_world_without_pictures_gives_nothing_to_guess_from():
    trial = make_trial()
    with pytest.raises(InputError, match=r"--variant.*a world of which pictures can be made"):
        GuessedWorld(ObedientWorld(trial), trial)
