"""Styles for QGIS: `NAME.qml` beside a layer is what QGIS draws it with when it is opened."""

from __future__ import annotations

from collections.abc import Sequence
from xml.sax.saxutils import quoteattr

Stop = tuple[float, str, str]
"""Value, colour as #rrggbb, label."""

COVER_STOPS: tuple[Stop, ...] = (
    (0.0, "#f4efe3", "0 %"),
    (0.1, "#cfe3bf", "10 %"),
    (0.3, "#7fbf8a", "30 %"),
    (0.6, "#2f8f68", "60 %"),
    (1.0, "#0b4a4f", "100 %"),
)
DISTANCE_STOPS: tuple[Stop, ...] = (
    (0.0, "#0b4a4f", "0 m"),
    (1.5, "#2f8f68", "1.5 m"),
    (3.0, "#b8d67c", "3 m"),
    (6.0, "#f0b429", "6 m"),
)


def raster_style(stops: Sequence[Stop], band: int = 1) -> str:
    """Return the style of one band of a raster, with colours between the stops interpolated."""
    items = "".join(
        f'<item value="{value:g}" color="{colour}" alpha="255" label={quoteattr(label)}/>'
        for value, colour, label in stops
    )
    low, high = stops[0][0], stops[-1][0]
    return (
        "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n"
        '<qgis version="3.28" styleCategories="Symbology"><pipe>'
        f'<rasterrenderer type="singlebandpseudocolor" band="{band}" opacity="1" alphaBand="-1" '
        f'classificationMin="{low:g}" classificationMax="{high:g}">'
        f'<rastershader><colorrampshader colorRampType="INTERPOLATED" classificationMode="1" clip="0" '
        f'minimumValue="{low:g}" maximumValue="{high:g}">{items}</colorrampshader></rastershader>'
        "</rasterrenderer></pipe></qgis>\n"
    )


def outline_style(label: str, colour: str = "11,74,79,255") -> str:
    """Return the style of polygons: an outline, and an attribute as label."""
    return (
        "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n"
        '<qgis version="3.28" styleCategories="Symbology|Labeling" labelsEnabled="1">'
        '<renderer-v2 type="singleSymbol"><symbols><symbol type="fill" name="0" alpha="1">'
        '<layer class="SimpleFill" enabled="1"><Option type="Map">'
        '<Option type="QString" name="style" value="no"/>'
        f'<Option type="QString" name="outline_color" value="{colour}"/>'
        '<Option type="QString" name="outline_width" value="0.5"/>'
        "</Option></layer></symbol></symbols></renderer-v2>"
        '<labeling type="simple"><settings calloutType="simple">'
        f'<text-style fieldName={quoteattr(label)} isExpression="0" fontSize="10"/>'
        "</settings></labeling></qgis>\n"
    )
