"""The reference page tells what the code knows, and its examples run."""

import re
from pathlib import Path

import numpy as np
import pytest

from coral.contact.cost_program import CostProgram
from coral.contact.plan.cost_reference import interface, updated

PAGE = (Path(__file__).parents[3] / "docs" / "reference" / "cost-language.md").read_text()


def test_the_tables_of_the_page_are_up_to_date():
    assert updated(PAGE) == PAGE
    assert "`self.box_left_contact`" in PAGE


@pytest.mark.parametrize("code", re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL))
def test_an_example_of_the_page_runs(code, schema, states):
    terms = CostProgram(code, schema)(states(np.random.default_rng(0)))
    assert {"reach", "grasp", "lift"} <= set(terms)


def test_the_text_for_a_prompt_names_every_quantity(schema):
    text = interface(schema)
    assert all(f"self.{name}:" in text for name in schema)
    assert "self.ee_force: vector of 3 (N)" in text
