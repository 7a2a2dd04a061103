from dataclasses import replace

import pytest

from coral.reef.sea.link import LinkRefused, VehicleReport
from coral.reef.sea.operator import VehicleOrders
from coral.reef.sea.safety import SafetyCfg, SafetyMonitor
from coral.reef.sea.supervisor import Supervisor
from coral.reef.sea.survey_file import SurveyArea
from coral.reef.vehicle.states import Mover, PilotState, StateMachine
from coral.reef.world.geometry import Pose

AREA = SurveyArea("tank", (20.0, 10.0), Pose(2.0, 5.0, 0.0), ((0, 0), (20, 0), (20, 10), (0, 10)))
HERE = Pose(5.0, 5.0, 0.0)


class Link:
    def __init__(self):
        self.done, self.refuse = [], set()

    def _do(self, order):
        if order in self.refuse:
            raise LinkRefused(f"{order} denied")
        self.done.append(order)

    def arm(self):
        self._do("arm")

    def hold(self):
        self._do("hold")

    def surface(self):
        self._do("surface")

    def disarm(self):
        self._do("disarm")


class Bench:
    """A supervisor in its loop, with a vehicle whose report is set by hand."""

    def __init__(self, **cfg):
        self.link, self.events, self.homeward = Link(), [], 0
        self.states = StateMachine()
        self.states.move(0.0, Mover.GUARD, "sensors good")
        self.safety = SafetyMonitor(SafetyCfg(**cfg), AREA, 600.0)
        self.supervisor = Supervisor(
            self.states,
            VehicleOrders(self.link, threaded=False),
            self.safety,
            lambda event, **fields: self.events.append((event, fields)),
            self.go_home,
        )
        self.t = 0.0

    def go_home(self):
        self.homeward += 1

    def tick(self, *words, seconds=0.1, pose=HERE, **report):
        for _ in range(max(1, round(seconds / 0.1))):
            self.t = round(self.t + 0.1, 9)
            fine = VehicleReport(
                pose=pose,
                pose_stamp_s=self.t,
                has_position=True,
                attitude_stamp_s=self.t,
                depth_m=1.0,
                heartbeat_age_s=0.1,
                armed=True,
                mode="GUIDED",
                battery_fraction=0.9,
            )
            said = [(word, "keyboard") for word in words]
            self.supervisor.update(self.t, self.t, replace(fine, **report), pose, said)
            words = ()
        return self.states.state


@pytest.fixture
def bench():
    return Bench()


def test_nothing_happens_while_all_is_well(bench):
    assert bench.tick(seconds=5.0) is PilotState.SURVEYING
    assert bench.link.done == []
    assert bench.supervisor.sends_commands


def test_a_hold_lasts_until_the_operators_word(bench):
    assert bench.tick("hold") is PilotState.HOLDING
    assert bench.tick(seconds=30.0) is PilotState.HOLDING
    assert not bench.supervisor.sends_commands
    bench.tick("resume")
    assert bench.tick() is PilotState.SURVEYING
    assert bench.link.done == ["hold", "arm"]


@pytest.mark.parametrize("word", ["resume", "home"])
def test_eyes_that_judge_nothing_hold_the_vehicle_until_the_operators_word(word):
    bench = Bench(on_unjudged="hold", unjudged_s=5.0)
    bench.safety.sees_m = lambda: 0.0
    assert bench.tick(seconds=6.0) is PilotState.HOLDING
    bench.tick(word)
    assert bench.tick(seconds=30.0) is PilotState.SURVEYING
    bench.safety.sees_m = lambda: 2.0
    bench.tick()
    bench.safety.sees_m = lambda: 0.0
    assert bench.tick(seconds=6.0) is PilotState.HOLDING


def test_a_stop_ends_and_holds_and_never_disarms(bench):
    bench.tick("stop")
    assert bench.supervisor.end_reason == "stopped by the operator (keyboard)"
    bench.supervisor.finish()
    assert bench.link.done == ["hold"]


def test_disarming_has_to_be_asked_for(bench):
    bench.tick("disarm")
    bench.supervisor.finish()
    assert bench.link.done == ["disarm"]


