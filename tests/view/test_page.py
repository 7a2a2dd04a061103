import jinja2
import pytest

from coral.view.page import metric_name, metric_rows, metric_text, origin, render_page, write_page
from coral.view.run import RunFolder


def test_a_page_says_what_is_missing_and_escapes_every_text():
    with pytest.raises(jinja2.UndefinedError):
        render_page("tables.html.j2", title="x")
    table = {"name": "<script>", "caption": "", "header": ["a", "b"], "rows": [["x", "<b>"]], "notes": []}
    page = render_page("tables.html.j2", title="x", tables=[table], shared=[])
    assert "&lt;script&gt;" in page
    assert "<td>&lt;b&gt;</td>" in page
    assert page.count("<style>") == page.count("</html>") == 1


def test_metrics_are_named_with_units_and_read_as_people_do():
    assert [metric_name(k) for k in ("v_m_s", "plan_ms", "peak_n")] == ["v (m/s)", "plan (ms)", "peak (N)"]
    assert [metric_name(k) for k in ("plan_ms_p99", "stages")] == ["plan p99 (ms)", "changes of stage"]
    assert metric_rows({"hold": 1}, {"hold": "its `hold_s` & more"})[0][2] == "its <code>hold_s</code> &amp; more"
    assert [metric_text("x", v) for v in (None, True, 0.5, 1234.0, {"a": 1})] == ["–", "yes", "0.5", "1,234", "a 1"]
    assert metric_text("coverage", 1) == "100.0%"
    assert metric_rows({"conditions": [], "steps": 3}, {"steps": "ticks"}) == [("steps", "3", "ticks")]


def test_the_origin_of_a_run_is_told_from_its_first_event_and_its_configuration(finished, tmp_path):
    run = RunFolder.read(finished)
    told = origin(run, ("world", "none"), tuple(run.timing))
    names = [name for name, _ in told["provenance"]]
    assert names[0] == "world"
    assert "none" not in names
    assert told["config"]
    assert write_page(tmp_path, "page", "p.html").read_text() == "page"
