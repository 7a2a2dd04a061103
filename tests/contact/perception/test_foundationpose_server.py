import io

import numpy as np
import pytest
from stub_foundationpose import Oracle

from coral.contact.perception.foundationpose_server import Sessions, decode, encode

THING = {"vertices": np.zeros((3, 3)), "faces": np.array([[0, 1, 2]]), "symmetry": np.eye(4)[None]}
PICTURE = {
    "K": np.eye(3),
    "rgb": np.zeros((4, 6, 3), np.uint8),
    "depth": np.ones((4, 6)),
    "mask": np.ones((4, 6), np.uint8),
}


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


@pytest.mark.parametrize(
    ("request_", "complaint"),
    [
        ({"vertices": np.zeros((3, 2)), "faces": np.zeros((1, 3)), "symmetry": np.eye(4)[None]}, "vertices"),
        ({"vertices": np.zeros((3, 3)), "faces": np.full((1, 3), 7), "symmetry": np.eye(4)[None]}, "face"),
        ({"faces": np.zeros((1, 3))}, "missing: vertices"),
        ({"vertices": np.full((3, 3), np.nan), "faces": np.zeros((1, 3)), "symmetry": np.eye(4)[None]}, "finite"),
    ],
)
def test_bad_objects_are_refused(request_, complaint):
    with pytest.raises(ValueError, match=complaint):
        Sessions(Oracle).answer("init", request_)


def test_sessions_end():
    sessions = Sessions(Oracle)
    session = sessions.answer("init", THING)["session"]
    with pytest.raises(ValueError, match="no such verb"):
        sessions.answer("explode", {"session": session})
    assert sessions.answer("close", {"session": session}) == {}
    with pytest.raises(ValueError, match="init again"):
        sessions.answer("track", {"session": session})
    ids = [sessions.answer("init", THING)["session"] for _ in range(17)]
    with pytest.raises(ValueError, match="init again"):
        sessions.answer("close", {"session": ids[0]})


def opened():
    sessions = Sessions(Oracle)
    return sessions, {"session": sessions.answer("init", THING)["session"]}


def test_a_pose_is_registered_and_tracked_with_its_usual_refinements(monkeypatch):
    monkeypatch.setattr(Oracle, "calls", [])
    monkeypatch.setattr(Oracle, "answer", 2.0 * np.eye(4))
    sessions, session = opened()
    for verb, more in (("register", {}), ("track", {}), ("track", {"iterations": np.array(7)})):
        np.testing.assert_array_equal(sessions.answer(verb, session | PICTURE | more)["pose"], 2.0 * np.eye(4))
    assert Oracle.calls == [("register", 5), ("track", 2), ("track", 7)]


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"depth": np.ones((4, 5))}, "depth: expected finite numbers of shape"),
        ({"mask": np.ones((3, 6))}, "mask: expected"),
        ({"rgb": np.zeros((4, 6))}, "rgb: expected"),
        ({"K": np.full((3, 3), np.inf)}, "K: expected"),
        ({"K": np.array("text")}, "K: expected"),
    ],
)
def test_bad_pictures_are_refused(changes, complaint):
    sessions, session = opened()
    with pytest.raises(ValueError, match=complaint):
        sessions.answer("register", session | PICTURE | changes)


def test_what_is_missing_in_a_picture_is_named():
    sessions, session = opened()
    for name in PICTURE:
        rest = {key: value for key, value in PICTURE.items() if key != name}
        with pytest.raises(ValueError, match=f"missing: {name}"):
            sessions.answer("register", session | rest)
