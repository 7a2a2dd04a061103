from types import SimpleNamespace

from coral.contact.perception.camera_stream import CameraStream
from coral.contact.worlds.franka.stream import StopCause


class Recorder:
    def __init__(self, log, name):
        self._log, self._name = log, name

    def __getattr__(self, verb):
        return lambda *words: self._log.append((self._name, verb, *words))


def test_the_stream_is_passed_on_and_the_camera_closed_after_it():
    log = []
    stream = CameraStream(Recorder(log, "stream"), Recorder(log, "camera"))
    stream.start()
    stream.follow("target")
    stream.stop(StopCause.END)
    stream.report()
    stream.close()
    assert [entry[:2] for entry in log] == [
        ("stream", "start"),
        ("stream", "follow"),
        ("stream", "stop"),
        ("stream", "report"),
        ("stream", "close"),
        ("camera", "close"),
    ]


def test_the_reason_tells_that_the_camera_failed():
    stream = SimpleNamespace(reason=lambda: "box was not seen for 0.25 s")
    fine, broken = SimpleNamespace(failure=lambda: ""), SimpleNamespace(failure=lambda: "unplugged")
    assert CameraStream(stream, fine).reason() == "box was not seen for 0.25 s"
    assert CameraStream(stream, broken).reason() == "box was not seen for 0.25 s: unplugged"
