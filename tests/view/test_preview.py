import numpy as np
import pytest
from PIL import Image

from coral.reef.pictures.mapframe import CELL_COLORS
from coral.reef.world.world import load_world
from coral.reef.world.world_model import Current, Thing
from coral.view.preview import preview, preview_sheet


@pytest.fixture(scope="module")
def world():
    return load_world("l1")


def picture(path):
    return np.asarray(Image.open(path).convert("RGB"))


def test_a_preview_shows_the_floor_rocks_and_oysters(world, tmp_path):
    rgb = picture(preview(world, tmp_path / "one.png"))
    floor, rocks, oysters = ((rgb == colour).all(axis=2).mean() for colour in CELL_COLORS[1:])
    assert 0.3 < floor < 0.95
    assert rocks > 0.01
    assert oysters > 0.001


def test_a_sheet_is_as_wide_as_its_columns_and_all_are_at_one_scale(world, tmp_path):
    large = world.model_copy(update={"size_m": (40.0, 40.0)})
    wide, high = (
        picture(preview_sheet([world, large], tmp_path / f"{columns}.png", columns=columns)) for columns in (2, 1)
    )
    assert wide.shape[1] > 1.9 * high.shape[1]
    assert wide.shape[0] < high.shape[0]
    floor = (wide == CELL_COLORS[1]).all(axis=2)
    half = floor.shape[1] // 2
    assert 3.0 < floor[:, half:].sum() / floor[:, :half].sum() < 5.5  # 20 m and 40 m


def test_the_name_of_a_world_may_be_odd(world, tmp_path):
    named = world.model_copy(update={"name": "$x_$\u202e"})
    assert preview(named, tmp_path / "one.png").stat().st_size > 1000
    assert preview_sheet([named], tmp_path / "sheet.png", columns=1).stat().st_size > 1000


@pytest.mark.parametrize(
    "more", [{"things": (Thing(name="net", kind="ghost-net", x=5.0, y=15.0),)}, {"current": Current(x_m_s=0.2)}]
)
def test_other_things_and_the_current_are_drawn(world, tmp_path, more):
    plain = world.model_copy(update={"current": Current()})
    before, after = (picture(preview(one, tmp_path / "one.png")) for one in (plain, plain.model_copy(update=more)))
    assert (before != after).any()
