"""Which kind of recording a path is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from coral.config import read_config
from coral.errors import InputError
from coral.reef.camera import CameraCfg
from coral.reef.mapping import MapCfg
from coral.reef.recordings.bag_recording import BagTopics, is_bag, read_bag
from coral.reef.recordings.perception import Perceive, perceive_nothing
from coral.reef.recordings.picture_folder import TABLE, read_folder
from coral.reef.recordings.recording import Recording
from coral.reef.recordings.run_recording import is_run, read_run

KINDS = "a run folder, a ROS 2 bag, an MCAP file, or a folder of pictures with poses.csv"


def find_recording(
    path: Path,
    *,
    camera: Path | None = None,
    topics: BagTopics | None = None,
    cfg: MapCfg | None = None,
    perceive: Perceive = perceive_nothing,
) -> Recording:
    """Read a recording of any kind.

    Args:
        path: Folder or file.
        camera: YAML file with the fields of `CameraCfg`. A run and a bag know their camera; a folder of pictures has it
            in `camera.yaml` unless it is given.
        topics: Topics of a bag.
        cfg: How pictures become a map.
        perceive: Makes classes and depth of colour pictures where the recording has none.

    Raises:
        InputError: The path is nothing of that, or something in it is missing or wrong.
    """
    given = None if camera is None else read_config(camera, CameraCfg())
    if not path.exists():
        raise InputError(str(path), "", "nothing", KINDS)
    if is_bag(path):
        return read_bag(path, topics or BagTopics(), given, cfg, perceive)
    if is_run(path):
        found = read_run(path)
        found = found if given is None else replace(found, camera=given)
        return found if cfg is None else replace(found, map=cfg)
    if (path / TABLE).is_file():
        if given is None:
            if not (path / "camera.yaml").is_file():
                raise InputError(str(path), "camera.yaml", "nothing", "the camera, there or by --camera FILE.yaml")
            given = read_config(path / "camera.yaml", CameraCfg())
        found = read_folder(path, given, perceive)
        return found if cfg is None else replace(found, map=cfg)
    raise InputError(str(path), "", "something else", KINDS)
