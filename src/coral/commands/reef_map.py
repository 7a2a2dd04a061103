"""`coral reef map`: a map and products from a recording, without driving anything."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

from coral.commands.reef_products import describe_products, make_products
from coral.errors import InputError
from coral.reef.products.survey_products import ProductsCfg
from coral.reef.recordings.bag_recording import BagTopics
from coral.reef.recordings.find_recording import find_recording
from coral.reef.recordings.picture_folder import TABLE, datum_of_folder


@dataclass(frozen=True, kw_only=True)
class ReefMap:
    """Make the map and all products from a recorded dive: pictures with poses, MCAP, a ROS 2 bag, or a run."""

    recording: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="RECORDING")]
    """Folder of pictures with poses.csv, MCAP file, ROS 2 bag or run folder."""
    out: Path
    """Folder of the map and the products, new or empty."""
    camera: Annotated[Path | None, tyro.conf.arg(metavar="FILE.yaml")] = None
    """The camera: width, height, hfov_deg, pitch_down_deg, altitude_m. By default the recording's own."""
    perception: Literal["recorded"] = "recorded"
    """Where classes and depth come from. recorded: pictures of classes and depth in the recording."""
    datum: Annotated[str | None, tyro.conf.arg(metavar="LAT,LON[,HEADING]")] = None
    """Latitude and longitude of the first picture (WGS 84, degrees), and the compass heading there if the recording's x
    axis does not point east. A table with lat and lon has its own."""
    topics: BagTopics = field(default_factory=BagTopics)
    """Topics of a bag or an MCAP file."""
    json: bool = False
    """Print one JSON object."""
    cfg: ProductsCfg = field(default_factory=ProductsCfg)
    """How products are made."""

    def __call__(self) -> Mapping[str, Any]:
        """Make them."""
        recording = find_recording(self.recording, camera=self.camera, topics=self.topics)
        datum = self.datum
        own = datum_of_folder(self.recording) if (self.recording / TABLE).is_file() else None
        if own is not None:
            if datum is not None:
                raise InputError("--datum", "", datum, f"none: {self.recording / TABLE} has lat and lon")
            datum = f"{own[0]!r},{own[1]!r}"
        return make_products(recording, self.cfg, datum, self.out)

    def describe(self, result: Mapping[str, Any]) -> str:
        """Describe what was found, and list the main files."""
        return describe_products(result)
