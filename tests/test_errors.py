import errno
import re
import tomllib
from pathlib import Path

import pytest

from coral.errors import InputError, RunError, first_line, naming, nearest, without_password


def test_an_input_error_is_one_line_that_names_place_field_found_and_expected():
    error = InputError("a.yaml", "start.x", "'left\nright'", "a  number")
    assert str(error) == "a.yaml: start.x: found 'left right', expected a number"
    assert (error.where, error.field, error.found) == ("a.yaml", "start.x", "'left\nright'")
    assert str(InputError("a.yaml", "", "a folder", "a file")) == "a.yaml: found a folder, expected a file"


def test_an_error_of_writing_gets_the_name_of_the_file(tmp_path):
    with pytest.raises(OSError, match="out") as error, naming(tmp_path / "out"):
        raise OSError(errno.ENOSPC, "No space left on device")
    assert (error.value.errno, error.value.filename) == (errno.ENOSPC, str(tmp_path / "out"))
    with pytest.raises(OSError, match="its own") as error, naming(tmp_path / "out"):
        raise OSError(errno.ENOSPC, "No space left on device", "its own")
    assert error.value.filename == "its own"


def test_the_first_line_of_an_error_without_text_is_its_name():
    assert first_line(ValueError("one\ntwo")) == "one"
    assert first_line(MemoryError()) == "MemoryError"


def test_only_a_name_that_is_alike_is_suggested():
    assert nearest("obstcles", ["clusters", "obstacles"]) == " (did you mean 'obstacles'?)"
    assert nearest("zzz", ["clusters", "obstacles"]) == ""
    assert nearest("clutters", ["clusters"], likeness=0.95) == ""


def test_every_extra_that_a_message_names_exists():
    root = Path(__file__).parents[1]
    extras = tomllib.loads((root / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    sources = [path.read_text() for path in (root / "src").rglob("*.py")]
    named = {name for text in sources for name in re.findall(r"install_extra\([\"'](\w+)[\"']\)", text)}
    assert len(named) > 6
    assert named <= set(extras)
    assert not [text for text in sources if "pip install 'coral-robotics" in text]


@pytest.mark.parametrize(
    ("text", "masked"),
    [
        ("rtsp://admin:s3cret@192.168.2.2:8554/v", "rtsp://***@192.168.2.2:8554/v"),
        ("'rtsp://admin:p@ss:w@10.0.0.1/a@b' gives nothing", "'rtsp://***@10.0.0.1/a@b' gives nothing"),
        (
            "rtspsrc location=rtsp://10.0.0.1/v user-id=admin user-pw=s3cret ! decode",
            "rtspsrc location=rtsp://10.0.0.1/v user-id=admin user-pw=*** ! decode",
        ),
        ("http://10.0.0.1/v and joe@sea.org", "http://10.0.0.1/v and joe@sea.org"),
        ('{"a": "ws://h", "b": "x@y"}', '{"a": "ws://h", "b": "x@y"}'),
    ],
)
def test_a_password_in_an_address_is_in_no_error(text, masked):
    assert without_password(text) == masked
    assert str(RunError(text)) == masked
    assert masked in str(InputError("--camera", "", text, "a camera"))
