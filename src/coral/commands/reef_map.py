"""`coral reef map`: a map and products from a recording, without driving anything."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

from coral.commands.reef_products import describe_products, make_products
from coral.config import NonNegative, checked
from coral.errors import InputError, nearest
from coral.flags import Argument, Option
from coral.plugins import has_plugin
from coral.reef.eyes.backends import PAINTED, RGB, open_eyes
from coral.reef.eyes.doubt import DoubtCfg
from coral.reef.eyes.perception import RgbPerception
from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.products.survey_products import ProductsCfg
from coral.reef.recordings.bag_recording import BagTopics
from coral.reef.recordings.find_recording import find_recording
from coral.reef.recordings.lens_check import check_lens
from coral.reef.recordings.perception import PicturePerception
from coral.reef.recordings.picture_folder import TABLE
from coral.reef.recordings.recording import RECORDED
from coral.reef.recordings.run_recording import is_run, true_reef
from coral.words import many


@dataclass(frozen=True, kw_only=True)
class ReefMap:
    """Make the map and all products from a recorded dive: pictures with poses or a vehicle's log, a bag, or a run."""

    recording: Annotated[Path, Argument(metavar="RECORDING")]
    """Folder of pictures with poses.csv, or of pictures or a video with a log (.tlog, .BIN); MCAP file, bag, run."""
    out: Path
    """Folder of the map and the products, new or empty."""
    camera: Annotated[Path | None, Option(metavar="FILE.yaml")] = None
    """The camera: width, height, and hfov_deg or fx, fy, cx, cy, model, distortion; pitch_down_deg, altitude_m. By
    default the recording's own."""
    perception: Annotated[str, Option(metavar="recorded|rgb|painted|FILE.onnx")] = RECORDED
    """Where classes and depth come from. recorded: pictures of classes and depth in the recording. rgb or
    painted: its colour pictures, by the network of CORAL for real or for painted ones. FILE.onnx, or the name of an
    entry point of the group `coral.eyes`: by yours."""
    depth: Annotated[Path | None, Option(metavar="FILE.onnx")] = None
    """A relative depth network (Depth Anything V2) whose depth replaces that of --perception, which still gives the
    classes."""
    period_s: NonNegative = 0.2
    """Shortest time between two pictures that are used (s); 0 uses all."""
    datum: Annotated[str | None, Option(metavar="LAT,LON[,HEADING]")] = None
    """Latitude and longitude of the first picture (WGS 84, degrees), and the compass heading there if the recording's x
    axis does not point east. A table with lat and lon has its own."""
    pictures_start_s: float | None = None
    """Time of the autopilot's log at which the first picture was taken or the video begins (s, as the log counts: since
    1970 in a .tlog, since the autopilot's start in most .BIN). By default both clocks agree."""
    topics: BagTopics = field(default_factory=BagTopics)
    """Topics of a bag or an MCAP file."""
    sonar: SonarCfg = field(default_factory=SonarCfg)
    """Beams of the sonar whose echoes a bag may have: width, height, hfov_deg, vfov_deg, range_m. Its tilt is the
    bag's."""
    doubt: DoubtCfg = field(default_factory=DoubtCfg)
    """Doubt with which a pixel still counts, where a network states one."""
    json: bool = False
    """Print one JSON object."""
    cfg: ProductsCfg = field(default_factory=ProductsCfg)
    """How products are made."""

    def __call__(self) -> Mapping[str, Any]:
        if self.pictures_start_s is not None and not math.isfinite(self.pictures_start_s):
            raise InputError("--pictures-start-s", "", self.pictures_start_s, "a number of seconds")
        if not 0.0 <= self.period_s < math.inf:
            raise InputError("--period-s", "", self.period_s, "0 seconds or more")
        truth = true_reef(self.recording) if is_run(self.recording) else None
        eyes = self._eyes(painted=truth is not None)
        named = self.perception if self.depth is None else f"{self.perception}, {self.depth}"
        recording = find_recording(
            self.recording,
            camera=self.camera,
            topics=self.topics,
            perception=None if eyes is None else PicturePerception(eyes, named),
            period_s=self.period_s,
            sonar=checked(self.sonar, "--sonar"),
            pictures_start_s=self.pictures_start_s,
        )
        recording = replace(recording, map=replace(recording.map, doubt=checked(self.doubt, "--doubt")))
        if recording.datum is not None and self.datum is not None and (self.recording / TABLE).is_file():
            raise InputError("--datum", "", self.datum, f"none: {self.recording / TABLE} has lat and lon")
        made = make_products(recording, self.cfg, self.datum, self.out, truth, check_lens(recording))
        about = [*recording.remarks, *(() if eyes is None else eyes.about)]
        return {**made, "pictures_left_out": len(recording.omitted), "eyes": about}

    def _eyes(self, *, painted: bool) -> RgbPerception | None:
        if self.perception == RECORDED:
            if self.depth is not None:
                expected = "--perception rgb, painted or FILE.onnx, for the classes"
                raise InputError("--depth", "", f"{self.depth} alone", expected)
            return None
        known = (RECORDED, RGB, PAINTED)
        given = self.perception.endswith(".onnx") or has_plugin("coral.eyes", self.perception)
        if self.perception not in known and not given:
            expected = f"{', '.join(known)} or FILE.onnx{nearest(self.perception, known)}"
            raise InputError("--perception", "", repr(self.perception), expected)
        return open_eyes(self.perception, depth=str(self.depth or ""), painted=painted and self.perception == PAINTED)

    def describe(self, result: Mapping[str, Any]) -> str:
        lines = [describe_products(result), *result["eyes"]]
        if result["pictures_left_out"]:
            lines.append(f"left out for want of a pose: {many(result['pictures_left_out'], 'picture')}")
        return "\n".join(lines)
