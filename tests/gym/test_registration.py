import gymnasium

import coral.gym  # noqa: F401  (registers)
from coral.contact.scene.task_names import every_task
from coral.gym.registration import register_environments
from coral.reef.world.world import shipped_worlds


def test_every_shipped_reef_and_task_has_an_environment():
    names = [f"coral/{name}-v0" for name in (*(f"reef-{reef}" for reef in shipped_worlds()), *every_task())]
    assert [name for name in names if name not in gymnasium.registry] == []


def test_registering_again_keeps_what_is_there(recwarn):
    before = gymnasium.registry["coral/reef-s1-v0"]
    register_environments()
    assert gymnasium.registry["coral/reef-s1-v0"] is before
    assert not recwarn.list
