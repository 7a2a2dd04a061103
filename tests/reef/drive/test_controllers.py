import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.drive.controller import DdpMppi, MppiCfg
from coral.reef.drive.controllers import ControllerSetup, controller_maker, part_name
from coral.reef.drive.pd import PdController
from coral.reef.vehicle.vehicle import VehicleCfg


def setup():
    return ControllerSetup(cfg=MppiCfg(), vehicle=VehicleCfg(), rng=np.random.default_rng(0), control_period_s=0.1)


@pytest.mark.parametrize(("name", "kind"), [("ddp-mppi", DdpMppi), ("pd", PdController)])
def test_ours_are_made_by_name(name, kind):
    assert isinstance(controller_maker(name)(setup()), kind)


def test_a_function_is_taken_as_it_is():
    assert controller_maker(PdController) is PdController


@pytest.mark.parametrize(("controller", "said"), [("ddp-mpi", "did you mean 'ddp-mppi'"), (3, "found 3")])
def test_what_is_no_controller_is_refused(controller, said):
    with pytest.raises(InputError, match=said):
        controller_maker(controller)


def test_a_part_is_recorded_under_its_own_name_or_that_of_its_class():
    class Named:
        name = "mine"

    class Bare:
        pass

    assert [part_name(part) for part in ("pd", Named(), PdController)] == ["pd", "mine", "PdController"]
    assert part_name(Bare()).endswith("Bare")
