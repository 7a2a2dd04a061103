"""A run folder of a reef mission as a recording."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

from coral.config import merge, read_yaml
from coral.errors import MALFORMED, InputError
from coral.reef.map.mapping import MapCfg
from coral.reef.recordings.picture_folder import read_folder
from coral.reef.recordings.recorded_pictures import PicturePerception
from coral.reef.recordings.recording import RECORDED, Recording
from coral.reef.sea.recorded_camera import RecordedCamera
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.world import ReefWorld, load_world
from coral.run_files import RunFiles, SurveyFiles, TaskFiles


def is_run(path: Path) -> bool:
    """Check whether a folder is the run of a reef mission."""
    return (path / RunFiles.CONFIG).is_file() and not (path / TaskFiles.TASK).is_file()


def read_run(path: Path, perception: PicturePerception | None = None, period_s: float = 0.0) -> Recording:
    """Read the keyframes of a run, finished or killed, `period_s` (s) apart at least.

    With `perception`, what they show is what that sees in their colours; without, what the run kept.

    Raises:
        InputError: There is no run of a reef mission, or it kept no keyframes.
    """
    if not is_run(path):
        found = "nothing" if not path.exists() else "no run of a reef mission"
        raise InputError(str(path), "", found, "the folder of a run")
    if not (path / SurveyFiles.POSES).is_file():
        raise InputError(
            str(path), SurveyFiles.POSES, "nothing", "a run that kept its keyframes (--cfg.record.keyframes)"
        )
    where = str(path / RunFiles.CONFIG)
    config = read_yaml(path / RunFiles.CONFIG)
    _part(config, "map", "doubt").pop("obstacle_depth", None)  # of earlier versions
    camera = RecordedCamera.plain(camera_of(config, where))
    recording = read_folder((path / SurveyFiles.POSES).parent, camera, perception, period_s)
    name, size, start, datum = _world(path, config)
    return dataclasses.replace(
        recording,
        name=name,
        source=str(path),
        area=None if size is None else (0.0, 0.0, *size),
        map=merge(MapCfg(), _part(config, "map"), where),
        start=start or recording.start,
        datum=datum,
        seen_by=perception.name if perception else str(_mission(config).get("perception", RECORDED)),
    )


def true_reef(run: Path) -> ReefWorld | None:
    """Return the simulated reef of a run, for comparisons; None where nobody knows the truth, as in real water.

    Raises:
        InputError: The file of the reef is broken.
    """
    path = run / SurveyFiles.WORLD
    known = path.is_file() and "geofence" not in read_yaml(path)
    return load_world(path) if known else None


def camera_of(config: dict[str, Any], where: str) -> CameraCfg:
    """Return the camera of a run's resolved configuration.

    Raises:
        InputError: A value is wrong.
    """
    return merge(CameraCfg(), _part(config, "simulator", "camera"), where)


def _mission(config: dict[str, Any]) -> dict[str, Any]:
    mission = config.get("mission", config.get("survey", {}))
    return mission if isinstance(mission, dict) else {}


def _part(config: dict[str, Any], *names: str) -> dict[str, Any]:
    part: Any = _mission(config)
    for name in names:
        part = part.get(name, {}) if isinstance(part, dict) else {}
    return part if isinstance(part, dict) else {}


def _world(
    path: Path, config: dict[str, Any]
) -> tuple[str, tuple[float, float] | None, Pose | None, tuple[float, float] | None]:
    """Return name, extent (m), start and its latitude and longitude of the run's world; the rest is the truth."""
    if not (path / SurveyFiles.WORLD).is_file():
        return str(config.get("world", path.name)), None, None, None
    world = read_yaml(path / SurveyFiles.WORLD)
    try:
        width, height = (float(edge) for edge in world["size_m"])
        start = Pose(*(float(world["start"][name]) for name in ("x", "y", "theta")))
        latitude, longitude = (float(angle) for angle in world.get("datum") or (math.nan, math.nan))
    except MALFORMED:
        raise InputError(str(path / SurveyFiles.WORLD), "size_m, start", "values missing", "a reef world") from None
    datum = None if math.isnan(latitude) else (latitude, longitude)
    return str(world.get("name", path.name)), (width, height), start, datum
