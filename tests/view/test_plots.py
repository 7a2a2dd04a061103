import numpy as np
import pytest

from coral.interface.mission import MissionResult
from coral.interface.result import ResultFolder
from coral.view.plots import plot_attempt, plot_survey

HEAD = "step,t,x,y,z,fx,fy,fz,cmd_qw,box_x,box_y,box_z,box_qw\n"


def test_a_survey_has_its_map_and_the_share_covered(finished):
    left, right = plot_survey(finished).axes
    assert left.images[0].get_array().shape[2] == 3
    assert right.lines[0].get_label() == "covered"
    assert 0 < right.lines[0].get_ydata()[-1] <= 100


def test_a_survey_without_a_map_is_titled_so(fresh):
    for file in (fresh / "frames").iterdir():
        file.unlink()
    assert "kept no map" in plot_survey(fresh).axes[0].get_title()


def test_an_attempt_has_the_way_of_each_object_and_the_force(tmp_path):
    rows = [f"{k},{0.1 * k},0,0,0,3,0,4,1,{0.01 * k},0,0,1\n" for k in range(3)]
    (tmp_path / "trajectory.csv").write_text(HEAD + "".join(rows))
    (tmp_path / "events.jsonl").write_text("")
    left, right = plot_attempt(tmp_path).axes
    assert [line.get_label() for line in left.lines] == ["box"]
    assert left.lines[0].get_ydata() == pytest.approx([0, 1, 2])
    assert np.allclose(right.lines[0].get_ydata(), 5.0)


def test_a_notebook_shows_values_and_plot(finished):
    html = MissionResult(ResultFolder(finished), {"end_reason": "time <limit>", "coverage": 0.5})._repr_html_()
    assert "time &lt;limit&gt;" in html
    assert "data:image/png;base64," in html
    assert str(finished.parent) not in html  # a notebook is shown to others
