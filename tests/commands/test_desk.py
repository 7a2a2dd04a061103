import json
import re
import signal
import subprocess
import sys
import urllib.request

import pytest

from coral.cli import main
from coral.commands.desk import Desk


def test_the_command_serves_until_it_is_told_to_stop(tmp_path):
    command = [sys.executable, "-m", "coral.cli", "desk", str(tmp_path / "inbox"), "--port", "0", "--json"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        url = re.search(r"(http://127\.0\.0\.1:\d+/)\?token=(\S+)", process.stderr.readline())
        asked = urllib.request.Request(f"{url[1]}api/state", headers={"Authorization": f"Bearer {url[2]}"})
        assert json.load(urllib.request.urlopen(asked, timeout=10)) == {"questions": [], "missions": []}
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
        (["{folder}", "--token-file", "{file}"], "token: found a token of 1 characters"),
        (["{folder}", "--token-file", "{folder}/no"], "no: --token-file: found no such file"),
        (["{folder}", "--token", "no-flag-for-it-exists"], "--token"),
        (["{folder}", "--host", "no such host"], "--host: found 'no such host'"),
        ([], "coral desk: INBOX: found nothing"),
    ],
)
def test_bad_flags_are_one_line(tmp_path, capsys, words, message):
    (tmp_path / "file").write_text("x\n")
    assert main(["desk", *(word.format(file=tmp_path / "file", folder=tmp_path) for word in words)]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


@pytest.mark.parametrize(("answered", "said"), [(0, "0 answers went"), (1, "1 answer went"), (2, "2 answers went")])
def test_the_end_tells_how_many_answers_were_given(tmp_path, answered, said):
    assert said in Desk(inbox=tmp_path).describe({"answered": answered, "inbox": "inbox"})


def test_the_token_of_the_environment_is_checked_too(refused, tmp_path, monkeypatch):
    monkeypatch.setenv("CORAL_DESK_TOKEN", "short")
    assert "token: found a token of 5 characters" in refused("desk", tmp_path / "inbox", "--port", "0")
