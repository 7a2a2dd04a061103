import re
import xml.etree.ElementTree as ET

import numpy as np

from coral.view.curves import curves_chart


def test_a_legend_of_many_names_takes_more_rows():
    t = np.linspace(0.0, 1.0, 20)
    few, many = (curves_chart(1.0, t, {f"a rather long name {k}": t for k in range(n)}, "x") for n in (2, 12))
    heights = [float(re.search(r'viewBox="0 0 1100 (\d+)', svg)[1]) for svg in (few, many)]
    assert heights[1] > heights[0]


def test_colours_that_come_again_are_dashed():
    t = np.linspace(0.0, 1.0, 20)
    svg = curves_chart(1.0, t, {str(k): t for k in range(11)}, "x")
    assert svg.count("stroke:#0b6470;stroke-dasharray") == 2  # in the legend and as a curve
    assert svg.count("stroke:#0b6470") == 4


def test_a_value_that_is_missing_leaves_a_gap_and_a_band_is_on_the_scale():
    t = np.array([0.0, 0.5, 1.0])
    svg = curves_chart(1.0, t, {"x": np.array([1.0, np.nan, 2.0])}, "x", bands=[(9.0, 1.0)])
    assert "nan" not in svg
    assert "10" in [e.text for e in ET.fromstring(svg).iter("text")]
