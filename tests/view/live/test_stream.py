import json

import pytest

from coral.view.live.stream import RunStream, Tail


class Counter:
    """Tells every event by its name, and keeps time and x of a row."""

    head = {}

    def tell(self, event):
        return {"line": event["event"]} if event["event"] != "silent" else None

    def row(self, row):
        return [row["t"], row.get("x", float("nan"))]


@pytest.fixture
def run(tmp_path):
    return tmp_path


def event(t, name="e", **fields):
    return json.dumps({"t": t, "event": name, **fields}) + "\n"


def add(run, name, text):
    with open(run / name, "a", encoding="utf-8") as file:
        file.write(text)


def test_lines_come_once_and_only_when_they_are_complete(run):
    tail = Tail(run / "log")
    assert tail.lines() == []
    add(run, "log", "one\ntw")
    assert tail.lines() == ["one"]
    add(run, "log", "o\n")
    assert tail.lines() == ["two"]
    assert tail.lines() == []
    tail.close()


def test_a_page_gets_what_it_does_not_have(run):
    stream = RunStream(run, Counter)
    add(run, "events.jsonl", event(0.0, "start") + event(0.1, "silent"))
    add(run, "trajectory.csv", "step,t,x\n1,0.1,2\n2,0.2,\n")
    first = stream.news(0, 0)
    assert first["moments"] == [{"t": 0.0, "line": "start"}]
    assert first["rows"] == [[0.1, 2.0], [0.2, None]]
    assert first["steps_per_s"] == 10.0
    assert not first["complete"]
    add(run, "events.jsonl", event(0.3, "end"))
    add(run, "trajectory.csv", "3,0.3,5\n")
    (run / "metrics.json").write_text("{}")
    later = stream.news(1, 2)
    assert later["moments"] == [{"t": 0.3, "line": "end"}]
    assert later["rows"] == [[0.3, 5.0]]
    assert later["complete"]
    assert stream.news(0, 0)["moments"][0]["line"] == "start"  # another page
    stream.close()


@pytest.mark.parametrize("line", ["{", "[1]", '{"event": "x"}', '{"t": "x", "event": "e"}', "[" * 5000, '{"t": 1e99}'])
def test_what_is_no_event_is_left_out(run, line):
    add(run, "events.jsonl", line + "\n" + event(1.0, "good", text="\ud800"))
    stream = RunStream(run, Counter)
    assert [moment["line"] for moment in stream.news(0, 0)["moments"]] == ["good"]
    stream.close()


def test_a_long_recording_is_thinned(run, monkeypatch):
    monkeypatch.setattr("coral.view.live.stream.ROWS", 10)
    add(run, "trajectory.csv", "step,t,x\n" + "".join(f"{k},{k / 10},0\n" for k in range(100)))
    stream = RunStream(run, Counter)
    rows = stream.news(0, 0)["rows"]
    assert 10 <= len(rows) <= 12
    assert rows[-1][0] == 9.9
    stream.close()


def test_nothing_is_told_before_the_run_has_begun(run):
    stream = RunStream(run, lambda: None)
    assert stream.news(0, 0)["moments"] == []
