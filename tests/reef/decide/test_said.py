"""What was said of things stays with their places."""

from coral.reef.decide.said import Said, of_place, records_of, said_by, with_said

TYRE = Said(dot=1, x=4.0, y=5.0, label="tyre", why="a black ring")


def test_a_later_word_replaces_the_label_and_what_is_ruled_out_stays_so():
    said = with_said(with_said((), TYRE), Said(dot=2, x=9.0, y=5.0, skip=True))
    said = with_said(said, Said(dot=7, x=4.5, y=5.0, skip=True))
    said = with_said(said, Said(dot=7, x=4.5, y=5.0, label="crab pot"))
    assert [(one.dot, one.label, one.skip) for one in said] == [(7, "crab pot", True), (2, "", True)]
    assert of_place(said, 4.4, 5.2) == said[0]
    assert of_place(said, 6.5, 5.0) is None
    assert [one.name for one in said] == ["crab pot, ruled out", "?, ruled out"]


def test_a_run_tells_what_had_been_said_by_a_time():
    more = (TYRE, Said(dot=2, x=9.0, y=5.0, label="net"))
    events = [
        {"event": "goal", "t": 3.0, "said": records_of([TYRE])},
        {"event": "goal", "t": 6.0},
        {"event": "held", "t": 9.0, "said": records_of(more)},
    ]
    assert said_by(events, 8.0) == [TYRE]
    assert said_by(events) == list(more)


def test_odd_records_are_left_out():
    odd = [None, {}, {"dot": 1, "x": "4", "y": 5}, {"dot": 1, "x": float("nan"), "y": 5}, {"dot": 1, "x": 4, "y": 5}]
    assert said_by([{"event": "goal", "t": 1.0, "said": odd}]) == [Said(dot=1, x=4.0, y=5.0)]
