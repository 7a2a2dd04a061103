"""The examples of the reference page run."""

import re
from pathlib import Path

import numpy as np
import pytest

from coral.contact.cost_program import CostProgram

PAGE = (Path(__file__).parents[3] / "docs" / "reference" / "cost-language.md").read_text()


@pytest.mark.parametrize("code", re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL))
def test_an_example_of_the_page_runs(code, schema, states):
    terms = CostProgram(code, schema)(states(np.random.default_rng(0)))
    assert {"reach", "grasp", "lift"} <= set(terms) or set(terms) == {"cost"}
