"""What a finished run is rendered as."""

import pytest

from coral.errors import InputError
from coral.view.rendering import render_run


@pytest.mark.parametrize("task", [False, True])
def test_only_what_is_asked_for_is_made(task, tmp_path):
    if task:
        (tmp_path / "task.yaml").write_text("")
    assert render_run(tmp_path, report=False, video=False) == {}
    for asked in ({"report": True, "video": False}, {"report": False, "video": True}):
        with pytest.raises(InputError, match=str(tmp_path)):
            render_run(tmp_path, **asked)
