import numpy as np
import pytest
from PIL import Image

from coral.reef.world.world import load_world
from coral.reef.world.world_model import Thing
from coral.view.preview import SEABED, preview, preview_sheet


@pytest.fixture(scope="module")
def world():
    return load_world("l1")


def test_a_preview_is_mostly_seabed(world, tmp_path):
    rgb = np.asarray(Image.open(preview(world, tmp_path / "one.png")).convert("RGB"))
    seabed = tuple(int(SEABED[k : k + 2], 16) for k in (1, 3, 5))
    assert 0.3 < (rgb == seabed).all(axis=2).mean() < 0.95


def test_a_sheet_is_as_wide_as_its_columns(world, tmp_path):
    sizes = [
        Image.open(preview_sheet([world] * 2, tmp_path / f"{columns}.png", columns=columns)).size for columns in (1, 2)
    ]
    assert sizes[1][0] == 2 * sizes[0][0]
    assert sizes[1][1] < sizes[0][1]


def test_the_name_of_a_world_is_no_formula(world, tmp_path):
    named = world.model_copy(update={"name": "$x_$"})
    assert preview(named, tmp_path / "one.png").stat().st_size > 1000
    assert preview_sheet([named], tmp_path / "sheet.png", columns=1).stat().st_size > 1000


def test_the_legend_has_room_and_names_other_things_where_there_are_any(world, tmp_path):
    net = world.model_copy(update={"things": (Thing(name="net", kind="ghost-net", x=5.0, y=5.0),)})
    rows = [np.asarray(Image.open(preview(one, tmp_path / "one.png")).convert("L"))[-70:] for one in (world, net)]
    for legend in rows:
        assert (legend[:, :8] == 255).all()
        assert (legend[:, -8:] == 255).all()
    assert (rows[1] < 128).sum() > (rows[0] < 128).sum()
