"""Vehicles to drive in tests: the simulated autopilot, and ArduSub in the loop where CORAL_ARDUSUB names its folder."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))  # so that tests can import `messages` and `sea_vehicles`

from sea_vehicles import ArduSub, SimulatedVehicle

HOME = "43.0,-70.0,0,90"


@pytest.fixture(scope="session")
def ardusub_port(tmp_path_factory):
    """Start ArduSub in the loop; the folder with `ardusub` and `sub-6dof.parm` stands in CORAL_ARDUSUB."""
    if "CORAL_ARDUSUB" not in os.environ:
        pytest.skip("CORAL_ARDUSUB names no folder with ArduSub for simulation")
    home = Path(os.environ["CORAL_ARDUSUB"]).resolve()
    command = [home / "ardusub", "--wipe", "--model", "vectored_6dof", "--defaults", home / "sub-6dof.parm"]
    where = tmp_path_factory.mktemp("ardusub")
    with open(where / "log", "wb") as log:
        process = subprocess.Popen([*command, "-I7", "--home", HOME], cwd=where, stdout=log, stderr=log)
    yield 5760 + 70
    process.kill()
    process.wait()


@pytest.fixture(params=["simulated", pytest.param("ardusub", marks=pytest.mark.ardusub)])
def vehicle(request):
    """A vehicle with a position, disarmed."""
    if request.param == "simulated":
        vehicle = SimulatedVehicle()
        vehicle.run(2.0)
    else:
        vehicle = ArduSub(request.getfixturevalue("ardusub_port"))
        for _ in range(60):
            if vehicle.run(2.0).has_position:
                break
    assert vehicle.link.report().has_position
    yield vehicle
    if vehicle.link.telemetry.said.armed:
        vehicle.link.disarm()
    vehicle.close()
