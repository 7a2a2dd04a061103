import dataclasses
import json
import re
from pathlib import Path

from coral.advisor.model_cfg import ModelCfg, SpendCfg
from coral.contact.episode.variants import contact_model

PAGE = (Path(__file__).parents[2] / "docs" / "reference" / "advisors.md").read_text()


def test_program_on_the_page_prints_what_the_page_says(capsys):
    code = re.search(r"```python\n(.*?)```", PAGE, re.DOTALL).group(1)
    exec(compile(code, "advisors.md", "exec"), {})
    assert capsys.readouterr().out.strip() == code.rsplit("# ", 1)[1].strip()


def test_defaults_on_the_page_are_the_real_ones():
    real = {**dataclasses.asdict(ModelCfg()), **{f"spend.{k}": v for k, v in dataclasses.asdict(SpendCfg()).items()}}
    rows = re.findall(r"^\| (`[^|]+) \| ([\d., ]+) \|", PAGE, re.MULTILINE)
    told = {}
    for names, values in rows:
        numbers = re.findall(r"\d[\d,]*\d{3}|[\d.]+", values)
        told |= dict(zip(re.findall(r"`([\w.]+)`", names), (float(n.replace(",", "")) for n in numbers), strict=True))
    assert len(told) == 10
    assert told == {name: real[name] for name in told}


def test_other_defaults_of_contact_tasks_are_the_real_ones():
    told = dict(re.findall(r"^\| `(\w+)` \|.*in a contact task ([\d,]+)", PAGE, re.MULTILINE))
    real, usual = dataclasses.asdict(contact_model()), dataclasses.asdict(ModelCfg())
    assert {name: float(value.replace(",", "")) for name, value in told.items()} == {
        name: value for name, value in real.items() if value != usual[name]
    }


def test_the_advisor_on_the_page_drives_a_mission(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (code,) = [code for code in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL) if "Mission(" in code]
    exec(compile(code, "advisors.md", "exec"), {"__name__": "page"})
    verdicts = [json.loads(line)["verdict"] for line in (tmp_path / "mine" / "attempts.jsonl").open()]
    assert int(capsys.readouterr().out.split()[1]) == len(verdicts) > 0
    assert "accepted" in verdicts
