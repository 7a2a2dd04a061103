import numpy as np
import pytest

from coral.contact.real_scenes.calibration.wrong_entry import check_fit
from coral.errors import InputError


def check(*values):
    check_fit(lambda chosen: float(np.std([values[i] for i in chosen])), len(values), 0.2, "m", 3, ("f.yaml", "values"))


def test_the_entry_that_spoils_the_fit_is_named():
    check(1.0, 1.1, 0.9)
    with pytest.raises(InputError, match=r"f\.yaml: values\[2\]: found a residual of 3\.5 m; without it"):
        check(1.0, 1.1, 9.0, 0.9)


@pytest.mark.parametrize("values", [(1.0, 5.0, 9.0, 0.9), (1.0, 1.1, 9.0)])
def test_two_wrong_entries_are_no_single_one_and_of_three_none_can_be_spared(values):
    with pytest.raises(InputError, match="values: found"):
        check(*values)
