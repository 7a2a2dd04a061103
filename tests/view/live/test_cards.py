from coral.view.live import cards
from coral.view.live.state import Answered, Asked, LiveState, Number


def test_words_from_outside_stay_words():
    bad = "<img src=x onerror=alert(1)>'\""
    state = LiveState(
        title=bad,
        about=bad,
        status=bad,
        numbers=(Number(name=bad, value=bad),),
        log=(bad,),
        note=bad,
        asked=Asked(title=bad, mode=bad, since_s=1.0, cause=bad),
        answered=Answered(verdict=bad, said=bad, at_s=1.0, reason=bad),
        legend=(((1, 2, 3), bad),),
    )
    for html in (cards.head(state), cards.decision(state), cards.log(state), cards.legend(state)):
        assert "<img" not in html
        assert "&lt;img" in html


def test_the_decision_card_says_since_when_and_why():
    state = LiveState(
        title="x",
        t=75.0,
        asked=Asked(title="Where to next?", mode="waypoint", since_s=63.0, attempt=1),
        answered=Answered(verdict="rejected", said="3 m ahead", at_s=62.0, reason="It leads back."),
    )
    html = cards.decision(state)
    for words in (
        "Where to next?",
        "waypoint mode, attempt 2",
        "open since 1:03, for 12 s",
        "rejected",
        "It leads back.",
    ):
        assert words in html
