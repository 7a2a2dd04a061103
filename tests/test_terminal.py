"""Lines fit a terminal, and stay whole elsewhere."""

import io
import os

import pytest

from coral.terminal import fitted

LONG = "o1: 7 of 7 oyster clusters covered (100 %), 0 collisions, 191 s simulated; ended: nothing left to explore"


class Terminal(io.StringIO):
    """A terminal of some columns."""

    def isatty(self):
        return True

    def fileno(self):
        return 1


@pytest.fixture
def columns(monkeypatch):
    return lambda count: monkeypatch.setattr(os, "get_terminal_size", lambda number: os.terminal_size((count, 24)))


@pytest.mark.parametrize("count", [40, 60, 80])
def test_lines_wrap_between_words(columns, count):
    columns(count)
    lines = fitted(LONG, Terminal()).splitlines()
    assert max(map(len, lines)) <= count
    assert " ".join(line.strip() for line in lines) == LONG
    assert all(line.startswith("  ") for line in lines[1:])


def test_a_path_is_not_torn_and_tables_stay(columns):
    columns(40)
    path = "report: /home/somebody/runs/2026-01-01-a-long-name-without-a-space/report.html"
    assert path.split(": ")[1] in fitted(path, Terminal())
    table = "| method | success | 95 % interval (%) | time (s) |"
    aligned = "pick-box         box          14%   6.3   98.1  24.6"
    for row in (table, aligned):
        assert fitted(f"  {row}\nshort", Terminal()) == f"  {row}\nshort"


def test_elsewhere_nothing_changes(columns):
    columns(40)
    assert fitted(LONG, io.StringIO()) == LONG
    columns(0)
    assert fitted(LONG, Terminal()) == LONG
