"""MAVLink messages with a sender, for tests."""

from pymavlink.dialects.v20 import ardupilotmega as mavlink


def sent(message, system=1, component=1):
    """Return a message as a receiver decodes it."""
    sender = mavlink.MAVLink(None, system, component)
    receiver = mavlink.MAVLink(None, 255, 191)
    return receiver.parse_buffer(bytes(message.pack(sender)))[0]


def heartbeat(mode=4, armed=True, kind=12, **source):
    base = 81 + (128 if armed else 0)
    return sent(mavlink.MAVLink_heartbeat_message(kind, 3, base, mode, 4, 3), **source)


def attitude(boot_ms, yaw=0.0, turn=0.0):
    return sent(mavlink.MAVLink_attitude_message(boot_ms, 0.1, 0.2, yaw, 0.0, 0.0, turn))


def position(boot_ms, north=0.0, east=0.0, vn=0.0, ve=0.0):
    return sent(mavlink.MAVLink_local_position_ned_message(boot_ms, north, east, 1.0, vn, ve, 0.0))


def estimator(flags=831):
    return sent(mavlink.MAVLink_ekf_status_report_message(flags, 0.1, 0.2, 0.0, 0.0, 0.0))


def height(centimetres, looks=25, least=20, most=5000):
    return sent(mavlink.MAVLink_distance_sensor_message(0, least, most, centimetres, 0, 0, looks, 0))


def text(words, severity=4, number=0, chunk=0):
    return sent(mavlink.MAVLink_statustext_message(severity, words.encode(), number, chunk))
