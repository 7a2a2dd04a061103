"""Spans of model calls, kept in memory or received by a collector on this machine."""

import asyncio
import gzip
import json
import sys
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest
from pydantic import BaseModel

from coral.advisor import tracing
from coral.advisor.model_cfg import ModelCfg
from coral.advisor.models import ModelAdvisor
from coral.advisor.question import AdvisorUnavailable, Picture, Question, Rejection
from coral.errors import InputError

pytest.importorskip("opentelemetry.sdk")
from opentelemetry.sdk.trace.export.in_memory_span_exporter import InMemorySpanExporter

SECRET = "a-secret-that-no-span-tells"
PNG = b"\x89PNG\r\n\x1a\n" + bytes(range(64))


class Choice(BaseModel):
    index: int


QUESTION = Question(
    kind="pick",
    prompt="Which dot is the reddest?",
    answer_type=Choice,
    facts={},
    pictures=(Picture(name="map", png=PNG, caption="from above"),),
)


@pytest.fixture
def spans(monkeypatch):
    """The spans of what runs next, by name."""
    memory = InMemorySpanExporter()
    provider = tracing.exporting(memory)
    monkeypatch.setattr(tracing, "tracer_provider", lambda: provider)

    def told():
        provider.force_flush()
        return {span.name: span for span in memory.get_finished_spans()}

    yield told
    provider.shutdown()


def ask(server, rejections=()):
    advisor = ModelAdvisor.local(server.url, "stub", ModelCfg(max_retries=0, format_repairs=0))

    async def answered():
        try:
            return await advisor.answer(QUESTION, rejections)
        finally:
            await advisor.aclose()

    return asyncio.run(answered())


def texts(span):
    return json.dumps([dict(span.attributes), [dict(event.attributes) for event in span.events]], default=str)


def test_no_span_unless_asked_for(stub, spans, monkeypatch):
    monkeypatch.delenv("CORAL_TRACE", raising=False)
    ask(stub(stub.completion('{"index": 2}')))
    assert spans() == {}


@pytest.mark.parametrize("mode", ["calls", "content"])
def test_an_answer_is_a_span_around_its_request(stub, spans, monkeypatch, mode):
    monkeypatch.setenv("CORAL_TRACE", mode)
    ask(stub(stub.completion('{"index": 2}')), [Rejection(code="behind", reason="It is behind you.")])
    answer, request = spans()["answer pick"], spans()["chat stub"]
    assert request.parent.span_id == answer.context.span_id
    assert answer.attributes["coral.question.rejections"] == 1
    assert answer.resource.attributes["service.name"] == "coral"
    assert request.attributes["gen_ai.usage.input_tokens"] == 100
    assert request.attributes["gen_ai.usage.output_tokens"] == 10
    assert (QUESTION.prompt in texts(request)) == (mode == "content")
    assert "iVBOR" not in texts(request), "the picture is in the span"


def test_no_span_tells_a_key(stub, spans, monkeypatch):
    monkeypatch.setenv("CORAL_TRACE", "content")
    monkeypatch.setenv("CORAL_LOCAL_API_KEY", SECRET)
    with pytest.raises(AdvisorUnavailable):
        ask(stub(stub.error(401, f"the key {SECRET} is unknown")))
    told = spans()
    assert "the key *** is unknown" in texts(told["chat stub"])
    assert all(SECRET not in texts(span) + str(span.status.description) for span in told.values())


def test_a_mistyped_mode_and_missing_packages_are_one_line(monkeypatch):
    monkeypatch.setenv("CORAL_TRACE", "contents")
    with pytest.raises(InputError, match=r"CORAL_TRACE: found 'contents', .* \(did you mean 'content'"):
        ModelAdvisor.local("http://127.0.0.1:9/v1", "m", ModelCfg())
    monkeypatch.setenv("CORAL_TRACE", "calls")
    monkeypatch.setitem(sys.modules, "opentelemetry.sdk.trace", None)
    with pytest.raises(InputError, match="the extra trace"):
        ModelAdvisor.local("http://127.0.0.1:9/v1", "m", ModelCfg())


@pytest.fixture
def collector():
    """A server on this machine that keeps what it is sent."""
    bodies = []

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self):
            bodies.append((self.path, self.rfile.read(int(self.headers["Content-Length"]))))
            self.send_response(200)
            self.send_header("Content-Length", "0")
            self.end_headers()

        def log_message(self, *_):
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        server.bodies, server.url = bodies, f"http://127.0.0.1:{server.server_port}"
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        yield server
        server.shutdown()
        thread.join()


def test_a_collector_receives_the_spans(stub, collector, monkeypatch):
    monkeypatch.setenv("CORAL_TRACE", "calls")
    monkeypatch.setenv("OTEL_EXPORTER_OTLP_ENDPOINT", collector.url)
    tracing.tracer_provider.cache_clear()
    try:
        ask(stub(stub.completion('{"index": 2}')))
        tracing.tracer_provider().shutdown()
    finally:
        tracing.tracer_provider.cache_clear()
    ((path, body),) = collector.bodies
    assert path == "/v1/traces"
    assert b"answer pick" in gzipped(body)
    assert b"chat stub" in gzipped(body)


def gzipped(body):
    return gzip.decompress(body) if body.startswith(b"\x1f\x8b") else body
