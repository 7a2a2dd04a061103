import dataclasses
import re
from pathlib import Path

from coral.advisor.model_cfg import ModelCfg, SpendCfg

PAGE = (Path(__file__).parents[2] / "docs" / "plug-in-a-model.md").read_text()


def test_program_on_the_page_prints_what_the_page_says(capsys):
    code = re.search(r"```python\n(.*?)```", PAGE, re.DOTALL).group(1)
    exec(compile(code, "plug-in-a-model.md", "exec"), {})
    assert capsys.readouterr().out.strip() == code.rsplit("# ", 1)[1].strip()


def test_defaults_on_the_page_are_the_real_ones():
    real = {**dataclasses.asdict(ModelCfg()), **{f"spend.{k}": v for k, v in dataclasses.asdict(SpendCfg()).items()}}
    rows = re.findall(r"^\| (`[^|]+) \| ([\d., ]+) \|", PAGE, re.MULTILINE)
    told = {}
    for names, values in rows:
        numbers = re.findall(r"\d[\d,]*\d{3}|[\d.]+", values)
        told |= dict(zip(re.findall(r"`([\w.]+)`", names), (float(n.replace(",", "")) for n in numbers), strict=True))
    assert len(told) == 9
    assert told == {name: real[name] for name in told}
