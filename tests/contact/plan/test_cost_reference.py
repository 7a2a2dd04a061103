"""The reference page tells what the code knows, and its examples run."""

import re
from pathlib import Path

import numpy as np
import pytest

from coral.contact.cost.schema import HAND
from coral.contact.cost_program import CostProgram
from coral.contact.cost_program.errors import CODES
from coral.contact.plan.cost_reference import interface, tables

PAGE = (Path(__file__).parents[3] / "docs" / "reference" / "cost-language.md").read_text()


@pytest.mark.parametrize("code", re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL))
def test_an_example_of_the_page_runs(code, schema, states):
    terms = CostProgram(code, schema)(states(np.random.default_rng(0)))
    assert {"reach", "grasp", "lift"} <= set(terms)


def test_the_text_for_a_prompt_names_every_quantity(schema):
    text = interface(schema)
    assert all(f"self.{name}:" in text for name in schema)
    assert "self.ee_force: vector of 3 (N)" in text


def test_the_tables_have_a_row_for_each_name():
    made = tables()
    assert "| `self.box_left_contact` | true or false |" in made["object"]
    assert all(f"`self.{name}`" in made["hand"] for name in HAND)
    assert all(f"| `{code}` |" in made["errors"] for code in CODES)
