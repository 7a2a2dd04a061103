"""Contact runs as a LeRobot data set (v3): frames as Parquet, pictures as MP4, readable by lerobot 0.4 and later."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from coral.config import Count
from coral.drawing import Image
from coral.errors import InputError
from coral.file_writer import scratch_for, write_whole
from coral.run_files import RunFiles
from coral.view.contact.replay import ReplayedScene
from coral.view.mp4 import write_mp4
from coral.view.run import RunFolder

Array = NDArray[np.float32]
POSE = ("x", "y", "z", "qw", "qx", "qy", "qz")
STATE = (*POSE, "opening", "fx", "fy", "fz", "tx", "ty", "tz")
"""Columns of the observation: what the robot itself measures."""
ACTION = tuple(f"cmd_{name}" for name in (*POSE, "opening"))
"""Columns of the action: the hand's target, absolute."""
CAMERA = "observation.images.overview"
DATA = "data/chunk-000/file-000.parquet"
EPISODES = "meta/episodes/chunk-000/file-000.parquet"
VIDEO = f"videos/{CAMERA}/chunk-000"
LARGEST = 1000
"""Episodes in one chunk of the format; more would need a second folder."""
QUANTILES = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}


@dataclass(frozen=True, kw_only=True)
class LerobotCfg:
    """What the data set holds."""

    fps: Count = 10
    """Frames per second; 1 / fps is a whole number of control steps."""
    width: Annotated[int, Field(ge=16, le=1920, multiple_of=2)] = 320
    height: Annotated[int, Field(ge=16, le=1920, multiple_of=2)] = 240
    """Size of the pictures (px); even, for the video."""
    pictures: bool = True
    """Whether frames have pictures of the scene."""


@dataclass(frozen=True)
class Frames:
    """The frames of one episode."""

    state: Array
    """Shape=(N, 14)."""
    action: Array
    """The target at the end of the frame's interval, Shape=(N, 8)."""
    times_s: NDArray[np.float64]
    """Time of each frame in the run, Shape=(N,)."""
    success: bool
    task: str
    """The instruction."""
    source: str
    """Name of the run folder."""
    robot: str
    """LeRobot's type of the robot: the world's arm, or a hand that flies freely."""


class PictureStats:
    """Counts how often each brightness occurs in each channel, so that the statistics need no picture twice."""

    def __init__(self) -> None:
        self._counts = np.zeros((3, 256), np.int64)
        self._pictures = 0

    def add(self, picture: Image) -> None:
        """Count the pixels of a picture, Shape=(H, W, 3)."""
        self._counts += [np.bincount(picture[..., channel].ravel(), minlength=256) for channel in range(3)]
        self._pictures += 1

    def stats(self) -> dict[str, Any]:
        """Return the statistics by channel, Shape=(3, 1, 1), of brightness from 0 to 1; the count is in pictures."""
        levels = np.arange(256) / 255
        share = self._counts / self._counts.sum(axis=1, keepdims=True)
        below = np.cumsum(share, axis=1)
        mean = share @ levels
        found = {
            "min": [levels[np.flatnonzero(row)[0]] for row in self._counts],
            "max": [levels[np.flatnonzero(row)[-1]] for row in self._counts],
            "mean": mean,
            "std": np.sqrt(np.maximum(share @ levels**2 - mean**2, 0.0)),
        }
        found |= {
            name: [levels[min(int(np.searchsorted(row, at - 1e-12)), 255)] for row in below]
            for name, at in QUANTILES.items()
        }
        return {name: np.reshape(each, (3, 1, 1)).tolist() for name, each in found.items()} | {
            "count": [self._pictures]
        }


@dataclass
class _Dataset:
    columns: dict[str, list[Any]] = field(default_factory=dict)
    episodes: list[dict[str, Any]] = field(default_factory=list)
    tasks: list[str] = field(default_factory=list)
    robots: set[str] = field(default_factory=set)
    pictures: PictureStats = field(default_factory=PictureStats)


