"""The container image cannot be built in a test; what its files say of each other and of the program is checked."""

import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
LINES = [
    line
    for line in (ROOT / "Dockerfile").read_text().replace("\\\n", "").splitlines()
    if line and not line.startswith("#")
]
ARGUMENTS = dict(re.findall(r'^ARG (\w+)="(.*)"$', "\n".join(LINES), re.M))
SERVICE = json.loads((ROOT / "blueos" / "register_service").read_text())
PAGE = (ROOT / "blueos" / "index.html").read_text()


def labels():
    """Return the labels with the default arguments in them; as in Docker, none is replaced in single quotes."""
    found = {}
    for name, quote, text in re.findall(r"^LABEL ([\w.]+)=(['\"])(.*)\2$", "\n".join(LINES), re.M):
        if quote == '"':
            text = re.sub(r"\$(\w+)", lambda match: ARGUMENTS[match[1]], text.replace('\\"', '"'))
        found[name] = text
    return found


def words(instruction):
    return [line.split(maxsplit=1)[1] for line in LINES if line.startswith(instruction + " ")]


def test_every_file_that_goes_into_the_image_is_there_and_not_ignored():
    kept = {line[1:] for line in (ROOT / ".dockerignore").read_text().splitlines() if line.startswith("!")}
    named = [name for copy in words("COPY") if not copy.startswith("--from") for name in copy.split()[:-1]]
    assert "src" in named
    assert "blueos" in named
    for name in named:
        assert (ROOT / name).exists(), name
        assert name in kept, name


def test_only_extras_and_constraints_that_the_project_has_are_installed():
    install = next(line for line in words("RUN") if "pip install" in line)
    extras = re.search(r"requirements\.py ([\w ]+) >", install)[1].split()
    assert set(extras) <= set(PROJECT["optional-dependencies"])
    assert "--constraint constraints.txt" in install


def test_the_labels_hold_what_the_store_of_extensions_reads():
    found = labels()
    assert found["version"] == PROJECT["version"] == SERVICE["version"]
    assert found["type"] in ("device-integration", "example", "theme", "tool", "other")
    assert found["readme"].startswith("https://")
    assert found["requirements"].startswith("core")
    assert all({"name", "email"} <= set(author) for author in json.loads(found["authors"]))
    assert set(json.loads(found["company"])) == {"about", "name", "email"}
    assert set(json.loads(found["links"])) == {"website", "support"}
    tags = json.loads(found["tags"])
    assert 0 < len(tags) <= 10
    assert all(re.fullmatch(r"[a-z0-9-]+", tag) for tag in tags)


def test_one_port_for_the_page_that_starts():
    command = json.loads(words("CMD")[0])
    assert command[:3] == ["python", "-m", "http.server"]
    port = command[3]
    assert words("EXPOSE") == [f"{port}/tcp"]
    permissions = json.loads(labels()["permissions"])
    assert list(permissions["ExposedPorts"]) == [f"{port}/tcp"]
    served = command[command.index("--directory") + 1]
    assert f"blueos {served}" in words("COPY")


def test_surveys_outlive_the_container():
    bind = json.loads(labels()["permissions"])["HostConfig"]["Binds"][0]
    assert bind.partition(":")[2] == words("WORKDIR")[-1]
    assert bind.partition(":")[0] in PAGE


def test_the_page_shows_commands_that_the_program_has():
    shown = re.findall(r"coral (reef sail .*)", re.sub(r"</pre>", "\n", PAGE))
    assert len(shown) >= 3
    start = [sys.executable, "-m", "coral.cli", "reef", "sail", "--help"]
    told = subprocess.run(start, capture_output=True, text=True, timeout=120, check=False)
    assert told.returncode == 0
    for command in shown:
        for flag in re.findall(r"--[\w-]+", command):
            assert flag in told.stdout, flag
