import json
import re
import signal
import socket
import subprocess
import sys

import pytest

from coral.cli import main
from coral.errors import InputError
from coral.view.live.pace import Pace
from coral.view.live.page import LivePage
from coral.view.live.panel import MissionControls
from coral.view.live.state import LiveState


@pytest.fixture
def page():
    with LivePage(0, MissionControls(Pace())) as page:
        yield page


def test_a_port_in_use_is_named(page):
    with pytest.raises(InputError, match=rf"--live-port: found port {page.port} in use"):
        LivePage(page.port, MissionControls(Pace()), flag="--live-port")


@pytest.mark.parametrize("words", [["replay", "{run}"], ["reef", "run", "l1", "--live", "--quiet", "--out", "{new}"]])
def test_commands_say_which_port_is_in_use(words, finished, tmp_path, capsys):
    flag = "--live-port" if words[0] == "reef" else "--port"
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        named = [w.format(run=finished, new=tmp_path / "new") for w in words]
        assert main([*named, flag, str(port)]) == 2
    out, err = capsys.readouterr()
    assert (out, err) == ("", f"coral: {flag}: found port {port} in use, expected a free port, or 0 for any\n")
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["replay", "{nothing}"], "found nothing, expected the folder of a run"),
        (["replay", "{run}", "--port", "70000"], "--port: found 70000"),
        (["replay", "{run}", "--speed", "0"], "speed"),
        (["reef", "run", "l1", "--live", "--live-speed", "-1"], "--live-speed: found -1.0"),
    ],
)
def test_bad_flags_are_one_line(words, message, finished, tmp_path, capsys):
    assert main([word.format(run=finished, nothing=tmp_path / "nothing") for word in words]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


def test_the_page_opens_on_this_machine_only_and_prints_nothing(capfd):
    with LivePage(0, MissionControls(Pace())) as page:
        assert page.url.startswith(f"http://127.0.0.1:{page.port}/?token=")
        assert page._server.get_host() == "127.0.0.1"
    assert capfd.readouterr() == ("", "")


def test_no_browser_can_ask_for_a_public_address(page):
    assert page._server.request_share_url() is None
    assert page._server._share_tunnel is None


def test_nothing_is_due_while_nobody_watches(page):
    assert not page.due()


def test_a_slow_page_drops_states_and_holds_nobody_up(page):
    with page._lock:  # the page cannot draw
        for k in range(100):
            page.show(LiveState(title=f"state {k}"))
        assert not page.due()
    page.close()
    assert "state 99" in page._panel._head.content


def test_a_fault_of_the_view_does_not_reach_the_mission(page, capfd):
    page.show(LiveState(title=3))  # no text
    page._worker.join(10.0)
    page.show(LiveState(title="more"))
    assert not page.due()
    assert capfd.readouterr().err.startswith("coral: the live page failed: ")


def test_replay_serves_until_it_is_told_to_stop(finished):
    command = [sys.executable, "-m", "coral.cli", "replay", str(finished), "--port", "0", "--json"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert re.search(r"http://127\.0\.0\.1:\d+/\?token=\S{24,}; ", process.stderr.readline())
        process.send_signal(signal.SIGTERM)
        out, _ = process.communicate(timeout=30)
    finally:
        process.kill()
    assert process.returncode == 0
    assert json.loads(out)["duration_s"] == 40.0
