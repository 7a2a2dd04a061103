"""A survey on disk: map, clusters and landmarks, to continue with after the battery was changed."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from coral.errors import InputError, first_line
from coral.file_writer import write_whole
from coral.foreign_file import parse_json, read_arrays
from coral.reef.map.belief import Belief, BeliefCfg
from coral.reef.map.chain import Track
from coral.reef.map.landmark_map import LandmarkMap
from coral.reef.map.mapping import MapCfg, OccupancyMap
from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.vehicle.camera import CameraCfg
from coral.run_files import SurveyFiles

FORMAT = "coral-saved-survey/1"
_TRACK_KEYS = ("index", "x", "y", "area_px", "length_m", "far")


def save_survey(folder: Path, belief: Belief, landmarks: LandmarkMap, clusters: Sequence[Track] | None = None) -> None:
    """Write `survey.npz` into a run folder: everything a later survey needs, atomically.

    Args:
        folder: Run folder.
        belief: What the vehicle knows.
        landmarks: Those of its localizer.
        clusters: The clusters, where another thread may change them meanwhile; by default the belief's.
    """
    known = belief.tracks if clusters is None else clusters
    tracks = [{key: getattr(track, key) for key in _TRACK_KEYS} for track in known]
    head = {
        "format": FORMAT,
        "size_m": list(belief.map.size_m),
        "cell_m": belief.map.cfg.cell_m,
        "tracks": tracks,
    }
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        head=np.frombuffer(json.dumps(head).encode(), np.uint8),
        trail=belief.trajectory,
        **landmarks.memory() | belief.map.memory(),  # type: ignore[arg-type]
    )
    write_whole(folder / SurveyFiles.SAVED, buffer.getvalue(), durable=True)


def load_survey(
    run: Path,
    size_m: tuple[float, float],
    camera: CameraCfg,
    map_cfg: MapCfg,
    cfg: BeliefCfg,
    sonar: SonarCfg | None = None,
) -> tuple[Belief, LandmarkMap]:
    """Read the survey that a run folder has saved. Return what is known, and the landmarks.

    A file of version 0.2.0 or before has no landmarks.

    Raises:
        InputError: There is none, it is broken, or it is of another area or cell size.
    """
    path = run / SurveyFiles.SAVED
    expected = "the run folder of an earlier survey of more than 5 s"
    if not path.is_file():
        raise InputError(str(path), "--resume", "no such file", expected)
    try:
        arrays = read_arrays(path)
        head: dict[str, Any] = parse_json(arrays.pop("head").tobytes())
        trail = np.asarray(arrays.pop("trail"), np.float64).reshape(-1, 2)
        if head["format"] != FORMAT:
            raise ValueError(f"format {head['format']}")
        old_size, old_cell = tuple(head["size_m"]), float(head["cell_m"])
        landmarks = LandmarkMap.recalled(arrays) if "landmarks" in arrays else LandmarkMap()
        tracks = [Track(**{key: track[key] for key in _TRACK_KEYS}) for track in head["tracks"]]
    except Exception as error:  # zip, JSON and array formats raise all kinds
        raise InputError(str(path), "", first_line(error), expected) from None
    if old_size != tuple(size_m) or old_cell != map_cfg.cell_m:
        found = f"{old_size[0]:g} x {old_size[1]:g} m in cells of {old_cell:g} m"
        raise InputError(
            str(path), "size_m", found, f"{size_m[0]:g} x {size_m[1]:g} m in cells of {map_cfg.cell_m:g} m"
        )
    cells = OccupancyMap(size_m, camera, map_cfg, sonar)
    try:
        cells.recall(arrays)
    except (KeyError, ValueError) as error:
        raise InputError(str(path), "", first_line(error), expected) from None
    belief = Belief(cells, cfg)
    belief.recall(tracks, trail)
    return belief, landmarks
