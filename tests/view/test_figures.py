import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest

from coral.view.decisions import decisions
from coral.view.figures import clearance_chart, coverage_chart, event_chart, speed_chart
from coral.view.run import RunFolder

CHARTS = (coverage_chart, speed_chart, clearance_chart, lambda run: event_chart(run, decisions(run)))


@pytest.fixture(scope="module")
def run(finished):
    return RunFolder.read(finished)


def drawn(svg):
    """The picture, its texts and its tooltips."""
    root = ET.fromstring(svg)
    return root, [e.text for e in root.iter("text")], [e.text for e in root.iter("title")]


def test_a_cluster_is_marked_when_it_was_covered(run):
    root, texts, titles = drawn(coverage_chart(run))
    assert titles == ["middle covered at 0:15", "north covered at 0:33"]
    assert "100%" in texts
    assert root.get("aria-label") == "clusters covered"


def test_the_closest_pass_and_each_collision_are_marked(run):
    _, texts, titles = drawn(clearance_chart(run))
    k = int(np.nanargmin(run.column("clearance")))
    assert f"clearance: closest pass {run.column('clearance')[k]:.2f} m at 0:{int(run.column('t')[k]):02d}" in texts
    assert "collision at 0:26" in titles


def test_the_speed_scale_holds_every_speed(run):
    fast = replace(run, trajectory={**run.trajectory, "u": run.column("u") + 1.3})
    for one, top in ((run, "0.2"), (fast, "1.5")):
        _, texts, _ = drawn(speed_chart(one))
        assert top in texts


def test_each_cause_has_a_lane_and_each_question_a_bar(run):
    root, texts, titles = drawn(event_chart(run, decisions(run)))
    assert {"first question", "near the goal", "stuck", "advisor thinking", "mode", "incidents"} <= set(texts)
    assert "planner failed" not in texts
    bars = [e.get("data-decision") for e in root.iter("g") if e.get("class") == "ask"]
    assert bars == ["0", "1", "1", "1", "2"]
    assert "0:12–0:13: held back (a question was already open)" in titles
    assert "0:26: collision" in titles
    assert "0:28: left the planned path, planned anew" in titles


def test_words_of_a_run_are_no_markup_in_any_chart(run):
    bad = "<script>\"'&"

    def spoiled(event):
        return {key: bad if isinstance(value, str) and key != "event" else value for key, value in event.items()}

    odd = replace(run, events=tuple(spoiled(event) for event in run.events))
    for draw in CHARTS:
        svg = draw(odd)
        assert "<script" not in svg
        ET.fromstring(svg)
    assert f"{bad} covered at 0:15" in drawn(coverage_chart(odd))[2]


def test_a_run_without_anything_has_charts_too(run):
    empty = replace(run, events=(), trajectory={}, attempts=())
    for draw in CHARTS:
        assert drawn(draw(empty))[0].tag == "svg"
