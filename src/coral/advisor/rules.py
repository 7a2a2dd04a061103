"""The embedded default advisor: the application's rules, applied to facts alone. Not a VLM, not an LLM."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeVar

from pydantic import BaseModel

from coral.advisor.question import AdvisorUnavailable, Question, Rejection, Reply
from coral.advisor.setting import Rule, Setting
from coral.errors import InputError

A = TypeVar("A", bound=BaseModel)


class RuleAdvisor:
    """Answers each kind of question with one of the application's functions."""

    latency = "0"

    def __init__(self, rules: Mapping[str, Rule], name: str = "heuristic") -> None:
        self.name = name
        self._rules = dict(rules)

    async def answer(self, question: Question[A], rejections: Sequence[Rejection]) -> Reply[A]:
        """Apply the rule for this kind of question.

        Raises:
            AdvisorUnavailable: There is no rule for it.
        """
        rule = self._rules.get(question.kind)
        if rule is None:
            raise AdvisorUnavailable(
                "no-rule",
                f"{self.name} has no rule for {question.kind!r}, only for "
                f"{', '.join(sorted(self._rules)) or 'nothing'}",
                final=True,
            )
        value = rule(question.facts, rejections)
        if not isinstance(value, question.answer_type):
            # Another model of the same shape is valid: its fields decide.
            value = question.answer_type.model_validate(value.model_dump())
        return Reply(value=value, raw=value.model_dump_json())


def make_rules(name: str, rest: str, setting: Setting) -> RuleAdvisor:
    """Make the advisor of the application's rules.

    Raises:
        InputError: The application has none.
    """
    if not setting.rules:
        raise InputError(setting.where, "", name, "another advisor, such as recorded: the hand has no rules")
    return RuleAdvisor(setting.rules)
