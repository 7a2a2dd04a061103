"""Where a tick's time went."""

from coral.reef.sea.stages import StageTimes


def test_stages_add_up_and_tell_what_was_computed():
    times, used = iter([10.0, 10.01, 10.05, 10.06]), iter([1.0, 1.02])
    stages = StageTimes(lambda: next(times), lambda: next(used))
    stages.begin(woken=0.002)
    for name in ("report", "pilot", "report"):
        stages.mark(name)
    assert stages.told_ms() == {"woken_ms": 2.0, "report_ms": 20.0, "pilot_ms": 40.0, "computed_ms": 20.0}


def test_a_tick_forgets_the_one_before():
    stages = StageTimes(lambda: 0.0, lambda: 0.0)
    stages.begin(page_before=1.0)
    stages.begin()
    assert stages.told_ms() == {"computed_ms": 0.0}
