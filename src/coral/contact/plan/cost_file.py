"""A plan in a file: one cost function in Python, or a plan of several stages in YAML or JSON, as a model gives it."""

from __future__ import annotations

from pathlib import Path

from pydantic import ValidationError

from coral.contact.plan.cost_plan import PlanAnswer
from coral.errors import InputError
from coral.foreign_file import read_text
from coral.validation_errors import input_error
from coral.yaml_file import load_mapping

ENDINGS = (".py", ".yaml", ".yml", ".json")


def read_cost_file(path: Path) -> PlanAnswer:
    """Read a plan. Its programs are not run; `judge_plan` checks them.

    Args:
        path: A `.py` file with `def state_cost(self)`, or a YAML or JSON file with `code` or `stages`
            (`PlanAnswer`), or the list of stages alone.

    Raises:
        InputError: The file cannot be read, or is no plan.
    """
    if path.suffix.lower() not in ENDINGS:
        raise InputError(str(path), "", repr(path.suffix), f"a file that ends in {', '.join(ENDINGS)}")
    text = read_text(path, "a readable file with a cost")
    try:
        if path.suffix.lower() == ".py":
            return PlanAnswer(code=text)
        # A model may say more than it was asked; what a person wrote and nobody reads is a mistake.
        return PlanAnswer.model_validate(load_mapping(text, str(path), list_key="stages"), extra="forbid")
    except ValidationError as error:
        told = input_error(str(path), error, PlanAnswer)
        if error.errors()[0]["type"] == "value_error":  # a sentence for whoever wrote the plan, a model or a person
            raise InputError(told.where, told.field, told.expected, "") from None
        raise told from None
