import re
import shutil

import pytest
from PIL import Image


@pytest.fixture(autouse=True)
def _interrupted(monkeypatch):
    """Ctrl-C comes as soon as the page is open."""
    monkeypatch.setattr("coral.commands.replay.wait_for_interrupt", lambda: None)


def test_a_run_is_shown_until_ctrl_c_and_then_told(told, survey):
    code, result, err = told("replay", survey, "--port", "0", "--json")
    assert code == 0
    assert (result["run"], result["duration_s"], result["complete"]) == (str(survey), 2.0, True)
    assert re.match(r"watch the run at http://127\.0\.0\.1:\d+/\?token=\S{24,}; Ctrl-C closes it\n", err)
    assert told("replay", survey, "--port", "0")[1] == f"the page is closed; 2 s of {survey} could be watched\n"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("{run}", "--speed", "0"), "speed: found 0"),
        (("{run}", "--port", "70000"), "--port: found 70000"),
        (("{here}/none",), "found nothing, expected the folder of a run"),
        (("{here}",), "found no run in it"),
    ],
)
def test_what_cannot_be_replayed_is_one_line(refused, survey, tmp_path, words, said):
    (tmp_path / "task.yaml").write_text("name: pick-box\n")
    assert said in refused("replay", *(word.format(run=survey, here=tmp_path) for word in words))


@pytest.fixture
def run(survey, tmp_path):
    """A run folder to write into."""
    return shutil.copytree(survey, tmp_path / "run")


def test_report_and_map_are_made_again_from_what_is_there(told, run):
    before = (run / "metrics.json").read_bytes()
    code, result, err = told("report", run, "--json")
    assert (code, err) == (0, "")
    assert result == {"report": str(run / "report.html"), "map": str(run / "map.png")}
    assert "s1" in (run / "report.html").read_text(encoding="utf-8")
    assert min(Image.open(run / "map.png").size) > 100
    assert (run / "metrics.json").read_bytes() == before


def test_a_run_cut_off_at_its_first_step_has_a_report_too(told, run):
    for path in run.iterdir():
        if path.name != "events.jsonl":
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    (run / "events.jsonl").write_text((run / "events.jsonl").read_text()[:50])
    code, text, _ = told("report", run)
    assert code == 0
    assert text.splitlines()[0] == f"report: {run / 'report.html'}"


def test_what_is_no_run_is_one_line(refused, tmp_path):
    assert "found nothing, expected the folder of a run" in refused("report", tmp_path / "none")
    assert "found no run in it" in refused("report", tmp_path)