def write_lerobot(runs: Sequence[Path], out: Path, cfg: LerobotCfg | None = None) -> dict[str, Any]:
    """Write finished contact runs as one data set into a new or empty folder; each run is an episode.

    Nothing in it comes from the true state of the objects but `next.reward` and `next.done`: 1 and true at the last
    frame of a success, as the judge said. Return the number of `episodes`, `frames`, `successes`, and the `dataset`.

    Raises:
        InputError: A folder is no finished contact run with states, or the rate does not fit its control step.
    """
    cfg = cfg or LerobotCfg()
    if not 1 <= len(runs) <= LARGEST:
        raise InputError("RUN", "", f"{len(runs)} runs", f"1 to {LARGEST}")
    read = [RunFolder.read(path) for path in runs]
    taken = [frames_of(run, cfg.fps) for run in read]
    scenes = [ReplayedScene(run, (cfg.width, cfg.height)) for run in read] if cfg.pictures else []
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise InputError(str(out), "--out", "a file or a folder that is not empty", "a new or empty folder")
    found = _Dataset()
    with scratch_for(out) as folder:
        for number, frames in enumerate(taken):
            _append(found, number, frames, cfg)
            if scenes:
                path = folder / VIDEO / f"file-{number:03d}.mp4"
                _write_video(path, (scenes[number].at(float(t)) for t in frames.times_s), found.pictures, cfg)
        _write_tables(found, folder, cfg)
    successes = sum(frames.success for frames in taken)
    total = len(found.columns["index"])
    return {"episodes": len(taken), "frames": total, "successes": successes, "dataset": str(out)}


def frames_of(run: RunFolder, fps: int) -> Frames:
    """Take the frames of a run: every n-th control step, each with the target commanded at the end of its interval.

    Raises:
        InputError: It is no finished contact run, or the rate does not fit.
    """
    if run.config.get("system") != "contact" or "end_reason" not in run.metrics:
        raise InputError(str(run.path), "", "no finished contact run", "a run folder with config.yaml and metrics.json")
    times = run.column("t")
    if len(times) < 2:
        raise InputError(str(run.path), RunFiles.TRAJECTORY, f"{len(times)} rows", "at least two")
    step_s = float(np.median(np.diff(times)))
    stride = round(1.0 / (fps * step_s))
    if stride < 1 or abs(stride * step_s * fps - 1.0) > 1e-3:
        rates = [str(k) for k in range(1, 101) if abs(1.0 / (k * step_s) - round(1.0 / (k * step_s))) < 1e-6]
        raise InputError("--cfg", "fps", fps, f"a rate that fits a control step of {step_s:g} s: {', '.join(rates)}")
    rows = np.arange(0, len(times) - stride, stride)
    if not len(rows):
        raise InputError(str(run.path), RunFiles.TRAJECTORY, f"{len(times)} rows", f"more than {stride}, one frame")
    state = np.stack([run.column(name)[rows] for name in STATE], axis=1).astype(np.float32)
    action = np.stack([run.column(name)[rows + stride] for name in ACTION], axis=1).astype(np.float32)
    start: Mapping[str, Any] = (run.select("start") or [{}])[0]
    success = bool(run.metrics.get("success"))
    task = str(start.get("instruction") or run.config.get("task"))
    world = str(run.config.get("world", "hand"))
    robot = "free_hand" if world == "hand" else world
    return Frames(state, action, times[rows], success, task, Path(run.path).name, robot)


def _append(found: _Dataset, number: int, frames: Frames, cfg: LerobotCfg) -> None:
    found.robots.add(frames.robot)
    if frames.task not in found.tasks:
        found.tasks.append(frames.task)
    n, first = len(frames.state), len(found.columns.get("index", []))
    last = np.arange(n) == n - 1
    made: dict[str, Any] = {
        "observation.state": frames.state.tolist(),
        "action": frames.action.tolist(),
        "next.reward": (last & frames.success).astype(np.float32),
        "next.done": last,
        "timestamp": (np.arange(n) / cfg.fps).astype(np.float32),
        "frame_index": np.arange(n),
        "episode_index": np.full(n, number),
        "index": np.arange(first, first + n),
        "task_index": np.full(n, found.tasks.index(frames.task)),
    }
    for name, values in made.items():
        found.columns.setdefault(name, []).extend(values)
    episode = {
        "episode_index": number,
        "tasks": [frames.task],
        "length": n,
        "data/chunk_index": 0,
        "data/file_index": 0,
        "dataset_from_index": first,
        "dataset_to_index": first + n,
        "meta/episodes/chunk_index": 0,
        "meta/episodes/file_index": 0,
        "source": frames.source,
        "success": frames.success,
    }
    if cfg.pictures:
        start = f"videos/{CAMERA}"
        episode |= {f"{start}/chunk_index": 0, f"{start}/file_index": number}
        episode |= {f"{start}/from_timestamp": 0.0, f"{start}/to_timestamp": n / cfg.fps}
    found.episodes.append(episode)


