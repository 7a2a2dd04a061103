"""Questions without an acceptable choice and answers that came too late, by variant."""

from coral.campaign.question_table import question_table


def mission(**found):
    return {"world": "l1", "seed": 0, "advisor_calls": 10, "unanswerable": 0, "idle_fraction": 0.1, **found}


def rows_of(by_variant):
    found = question_table(by_variant, str.upper, "Who.", ("From where.",))
    return [dict(zip(found.header, row, strict=True)) for row in found.rows]


def test_counts_are_sums_and_shares_are_of_the_answers():
    answers = {"accepted": 7, "refused": 3}
    one = mission(answers=answers, refused_late=1, overtaken=0, unanswerable=2)
    two = mission(answers=answers, seed=1, refused_late=0, overtaken=2, idle_fraction=0.3)
    (row,) = rows_of({"full": [one, two]})
    assert (row["questions"], row["without an acceptable choice"], row["answers"]) == ("20", "2", "20")
    assert (row["refused (%)"], row["refused late, at most (%)"], row["overtaken (%)"]) == ("30.0", "5.0", "10.0")
    assert row["standing still (%)"] == "20.0"


def test_variants_that_ask_nothing_have_no_row():
    assert rows_of({"blind-sweep": [mission(advisor_calls=0)], "old": [mission(unanswerable=None)]}) == []


def test_without_an_answer_there_is_no_share():
    (row,) = rows_of({"full": [mission(answers={})]})
    assert row["refused (%)"] == "—"