def test_a_lost_link_holds_within_a_second_and_goes_on_when_it_is_back(bench):
    bench.tick()
    lost_at = bench.t
    for _ in range(10):
        if bench.tick(pose_stamp_s=lost_at, attitude_stamp_s=lost_at) is PilotState.HOLDING:
            break
    assert bench.states.state is PilotState.HOLDING
    assert bench.t - lost_at <= 1.0
    assert "link lost" in bench.states.reason
    assert bench.tick(seconds=1.8) is PilotState.HOLDING
    assert bench.tick(seconds=0.5) is PilotState.SURVEYING
    assert bench.link.done == ["hold", "arm"]


def test_a_reboot_holds_until_the_operators_word(bench):
    assert bench.tick(reboots=1) is PilotState.HOLDING
    assert bench.tick(seconds=10.0, reboots=1) is PilotState.HOLDING
    bench.tick("resume", reboots=1)
    assert bench.tick(reboots=1) is PilotState.SURVEYING


def test_an_order_that_is_refused_is_repeated(bench):
    bench.link.refuse = {"hold"}
    bench.tick(leak=False, tether_turns=9.0)
    assert bench.supervisor.sends_commands  # zero set-points, as long as the autopilot does not hold
    bench.link.refuse = set()
    bench.tick(seconds=1.3, tether_turns=9.0)
    assert bench.link.done == ["hold"]
    assert ("order_refused", {"order": "hold", "reason": "hold denied"}) in bench.events


def test_a_refused_resume_stays_held_and_tells_why(bench):
    bench.tick("hold")
    bench.link.refuse = {"arm"}
    bench.tick("resume")
    assert bench.tick() is PilotState.HOLDING
    assert ("order_refused", {"order": "arm", "reason": "arm denied"}) in bench.events


def test_a_leak_surfaces_and_the_survey_ends_at_the_top(bench):
    assert bench.tick(leak=True) is PilotState.SURFACING
    assert bench.supervisor.end_reason == ""
    bench.tick(leak=True, depth_m=0.1)
    assert bench.supervisor.end_reason == "surfaced: leak: water inside the hull"
    bench.supervisor.finish()
    assert bench.link.done == ["surface"]


def test_a_low_battery_brings_the_vehicle_home_once(bench):
    bench.tick(seconds=2.0, battery_fraction=0.2)
    assert (bench.homeward, bench.states.state) == (1, PilotState.SURVEYING)
    bench.tick(battery_fraction=0.2, pose=Pose(2.3, 5.0, 0.0))
    assert bench.supervisor.end_reason == "back at the start: battery at 20%"


def test_after_the_way_back_it_may_surface():
    bench = Bench(after_return="surface")
    bench.tick(battery_fraction=0.2)
    assert bench.tick(battery_fraction=0.2, pose=Pose(2.3, 5.0, 0.0)) is PilotState.SURFACING


def test_the_operator_calls_the_vehicle_home_once(bench):
    bench.tick("home")
    assert bench.tick("home", seconds=2.0) is PilotState.SURVEYING
    assert (bench.homeward, bench.link.done, bench.supervisor.end_reason) == (1, [], "")
    assert "because of the operator's word (keyboard)" in bench.supervisor.awaits(1.0, None)
    bench.tick(pose=Pose(2.3, 5.0, 0.0))
    assert bench.supervisor.end_reason == "back at the start: the operator's word (keyboard)"


def test_a_vehicle_called_home_may_surface_there():
    bench = Bench(after_return="surface")
    bench.tick("home")
    assert bench.tick(pose=Pose(2.3, 5.0, 0.0)) is PilotState.SURFACING


@pytest.mark.parametrize(("words", "report"), [(["hold"], {}), ([], {"manual_override": True})])
def test_home_gets_a_vehicle_going_that_is_held_or_given_back(bench, words, report):
    assert bench.tick(*words, **report) in (PilotState.HOLDING, PilotState.TAKEN_OVER)
    bench.tick("home")
    assert bench.tick() is PilotState.SURVEYING
    assert (bench.homeward, bench.link.done[-1]) == (1, "arm")
    bench.tick(pose=Pose(2.3, 5.0, 0.0))
    assert bench.supervisor.end_reason == "back at the start: the operator's word (keyboard)"


def test_the_way_home_may_be_held_and_goes_on(bench):
    bench.tick("home")
    assert bench.tick("hold", seconds=5.0) is PilotState.HOLDING
    bench.tick("resume")
    assert bench.tick() is PilotState.SURVEYING
    assert bench.homeward == 1
    bench.tick(pose=Pose(2.3, 5.0, 0.0))
    assert bench.supervisor.end_reason.startswith("back at the start")


