"""The flags of the viewer."""

import pytest

from coral import plugins
from coral.commands.live import LiveFlags, watching
from coral.errors import InputError


def test_without_the_flag_nobody_watches_and_nothing_is_checked():
    flags = LiveFlags(live=False, live_port=70000, live_speed=-1.0)
    flags.check()
    with watching(flags, "reef", object()) as viewers:
        assert viewers == []


@pytest.mark.wing("coral.view")
@pytest.mark.parametrize(("port", "speed", "said"), [(70000, 1.0, "--live-port"), (0, -1.0, "--live-speed")])
def test_a_flag_out_of_range_is_refused_before_anything_is_made(port, speed, said):
    with pytest.raises(InputError, match=said):
        LiveFlags(live=True, live_port=port, live_speed=speed).check()


def test_a_missing_viewer_is_said_before_anything_is_made(monkeypatch):
    monkeypatch.setitem(plugins.OURS, "live", {"run": "coral.no_such_wing:watching"})
    with pytest.raises(InputError, match=r"--live: found 'run', expected the wing coral.no_such_wing"):
        LiveFlags(live=True, live_port=0, live_speed=1.0).check()
