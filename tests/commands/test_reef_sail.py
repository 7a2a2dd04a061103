import signal
from pathlib import Path

import pytest

from coral.cli import main
from coral.commands.reef_sail import ReefSail, conduct, signals_as_words
from coral.errors import InputError, RunError
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
        ({"fault": ("blind-sonar@5:2",)}, "--fault"),
        ({"cfg": MissionCfg(robots=2)}, "--cfg.robots"),
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


def test_a_signal_becomes_a_word_and_the_handler_is_put_back():
    words = OperatorWords()
    found = signal.signal(signal.SIGINT, signal.default_int_handler)  # a process in the background ignores it
    try:
        with signals_as_words(words):
            signal.raise_signal(signal.SIGINT)
        assert words.take() == [("stop", "SIGINT")]
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, found)


def test_a_failure_of_the_control_loop_is_told():
    class Broken:
        instructing = None

        def run(self, observers):
            raise ValueError("no way")

    with pytest.raises(RunError, match="ValueError: no way"):
        conduct(Broken(), [], OperatorWords())
