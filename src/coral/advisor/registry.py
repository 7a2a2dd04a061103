"""From the string on the command line to the advisor that it names."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from coral.advisor.connect import KEYS, LOCAL_KEY
from coral.advisor.model_cfg import ModelCfg
from coral.advisor.question import Advisor
from coral.advisor.rules import Rule, RuleAdvisor
from coral.advisor.scrub import public_url
from coral.errors import InputError, nearest

FORMS = (
    "heuristic",
    "PROVIDER:MODEL (openai, anthropic, google)",
    "local:URL#MODEL",
    "desk",
    "replay:FILE",
    "fallible:P:INNER",
)
OTHER_NAMES = {
    "gemini": "google",
    "claude": "anthropic",
    "gpt": "openai",
    "chatgpt": "openai",
    "ollama": "local:URL#MODEL",
    "vllm": "local:URL#MODEL",
    "llama": "local:URL#MODEL",
    "human": "desk",
    "operator": "desk",
    "rules": "heuristic",
}
"""What people write for a provider or an advisor, as its beginning."""
NAMES = ("heuristic", *KEYS, "local", "desk", "replay", "fallible")


def rules_alone(advisor: str) -> bool:
    """Whether only rules answer for an advisor, spoilt or not: no model, no person, no recording of either.

    Args:
        advisor: As on the command line.
    """
    return re.fullmatch(r"(fallible:[^:]*:)*heuristic", advisor.replace(" ", "")) is not None


def make_advisor(
    spec: str,
    *,
    rules: Mapping[str, Rule],
    rng: np.random.Generator,
    inbox: Path | None = None,
    cfg: ModelCfg | None = None,
    where: str = "--advisor",
    spoil: Mapping[str, Callable[..., dict[str, Any]]] | None = None,
) -> Advisor:
    """Make the advisor that a string names.

    Args:
        spec: `heuristic`, `PROVIDER:MODEL`, `local:URL#MODEL`, `desk`, `replay:FILE` or `fallible:P:INNER`.
        rules: The application's own rules, for `heuristic`: kind of question to function of its facts.
        rng: Drawn from by `fallible` only.
        inbox: Folder in which `desk` puts its questions.
        cfg: Time-outs, budget and output mode of real models.
        where: What to name in an error message.
        spoil: How `fallible` spoils answers to a kind of question (`Corrupt`), where the general way knows too little.

    Raises:
        InputError: The string names no advisor, a file is missing or unreadable, or the environment lacks a key.
    """
    spec = spec.strip()
    name, _, rest = spec.partition(":")
    if spec == "heuristic":
        return RuleAdvisor(rules)
    if spec == "desk":
        from coral.advisor.desk import DeskAdvisor

        if inbox is None:
            raise InputError(where, "", "desk without an inbox", "a folder for its questions (--inbox DIR)")
        return DeskAdvisor(inbox)
    if name == "replay" and rest:
        from coral.advisor.replay import ReplayAdvisor

        return ReplayAdvisor(Path(rest), where=where)
    if name == "fallible" and rest:
        from coral.advisor.fallible import FallibleAdvisor, FallibleCfg

        rate, _, inner = rest.partition(":")
        if not inner:
            raise InputError(where, "", repr(spec), "fallible:P:INNER, such as fallible:0.3:heuristic")
        try:
            errors = FallibleCfg.total(float(rate))
        except ValueError:
            raise InputError(where, "P", repr(rate), "a probability from 0 to 1") from None
        wrapped = make_advisor(inner, rules=rules, rng=rng, inbox=inbox, cfg=cfg, where=where)
        return FallibleAdvisor(wrapped, errors, rng, spoil)
    if name == "local" and rest:
        if not re.match(r"https?://[^#\s]+#\S", rest):
            raise InputError(
                where,
                "",
                "an incomplete local advisor",
                "local:URL#MODEL, such as local:http://127.0.0.1:8080/v1#my-model",
            )
        url, _, model = rest.partition("#")
        if public_url(url) != url.rstrip("?"):
            raise InputError(
                where,
                "",
                f"a URL with credentials or a query ({public_url(url)})",
                f"a plain URL, and the key in the environment variable {LOCAL_KEY}",
            )
        from coral.advisor.models import ModelAdvisor

        return ModelAdvisor.local(url, model, cfg or ModelCfg())
    if name in KEYS and rest:
        from coral.advisor.models import ModelAdvisor

        return ModelAdvisor.provider(name, rest, cfg or ModelCfg(), where=where)
    raise InputError(where, "", repr(spec), _expected(spec))


def _expected(spec: str) -> str:
    """What might have been meant by a string that names no advisor."""
    name, colon, rest = spec.partition(":")
    whole = {form.partition(":")[0]: form for form in FORMS if ":" in form and " " not in form}
    whole |= {provider: f"{provider}:MODEL" for provider in KEYS}
    if name in whole and not rest:
        return f"all of {whole[name]}"
    known = next((provider for start, provider in OTHER_NAMES.items() if name.lower().startswith(start)), "")
    if known in KEYS:
        model = rest if colon else spec
        return f"one of {', '.join(FORMS)} (did you mean '{known}:{model or 'MODEL'}'?)"
    if known:
        return f"one of {', '.join(FORMS)} (did you mean {known!r}?)"
    return f"one of {', '.join(FORMS)}{nearest(name, NAMES, 0.7)}"
