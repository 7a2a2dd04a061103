"""A node that keeps what is made of it, without ROS 2: messages are plain values."""

from types import SimpleNamespace


def message(**fields):
    """Make a message of nested values: dictionaries become messages."""
    return SimpleNamespace(**{k: message(**v) if isinstance(v, dict) else v for k, v in fields.items()})


class Twist:
    """A velocity of zero."""

    def __init__(self):
        self.linear, self.angular = message(x=0.0, y=0.0, z=0.0), message(x=0.0, y=0.0, z=0.0)


def mounted(parent, child, at=(0.0, 0.0, 0.0), turn=(0.0, 0.0, 0.0, 1.0)):
    """Make a message of /tf: where one frame is in another, and how it is turned (x, y, z, w)."""
    translation, rotation = dict(zip("xyz", at, strict=True)), dict(zip("xyzw", turn, strict=True))
    each = {
        "header": {"frame_id": parent},
        "child_frame_id": child,
        "transform": {"translation": translation, "rotation": rotation},
    }
    return message(transforms=[message(**each)])


class FakeNode:
    """Stands in for `RosNode`, whose `node` it is too."""

    def __init__(self, stamp_s=0.0):
        self.node, self.sent, self.heard, self.timers, self.services = self, [], {}, [], {}
        self.publishers = {"odom": 1, "cmd_vel": 1}
        self.subscribers, self.closed, self.stamp_s = 1, False, stamp_s
        self.arms = None

    def parameter(self, name, default):
        return default

    def qos(self, kind):
        return kind

    def resolve_topic_name(self, topic):
        return topic

    def monotonic(self, stamp):
        if isinstance(stamp, Exception):
            raise stamp
        return stamp

    def stamp(self):
        return self.stamp_s

    def close(self):
        self.closed = True

    def create_subscription(self, kind, topic, hear, qos):
        self.heard[topic] = hear

    def create_publisher(self, kind, topic, qos):
        return SimpleNamespace(publish=lambda m: self.sent.append((topic, m)))

    def create_timer(self, period_s, tick):
        self.timers.append(tick)

    def create_service(self, kind, name, answer):
        self.services[name] = answer

    def create_client(self, kind, name):
        def call_async(request):
            success, told = self.arms(request.data)
            result = SimpleNamespace(success=success, message=told)
            return SimpleNamespace(add_done_callback=lambda done: done(None), result=lambda: result)

        return SimpleNamespace(srv_name=name, service_is_ready=lambda: self.arms is not None, call_async=call_async)

    def count_publishers(self, topic):
        return self.publishers[topic]

    def count_subscribers(self, topic):
        return self.subscribers


def fake_type(name, flag=""):
    """Return a type of message by name."""
    if name.endswith("Twist"):
        return Twist
    if name.endswith("SetBool"):
        return SimpleNamespace(Request=lambda data: SimpleNamespace(data=data))
    return lambda **fields: message(**fields)


def info(**more):
    """Make a CameraInfo of a lens without distortion, 90 degrees across."""
    k = [4.0, 0.0, 3.5, 0.0, 4.0, 1.5, 0.0, 0.0, 1.0]
    roi = {"x_offset": 0, "y_offset": 0, "width": 0, "height": 0}
    fields = {
        "width": 8, "height": 4, "distortion_model": "plumb_bob", "d": [0.0] * 5, "k": k, "p": [0.0] * 12, "roi": roi,
        "binning_x": 0, "binning_y": 0, "header": {"frame_id": "optical"},
    }  # fmt: skip
    return message(**{**fields, **more})


def odometry(x=1.0, y=2.0, z=-1.5, yaw_half=(0.0, 1.0), frame="odom", stamp=5.0, speed=0.3, cov=0.0):
    """Make an odometry message."""
    covariance = [0.0] * 36
    covariance[0] = covariance[7] = covariance[35] = cov
    return message(
        header={"stamp": stamp, "frame_id": frame},
        child_frame_id="base_link",
        pose={
            "pose": {
                "position": {"x": x, "y": y, "z": z},
                "orientation": {"x": 0.0, "y": 0.0, "z": yaw_half[0], "w": yaw_half[1]},
            },
            "covariance": covariance,
        },
        twist={"twist": {"linear": {"x": speed, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.1}}},
    )


__all__ = ["FakeNode", "Twist", "fake_type", "info", "message", "odometry"]
