import json
import os
import sys
from pathlib import Path

FOLDER = Path(__file__).parents[2] / "benchmarks"


def test_rows_that_are_lost_and_ticks_that_are_late_are_counted(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    import soak

    steps = [0, 1, 2, 5, 6]
    (tmp_path / "trajectory.csv").write_text("step,t\n" + "".join(f"{k},0\n" for k in steps))
    events = [{"event": "late_tick"}, {"event": "state", "state": "holding", "reason": "still"}]
    (tmp_path / "events.jsonl").write_text("".join(json.dumps(event) + "\n" for event in events))
    minutes, memory, ticks, late, lost, _ = [
        cell.strip() for cell in soak.state(tmp_path, os.getpid(), 90.0).split("|")
    ][1:-1]
    assert (minutes, ticks, late, lost) == ("1.5", "5", "1", "2")
    assert int(memory) > 10
    assert "holding: still" in soak.ends(tmp_path)
    sys.modules.pop("soak")
