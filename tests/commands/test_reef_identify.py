"""`coral reef identify`: refusals, and the file that it writes from a drive."""

import math

import pytest
import yaml

from coral.commands.reef_identify import ReefIdentify
from coral.config import read_config
from coral.errors import InputError
from coral.reef.sea.response_trial import TrialLog, legs
from coral.reef.vehicle.response import Trailing, VehicleResponse
from coral.reef.vehicle.vehicle import VehicleState

TRUE = VehicleResponse(surge_lag_s=0.3, yaw_lag_s=0.2)
NOBODY = "mavlink:udp:127.0.0.1:9"


def driven(self, link):
    """What a vehicle with the response `TRUE` does on the calibration drive, at 80 % of the speed asked for."""
    log, state, trailing, t = TrialLog(), VehicleState(0.0, 0.0, 0.0), Trailing(), 100.0
    for leg in legs(0.5, 0.5):
        for _ in range(round(leg.seconds / 0.1)):
            log.commands.append((t, leg.forward_m_s, leg.yaw_rate_rad_s))
            log.velocities.append((t, state.u, state.v, state.r))
            log.poses.append((t, state.x, state.y, math.remainder(state.theta, math.tau)))
            wanted = (0.8 * leg.forward_m_s, leg.yaw_rate_rad_s)
            state, trailing = TRUE.advance(state, trailing, wanted, 0.1)
            t += 0.1
    return log


def test_the_file_can_be_given_to_sail(tmp_path, monkeypatch):
    monkeypatch.setattr(ReefIdentify, "_drive", driven)
    command = ReefIdentify(vehicle=NOBODY, out=tmp_path / "response.yaml")
    result = command()
    found = read_config(tmp_path / "response.yaml", VehicleResponse())
    assert found.surge_gain == pytest.approx(0.8, abs=0.02)
    assert (1 - found.trail) * found.surge_lag_s + found.trail * found.trail_lag_s == pytest.approx(0.3, abs=0.1)
    assert found.yaw_lag_s == pytest.approx(0.2, abs=0.06)
    assert "speed: 80%" in command.describe(result)
    assert set(yaml.safe_load((tmp_path / "response.yaml").read_text())) <= set(result)


def test_an_existing_file_is_not_overwritten(tmp_path):
    (tmp_path / "response.yaml").write_text("mine")
    with pytest.raises(InputError, match="--out"):
        ReefIdentify(vehicle=NOBODY, out=tmp_path / "response.yaml")()
    assert (tmp_path / "response.yaml").read_text() == "mine"


def test_a_vehicle_that_may_be_real_is_not_armed_without_asking(tmp_path):
    with pytest.raises(InputError, match="--yes"):
        ReefIdentify(vehicle=NOBODY, out=tmp_path / "response.yaml", yes=True)()
