"""Real models: one question, one request, limited retries and repairs, and a hard deadline."""

from __future__ import annotations

import asyncio
import os
import re
import socket
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, TypeVar
from urllib.parse import urlsplit

from pydantic import BaseModel

from coral.advisor.connect import KEYS, LOCAL_KEY, connect
from coral.advisor.model_cfg import CONNECT_S, ModelCfg, SpendCfg
from coral.advisor.parse import parse_answer
from coral.advisor.prompt import render_rejections
from coral.advisor.question import AdvisorUnavailable, BadAnswer, Question, Rejection, Reply, Usage
from coral.advisor.scrub import public_url, scrub
from coral.advisor.setting import Setting
from coral.errors import InputError

if TYPE_CHECKING:
    import httpx2
    from pydantic_ai.messages import ModelResponse, UserContent
    from pydantic_ai.models import Model, ModelRequestParameters

A = TypeVar("A", bound=BaseModel)

REPAIRED = ("empty", "not-json", "missing-field", "wrong-type", "out-of-range", "invalid", "cut-off")
"""Faults of format, which a second request may repair. A refusal or an endless reply is not repeated here."""
MOST_TOKENS = 10**9
"""A server that tells of more in one reply is taken at this."""


class Ledger:
    """Counts requests, tokens and money of one run."""

    def __init__(self, cfg: SpendCfg) -> None:
        self.cfg = cfg
        self.calls = 0
        self.tokens = 0
        self.usd = 0.0

    def open_call(self) -> None:
        """Count one request before it is sent.

        Raises:
            AdvisorUnavailable: The budget is exhausted (code "budget", final).
        """
        bounds = (
            (self.calls, self.cfg.max_calls, "calls", "max_calls"),
            (self.tokens, self.cfg.max_tokens, "tokens", "max_tokens"),
            (self.usd, self.cfg.max_usd, "USD", "max_usd"),
        )
        for spent, bound, unit, name in bounds:
            if spent >= bound:
                raise AdvisorUnavailable(
                    "budget", f"the run's budget is used up: {spent:g} of {bound:g} {unit} (spend.{name})", final=True
                )
        self.calls += 1

    def add(self, tokens: int, usd: float) -> None:
        """Record the cost of a reply."""
        self.tokens += tokens
        self.usd += usd


@dataclass
class _Spent:
    """Running cost of one answer."""

    usage: Usage = field(default_factory=lambda: Usage(requests=0))

    def fault(self, code: str) -> None:
        self.usage = replace(self.usage, faults=(*self.usage.faults, code))

    def add(self, **counts: float) -> None:
        self.usage = replace(self.usage, **{key: getattr(self.usage, key) + n for key, n in counts.items()})


