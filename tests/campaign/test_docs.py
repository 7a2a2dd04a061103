import dataclasses
import re
import subprocess
import sys
from pathlib import Path

from coral.commands.reef_bench import ReefBench

DOCS = Path(__file__).parents[2] / "docs"


def test_the_program_on_the_page_prints_the_squares(tmp_path):
    code = re.search(r"```python\n(.*?)```", (DOCS / "guide/cluster.md").read_text(), re.DOTALL).group(1)
    (tmp_path / "study.py").write_text(code)
    done = subprocess.run([sys.executable, "study.py"], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[0, 1, 4, 9]"


def test_flags_on_the_pages_exist():
    fields = {"--" + field.name.replace("_", "-") for field in dataclasses.fields(ReefBench)}
    told = set(re.findall(r"`(--[a-z-]+)", (DOCS / "reference/campaigns.md").read_text()))
    told |= set(re.findall(r"coral reef bench (--[a-z]+)", (DOCS / "guide/cluster.md").read_text()))
    assert {flag.replace("--no-", "--") for flag in told} - fields == set()
    assert len(told) > 5
