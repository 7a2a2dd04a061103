"""The default advisor of the hand: what a vision-language model answered at the desk, by the name of the task."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from pydantic import BaseModel

from coral.advisor.attribution import Source
from coral.advisor.question import AdvisorUnavailable, Question, Rejection, Reply
from coral.advisor.recorded_attempts import SHIPPED, shipped_recordings
from coral.advisor.replay import ReplayAdvisor
from coral.advisor.setting import Setting
from coral.errors import InputError

A = TypeVar("A", bound=BaseModel)
CONTACT, UNIFIED, UNGUIDED = "contact-", "unified-", "unguided-"
"""Beginnings of the names of shipped recordings of contact tasks; the last two are of the variants of these names."""
POSES = "poses"
"""The recording of answers about pictures: each serves the trial whose picture it is about, and no other."""


class RecordedAdvisor:
    """Answers with what a vision-language model answered at the desk for the task that the question names.

    A plan is a program over quantities, so one recording serves every trial of its task, whatever its poses, sizes and
    masses; a repair is given where one is asked for. One question for everything, and plans without a contact strategy,
    have recordings of their own. There is nothing for a task that nobody answered, nor for a picture (`no-tracking`)
    that nobody read.
    """

    latency = "recorded"
    source: Source = "recording"
    name = "recorded"

    def __init__(self) -> None:
        self._recordings: dict[str, ReplayAdvisor] = {}
        self._asked = CONTACT

    async def answer(self, question: Question[A], rejections: Sequence[Rejection]) -> Reply[A]:
        """Give the next recorded answer of the question's kind.

        Raises:
            AdvisorUnavailable: With code "not-recorded": there is none, or none is left.
        """
        if question.kind == "object-poses":
            if POSES not in self._recordings:
                self._recordings[POSES] = ReplayAdvisor(SHIPPED / f"{POSES}.jsonl")
            return await self._recordings[POSES].answer(question, rejections)
        task = str(question.facts.get("task", ""))
        if question.kind == "unified":
            self._asked = UNIFIED
        elif not question.facts.get("contact_strategy", True):
            self._asked = UNGUIDED
        name = f"{self._asked}{task}"
        if name not in shipped_recordings():
            raise AdvisorUnavailable("not-recorded", f"nobody answered {task!r} yet", final=True, latency_s=0.0)
        if name not in self._recordings:
            self._recordings[name] = ReplayAdvisor(SHIPPED / f"{name}.jsonl", in_order=True, accepted=True)
        return await self._recordings[name].answer(question, rejections)


def is_recorded(task: str, variant: str = "full") -> bool:
    """Return whether a recording of a contact task comes with the package; `unified` and `unguided` have their own."""
    own = f"{variant}-"
    return f"{own if own in (UNIFIED, UNGUIDED) else CONTACT}{task}" in shipped_recordings()


def make_recorded(name: str, rest: str, setting: Setting) -> RecordedAdvisor:
    """Make the advisor of the shipped recordings of contact tasks.

    Raises:
        InputError: The application has reefs alone.
    """
    if setting.rules and all(kind.startswith("reef-") for kind in setting.rules):
        reefs = [name for name in shipped_recordings() if name.startswith("reef-")]
        expected = f"for a reef a recorded mission, such as in-order:{reefs[0]}: {name} holds answers to contact tasks"
        raise InputError(setting.where, "", name, expected)
    return RecordedAdvisor()
