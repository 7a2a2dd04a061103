"""A model's server that lies: about what it used, about its length, about where it is."""

import asyncio
import contextlib
import json
import socketserver
import threading
import time
import warnings
from dataclasses import replace

import pytest
from pydantic import BaseModel

from coral.advisor.model_cfg import ModelCfg, SpendCfg
from coral.advisor.models import ModelAdvisor
from coral.advisor.question import AdvisorUnavailable, BadAnswer, Question


class Choice(BaseModel):
    index: int


QUESTION = Question(kind="pick", prompt="Which dot?", answer_type=Choice, facts={})
GOOD = '{"index": 2}'
CFG = ModelCfg(attempt_timeout_s=5.0, deadline_s=10.0, backoff_s=0.0, max_reply_bytes=100_000)


def ask(url, cfg=CFG, times=1):
    async def put():
        async with contextlib.aclosing(ModelAdvisor.local(url, "stub", cfg)) as advisor:
            return [await advisor.answer(QUESTION, ()) for _ in range(times)][-1]

    return asyncio.run(put())


def with_usage(stub, usage):
    status, headers, data = stub.completion(GOOD)
    return status, headers, json.dumps(json.loads(data) | {"usage": usage}).encode()


@pytest.mark.parametrize(
    ("prompt", "completion", "counted"),
    [(-(10**9), -5, 0), (10**40, 10, 10**9 + 10), (True, True, 2)],
)
def test_a_use_that_cannot_be_is_bounded(stub, prompt, completion, counted):
    server = stub(with_usage(stub, {"prompt_tokens": prompt, "completion_tokens": completion, "total_tokens": 7}))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        usage = ask(server.url).usage
    assert usage.input_tokens + usage.output_tokens == counted


@pytest.mark.parametrize("usage", [{"prompt_tokens": "many"}, {"prompt_tokens": 1e300}, [1], {"prompt_tokens": None}])
def test_a_use_that_is_no_number_is_a_bad_reply(stub, usage):
    with pytest.raises(BadAnswer) as bad:
        ask(stub(with_usage(stub, usage)).url)
    assert bad.value.rejection.code == "bad-reply"


def test_a_server_that_says_it_used_nothing_still_uses_up_the_calls(stub):
    server = stub(with_usage(stub, {"prompt_tokens": -100, "completion_tokens": 0, "total_tokens": -100}))
    with pytest.raises(AdvisorUnavailable, match="budget is used up: 3 of 3 calls"):
        ask(server.url, replace(CFG, spend=SpendCfg(max_calls=3, max_tokens=1000)), times=4)


def test_a_question_is_not_sent_on_to_where_the_server_points(stub):
    elsewhere = stub(stub.completion(GOOD))
    server = stub((307, {"Location": f"{elsewhere.url}/chat/completions"}, b""))
    with pytest.raises((AdvisorUnavailable, BadAnswer)):
        ask(server.url, replace(CFG, max_retries=0))
    assert len(server.requests) == 1
    assert elsewhere.requests == []


class Dripping(socketserver.BaseRequestHandler):
    """One byte of a long reply every 20 ms: no single wait is long, all of them together are."""

    def handle(self):
        self.request.recv(65536)
        self.request.sendall(b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: 90000\r\n\r\n{")
        with contextlib.suppress(OSError):
            while not self.server.over.wait(0.02):
                self.request.sendall(b" ")
        self.server.hung_up.set()


def test_a_reply_that_drips_ends_at_the_deadline(stub):
    with socketserver.ThreadingTCPServer(("127.0.0.1", 0), Dripping) as server:
        server.daemon_threads, server.over, server.hung_up = True, threading.Event(), threading.Event()
        threading.Thread(target=server.serve_forever, daemon=True).start()
        begun = time.monotonic()
        try:
            with pytest.raises(AdvisorUnavailable) as gone:
                ask(f"http://127.0.0.1:{server.server_address[1]}/v1", replace(CFG, attempt_timeout_s=0.3))
            assert gone.value.code == "timeout"
            assert time.monotonic() - begun < 5.0
            assert server.hung_up.wait(5)
        finally:
            server.over.set()
            server.shutdown()
