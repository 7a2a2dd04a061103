"""Echoes in messages."""

from types import SimpleNamespace

import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.map.sonar_3d15 import SonarCfg
from coral.reef.ros.point_clouds import points_in, range_image_of
from coral.reef.vehicle.range_image import beam_directions

SONAR = SonarCfg(width=16, height=8)


def cloud(points, kind="<f4", padding=4):
    layout = np.dtype({"names": list("xyz"), "formats": [kind] * 3, "offsets": [0, 8, 16], "itemsize": 24 + padding})
    rows = np.zeros(len(points), layout)
    for k, name in enumerate("xyz"):
        rows[name] = np.asarray(points)[:, k]
    fields = [SimpleNamespace(name=n, offset=8 * k, datatype=7 if "4" in kind else 8) for k, n in enumerate("xyz")]
    return SimpleNamespace(
        fields=fields, width=len(points), height=1, point_step=layout.itemsize, is_bigendian=kind.startswith(">"),
        data=np.frombuffer(rows.tobytes(), np.uint8),
    )  # fmt: skip


@pytest.mark.parametrize("kind", ["<f4", ">f4", "<f8"])
def test_finite_points_come_out_whatever_lies_between_them(kind):
    points = [[1.0, 2.0, 3.0], [np.nan, 0.0, 0.0], [-4.0, 5.5, 0.25]]
    np.testing.assert_array_equal(points_in(cloud(points, kind), "x"), [points[0], points[2]])


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"fields": []}, "fields: found none, expected x, y and z"),
        ({"width": 9}, "data: found 28 bytes, expected 9 points of 28 bytes"),
        ({"point_step": 6}, "data: found"),
    ],
)
def test_a_cloud_that_lies_is_one_line(changed, said):
    with pytest.raises(InputError, match=said):
        points_in(SimpleNamespace(**{**vars(cloud([[1.0, 2.0, 3.0]])), **changed}), "x")


def test_points_of_a_sonar_become_its_range_image_again():
    rng = np.random.default_rng(1)
    ranges = rng.uniform(0.5, 9.0, (8, 16)).astype(np.float32)
    ranges[2, 3] = np.inf
    directions = beam_directions((8, 16), SONAR.hfov_deg, SONAR.vfov_deg)
    heard = np.isfinite(ranges)
    points = directions[heard] * ranges[heard][:, None]
    farther = points * 1.01  # two echoes in a beam: the nearer one counts
    made = range_image_of(np.concatenate([farther, points, [[-3.0, 0.0, 0.0], [20.0, 0.0, 0.0]]]), SONAR)
    np.testing.assert_allclose(made.ranges, ranges, rtol=1e-6)
