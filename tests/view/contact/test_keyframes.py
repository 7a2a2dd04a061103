import json

import numpy as np

from coral.view.contact.figures import stage_spans
from coral.view.contact.keyframes import FEWEST, MOST, SIZE, Keyframe, keyframes, moments, sheet
from coral.view.run import RunFolder


def test_moments_are_in_order_and_hold_beginning_stages_and_end(recorded):
    run = RunFolder.read(recorded)
    chosen = moments(run)
    times = [t for t, _ in chosen]
    assert times == sorted(times)
    assert (times[0], times[-1]) == (0.0, run.duration_s)
    assert len(chosen) <= MOST
    assert chosen[-1][1] == "timeout"
    assert {f"begin to {name}" for start, _, name in stage_spans(run) if start > 0} <= {why for _, why in chosen}
    assert len(keyframes(run)) == len(chosen)


def run_of(tmp_path, *events, end=10.0):
    """A run with these events alone."""
    lines = [{"t": 0.0, "event": "start"}, *events, {"t": end, "event": "end"}]
    (tmp_path / "events.jsonl").write_text("".join(json.dumps({"step": 0, **line}) + "\n" for line in lines))
    return RunFolder.read(tmp_path)


def test_a_run_in_which_little_happened_is_halved_until_there_are_enough(tmp_path):
    times = [t for t, _ in moments(run_of(tmp_path))]
    assert len(times) == FEWEST
    assert np.diff(times).max() <= 2.5


def test_only_the_first_touch_of_a_thing_by_the_hand_counts_and_the_number_is_limited(tmp_path):
    touches = [
        {"t": t, "event": "contact", "first": first, "second": "box", "force_n": 1.0}
        for t, first in ((1.0, "table"), (3.0, "hand"), (5.0, "left"))
    ]
    why = {why: t for t, why in moments(run_of(tmp_path, *touches))}
    assert why["touches the box"] == 3.0
    assert sum("touches" in one for one in why) == 1
    busy = [{"t": 0.4 * k, "event": "stage", "stage": f"s{k}"} for k in range(1, 24)]
    assert len(moments(run_of(tmp_path, *busy))) == MOST


def test_a_sheet_has_four_pictures_in_a_row():
    frame = Keyframe(1.0, "start", np.zeros((SIZE[1], SIZE[0], 3), np.uint8))
    (one, four, five) = (sheet([frame] * n).shape for n in (1, 4, 5))
    assert one[0] == four[0] < five[0]
    assert one[1] < four[1] == five[1]
