import pytest

from coral.contact.control.hand_controllers import hand_controller_maker
from coral.contact.control.mppi_controller import Controller
from coral.errors import InputError


def test_ours_is_made_by_name_and_a_function_is_taken_as_it_is():
    assert hand_controller_maker("mppi") is Controller
    assert hand_controller_maker(Controller) is Controller


@pytest.mark.parametrize(("controller", "said"), [("mpi", "did you mean 'mppi'"), (3, "found 3")])
def test_what_is_no_controller_is_refused(controller, said):
    with pytest.raises(InputError, match=said):
        hand_controller_maker(controller)
