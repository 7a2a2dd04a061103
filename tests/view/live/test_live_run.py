"""What the terminal says of the viewer of a run."""

from types import SimpleNamespace

from coral.view.live.live_run import watching_mission, watching_task
from coral.view.live.viewer import Viewer


def test_the_run_waits_for_a_viewer_and_the_page_stays(tmp_path, capsys, monkeypatch):
    waited = []
    monkeypatch.setattr(Viewer, "wait_for_viewer", lambda self, what: waited.append(what))
    monkeypatch.setattr(Viewer, "stay", lambda self: waited.append("stay"))
    mission = SimpleNamespace(writer=SimpleNamespace(folder=tmp_path), instructing=None)
    with watching_mission(mission, port=0, speed=1.0, wait=True) as viewers:
        assert waited == ["mission"]
        assert len(viewers) == 1
    assert waited == ["mission", "stay"]
    with watching_mission(mission, port=0, speed=1.0, wait=False):
        assert "watch the mission at http://127.0.0.1:" in capsys.readouterr().err
    assert waited == ["mission", "stay"]


def test_the_stop_button_of_a_task_stops_an_arm_at_once(tmp_path):
    stopped = []
    world = SimpleNamespace(stop_now=lambda: stopped.append("now"), in_real_time=True)
    episode = SimpleNamespace(writer=SimpleNamespace(folder=tmp_path), world=world, weights=None)
    with watching_task(episode, port=0, speed=1.0, wait=False) as (watched,):
        assert watched.viewer.controls.press("stop", None)
        assert watched.pace.stop
    assert stopped == ["now"]
