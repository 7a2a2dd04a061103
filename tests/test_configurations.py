import pytest

from coral.configurations import CONFIGURATIONS, configuration_at
from coral.surface import described


@pytest.mark.parametrize("name", CONFIGURATIONS)
def test_every_configuration_has_keys_and_is_found_by_its_class(name):
    place, flag, _ = CONFIGURATIONS[name]
    assert flag.startswith("--")
    assert len(described(place).flags) > 5
    assert configuration_at(place) == name
    assert configuration_at("coral.nowhere:Nothing") is None
