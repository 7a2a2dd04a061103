import pytest

from coral.contact.episode.policy_cfg import LiberoCfg


def test_a_world_ticks_so_often_during_an_action():
    assert LiberoCfg(rate_hz=20.0, ticks=5).tick_s == pytest.approx(0.01)
