"""The answer of a mission in words, as models write it."""

from coral.reef.decide.mission_answer import MissionAnswer


def test_lists_are_cut_and_null_means_nothing():
    answer = MissionAnswer.model_validate(
        {
            "selected_centroid_index": 3,
            "then": [1, 2, 4, 5],
            "skip": None,
            "marks": [{"dot": 1, "label": None}],
            "answer": None,
        }
    )
    assert answer.then == (1, 2, 4)
    assert answer.skip == ()
    assert answer.marks[0].label == ""
    assert not answer.end_survey


def test_done_ends_the_survey():
    assert MissionAnswer(done=True, answer="4").end_survey
