import pytest

from coral.contact.plan.stage_end import EndPart, PartReading
from coral.contact.thinker.end_evidence import collect_end
from coral.contact.thinker.progress_monitor import PlanNote

NEAR = EndPart("norm(self.off) < 0.012", "<", "m", "norm(self.off)", "0.012")
SQUARE = EndPart("square < 0.05", "<", "", "square", "0.05")
TOUCH = EndPart("self.box_left_contact", "holds", "truth", "self.box_left_contact", "0.5")
LOWER = EndPart("self.box_pos[2] < 0.5 * self.box_size[2]", "<", "m", "self.box_pos[2]", "0.5 * self.box_size[2]")
OTHER = EndPart("a or b", "holds", "?", "a or b", "0.5")
RIGHT = {NEAR: 0.012, SQUARE: 0.05, TOUCH: 0.5, LOWER: 0.03, OTHER: 0.5}


def notes(*values, stage="reach", start_s=0.0):
    """A note for each 0.1 s: the left sides of an end's parts."""
    return [
        PlanNote(start_s + 0.1 * k, stage, {}, {}, end=tuple(PartReading(part, at, RIGHT[part]) for part, at in one))
        for k, one in enumerate(values)
    ]


def resting(**parts):
    """The parts, unchanged for three seconds."""
    given = {"near": NEAR, "square": SQUARE, "touch": TOUCH, "lower": LOWER, "other": OTHER}
    return notes(*[[(given[name], value) for name, value in parts.items()]] * 30)


def test_what_does_not_hold_is_told_with_its_best_and_its_present_value():
    coming = [[(NEAR, 0.1 - 0.003 * min(k, 29)), (SQUARE, 0.01), (TOUCH, 1.0)] for k in range(40)]
    end = collect_end(notes(*coming, *[[(NEAR, 0.02), (SQUARE, 0.01), (TOUCH, 1.0)]] * 30))
    (part,) = end.unmet
    assert (part.part, part.held, part.best, part.now) == (NEAR, 0.0, pytest.approx(0.013), 0.02)
    assert (part.first_missing, part.missing) == pytest.approx((0.088, 0.008))
    assert end.sentences() == [
        "Stage 'reach' ends when `norm(self.off) < 0.012`: 0.013 m at best, 0.02 m now; the other two of its three "
        "parts hold."
    ]


def test_a_contact_is_true_or_false_and_a_bound_that_is_no_number_has_its_value():
    (told,) = collect_end(resting(touch=0.0, lower=0.031, other=0.0)).sentences()
    assert told == (
        "Stage 'reach' ends when `self.box_left_contact`, which is false now; and `self.box_pos[2] < 0.5 * "
        "self.box_size[2]`: 0.031 m at best, 0.031 m now against 0.03 m; and `a or b`, which does not hold; none of "
        "its three parts holds."
    )
    assert collect_end(resting(near=0.02)).sentences()[0].endswith("0.02 m now.")
    assert collect_end(resting(near=0.02, touch=1.0)).sentences()[0].endswith("the other of its two parts holds.")


def test_only_the_last_stage_counts_and_without_its_end_nothing_is_told():
    before = notes(*[[(SQUARE, 1.0)]] * 30, stage="before")
    end = collect_end([*before, *notes(*[[(NEAR, 0.5)]] * 30, start_s=3.0)])
    assert [part.part for part in end.parts] == [NEAR]
    unknown = collect_end([*before, PlanNote(3.0, "last", {}, {})])
    assert (unknown.stage, unknown.parts, unknown.sentences(), unknown.misses_by_little) == ("last", (), [], False)
    assert collect_end([]).parts == ()


def test_parts_that_hold_in_turn_are_told():
    turns = notes(*[[(NEAR, 0.01 * (1 + k % 2)), (SQUARE, 0.04 + 0.1 * ((k + 1) % 2 > 0))] for k in range(30)])
    end = collect_end(turns)
    assert (end.unmet, end.misses_by_little) == ((), True)
    assert end.sentences() == ["Stage 'reach' ends when two comparisons hold: each did, not all at once."]


@pytest.mark.parametrize(
    ("parts", "little"),
    [
        ({"near": 0.026}, True),
        ({"near": 0.028}, False),
        ({"near": 0.02, "square": 0.07}, True),
        ({"near": 0.02, "square": 0.5}, False),
        ({"near": 0.02, "touch": 0.0}, False),
        ({"near": 0.02, "touch": 1.0}, True),
        ({"other": 0.0}, False),
    ],
)
def test_an_end_is_missed_by_little_if_each_of_its_parts_is(parts, little):
    far = tuple(PartReading(note.part, 10.0 * note.left, note.right) for note in resting(**parts)[0].end)
    assert collect_end(resting(**parts), {"reach": far}).misses_by_little == little


def test_what_was_near_from_the_beginning_is_not_missed_by_little_unless_another_length_holds():
    assert not collect_end(resting(near=0.02)).misses_by_little
    assert collect_end(resting(near=0.02, square=0.06)).misses_by_little is False
    assert collect_end(resting(near=0.01, lower=0.031)).misses_by_little
    assert collect_end(resting(square=0.06)).misses_by_little


@pytest.mark.parametrize(
    ("parts", "only"),
    [
        ({"near": 0.01, "touch": 0.0}, True),
        ({"near": 0.01, "touch": 1.0}, False),
        ({"near": 0.1, "touch": 0.0}, False),
        ({"touch": 0.0}, False),
        ({"near": 0.01, "touch": 0.0, "square": 1.0}, False),
    ],
)
def test_only_a_contact_is_missing_where_the_lengths_hold(parts, only):
    assert collect_end(resting(**parts)).lacks_only_a_contact == only


def test_an_end_recedes_if_it_was_nearer_when_the_stage_began():
    away = collect_end(notes(*[[(NEAR, 0.1 + 0.01 * k), (SQUARE, 0.01)] for k in range(30)]))
    assert away.recedes(0.1)
    assert not away.recedes(0.3)
    still = resting(near=0.5)
    assert not collect_end(still).recedes(0.05)
    assert collect_end(still, {"reach": (PartReading(NEAR, 0.1, 0.012),)}).recedes(0.05)
    assert not collect_end(resting(near=0.5, square=1.0), {"reach": still[0].end * 2}).recedes(0.05)
