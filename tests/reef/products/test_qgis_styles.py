"""Styles are XML with a stop for each colour."""

import xml.etree.ElementTree as ET

from coral.reef.products.qgis_styles import COVER_STOPS, outline_style, raster_style


def test_a_raster_style_has_every_stop():
    style = ET.fromstring(raster_style(COVER_STOPS, band=2).split("\n", 1)[1])
    assert [item.get("color") for item in style.iter("item")] == [colour for _, colour, _ in COVER_STOPS]
    assert next(style.iter("rasterrenderer")).get("band") == "2"


def test_an_outline_style_labels_by_a_field():
    style = ET.fromstring(outline_style("number").split("\n", 1)[1])
    assert next(style.iter("text-style")).get("fieldName") == "number"