def test_a_surfacing_vehicle_is_not_called_home(bench):
    bench.tick("surface")
    assert bench.tick("home") is PilotState.SURFACING
    assert bench.homeward == 0


def test_a_leak_on_the_way_back_surfaces_at_once(bench):
    bench.tick(battery_fraction=0.2)
    assert bench.tick(battery_fraction=0.2, leak=True) is PilotState.SURFACING


def test_the_joystick_takes_over_at_once_and_only_a_word_gives_back(bench):
    assert bench.tick(manual_override=True, mode="MANUAL") is PilotState.TAKEN_OVER
    assert not bench.supervisor.sends_commands
    assert bench.tick(seconds=20.0) is PilotState.TAKEN_OVER
    bench.tick("resume")
    assert bench.tick() is PilotState.SURVEYING
    assert bench.link.done == ["arm"]


def test_limits_give_no_orders_to_a_person_who_steers(bench):
    bench.tick(manual_override=True)
    bench.tick(seconds=3.0, manual_override=True, tether_turns=9.0, pose=Pose(25.0, 5.0, 0.0))
    assert bench.link.done == []


def test_who_disarms_the_vehicle_has_taken_over(bench):
    assert bench.tick(armed=False) is PilotState.TAKEN_OVER
    assert bench.states.reason == "disarmed, not by this program"


def test_a_hold_of_the_operator_is_not_ended_by_a_limit_that_passes(bench):
    bench.tick("hold")
    old = bench.t
    bench.tick(seconds=2.0, pose_stamp_s=old, attitude_stamp_s=old)
    assert bench.tick(seconds=5.0) is PilotState.HOLDING


def test_the_time_limit_ends_a_survey_that_is_held(bench):
    bench.tick("hold")
    bench.t = 599.5
    bench.tick(seconds=2.0)
    assert "time limit" in bench.supervisor.end_reason


def test_a_finished_survey_ends_holding_by_default(bench):
    bench.supervisor.complete(5.0, "nothing left")
    assert bench.supervisor.end_reason == "nothing left"


def test_a_finished_survey_may_return_or_surface():
    bench = Bench(on_done="return")
    bench.supervisor.complete(5.0, "nothing left")
    assert (bench.homeward, bench.supervisor.end_reason) == (1, "")
    bench.tick(pose=Pose(2.3, 5.0, 0.0))
    assert bench.supervisor.end_reason == "back at the start: nothing left"
    bench = Bench(on_done="surface")
    bench.supervisor.complete(5.0, "nothing left")
    assert bench.states.state is PilotState.SURFACING


def test_a_hold_by_the_time_left_ends_at_the_time_limit():
    bench = Bench(on_time="hold")
    bench.t = 580.0
    assert bench.tick(seconds=5.0) is PilotState.HOLDING
    bench.tick(seconds=20.0)
    assert bench.supervisor.end_reason == "time limit"


def test_every_state_says_what_ends_it_but_surveying(bench):
    said = {}
    for state in PilotState:
        bench.states.state = state
        said[state] = bench.supervisor.awaits(1.0, None)
    assert [state for state, text in said.items() if not text] == [PilotState.SURVEYING, PilotState.STOPPED]


@pytest.mark.parametrize(
    ("move", "surface_after_s", "text"),
    [
        ((Mover.GUARD, "sensors lost"), None, "good for 1 s, or on your word"),
        ((Mover.GUARD, "sensors lost"), 60.0, "surfaces after 60 s"),
        ((Mover.OPERATOR, "hold"), None, "only on your word"),
        ((Mover.OPERATOR, "take over"), None, "given back"),
        ((Mover.VEHICLE, "must surface"), None, "at the surface"),
    ],
)
def test_a_hold_ends_by_whoever_began_it(bench, move, surface_after_s, text):
    bench.states.move(0.1, *move)
    assert text in bench.supervisor.awaits(1.0, surface_after_s)


@pytest.mark.parametrize(
    ("report", "text"), [({"pose_stamp_s": 0.0}, "gone for 2 s"), ({"reboots": 1}, "only on your")]
)
def test_a_fault_that_may_pass_ends_by_itself(bench, report, text):
    assert bench.tick(seconds=1.0, **report) is PilotState.HOLDING
    assert text in bench.supervisor.awaits(1.0, None)
