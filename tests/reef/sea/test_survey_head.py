import yaml

from coral.reef.sea.local_frame import LocalFrame
from coral.reef.sea.sail_cfg import SailCfg
from coral.reef.sea.survey_file import SurveyArea
from coral.reef.sea.survey_head import write_head
from coral.reef.vehicle.response import VehicleResponse
from coral.reef.world.geometry import Pose
from coral.reef.world.world import load_world
from coral.runs import RunWriter


def written(folder, world):
    area = SurveyArea(
        "pier", (9.0, 8.0), Pose(1, 2, 0), ((0, 0), (9, 0), (9, 8)), (("wall", ((1, 1), (2, 1), (2, 2))),)
    )
    writer = RunWriter(folder, ("step",))
    response = VehicleResponse.of_vehicle(SailCfg().mission.simulator.vehicle)
    write_head(
        writer, area, world, {"world": "pier", "seed": 3}, SailCfg(depth_m=2.0), response, LocalFrame(1.0, 2.0, 0.5)
    )
    writer.close()
    return [yaml.safe_load((folder / name).read_text()) for name in ("config.yaml", "world.yaml")]


def test_the_configuration_is_complete(tmp_path):
    config, _ = written(tmp_path / "run", None)
    assert (config["system"], config["world"], config["seed"], config["depth_m"]) == ("reef", "pier", 3, 2.0)
    assert config["frame"] == {"x": 1.0, "y": 2.0, "turn": 0.5}
    assert config["safety"]["on_leak"] == "surface"
    assert config["mission"]["pilot"]


def test_in_real_water_the_world_is_the_area_with_its_outlines(tmp_path):
    _, world = written(tmp_path / "run", None)
    assert world["size_m"] == [9.0, 8.0]
    assert world["keep_out"] == [{"name": "wall", "metres": [[1, 1], [2, 1], [2, 2]]}]


def test_a_simulated_reef_is_kept_whole(tmp_path):
    _, world = written(tmp_path / "run", load_world("s1"))
    assert world["clusters"]
