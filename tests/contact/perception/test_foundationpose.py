"""The FoundationPose client and server, with an estimator that knows the answer."""

import socket
import threading
from dataclasses import replace

import numpy as np
import pytest
from stub_foundationpose import Oracle, serving

from coral.contact.perception.camera import RgbdCameraCfg
from coral.contact.perception.foundationpose import URL, FoundationPoseTracker, OutOfReach, exchange
from coral.contact.perception.foundationpose_server import Sessions, encode
from coral.contact.perception.object_model import from_trial
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.perception.tracker import TrackerFailed
from coral.contact.real_scenes.posed_scene import PosedScene, scene_at_start
from coral.contact.scene.geometry import body_to_matrix, from_rotvec, inverse_transform, matrix_to_body, rotation_of
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.errors import InputError


@pytest.fixture
def url():
    with serving() as server:
        yield server.url


def picture_of_the_box(trial, camera, T_world_box=None):
    """Return the model of the box, a picture, and the true pose."""
    cfg = TrackedCfg(camera=camera, noise=False, eye_m=(-0.35, -0.75, 0.6), target_m=(0.05, 0.0, 0.05))
    stage, state = PosedScene(trial, cfg), scene_at_start(trial)
    if T_world_box is not None:
        state = replace(state, objects={**state.objects, "box": matrix_to_body(T_world_box)})
    frame = stage.take(state, np.random.default_rng(0))
    return from_trial(stage.model, trial, "box"), frame, body_to_matrix(state.objects["box"])


@pytest.fixture(scope="module")
def seen(trial):
    return picture_of_the_box(trial, RgbdCameraCfg(width=160, height=120))


def test_poses_go_through_the_server_and_are_judged(url, seen):
    model, frame, truth = seen
    tracker = FoundationPoseTracker(model, url, expected=truth)
    np.testing.assert_allclose(Oracle.last.vertices[Oracle.last.faces], model.triangles, atol=1e-6)
    Oracle.answer = inverse_transform(frame.T_world_camera) @ truth
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
    Oracle.answer = inverse_transform(frame.T_world_camera) @ truth
    assert tracker.track(frame, frame.mask("box")).registered


def test_an_unseen_object_is_not_even_asked_for(url, seen):
    model, frame, _ = seen
    tracker = FoundationPoseTracker(model, url)
    estimate = tracker.track(frame, np.zeros(frame.depth.shape, bool))
    assert (estimate.lost, estimate.reason) == (True, "not seen")
    assert Oracle.calls == []


def test_the_server_s_complaint_reaches_the_user(url, seen, monkeypatch):
    model, frame, _ = seen
    tracker = FoundationPoseTracker(model, url)

    def fail(self, **request):
        raise RuntimeError("CUDA out of memory")

    monkeypatch.setattr(Oracle, "register", fail)
    with pytest.raises(TrackerFailed, match="CUDA out of memory"):
        tracker.register(frame, frame.mask("box"))
    monkeypatch.setattr(Oracle, "register", lambda self, **request: np.zeros((4, 4)))
    with pytest.raises(TrackerFailed, match="no pose"):
        tracker.register(frame, frame.mask("box"))


def test_bad_addresses_and_colourless_pictures(url, seen):
    model, frame, _ = seen
    with pytest.raises(TrackerFailed, match="does not answer"):
        FoundationPoseTracker(model, "http://127.0.0.1:9")
    tracker = FoundationPoseTracker(model, url)
    with pytest.raises(InputError, match="colours"):
        tracker.register(replace(frame, rgb=None), frame.mask("box"))


def test_a_hint_is_taken_and_left_alone(url, seen):
    model, frame, truth = seen
    tracker = FoundationPoseTracker(model, url, expected=truth)
    Oracle.answer = inverse_transform(frame.T_world_camera) @ truth
    for _ in range(2):
        estimate = tracker.track(frame, frame.mask("box"), guess=np.eye(4))
        np.testing.assert_allclose(estimate.T_world_object, truth, atol=1e-9)


