import cv2
import pytest

from coral.errors import InputError
from coral.view.contact.ablation import draw_ablation


@pytest.mark.parametrize("title", ["slide, world hand", "$x_$", "a\udcff\x1b"])
def test_runs_with_and_without_a_strategy_are_drawn_under_any_title(recorded, tmp_path, title):
    path = tmp_path / "ablation.png"
    draw_ablation({"with": [recorded, recorded], "without": [recorded], "never run": []}, path, title)
    height, width = cv2.imread(str(path)).shape[:2]
    assert width > 2 * height
    assert [file.name for file in tmp_path.iterdir()] == ["ablation.png"]


def test_a_killed_run_is_drawn_as_far_as_it_goes(copy, tmp_path):
    (copy / "metrics.json").unlink()
    for name in ("trajectory.csv", "events.jsonl"):
        text = (copy / name).read_text()
        (copy / name).write_text(text[: len(text) // 3])
    draw_ablation({"with": [copy]}, tmp_path / "ablation.png", "x")
    assert (tmp_path / "ablation.png").is_file()


def test_a_picture_that_cannot_be_written_and_a_folder_that_is_no_run_are_one_line(recorded, tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match="a file that can be written"):
        draw_ablation({"with": [recorded]}, tmp_path / "file" / "a.png", "x")
    with pytest.raises(InputError, match="the folder of a run"):
        draw_ablation({"with": [tmp_path / "none"]}, tmp_path / "a.png", "x")
