"""Episodes that somebody else thinks for: a new task file, a person at the desk, a recording."""

import dataclasses
import json
import os
import threading

import pytest
import yaml
from episodes import ANSWERS, COARSE, SLIDE
from recorded import one_by_one

from coral.advisor.question import Picture
from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.planning_world import PlanningCfg
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.episode.variants import AdvisorSetup, make_strategist
from coral.contact.scene.task_names import shipped_tasks
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.mppi.knots import KnotMppiCfg

FAST = EpisodeCfg(
    poses="ground-truth",
    planning=PlanningCfg(threads=1),
    controller=ControllerCfg(horizon=25, mppi=KnotMppiCfg(samples=16)),
)


@pytest.fixture
def task(tmp_path):
    """A task of one's own, from its file."""
    path = tmp_path / "slide.yaml"
    path.write_text(yaml.safe_dump(SLIDE))
    return load_task(path)


def attempted(task, folder, advisor="written", cfg=FAST, **more):
    more |= {"given": one_by_one(ANSWERS)} if advisor == "written" else {}
    strategist = make_strategist("full", task, AdvisorSetup(advisor=advisor, folder=folder, think=cfg.think, **more))
    return Episode(sample_trial(task, 0), "hand", strategist, cfg, folder, variant="full", advisor=advisor).run()


@pytest.fixture
def person(tmp_path):
    """Answers whatever is put into the inbox, and remembers the questions."""
    inbox, done, heard = tmp_path / "inbox", threading.Event(), {}

    def answer():
        while not done.wait(0.005):
            for folder in sorted(inbox.glob("[0-9]*")) if inbox.is_dir() else ():
                if folder.name not in heard:
                    question = json.loads((folder / "question.json").read_text())
                    heard[folder.name] = question
                    (folder / "answer.part").write_text(json.dumps(ANSWERS[question["kind"]]))
                    os.replace(folder / "answer.part", folder / "answer.json")

    thread = threading.Thread(target=answer)
    thread.start()
    yield inbox, heard
    done.set()
    thread.join()


def test_a_task_that_nobody_here_wrote_runs_from_its_file_alone(task, tmp_path):
    assert task.name not in shipped_tasks()
    result = attempted(task, tmp_path / "run")
    assert (result["success"], result["advisor_calls"], result["repairs"]) == (True, 3, 0)


def test_the_world_goes_on_while_an_advisor_repairs_and_only_counts_the_time_before_the_first_plan(task, tmp_path):
    hasty = dataclasses.replace(FAST.think.outer, n_retry=1, refinements=1, progress=1.0, progress_m=1.0)
    think = dataclasses.replace(COARSE.think, latency="fixed:0.5", outer=hasty)
    brief = task.model_copy(update={"time_limit_s": 0.6})
    result = attempted(brief, tmp_path / "run", cfg=dataclasses.replace(COARSE, think=think))
    lines = [json.loads(line) for line in (tmp_path / "run" / "events.jsonl").open()]
    passed = [event for event in lines if event["event"] == "thinking"]
    assert [event["seconds"] for event in passed if event["meanwhile"] == "before"] == [0.5] * 3
    within = sum(event["seconds"] for event in passed if event["meanwhile"] != "before")
    assert within == pytest.approx(0.5 * (len(passed) - 3), abs=0.021 * len(passed))
    assert within > 0.4
    assert result["sim_time_s"] <= 0.621
    assert result["time_with_thinking_s"] == pytest.approx(result["sim_time_s"] + within + 1.5, abs=1e-6)
    assert result["thinking_s"] == pytest.approx(within + 1.5, abs=1e-3)
    assert {event["meanwhile"] for event in passed} == {"before", "the last plan"}


def test_without_latency_the_same_episode_has_no_thinking_in_it(task, tmp_path):
    brief = task.model_copy(update={"time_limit_s": 0.2})
    result = attempted(brief, tmp_path / "run")
    assert result["time_with_thinking_s"] == result["sim_time_s"] == 0.2
    assert result["thinking_s"] == 0.0
    assert '"thinking"' not in (tmp_path / "run" / "events.jsonl").read_text()


def test_a_task_that_nobody_answered_has_no_strategy_and_no_traceback(task, tmp_path):
    result = attempted(task, tmp_path / "run", "recorded")
    assert (result["end_reason"], result["steps"]) == ("no-strategy", 0)
    end = json.loads((tmp_path / "run" / "events.jsonl").read_text().splitlines()[-1])
    assert end["detail"] == "the advisor gave no plan (not-recorded)"


def test_a_cost_that_a_person_writes_at_the_desk_drives_a_task(task, tmp_path, person):
    inbox, heard = person
    result = attempted(task, tmp_path / "run", "desk", inbox=inbox)
    assert result["success"]
    assert [question["kind"] for question in heard.values()] == list(ANSWERS)
    plans = [json.loads(line) for line in (tmp_path / "run" / "events.jsonl").open()]
    assert {tuple(event["terms"]) for event in plans if event["event"] == "plan"} == {
        ("be behind the crate", "crate at the mark", "stay upright")
    }


def test_whoever_sits_at_the_desk_sees_what_the_camera_sees(task, tmp_path, person):
    inbox, heard = person
    attempted(task.model_copy(update={"time_limit_s": 0.04}), tmp_path / "run", "desk", inbox=inbox)
    shown = {question["kind"]: question["images"] for question in heard.values()}
    assert shown == {
        "physical-parameters": ["scene.png"],
        "cost-function": ["scene.png", "above.png"],
        "contact-regions": ["scene.png", "above.png"],
    }
    first = next(folder for folder, question in heard.items() if question["images"])
    data = (inbox / first / "scene.png").read_bytes()
    kept = {path.stem for path in (tmp_path / "run" / "pictures").iterdir()}
    assert Picture(name="scene", png=data).digest in kept


def test_a_recording_replays_byte_for_byte(task, tmp_path):
    short = dataclasses.replace(COARSE, poses="tracked")
    brief = task.model_copy(update={"time_limit_s": 0.2})
    first, second = tmp_path / "first", tmp_path / "second"
    attempted(brief, first, cfg=short)
    attempted(brief, second, f"replay:{first}", cfg=short)
    for name in ("trajectory.csv", "states.csv"):
        assert (first / name).read_bytes() == (second / name).read_bytes()
    metrics = [json.loads((folder / "metrics.json").read_text()) for folder in (first, second)]
    assert [one.pop("decided_by") for one in metrics] == [
        {"advisor": 3, "memory": 0, "recording": 0, "fallback": 0},
        {"advisor": 0, "memory": 0, "recording": 3, "fallback": 0},
    ]
    assert metrics[0] == metrics[1]
    events = [
        [
            line.replace('"source": "recording"', '"source": "advisor"')
            for line in (folder / "events.jsonl").open()
            if '"start"' not in line
        ]
        for folder in (first, second)
    ]
    assert events[0] == events[1]
    assert any((second / "pictures").iterdir())
    asked = [[json.loads(line) for line in (folder / "attempts.jsonl").open()] for folder in (first, second)]
    assert [one["pictures"] for one in asked[0]] == [one["pictures"] for one in asked[1]]
