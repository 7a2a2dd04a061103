from coral.reef.mission.loop import MissionLoop, SimulatedTicks


class Listed:
    """A robot, and what stands round the loop: both write down when they are called."""

    def __init__(self, calls, name):
        self.calls, self.name = calls, name

    def sense(self, t):
        self.calls.append(f"{self.name} senses at {t:g}")

    def localize(self, dt):
        self.calls.append(f"{self.name} localizes after {dt:g}")

    def think(self):
        self.calls.append(f"{self.name} thinks")
        return 0.0

    def act(self):
        self.calls.append(f"{self.name} acts")

    def located(self):
        self.calls.append("located")

    def decided(self):
        self.calls.append("decided")

    def commanded(self):
        self.calls.append("commanded")
        return "enough" if len(self.calls) > 10 else ""


class LateTicks:
    """Real time: the third tick begins late."""

    def begin(self, step):
        return ((0.0, 0.0), (0.1, 0.1), (0.25, 0.15))[step]

    def end(self, step):
        return 10.0 + step


def test_it_observes_decides_and_is_commanded():
    calls = []
    loop = MissionLoop(Listed(calls, "it"), SimulatedTicks(0.1), Listed(calls, "hooks"))
    loop.advance()
    assert calls == [
        "it senses at 0",
        "it localizes after 0",
        "located",
        "it thinks",
        "decided",
        "it acts",
        "commanded",
    ]
    assert (loop.step, loop.t, loop.end_reason) == (1, 0.1, "")
    loop.advance()
    assert calls[7:9] == ["it senses at 0.1", "it localizes after 0.1"]
    assert loop.end_reason == "enough"
    assert (len(loop.tick_ms), len(loop.control_ms)) == (2, 2)


def test_in_real_time_the_ticks_say_what_time_it_is():
    calls = []
    loop = MissionLoop(Listed(calls, "a"), LateTicks(), Listed(calls, "hooks"))
    for _ in range(3):
        loop.advance()
    assert [call for call in calls if "senses" in call] == ["a senses at 0", "a senses at 0.1", "a senses at 0.25"]
    assert [call for call in calls if "localizes" in call][-1] == "a localizes after 0.15"
    assert loop.t == 13.0
