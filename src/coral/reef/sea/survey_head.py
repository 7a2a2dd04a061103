"""What the run folder says about a survey in real time as a whole, written before its first tick."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from coral.config import to_mapping
from coral.reef.sea.local_frame import LocalFrame
from coral.reef.sea.sail_cfg import SailCfg
from coral.reef.sea.survey_file import SurveyArea
from coral.reef.vehicle.response import VehicleResponse
from coral.reef.world.world import ReefWorld, save_world
from coral.run_files import RunFiles, SurveyFiles
from coral.runs import RunWriter, provenance


def write_head(
    writer: RunWriter,
    area: SurveyArea,
    world: ReefWorld | None,
    about: Mapping[str, Any],
    cfg: SailCfg,
    response: VehicleResponse,
    frame: LocalFrame,
) -> None:
    """Write world.yaml and config.yaml.

    Args:
        writer: The run's writer.
        area: Where the survey is.
        world: The simulated reef; None in real water: then world.yaml holds the area with its outlines.
        about: First entries of config.yaml: world, advisor, seed, names on the command line.
        cfg: Configuration.
        response: How the vehicle follows its set-points.
        frame: From the vehicle's frame to the survey's.
    """
    if world is not None:
        save_world(world, writer.folder / SurveyFiles.WORLD)
    else:
        outlines = [{"name": name, "metres": [list(p) for p in ring]} for name, ring in area.keep_out]
        fence = [list(p) for p in area.fence]
        content = {"name": area.name, "size_m": list(area.size_m), "geofence": fence, "keep_out": outlines}
        writer.yaml(SurveyFiles.WORLD, content)
    writer.yaml(
        RunFiles.CONFIG,
        {
            "system": "reef",
            **about,
            "mission": to_mapping(cfg.mission),
            "safety": to_mapping(cfg.safety),
            "depth_m": cfg.depth_m,
            "response": to_mapping(response),
            "frame": dataclasses.asdict(frame),
            "provenance": provenance(),
        },
    )
