"""The handle of the simulated arm; the simulation itself is tested by `make test-franka`."""

import pytest
from episodes import make_trial

from coral.contact.franka import double as module
from coral.contact.franka.double import Double
from coral.contact.worlds.franka_cfg import FrankaCfg
from coral.errors import InputError, RunError


def serve(trial, arm, speed, state, connection):
    """Answer as the simulation does, but from nothing."""
    connection.send(("ok", "127.0.0.3"))
    while True:
        question, value = connection.recv()
        if question == "stop":
            return
        if question == "truth":
            connection.send(("error", "ValueError: no truth"))
        else:
            connection.send(("ok", value))


@pytest.fixture
def double(monkeypatch, in_threads):
    monkeypatch.setitem(__import__("sys").modules, "franky_sim", object())
    monkeypatch.setattr(module, "_serve", serve)
    found = Double(make_trial(), FrankaCfg())
    yield found
    found.close()


def test_it_tells_its_address_and_takes_wishes(double):
    assert double.address == "127.0.0.3"
    double.send_poses_to("127.0.0.1", 5577)


def test_a_failure_in_the_simulation_is_told(double):
    with pytest.raises(RunError, match="the simulated arm failed: ValueError: no truth"):
        double.truth()


def test_without_the_package_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "franky_sim", None)
    with pytest.raises(InputError, match=r"--robot: found sim .*expected the package franky-sim"):
        Double(make_trial(), FrankaCfg())
