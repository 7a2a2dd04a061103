"""The score of the memory's retrieval."""

from dataclasses import replace

from coral.contact.episode.retrieval_bench import RetrievalResult, retrieve_cases, score_retrieval
from coral.contact.episode.retrieval_cases import REMEMBERED, RetrievalCase, load_retrieval_cases
from coral.contact.scene.task_file import load_task_file


def test_a_remembered_task_as_it_was_is_found():
    task = load_task_file("pick-box")
    (found,) = retrieve_cases([RetrievalCase("development", "words", "pick-box", task, ("pick-box",))])
    assert (found.found, found.right, found.wrong_offer) == ("pick-box", True, False)


def result(fits, found, change="words"):
    case = replace(load_retrieval_cases("development")[0], fits=fits, change=change)
    return RetrievalResult(case, found, 0.5)


def test_right_and_wrong_offers_are_counted():
    results = [
        result(("pick-box",), "pick-box"),
        result(("pick-box",), "none"),
        result(("pick-box",), "flip-box"),
        result(("none",), "none", "other"),
        result(("none",), "flip-box", "other"),
        result(("none", "flip-box"), "flip-box", "other"),
    ]
    assert score_retrieval(results) == {
        "words": {"cases": 3, "right": 1, "wrong_offers": 1},
        "other": {"cases": 3, "right": 2, "wrong_offers": 1},
        "found": {"cases": 3, "right": 1, "wrong_offers": 1},
    }


def test_names_of_remembered_tasks_are_names_of_tasks():
    assert [load_task_file(name).name for name in REMEMBERED] == list(REMEMBERED)
