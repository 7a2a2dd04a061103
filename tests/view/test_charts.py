import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from coral.view.charts import INSIDE, LEFT, WIDTH, bar, curves_chart, dot, lanes_chart, svg

T = np.linspace(0.0, 1.0, 20)


def texts(axes):
    return [e.text for e in ET.fromstring(svg(axes)).iter("text")]


def box(told, root):
    """The left and right edge (px) of what a pointer is told about."""
    (group,) = (e for e in root.iter("g") if e.findtext("title") == told)
    xs = [float(x) for x in re.findall(r"[ML] ([-\d.]+)", group.find("path").get("d"))]
    return pytest.approx((min(xs), max(xs)), abs=1e-3)


@pytest.mark.parametrize("duration_s", [0.0, 0.4, 9.0, 61.0, 600.0, 36_000.0])
def test_times_are_few_and_start_at_zero(duration_s):
    said = [one for one in texts(lanes_chart(duration_s, ["a"], "x")) if ":" in one]
    assert said[0] == "0:00"
    assert len(said) <= 11


def test_words_are_no_markup_and_no_formula():
    bad = '"><script>$x$'
    axes = curves_chart(1.0, T, {bad: T}, "x")
    dot(axes, 0.5, 0.5, bad)
    root = ET.fromstring(svg(axes))
    assert root.findtext(".//title") == bad
    assert bad in [e.text for e in root.iter("text")]
    lanes = lanes_chart(1.0, [bad], "x")
    bar(lanes, 0, 0.0, 1.0, "x", "red", name=bad)
    assert texts(lanes).count(bad) == 2


def test_a_chart_is_the_same_each_time_and_shares_no_id_with_another():
    one, again, other = (svg(curves_chart(1.0, T, {"x": T}, label)) for label in ("x", "x", "y"))
    assert one == again
    ids = [set(re.findall(r'id="([^"]*)"', text)) for text in (one, other)]
    assert ids[0]
    assert not ids[0] & ids[1]
    assert "<style" not in one


def test_a_long_run_keeps_its_extremes_and_not_all_its_points():
    t, values = np.arange(100_000.0), np.random.default_rng(0).random(100_000)
    values[54_321] = 9.0
    text = svg(curves_chart(1e5, t, {"x": values}, "x"))
    assert len(text) < 150_000
    assert re.search(rf"L {LEFT + INSIDE * 0.54321:.0f}[.\d]* 25 \n", text)


def test_a_legend_of_many_names_takes_more_rows_and_dashes_the_colours_that_come_again():
    few, many = (svg(curves_chart(1.0, T, {f"a rather long name {k}": T for k in range(n)}, "x")) for n in (2, 12))
    heights = [float(re.search(r'viewBox="0 0 1100 (\d+)', text)[1]) for text in (few, many)]
    assert heights[1] > heights[0]
    assert ("stroke-dasharray" in few, many.count("stroke: #0b6470")) == (False, 4)


def test_a_moment_is_a_bar_around_its_time_that_stays_on_the_axis():
    axes = lanes_chart(1.0, ["a", "b"], "x")
    for at in (0.0, 0.5, 1.0):
        bar(axes, 1, at, at, f"at {at}", "red", decision=3)
    bar(axes, 0, 0.5, 9.0, "late", "red")
    root = ET.fromstring(svg(axes))
    assert box("at 0.0", root) == (LEFT, LEFT + 4)
    assert box("at 0.5", root) == (LEFT + INSIDE / 2 - 2, LEFT + INSIDE / 2 + 2)
    assert box("at 1.0", root) == (WIDTH - 22, WIDTH - 18)
    assert box("late", root) == (LEFT + INSIDE / 2, WIDTH - 18)
    assert [e.get("data-decision") for e in root.iter("g") if e.get("class") == "ask"] == ["3"] * 3


def test_a_name_is_written_into_a_bar_that_has_room_for_it():
    axes = lanes_chart(1.0, ["a"], "bars")
    for end in (0.01, 0.9):
        bar(axes, 0, 0.0, end, "x", "red", name="lifting")
    assert texts(axes).count("lifting") == 1
