import json
import os
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from coral.commands.reef_run import is_compiled
from coral.reef.drive.controller_kernels import rollout

sys.path.insert(0, str(Path(__file__).parents[1] / "reef"))

from coral.advisor.consult import DEADLINE_S
from coral.commands.reef_run import FallbackNotice, ReefRun, covered, fulfilled, share_inspected, still_left
from coral.reef.mission.metrics import OWN_MAP
from coral.reef.mission.resolution import PERSON_DEADLINE_S


def test_json_holds_the_metrics_and_where_the_run_is(survey):
    result = json.loads(survey.with_name("result.json").read_text())
    metrics = json.loads((survey / "metrics.json").read_text())
    assert {key: result[key] for key in metrics} == metrics
    assert (result["run"], result["end_reason"], result["decided"]) == (str(survey), "time limit", "")
    assert (survey / "config.yaml").is_file()
    assert not (survey / "report.html").exists()


def test_the_outcome_in_words_names_the_run_and_who_decided():
    result = {
        "clusters_covered": 1,
        "clusters_total": 8,
        "coverage": 0.125,
        "collisions": 1,
        "advisor_calls": 2,
        "requeries": 1,
        "sim_time_s": 9.0,
        "wall_time_s": 1.2,
        "end_reason": "time limit",
        "run": "runs/s1-001",
        "report": "runs/s1-001/report.html",
        "decided": "the advisor decided 1 of 2 goals, the fallback's rules 1",
    }
    assert ReefRun(world="s1").describe(result).splitlines() == [
        "s1: 1 of 8 oyster clusters covered (12 %), 1 collision, 2 advisor calls (1 re-query), 9 s simulated in 1 s "
        "(compiling counted, start and report not); "
        "ended: time limit",
        "run folder: runs/s1-001",
        "report: runs/s1-001/report.html",
        result["decided"],
    ]


def test_clusters_that_are_covered_and_not_inspected_to_the_end_are_told():
    assert still_left({"clusters_left": 1}) == ["not fully inspected, by the robot's own map: 1 cluster"]
    assert still_left({"clusters_left": 0}) == []


def test_the_share_inspected_is_told_where_it_is_known():
    assert share_inspected({"inspected": 0.876}) == "88 % of the oysters inspected from near, "
    assert share_inspected({"inspected": None}) == ""


def test_why_no_answer_was_accepted_is_told(capsys):
    notice = FallbackNotice("rules")
    refused = {"event": "verdict", "t": 4.0, "verdict": "rejected", "code": "hazard", "reason": "3 lies behind rock"}
    notice(refused)
    notice({"event": "fallback", "t": 5.0, "failure": "requeries-used-up"})
    assert "(every answer was refused, the last answer because: 3 lies behind rock)" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("policy", "then"), [("rules", "rules decide"), ("hold", "goal is kept"), ("fail", "mission ends")]
)
def test_that_the_advisor_did_not_decide_is_told_once(capsys, policy, then):
    notice = FallbackNotice(policy)
    for t in (4.0, 9.0):
        notice({"event": "trigger", "t": t})
        notice({"event": "fallback", "t": t, "failure": "deadline"})
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("at 4 s the advisor did not decide (deadline): ")
    assert then in line
    assert line.endswith(f"(--fallback {policy})")


@pytest.mark.parametrize(("advisor", "deadline_s"), [("desk", PERSON_DEADLINE_S), ("heuristic", DEADLINE_S)])
def test_a_person_gets_longer_than_a_model(tmp_path, monkeypatch, advisor, deadline_s):
    class Stop(Exception):
        pass

    def stop(self, observers):
        raise Stop(self.cfg.pilot.budget.deadline_s)

    monkeypatch.setattr("coral.commands.reef_run.Mission.run", stop)
    with pytest.raises(Stop) as seen:
        ReefRun(world="s1", advisor=advisor, out=tmp_path / "run", quiet=True)()
    assert seen.value.args == (deadline_s,)


