import cv2
import pytest

from coral.campaign.measures import field
from coral.campaign.sweep_figure import draw_sweep

COVERAGE = field("coverage", "coverage (%)", "coverage", 100.0)
HITS = field("collisions", "collisions", "collisions")


def row(overrides="{}", world="l1", coverage=1.0):
    return {
        "variant": "full",
        "world": world,
        "seed": 0,
        "overrides": overrides,
        "coverage": coverage,
        "collisions": None,
    }


ROWS = [row(overrides, world) for world in ("l1", "s1") for overrides in ("{}", '{"current": 0.1}', '{"current": 2}')]


@pytest.fixture
def size(tmp_path):
    """Draws a figure; its width and height, or None if none was made."""

    def draw(variants, measures):
        path = tmp_path / "sweep.png"
        path.unlink(missing_ok=True)
        assert draw_sweep(variants, measures, path, title="t") is path.exists()
        return cv2.imread(str(path)).shape[1::-1] if path.exists() else None

    return draw


def test_each_key_has_a_column_and_each_measure_a_line(size):
    width, height = size({"full": ROWS}, (COVERAGE,))
    more = [row(f'{{"key_{k}": {k}}}') for k in range(2)]
    assert size({"full": ROWS + more}, (COVERAGE,))[0] > width
    assert size({"full": ROWS}, (COVERAGE, HITS))[1] > height


def test_variants_and_values_that_some_lack_are_drawn_all_the_same(size):
    assert size({"full": [*ROWS, row('{"driver": "pd"}')], "pd": ROWS[:1], "none": []}, (COVERAGE, HITS))


def test_nothing_swept_makes_no_figure(size):
    assert size({"full": [row()]}, (COVERAGE,)) is None
    assert size({"full": [row(), row('{"current": 1, "driver": "pd"}')]}, (COVERAGE,)) is None