def test_a_closed_tracker_leaves_nothing_on_the_server(seen):
    model, _, _ = seen
    with serving() as server:
        tracker = FoundationPoseTracker(model, server.url)
        assert len(server.sessions._open) == 1
        tracker.close()
        assert len(server.sessions._open) == 0
        tracker.close()  # a second time, and a server that knows nothing of it, are no error


@pytest.mark.parametrize(
    "answer",
    [
        np.full((4, 4), np.nan),
        np.eye(3),
        np.diag([1.0, 1.0, -1.0, 1.0]),
        np.eye(4) + np.array([[0, 0, 0, np.inf]] + [[0] * 4] * 3),
    ],
)
def test_what_is_no_pose_is_named(url, seen, monkeypatch, answer):
    model, frame, _ = seen
    monkeypatch.setattr(
        Sessions,
        "answer",
        lambda self, verb, request: {"session": np.array("a")} if verb == "init" else {"pose": answer},
    )
    tracker = FoundationPoseTracker(model, url)
    with pytest.raises(TrackerFailed, match="no pose"):
        tracker.register(frame, frame.mask("box"))


@pytest.mark.parametrize("answer", [{}, {"pose": np.array("text")}])
def test_answers_that_lack_what_was_asked_are_named(url, seen, monkeypatch, answer):
    model, frame, _ = seen
    monkeypatch.setattr(Sessions, "answer", lambda self, verb, request: answer)
    with pytest.raises(TrackerFailed, match="session"):
        FoundationPoseTracker(model, url)
    monkeypatch.setattr(Sessions, "answer", lambda self, verb, request: answer | {"session": np.array("a")})
    with pytest.raises(TrackerFailed, match="no pose"):
        FoundationPoseTracker(model, url).register(frame, frame.mask("box"))


def test_garbage_from_the_network_is_a_named_failure(url, seen, monkeypatch):
    model, _, _ = seen
    for raw in (b"PK\x03\x04 and no more", b"", encode({"session": np.array("a")})[:60]):
        monkeypatch.setattr("coral.contact.perception.foundationpose_server.encode", lambda arrays, raw=raw: raw)
        with pytest.raises(TrackerFailed, match="npz"):
            FoundationPoseTracker(model, url)


@pytest.mark.parametrize("place", [(0, 0, 0), (0, 0, -1), (1e9, 0, 1), (0, 0, 1e9)])
def test_a_pose_out_of_this_world_is_a_lost_object(url, seen, monkeypatch, place):
    model, frame, truth = seen
    pose = np.eye(4)
    pose[:3, 3] = place
    monkeypatch.setattr(Oracle, "answer", pose)
    tracker = FoundationPoseTracker(model, url, expected=truth)
    estimate = tracker.register(frame, frame.mask("box"))
    assert estimate.lost
    np.testing.assert_array_equal(estimate.T_world_object, truth)


@pytest.fixture(scope="module")
def seen_in_full():
    """The box of pick-box in pictures of the size that episodes use."""
    trial = sample_trial(load_task("pick-box"), 0, "pick-box")
    return picture_of_the_box(trial, RgbdCameraCfg())


@pytest.mark.parametrize(
    ("shift_m", "turn_deg", "noticed"),
    [
        ((0.015, 0, 0), 0, False),
        ((0, 0, 0), 40, False),
        ((0.02, 0, 0), 0, True),
        ((0, 0.02, 0), 0, True),
        ((0, 0, 0.02), 0, True),
    ],
)
def test_a_server_that_lies_by_two_centimetres_is_found_out(url, seen_in_full, monkeypatch, shift_m, turn_deg, noticed):
    model, frame, truth = seen_in_full
    tracker = FoundationPoseTracker(model, url, expected=truth)
    monkeypatch.setattr(Oracle, "answer", inverse_transform(frame.T_world_camera) @ truth)
    believed = tracker.track(frame, frame.mask("box")).confidence
    wrong = truth.copy()
    wrong[:3, 3] += shift_m
    wrong[:3, :3] = rotation_of(from_rotvec(np.array([0, 0, np.radians(turn_deg)]))) @ wrong[:3, :3]
    Oracle.answer = inverse_transform(frame.T_world_camera) @ wrong
    estimate = tracker.track(frame, frame.mask("box"))
    assert estimate.lost == noticed
    assert estimate.confidence < believed


