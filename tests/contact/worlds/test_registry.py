import pytest
from episodes import make_trial

from coral.contact.worlds.registry import check_world, make_world
from coral.errors import InputError


def test_a_world_has_the_name_and_the_control_period_it_was_made_with():
    world = make_world("hand", make_trial(), 0.04)
    assert (world.name, world.control_period_s) == ("hand", 0.04)
    world.close()


def test_every_name_passes_the_check():
    for name in ("panda", "hand"):
        check_world(name)


def test_another_world_is_refused_with_the_nearest_name():
    with pytest.raises(InputError, match=r"--world.*one of panda, hand.*did you mean.*hand"):
        check_world("hands")
    with pytest.raises(InputError, match=r"cfg.*one of panda, hand"):
        check_world("ur5", "cfg")
    with pytest.raises(InputError, match="one of panda, hand"):
        make_world("hands", make_trial(), 0.02)
