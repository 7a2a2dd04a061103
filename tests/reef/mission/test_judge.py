import csv

import pytest

from coral.reef.map.chain import Track
from coral.reef.mission.judge import MissionJudge
from coral.reef.simulation.coverage import CoverageMeter
from coral.reef.simulation.imaging import ImagingMeter
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene


@pytest.fixture
def judge(pond, tmp_path):
    made = judge_of(pond, tmp_path)
    yield made
    made.close()


def judge_of(world, folder):
    scene = Scene.from_world(world)
    return MissionJudge(world, scene, CoverageMeter(scene), ImagingMeter(scene), folder, lambda event, **fields: None)


def track(x, y):
    return Track(index=0, x=x, y=y, area_px=200, length_m=1.0)


def test_tracks_that_match_no_true_cluster_are_phantoms(judge):
    # The beds lie about (6, 3.5), (10, 3.5) and (10.5, 9.5).
    assert judge.phantoms([track(6.0, 3.5), track(6.6, 3.2)]) == 0
    assert judge.phantoms([track(6.0, 3.5), track(3.0, 9.0), track(10.5, 12.5)]) == 2
    assert judge.phantoms([]) == 0


def test_distance_from_the_reef_is_to_an_oyster_or_to_the_line_it_grew_along(pond, judge, tmp_path):
    assert judge.reef_m(10.0, 3.5) < 0.3
    assert judge.reef_m(2.0, 12.0) > 5.0
    (tmp_path / "spine").mkdir()
    grown = pond.model_copy(update={"spine": (((2.0, 3.0), (2.0, 13.0)),)})
    assert judge_of(grown, tmp_path / "spine").reef_m(2.5, 12.0) == pytest.approx(0.5, abs=0.11)


def test_rows_hold_the_shares_at_that_time(judge, tmp_path):
    judge.note(0, 0.0, Pose(2.0, 3.0, 0.0))
    judge.meter.update(Pose(5.0, 3.0, 0.2))
    judge.note(1, 0.1, Pose(2.0, 12.0, 0.0))
    first, second = csv.DictReader((tmp_path / "judge.csv").open())
    assert float(first["imaged"]) == float(first["inspected"]) == 0.0
    assert 0.3 < float(second["imaged"]) <= 0.7
    assert float(second["inspected"]) == pytest.approx(judge.meter.inspected, abs=1e-5)
    assert float(second["reef_m"]) == pytest.approx(judge.reef_m(2.0, 12.0), abs=1e-2)
    assert {c["name"] for c in judge.clusters()} == {"near", "corner", "far"}
