"""Who is on the link: the vehicle is one sender, and what is not certain is named."""

from messages import mavlink, sent

from coral.reef.sea.stations import MOST, RECENT_S, TORN, Stations

A, B = ("192.168.2.2", 14550), ("192.168.2.3", 14550)


def beat(stations, peer=A, system=1, kind=12, maker=3, now=100.0, component=1):
    message = sent(mavlink.MAVLink_heartbeat_message(kind, maker, 81, 19, 3, 3), system, component)
    return stations.take(message, peer, now)


def known(system=0):
    stations = Stations(system)
    beat(stations)
    stations.answered()
    return stations


def test_one_submarine_that_answers_is_certain():
    stations = known()
    assert (stations.vehicle.peer, stations.faults(100.0)) == (A, ())
    assert beat(stations)
    assert not beat(stations, B)


def test_a_vehicle_that_answers_nothing_may_be_a_recording():
    stations = Stations()
    beat(stations)
    assert "it has answered nothing yet" in stations.faults(100.0)[0]


def test_a_second_sender_of_the_same_identity_is_named_with_both_addresses():
    stations = known()
    beat(stations, B)
    (fault,) = stations.faults(100.0)
    assert "second sender calls itself system 1, at 192.168.2.3:14550 beside 192.168.2.2:14550" in fault
    assert stations.faults(100.0 + RECENT_S + 0.1) == ()


def test_of_two_systems_one_must_be_named():
    stations = known()
    beat(stations, B, system=2)
    assert "systems 1 and 2 are on the line" in stations.faults(100.0)[0]
    stations = Stations(2)
    beat(stations, A, system=1)
    assert stations.vehicle is None
    beat(stations, B, system=2)
    stations.answered()
    assert (stations.vehicle.peer, stations.faults(100.0)) == (B, ())


def test_another_kind_of_vehicle_and_another_autopilot_are_named():
    stations = Stations()
    beat(stations, kind=2)
    stations.answered()
    assert stations.faults(100.0) == ("it calls itself type 2, not a submarine (12)",)
    stations = Stations()
    beat(stations, maker=12)
    stations.answered()
    assert stations.faults(100.0) == ("its autopilot is PX4, not ArduPilot",)


def test_ground_stations_and_cameras_are_no_vehicles():
    stations = Stations()
    beat(stations, maker=8, kind=6)
    beat(stations, component=100)
    assert stations.vehicle is None


def numbered(numbers):
    stations = known()
    for number in numbers:
        codec = mavlink.MAVLink(None, 1, 1)
        codec.seq = number % 256
        packed = mavlink.MAVLink_attitude_message(0, 0, 0, 0, 0, 0, 0).pack(codec)
        (message,) = mavlink.MAVLink(None, 255, 191).parse_buffer(bytes(packed))
        stations.take(message, A, 100.0)
    return stations.faults(100.0)


def test_two_senders_behind_one_address_break_the_numbering():
    mixed = [number for k in range(TORN) for number in (k, 130 + k)]
    assert "two senders call themselves system 1" in numbered(mixed)[0]


def test_lost_late_and_doubled_messages_do_not():
    assert numbered(range(0, 4000, 7)) == ()
    assert numbered([number for k in range(300) for number in (2 * k + 1, 2 * k)]) == ()
    assert numbered([number for k in range(300) for number in (k, k)]) == ()


def test_a_vehicle_that_comes_back_from_another_port_is_followed_once_its_own_is_silent():
    stations = known()
    beat(stations, B, now=102.0)
    assert not stations.moved(103.0)
    beat(stations, B, now=106.0)
    assert stations.moved(106.0)
    assert stations.vehicle.peer == B


def test_a_flood_of_senders_pushes_out_neither_the_vehicle_nor_the_memory():
    stations = known()
    for port in range(1000):
        beat(stations, ("10.0.0.1", port))
    assert stations.vehicle.peer == A
    assert len(stations.faults(100.0)) == MOST
