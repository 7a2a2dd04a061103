import contextlib
import os
import stat

import pytest

from coral.errors import InputError
from coral.file_writer import open_log, scratch_for, write_whole, writing


def test_a_file_is_written_whole_with_its_folder(tmp_path):
    write_whole(tmp_path / "new" / "a.txt", "Großes Riff")
    write_whole(tmp_path / "new" / "a.txt", b"again", durable=True)
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["a.txt"]
    assert (tmp_path / "new" / "a.txt").read_bytes() == b"again"
    assert stat.S_IMODE((tmp_path / "new" / "a.txt").stat().st_mode) == 0o666 & ~_umask()


def test_a_file_that_was_not_written_whole_is_not_there(tmp_path):
    (tmp_path / "taken").mkdir()
    with pytest.raises(OSError, match="taken"):
        write_whole(tmp_path / "taken", b"content")
    with contextlib.suppress(ValueError), scratch_for(tmp_path / "film.mp4") as scratch:
        scratch.write_bytes(b"half")
        raise ValueError
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


@pytest.mark.parametrize("name", ["a.txt", "a.txt.part", ".a.txt.part"])
def test_a_planted_link_leads_nowhere(tmp_path, name):
    precious = tmp_path / "precious"
    precious.write_text("mine")
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / name).symlink_to(precious)
    write_whole(folder / "a.txt", "theirs")
    with scratch_for(folder / "a.txt") as scratch:
        scratch.write_text("theirs, too")
    assert precious.read_text() == "mine"
    assert (folder / "a.txt").read_text() == "theirs, too"


def test_a_log_is_a_new_file_and_no_link(tmp_path):
    (tmp_path / "precious").write_text("mine\n")
    (tmp_path / "events.jsonl").symlink_to(tmp_path / "precious")
    (tmp_path / "dangling.jsonl").symlink_to(tmp_path / "nothing")
    for name in ("events.jsonl", "dangling.jsonl"):
        for new in (True, False):
            with pytest.raises(OSError, match=name):
                open_log(tmp_path / name, new=new)
    with open_log(tmp_path / "log") as log:
        log.write("one\n")
        assert (tmp_path / "log").read_text() == "one\n"
    with open_log(tmp_path / "log", new=False) as log:
        log.write("two\n")
    assert (tmp_path / "log").read_text() == "one\ntwo\n"
    assert (tmp_path / "precious").read_text() == "mine\n"


def test_an_existing_file_is_kept_if_asked(tmp_path):
    write_whole(tmp_path / "answer.json", "1", replace=False)
    with pytest.raises(FileExistsError):
        write_whole(tmp_path / "answer.json", "2", replace=False)
    assert (tmp_path / "answer.json").read_text() == "1"
    assert len(list(tmp_path.iterdir())) == 1


def test_without_hard_links_only_one_of_two_writers_wins(tmp_path, monkeypatch):
    def no_links(*_):
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "link", no_links)
    write_whole(tmp_path / "answer.json", "1", replace=False)
    with pytest.raises(FileExistsError):
        write_whole(tmp_path / "answer.json", "2", replace=False)
    assert (tmp_path / "answer.json").read_text() == "1"


def test_a_device_is_not_replaced(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match=r"a device or a pipe: .*pipe"):
        write_whole(tmp_path / "pipe", "text")
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)


def test_a_folder_appears_whole_even_onto_an_empty_one(tmp_path):
    (tmp_path / "set").mkdir()
    with scratch_for(tmp_path / "set") as scratch:
        write_whole(scratch / "meta" / "info.json", "{}")
        assert not list((tmp_path / "set").iterdir())
    assert [str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*.json")] == ["set/meta/info.json"]
    assert stat.S_IMODE((tmp_path / "set").stat().st_mode) == 0o777 & ~_umask()


def test_what_cannot_be_written_is_one_line(tmp_path):
    with (
        pytest.raises(InputError, match="/x: found Is a directory, expected a file that can be written"),
        writing(tmp_path / "x"),
    ):
        raise IsADirectoryError(21, "Is a directory")


def _umask():
    mask = os.umask(0)
    os.umask(mask)
    return mask
