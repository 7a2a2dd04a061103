import pytest

from coral import plugins
from coral.advisor.setting import known_mistakes


@pytest.mark.wing("coral.erring")
@pytest.mark.parametrize(("system", "name"), [("reef", "mirrored"), ("contact", "goal-off")])
def test_each_system_has_its_own_plausible_errors(system, name):
    assert name in {one.name for one in known_mistakes(system)}


def test_without_their_wing_there_are_none(monkeypatch):
    monkeypatch.setitem(plugins.OURS, "mistakes", {"reef": "coral.no_such_wing:ERRORS"})
    assert known_mistakes("reef") == ()
