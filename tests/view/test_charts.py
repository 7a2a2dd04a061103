import math
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from coral.view.charts import (
    LEFT,
    RIGHT,
    WIDTH,
    Bar,
    Span,
    chart,
    clock,
    curves_chart,
    lanes_chart,
    path,
    text,
    thin,
    time_axis,
    time_ticks,
)


def test_a_scale_maps_its_ends_and_its_middle():
    span = Span(2.0, 4.0, 100.0, 20.0)
    assert [span(v) for v in (2.0, 3.0, 4.0)] == [100.0, 60.0, 20.0]
    assert Span(2.0, 2.0, 100.0, 20.0)(2.0) == 100.0


def test_ticks_are_round_and_inside():
    assert Span(-0.3, 1.0, 0, 1).ticks(4) == pytest.approx([0.0, 0.5, 1.0])
    assert Span(0.0, 95.0, 0, 1).ticks(5) == [0.0, 20.0, 40.0, 60.0, 80.0]


@pytest.mark.parametrize(
    ("seconds", "said"), [(0.0, "0:00"), (59.4, "0:59"), (70.6, "1:11"), (60.0, "1:00"), (3725.0, "62:05")]
)
def test_time_in_minutes_and_seconds(seconds, said):
    assert clock(seconds) == said


@pytest.mark.parametrize("duration_s", [0.0, 0.4, 9.0, 61.0, 600.0, 36_000.0])
def test_time_ticks_are_few_and_on_the_axis(duration_s):
    ticks = time_ticks(time_axis(duration_s))
    assert 1 <= len(ticks) <= 11
    assert ticks[0] == 0.0
    assert ticks[-1] <= max(duration_s, 1e-3)


def test_words_are_no_markup():
    assert ET.fromstring(text(1, 2, "<b>&'\"")).text == "<b>&'\""
    svg = ET.fromstring(chart(50, [], time_axis(1.0), label='"><script>', top=0, bottom=40))
    assert svg.get("aria-label") == '"><script>'


def test_a_curve_is_broken_where_a_value_is_missing():
    assert (
        path([0, 1, 2, 3], [0, 1, math.nan, 3], "c") == '<path d="M0.0,0.0L1.0,1.0M3.0,3.0" class="curve" style="c"/>'
    )
    assert (
        path([0, 1, 2], [5, 5, 7], "c", steps=True)
        == '<path d="M0.0,5.0L1.0,5.0L2.0,5.0L2.0,7.0" class="curve" style="c"/>'
    )
    assert path([1.0], [math.inf], "c") == ""


def test_charts_share_their_time_axis():
    axis = time_axis(10.0)
    assert (axis(0.0), axis(10.0)) == (LEFT, WIDTH - RIGHT)
    svg = ET.fromstring(chart(77.0, [], axis, label="x", top=0, bottom=40))
    assert svg.get("viewBox") == f"0 0 {WIDTH:.0f} 77"
    assert [t.text for t in svg.iter("text")] == [clock(t) for t in time_ticks(axis)]


def test_thinning_keeps_ends_and_every_extreme():
    times, values = np.arange(100_000.0), np.zeros(100_000)
    values[12_345], values[54_321], values[60_000] = 9.0, -9.0, math.nan
    few, kept = thin(times, values)
    assert len(few) <= 3 * 900
    assert (few[0], few[-1]) == (0.0, 99_999.0)
    assert {(12_345.0, 9.0), (54_321.0, -9.0)} <= set(zip(few.tolist(), kept.tolist(), strict=True))
    assert thin(times[:5], values[:5])[0] is not None
    np.testing.assert_array_equal(thin(times[:5], values[:5])[0], times[:5])


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
    svg = curves_chart(1.0, t, {"x": np.array([1.0, np.nan, 2.0])}, "x", bands=[(8.0, 10.0, "wanted")])
    assert "nan" not in svg
    assert "10" in [e.text for e in ET.fromstring(svg).iter("text")]


def test_dots_and_limits_stand_at_their_values():
    t = np.array([0.0, 1.0])
    svg = curves_chart(1.0, t, {"x": t}, "x", ceiling=1.0, limits=[(0.5, "limit")], dots=[(1.0, 0.5, "half <way>")])
    root = ET.fromstring(svg)
    (dot,) = root.iter("circle")
    (limit,) = (one for one in root.iter("line") if one.get("class") == "limit")
    assert dot.get("cy") == limit.get("y1")
    assert [one.text for one in root.iter("title")] == ["half <way>"]


def test_a_moment_is_a_bar_around_its_time_that_stays_on_the_axis():
    bars = [Bar(lane="b", start=at, end=at, said="x", least=10) for at in (0.0, 0.5, 1.0)]
    root = ET.fromstring(lanes_chart(1.0, ["a", "b"], bars, "bars"))
    lefts = [float(one.get("x")) for one in root.iter("rect")]
    assert lefts == [LEFT, time_axis(1.0)(0.5) - 5, WIDTH - RIGHT - 10]


def test_a_name_is_written_into_a_bar_that_has_room_for_it():
    bars = [Bar(lane="a", start=0.0, end=end, said="x", name="lifting") for end in (0.01, 0.9)]
    assert lanes_chart(1.0, ["a"], bars, "bars").count(">lifting<") == 1
