import json
import os
from pathlib import Path

import pytest
from contact_bench import changed

from coral.cli import main
from coral.commands.contact_run import HINT, WAYS_ON, KeyboardVerdict
from coral.contact.episode.trial_log import END_REASONS
from coral.contact.scene.task_names import TASKS_DIR

COARSE = ["--samples", "6", "--cfg.controller.horizon", "8", "--cfg.planning.threads", "1", "--quiet"]


def answer(capsys):
    return json.loads(capsys.readouterr().out)


@pytest.mark.wing("coral.view")
def test_run_prints_one_object_with_the_promised_keys_and_leaves_a_run(task, tmp_path, capsys):
    assert main(["contact", "run", task, "--world", "hand", "--out", str(tmp_path / "run"), "--json", *COARSE]) == 0
    result = answer(capsys)
    assert {
        "success",
        "sim_time_s",
        "steps",
        "advisor_calls",
        "repairs",
        "memory_hit",
        "path_length_m",
        "end_reason",
        "poses",
        "wall_time_s",
        "plan_ms_median",
    } <= set(result)
    assert (result["success"], result["end_reason"], result["poses"]) == (False, "timeout", "tracked")
    assert {path.name for path in (tmp_path / "run").iterdir()} == {
        "config.yaml",
        "task.yaml",
        "events.jsonl",
        "attempts.jsonl",
        "pictures",
        "trajectory.csv",
        "states.csv",
        "metrics.json",
        "timing.json",
        "report.html",
        "keyframes.png",
    }


