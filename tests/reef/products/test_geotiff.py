"""GeoTIFF, opened by GDAL."""

import numpy as np
import pytest

from coral.reef.products.geotiff import write_geotiff
from coral.reef.products.placement import PlacedRaster

pytest.importorskip("tifffile")
rasterio = pytest.importorskip("rasterio")


def test_gdal_reads_values_place_names_and_what_is_nothing(tmp_path):
    values = np.arange(24, dtype=np.float32).reshape(3, 4, 2)
    raster = PlacedRaster(values, 500_000.0, 4_000_000.0, 0.5)
    write_geotiff(tmp_path / "x.tif", raster, 32610, bands=("a < b", "c"), nothing=-9999.0)
    with rasterio.open(tmp_path / "x.tif") as opened:
        assert opened.crs.to_epsg() == 32610
        assert opened.nodata == -9999.0
        assert opened.descriptions == ("a < b", "c")
        assert opened.xy(0, 0) == (500_000.25, 3_999_999.75)
        np.testing.assert_array_equal(np.moveaxis(opened.read(), 0, 2), values)


def test_colours_have_alpha(tmp_path):
    values = np.zeros((5, 6, 4), np.uint8)
    values[..., 3] = 255
    write_geotiff(tmp_path / "x.tif", PlacedRaster(values, 0.0, 2.5, 0.5), None)
    with rasterio.open(tmp_path / "x.tif") as opened:
        names = [one.name for one in opened.colorinterp]
        assert names == ["red", "green", "blue", "alpha"]
        assert opened.crs is None or opened.crs.to_epsg() is None
        assert opened.bounds == (0.0, 0.0, 3.0, 2.5)
