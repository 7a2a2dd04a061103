import json
import re
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path

import cv2
import numpy as np
import pytest

from coral.cli import main
from coral.commands.reef_run import ReefRun
from coral.reef.belief import Belief
from coral.reef.camera import CameraCfg
from coral.reef.geometry import Pose
from coral.reef.mapping import OccupancyMap
from coral.view.questions import question_pictures


def test_the_command_serves_until_it_is_told_to_stop(tmp_path):
    command = [sys.executable, "-m", "coral.cli", "desk", str(tmp_path / "inbox"), "--port", "0", "--json"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        url = re.search(r"http://127\.0\.0\.1:\d+/", process.stderr.readline()).group()
        assert json.load(urllib.request.urlopen(f"{url}api/state", timeout=10)) == {"questions": [], "missions": []}
        process.send_signal(signal.SIGTERM)
        out, _ = process.communicate(timeout=20)
    finally:
        process.kill()
    assert process.returncode == 0
    assert json.loads(out)["answered"] == 0
    assert (tmp_path / "inbox").is_dir()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["{file}"], "INBOX: found a file, expected a folder"),
        (["{folder}", "--port", "-1"], "--port: found -1"),
        (["{folder}", "--token", "x"], "--token: found a token of 1 characters"),
        (["{folder}", "--host", "no such host"], "--host: found 'no such host'"),
        ([], "coral desk: INBOX: found nothing"),
    ],
)
def test_bad_flags_are_one_line(tmp_path, capsys, words, message):
    (tmp_path / "file").write_text("")
    assert main(["desk", *(word.format(file=tmp_path / "file", folder=tmp_path) for word in words)]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


def test_the_map_says_where_the_world_lies_in_it():
    belief = Belief(OccupancyMap((20.0, 16.0), CameraCfg()))
    belief.pose = Pose(7.0, 4.0, 2.0)
    belief.goal = (12.0, 9.0)
    (picture,) = question_pictures(belief)
    rgb = cv2.imdecode(np.frombuffer(picture.png, np.uint8), cv2.IMREAD_COLOR)[:, :, ::-1]
    column, row = np.array(picture.pixel_from_world) @ (belief.pose.x, belief.pose.y, 1.0)
    red, green, blue = rgb[round(row), round(column)].astype(int)
    assert red > 180 > 80 > max(green, blue)
    # The goal's cross-hair leaves a hole in its middle and is magenta 13 px beside it.
    column, row = np.array(picture.pixel_from_world) @ (*belief.goal, 1.0)
    red, green, blue = rgb[round(row), round(column) + 13].astype(int)
    assert min(red, blue) > 120 > 80 > green


def test_the_default_inbox_lies_in_the_run_folder(tmp_path, monkeypatch):
    """The inbox is made with the first question, so the run folder is still empty when the run opens it."""
    seen = []

    class Stop(Exception):
        pass

    def stop(self, observers):
        seen.append(self.writer.folder)
        raise Stop

    monkeypatch.setattr("coral.commands.reef_run.Mission.run", stop)
    with pytest.raises(Stop):
        ReefRun(world="s1", advisor="desk", out=tmp_path / "run", quiet=True)()
    assert seen == [tmp_path / "run"]
    (notice,) = (tmp_path / "run" / "inbox").glob("mission-*.json")
    assert json.loads(notice.read_text())["state"] == "failed"


def test_the_program_in_the_guide_answers(tmp_path, monkeypatch, ask, case):
    page = (Path(__file__).parents[2] / "docs" / "answer-as-the-operator.md").read_text(encoding="utf-8")
    asking = ask(case.reef_question())
    monkeypatch.chdir(tmp_path)
    exec(compile(re.search(r"```python\n(.*?)```", page, re.DOTALL)[1], "guide", "exec"), {})
    assert asking.result().selected_centroid_index == 4
