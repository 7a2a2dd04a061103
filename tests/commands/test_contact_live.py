"""The flags of a contact task's live page."""

from types import SimpleNamespace

import pytest

from coral.commands.contact_live import LiveFlags, watching
from coral.errors import InputError


def test_without_the_flag_nobody_watches_and_nothing_is_checked():
    flags = LiveFlags(live=False, port=70000, speed=-1.0)
    flags.check()
    with watching(SimpleNamespace(), flags) as viewers:
        assert viewers == []


@pytest.mark.parametrize(("port", "speed", "said"), [(70000, 1.0, "--live-port"), (0, -1.0, "--live-speed")])
def test_a_flag_out_of_range_is_refused_before_anything_is_made(port, speed, said):
    with pytest.raises(InputError, match=said):
        LiveFlags(live=True, port=port, speed=speed).check()