class ModelAdvisor:
    """A vision-language or language model behind an API.

    Each answer is a new conversation: the prompt, the reasons why earlier answers were refused (in our words), and the
    present pictures. Nothing else of earlier attempts is sent. The client library makes one request and neither retries
    nor repairs.
    """

    latency = "measured"

    def __init__(self, provider: str, model: str, cfg: ModelCfg, url: str = "") -> None:
        """Describe a model of "openai", "anthropic", "google" or "local", which connects at its first answer."""
        self.cfg = cfg
        self.ledger = Ledger(cfg.spend)
        self.name = f"local:{public_url(url)}#{model}" if provider == "local" else f"{provider}:{model}"
        self._provider, self._model_name, self._url = provider, model, url
        self._model: Model | None = None
        self._client: httpx2.AsyncClient | None = None

    @classmethod
    def local(cls, url: str, model: str, cfg: ModelCfg) -> ModelAdvisor:
        """Make a model on an OpenAI-compatible server (vLLM, Ollama, llama.cpp)."""
        return cls("local", model, cfg, url)

    def with_cfg(self, cfg: ModelCfg) -> ModelAdvisor:
        """Return the same model with another configuration and its own accounts."""
        return ModelAdvisor(self._provider, self._model_name, cfg, self._url)

    def is_dead(self) -> bool:
        """Check whether nothing listens at the address of a local server; the client library alone takes seconds."""
        if self._provider != "local" or any(name.lower().endswith("_proxy") for name in os.environ):
            return False
        place = urlsplit(self._url)
        try:
            address = place.hostname or "", place.port or (443 if place.scheme == "https" else 80)
            with socket.create_connection(address, timeout=min(CONNECT_S, self.cfg.attempt_timeout_s)):
                return False
        except (OSError, ValueError):
            return True

    async def warm_up(self) -> None:
        """Import the client library and make the connection pool before a control loop runs."""
        self._connect()

    async def aclose(self) -> None:
        """Close the connections; the next answer opens new ones."""
        client, self._client, self._model = self._client, None, None
        if client is not None:
            await client.aclose()

    def _connect(self) -> Model:
        if self._model is None:
            self._model, self._client = connect(self._provider, self._model_name, self._url, self.cfg)
        return self._model

    async def answer(self, question: Question[A], rejections: Sequence[Rejection]) -> Reply[A]:
        """Ask the model.

        Raises:
            BadAnswer: Its reply does not validate, and neither does the repaired one.
            AdvisorUnavailable: No reply: "timeout", "connection", "http-STATUS" (final if asking again cannot help),
                "budget" (final), "key-refused" (final), "no-such-model" (final), "client-error".
        """
        spent = _Spent()
        self._connect()  # The first import takes seconds; the deadline is the model's.
        try:
            async with asyncio.timeout(self.cfg.deadline_s) as deadline:
                return await self._answer(question, rejections, spent, deadline.when() or 0.0)
        except TimeoutError:
            late = f"{self.name} gave no answer within {self.cfg.deadline_s:g} s"
            raise AdvisorUnavailable("timeout", late, usage=spent.usage) from None
        except AdvisorUnavailable as gone:
            gone.usage = spent.usage
            raise
        except BadAnswer as bad:
            raise BadAnswer(bad.rejection.code, scrub(bad.rejection.reason), scrub(bad.raw), spent.usage) from None

    async def _answer(
        self, question: Question[A], rejections: Sequence[Rejection], spent: _Spent, deadline: float
    ) -> Reply[A]:
        parameters = self._request_parameters(question.answer_type)
        repair = ""
        for repairs_left in range(self.cfg.format_repairs, -1, -1):
            message = self._build_message(question, rejections, repair)
            response = await self._request(message, parameters, spent, deadline)
            raw = _raw(response)
            try:
                value = _parse(response, raw, question.answer_type, self.cfg.max_output_tokens)
            except BadAnswer as bad:
                code, reason = bad.rejection.code, bad.rejection.reason
                if not repairs_left or code not in REPAIRED:
                    raise
                spent.fault(code)
                repair = (
                    f"Your last reply to this could not be used. {reason} It began:\n{raw[:1000]}\n"
                    "Reply again, with nothing but the answer in the format asked for."
                )
                continue
            return Reply(value=value, raw=raw, usage=spent.usage)
        raise AssertionError("the last repair returns or raises")

    def _build_message(
        self, question: Question[Any], rejections: Sequence[Rejection], repair: str
    ) -> list[UserContent]:
        """Build the user message: constant parts first, then pictures, then the new parts."""
        from pydantic_ai.messages import BinaryContent

        content: list[UserContent] = [question.prompt]
        if self.cfg.facts:
            from coral.advisor.log import plain_json

            content.append("What the pictures show, as numbers:\n" + plain_json(question.facts))
        if self.cfg.pictures:
            for picture in question.pictures:
                content.append(f"Picture {picture.name}: {picture.caption}".rstrip(": "))
                content.append(BinaryContent(data=picture.png, media_type="image/png"))
        if rejections:
            content.append(render_rejections(rejections))
        if repair:
            content.append(repair)
        return content

    def _request_parameters(self, answer_type: type[BaseModel]) -> ModelRequestParameters:
        """Return the request parameters for the output mode."""
        from pydantic_ai.models import ModelRequestParameters
        from pydantic_ai.output import OutputObjectDefinition
        from pydantic_ai.tools import ToolDefinition

        mode = self.cfg.output
        if mode == "auto":
            mode = "plain" if self._provider == "local" else "native"
        schema = answer_type.model_json_schema()
        if mode == "tool":
            said = "Give the answer."
            tool = ToolDefinition(name="answer", description=said, parameters_json_schema=schema, kind="output")
            return ModelRequestParameters(output_mode="tool", output_tools=[tool], allow_text_output=False)
        if mode == "plain":
            return ModelRequestParameters()
        shape = OutputObjectDefinition(json_schema=schema, name="answer")
        # The prompt says what to return; leave the library's own instructions out.
        return ModelRequestParameters(output_mode=mode, output_object=shape, prompted_output_template=False)

    async def _request(
        self, content: list[UserContent], parameters: ModelRequestParameters, spent: _Spent, deadline: float
    ) -> ModelResponse:
        """Return one reply, after as many retries as needed and allowed."""
        from pydantic_ai.messages import ModelRequest, UserPromptPart
        from pydantic_ai.settings import ModelSettings

        from coral.advisor.failures import CLIENT_ERRORS, diagnose

        settings = ModelSettings(max_tokens=self.cfg.max_output_tokens)
        if self.cfg.temperature is not None:
            settings["temperature"] = self.cfg.temperature
        pause_s, began_s = self.cfg.backoff_s, asyncio.get_running_loop().time()
        for retries_left in range(self.cfg.max_retries, -1, -1):
            self.ledger.open_call()
            spent.add(requests=1)
            try:
                async with asyncio.timeout(self.cfg.attempt_timeout_s):
                    response = await self._connect().request(
                        [ModelRequest(parts=[UserPromptPart(_plain_if_text(content))])], settings, parameters
                    )
            except TimeoutError:
                silence = f"{self.name} was silent for {self.cfg.attempt_timeout_s:g} s"
                raise AdvisorUnavailable("timeout", silence) from None
            except CLIENT_ERRORS as error:
                failure = diagnose(error, self.name, self.cfg.max_reply_bytes)
            else:
                self._record_cost(response, spent)
                return response
            if not failure.retry or not retries_left:
                raise failure.error
            wait_s = pause_s if failure.wait_s is None else failure.wait_s
            next_s = asyncio.get_running_loop().time() + wait_s
            if next_s - began_s > failure.patience_s:
                raise failure.error
            if next_s >= deadline:
                late = f"{failure.error}; the next try would be in {wait_s:g} s, after the deadline"
                raise AdvisorUnavailable(failure.code, late)
            spent.fault(failure.code)
            await asyncio.sleep(wait_s)
            pause_s *= 2
        raise AssertionError("the last retry returns or raises")

    def _record_cost(self, response: ModelResponse, spent: _Spent) -> None:
        """Count tokens and money, as far as the reply and the price list provide them."""
        try:
            usd = float(response.cost().total_price)
        except (LookupError, ValueError, AssertionError):
            usd = 0.0
        told, wrote = (min(n, MOST_TOKENS) for n in (response.usage.input_tokens, response.usage.output_tokens))
        spent.add(input_tokens=told, output_tokens=wrote, cost_usd=usd)
        self.ledger.add(told + wrote, usd)


