import numpy as np

from coral.contact.real_scenes.calibration.wrong_entry import find_wrong_entry


def spread(values):
    return lambda chosen: float(np.std([values[i] for i in chosen]))


def test_the_entry_that_spoils_the_fit_is_found():
    assert find_wrong_entry(spread([1.0, 1.1, 9.0, 0.9]), 4, 0.2) == 2


def test_two_wrong_entries_are_no_single_one():
    assert find_wrong_entry(spread([1.0, 5.0, 9.0, 0.9]), 4, 0.2) is None
