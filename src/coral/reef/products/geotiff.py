"""GeoTIFF files (OGC 19-008): a TIFF with the place of its pixels."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

import numpy as np

from coral.errors import InputError, install_extra
from coral.file_writer import write_whole
from coral.reef.products.placement import PlacedRaster

_SHORT, _DOUBLE, _ASCII = 3, 12, 2
_PIXEL_SCALE, _TIE_POINT, _GEO_KEYS, _GDAL_METADATA, _NO_DATA = 33550, 33922, 34735, 42112, 42113


def write_geotiff(
    path: Path, raster: PlacedRaster, epsg: int | None, *, bands: Sequence[str] = (), nothing: float | None = None
) -> None:
    """Write a raster, Shape=(H, W), (H, W, C), or red, green, blue, alpha as uint8, compressed without loss.

    `epsg` is the code of the projected coordinates; None: metres of no known place. `nothing` stands for no value.

    Raises:
        InputError: tifffile is not installed.
        OSError: The file cannot be written.
    """
    try:
        import tifffile
    except ImportError:
        raise InputError(str(path), "", "no package tifffile", install_extra("geo")) from None
    values = raster.values
    colour = values.dtype == np.uint8 and values.ndim == 3
    options: dict[str, Any] = {"photometric": "rgb", "extrasamples": ["unassalpha"]} if colour else {}
    if not colour:
        options["photometric"] = "minisblack"
        if values.ndim == 3 and values.shape[2] == 1:
            values = np.ascontiguousarray(values[:, :, 0])
        elif values.ndim == 3:
            values, options["planarconfig"] = np.ascontiguousarray(np.moveaxis(values, 2, 0)), "separate"
    scale = (raster.pixel_m, raster.pixel_m, 0.0)
    tie = (0.0, 0.0, 0.0, raster.west, raster.north, 0.0)
    # GTModelType projected, GTRasterType pixel is area, ProjectedCRS.
    keys = [(1024, 0, 1, 1), (1025, 0, 1, 1), (3072, 0, 1, epsg)] if epsg else [(1025, 0, 1, 1)]
    directory = [1, 1, 0, len(keys), *(number for key in keys for number in key)]
    tags: list[tuple[int, int, int, Any, bool]] = [
        (_PIXEL_SCALE, _DOUBLE, 3, scale, True),
        (_TIE_POINT, _DOUBLE, 6, tie, True),
        (_GEO_KEYS, _SHORT, len(directory), directory, True),
    ]
    if bands:
        items = "".join(
            f'<Item name="DESCRIPTION" sample="{k}" role="description">{escape(name)}</Item>'
            for k, name in enumerate(bands)
        )
        tags.append((_GDAL_METADATA, _ASCII, 0, f"<GDALMetadata>{items}</GDALMetadata>", True))
    if nothing is not None:
        tags.append((_NO_DATA, _ASCII, 0, f"{nothing:g}", True))
    content = io.BytesIO()
    with tifffile.TiffWriter(content) as tiff:
        tiff.write(values, compression="zlib", tile=(256, 256), metadata=None, extratags=tags, **options)
    write_whole(path, content.getvalue())
