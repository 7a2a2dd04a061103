import errno
import os
import signal
import threading

import pytest

from coral import cli
from coral.runs import RunWriter, write_whole
from coral.termination import Terminated, orderly_termination


@pytest.fixture
def free():
    """As in a process of its own: nobody has decided upon these signals."""
    before = {number: signal.signal(number, signal.SIG_DFL) for number in (signal.SIGTERM, signal.SIGHUP)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_the_first_signal_ends_and_later_ones_do_not_disturb(free, number):
    with orderly_termination() as received:
        with pytest.raises(Terminated, match=f"stopped by {number.name}"):
            os.kill(os.getpid(), number)
        os.kill(os.getpid(), signal.SIGTERM)
        os.kill(os.getpid(), signal.SIGHUP)
    assert received.exit_code(0) == 128 + number
    assert signal.getsignal(number) is signal.SIG_DFL


def test_nohup_and_handlers_of_others_stay(free):
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    heard = []
    signal.signal(signal.SIGTERM, lambda number, frame: heard.append(number))
    with orderly_termination() as received:
        os.kill(os.getpid(), signal.SIGHUP)
        os.kill(os.getpid(), signal.SIGTERM)
    assert heard == [signal.SIGTERM]
    assert received.exit_code(1) == 1


def test_other_threads_leave_signals_alone(free):
    found = []

    def enter():
        with orderly_termination():
            found.append(signal.getsignal(signal.SIGTERM))

    thread = threading.Thread(target=enter)
    thread.start()
    thread.join()
    assert found == [signal.SIG_DFL]


class Full:
    """A disk that takes nothing more."""

    name = "somewhere/events.jsonl"

    def write(self, text):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def close(self):
        self.write("")


def test_a_full_disk_names_the_file_and_the_log_can_still_be_closed(tmp_path):
    writer = RunWriter(tmp_path / "run", ("step",))
    writer._events = Full()
    with pytest.raises(OSError, match=r"No space left on device: 'somewhere/events\.jsonl'"):
        writer.event(0, 0.0, "start")
    writer.close()


def test_a_file_that_was_not_written_whole_is_not_there(tmp_path):
    (tmp_path / "taken").mkdir()
    with pytest.raises(OSError, match="taken"):
        write_whole(tmp_path / "taken", b"content")
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (OSError(errno.ENOSPC, "No space left on device", "runs/a/events.jsonl"), "runs/a/events.jsonl: no space left"),
        (OSError(errno.EDQUOT, "Disk quota exceeded"), "coral: disk quota exceeded"),
    ],
)
def test_the_command_line_says_it_in_one_line(monkeypatch, capsys, error, said):
    def fail(name, words):
        raise error

    monkeypatch.setattr(cli, "_parse", fail)
    assert cli.main(["version"]) == 1
    told = capsys.readouterr()
    assert told.out == ""
    assert said in told.err
    assert told.err.count("\n") == 1
