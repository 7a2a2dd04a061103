import re
from pathlib import Path


def test_the_program_in_the_guide_answers(tmp_path, monkeypatch, ask, case):
    page = (Path(__file__).parents[2] / "docs" / "guide" / "the-desk.md").read_text(encoding="utf-8")
    asking = ask(case.reef_question())
    monkeypatch.chdir(tmp_path)
    exec(compile(re.search(r"```python\n(.*?)```", page, re.DOTALL)[1], "guide", "exec"), {})
    assert asking.result().selected_centroid_index == 4
