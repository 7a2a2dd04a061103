import json

import numpy as np
import pytest
from recorded import RULES

from coral.advisor.rules import RuleAdvisor
from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.planning_world import PlanningCfg
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.episode.variants import AdvisorSetup, make_strategist
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.progress_monitor import OuterCfg
from coral.contact.thinker.think_cfg import ThinkCfg
from coral.erring.sloppy import Rates, SloppyAdvisor
from coral.mppi.knots import KnotMppiCfg
from coral.view.contact.report import write_contact_report
from coral.view.contact.thought import answers, counted, seen, thoughts
from coral.view.run import RunFolder

COARSE = EpisodeCfg(
    poses="ground-truth",
    planning=PlanningCfg(threads=1),
    think=ThinkCfg(outer=OuterCfg(n_retry=2, attempt_s=0.1, refinements=1, progress=0.9)),
    controller=ControllerCfg(horizon=8, mppi=KnotMppiCfg(samples=6, knots=3)),
)


@pytest.fixture(scope="module")
def spoilt(tmp_path_factory):
    """A second of a run whose advisor errs every other time, stuck once."""
    folder = tmp_path_factory.mktemp("thought") / "run"
    task = load_task("pick-box").model_copy(update={"time_limit_s": 1.0})
    advisor = SloppyAdvisor(RuleAdvisor(RULES), Rates(each={"malformed": 0.5}), np.random.default_rng([1, 2]), ())
    setup = AdvisorSetup(advisor=advisor.name, given=advisor, seed=1, folder=folder, think=COARSE.think)
    strategist = make_strategist("full", task, setup)
    Episode(sample_trial(task, 1), "hand", strategist, COARSE, folder, variant="full", advisor=advisor.name).run()
    return RunFolder.read(folder)


def told(tmp_path, *events):
    """A run with these events alone."""
    lines = [{"step": 0, "t": 0.0, "event": "start"}, *({"step": 5, "t": 0.1, **event} for event in events)]
    (tmp_path / "events.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    return RunFolder.read(tmp_path)


def test_thoughts_stand_in_order_under_the_moment_they_were_had(spoilt):
    found = thoughts(spoilt)
    assert [thought.title for thought in found] == ["At the start", "Stuck: the outer loop asks again"]
    assert [part.title for part in found[0].parts][:1] == ["Masses and frictions"]
    diagnosis = next(part for part in found[1].parts if part.title.startswith("Diagnosis: "))
    assert diagnosis.rows[0][0] == "time (s)"


def test_every_answer_is_there_and_each_spoilt_one_is_named(spoilt):
    given = answers(spoilt)
    assert len(given) == len(spoilt.attempts)
    named = [one for one in given if one.spoilt]
    assert named
    assert all(one.reason for one in given if one.verdict != "accepted")
    assert f"{len(named)} answers were spoilt on purpose" in counted(given)


def test_the_page_shows_thoughts_reasons_and_what_the_advisor_saw(spoilt):
    page = write_contact_report(spoilt.path).read_text()
    assert "Reasoning" in page
    assert "Stuck: the outer loop asks again" in page
    assert 'class="spoilt"' in page
    assert ">asked again<" in page
    assert seen(spoilt) in page
    assert "http" not in page.replace("http://www.w3.org", "")


def test_a_correction_says_how_well_the_history_fits(tmp_path):
    run = told(
        tmp_path,
        {"event": "stuck", "diagnosis": "not-moved", "text": "it hardly moved", "object": "box"},
        {
            "event": "correction",
            "object": "box",
            "accepted": True,
            "text": "box: lighter",
            "errors": [0.8, 0.3],
            "before": [2.0, 0.9],
            "after": [0.1, 0.5],
            "refused": ["too heavy"],
        },
    )
    part = thoughts(run)[0].parts[1]
    assert part.title == "World model of the box: corrected"
    assert part.chips == ("mass 2 → 0.1 kg", "friction 0.9 → 0.5", "replay error over all windows 0.80 → 0.30")
    assert part.refused == ("too heavy",)


@pytest.mark.parametrize(
    ("event", "title", "said"),
    [
        (
            {
                "event": "recall",
                "id": 3,
                "similarity": 0.9,
                "distance": 0.2,
                "rehearsed_s": 11.6,
                "outcome": {"succeeded": False, "stages": 0.5, "conditions": 0.25, "spare_s": 1.0},
                "refused": "",
            },
            "Memory 3 was used",
            "in an imagined run for 12 s it came through 50 % of its stages",
        ),
        (
            {"event": "recall", "id": 3, "similarity": 0.9, "distance": 0.2, "refused": "off the surface"},
            "Memory 3 was not used",
            "similar by 0.90",
        ),
        (
            {"event": "fallback", "what": "plan", "by": "heuristic", "because": "requeries-used-up"},
            "The fallback decided: heuristic",
            "no answer passed the checks",
        ),
        (
            {"event": "poses", "attempts": 2, "box": [0.1, 0.0, 0.03, 1, 0, 0, 0], "refused": ["off the table"]},
            "Estimated object poses, used from now on",
            "Accepted at attempt 2",
        ),
        (
            {
                "event": "candidates",
                "regions": [{"object": "box", "stage": "push", "kept": 3, "lost": {"inside wall": 2}}],
            },
            "Some points cannot be touched",
            "3 of 5 are left on the box for push; 2 inside wall.",
        ),
    ],
)
def test_each_kind_of_event_is_told_in_words(tmp_path, event, title, said):
    part = thoughts(told(tmp_path, event))[0].parts[0]
    assert part.title == title
    assert said in part.text


def test_a_run_without_an_advisor_has_no_thoughts(tmp_path):
    assert thoughts(told(tmp_path, {"event": "strategy", "name": "expert", "stages": ["all"]})) == []


def test_a_run_that_never_began_has_a_page_that_says_why(tmp_path):
    folder = tmp_path / "run"
    odd = load_task("pick-box").model_copy(update={"name": "nobody-answered"})
    strategist = make_strategist("full", odd, AdvisorSetup(folder=folder))
    episode = Episode(sample_trial(odd, 0), "hand", strategist, COARSE, folder, variant="full", advisor="recorded")
    assert episode.run()["steps"] == 0
    page = write_contact_report(folder).read_text()
    ended = (
        "Ended at the start: no answer of the advisor contained a usable plan (the advisor gave no plan (not-recorded))"
    )
    assert ended in page
