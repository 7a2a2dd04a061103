import asyncio
import contextlib
import json
from dataclasses import replace

import numpy as np
import pytest
from pydantic import BaseModel, Field

from coral.advisor.clock import SimulatedClock, WallClock
from coral.advisor.consult import BudgetCfg, consult
from coral.advisor.log import attempt_to_json
from coral.advisor.model_cfg import ModelCfg, SpendCfg
from coral.advisor.models import Ledger, ModelAdvisor
from coral.advisor.question import AdvisorUnavailable, BadAnswer, Picture, Question, Rejection

PNG = bytes.fromhex(
    "89504e470d0a1a0a0000000d49484452000000010000000108000000003a7e9b55"
    "0000000a49444154789c6360000000020001e221bc330000000049454e44ae426082"
)


class Choice(BaseModel):
    index: int = Field(ge=0, le=5)
    reason: str = ""


QUESTION = Question(
    kind="pick",
    prompt="Which dot?",
    answer_type=Choice,
    facts={"n": 6},
    pictures=(Picture(name="map", png=PNG, caption="from above"),),
)
GOOD = '{"index": 2, "reason": "ok"}'
FAST = ModelCfg(attempt_timeout_s=5.0, deadline_s=10.0, backoff_s=0.0, max_reply_bytes=100_000)


def ask(server, cfg=FAST, rejections=(), question=QUESTION):
    advisor = ModelAdvisor.local(server.url, "stub", cfg)
    return asyncio.run(_answered(advisor, question, rejections))


async def _answered(advisor, question, rejections):
    async with contextlib.aclosing(advisor):
        return await advisor.answer(question, rejections)


def decide(advisor, log, **budget):
    clock = WallClock()
    task = clock.start(consult(advisor, lambda _: QUESTION, lambda q, a: None, BudgetCfg(**budget), clock, log.append))
    while not task.done():
        clock.advance()
    clock.thread.submit(advisor.aclose).result(10.0)
    clock.close()
    return task.result()


def texts(request):
    return [part["text"] for part in request["body"]["messages"][-1]["content"] if part["type"] == "text"]


def test_good_answer_at_once(stub):
    server = stub(stub.completion(GOOD))
    reply = ask(server)
    assert reply.value == Choice(index=2, reason="ok")
    assert reply.raw == GOOD
    assert (reply.usage.requests, reply.usage.input_tokens, reply.usage.output_tokens) == (1, 100, 10)
    assert reply.usage.faults == ()
    content = server.requests[0]["body"]["messages"][-1]["content"]
    assert [part["type"] for part in content] == ["text", "text", "image_url"]
    assert content[2]["image_url"]["url"].startswith("data:image/png;base64,")
    assert len(server.requests[0]["body"]["messages"]) == 1


def test_rejections_are_told_in_our_words_and_nothing_old_is_sent(stub):
    server = stub(stub.completion(GOOD))
    ask(server, rejections=(Rejection(code="backward", reason="Dot 1 lies behind the robot."),))
    assert "1. Dot 1 lies behind the robot." in texts(server.requests[0])[-1]
    assert len(server.requests[0]["body"]["messages"]) == 1


@pytest.mark.parametrize(("facts", "pictures", "parts"), [(True, True, 4), (False, False, 1), (True, False, 1)])
def test_facts_and_pictures_are_options(stub, facts, pictures, parts):
    server = stub(stub.completion(GOOD))
    ask(server, replace(FAST, facts=facts, pictures=pictures))
    content = server.requests[0]["body"]["messages"][-1]["content"]
    assert (1 if isinstance(content, str) else len(content)) == parts
    assert ('{"n": 6}' in json.dumps(content).replace('\\"', '"')) is facts


@pytest.mark.parametrize(
    ("mode", "key"),
    [("native", "response_format"), ("prompted", "response_format"), ("tool", "tools"), ("plain", None)],
)
def test_output_modes_on_the_wire(stub, mode, key):
    server = stub(stub.completion(None, tool=GOOD) if mode == "tool" else stub.completion(GOOD))
    assert ask(server, replace(FAST, output=mode)).value.index == 2
    body = server.requests[0]["body"]
    assert {k for k in ("response_format", "tools") if k in body} == ({key} if key else set())
    if mode == "native":
        assert body["response_format"]["json_schema"]["schema"]["properties"]["index"]["maximum"] == 5
    if mode == "tool":
        assert body["tools"][0]["function"]["name"] == "answer"
    assert len(body["messages"]) == 1


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("", "empty"),
        ("well, dot two", "not-json"),
        ('{"index": "two"}', "wrong-type"),
    ],
)
def test_format_is_repaired_once(stub, text, code):
    server = stub(stub.completion(text), stub.completion(GOOD))
    reply = ask(server)
    assert reply.value.index == 2
    assert reply.usage.faults == (code,)
    assert "could not be used" in texts(server.requests[1])[-1]
    server = stub(stub.completion(text))
    with pytest.raises(BadAnswer) as bad:
        ask(server)
    assert bad.value.rejection.code == code
    assert bad.value.raw == text
    assert len(server.requests) == 2
    assert bad.value.usage.requests == 2


