"""The flags of the viewer, and what the terminal says of it."""

import pytest

from coral.commands.live import LiveFlags, watching
from coral.errors import InputError
from coral.view.live.controls import RunControls
from coral.view.live.viewer import Viewer


def test_without_the_flag_nobody_watches_and_nothing_is_checked(tmp_path):
    flags = LiveFlags(live=False, port=70000, speed=-1.0)
    flags.check()
    with watching(flags, tmp_path, "mission", lambda run: (), RunControls) as viewers:
        assert viewers == []


def test_the_run_waits_for_a_viewer_and_the_page_stays(tmp_path, capsys, monkeypatch):
    waited = []
    monkeypatch.setattr(Viewer, "wait_for_viewer", lambda self, what: waited.append(what))
    monkeypatch.setattr(Viewer, "stay", lambda self: waited.append("stay"))
    with watching(LiveFlags(live=True, port=0, speed=1.0), tmp_path, "mission", lambda run: (), RunControls) as viewers:
        assert waited == ["mission"]
        assert len(viewers) == 1
    assert waited == ["mission", "stay"]
    flags = LiveFlags(live=True, port=0, speed=1.0, wait=False)
    with watching(flags, tmp_path, "mission", lambda run: (), RunControls):
        assert "watch the mission at http://127.0.0.1:" in capsys.readouterr().err
    assert waited == ["mission", "stay"]


@pytest.mark.parametrize(("port", "speed", "said"), [(70000, 1.0, "--live-port"), (0, -1.0, "--live-speed")])
def test_a_flag_out_of_range_is_refused_before_anything_is_made(port, speed, said):
    with pytest.raises(InputError, match=said):
        LiveFlags(live=True, port=port, speed=speed).check()
