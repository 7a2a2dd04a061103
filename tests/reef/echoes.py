"""A small sonar without errors, and images made by hand."""

import numpy as np

from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.vehicle.range_image import RangeImage

SMALL = SonarCfg(
    enabled=True, width=31, height=21, resolution_m=0.0, sigma_m=0.0, sigma_share=0.0, dropout=0.0, grazing_deg=0.0,
    multipath=0.0,
)  # fmt: skip


def flat_floor(sonar=SMALL, altitude_m=1.0):
    """The image above bare ground, by plain trigonometry."""
    tilt = np.radians(sonar.pitch_down_deg)
    beams = RangeImage(np.zeros((sonar.height, sonar.width), np.float32), sonar.hfov_deg, sonar.vfov_deg).directions()
    down = beams[..., 0] * np.sin(tilt) - beams[..., 2] * np.cos(tilt)
    ranges = np.where(down > 1e-9, altitude_m / np.maximum(down, 1e-9), np.inf)
    ranges[ranges > sonar.range_m] = np.inf
    return RangeImage(ranges.astype(np.float32), sonar.hfov_deg, sonar.vfov_deg)
