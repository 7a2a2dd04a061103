"""OpenTelemetry spans of model calls, by pydantic-ai's instrumentation; off unless the environment asks for them."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from functools import cache
from typing import TYPE_CHECKING, Any

from coral.advisor.scrub import scrub
from coral.errors import InputError, install_extra, nearest

if TYPE_CHECKING:
    from opentelemetry.sdk.trace import ReadableSpan
    from opentelemetry.sdk.trace.export import SpanExporter
    from opentelemetry.trace import TracerProvider
    from pydantic_ai.models import Model

TRACE = "CORAL_TRACE"
"""Environment variable: "calls" for spans without what was said, "content" for prompts and replies, too."""
MODES = ("off", "calls", "content")


def trace_mode() -> str:
    """Return what the environment asks for, one of `MODES`.

    Raises:
        InputError: It asks for something else, or the packages are missing.
    """
    mode = os.environ.get(TRACE, "") or "off"
    if mode not in MODES:
        raise InputError(TRACE, "", repr(mode), f"one of: {', '.join(MODES)}{nearest(mode, MODES)}")
    if mode != "off":
        try:
            import opentelemetry.exporter.otlp.proto.http.trace_exporter
            import opentelemetry.sdk.trace  # noqa: F401
        except ImportError:
            raise InputError(TRACE, "", "no packages of OpenTelemetry", install_extra("trace")) from None
    return mode


def traced(model: Model) -> Model:
    """Return a model whose requests are spans, or the same one if none are asked for. Pictures are left out."""
    mode = trace_mode()
    if mode == "off":
        return model
    from pydantic_ai.models.instrumented import InstrumentationSettings, InstrumentedModel

    settings = InstrumentationSettings(
        tracer_provider=tracer_provider(), include_content=mode == "content", include_binary_content=False
    )
    return InstrumentedModel(model, settings)


def answer_span(kind: str, advisor: str, rejections: int) -> AbstractContextManager[Any]:
    """Return the span of one answer, around its requests.

    Args:
        kind: Kind of the question.
        advisor: Name of the advisor.
        rejections: Number of refused answers before this one.
    """
    if trace_mode() == "off":
        return nullcontext()
    return (
        tracer_provider()
        .get_tracer("coral")
        .start_as_current_span(
            f"answer {kind}",
            attributes={
                "coral.question.kind": kind,
                "coral.advisor": scrub(advisor),
                "coral.question.rejections": rejections,
            },
        )
    )


@cache
def tracer_provider() -> TracerProvider:
    """Return the program's own provider if it has set one; else one that exports over OTLP as `OTEL_...` say."""
    from opentelemetry.exporter.otlp.proto.http.trace_exporter import OTLPSpanExporter
    from opentelemetry.trace import ProxyTracerProvider, get_tracer_provider

    given = get_tracer_provider()
    return exporting(OTLPSpanExporter()) if isinstance(given, ProxyTracerProvider) else given


def exporting(exporter: SpanExporter) -> TracerProvider:
    """Return a provider that sends spans in batches, and the rest at the end of the process, without keys."""
    from opentelemetry.sdk.resources import Resource
    from opentelemetry.sdk.trace import TracerProvider
    from opentelemetry.sdk.trace.export import BatchSpanProcessor, SpanExporter

    class Scrubbing(SpanExporter):
        """Removes keys: an error's text may quote one."""

        def export(self, spans: Sequence[ReadableSpan]) -> Any:
            return exporter.export([scrubbed_span(span) for span in spans])

        def shutdown(self) -> None:
            exporter.shutdown()

        def force_flush(self, timeout_millis: int = 30_000) -> bool:
            return exporter.force_flush(timeout_millis)

    # OTEL_SERVICE_NAME takes precedence.
    name = os.environ.get("OTEL_SERVICE_NAME", "coral")
    provider = TracerProvider(resource=Resource.create({"service.name": name}))
    provider.add_span_processor(BatchSpanProcessor(Scrubbing()))
    return provider


def scrubbed_span(span: ReadableSpan) -> ReadableSpan:
    """Return a span whose texts contain no key of this environment."""
    from opentelemetry.sdk.trace import Event, ReadableSpan
    from opentelemetry.trace import Status

    return ReadableSpan(
        name=span.name,
        context=span.get_span_context(),
        parent=span.parent,
        resource=span.resource,
        attributes=_scrubbed(span.attributes),
        events=[Event(event.name, _scrubbed(event.attributes), event.timestamp) for event in span.events],
        links=span.links,
        kind=span.kind,
        status=Status(span.status.status_code, scrub(span.status.description or "") or None),
        start_time=span.start_time,
        end_time=span.end_time,
        instrumentation_scope=span.instrumentation_scope,
    )


def _scrubbed(attributes: Mapping[str, Any] | None) -> dict[str, Any]:
    return {name: scrub(value) if isinstance(value, str) else value for name, value in (attributes or {}).items()}
