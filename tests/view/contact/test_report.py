import dataclasses
import json
import re

import numpy as np

from coral.cli import main
from coral.view.contact.figures import stage_spans
from coral.view.contact.report import FEWEST, MOST, SIZE, Keyframe, keyframes, moments, sheet, write_contact_report
from coral.view.run import RunFolder


def cut(folder, at_s):
    """What a run leaves that is killed at a time."""
    for name in ("metrics.json", "timing.json"):
        (folder / name).unlink()
    lines = (folder / "events.jsonl").read_text().splitlines()
    kept = [line for line in lines if float(re.search(r'"t": ([\d.]+)', line)[1]) <= at_s]
    (folder / "events.jsonl").write_text("\n".join(kept) + '\n{"step": 9')
    for name in ("trajectory.csv", "states.csv"):
        rows = (folder / name).read_text().splitlines()
        kept = [row for row in rows[1:] if float(row.split(",")[1]) <= at_s]
        (folder / name).write_text("\n".join([rows[0], *kept]) + "\n1,2")
    return folder


def test_a_report_shows_outcome_pictures_charts_and_where_it_comes_from(copy):
    page = write_contact_report(copy).read_text()
    assert "Not done within 1 s of simulated time" in page
    assert page.count("data:image/webp") == len(moments(RunFolder.read(copy)))
    for said in ("Cost, term by term", "Force", "final belief", "pick-box"):
        assert said in page
    assert (copy / "keyframes.png").read_bytes().startswith(b"\x89PNG")


def test_a_report_of_a_broken_condition_names_it(copy):
    metrics = json.loads((copy / "metrics.json").read_text())
    decided = {"advisor": 0, "memory": 0, "recording": 1, "fallback": 0}
    metrics |= {"end_reason": "broken: peak-force of box", "decided_by": decided}
    (copy / "metrics.json").write_text(json.dumps(metrics))
    events = (copy / "events.jsonl").read_text().splitlines()
    end = json.dumps({**json.loads(events[-1]), "reason": "broken: peak-force of box", "detail": ""})
    (copy / "events.jsonl").write_text("\n".join([*events[:-1], end]) + "\n")
    page = write_contact_report(copy).read_text()
    assert "because a condition of success was broken that can never hold again (peak-force of box)" in page
    assert "a condition of success was broken that can never hold again: peak-force of box" in page
    assert "of path. The recording decided" in page
    assert "<dt>wall time (s)</dt>" in page


def test_a_report_loads_nothing(copy):
    page = write_contact_report(copy).read_text()
    assert not re.search(r"""(?:src|href)=["'](?!data:|#|episode\.mp4)""", page)
    assert "http" not in page


def test_a_killed_run_is_reported_with_what_there_is(copy):
    page = write_contact_report(cut(copy, 0.3)).read_text()
    assert "This run was interrupted" in page
    assert "Cut off after 0.3 s" in page
    assert "was cut off while it was written" in page


def test_a_run_of_which_next_to_nothing_is_left_is_reported_too(copy):
    cut(copy, -1.0)
    (copy / "states.csv").unlink()
    assert "Nothing was recorded" in write_contact_report(copy).read_text()


def test_a_run_without_states_has_a_report_without_pictures(copy):
    (copy / "states.csv").unlink()
    page = write_contact_report(copy).read_text()
    assert "data:image/webp" not in page
    assert "Cost, term by term" in page


def test_names_from_a_task_file_are_escaped(copy):
    task = (copy / "task.yaml").read_text().replace("title: Pick box", "title: <script>alert(1)</script>")
    (copy / "task.yaml").write_text(task)
    assert "<script>" not in write_contact_report(copy).read_text()


def test_coral_report_makes_page_keyframes_and_film(copy, capsys):
    assert main(["report", str(copy), "--video", "--json"]) == 0
    assert (copy / "episode.mp4").stat().st_size > 1000
    assert "episode.mp4" in (copy / "report.html").read_text()


def test_a_world_that_cannot_be_built_costs_the_pictures_only(copy):
    config = (copy / "config.yaml").read_text().replace("world: hand", "world: elsewhere")
    (copy / "config.yaml").write_text(config)
    page = write_contact_report(copy).read_text()
    assert "No pictures" in page
    assert dataclasses.is_dataclass(RunFolder.read(copy))


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
