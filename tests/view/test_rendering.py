"""What a finished run is rendered as."""

import pytest

from coral.errors import InputError
from coral.view.rendering import render_attempt, render_survey


@pytest.mark.parametrize("render", [render_survey, render_attempt])
def test_only_what_is_asked_for_is_made(render, tmp_path):
    assert render(tmp_path, report=False, video=False) == {}
    for asked in ({"report": True, "video": False}, {"report": False, "video": True}):
        with pytest.raises(InputError, match=str(tmp_path)):
            render(tmp_path, **asked)
