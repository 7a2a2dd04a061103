"""The oracle's tour of a world is planned once."""

import numpy as np
import pytest

from coral.reef.mission import bound
from coral.reef.mission.oracle import Tour
from coral.reef.simulation.imaging import ImagingCfg
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.vehicle.vehicle import VehicleCfg

TOUR = Tour(np.array([[0.6, 0.0], [0.6, 0.1], [0.0, 0.6]]), np.zeros((4, 3)), np.array([0.0, 0.5, 0.6, 0.95]), (), 0.1)


@pytest.fixture
def planned(tmp_path, monkeypatch):
    """Counts the tours planned, in a fresh process with an empty cache folder."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    bound.oracle_bound.cache_clear()
    made = []
    monkeypatch.setattr(bound, "plan_tour", lambda *_: made.append(1) or TOUR)
    yield made
    bound.oracle_bound.cache_clear()


def ask(world, visibility_m=None, **vehicle):
    return bound.oracle_bound(world, CameraCfg(), ImagingCfg(), visibility_m, VehicleCfg(**vehicle))


def test_a_world_is_planned_once_in_a_process(pond, planned):
    first = ask(pond)
    assert first.time_s == pytest.approx(0.3)
    assert ask(pond) is first
    assert len(planned) == 1


def test_another_process_reads_what_was_planned(pond, planned):
    first = ask(pond)
    bound.oracle_bound.cache_clear()
    read = ask(pond)
    assert read.time_s == first.time_s
    np.testing.assert_array_equal(read.commands, TOUR.commands)
    assert len(planned) == 1


def test_other_water_another_vehicle_or_another_world_is_another_tour(pond, planned):
    ask(pond)
    ask(pond, visibility_m=3.0)
    ask(pond, max_speed_m_s=0.4)
    ask(pond.model_copy(update={"obstacles": pond.obstacles[:-1]}))
    assert len(planned) == 4


@pytest.mark.parametrize("broken", ["{", "[]", '{"commands": []}'])
def test_a_broken_file_is_planned_anew(pond, planned, tmp_path, broken):
    first = ask(pond)
    (kept,) = (tmp_path / "coral").rglob("oracle-*.json")
    kept.write_text(broken)
    bound.oracle_bound.cache_clear()
    assert ask(pond).time_s == first.time_s
    assert len(planned) == 2
