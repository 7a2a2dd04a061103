import math

import pytest

from coral.config import to_mapping
from coral.errors import InputError
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.presets import NOISE, PRESETS, apply_preset, preset_help
from coral.reef.world.world import load_world

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
