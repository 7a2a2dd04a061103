import socket
import threading

import numpy as np
import pytest
from stub_foundationpose import serving

from coral.contact.perception.foundationpose_client import URL, OutOfReach, exchange
from coral.contact.perception.foundationpose_server import encode
from coral.contact.perception.tracker import TrackerFailed

THING = {"vertices": np.zeros((3, 3)), "faces": np.array([[0, 1, 2]]), "symmetry": np.eye(4)[None]}
NOBODY = "http://127.0.0.1:9"


@pytest.mark.parametrize("url", ["http://127.0.0.1:5070", "http://robot.local/", "http://[::1]:5070"])
def test_an_address_is_a_host_and_a_port(url):
    assert URL.fullmatch(url)


@pytest.mark.parametrize(
    "url",
    [
        "",
        "127.0.0.1:5070",
        "ws://127.0.0.1:5070",
        "http://",
        "http://x:none",
        "http://x:99999",
        "http://me:word@x:5070",
        "http://x/a",
        "http://x?a=1",
        "http://x y",
    ],
)
def test_another_address_is_none(url):
    assert not URL.fullmatch(url)


def test_an_answer_comes_back_as_arrays():
    with serving() as server:
        assert exchange(server.url, "", b"", 5.0) == {}
        answer = exchange(server.url, "init", encode(THING), 30.0)
    assert set(answer) == {"session"}


def test_a_refusal_is_one_line_with_the_reason():
    with serving() as server, pytest.raises(TrackerFailed, match=r"refuses to track: no such session") as refused:
        exchange(server.url, "track", encode({"session": np.array("none")}), 30.0)
    assert not isinstance(refused.value, OutOfReach)
    assert "\n" not in str(refused.value)


def test_nobody_there_is_out_of_reach():
    for verb in ("", "init"):
        with pytest.raises(OutOfReach, match=f"^foundationpose at {NOBODY} does not answer: "):
            exchange(NOBODY, verb, b"x", 1.0)


@pytest.mark.parametrize("sent", [b"", b"HTTP/1.1 200 OK\r\nContent-Length: 9\r\n\r\n", b"not HTTP at all\r\n\r\n"])
def test_a_server_that_falls_silent_is_not_waited_for(sent):
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def speak():
            line, _ = listener.accept()
            line.sendall(sent)
            lines.append(line)

        lines = []
        thread = threading.Thread(target=speak, daemon=True)
        thread.start()
        url = f"http://127.0.0.1:{listener.getsockname()[1]}"
        with pytest.raises(OutOfReach, match=url):
            exchange(url, "init", b"x", 0.1)
        thread.join()
        lines[0].close()


def test_a_server_that_drips_is_not_waited_for():
    """Byte by byte: no single wait is long, all of them together are."""
    stop = threading.Event()
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def drip():
            line, _ = listener.accept()
            line.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: 100000000\r\n\r\n")
            while not stop.wait(0.02):
                try:
                    line.sendall(b"x")
                except OSError:
                    return

        thread = threading.Thread(target=drip, daemon=True)
        thread.start()
        url = f"http://127.0.0.1:{listener.getsockname()[1]}"
        try:
            with pytest.raises(OutOfReach, match=r"no answer to init in 0\.2 s"):
                exchange(url, "init", b"x", 0.2)
        finally:
            stop.set()
            thread.join()
