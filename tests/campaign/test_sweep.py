import pytest

from coral.campaign.measures import field
from coral.campaign.sweep import in_order, parse_sweeps, setting_text
from coral.campaign.sweep_figure import draw_sweep
from coral.campaign.sweep_tables import sweep_tables
from coral.errors import InputError

COVERAGE = field("coverage", "coverage (%)", "coverage", 100.0)
HITS = field("collisions", "collisions", "collisions")


def row(overrides="{}", world="l1", seed=0, coverage=1.0, collisions=0):
    return {
        "variant": "full",
        "world": world,
        "seed": seed,
        "overrides": overrides,
        "coverage": coverage,
        "collisions": collisions,
    }


ROWS = [
    row(overrides, world, seed, coverage, collisions)
    for world in ("l1", "s1")
    for seed in (0, 1)
    for overrides, coverage, collisions in (
        ('{"current": 0.5}', 0.5, 1 + seed),
        ("{}", 1.0, 0),
        ('{"current": 0.1}', 1.0, 0),
    )
]


def test_one_key_at_a_time_after_the_nominal_setting():
    assert parse_sweeps(["a.b=1,x", " c = true ", "a.b=1"]) == ({}, {"a.b": 1}, {"a.b": "x"}, {"c": True})
    assert parse_sweeps([]) == ({},)


@pytest.mark.parametrize("text", ["", "a", "=1", "a=", "a=1,,2"])
def test_what_is_no_sweep_is_refused(text):
    with pytest.raises(InputError, match="--sweep"):
        parse_sweeps([text])


def test_infinities_are_no_numbers():
    assert parse_sweeps(["a=NaN"])[1] == {"a": "NaN"}


def test_settings_in_words():
    assert setting_text("{}") == setting_text({}) == "nominal"
    assert setting_text('{"current": 0.2}') == "current=0.2"


def test_settings_are_put_in_order_whenever_they_were_asked_for():
    asked = ['{"b": 2}', '{"b": 10}', '{"a": "x"}', "{}", '{"b": 2}', '{"a": 1}', '{"b": 3.5}']
    assert in_order(asked) == ["{}", '{"b": 2}', '{"b": 3.5}', '{"b": 10}', '{"a": 1}', '{"a": "x"}']


def test_means_stand_with_the_nominal_setting_first():
    means, _ = sweep_tables(ROWS, (COVERAGE, HITS), "Who.", ("From where.",))
    assert means.header == ("setting", "missions", "coverage (%)", "collisions")
    assert means.rows == (
        ("nominal", "4", "100.0 [100.0, 100.0]", "0.0 [0.0, 0.0]"),
        ("current=0.1", "4", "100.0 [100.0, 100.0]", "0.0 [0.0, 0.0]"),
        ("current=0.5", "4", "50.0 [50.0, 50.0]", "1.5 [1.5, 1.5]"),
    )
    assert means.notes[-1] == "From where."
    assert means.notes[-2].startswith("Few worlds to draw from (2)")


def test_differences_are_paired_with_the_nominal_setting():
    _, differences = sweep_tables(ROWS, (COVERAGE, HITS), "Who.", ())
    assert differences.rows == (
        ("current=0.1", "4", "≈ 0.0 [0.0, 0.0]", "≈ 0.0 [0.0, 0.0]"),
        ("current=0.5", "4", "−50.0 [−50.0, −50.0]", "+1.5 [+1.5, +1.5]"),
    )
    assert any("could be shown for: current=0.1." in note for note in differences.notes)


def test_without_the_nominal_setting_there_are_no_differences():
    rows = [row for row in ROWS if row["overrides"] != "{}"]
    assert [table.name for table in sweep_tables(rows, (COVERAGE,), "Who.", ())] == ["Sweep"]


def test_nothing_swept_makes_no_table_and_no_figure(tmp_path):
    assert sweep_tables([row()], (COVERAGE,), "Who.", ()) == []
    assert draw_sweep({"full": [row()]}, (COVERAGE,), tmp_path / "sweep.png", title="t") is False
    assert not list(tmp_path.iterdir())


def test_the_figure(tmp_path):
    rows = [*ROWS, row('{"driver": "pd"}')]
    assert draw_sweep({"full": rows, "pd": ROWS[:1]}, (COVERAGE, HITS), tmp_path / "sweep.png", title="t") is True
    assert (tmp_path / "sweep.png").read_bytes().startswith(b"\x89PNG")
