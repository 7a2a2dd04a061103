import http.client
import json

import pytest
import yaml

from coral.desk.front.server import FrontServer
from coral.errors import InputError


@pytest.fixture
def root(tmp_path):
    folder = tmp_path / "s1-001"
    folder.mkdir()
    (folder / "config.yaml").write_text(yaml.safe_dump({"system": "reef", "world": "s1", "seed": 3}))
    (folder / "metrics.json").write_text(json.dumps({"end_reason": "time limit", "coverage": 0.5, "collisions": 0}))
    (folder / "report.html").write_text("<!doctype html><title>r</title><h1>a report</h1>")
    return tmp_path


@pytest.fixture
def server(root):
    def start(wanted):
        if wanted.get("name") == "absent":
            raise InputError("name", "", "'absent'", "a reef")
        return ["version"], root / "new-001"

    with FrontServer(root, {"reef": {}}, start) as server:
        yield server


def ask(server, path, content=None):
    connection = http.client.HTTPConnection("127.0.0.1", server.access.port, timeout=30)
    headers = {"Authorization": f"Bearer {server.access.token}", "X-Coral": "1", "Content-Type": "application/json"}
    body = None if content is None else json.dumps(content)
    connection.request("GET" if body is None else "POST", path, body, headers)
    response = connection.getresponse()
    body = json.loads(response.read())
    connection.close()
    return response.status, body


def test_recorded_runs_are_listed_with_what_they_were_of(server):
    (run,) = ask(server, "/api/state")[1]["runs"]
    assert (run["name"], run["world"], run["seed"], run["ended"], run["report"]) == (
        "s1-001",
        "s1",
        "3",
        "time limit",
        True,
    )
    assert {"name": "covered", "unit": "%", "value": 50.0} in run["numbers"]


def test_a_report_gets_a_page_of_its_own(server):
    status, opened = ask(server, "/api/open", {"name": "s1-001", "what": "report"})
    assert status == 200
    assert opened["url"] == ask(server, "/api/open", {"name": "s1-001", "what": "report"})[1]["url"]
    assert f":{server.access.port}/" not in opened["url"]


@pytest.mark.parametrize("wanted", [{"name": "../x", "what": "report"}, {"name": "s1-001", "what": "config"}, {}])
def test_nothing_else_is_opened(server, wanted):
    assert ask(server, "/api/open", wanted)[0] == 404


def test_a_command_is_started_and_its_end_is_told(server):
    assert ask(server, "/api/start", {"name": "s1"}) == (200, {"number": 0})
    server.jobs[0].stop(60.0)
    (job,) = ask(server, "/api/state")[1]["jobs"]
    assert (job["running"], job["name"], job["command"]) == (False, "new-001", "coral version")
    assert ask(server, "/api/stop", {"number": 7})[0] == 404


def test_a_run_can_be_watched_once_its_page_is_open(server, monkeypatch):
    ask(server, "/api/start", {"name": "s1"})
    server.jobs[0].stop(60.0)
    monkeypatch.setattr(type(server.jobs[0]), "running", True)
    assert ask(server, "/api/state")[1]["jobs"][0]["opens"] is False
    server.jobs[0].url = "http://127.0.0.1:1/"
    assert ask(server, "/api/state")[1]["jobs"][0]["opens"] is True


def test_what_cannot_be_started_is_said(server):
    assert ask(server, "/api/start", {"name": "absent"}) == (400, {"error": "name: found 'absent', expected a reef"})


def test_no_more_runs_than_cores_can_bear(server, monkeypatch):
    monkeypatch.setattr("coral.desk.front.server.MOST", 0)
    assert ask(server, "/api/start", {"name": "s1"})[0] == 409
