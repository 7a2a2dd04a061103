import errno
import json
import re
import subprocess
import sys
from dataclasses import dataclass

import pytest

from coral import __version__, cli
from coral.cli import COMMANDS, main
from coral.errors import InputError, RunError


@dataclass(frozen=True)
class Toy:
    """A command that returns a result, or raises."""

    result: object
    json: bool = True

    def __call__(self):
        if isinstance(self.result, BaseException):
            raise self.result
        return self.result

    def describe(self, result):
        return f"in words: {result}"

    def exit_code(self, result):
        return 3 if result == "fails" else 0


@pytest.fixture
def toy(monkeypatch):
    """Runs a toy in place of the command; returns the exit code."""

    def run(result, as_json=True):
        monkeypatch.setattr(cli, "_parse", lambda name, words: Toy(result, as_json))
        return main(["version"])

    return run


@pytest.mark.parametrize("words", [["--version"], ["-V"], ["version"]])
def test_the_version_is_told(capsys, words):
    assert main(words) == 0
    assert capsys.readouterr().out == f"coral {__version__}\n"


def test_the_package_runs_as_a_module():
    done = subprocess.run([sys.executable, "-m", "coral", "--version"], capture_output=True, text=True, check=True)
    assert done.stdout == f"coral {__version__}\n"


def test_the_overview_lists_every_command_and_that_of_a_group_only_its_own(capsys):
    assert main([]) == 0
    listed = capsys.readouterr().out
    assert all(f"  coral {name} " in listed for name in COMMANDS)
    assert main(["memory", "--help"]) == 0
    names = [line.split()[1:3] for line in capsys.readouterr().out.splitlines() if line.startswith("  coral ")]
    assert names == [["memory", word] for word in ("list", "show", "forget")]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["reprt"], "found 'reprt', expected one of: reef run, .*did you mean 'report'"),
        (["reef", "bnch"], "found 'reef bnch', expected one of: reef run, .*, reef generate .*'reef bench'"),
        (["reef", "--json"], "found 'reef --json', expected one of: reef run"),
    ],
)
def test_a_mistyped_command_is_suggested(capsys, words, said):
    assert main(words) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert re.fullmatch(f"coral: coral: {said}.*\n", told.err)


def test_a_result_is_told_in_json_or_in_words(toy, capsys):
    assert toy({"a": 1}) == 0
    assert json.loads(capsys.readouterr().out) == {"a": 1}
    assert toy({"a": 1}, as_json=False) == 0
    assert capsys.readouterr().out == "in words: {'a': 1}\n"


def test_a_command_may_fail_by_its_result_which_is_printed_all_the_same(toy, capsys):
    assert toy("fails") == 3
    assert capsys.readouterr().out == '"fails"\n'


@pytest.mark.parametrize(
    ("error", "code", "line"),
    [
        (InputError("a.yaml", "x", "1", "2"), 2, "coral: a.yaml: x: found 1, expected 2\n"),
        (RunError("two\nlines"), 1, "coral: two lines\n"),
        (KeyboardInterrupt(), 130, "coral: interrupted\n"),
        (KeyboardInterrupt("stopped by SIGTERM"), 130, "coral: stopped by SIGTERM\n"),
    ],
)
def test_an_error_for_the_reader_is_one_line_and_an_exit_code(toy, capsys, error, code, line):
    assert toy(error) == code
    assert capsys.readouterr().err == line


@pytest.mark.parametrize("error", [OSError(errno.EACCES, "Permission denied", "a"), ZeroDivisionError()])
def test_a_fault_of_ours_keeps_its_traceback(toy, error):
    with pytest.raises(type(error)):
        toy(error)


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


@pytest.mark.parametrize("name", ["a\udcffb", "a\x1b[31mb"])
def test_messages_are_printable(capsys, name):
    assert main(["reef", "run", f"{name}.yaml"]) == 2
    told = capsys.readouterr().err
    assert told.rstrip("\n").isprintable()
    assert told.isascii() or "\ufffd" in told
