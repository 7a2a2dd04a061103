import math

import pytest

from coral.errors import InputError
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.sweep import apply_setting
from coral.reef.world.world import Current, load_world

CFG, WORLD = MissionCfg(), load_world("l1")


def test_no_setting_changes_nothing():
    cfg, world = apply_setting((), CFG, WORLD)
    assert cfg is CFG
    assert world is WORLD


def test_the_current_keeps_the_worlds_direction():
    cfg, world = apply_setting((("current", 0.3),), CFG, WORLD)
    now, was = world.current, WORLD.current
    assert math.hypot(now.x_m_s, now.y_m_s) == pytest.approx(0.3)
    assert math.atan2(now.y_m_s, now.x_m_s) == pytest.approx(math.atan2(was.y_m_s, was.x_m_s))
    assert world.clusters == WORLD.clusters
    assert cfg is CFG


def test_still_water_is_set_flowing_along_x():
    still = WORLD.model_copy(update={"current": Current()})
    assert apply_setting((("current", 0.2),), CFG, still)[1].current == Current(x_m_s=0.2, y_m_s=0.0)
    assert apply_setting((("current", 0),), CFG, WORLD)[1].current == Current()


def test_any_key_of_the_configuration_can_be_swept():
    cfg, _ = apply_setting((("simulator.noise.dropout", 0.2), ("time_limit_s", 5)), CFG, WORLD)
    assert (cfg.simulator.noise.dropout, cfg.time_limit_s) == (0.2, 5)


@pytest.mark.parametrize(
    ("key", "value", "complaint"),
    [
        ("curent", 0.1, "'current'"),
        ("dropout", 0.1, "'simulator.noise.dropout'"),
        ("simulator.noise.drop_out", 0.1, "'simulator.noise.dropout'"),
        ("simulator.noise", 1, "unknown key"),
        ("current", -0.1, "between 0 and 1"),
        ("current", "fast", "speed"),
        ("simulator.noise.oyster_missed", 1.5, "oyster_missed"),
        ("time_limit_s", "x", "time_limit_s"),
        ("driver", "sail", "driver"),
    ],
)
def test_bad_settings_are_told_in_one_line(key, value, complaint):
    with pytest.raises(InputError, match=complaint) as error:
        apply_setting(((key, value),), CFG, WORLD)
    assert str(error.value).startswith(("--sweep: ", "noise: "))
    assert "\n" not in str(error.value)
