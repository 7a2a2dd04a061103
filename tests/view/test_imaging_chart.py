import json

from coral.view.figures import imaging_chart
from coral.view.report import render_report
from coral.view.run import RunFolder

CURVE = "step,t,imaged,inspected,reef_m\n0,0,0.1,0,0\n100,10,0.6,0.4,0\n200,20,1,0.85,0\n300,30,1,0.92,0\n"


def judged(folder, text=CURVE):
    (folder / "judge.csv").write_text(text)
    return RunFolder.read(folder)


def test_both_curves_are_drawn_with_the_times_that_count(fresh):
    svg = imaging_chart(judged(fresh))
    assert svg.count("stroke-width: 2") == 4  # two curves, and their lines in the legend
    assert "inspected 92%" in svg
    marks = [f"{share}% inspected at {at}" for share, at in ((50, "0:20"), (80, "0:20"), (90, "0:30"))]
    assert all(mark in svg for mark in marks)
    assert "100% inspected at" not in svg


def test_the_report_shows_them_and_the_figure(fresh):
    metrics = json.loads((fresh / "metrics.json").read_text())
    more = {"inspected": 0.92, "imaged": 1.0, "time_to_90_s": 30.0, "oracle_ratio_90": 1.75}
    (fresh / "metrics.json").write_text(json.dumps({**metrics, **more}))
    html = render_report(judged(fresh))
    assert "Imaged and inspected" in html
    assert "90 % at 0:30, 1.8 × oracle" in html


def test_a_run_that_was_not_judged_has_neither(fresh):
    assert imaging_chart(RunFolder.read(fresh)) == ""
    assert "Imaged and inspected" not in render_report(RunFolder.read(fresh))
    assert imaging_chart(judged(fresh, "step,t,imaged,inspected,reef_m\n")) == ""


def test_a_killed_run_is_judged_as_far_as_it_goes(fresh):
    (fresh / "metrics.json").unlink()
    html = render_report(judged(fresh, CURVE + "400,40,1,0."))
    assert "90 % at 0:30" in html