def _plain_if_text(content: list[UserContent]) -> str | list[UserContent]:
    """Return a single string if there are no pictures: many local models' chat templates accept nothing else."""
    texts = [part for part in content if isinstance(part, str)]
    return "\n\n".join(texts) if len(texts) == len(content) else content


def _raw(response: ModelResponse) -> str:
    """Return the model's text, and the arguments of its tool call."""
    texts = [part.content for part in response.parts if part.part_kind == "text"]
    calls = [part.args_as_json_str() for part in response.parts if part.part_kind == "tool-call"]
    return "\n".join([*texts, *calls])


def _parse(response: ModelResponse, raw: str, answer_type: type[A], most_tokens: int) -> A:
    if response.finish_reason == "content_filter":
        said = str((response.provider_details or {}).get("refusal", ""))
        raise BadAnswer("refusal", "The request was declined; choose one of the options as asked.", raw or said)
    if response.finish_reason == "length":
        # Whatever parses in a reply that broke off may be a draft, or the first half of the answer.
        raise BadAnswer("cut-off", f"The reply broke off at its limit of {most_tokens} tokens; think less.", raw)
    return parse_answer(raw, answer_type)


def make_provider(name: str, rest: str, setting: Setting) -> ModelAdvisor:
    """Make a provider's model, PROVIDER:MODEL.

    Raises:
        InputError: The environment has no key for it.
    """
    if not any(os.environ.get(key) for key in KEYS[name]):
        expected = f"the environment variable {' or '.join(KEYS[name])}"
        raise InputError(setting.where, "", f"no key for {name}", expected)
    return ModelAdvisor(name, rest, setting.model)


def make_local(name: str, rest: str, setting: Setting) -> ModelAdvisor:
    """Make a model on a private server, local:URL#MODEL.

    Raises:
        InputError: The address is incomplete, or contains a secret.
    """
    if not re.match(r"https?://[^#\s]+#\S", rest):
        expected = "local:URL#MODEL, such as local:http://127.0.0.1:8080/v1#my-model"
        raise InputError(setting.where, "", "an incomplete local advisor", expected)
    url, _, model = rest.partition("#")
    if public_url(url) != url.rstrip("?"):
        found = f"a URL with credentials or a query ({public_url(url)})"
        expected = f"a plain URL, and the key in the environment variable {LOCAL_KEY}"
        raise InputError(setting.where, "", found, expected)
    return ModelAdvisor.local(url, model, setting.model)
