"""Run folders in which something else stands where a number belongs: read as far as they make sense."""

import json
import os

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from coral.cli import main
from coral.view.live.stream import RunStream
from coral.view.live.viewer import subject_of
from coral.view.records import sound
from coral.view.run import RunFolder

ODD = [
    "x",
    None,
    [1],
    {"a": 1},
    1e400,
    -1e300,
    10**400,
    True,
    "\ud800",
    [[]],
    [None],
    {},
    [{"x": "a", "index": 0, "y": 1}],
]


def spoil(path):
    """Beside each kind of line, a copy of it for each of its fields and each odd value in that field."""
    kept, seen = [], set()
    for line in map(json.loads, path.read_text().splitlines()):
        kept.append(line)
        for key in line:
            if (line.get("event"), key, line.get("verdict")) not in seen:
                seen.add((line.get("event"), key, line.get("verdict")))
                kept += [{**line, key: odd} for odd in ODD] + [{k: v for k, v in line.items() if k != key}]
    path.write_text("".join(json.dumps(line) + "\n" for line in kept))


@pytest.mark.parametrize("name", ["events.jsonl", "attempts.jsonl"])
def test_lines_with_text_for_numbers_are_left_out_and_counted(fresh, name, capsys):
    spoil(fresh / name)
    assert main(["report", str(fresh)]) == 0, capsys.readouterr().err
    assert "with text where a number belongs left out" in (fresh / "report.html").read_text()
    json.dumps(streamed(fresh), allow_nan=False)


def streamed(folder):
    """What the viewer's page gets of a run."""
    stream = RunStream(folder, lambda: subject_of(folder))
    return [stream.subject.head, stream.news(0, 0)]


def test_documents_with_odd_values_are_read_as_far_as_they_make_sense(fresh, capsys):
    metrics = json.loads((fresh / "metrics.json").read_text())
    (fresh / "metrics.json").write_text(
        json.dumps({**metrics, "coverage": "all", "sim_time_s": [], "collisions": None})
    )
    (fresh / "timing.json").write_text(json.dumps({"wall_time_s": "long"}))
    world = yaml.safe_load((fresh / "world.yaml").read_text())
    (fresh / "world.yaml").write_text(yaml.safe_dump({**world, "size_m": ["wide", 1e300]}))
    assert main(["report", str(fresh)]) == 0, capsys.readouterr().err
    assert "size_m is no width and height" in (fresh / "report.html").read_text()
    json.dumps(streamed(fresh), allow_nan=False)


@pytest.mark.parametrize("deep", ['{"a": ' + "[" * 900 + "]" * 900 + "}", "[" * 100_000, '{"a":' * 100_000])
def test_deep_lines_and_documents_are_left_out(fresh, deep):
    for name in ("events.jsonl", "attempts.jsonl"):
        text = (fresh / name).read_text()
        (fresh / name).write_text(f"{deep}\n{text}")
    for name in ("metrics.json", "config.yaml", "world.yaml"):
        (fresh / name).write_text(deep)
    run = RunFolder.read(fresh)
    assert run.events[0]["event"] == "start"
    assert (run.metrics, run.config, run.world) == ({}, {}, {})
    assert sum("was left out" in note for note in run.notes) == 5


def test_a_pipe_in_a_run_folder_is_not_waited_for(fresh):
    for name in ("events.jsonl", "trajectory.csv"):
        (fresh / name).unlink()
        os.mkfifo(fresh / name)
    run = RunFolder.read(fresh)
    assert run.events == ()
    assert {"events.jsonl cannot be read: a named pipe.", "trajectory.csv cannot be read: a named pipe."} <= set(
        run.notes
    )


def test_a_field_without_end_is_no_table(fresh):
    (fresh / "trajectory.csv").write_text("step,t\n" + "1" * 200_000 + ",2\n")
    run = RunFolder.read(fresh)
    assert run.trajectory == {}
    assert any("is no table" in note for note in run.notes)


ANY = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=3),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner, max_size=3),
    max_leaves=6,
)
NAMES = st.sampled_from(
    ["event", "t", "x", "y", "decision", "attempt", "pictures", "centroids", "captions", "answer", "first"]
)


@given(st.dictionaries(NAMES, ANY))
def test_any_record_is_judged(record):
    assert sound(record) in (True, False)
