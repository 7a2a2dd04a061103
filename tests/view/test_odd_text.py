"""Pictures and reports of runs whose text no font and no file takes as it is."""

import json
import subprocess
import sys

import pytest

from coral.cli import main
from coral.view.report import write_report

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


def test_a_run_with_odd_text_gets_its_report(odd):
    page = write_report(odd).read_text(encoding="utf-8")
    assert "Along &lt;the&gt; reef.a\ufffdb" in page


def test_a_run_with_odd_text_gets_map_and_film(odd):
    command = [sys.executable, "-m", "coral.cli", "report", str(odd), "--video"]
    done = subprocess.run(command, capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (0, b"")
    assert (odd / "mission.mp4").is_file()


def test_the_command_writes_it_too(odd, capsys):
    assert main(["report", str(odd)]) == 0
    assert capsys.readouterr().err == ""
