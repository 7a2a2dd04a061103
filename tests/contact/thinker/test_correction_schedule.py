from histories import history, sliding

from coral.contact.thinker.correction import CorrectionSchedule

MOVED = history(100, period_s=0.1, box=sliding(1.0))
"""Ten seconds in which the box slides."""
STILL = (0.0, 0.0, 0.03)


def due_times(schedule, steps):
    """Simulated times at which a correction is due, asked after every step."""
    return [round(steps[k - 1].after.time_s, 6) for k in range(1, len(steps) + 1) if schedule.due(steps[:k])]


def test_a_correction_is_due_at_each_interval_until_all_but_the_last_are_spent():
    assert due_times(CorrectionSchedule(every_s=2.0, most=4), MOVED) == [2.0, 4.0, 6.0]


def test_the_last_one_is_kept_for_the_end_of_the_episode():
    schedule = CorrectionSchedule(every_s=2.0, most=1)
    assert due_times(schedule, MOVED) == []
    assert schedule.due(MOVED, last=True) == "box"
    assert schedule.done == 1
    assert schedule.due(MOVED, last=True) is None


def test_at_the_end_no_interval_is_waited_for():
    assert CorrectionSchedule(every_s=60.0, most=5).due(MOVED, last=True) == "box"


def test_without_an_interval_or_a_history_nothing_is_due():
    assert CorrectionSchedule(every_s=0.0, most=5).due(MOVED, last=True) is None
    assert CorrectionSchedule(every_s=2.0, most=5).due([], last=True) is None


def test_an_interval_without_touch_is_not_counted_and_the_next_touch_is_corrected_at_once():
    def later(k):
        return (0.001 * max(0, k - 52), 0.0, 0.03)

    schedule = CorrectionSchedule(every_s=2.0, most=9)
    # 4 mm have been gone at step 56
    assert due_times(schedule, history(60, period_s=0.1, box=later)) == [5.6]
    assert schedule.done == 1


def test_each_correction_is_of_what_was_moved_since_the_one_before():
    def box(k):
        return (0.002 * min(k, 20), 0.0, 0.03)

    def cup(k):
        return (0.5, 0.001 * max(0, k - 20), 0.03)

    schedule = CorrectionSchedule(every_s=2.0, most=9)
    steps = history(40, period_s=0.1, box=box, cup=cup)
    assert [schedule.due(steps[:k]) for k in (20, 40)] == ["box", "cup"]
