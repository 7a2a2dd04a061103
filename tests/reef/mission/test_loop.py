from coral.reef.mission.loop import MissionLoop, SimulatedTicks


class Listed:
    """A robot that writes down what it does."""

    belief = pilot = None

    def __init__(self, calls):
        self.calls = calls

    def sense(self, t):
        self.calls.append(f"senses at {t:g}")

    def localize(self, dt):
        self.calls.append(f"localizes after {dt:g}")

    def think(self):
        self.calls.append("thinks")
        return 0.0

    def act(self):
        self.calls.append("acts")


class ListedLoop(MissionLoop):
    """What stands round the loop writes down when it is called, too."""

    def __init__(self, ticks):
        self.told = []
        super().__init__(Listed(self.told), ticks)

    def located(self):
        self.told.append("located")

    def decided(self):
        self.told.append("decided")

    def commanded(self):
        self.told.append("commanded")
        return "enough" if len(self.told) > 10 else ""


class LateTicks:
    """Real time: the third tick begins late."""

    def begin(self, step):
        return ((0.0, 0.0), (0.1, 0.1), (0.25, 0.15))[step]

    def end(self, step):
        return 10.0 + step


def test_it_observes_decides_and_is_commanded():
    loop = ListedLoop(SimulatedTicks(0.1))
    loop.advance()
    assert loop.told == ["senses at 0", "localizes after 0", "located", "thinks", "decided", "acts", "commanded"]
    assert (loop.step, loop.t, loop.end_reason) == (1, 0.1, "")
    loop.advance()
    assert loop.told[7:9] == ["senses at 0.1", "localizes after 0.1"]
    assert loop.end_reason == "enough"
    assert (len(loop.tick_ms), len(loop.control_ms)) == (2, 2)


def test_in_real_time_the_ticks_say_what_time_it_is():
    loop = ListedLoop(LateTicks())
    for _ in range(3):
        loop.advance()
    assert [call for call in loop.told if "at" in call.split()] == ["senses at 0", "senses at 0.1", "senses at 0.25"]
    assert [call for call in loop.told if "localizes" in call][-1] == "localizes after 0.15"
    assert loop.t == 13.0
