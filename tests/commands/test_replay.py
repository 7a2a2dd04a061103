import re

import pytest


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
