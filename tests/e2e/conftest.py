"""The installed command, run as a user runs it, and a reef small enough for a test."""

import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

CORAL = Path(sys.executable).with_name("coral")
CLIENT = """#!{python} -IS
import json, os, socket, sys
with socket.socket(socket.AF_UNIX) as line:
    line.connect({path!r})
    socket.send_fds(line, [b"."], [0, 1, 2])
    line.sendall(json.dumps([sys.argv[1:], os.getcwd(), dict(os.environ)]).encode() + b"\\n")
    code = line.makefile("rb").read()
sys.exit(int(code or 1))
"""
"""Stands in for the installed command: fork_server.py answers with the exit code, or with none if it was killed."""
KEYS = ("OPENAI_API_KEY", "ANTHROPIC_API_KEY", "GOOGLE_API_KEY", "GEMINI_API_KEY")


def pond():
    """A valid world as plain data: two clusters, two posts, 9 x 7 m."""
    oyster = {"z": 0.05, "radii": [0.12, 0.09, 0.06]}
    beds = {"near": (5.0, 3.0), "far": (7.5, 5.0)}
    return {
        "format": "coral-reef/1",
        "name": "pond",
        "size_m": [9.0, 7.0],
        "start": {"x": 1.0, "y": 3.0, "theta": 0.0},
        "clusters": [
            {
                "name": name,
                "oysters": [
                    {"x": round(x + 0.2 * (k % 6 - 2.5), 3), "y": round(y + 0.2 * (k // 6 - 2.5), 3), **oyster}
                    for k in range(36)
                ],
            }
            for name, (x, y) in beds.items()
        ],
        "obstacles": [
            {"shape": "cylinder", "x": x, "y": y, "z": 0.7, "size": [0.15, 0.15, 0.7]}
            for x, y in ((3.0, 2.2), (5.8, 4.2))
        ],
    }


@pytest.fixture(scope="session")
def world():
    """The world of the tests, a fresh copy at each call."""
    return pond


@pytest.fixture
def place(tmp_path):
    """An empty folder with pond.yaml in it."""
    (tmp_path / "pond.yaml").write_text(yaml.safe_dump(pond(), sort_keys=False))
    return tmp_path


@pytest.fixture(scope="session")
def environment():
    """The caller's environment, less model keys, and with a terminal too narrow for one-line messages to be luck."""
    return {**{key: value for key, value in os.environ.items() if key not in KEYS}, "COLUMNS": "60"}


@pytest.fixture(scope="module")
def fast_coral(environment, tmp_path_factory):
    """The folder of a `coral` that runs in forks of one process, for tests of many commands."""
    folder = tmp_path_factory.mktemp("fast")
    (folder / "coral").write_text(CLIENT.format(python=sys.executable, path=str(folder / "socket")))
    (folder / "coral").chmod(0o755)
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(folder / "socket"))
        listening.listen()
        number = listening.fileno()
        words = [sys.executable, Path(__file__).with_name("fork_server.py"), str(number)]
        server = subprocess.Popen(words, env=environment, pass_fds=[number])
    yield folder  # here the socket is closed: if the server dies, its clients are refused and do not wait
    server.kill()
    server.wait()


@pytest.fixture(scope="session")
def coral(environment):
    """Run the command to its end in a folder."""

    def run(folder, *words):
        return subprocess.run(
            [CORAL, *map(str, words)],
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )

    return run