def _write_tables(found: _Dataset, out: Path, cfg: LerobotCfg) -> None:
    import pyarrow as pa
    from pyarrow import parquet

    features = _features(cfg)
    types = {"float32": pa.float32(), "int64": pa.int64(), "bool": pa.bool_()}
    fields = []
    for name in found.columns:
        value, size = types[features[name]["dtype"]], features[name]["shape"][0]
        fields.append(pa.field(name, value if size == 1 else pa.list_(value, size)))
    for folder in (Path(DATA).parent, Path(EPISODES).parent):
        (out / folder).mkdir(parents=True, exist_ok=True)
    parquet.write_table(pa.table(found.columns, schema=pa.schema(fields)), out / DATA)
    parquet.write_table(pa.Table.from_pylist(found.episodes), out / EPISODES)
    parquet.write_table(_task_table(found.tasks), out / "meta/tasks.parquet")
    info = {
        "codebase_version": "v3.0",
        "fps": cfg.fps,
        "features": features,
        "total_episodes": len(found.episodes),
        "total_frames": len(found.columns["index"]),
        "total_tasks": len(found.tasks),
        "chunks_size": LARGEST,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 200,
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4" if cfg.pictures else None,
        "robot_type": "+".join(sorted(found.robots)),
        "splits": {"train": f"0:{len(found.episodes)}"},
    }
    stats: dict[str, Any] = {name: column_stats(values) for name, values in found.columns.items()}
    stats |= {CAMERA: found.pictures.stats()} if cfg.pictures else {}
    for name, content in (("info", info), ("stats", stats)):
        write_whole(out / f"meta/{name}.json", json.dumps(content, indent=2, allow_nan=False) + "\n")


def _features(cfg: LerobotCfg) -> dict[str, Any]:
    one = {"shape": [1], "names": None}
    found: dict[str, Any] = {
        "observation.state": {"dtype": "float32", "shape": [len(STATE)], "names": list(STATE)},
        "action": {"dtype": "float32", "shape": [len(ACTION)], "names": [name[len("cmd_") :] for name in ACTION]},
        "next.reward": {"dtype": "float32", **one},
        "next.done": {"dtype": "bool", **one},
        "timestamp": {"dtype": "float32", **one},
        **{name: {"dtype": "int64", **one} for name in ("frame_index", "episode_index", "index", "task_index")},
    }
    if cfg.pictures:
        shape = [cfg.height, cfg.width, 3]
        about = {
            "video.fps": cfg.fps,
            "video.height": cfg.height,
            "video.width": cfg.width,
            "video.channels": 3,
            "video.codec": "h264",
            "video.pix_fmt": "yuv420p",
            "video.is_depth_map": False,
            "has_audio": False,
        }
        found[CAMERA] = {"dtype": "video", "shape": shape, "names": ["height", "width", "channels"], "info": about}
    return found


def _task_table(tasks: Sequence[str]) -> Any:
    """Make the table of tasks with the texts as its pandas index, as lerobot reads it."""
    import pyarrow as pa

    table = pa.table({"task_index": list(range(len(tasks))), "task": list(tasks)})
    columns = [
        {"field_name": name, "name": name, "pandas_type": pandas_type, "numpy_type": numpy_type, "metadata": None}
        for name, pandas_type, numpy_type in (("task_index", "int64", "int64"), ("task", "unicode", "object"))
    ]
    pandas = {"index_columns": ["task"], "column_indexes": [], "columns": columns, "pandas_version": "2.0.0"}
    return table.replace_schema_metadata({"pandas": json.dumps(pandas)})


def _write_video(path: Path, pictures: Iterator[Image], stats: PictureStats, cfg: LerobotCfg) -> None:
    """Write an MP4 (H.264) with a key frame at every second picture, so that a learner can jump in it."""

    def counted() -> Iterator[Image]:
        for picture in pictures:
            stats.add(picture)
            yield picture

    path.parent.mkdir(parents=True, exist_ok=True)
    write_mp4(path, counted(), (cfg.width, cfg.height), cfg.fps, "-crf", "23", "-g", "2", "-bf", "0")


def column_stats(values: Sequence[Any]) -> dict[str, list[float]]:
    """Compute the statistics of a column, Shape=(N,) or (N, D), one value for each of its numbers."""
    rows = np.asarray(values, np.float64).reshape(len(values), -1)
    found = {"min": rows.min(axis=0), "max": rows.max(axis=0), "mean": rows.mean(axis=0), "std": rows.std(axis=0)}
    found |= {name: np.quantile(rows, share, axis=0) for name, share in QUANTILES.items()}
    return {**{name: each.tolist() for name, each in found.items()}, "count": [len(rows)]}
