import json
import re
from pathlib import Path

PAGE = (Path(__file__).parents[2] / "docs" / "reference" / "advisors.md").read_text()


def test_the_advisor_on_the_page_drives_a_mission(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (code,) = [code for code in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL) if "Mission(" in code]
    exec(compile(code, "advisors.md", "exec"), {"__name__": "page"})
    verdicts = [json.loads(line)["verdict"] for line in (tmp_path / "mine" / "attempts.jsonl").open()]
    assert int(capsys.readouterr().out.split()[1]) == len(verdicts) > 0
    assert "accepted" in verdicts
