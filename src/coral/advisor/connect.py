"""Connections to the providers: one pydantic-ai model each, silent retries off, keys from the environment only."""

from __future__ import annotations

import os
import warnings
from typing import TYPE_CHECKING

from coral.advisor.model_cfg import ModelCfg

if TYPE_CHECKING:
    import httpx2
    from pydantic_ai.models import Model

KEYS = {
    "openai": ("OPENAI_API_KEY",),
    "anthropic": ("ANTHROPIC_API_KEY",),
    "google": ("GOOGLE_API_KEY", "GEMINI_API_KEY"),
}
"""Supported providers, and the environment variables that may hold their key (any one)."""

LOCAL_KEY = "CORAL_LOCAL_API_KEY"
"""Environment variable with the key of an OpenAI-compatible server, for servers that require one."""


def connect(provider: str, model: str, url: str, cfg: ModelCfg) -> tuple[Model, httpx2.AsyncClient]:
    """Make the client of one model; nothing is sent yet. Call it on the event loop that will use it.

    The provider is "openai", "anthropic", "google", or "local" (an OpenAI-compatible server, which alone has a `url`).
    """
    from coral.advisor.wire import http_client

    # A server that tells nonsense of its use is not worth a line in the terminal; the calls count anyhow.
    warnings.filterwarnings("ignore", message="Failed to extract usage")
    client = http_client(cfg.max_reply_bytes, cfg.attempt_timeout_s)
    key = next((os.environ[name] for name in KEYS.get(provider, (LOCAL_KEY,)) if os.environ.get(name)), "none")
    if provider == "anthropic":
        from anthropic import AsyncAnthropic
        from pydantic_ai.models.anthropic import AnthropicModel
        from pydantic_ai.providers.anthropic import AnthropicProvider

        return AnthropicModel(
            model,
            provider=AnthropicProvider(anthropic_client=AsyncAnthropic(api_key=key, max_retries=0, http_client=client)),
        ), client
    if provider == "google":
        from pydantic_ai.models.google import GoogleModel
        from pydantic_ai.providers.google import GoogleProvider

        return GoogleModel(model, provider=GoogleProvider(api_key=key, http_client=client)), client
    from openai import AsyncOpenAI
    from pydantic_ai.models.openai import OpenAIChatModel
    from pydantic_ai.profiles.openai import OpenAIModelProfile
    from pydantic_ai.providers.openai import OpenAIProvider

    # The library would drop the mark of a thought that is not closed, and pass the thought off as the reply.
    profile = OpenAIModelProfile(thinking_tags=("\0", "\0"))
    if provider == "local":
        # A local server's capabilities do not follow from its model's name: try the requested output mode.
        profile |= OpenAIModelProfile(
            supports_json_schema_output=True,
            supports_json_object_output=True,
            supports_tools=True,
            openai_chat_supports_max_completion_tokens=False,
        )
    made = AsyncOpenAI(api_key=key, base_url=url or None, max_retries=0, http_client=client)
    return OpenAIChatModel(model, profile=profile, provider=OpenAIProvider(openai_client=made)), client
