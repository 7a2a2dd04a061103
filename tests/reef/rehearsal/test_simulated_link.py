import pytest

from coral.reef.rehearsal.simulated_link import SimulatedLink
from coral.reef.sea.link import LinkRefused
from coral.reef.world.geometry import Pose


class FakeClock:
    now = 50.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return FakeClock()


@pytest.fixture
def link(clock):
    return SimulatedLink(start=Pose(2.0, 3.0, 0.0), clock=clock)


def drive(link, clock, seconds, forward=0.5, turn=0.0):
    for _ in range(round(10 * seconds)):
        link.command(forward, turn, 1.0)
        clock.now += 0.1
    return link.report()


def test_a_disarmed_vehicle_stays(link, clock):
    report = drive(link, clock, 2.0)
    assert report.pose == pytest.approx((2.0, 3.0, 0.0))
    assert not report.armed


def test_an_armed_vehicle_drives_as_commanded(link, clock):
    link.arm()
    report = drive(link, clock, 4.0)
    assert 3.4 < report.pose.x < 4.1
    assert report.velocity[0] == pytest.approx(0.5, abs=0.02)
    assert (report.armed, report.mode, report.pose_stamp_s) == (True, "GUIDED", pytest.approx(clock.now, abs=0.03))


def test_a_set_point_expires_after_three_seconds(link, clock):
    link.arm()
    drive(link, clock, 2.0)
    for _ in range(60):
        clock.now += 0.1
        report = link.report()
    assert report.velocity[0] == pytest.approx(0.0, abs=0.02)
    assert 4.0 < report.pose.x < 4.7  # 1 m in two seconds, 1.5 m in the three after


def test_the_same_commands_give_the_same_track(clock):
    def track():
        clock.now = 50.0
        link = SimulatedLink(clock=clock)
        link.arm()
        return drive(link, clock, 5.0, turn=0.3).pose

    assert track() == track()


def test_hold_stops_and_surface_comes_up(link, clock):
    link.arm()
    drive(link, clock, 2.0)
    link.hold()
    report = drive(link, clock, 2.0)
    assert (report.mode, report.velocity[0]) == ("POSHOLD", pytest.approx(0.0, abs=0.02))
    link.surface()
    assert drive(link, clock, 6.0).depth_m == 0.0


def test_turns_of_the_tether_are_counted(link, clock):
    link.arm()
    assert drive(link, clock, 22.0, forward=0.0, turn=0.6).tether_turns == pytest.approx(2.1, abs=0.1)


def test_an_obstacle_stops_the_hull(clock):
    link = SimulatedLink(contact=lambda x, y: 2.0 - x, clock=clock)
    link.arm()
    assert drive(link, clock, 8.0).pose.x == pytest.approx(1.7, abs=0.01)


def test_what_is_not_finite_stops(link, clock):
    link.arm()
    drive(link, clock, 1.0)
    report = drive(link, clock, 2.0, forward=float("nan"))
    assert report.velocity[0] == pytest.approx(0.0, abs=0.02)


def test_a_long_pause_of_the_program_is_no_long_drive(link, clock):
    link.arm()
    drive(link, clock, 1.0)
    clock.now += 100.0
    assert link.report().pose.x < 4.0


def test_a_closed_link_refuses(link):
    link.close()
    with pytest.raises(LinkRefused):
        link.arm()
