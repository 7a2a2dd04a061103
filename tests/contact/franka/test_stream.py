"""The stream, tick by tick: what the arm is told, and each reason to stop it."""

import dataclasses

import numpy as np
import pytest
from arms import DOWN, TOOL, ObedientArm

from coral.contact.franka.hand_gaps import Gap
from coral.contact.franka.stream import Orders, Phase, StopCause, Stream
from coral.contact.scene.observation import HandTarget
from coral.contact.worlds.franka_cfg import FrankaCfg

CFG = FrankaCfg(bias_readings=3, wrench_filter_s=0.0)


class SeenPoses:
    """Every object was seen just now, unless `age` says otherwise."""

    age = 0.0
    tool = None
    poses = {}

    def update(self, now_s, tool):
        self.tool = tool

    def oldest(self, now_s):
        return "box", self.age


class Bench:
    """A stream with a clock of its own: 5 ms a tick."""

    def __init__(self, hand_gaps=None):
        self.arm, self.poses, self.now, self.beat = ObedientArm(), SeenPoses(), 0.0, 0
        self.stream = Stream(self.arm, self.poses, CFG, lambda: self.now, hand_gaps)

    def tick(self, times=1, alive=True, **orders):
        for _ in range(times):
            self.now += 0.005
            self.beat += alive
            self.stream.tick(Orders(self.beat, **orders))

    def following(self):
        self.tick(10, start=True)
        assert self.stream.phase is Phase.FOLLOWING
        return self


@pytest.fixture
def bench():
    return Bench()


def change(bench, **changes):
    bench.arm.state = dataclasses.replace(bench.arm.state, **changes)


def test_nothing_is_commanded_before_the_word(bench):
    bench.tick(20, target=HandTarget(TOOL, DOWN, 0.0, 600.0))
    assert bench.stream.phase is Phase.WATCHING
    assert bench.arm.calls == []


def test_a_stop_of_an_arm_that_was_only_watched_sends_nothing(bench):
    bench.tick()
    bench.tick(stop=StopCause.END)
    assert bench.stream.phase is Phase.STOPPED
    assert bench.arm.calls == []


def test_it_goes_to_the_start_measures_the_bias_and_holds(bench):
    change(bench, wrench=np.array([1.0, 2, 3, 0, 0, 0]))
    bench.following()
    assert bench.arm.calls[:2] == [("open", 0.08), "go"]
    assert bench.stream.wrench == pytest.approx(np.zeros(6))
    assert bench.arm.calls[-1].position == pytest.approx(TOOL)


def test_it_follows_targets_and_holds_the_last_one(bench):
    bench.following()
    bench.tick(target=HandTarget(np.add(TOOL, [0.01, 0, 0]), DOWN, 0.03, 500.0))
    bench.tick(3)
    assert bench.arm.calls[-1].position == pytest.approx(np.add(TOOL, [0.01, 0, 0]))
    assert bench.arm.calls[-1].stiffness == 500.0
    assert ("open", 0.03) in bench.arm.calls


@pytest.mark.parametrize("cause", [StopCause.PAGE, StopCause.KEYBOARD, StopCause.END])
def test_a_request_stops_at_the_next_tick(bench, cause):
    bench.following().tick(stop=cause)
    assert bench.stream.cause is cause
    assert bench.arm.calls[-1] == "stop"


def test_a_contact_force_beyond_the_limit_stops(bench):
    bench.following()
    change(bench, wrench=np.array([0, 0, 60.0, 0, 0, 0]))
    bench.tick()
    assert bench.stream.cause is StopCause.LIMIT
    assert "60 N" in bench.stream.reason
    assert bench.arm.calls[-1] == "stop"


def test_what_carries_a_held_object_is_the_tool_in_the_world(bench):
    bench.following()
    state = bench.stream.state
    assert bench.poses.tool.position == pytest.approx(state.position + np.array(CFG.base_m))
    assert bench.poses.tool.quaternion == pytest.approx(state.quaternion)


class NarrowGap:
    """A gap to something below, wherever the hand is."""

    asked = None

    def gaps(self, tool, opening_m, objects, within_m):
        self.asked = tool, within_m
        return [Gap(np.array([0.0, 0.0, -1.0]), 0.0, np.zeros(3))]


def test_towards_what_is_near_it_pulls_gently_and_not_after_a_blow():
    bench = Bench(hand_gaps := NarrowGap()).following()
    below = HandTarget(np.add(TOOL, [0.0, 0.0, -0.2]), DOWN, 0.08, 600.0)
    bench.tick(target=below)
    assert hand_gaps.asked[0].position == pytest.approx(bench.stream.state.position + np.array(CFG.base_m))
    gently = TOOL[2] - bench.arm.calls[-1].position[2]
    assert 0.0 < gently < 0.5 * CFG.limits.push_n / 600.0
    change(bench, wrench=np.array([0.0, 0.0, 30.0, 0.0, 0.0, 0.0]))
    before = bench.arm.state.position[2]
    bench.tick()
    assert before - bench.arm.calls[-1].position[2] < gently + 3.0 / 600.0


def test_lost_poses_stop(bench):
    bench.following()
    bench.poses.age = CFG.poses_timeout_s + 0.01
    bench.tick()
    assert bench.stream.cause is StopCause.POSES
    assert "box was not seen" in bench.stream.reason


def test_a_clock_that_stands_still_is_a_lost_link(bench):
    bench.following()
    bench.arm.frozen = True
    bench.tick(5)
    assert bench.stream.phase is Phase.FOLLOWING
    bench.tick(3)
    assert bench.stream.cause is StopCause.LINK


def test_an_arm_that_cannot_be_read_is_a_lost_link(bench):
    bench.following()
    bench.arm.dead = True
    bench.tick()
    assert bench.stream.cause is StopCause.LINK


def test_a_silent_program_stops(bench):
    bench.following()
    bench.tick(59, alive=False)
    assert bench.stream.phase is Phase.FOLLOWING
    bench.tick(3, alive=False)
    assert bench.stream.cause is StopCause.WATCHDOG


def test_a_reflex_and_a_refusal_stop(bench):
    bench.following()
    change(bench, fault="the arm is in the mode Reflex")
    bench.tick()
    assert (bench.stream.cause, bench.stream.reason) == (StopCause.FAULT, "the arm is in the mode Reflex")
    other = Bench().following()
    other.arm.refuses = True
    other.tick()
    assert (other.stream.cause, other.stream.reason) == (StopCause.FAULT, "control has ended")


def test_a_stopped_arm_gets_no_further_command(bench):
    bench.following().tick(stop=StopCause.PAGE)
    said = len(bench.arm.calls)
    bench.tick(5, start=True, target=HandTarget(TOOL, DOWN, 0.08, 600.0))
    assert len(bench.arm.calls) == said
    assert bench.stream.cause is StopCause.PAGE
