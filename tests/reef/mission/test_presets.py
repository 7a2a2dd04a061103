import math

import pytest

from coral.config import to_mapping
from coral.errors import InputError
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.presets import NOISE, PRESETS, apply_preset, apply_setting, preset_help
from coral.reef.world.world import Current, load_world

CFG, WORLD = MissionCfg(), load_world("l1")


def test_clear_is_what_a_mission_is_by_default():
    cfg, world = apply_preset("clear", CFG, WORLD)
    assert cfg is CFG
    assert world is WORLD


@pytest.mark.parametrize("name", ["coast", "bay", "hard"])
def test_every_value_of_a_preset_arrives(name):
    cfg, world = apply_preset(name, CFG, WORLD)
    values = {f"{NOISE}{key}": value for key, value in to_mapping(cfg.simulator.noise).items()}
    values |= {f"localization.{key}": value for key, value in to_mapping(cfg.localization).items()}
    for key, value in PRESETS[name].values.items():
        if key == "current":
            assert math.hypot(world.current.x_m_s, world.current.y_m_s) == pytest.approx(value)
        else:
            assert values[key] == value
    assert world.clusters == WORLD.clusters


@pytest.mark.parametrize(("better", "worse"), [("coast", "bay"), ("bay", "hard")])
def test_a_preset_is_at_least_as_bad_in_everything_as_the_one_before(better, worse):
    before, after = PRESETS[better].values, PRESETS[worse].values
    assert set(before) == set(after)
    for key, value in before.items():
        assert after[key] < value if key.endswith("visibility_m") else after[key] >= value


def test_what_the_user_has_set_wins():
    keep = {f"{NOISE}visibility_m", f"{NOISE}drift_xy"}
    cfg, _ = apply_preset("hard", CFG, WORLD, keep)
    assert (cfg.simulator.noise.visibility_m, cfg.simulator.noise.drift_xy) == (None, 0.0)
    assert cfg.simulator.noise.oyster_missed == 0.1


def test_every_value_has_a_reason_and_every_preset_its_place_in_the_help():
    assert all(condition.reason for preset in PRESETS.values() for condition in preset.conditions)
    assert all(f"{name}: {preset.what}" in preset_help("Water") for name, preset in PRESETS.items())


def test_an_unknown_preset_is_named():
    with pytest.raises(InputError, match="did you mean 'hard'"):
        apply_preset("hart", CFG, WORLD)


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
