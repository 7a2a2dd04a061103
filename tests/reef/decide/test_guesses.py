import pytest
from beds import bed, belief_with

from coral.reef.decide.guesses import Guess, GuessRecord


def guess(x, y, **more):
    return Guess(x=x, y=y, what="the line goes on", sure=0.8, **more)


def test_a_guess_comes_out_when_the_robot_has_looked():
    belief = belief_with([(4.0, 4.0)])
    belief.map.explored[:, 200:] = False
    record = GuessRecord().with_guess(guess(15.0, 10.0), belief)
    record, out = record.settled(belief)
    assert (record.right, record.wrong, out) == (0, 0, [])
    belief.map.explored[:] = True
    assert record.settled(belief)[1][0].hit is False
    belief.tracker.update([bed(4.0, 4.0), bed(14.2, 11.0)])
    record, out = record.settled(belief)
    assert (record.right, record.wrong, out[0].hit) == (1, 0, True)
    assert record.settled(belief)[1] == []  # told once


def test_what_is_known_is_no_guess_and_the_same_counts_once():
    belief = belief_with([(4.0, 4.0)])
    belief.map.explored[:, 200:] = False
    record = GuessRecord().with_guess(guess(5.0, 4.5), belief)
    assert record.guesses == ()
    record = record.with_guess(guess(15.0, 10.0), belief).with_guess(guess(15.5, 10.0), belief)
    assert len(record.guesses) == 1


def test_the_record_sets_what_the_next_guess_may_cost():
    def allowed(right, wrong, sure=1.0):
        made = [guess(0.0, 0.0, hit=True)] * right + [guess(0.0, 0.0, hit=False)] * wrong
        return GuessRecord(tuple(made)).allowance_s(sure)

    assert allowed(0, 0) == pytest.approx(30.0)
    assert allowed(0, 0, sure=0.5) == pytest.approx(15.0)
    assert allowed(0, 4) == pytest.approx(10.0)
    assert allowed(4, 0) == pytest.approx(50.0)
