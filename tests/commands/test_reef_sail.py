from contextlib import ExitStack
from pathlib import Path
from types import SimpleNamespace

import pytest

from coral.cli import main
from coral.commands.reef_sail import ReefSail
from coral.errors import InputError
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.sea.operator import OperatorWords


def test_yes_is_refused_where_a_real_vehicle_would_arm(capsys):
    assert main(["reef", "sail", "s1", "--vehicle", "mavlink:udp:127.0.0.1:14999", "--yes"]) == 2
    told = capsys.readouterr().err.strip().splitlines()
    assert len(told) == 1
    assert "--yes" in told[0]
    assert "may be a real vehicle" in told[0]


@pytest.mark.parametrize(
    ("flags", "where"),
    [
        ({"seed": -1}, "--seed"),
        ({"camera_latency": 3.0}, "--camera-latency"),
        ({"start": (0.0, 0.0, 0.0)}, "--start"),
        ({"cfg": MissionCfg(decider="sweep")}, "--cfg.decider"),
        ({"cfg": MissionCfg(time_limit_s=20.0)}, "--cfg.time-limit-s"),
        ({"perception": "nope"}, "--perception"),
        ({"lens": Path("camera.yaml")}, "--lens"),
    ],
)
def test_bad_flags_are_one_line(flags, where):
    with pytest.raises(InputError) as error:
        ReefSail(area="s1", check=True, quiet=True, **flags)()
    assert error.value.where == where


def test_whoever_sails_over_ros_2_can_change_the_instruction(monkeypatch):
    made = []

    def topics(*given):
        made.append(given)
        return SimpleNamespace(close=lambda: made.append("closed"))

    monkeypatch.setattr("coral.commands.reef_sail.our_part", lambda *names: topics)
    words, mission = OperatorWords(), SimpleNamespace(instructing=print)
    mission.crew = SimpleNamespace(words=words)
    with ExitStack() as opened:
        assert len(list(ReefSail(area="s1", vehicle="ros2:/rov")._observers(mission, opened))) == 1
        assert list(ReefSail(area="s1")._observers(mission, opened)) == []
    assert made == [("/rov", words, print), "closed"]
