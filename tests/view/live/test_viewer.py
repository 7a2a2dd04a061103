import http.client
import json
import threading

import numpy as np
import pytest

from coral.view.live.controls import Pace, RunControls
from coral.view.live.viewer import Stroke, Viewer, frame_picture


def ask(viewer, method, path, content=None):
    connection = http.client.HTTPConnection("127.0.0.1", viewer.access.port, timeout=30)
    headers = {"Authorization": f"Bearer {viewer.access.token}", "X-Coral": "1", "Content-Type": "application/json"}
    connection.request(method, path, None if content is None else json.dumps(content), headers)
    response = connection.getresponse()
    body = response.read()
    connection.close()
    kind = response.headers["Content-Type"]
    return response.status, json.loads(body) if kind == "application/json" else body


@pytest.fixture
def viewer(finished):
    with Viewer(finished, rate=20.0) as viewer:
        yield viewer


def test_a_recording_is_served(viewer, finished):
    status, head = ask(viewer, "GET", "/api/head")
    assert (status, head["live"], head["rate"], head["title"]) == (200, False, 20.0, "made-up <reef>")
    _, news = ask(viewer, "GET", "/api/news?moments=0&rows=0")
    assert news["moments"][-1]["ended"] == "time limit"
    assert news["now"] is None
    assert news["complete"]
    _, rest = ask(viewer, "GET", f"/api/news?moments={len(news['moments'])}&rows={len(news['rows'])}")
    assert (rest["moments"], rest["rows"]) == ([], [])
    step = news["maps"][0]
    assert ask(viewer, "GET", f"/frames/{step}/map")[1].startswith(b"\x89PNG")
    digest = next(moment["pictures"][0] for moment in news["moments"] if moment.get("pictures"))
    assert (finished / "pictures" / f"{digest}.png").is_file() == (ask(viewer, "GET", f"/pictures/{digest}")[0] == 200)


@pytest.mark.parametrize(
    "path",
    [
        "/frames/999999/map",
        "/frames/0/none",
        "/frames/0/..%2fmap",
        "/frames/x/map",
        "/pictures/..%2f..%2fconfig",
        "/config.yaml",
    ],
)
def test_nothing_else_of_the_folder_is_served(viewer, path):
    assert ask(viewer, "GET", path)[0] == 404


def test_a_recording_has_no_buttons(viewer):
    assert ask(viewer, "POST", "/api/press", {"name": "stop"})[0] == 400
    assert ask(viewer, "GET", "/api/news?moments=x")[0] == 400


def test_buttons_and_the_plan_of_a_run_that_goes_on(tmp_path):
    pace = Pace()
    with Viewer(tmp_path, RunControls(pace)) as viewer:
        assert ask(viewer, "GET", "/api/head")[1] == {"live": True, "rate": 10.0}
        assert not viewer.watched
        viewer.now.strokes = [Stroke(name="plan", color="#000", points=np.array([[1.0, 2.00049]]))]
        _, news = ask(viewer, "GET", "/api/news?moments=0")
        assert viewer.watched
        assert news["now"]["strokes"][0]["points"] == [[1.0, 2.0]] or news["now"]["strokes"][0]["points"] == [
            [1.0, 2.001]
        ]
        assert ask(viewer, "POST", "/api/press", {"name": "pause"})[0] == 200
        assert ask(viewer, "POST", "/api/press", {"name": "sink"})[0] == 400
    assert pace.paused


def test_a_run_begins_when_somebody_has_opened_the_page(tmp_path, capsys):
    with Viewer(tmp_path, RunControls(Pace())) as viewer:
        visitor = threading.Thread(target=ask, args=(viewer, "GET", "/api/news"))
        visitor.start()
        viewer.wait_for_viewer("mission")
        visitor.join()
        assert f"begins when you open {viewer.url}" in capsys.readouterr().err


def test_a_map_is_drawn_with_north_up(finished):
    picture = frame_picture(finished, 0, "map")
    assert picture.ndim == 3
    assert frame_picture(finished, 0, "unknown") is None
