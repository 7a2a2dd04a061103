"""An episode's world over a stream: steps take the arm's time, frames are converted, a stop ends the episode."""

import dataclasses

import numpy as np
import pytest
from arms import DOWN, TOOL, arm_state

from coral.contact.franka.stream import Phase, StopCause, StreamReport
from coral.contact.franka.world import CODES, FrankaDoubleWorld, FrankaWorld
from coral.contact.scene.observation import BodyState, HandTarget, Truth
from coral.contact.worlds.evaluation_world import EvaluationWorld, TruthfulWorld
from coral.contact.worlds.franka_cfg import FrankaCfg
from coral.contact.worlds.robot_world import WorldError, in_real_time
from coral.errors import RunError

BOX = BodyState(np.array([0.1, 0.0, 0.03]), np.array([1.0, 0, 0, 0]))
REPORT = StreamReport(
    state=arm_state(7.0),
    tool=BodyState(np.subtract(TOOL, [0.5, 0, 0]), DOWN),
    objects={"box": BOX},
    ages_s={"box": 0.0},
)


def at(report, time_s):
    return dataclasses.replace(report, state=dataclasses.replace(report.state, time_s=time_s))


class FakeStream:
    """Its clock goes on by 5 ms at every report; targets are kept."""

    def __init__(self):
        self.now, self.targets, self.stops, self.closed, self.dead = REPORT, [], [], False, False

    def start(self):
        self.now = dataclasses.replace(self.now, phase=Phase.FOLLOWING)

    def follow(self, target):
        self.targets.append(target)

    def stop(self, cause):
        self.stops.append(cause)

    def report(self):
        if self.dead:
            raise RunError("the stream to the arm has ended")
        self.now = at(self.now, self.now.time_s + 0.005)
        return self.now

    def reason(self):
        return "as somebody wished"

    def close(self):
        self.closed = True


def make(**changes):
    stream = FakeStream()
    return stream, FrankaWorld(stream, FrankaCfg(), 0.02, ("box",), sleep=lambda seconds: None, **changes)


HAND = HandTarget(np.array([0.0, 0.1, 0.2]), DOWN, 0.05, 600.0)


def test_poses_are_in_the_world_frame_and_targets_in_the_arms():
    stream, world = make()
    first = world.reset()
    assert first.time_s == 0.0
    assert first.tool.position == pytest.approx(np.subtract(TOOL, [0.5, 0, 0]))
    assert first.objects["box"] is BOX
    world.step(HAND)
    assert stream.targets[0].position == pytest.approx([0.5, 0.1, 0.2])


def test_a_step_lasts_one_period_of_the_arms_clock():
    stream, world = make()
    world.reset()
    times = [world.step(HAND).time_s for _ in range(5)]
    assert np.diff(times) == pytest.approx(np.full(4, 0.02))
    stream.now = at(stream.now, stream.now.time_s + 3.0)  # the program thought for 3 s
    after = [world.step(HAND).time_s for _ in range(3)]
    assert after[0] - times[-1] > 3.0
    assert np.diff(after) == pytest.approx(np.full(2, 0.02), abs=0.0051)  # the fake clock has steps of 5 ms


def test_no_two_steps_have_the_same_time_where_states_come_seldom():
    stream, world = make()
    world.reset()
    told = stream.report

    def seldom():
        now = told()
        return at(now, 0.06 * (now.time_s // 0.06))

    stream.report = seldom
    times = [world.step(HAND).time_s for _ in range(6)]
    assert np.diff(times).min() > 0.05


@pytest.mark.parametrize("cause", [cause for cause in StopCause if cause is not StopCause.NONE])
def test_a_stop_ends_the_episode_with_its_name(cause):
    stream, world = make()
    world.reset()
    stream.now = dataclasses.replace(stream.now, phase=Phase.STOPPED, cause=cause)
    with pytest.raises(WorldError, match="as somebody wished") as caught:
        world.step(HAND)
    assert caught.value.code == CODES[cause]


def test_an_object_without_a_pose_is_not_guessed():
    stream, world = make()
    stream.now = dataclasses.replace(stream.now, objects={}, ages_s={})
    with pytest.raises(WorldError, match="no pose of box") as caught:
        world.reset()
    assert caught.value.code == "not-found"


def test_a_stream_that_died_is_a_lost_link():
    stream, world = make()
    world.reset()
    stream.dead = True
    with pytest.raises(WorldError, match="has ended") as caught:
        world.step(HAND)
    assert caught.value.code == "link-lost"


def test_an_arm_whose_clock_stands_still_is_stopped():
    stream, world = make()
    world.reset()
    stream.report = lambda: stream.now
    with pytest.raises(WorldError, match="stood still"):
        world.step(HAND)
    assert stream.stops == [StopCause.LINK]


def test_a_dry_run_shows_commands_and_sends_none():
    lines = []
    stream, world = make(dry_run=True, show=lines.append)
    world.reset()
    for _ in range(12):
        world.step(HAND)
    assert stream.now.phase is Phase.WATCHING
    assert stream.targets == []
    assert len(lines) == 2
    assert "tool to +0.000 +0.100 +0.200 m, opening 50 mm, 600 N/m (not sent)" in lines[0]


def test_stop_and_close_reach_the_stream():
    stream, world = make()
    world.stop()
    world.close()
    assert stream.stops == [StopCause.END]
    assert stream.closed


def test_only_the_simulated_arm_has_a_truth_and_neither_has_a_simulation():
    class Double:
        def truth(self):
            return Truth(99.0, REPORT.tool, 0.0, {"box": BOX}, ())

        def close(self):
            pass

    stream, world = make()
    simulated = FrankaDoubleWorld(stream, FrankaCfg(), 0.02, ("box",), double=Double(), sleep=lambda seconds: None)
    simulated.reset()
    assert not isinstance(world, TruthfulWorld)
    assert isinstance(simulated, TruthfulWorld)
    assert not isinstance(simulated, EvaluationWorld)
    assert simulated.truth().time_s == 0.0
    assert simulated.step(HAND).time_s == simulated.truth().time_s > 0.0
    assert in_real_time(world)


class Camera:
    def __init__(self):
        self.told, self.closed = [], False

    def tell_hand(self, hand):
        self.told.append(hand)

    def failure(self):
        return "unplugged"

    def close(self):
        self.closed = True


def test_the_camera_is_told_of_the_hand_in_the_world_and_ends_with_the_stream():
    camera = Camera()
    stream, world = make(camera=camera)
    world.reset()
    world.step(HAND)
    (told,) = camera.told
    assert told.T_world_tool[:3, 3] == pytest.approx(np.subtract(TOOL, [0.5, 0, 0]))
    assert (told.opening_m, told.wanted_m) == (0.08, 0.05)
    stream.now = dataclasses.replace(stream.now, phase=Phase.STOPPED, cause=StopCause.POSES)
    with pytest.raises(WorldError, match="as somebody wished: unplugged"):
        world.step(HAND)
    world.close()
    assert stream.closed
    assert camera.closed