def test_refusal_is_not_repaired(stub):
    for reply in (stub.completion(None, refusal="I will not."), stub.completion("I'm sorry, I can't help with that.")):
        server = stub(reply)
        with pytest.raises(BadAnswer) as bad:
            ask(server)
        assert bad.value.rejection.code == "refusal"
        assert bad.value.raw
        assert len(server.requests) == 1


DRAFT = 'Dot {"index": 1, "reason": "near"} would do, but there is a wall, so this must NOT be chosen. The better one'


@pytest.mark.parametrize(
    ("text", "finish"),
    [
        ('{"index": 2, "reason": "because', "length"),
        (f"<think>\n{DRAFT}", "length"),
        (DRAFT, "length"),
        (GOOD, "length"),
        ("", "length"),
        (f"<think>\n{DRAFT}", "stop"),
        ('{"index": 2, "reason": "because', "stop"),
    ],
)
def test_a_reply_that_broke_off_is_asked_for_again(stub, text, finish):
    server = stub(stub.completion(text, finish), stub.completion(f"<think>{DRAFT}</think>{GOOD}"))
    reply = ask(server)
    assert reply.value == Choice(index=2, reason="ok")
    assert reply.usage.faults == ("cut-off",)
    assert "broke off" in texts(server.requests[1])[-1] or "inside its thoughts" in texts(server.requests[1])[-1]
    with pytest.raises(BadAnswer) as bad:
        ask(stub(stub.completion(text, finish)))
    assert (bad.value.rejection.code, bad.value.raw) == ("cut-off", text)


@pytest.mark.parametrize(
    ("failure", "code"), [(429, "http-429"), (500, "http-500"), (503, "http-503"), ("drop", "connection")]
)
def test_passing_failures_are_retried(stub, failure, code):
    fault = stub.DROP if failure == "drop" else stub.error(failure)
    server = stub(fault, fault, stub.completion(GOOD))
    reply = ask(server)
    assert reply.usage.faults == (code, code)
    assert reply.usage.requests == 3
    server = stub(fault)
    with pytest.raises(AdvisorUnavailable) as gone:
        ask(server)
    assert (gone.value.code, gone.value.final) == (code, False)
    assert len(server.requests) == 1 + FAST.max_retries
    assert gone.value.usage.requests == 1 + FAST.max_retries


def test_retry_after_is_honoured(stub, monkeypatch):
    slept = []
    real = asyncio.sleep

    async def sleep(seconds):
        slept.append(seconds)
        await real(0)

    monkeypatch.setattr("coral.advisor.models.asyncio.sleep", sleep)
    ask(
        stub(stub.error(429, retry_after="3"), stub.error(500), stub.error(500), stub.completion(GOOD)),
        replace(FAST, backoff_s=0.5),
    )
    assert [s for s in slept if s] == [3, 1.0, 2.0]


def test_retry_after_beyond_the_deadline_is_not_waited_for(stub):
    server = stub(stub.error(429, retry_after="300"))
    with pytest.raises(AdvisorUnavailable, match="after the deadline") as gone:
        ask(server)
    assert gone.value.code == "http-429"
    assert len(server.requests) == 1


@pytest.mark.parametrize(
    ("status", "code"),
    [(401, "key-refused"), (403, "key-refused"), (404, "no-such-model"), (400, "http-400"), (422, "http-422")],
)
def test_lasting_failures_are_final(stub, status, code):
    server = stub(stub.error(status, "bad key sk-abcdef123456"))
    with pytest.raises(AdvisorUnavailable) as gone:
        ask(server)
    assert (gone.value.code, gone.value.final) == (code, True)
    assert len(server.requests) == 1
    assert "sk-abcdef" not in gone.value.reason


def test_silence_ends_at_the_deadline_and_the_request_is_cancelled(stub):
    server = stub(stub.SILENCE)
    with pytest.raises(AdvisorUnavailable) as gone:
        ask(server, replace(FAST, attempt_timeout_s=0.2))
    assert (gone.value.code, gone.value.final) == ("timeout", False)
    assert server.hung_up.wait(5)
    server = stub(stub.SILENCE)
    with pytest.raises(AdvisorUnavailable, match=r"within 0\.2 s"):
        ask(server, replace(FAST, deadline_s=0.2))
    assert server.hung_up.wait(5)