def test_the_default_inbox_lies_in_the_run_folder(tmp_path, monkeypatch):
    """The inbox is made with the first question, so the run folder is still empty when the run opens it."""
    seen = []

    class Stop(Exception):
        pass

    def stop(self, observers):
        seen.append(self.writer.folder)
        raise Stop

    monkeypatch.setattr("coral.commands.reef_run.Mission.run", stop)
    with pytest.raises(Stop):
        ReefRun(world="s1", advisor="desk", out=tmp_path / "run", quiet=True)()
    assert seen == [tmp_path / "run"]
    (notice,) = (tmp_path / "run" / "inbox").glob("mission-*.json")
    assert json.loads(notice.read_text())["state"] == "failed"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("s1", "--live", "--live-speed", "-1", "--live-port", "0"), "--live-speed: found -1"),
        (("s1", "--variant", "ful"), "did you mean 'full'?"),
    ],
)
def test_bad_flags_are_one_line_and_leave_nothing(refused, tmp_path, monkeypatch, words, said):
    monkeypatch.chdir(tmp_path)
    assert said in refused("reef", "run", *words)
    assert list(tmp_path.iterdir()) == []


def test_the_first_mission_says_why_nothing_moves_yet(told, tmp_path, monkeypatch):
    monkeypatch.setattr("coral.commands.reef_run.is_compiled", lambda: False)
    short = ["--cfg.time-limit-s", "0.2", "--cfg.record.no-report", "--json"]
    assert "compiling once, about a minute" in told("reef", "run", "s1", *short, "--out", tmp_path / "a")[2]
    assert "compiling" not in told("reef", "run", "s1", *short, "--quiet", "--out", tmp_path / "b")[2]


@pytest.mark.parametrize("words", [("--out", "/"), ("--trigger", "nope")])
def test_a_refusal_comes_before_anything_is_compiled(refused, monkeypatch, words):
    def compile_(*_args, **_named):
        raise AssertionError

    monkeypatch.setattr("coral.commands.reef_run.is_compiled", lambda: False)
    monkeypatch.setattr("coral.reef.mission.mission.ReefSimulator", compile_)
    assert words[0] in refused("reef", "run", "s1", *words)


def test_who_does_not_judge_a_mission_in_words_is_told_beside_the_answer():
    own = {"success": None, "answer": "a net"}
    assert fulfilled(own) == ["mission not judged: words without known conditions; answer: a net"]
    at_sea = {**own, "answer": None, "judged_by": OWN_MAP}
    assert fulfilled(at_sea) == ["mission not judged: nobody judges at sea; answer: none"]


def test_a_mission_in_words_on_a_reef_without_oysters_names_none():
    assert covered({"success": True, "clusters_total": 0}) == ""
    told = covered({"clusters_covered": 2, "clusters_total": 4, "coverage": 0.5, "inspected": 0.25})
    assert told.startswith("2 of 4 oyster clusters covered (50 %), 25 % of the oysters")


def test_a_kernel_is_compiled_once_its_index_is_newer_than_its_source(tmp_path):
    source = tmp_path / "kernels.py"
    source.write_text("def add(a):\n    return a + 1\n")
    names = {}
    exec(compile(source.read_text(), str(source), "exec"), names)
    cache = tmp_path / "cache"
    cache.mkdir()
    kernel = SimpleNamespace(py_func=names["add"], _cache=SimpleNamespace(cache_path=str(cache)))
    assert not is_compiled(kernel)
    index = cache / "kernels.add-1.py311.nbi"
    index.write_bytes(b"")
    assert is_compiled(kernel)
    os.utime(index, (1.0, 1.0))
    assert not is_compiled(kernel)


def test_numba_names_its_index_so():
    line = rollout.py_func.__code__.co_firstlineno
    assert rollout._cache._cache_file._index_name.startswith(f"controller_kernels.rollout-{line}.")


def test_where_nobody_can_tell_nothing_is_said():
    assert is_compiled(lambda: None)
