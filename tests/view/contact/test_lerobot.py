"""The layout of LeRobot's data sets of version 3, read here without lerobot, which needs torch and another Python."""

import json

import numpy as np
import pytest
from pyarrow import parquet

import coral
from coral.contact.tasks import load_task
from coral.errors import InputError
from coral.view.contact.lerobot import (
    ACTION,
    CAMERA,
    QUANTILES,
    STATE,
    LerobotCfg,
    PictureStats,
    column_stats,
    write_lerobot,
)

SMALL = LerobotCfg(width=32, height=24)


def stay(state):
    return {"stay": np.square(state.ee_pos).sum(axis=-1)}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A run of 0.3 s: 16 rows, every 0.02 s."""
    task = load_task("pick-box")
    success = task.success.model_copy(update={"hold_s": 0.04})
    folder = tmp_path_factory.mktemp("runs") / "one"
    short = task.model_copy(update={"time_limit_s": 0.3, "success": success})
    settings = {"controller.horizon": 8, "planning.threads": 1, "record.state_period_s": 0.02}
    coral.run_task(
        short, cost=stay, world="hand", poses="ground-truth", samples=6, cfg=settings, out=folder, report=False
    )
    return folder


@pytest.fixture(scope="module")
def dataset(run, tmp_path_factory):
    out = tmp_path_factory.mktemp("set") / "box"
    return write_lerobot([run, run], out, SMALL), out


def test_every_row_stands_in_the_data(dataset, run):
    made, out = dataset
    rows = np.genfromtxt(run / "trajectory.csv", delimiter=",", names=True)
    table = parquet.read_table(out / "data/chunk-000/file-000.parquet")
    count = (len(rows) - 1) // 5
    assert made == {"episodes": 2, "frames": 2 * count, "successes": 0, "dataset": str(out)}
    state = np.array(table["observation.state"].to_pylist())[:count]
    action = np.array(table["action"].to_pylist())[:count]
    taken = np.arange(count) * 5
    assert state == pytest.approx(np.stack([rows[name][taken] for name in STATE], axis=1), rel=1e-6)
    assert action == pytest.approx(np.stack([rows[name][taken + 5] for name in ACTION], axis=1), rel=1e-6)
    assert table["index"].to_pylist() == list(range(2 * count))
    assert table["episode_index"].to_pylist() == [0] * count + [1] * count
    assert np.allclose(table["timestamp"].to_pylist()[:count], np.arange(count) / 10)
    assert table["next.done"].to_pylist()[:count] == [False] * (count - 1) + [True]
    assert set(table["next.reward"].to_pylist()) == {0.0}


def test_no_column_holds_the_true_state(dataset):
    table = parquet.read_table(dataset[1] / "data/chunk-000/file-000.parquet")
    info = json.loads((dataset[1] / "meta/info.json").read_text())
    assert not [name for name in table.schema.names if "box" in name]
    assert not [name for feature in info["features"].values() for name in feature["names"] or () if "box" in name]


def test_the_episodes_say_where_their_frames_are(dataset):
    made, out = dataset
    episodes = parquet.read_table(out / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    assert [(e["dataset_from_index"], e["dataset_to_index"]) for e in episodes] == [
        (0, made["frames"] // 2),
        (made["frames"] // 2, made["frames"]),
    ]
    for episode in episodes:
        path = out / f"videos/{CAMERA}/chunk-000/file-{episode[f'videos/{CAMERA}/file_index']:03d}.mp4"
        assert path.is_file()


def test_the_film_has_one_picture_for_every_frame(dataset):
    import cv2

    made, out = dataset
    film = cv2.VideoCapture(str(out / f"videos/{CAMERA}/chunk-000/file-000.mp4"))
    pictures = []
    while (read := film.read())[0]:
        pictures.append(read[1])
    assert len(pictures) == made["frames"] // 2
    assert pictures[0].shape == (24, 32, 3)
    assert film.get(cv2.CAP_PROP_FPS) == pytest.approx(10)


def test_features_tasks_and_statistics_agree_with_the_data(dataset):
    _, out = dataset
    info = json.loads((out / "meta/info.json").read_text())
    table = parquet.read_table(out / "data/chunk-000/file-000.parquet")
    assert set(info["features"]) == {*table.schema.names, CAMERA}
    assert info["codebase_version"] == "v3.0"
    tasks = parquet.read_table(out / "meta/tasks.parquet")
    assert tasks.to_pydict() == {"task_index": [0], "task": [load_task("pick-box").instruction]}
    assert json.loads(tasks.schema.metadata[b"pandas"])["index_columns"] == ["task"]
    stats = json.loads((out / "meta/stats.json").read_text())
    assert {"q01", "q99"} < set(stats["action"])
    assert np.shape(stats[CAMERA]["mean"]) == (3, 1, 1)
    assert info["robot_type"] == "free_hand"
    assert stats["observation.state"]["max"] == pytest.approx(np.max(table["observation.state"].to_pylist(), axis=0))


def test_pictures_can_be_left_out(run, tmp_path):
    write_lerobot([run], tmp_path / "set", LerobotCfg(pictures=False))
    assert not (tmp_path / "set/videos").exists()
    assert json.loads((tmp_path / "set/meta/info.json").read_text())["video_path"] is None


def test_a_rate_that_does_not_fit_the_control_step_is_refused(run, tmp_path):
    with pytest.raises(
        InputError, match=r"fps: found 30, expected a rate that fits a control step of 0\.02 s: 1, 2, 5"
    ):
        write_lerobot([run], tmp_path / "set", LerobotCfg(fps=30))
    assert not (tmp_path / "set").exists()


def test_nothing_is_overwritten_and_other_folders_are_no_runs(run, tmp_path):
    (tmp_path / "kept").mkdir()
    (tmp_path / "kept/file").touch()
    with pytest.raises(InputError, match="not empty"):
        write_lerobot([run], tmp_path / "kept", SMALL)
    with pytest.raises(InputError, match="kept"):
        write_lerobot([tmp_path / "kept"], tmp_path / "set", SMALL)
    with pytest.raises(InputError, match="0 runs"):
        write_lerobot([], tmp_path / "set", SMALL)


def test_a_column_has_moments_and_quantiles_by_number():
    rows = np.random.default_rng(0).normal(size=(101, 2))
    found = column_stats(rows.tolist())
    assert found["mean"] == pytest.approx(rows.mean(axis=0))
    assert found["std"] == pytest.approx(rows.std(axis=0))
    assert found["q50"] == pytest.approx(np.median(rows, axis=0))
    assert found["count"] == [101]
    assert len(column_stats([True, False])["q99"]) == 1


def test_pictures_have_what_all_their_pixels_together_give():
    pictures = np.random.default_rng(1).integers(3, 250, (4, 6, 5, 3)).astype(np.uint8)
    stats = PictureStats()
    for picture in pictures:
        stats.add(picture)
    found, pixels = stats.stats(), pictures.reshape(-1, 3) / 255
    assert np.shape(found["mean"]) == (3, 1, 1)
    assert np.ravel(found["mean"]) == pytest.approx(pixels.mean(axis=0))
    assert np.ravel(found["std"]) == pytest.approx(pixels.std(axis=0))
    assert np.ravel(found["min"]) == pytest.approx(pixels.min(axis=0))
    assert np.ravel(found["max"]) == pytest.approx(pixels.max(axis=0))
    for name, share in QUANTILES.items():
        expected = np.quantile(pixels, share, axis=0, method="inverted_cdf")
        assert np.ravel(found[name]) == pytest.approx(expected)
    assert found["count"] == [4]
