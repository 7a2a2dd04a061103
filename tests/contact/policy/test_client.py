import socket

import numpy as np
import pytest

from coral.contact.episode.policy_cfg import ClientCfg
from coral.contact.policy.client import KEY_VARIABLE, PolicyClient, PolicyError


@pytest.fixture
def client():
    made = []

    def make(url, cfg):
        made.append(PolicyClient(url, cfg))
        return made[-1]

    yield make
    for one in made:
        one.close()


def failure(client, observation=None):
    with pytest.raises(PolicyError) as failed:
        client.infer(observation or {"prompt": "go"})
    return failed.value


def test_an_observation_arrives_and_its_answer_returns(serve, client, patient):
    server = serve(lambda k, seen: {"actions": seen["observation/state"][None], "k": k}, {"robot": "panda"})
    one = client(server.url, patient)
    one.connect()
    state = np.arange(7.0)
    answer = one.infer({"observation/state": state, "prompt": "pick up the box"})
    assert one.metadata == {"robot": "panda"}
    np.testing.assert_array_equal(answer["actions"], [state])
    assert server.asked[0]["prompt"] == "pick up the box"
    assert one.infer({"observation/state": state})["k"] == 2
    assert server.connections == 1


def test_a_large_observation_is_sent_whole(serve, client, patient):
    server = serve(lambda k, seen: {"sum": int(seen["picture"].sum())})
    picture = np.full((1024, 1024, 3), 7, np.uint8)
    assert client(server.url, patient).infer({"picture": picture})["sum"] == 7 * picture.size


def test_a_connection_that_breaks_is_made_anew_and_the_question_put_again(serve, client, patient):
    server = serve(lambda k, seen: {"k": k} if k != 2 else ConnectionError)
    one = client(server.url, patient)
    assert [one.infer({"n": n})["k"] for n in (1, 2)] == [1, 3]
    assert [seen["n"] for seen in server.asked] == [1, 2, 2]
    assert server.connections == 2


def test_a_server_that_always_hangs_up_is_given_up(serve, client, patient):
    server = serve(lambda k, seen: ConnectionError)
    assert failure(client(server.url, patient)).code == "closed"
    assert len(server.asked) == patient.attempts


def test_silence_ends_at_the_deadline_and_no_late_answer_is_taken(serve, client, hasty):
    server = serve(lambda k, seen: None if k == 1 else {"k": k})
    one = client(server.url, hasty)
    assert one.infer({})["k"] == 2
    assert server.connections == 2
    silent = serve(lambda k, seen: None)
    assert failure(client(silent.url, hasty)).code == "silence"


def test_a_server_that_does_not_greet_is_silent(serve, client, hasty):
    with pytest.raises(PolicyError) as failed:
        client(serve(greeting=None).url, hasty).connect()
    assert failed.value.code == "silence"


def test_nobody_there_is_unreachable(client, hasty):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        error = failure(client(f"ws://127.0.0.1:{free.getsockname()[1]}", hasty))
    assert error.code == "unreachable"


def test_something_else_there_is_unreachable(client, hasty):
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        assert failure(client(f"ws://127.0.0.1:{other.getsockname()[1]}", hasty)).code == "unreachable"


@pytest.mark.parametrize(
    ("message", "code", "said"),
    [
        (
            "Traceback (most recent call last):\n  File x\nValueError: bad \x1b[31mstate\n\n",
            "error",
            "ValueError: bad [31mstate",
        ),
        (b"\xc1", "bad-message", "no MessagePack"),
        (b"\x01", "bad-message", "a int where a map"),
        (
            b"\x81\xa1a\x84\xc4\x0b__ndarray__\xc3\xc4\x04data\xc4\x08"
            + bytes(8)
            + b"\xc4\x05dtype\xa2|O\xc4\x05shape\x91\x01",
            "bad-message",
            "dtype '|O'",
        ),
        (b"\xc6\x00\x10\x00\x00" + bytes(2**20), "too-large", "more than 65536 bytes"),
    ],
)
def test_an_answer_that_cannot_be_used_is_named_and_not_asked_for_again(serve, client, message, code, said):
    server = serve(lambda k, seen: message)
    error = failure(client(server.url, ClientCfg(connect_s=5, answer_s=5, attempts=3, wait_s=0, most_bytes=65536)))
    assert error.code == code
    assert said in str(error)
    assert len(server.asked) == 1


def test_a_key_goes_from_the_environment_into_the_header(client, patient, monkeypatch):
    from websockets.sync.server import serve as websocket_server

    from coral.contact.policy.wire import encode

    monkeypatch.setenv(KEY_VARIABLE, "secret")
    seen = []

    def handle(line):
        seen.append(line.request.headers["Authorization"])
        line.send(encode({}))

    with websocket_server(handle, "127.0.0.1", 0) as server:
        import threading

        threading.Thread(target=server.serve_forever, daemon=True).start()
        client(f"ws://127.0.0.1:{server.socket.getsockname()[1]}", patient).connect()
        server.shutdown()
    assert seen == ["Api-Key secret"]
