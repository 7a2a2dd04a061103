"""The FoundationPose client and server, with an estimator that knows the answer."""

import io
import threading

import numpy as np
import pytest

from coral.contact.perception.camera import CameraCfg
from coral.contact.perception.foundationpose import FoundationPoseCfg, FoundationPoseTracker
from coral.contact.perception.foundationpose_server import Sessions, decode, encode, serve
from coral.contact.perception.motions import motion_of
from coral.contact.perception.rotation import inverse
from coral.contact.perception.stage import Stage, object_model
from coral.errors import InputError, RunError


class Oracle:
    """Has the verbs of FoundationPose's estimator."""

    answer = np.eye(4)
    calls: list = []

    def __init__(self, vertices, faces, symmetry):
        self.vertices, self.faces, self.symmetry = vertices, faces, symmetry
        Oracle.last = self

    def register(self, K, rgb, depth, ob_mask, iteration):
        assert rgb.dtype == np.uint8
        assert ob_mask.any()
        Oracle.calls.append(("register", iteration))
        return self.answer

    def track_one(self, rgb, depth, K, iteration):
        Oracle.calls.append(("track", iteration))
        return self.answer


@pytest.fixture
def url():
    Oracle.calls = []
    server = serve(Sessions(Oracle), "127.0.0.1", 0)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True)
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    server.server_close()
    thread.join()


@pytest.fixture(scope="module")
def seen(trial):
    stage = Stage(trial, CameraCfg(width=160, height=120), None, colours="shaded")
    moment = motion_of(trial).at(0.0)
    return object_model(stage.model, trial, "box"), stage.take(moment, np.random.default_rng(0)), moment.objects["box"]


def test_poses_go_through_the_server_and_are_judged(url, seen):
    model, frame, truth = seen
    tracker = FoundationPoseTracker(model, FoundationPoseCfg(url=url), expected=truth)
    np.testing.assert_allclose(Oracle.last.vertices[Oracle.last.faces], model.triangles, atol=1e-6)
    Oracle.answer = inverse(frame.T_world_camera) @ truth
    first = tracker.track(frame, frame.mask("box"))
    assert first.registered
    assert not first.lost
    np.testing.assert_allclose(first.T_world_object, truth, atol=1e-9)
    second = tracker.track(frame, frame.mask("box"))
    assert not second.registered

    Oracle.answer = np.eye(4)  # what it returns for a picture without depth
    Oracle.answer = Oracle.answer + np.array([[0, 0, 0, 0.3], [0] * 4, [0, 0, 0, 1.0], [0] * 4])
    third = tracker.track(frame, frame.mask("box"))
    assert third.lost
    assert third.reason == "does not fit"
    assert Oracle.calls == [("register", 5), ("track", 2), ("track", 2)]
    Oracle.answer = inverse(frame.T_world_camera) @ truth
    assert tracker.track(frame, frame.mask("box")).registered


def test_an_unseen_object_is_not_even_asked_for(url, seen):
    model, frame, _ = seen
    tracker = FoundationPoseTracker(model, FoundationPoseCfg(url=url))
    estimate = tracker.track(frame, np.zeros(frame.depth.shape, bool))
    assert (estimate.lost, estimate.reason) == (True, "not seen")
    assert Oracle.calls == []


def test_nothing_is_unpickled():
    buffer = io.BytesIO()
    np.savez(buffer, trap=np.array([{"a": 1}], dtype=object))
    with pytest.raises(ValueError, match="pickle"):
        decode(buffer.getvalue())
    with pytest.raises(ValueError, match="npz"):
        decode(b"\x80\x04K\x01.")


def test_arrays_survive_the_codec():
    arrays = {"a": np.arange(6.0).reshape(2, 3), "b": np.array("text"), "c": np.zeros((0, 3), np.uint8)}
    for name, array in decode(encode(arrays)).items():
        np.testing.assert_array_equal(array, arrays[name])


@pytest.mark.parametrize(("request_", "complaint"), [
    ({"vertices": np.zeros((3, 2)), "faces": np.zeros((1, 3)), "symmetry": np.eye(4)[None]}, "vertices"),
    ({"vertices": np.zeros((3, 3)), "faces": np.full((1, 3), 7), "symmetry": np.eye(4)[None]}, "face"),
    ({"faces": np.zeros((1, 3))}, "missing: vertices"),
    ({"vertices": np.full((3, 3), np.nan), "faces": np.zeros((1, 3)), "symmetry": np.eye(4)[None]}, "finite")])
def test_bad_objects_are_refused(request_, complaint):
    with pytest.raises(ValueError, match=complaint):
        Sessions(Oracle).answer("init", request_)


def test_sessions_end():
    sessions = Sessions(Oracle)
    thing = {"vertices": np.zeros((3, 3)), "faces": np.array([[0, 1, 2]]), "symmetry": np.eye(4)[None]}
    session = sessions.answer("init", thing)["session"]
    with pytest.raises(ValueError, match="no such verb"):
        sessions.answer("explode", {"session": session})
    assert sessions.answer("close", {"session": session}) == {}
    with pytest.raises(ValueError, match="init again"):
        sessions.answer("track", {"session": session})
    ids = [sessions.answer("init", thing)["session"] for _ in range(17)]
    with pytest.raises(ValueError, match="init again"):
        sessions.answer("close", {"session": ids[0]})


def test_the_server_s_complaint_reaches_the_user(url, seen, monkeypatch):
    model, frame, _ = seen
    tracker = FoundationPoseTracker(model, FoundationPoseCfg(url=url))

    def fail(self, **request):
        raise RuntimeError("CUDA out of memory")
    monkeypatch.setattr(Oracle, "register", fail)
    with pytest.raises(RunError, match="CUDA out of memory"):
        tracker.register(frame, frame.mask("box"))
    monkeypatch.setattr(Oracle, "register", lambda self, **request: np.zeros((4, 4)))
    with pytest.raises(RunError, match="no pose"):
        tracker.register(frame, frame.mask("box"))


def test_bad_addresses_and_colourless_pictures(url, seen, trial):
    model, _, _ = seen
    with pytest.raises(InputError, match="url"):
        FoundationPoseTracker(model, FoundationPoseCfg(url="tcp://x"))
    with pytest.raises(RunError, match="does not answer"):
        FoundationPoseTracker(model, FoundationPoseCfg(url="http://127.0.0.1:9"))
    stage = Stage(trial, CameraCfg(width=160, height=120), None)
    frame = stage.take(motion_of(trial).at(0.0), np.random.default_rng(0))
    tracker = FoundationPoseTracker(model, FoundationPoseCfg(url=url))
    with pytest.raises(InputError, match="colours"):
        tracker.register(frame, frame.mask("box"))
