"""Pictures and reports of runs whose text no font and no file takes as it is."""

import json

import pytest

from coral.cli import main

ODD = "a\ud800b\x00\x1b[31m\u202e\uffff<b>"


@pytest.fixture
def odd(fresh):
    """A run in which every text of the events is odd."""

    def spoiled(value):
        if isinstance(value, dict):
            return {key: value[key] if key == "event" else spoiled(value[key]) for key in value}
        return f"{value}{ODD}" if isinstance(value, str) else value

    for name in ("events.jsonl", "attempts.jsonl"):
        lines = (fresh / name).read_text().splitlines()
        (fresh / name).write_text("".join(json.dumps(spoiled(json.loads(line))) + "\n" for line in lines))
    return fresh


def test_a_run_with_odd_text_gets_report_map_and_film(odd, capfd, monkeypatch):
    monkeypatch.setattr("coral.view.video.LONGEST_S", 1.0)
    assert main(["report", str(odd), "--video"]) == 0
    assert capfd.readouterr().err == ""
    assert "Along &lt;the&gt; reef.a\ufffdb" in (odd / "report.html").read_text(encoding="utf-8")
    assert (odd / "map.png").is_file()
    assert (odd / "mission.mp4").is_file()
