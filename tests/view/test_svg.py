import math
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from coral.view.svg import LEFT, RIGHT, WIDTH, Span, chart, clock, path, text, thin, time_axis, time_ticks


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
    assert path([0, 1, 2, 3], [0, 1, math.nan, 3], "c") == '<path d="M0.0,0.0L1.0,1.0M3.0,3.0" class="c"/>'
    assert path([0, 1, 2], [5, 5, 7], "c", steps=True) == '<path d="M0.0,5.0L1.0,5.0L2.0,5.0L2.0,7.0" class="c"/>'
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
