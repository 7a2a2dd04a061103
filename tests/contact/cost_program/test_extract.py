"""The program is found in any layout of a model's reply, and nothing else of the reply is taken for code."""

from __future__ import annotations

import textwrap

import numpy as np
import pytest

from coral.contact.cost_program import CostProgram
from coral.contact.cost_program.extract import extract

LAYOUTS = {
    "python fence": "Here is the cost:\n\n```python\n{}\n```\nIt reaches the box.",
    "bare fence": "```\n{}\n```",
    "two fences": "Install:\n```bash\npip install x\n```\nthen\n```py\n{}\n```\n",
    "unclosed fence": "```python\n{}",
    "explanation after a rule": "{}\n---\nThe old cost was flat.",
    "prose around it": "The new function:\n\n{}\n\nThis rewards the approach.",
    "windows line ends": "{}\n",
    "class around it": "CLASS",
    "indented block": "INDENT",
    "body only": "BODY",
    "body without its first indent": "STRIPPED",
}
INNER = (
    "def state_cost(self):\n    cost = np.linalg.norm(self.ee_pos - self.box_pos)\n    if self.time > 0.5:\n"
    "        cost += 1.0\n    return cost"
)


@pytest.mark.parametrize("layout", sorted(LAYOUTS))
def test_a_layout_of_the_reply_does_not_matter(layout, schema, states, plainly):
    form = LAYOUTS[layout]
    body = textwrap.dedent(INNER.split("\n", 1)[1])
    if form == "INDENT":
        text = "Sure:\n\n" + textwrap.indent(INNER, "    ")
    elif form == "CLASS":
        text = "import numpy as np\n\nclass Task:\n" + textwrap.indent(INNER, "    ")
    elif form == "BODY":
        text = textwrap.indent(body, "    ")
    elif form == "STRIPPED":
        text = textwrap.indent(body, "    ").strip()
    else:
        text = form.format(INNER)
    if layout == "windows line ends":
        text = text.replace("\n", "\r\n")
    state = states(np.random.default_rng(1), 2, 3)
    np.testing.assert_allclose(
        sum(CostProgram(text, schema).evaluate(state).values()), plainly(INNER, state), rtol=1e-9
    )


def test_the_block_with_the_cost_is_taken_even_where_another_is_longer():
    cost = "def state_cost(self):\n    return 1.0\n"
    longer = "def helper(x):\n" + "    x = x + 1.0\n" * 20 + "    return x\n"
    assert extract(f"```python\n{longer}```\nand\n```python\n{cost}```") == cost


def test_code_above_the_function_is_kept_and_prose_is_not():
    found = extract("This cost is new:\nimport math\nW = 2.0\n\ndef state_cost(self):\n    return W\n\nIt reaches.")
    assert found == "import math\nW = 2.0\n\ndef state_cost(self):\n    return W\n"


def test_tabs_become_spaces():
    assert extract("def state_cost(self):\n\treturn 1.0") == "def state_cost(self):\n    return 1.0\n"


def test_a_reply_without_text_holds_no_program():
    assert extract(" \n\n") == ""
