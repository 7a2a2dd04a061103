import pytest
from pydantic import ValidationError

from coral.reef.world.world import load_world
from coral.reef.world.world_model import ReefWorld


def test_solids_are_the_obstacles_and_then_what_they_hang_on():
    world = load_world("s1")
    assert world.solids[: len(world.obstacles)] == world.obstacles


def test_an_unknown_key_is_refused():
    with pytest.raises(ValidationError, match="colour"):
        ReefWorld.model_validate({**load_world("s1").model_dump(), "colour": "red"})
