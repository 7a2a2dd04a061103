"""One small question: before a run with a model, which is refused if it cannot succeed, and to probe an endpoint."""

from __future__ import annotations

import sys
import time
from dataclasses import replace
from typing import Any, Literal

import cv2
import numpy as np
from pydantic import BaseModel, Field

from coral.advisor.inner_loop import run_alone
from coral.advisor.model_cfg import NOBODY, ModelCfg, OutputMode
from coral.advisor.models import ModelAdvisor
from coral.advisor.question import AdvisorUnavailable, BadAnswer, Picture, Question
from coral.advisor.registry import make_advisor, rules_alone
from coral.errors import InputError

NUMBER = 7
COLOR = "yellow"
"""Colour of the picture: a model that sees none would rather guess red or blue."""
RGB = (240, 205, 30)
SKIP = "--no-preflight skips this question"
MODES: tuple[OutputMode, ...] = ("native", "tool", "prompted", "plain")
"""The strictest first: the first that works is recommended."""
HOPELESS = ("key-refused", "no-such-model", "connection")
"""Failures of every output mode alike."""


class SmallAnswer(BaseModel):
    """What is asked for: small, but with a number, a range and a fixed set of words."""

    number: int = Field(ge=0, le=9)
    color: Literal["red", "green", "blue", "yellow", "white", "black", "none"]


def small_question(seeing: bool) -> Question[SmallAnswer]:
    """Make a question that any model can answer: repeat a number, and name the colour of a picture, if there is one."""
    color = "the color that fills the picture (red, green, blue, yellow, white or black)" if seeing else '"none"'
    return Question(
        kind="preflight",
        answer_type=SmallAnswer,
        facts={},
        prompt=f"Return only a JSON object with two keys: number, which is {NUMBER}, and color, which is {color}.",
        pictures=(Picture(name="patch", png=_patch()),) if seeing else (),
    )


def model_of(advisor: Any) -> ModelAdvisor | None:
    """Return the real model behind an advisor, also inside those that corrupt its answers; None if there is none."""
    while not isinstance(advisor, ModelAdvisor):
        advisor = getattr(advisor, "inner", None)
        if advisor is None:
            return None
    return advisor


def preflight(advisor: Any, *, pictures: bool, where: str = "--advisor", quiet: bool = False) -> None:
    """Ask the model of a run one small question, with a small picture if the run sends pictures.

    Without a model nothing happens. It retries at most once, whatever the configuration allows later; its tokens do not
    count for the run.

    Raises:
        InputError: The model cannot be used: its address does not respond, does not know it, or refuses its key, its
            reply is not an answer, or it does not see the picture.
    """
    model = model_of(advisor)
    if model is None:
        return
    if not quiet and sys.stderr.isatty():
        print(f"asking {model.name} one small question first ({SKIP})", file=sys.stderr, flush=True)
    seeing = pictures and model.cfg.pictures
    cfg = replace(model.cfg, max_retries=min(1, model.cfg.max_retries), pictures=seeing, facts=False)
    if model.is_dead():
        wrong = f"connection: {model.name} cannot be reached: {NOBODY}"
    else:
        wrong = run_alone(_ask(model.with_cfg(cfg), seeing))
    if wrong:
        raise InputError(where, "", f"{model.name}, which cannot be used ({wrong})", f"a model that answers; {SKIP}")


def probe(spec: str, cfg: ModelCfg) -> dict[str, Any]:
    """Ask PROVIDER:MODEL or local:URL#MODEL the question in every output mode, in the first that works with a picture.

    Retries and repairs are off, because the first reply is tested. Return the `advisor`, the outcome of each of the
    `modes` and of `pictures` (whether it `works`, what it `says`, and `wall_s`, the time), and the `recommended` mode;
    the last two are None if no mode works.

    Raises:
        InputError: The string names no real model, or the environment lacks its key.
    """
    cfg = replace(cfg, max_retries=0, format_repairs=0, facts=False)
    rng = np.random.default_rng(0)
    model = None if rules_alone(spec) else make_advisor(spec, rules={}, rng=rng, cfg=cfg, where="MODEL")
    if not isinstance(model, ModelAdvisor):
        raise InputError("MODEL", "", repr(spec), "a real model: PROVIDER:MODEL or local:URL#MODEL")
    return run_alone(_probe(model, cfg))


async def _probe(model: ModelAdvisor, cfg: ModelCfg) -> dict[str, Any]:
    async def outcome(mode: OutputMode, seeing: bool) -> dict[str, Any]:
        began = time.monotonic()
        wrong = await _ask(model.with_cfg(replace(cfg, output=mode, pictures=seeing)), seeing)
        return {"works": not wrong, "says": wrong or "ok", "wall_s": time.monotonic() - began}

    modes: dict[str, dict[str, Any]] = {}
    for mode in MODES:
        modes[mode] = await outcome(mode, False)
        if modes[mode]["says"].startswith(HOPELESS):
            break
    best = next((mode for mode in MODES if mode in modes and modes[mode]["works"]), None)
    pictures = None if best is None else await outcome(best, True)
    return {"advisor": model.name, "modes": modes, "pictures": pictures, "recommended": best}


async def _ask(model: ModelAdvisor, seeing: bool) -> str:
    """Return the model's fault, or ""."""
    try:
        answer = (await model.answer(small_question(seeing), ())).value
    except BadAnswer as bad:
        return _short(f"its reply is no answer, {bad.rejection.code}: {bad.rejection.reason}")
    except AdvisorUnavailable as gone:
        blind = "; --model.no-pictures sends none" if seeing and gone.code.startswith("http-") else ""
        return _short(f"{gone.code}: {gone.reason}") + blind
    finally:
        await model.aclose()
    if seeing and answer.color != COLOR:
        return f"it calls a {COLOR} picture {answer.color}, so it does not see pictures; --model.no-pictures sends none"
    return ""


def _patch() -> bytes:
    """Make a yellow PNG, 64 x 64 pixels."""
    image = np.full((64, 64, 3), RGB, np.uint8)
    return bytes(cv2.imencode(".png", image[:, :, ::-1])[1])


def _short(text: str) -> str:
    return " ".join(text.split())[:240]
