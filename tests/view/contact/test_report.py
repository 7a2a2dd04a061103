import dataclasses
import json
import re

from coral.cli import main
from coral.view.contact.keyframes import moments
from coral.view.contact.report import write_contact_report
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
