"""The products as files, opened by others."""

import csv
import json

import numpy as np
import pytest

from coral.reef.products.files import summary, write_products
from coral.reef.products.placement import Datum, EarthPlacement
from coral.reef.products.product_files import ProductFiles
from reference import texts

pytest.importorskip("tifffile")
rasterio = pytest.importorskip("rasterio")
pyogrio = pytest.importorskip("pyogrio")


@pytest.fixture(scope="module")
def placed(products, tmp_path_factory):
    folder = tmp_path_factory.mktemp("products") / "out"
    placement = EarthPlacement(products.recording.start, Datum(36.95, -122.02, heading=60.0))
    return folder, placement, write_products(products, placement, folder)


def test_the_oysters_of_raster_layer_and_table_lie_at_one_place(placed, products):
    folder, placement, _ = placed
    with rasterio.open(folder / "oysters.tif") as opened:
        share = opened.read(1)
        rows, columns = np.nonzero(share > 0.5)
        x, y = rasterio.transform.xy(opened.transform, rows, columns)
        # Cells turned by 30 degrees and sampled anew have the same area.
        area = share[share > 0].sum() * opened.res[0] ** 2
    assert area == pytest.approx(products.area.value, rel=0.05)
    info = pyogrio.read_info(folder / "survey.gpkg", layer="clusters", force_total_bounds=True)
    west, south, east, north = info["total_bounds"]
    inside = (np.array(x) > west - 0.2) & (np.array(x) < east + 0.2) & (np.array(y) > south - 0.2)
    assert inside.mean() > 0.98
    assert (np.array(y) < north + 0.2).mean() > 0.98
    rows = list(csv.DictReader((folder / "clusters.csv").open()))
    place = placement.to_degrees(float(rows[0]["x_m"]), float(rows[0]["y_m"]))
    assert (float(rows[0]["latitude"]), float(rows[0]["longitude"])) == pytest.approx(place, abs=1e-7)
    bounds = pyogrio.read_info(folder / "clusters.geojson", force_total_bounds=True)["total_bounds"]
    assert bounds[0] < float(rows[0]["longitude"]) < bounds[2]
    assert bounds[1] < float(rows[0]["latitude"]) < bounds[3]


def test_every_raster_opens_with_its_place(placed):
    folder, _, files = placed
    for name in ("orthomosaic", "oysters", "density", "seen"):
        with rasterio.open(folder / f"{name}.tif") as opened:
            assert opened.crs.to_epsg() == 32610
    assert "pictures/cluster-01-1.png" in files
    assert json.loads((folder / "products.json").read_text())["clusters"] == 1


def test_the_reference_names_every_file_and_number(placed, products):
    _, placement, files = placed
    named = {value for name, value in vars(ProductFiles).items() if name.isupper()}
    assert [name for name in files if not {name, f"{name.split('/')[0]}/", f"*{name[-4:]}"} & named] == []
    assert set(summary(products, placement)) == set(" ".join(texts.PRODUCTS).split())


def test_without_a_datum_there_are_no_degrees(products, tmp_path):
    files = write_products(products, EarthPlacement(products.recording.start), tmp_path / "out")
    assert "clusters.geojson" not in files
    assert "survey.gpkg" in files
    row = next(csv.DictReader((tmp_path / "out/clusters.csv").open()))
    assert row["latitude"] == ""
    assert float(row["x_m"]) == pytest.approx(5.0, abs=0.5)