def test_reply_that_is_not_of_the_api(stub):
    for data in (b"<html>proxy says hello</html>", b'{"ok": true}', b'{"choices": []}', b"[1, 2"):
        with pytest.raises(BadAnswer) as bad:
            ask(stub((200, {}, data)))
        assert bad.value.rejection.code == "bad-reply"


def test_a_dead_server_is_noticed_within_three_seconds(stub, monkeypatch):
    slept = []

    async def sleep(seconds):
        slept.append(seconds)

    monkeypatch.setattr("coral.advisor.models.asyncio.sleep", sleep)
    server = stub(stub.DROP)
    server.close()
    with pytest.raises(AdvisorUnavailable, match="nothing answers at that address"):
        ask(server, replace(FAST, backoff_s=2.0))
    assert slept == [2.0]


@pytest.mark.parametrize(("path", "hint"), [("", "/v1#stub"), ("/v1/chat/completions", "/v1#stub"), ("/v1", "")])
def test_an_address_without_v1_is_told(stub, path, hint):
    server = stub(stub.error(404, "Not Found"))
    server.url = server.url.removesuffix("/v1")
    wanted = f" (most servers want local:{server.url}{hint})" if hint else ""
    server.url += path
    with pytest.raises(AdvisorUnavailable) as gone:
        ask(server)
    assert gone.value.reason.startswith(f"local:{server.url}#stub{wanted} was not found: ")


@pytest.mark.parametrize(("spend", "unit"), [(SpendCfg(max_calls=2), "calls"), (SpendCfg(max_tokens=150), "tokens")])
def test_budget_ends_asking_with_a_clear_message(stub, spend, unit):
    server = stub(stub.completion(GOOD))
    advisor = ModelAdvisor.local(server.url, "stub", replace(FAST, spend=spend))

    async def three():
        async with contextlib.aclosing(advisor):
            for _ in range(3):
                await advisor.answer(QUESTION, ())

    with pytest.raises(AdvisorUnavailable, match=f"budget is used up: .* {unit}") as gone:
        asyncio.run(three())
    assert (gone.value.code, gone.value.final) == ("budget", True)
    assert len(server.requests) == 2


def test_keys_come_from_the_environment_and_stay_out_of_everything(stub, monkeypatch):
    secret = "very-secret-0123456789"
    monkeypatch.setenv("CORAL_LOCAL_API_KEY", secret)
    server = stub(stub.completion(f"you sent {secret}"))
    log = []
    advisor = ModelAdvisor.local(server.url, "stub", FAST)
    decide(advisor, log, max_requeries=0)
    assert server.requests[0]["headers"]["authorization"] == f"Bearer {secret}"
    assert "you sent ***" in log[0].raw
    assert secret not in json.dumps([attempt_to_json(a) for a in log]) + advisor.name
    named = ModelAdvisor.local("http://user:pass@127.0.0.1:80/v1?key=abc", "stub", FAST).name
    assert named == "local:http://127.0.0.1:80/v1#stub"


def test_simulated_latency_hides_how_long_the_wire_took(stub):
    server = stub(stub.completion('{"index": 9}'), stub.completion(GOOD))
    clock = SimulatedClock("fixed:3", np.random.default_rng(0))
    advisor = ModelAdvisor.local(server.url, "stub", replace(FAST, format_repairs=0))
    clock.thread.warm_up(advisor)
    log = []
    task = clock.start(consult(advisor, lambda _: QUESTION, lambda q, a: None, BudgetCfg(), clock, log.append))
    tick = 0
    while not task.done():
        tick += 1
        clock.advance(tick * 0.1)
    assert tick == 60
    assert [a.verdict for a in log] == ["malformed", "accepted"]
    clock.close()


def test_calls_are_counted_when_they_leave_and_end_at_their_bound():
    ledger = Ledger(SpendCfg(max_calls=2))
    ledger.open_call()
    ledger.open_call()
    with pytest.raises(AdvisorUnavailable, match=r"used up: 2 of 2 calls \(spend\.max_calls\)") as gone:
        ledger.open_call()
    assert (gone.value.code, gone.value.final, ledger.calls) == ("budget", True, 2)


@pytest.mark.parametrize(
    ("spend", "cost", "said"),
    [
        (SpendCfg(max_tokens=100), (60, 0.0), r"120 of 100 tokens \(spend\.max_tokens\)"),
        (SpendCfg(max_usd=0.5), (0, 0.25), r"0\.5 of 0\.5 USD \(spend\.max_usd\)"),
    ],
)
def test_tokens_and_money_end_asking_once_their_sum_reaches_the_bound(spend, cost, said):
    ledger = Ledger(spend)
    ledger.open_call()
    ledger.add(*cost)
    ledger.open_call()
    ledger.add(*cost)
    with pytest.raises(AdvisorUnavailable, match=said):
        ledger.open_call()