def test_a_server_that_repeats_itself_is_found_out_once_the_object_has_moved(url, seen, monkeypatch, trial):
    model, frame, truth = seen
    tracker = FoundationPoseTracker(model, url, expected=truth)
    monkeypatch.setattr(Oracle, "answer", inverse_transform(frame.T_world_camera) @ truth)
    assert not tracker.track(frame, frame.mask("box")).lost
    moved = truth.copy()
    moved[0, 3] += 0.05
    _, later, _ = picture_of_the_box(trial, RgbdCameraCfg(width=160, height=120), moved)
    assert tracker.track(later, later.mask("box")).lost


THING = {"vertices": np.zeros((3, 3)), "faces": np.array([[0, 1, 2]]), "symmetry": np.eye(4)[None]}
NOBODY = "http://127.0.0.1:9"


@pytest.mark.parametrize("url", ["http://127.0.0.1:5070", "http://robot.local/", "http://[::1]:5070"])
def test_an_address_is_a_host_and_a_port(url):
    assert URL.fullmatch(url)


@pytest.mark.parametrize(
    "url",
    [
        "",
        "127.0.0.1:5070",
        "ws://127.0.0.1:5070",
        "http://",
        "http://x:none",
        "http://x:99999",
        "http://me:word@x:5070",
        "http://x/a",
        "http://x?a=1",
        "http://x y",
    ],
)
def test_another_address_is_none(url):
    assert not URL.fullmatch(url)


def test_an_answer_comes_back_as_arrays():
    with serving() as server:
        assert exchange(server.url, "", b"", 5.0) == {}
        answer = exchange(server.url, "init", encode(THING), 30.0)
    assert set(answer) == {"session"}


def test_a_refusal_is_one_line_with_the_reason():
    with serving() as server, pytest.raises(TrackerFailed, match=r"refuses to track: no such session") as refused:
        exchange(server.url, "track", encode({"session": np.array("none")}), 30.0)
    assert not isinstance(refused.value, OutOfReach)
    assert "\n" not in str(refused.value)


def test_nobody_there_is_out_of_reach():
    for verb in ("", "init"):
        with pytest.raises(OutOfReach, match=f"^foundationpose at {NOBODY} does not answer: "):
            exchange(NOBODY, verb, b"x", 1.0)


@pytest.mark.parametrize("sent", [b"", b"HTTP/1.1 200 OK\r\nContent-Length: 9\r\n\r\n", b"not HTTP at all\r\n\r\n"])
def test_a_server_that_falls_silent_is_not_waited_for(sent):
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def speak():
            line, _ = listener.accept()
            line.sendall(sent)
            lines.append(line)

        lines = []
        thread = threading.Thread(target=speak, daemon=True)
        thread.start()
        url = f"http://127.0.0.1:{listener.getsockname()[1]}"
        with pytest.raises(OutOfReach, match=url):
            exchange(url, "init", b"x", 0.1)
        thread.join()
        lines[0].close()


def test_a_server_that_drips_is_not_waited_for():
    """Byte by byte: no single wait is long, all of them together are."""
    stop = threading.Event()
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def drip():
            line, _ = listener.accept()
            line.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: 100000000\r\n\r\n")
            while not stop.wait(0.02):
                try:
                    line.sendall(b"x")
                except OSError:
                    return

        thread = threading.Thread(target=drip, daemon=True)
        thread.start()
        url = f"http://127.0.0.1:{listener.getsockname()[1]}"
        try:
            with pytest.raises(OutOfReach, match=r"no answer to init in 0\.2 s"):
                exchange(url, "init", b"x", 0.2)
        finally:
            stop.set()
            thread.join()
