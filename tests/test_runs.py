import errno
import json
import os
from datetime import datetime

import pytest
import yaml

from coral import __version__
from coral.errors import InputError
from coral.runs import (
    RunWriter,
    file_stem,
    new_run_folder,
    provenance,
    read_events,
    read_rows,
)

ODD = "a\ud800b\x00\x1b[31m\u202e\uffff"


def test_what_is_written_is_read_again_while_the_run_goes_on(tmp_path):
    writer = RunWriter(tmp_path / "run", ("step", "x"))
    writer.event(3, 0.30000000004, "goal", at=(1.0, 2.0))
    writer.row(0, 0.1234567)
    writer.row(1, "far")
    assert list(read_events(tmp_path / "run" / "events.jsonl")) == [
        {"step": 3, "t": 0.3, "event": "goal", "at": [1.0, 2.0]}
    ]
    rows = list(read_rows(tmp_path / "run" / "trajectory.csv"))
    assert rows == [{"step": "0", "x": "0.123457"}, {"step": "1", "x": "far"}]
    writer.close()


def test_half_a_line_of_a_killed_run_is_left_out(tmp_path):
    writer = RunWriter(tmp_path / "run", ("step", "x"))
    writer.event(0, 0.0, "start")
    writer.row(0, 1.5)
    writer.close()
    for name, half in (("events.jsonl", '{"step": 1, "t"'), ("trajectory.csv", "1,2")):
        with (tmp_path / "run" / name).open("a") as out:
            out.write(half)
    assert [event["event"] for event in read_events(tmp_path / "run" / "events.jsonl")] == ["start"]
    assert [row["x"] for row in read_rows(tmp_path / "run" / "trajectory.csv")] == ["1.5"]


def test_a_folder_that_holds_something_is_not_written_to(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match="--out: found a folder that is not empty, expected a new or empty folder"):
        RunWriter(tmp_path, ("step",))
    with pytest.raises(InputError, match="expected a folder that can be written"):
        RunWriter(tmp_path / "notes.txt" / "run", ("step",))
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


def test_the_next_run_gets_the_first_free_number(tmp_path):
    for taken in ("s1-001", "s1-003", "s2-002"):
        (tmp_path / taken).mkdir()
    assert new_run_folder(tmp_path, "s1") == tmp_path / "s1-002"


@pytest.mark.parametrize(
    ("name", "stem"),
    [
        ("s1", "s1"),
        ("my reef.v2", "my-reef.v2"),
        ("../../up", "up"),
        ("/etc/x", "etc-x"),
        ("a\0b\\c", "a-b-c"),
        ("..", "unnamed"),
        ("Großes Riff", "Großes-Riff"),
    ],
)
def test_the_name_of_a_world_leads_to_no_other_folder(tmp_path, name, stem):
    assert file_stem(name) == stem
    assert new_run_folder(tmp_path, name) == tmp_path / f"{stem}-001"


def test_provenance_names_the_version_and_a_date_with_its_zone():
    found = provenance()
    assert found["coral"] == __version__
    assert datetime.fromisoformat(found["date"]).tzinfo is not None


def test_a_run_folder_takes_any_text(tmp_path):
    writer = RunWriter(tmp_path / "run", ("step", "name"))
    writer.event(0, 0.0, "verdict", reason=ODD, answer={ODD: [ODD]})
    writer.row(0, ODD.replace("\ud800", "\udcff"))
    writer.yaml("config.yaml", {"world": ODD})
    writer.json("metrics.json", {"end_reason": ODD})
    writer.text("report.html", ODD)
    writer.close()
    for name in ("events.jsonl", "metrics.json"):
        told = (tmp_path / "run" / name).read_text(encoding="utf-8")
        assert "\\ud800" not in told
        assert json.loads(told)
    assert (
        "\ufffd" in yaml.load((tmp_path / "run" / "config.yaml").read_text(encoding="utf-8"), yaml.CSafeLoader)["world"]
    )
    assert (tmp_path / "run" / "report.html").read_text(encoding="utf-8") == ODD.replace("\ud800", "\ufffd")


class Full:
    """A disk that takes nothing more."""

    name = "events.jsonl"

    def write(self, text):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def close(self):
        self.write("")


def test_a_full_disk_names_the_file_and_the_log_can_still_be_closed(tmp_path):
    writer = RunWriter(tmp_path / "run", ("step",))
    writer._events = Full()
    with pytest.raises(OSError, match=r"No space left on device: .*events\.jsonl"):
        writer.event(0, 0.0, "start")
    writer.close()


def test_a_password_in_an_address_is_in_no_file_of_a_run(tmp_path):
    writer = RunWriter(tmp_path / "run", ("step",))
    writer.event(0, 0.0, "start", camera="rtsp://admin:s3cret@10.0.0.1/v")
    writer.yaml("config.yaml", {"camera": "rtsp://admin:s3cret@10.0.0.1/v"})
    writer.json("metrics.json", {"camera": "rtsp://admin:s3cret@10.0.0.1/v"})
    writer.close()
    files = {path.name: path.read_text() for path in (tmp_path / "run").iterdir()}
    assert sum("rtsp://***@10.0.0.1/v" in text for text in files.values()) == 3
    assert not any("s3cret" in text for text in files.values())
