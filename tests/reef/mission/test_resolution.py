import pytest

from coral.errors import InputError
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.resolution import PERSON_DEADLINE_S, resolve_mission


def test_variant_preset_and_fallback_are_applied(pond):
    cfg, world = resolve_mission(MissionCfg(), pond, variant="pd", preset="bay", fallback="hold")
    assert (cfg.driver, cfg.pilot.fallback) == ("pd", "hold")
    assert cfg.simulator.noise.visibility_m == 4.5
    assert world.current != pond.current


def test_a_person_gets_more_time(pond):
    budget = resolve_mission(MissionCfg(), pond, asks_people=True)[0].pilot.budget
    assert budget.deadline_s == PERSON_DEADLINE_S


def test_a_value_out_of_range_is_named(pond):
    with pytest.raises(InputError, match="--cfg: time_limit_s: found -1"):
        resolve_mission(MissionCfg(time_limit_s=-1.0), pond)