def test_run_says_in_words_how_it_ended(task, tmp_path, capsys):
    words = ["contact", "run", task, "--world", "hand", "--out", str(tmp_path / "run"), "--cfg.record.no-report"]
    assert main([*words, *COARSE]) == 0
    assert "timeout (the task's time limit was reached; not held: " in (said := capsys.readouterr().out)
    assert " cm, wanted " in said
    assert ") after 0.2 s simulated" in said


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["pick-bx"], "did you mean 'pick-box'?"),
        (["pick-box", "--world", "pand"], "did you mean 'panda'?"),
        (["pick-box", "--advisor", "recordd"], "did you mean 'recorded'?"),
        (["pick-box", "--samples", "100000000"], "samples"),
        (
            ["pick-box", "--cfg.controller.workspace-low-m", "1", "1", "1"],
            "found [1.0, 1.0, 1.0], expected numbers below",
        ),
        (["push-pick-board", "--variant", "full", "--believe", "bord=2,0.9"], "did you mean 'board'?"),
        (["pick-box", "--advisor", "heuristic"], "the hand has no rules"),
        (["pick-box", "--variant", "expert", "--advisor", "desk"], "desk with --variant expert"),
        (["absent.yaml"], "no such file"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(words, said, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["contact", "run", *words, "--quiet"]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", [["tasks"], ["run", "--world", "hand"], ["bench", "--worlds", "hand", "--tasks"]])
def test_what_cannot_be_drawn_is_told_with_its_file_before_anything_runs(command, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    content = changed("objects.0.z", 0.0)
    Path("low.yaml").write_text(json.dumps(content), encoding="utf-8")
    assert main(["contact", *command, "low.yaml"]) == 2
    assert "low.yaml: objects[0].z: found 0, which is 0.03 m deep in the table" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["low.yaml"]


@pytest.mark.wing("coral.contact.experts")
@pytest.mark.parametrize(
    ("name", "changes", "variant", "said"),
    [
        (
            "push-pick-board",
            {"name: board": "name: slab", "object: board": "object: slab"},
            "expert-fsm",
            "board_rear_pos",
        ),
        ("push-force", {"push_force": "force"}, "expert", "push_force"),
        ("flip-wall", {"name: wall": "name: fence", "thing: wall": "thing: fence"}, "expert", "wall_pos"),
    ],
)
def test_a_copy_that_lacks_what_the_experts_read_is_told_so(name, changes, variant, said, tmp_path, capsys):
    text = (TASKS_DIR / f"{name}.yaml").read_text(encoding="utf-8")
    for old, new in changes.items():
        text = text.replace(old, new)
    (tmp_path / "copy.yaml").write_text(text, encoding="utf-8")
    out = tmp_path / "run"
    words = ["--world", "hand", "--variant", variant, "--out", str(out)]
    assert main(["contact", "run", str(tmp_path / "copy.yaml"), *words]) == 2
    assert said in capsys.readouterr().err
    assert not out.exists()


REFUSED = ["--world", "hand", "--variant", "full", *COARSE, "--advisor"]
SKIP = ["--no-preflight", "--model.max-retries", "0", "--model.format-repairs", "0", "--cfg.think.latency", "0"]


@pytest.mark.wing("coral.erring")
@pytest.mark.parametrize("advisor", ["recorded", "sloppy:malformed=0.5:recorded"])
def test_a_task_that_nobody_answered_tells_the_ways_on(tmp_path, monkeypatch, capsys, advisor):
    monkeypatch.chdir(tmp_path)
    Path("new.yaml").write_text(json.dumps(changed("name", "new-task")), encoding="utf-8")
    assert main(["contact", "run", "new.yaml", "--world", "hand", "--advisor", advisor, "--quiet"]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert all(way in error for way in ("--advisor PROVIDER:MODEL", "--advisor desk", "--cost FILE"))
    assert [path.name for path in tmp_path.iterdir()] == ["new.yaml"]


@pytest.mark.parametrize("variant", ["unified", "unguided"])
def test_a_task_that_is_recorded_for_other_variants_says_so(tmp_path, monkeypatch, capsys, variant):
    monkeypatch.chdir(tmp_path)
    assert main(["contact", "run", "open-drawer", "--variant", variant, "--quiet"]) == 1
    error = capsys.readouterr().err
    assert f"for the task 'open-drawer' with --variant {variant}, which has those of the paper's six tasks" in error
    assert "--variant full, whose answers for open-drawer are recorded" in error
    assert "remembered" not in error
    assert WAYS_ON in error
    assert list(tmp_path.iterdir()) == []


def test_poses_that_nobody_recorded_tell_where_they_are_and_the_ways_on(tmp_path, capsys):
    words = ["pick-box", "--world", "hand", "--variant", "no-tracking", "--quiet", "--out", str(tmp_path / "run")]
    assert main(["contact", "run", *words, *SKIP]) == 1
    error = capsys.readouterr().err
    assert "for the paper's six tasks with --world panda and --seed 1000 to 1009" in error
    assert WAYS_ON in error
    assert "policy" not in error


def test_the_help_of_the_hand_offers_no_rules(capsys):
    for command, flag in (("run", "advisor"), ("bench", "advisors")):
        assert main(["contact", command, "--help", flag]) == 0
        assert "heuristic" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("policy", "reason"), [("hold", "no-decision: parameters"), ("fail", "advisor failed: requeries-used-up")]
)
def test_an_episode_ends_where_nobody_may_stand_in(task, refusing, tmp_path, capsys, policy, reason):
    words = [*REFUSED, refusing, *SKIP, "--fallback", policy, "--out", str(tmp_path / "run"), "--json"]
    assert main(["contact", "run", task, *words]) == 0
    result = answer(capsys)
    assert (result["success"], result["end_reason"], result["steps"]) == (False, reason, 0)
    assert result["end_reason"].partition(":")[0] in END_REASONS
    assert result["decided"] == f"the advisor decided 0 of 1 decisions, nobody 1 ({policy})"


def test_the_keyboard_is_read_without_waiting(capsys):
    read, write = os.pipe()
    with os.fdopen(read) as stream:
        verdict = KeyboardVerdict(stream)
        assert verdict() == ""
        os.write(write, b"what?\n")
        assert verdict() == ""
        assert HINT in capsys.readouterr().err
        os.write(write, b" S \n")
        assert verdict() == "success"
        os.write(write, b"no\nf\ns\n")  # all at once
        assert verdict() == "failure"
        os.close(write)
        assert verdict() == "success"
        assert verdict() == ""
