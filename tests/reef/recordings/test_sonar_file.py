"""A file of the sonar's packets beside pictures with poses."""

import numpy as np
import pytest
from survey_runs import patch, poses, write_run

from coral.errors import InputError
from coral.reef.map.mapping import OBSTACLE
from coral.reef.map.sonar_3d15 import Sonar3d15, SonarCfg
from coral.reef.recordings.recording import map_of
from coral.reef.recordings.run_recording import read_run
from coral.reef.recordings.sonar_file import add_sonar_file
from coral.reef.sea.sonar_packets import SonarPing, encode_packet
from coral.reef.vehicle.range_image import RangeImage
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene

pytest.importorskip("wlsonar")
SONAR = SonarCfg(width=64, height=24, dropout=0.0, multipath=0.0)


def packet(device_s, metres=2.0):
    return encode_packet(SonarPing(RangeImage(np.full((2, 3), metres, np.float32), 90.0, 40.0), device_s))


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sonar") / "run"
    write_run(folder)
    return folder


@pytest.fixture
def recording(run):
    return read_run(run).located()


def pings(recording):
    return [ping for keyframe in recording.keyframes() for ping in keyframe.pings]


def test_the_files_obstacles_reach_the_map(recording, tmp_path):
    sonar = Sonar3d15(Scene.from_world(patch()), SONAR, np.random.default_rng(0))
    path = tmp_path / "dive.sonar"
    # The sonar's clock begins at 900 s, the recording's at 0; a ping with every picture.
    heard = [SonarPing(sonar.image(pose, 1.0), 900.0 + 0.5 * k) for k, pose in enumerate(poses())]
    path.write_bytes(b"".join(map(encode_packet, heard)))
    cfg = recording.map
    far = type(cfg)(sonar=type(cfg.sonar)(range_m=8.0))
    placed = add_sonar_file(recording, path, SonarCfg(), start_s=0.0)
    assert (placed.sonar.width, placed.sonar.height, placed.sonar.enabled) == (64, 24, True)
    cells = map_of(type(placed)(**{**placed.__dict__, "map": far}))
    iy, ix = np.nonzero(cells.layer.obstacle)
    assert len(iy) > 3
    # The post at (7.5, 6.5), 0.2 m thick.
    assert np.hypot((ix + 0.5) * 0.05 - 7.5, (iy + 0.5) * 0.05 - 6.5).max() < 0.45
    assert (cells.cells()[cells.layer.obstacle] == OBSTACLE).all()


def test_a_ping_lies_between_the_pictures_about_it(recording, tmp_path):
    path = tmp_path / "dive.sonar"
    broken = bytearray(packet(0.75))
    broken[-1] ^= 1
    path.write_bytes(packet(-1.0) + packet(0.25) + bytes(broken) + packet(0.5) + packet(99.0) + packet(99.5)[:-3])
    first, second = list(recording.keyframes())[:2]
    between, at = pings(add_sonar_file(recording, path, SonarCfg()))
    assert between.t == 0.25
    assert between.pose[:2] == pytest.approx(
        [(a + b) / 2 for a, b in zip(first.pose[:2], second.pose[:2], strict=True)]
    )
    assert at.pose == pytest.approx(Pose(*second.pose))
    assert at.attitude.altitude_m == pytest.approx(second.height_m)


def test_a_file_of_another_time_is_told_and_can_be_shifted(recording, tmp_path):
    path = tmp_path / "dive.sonar"
    path.write_bytes(packet(5000.0) + packet(5000.2))
    with pytest.raises(
        InputError, match=r"5000.000 to 5000.200 s, expected times within .* 0.000 to 20.000 s; --sonar-s"
    ):
        add_sonar_file(recording, path, SonarCfg())
    assert [round(one.t, 6) for one in pings(add_sonar_file(recording, path, SonarCfg(), start_s=3.0))] == [3.0, 3.2]


def test_what_is_no_recording_is_one_line(recording, tmp_path):
    with pytest.raises(InputError, match="No such file"):
        add_sonar_file(recording, tmp_path / "none.sonar", SonarCfg())
    (tmp_path / "text.sonar").write_text("hello world")
    with pytest.raises(InputError, match="wrong identifier"):
        add_sonar_file(recording, tmp_path / "text.sonar", SonarCfg())
    (tmp_path / "empty.sonar").write_bytes(b"")
    with pytest.raises(InputError, match="no range image"):
        add_sonar_file(recording, tmp_path / "empty.sonar", SonarCfg())
