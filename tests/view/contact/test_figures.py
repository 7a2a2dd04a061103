import xml.etree.ElementTree as ET
from dataclasses import replace

import pytest

from coral.view.contact.figures import (
    cost_chart,
    force_chart,
    motion_chart,
    opening_chart,
    samples_chart,
    stage_names,
    stage_spans,
    stages_chart,
    touching,
    tracking_chart,
    tracks,
    wanted_forces,
)
from coral.view.run import RunFolder

CHARTS = (
    stages_chart,
    cost_chart,
    samples_chart,
    opening_chart,
    lambda run: force_chart(run, ["box"]),
    lambda run: motion_chart(run, ["box"]),
)


def test_contacts_of_the_whole_run_have_ended(recorded):
    run = RunFolder.read(recorded)
    touches = touching(run)
    assert {(touch["first"], touch["second"]) for touch in touches} >= {("box", "table")}
    assert all(touch["begun_s"] <= touch["ended_s"] <= run.duration_s + 1e-6 for touch in touches)


def test_the_forces_that_a_task_asks_for_are_drawn_and_told(recorded):
    run = RunFolder.read(recorded)
    assert wanted_forces(run) == ""
    limit = {"kind": "peak-force", "object": "box", "newtons": 25}
    limited = replace(run, world={**run.world, "success": {"conditions": [limit]}})
    assert wanted_forces(limited) == " Line: the most that it allows, 25 N."
    assert force_chart(limited, ["box"]).count("dasharray") == 1 + force_chart(run, ["box"]).count("dasharray")


@pytest.mark.parametrize("draw", CHARTS)
def test_words_of_a_run_are_no_markup_in_any_chart(recorded, draw):
    run = RunFolder.read(recorded)
    bad = "<script>\"'&"

    def spoiled(event):
        changed = {key: bad if isinstance(value, str) and key != "event" else value for key, value in event.items()}
        return {**changed, "terms": dict.fromkeys((bad, "calm"), 1.0)} if event["event"] == "plan" else changed

    svg = draw(replace(run, events=tuple(spoiled(event) for event in run.events)))
    assert "<script" not in svg
    assert ET.fromstring(svg).get("role") == "img"


def test_stages_follow_one_another_to_the_end(recorded):
    run = RunFolder.read(recorded)
    spans = stage_spans(run)
    assert [name for _, _, name in spans][:1] == ["down"]
    assert [end for _, end, _ in spans] == [*(start for start, _, _ in spans[1:]), run.duration_s]
    assert stage_names(run) == list(dict.fromkeys(name for _, _, name in spans))


def test_a_contact_in_the_last_moment_has_a_width(recorded):
    run = RunFolder.read(recorded)
    end_s = run.duration_s
    last = {"t": end_s, "event": "contact_end", "first": "a", "second": "b", "begun_s": end_s, "ended_s": end_s}
    svg = stages_chart(replace(run, events=(*run.events, {**last, "mean_n": 1.0, "peak_n": 1.0})))
    assert 'd="M 1078 ' in svg


def test_an_open_contact_of_a_killed_run_ends_with_its_record(recorded):
    run = RunFolder.read(recorded)
    opened = tuple(event for event in run.events if event["event"] not in ("contact_end", "contact"))
    contact = {"t": 0.5, "event": "contact", "first": "box", "second": "hand", "force_n": 3.0}
    opened = (*opened[:-1], contact, opened[-1])
    assert touching(replace(run, events=opened)) == []
    (touch,) = touching(replace(run, events=opened, metrics={}))
    assert (touch["begun_s"], touch["ended_s"], touch["mean_n"]) == (0.5, run.duration_s, 3.0)


def test_a_run_without_anything_has_charts_too(recorded):
    empty = replace(RunFolder.read(recorded), events=(), trajectory={})
    for draw in CHARTS:
        assert ET.fromstring(draw(empty)).tag == "svg"
    assert tracking_chart(empty, ["box"]) == ""


def test_what_was_lost_and_found_is_told_in_a_sentence(recorded):
    run = RunFolder.read(recorded)
    assert tracks(replace(run, events=())) == "No object was lost."
    events = (
        {"t": 1.0, "event": "track", "object": "box", "lost": True, "reason": "hidden"},
        {"t": 2.5, "event": "track", "object": "box", "lost": False},
    )
    assert tracks(replace(run, events=events)) == "box lost at 1.00 s (hidden); box found at 2.50 s."
    assert tracks(replace(run, events=events * 20)).endswith(" ….")
