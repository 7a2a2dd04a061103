import subprocess
import sys

import cv2
import numpy as np
import pytest

from coral.drawing import contact_sheet, draw_arrow, draw_line, draw_text, palette_png, png, text_size

ODD = "a\ud800b\x00\x1b[31m\u202e\uffff<b>"
DRAW = """
import numpy as np
from coral.drawing import draw_text
for text in {texts!r}:
    draw_text(np.zeros((40, 300, 3), np.uint8), text, 10, 20)
"""


def read(data):
    return cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)


def test_indexed_png_reads_back():
    rng = np.random.default_rng(0)
    for count in (4, 200):
        classes = rng.integers(0, count, (7, 13)).astype(np.uint8)
        palette = rng.integers(0, 256, (count, 3)).astype(np.uint8)
        back = cv2.imdecode(np.frombuffer(palette_png(classes, palette), np.uint8), cv2.IMREAD_COLOR)[..., ::-1]
        np.testing.assert_array_equal(back, palette[classes])


def test_text_never_leaves_the_picture():
    image = np.full((40, 60, 3), 255, np.uint8)
    draw_text(image, "long words that do not fit", 55, 38, size=20, halo=3)
    draw_text(image, "x", -500, -500)
    assert image.shape == (40, 60, 3)


def test_a_picture_reads_back_and_one_of_another_type_is_refused():
    rng = np.random.default_rng(0)
    rgb = rng.integers(0, 256, (7, 9, 3)).astype(np.uint8)
    np.testing.assert_array_equal(read(png(rgb))[..., ::-1], rgb)
    deep = rng.integers(0, 65536, (7, 9)).astype(np.uint16)
    np.testing.assert_array_equal(read(png(deep)), deep)
    with pytest.raises((ValueError, cv2.error)):
        png(np.zeros((4, 4, 5), np.uint8))


@pytest.mark.parametrize(("anchor", "left", "top"), [("lt", 100, 50), ("mm", 50, 25), ("rb", 0, 0)])
def test_text_stands_where_its_anchor_says(anchor, left, top):
    image = np.full((100, 200, 3), 255, np.uint8)
    width, height = text_size("HHH", 20)
    draw_text(image, "HHH", 100, 50, size=20, anchor=anchor)
    rows, columns = np.nonzero((image < 128).any(axis=2))
    shift = {"l": 0, "m": width / 2, "r": width}[anchor[0]], {"t": 0, "m": height / 2, "b": height}[anchor[1]]
    assert columns.min() == pytest.approx(100 - shift[0], abs=2)
    assert columns.max() == pytest.approx(100 - shift[0] + width, abs=2)
    assert 50 - shift[1] - 1 <= rows.min() <= rows.max() <= 50 - shift[1] + height + 1


def test_lines_and_arrows_of_no_length_draw_nothing():
    image = np.full((40, 40, 3), 255, np.uint8)
    draw_line(image, np.array([(5.0, 5.0)]), (0, 0, 0))
    draw_arrow(image, np.array([5.0, 5.0]), np.array([5.0, 5.0]), (0, 0, 0))
    assert (image == 255).all()


def test_a_picture_takes_any_text():
    """In a process of its own: OpenCV ended it."""
    done = subprocess.run(
        [sys.executable, "-c", DRAW.format(texts=[ODD, "\udfff", "\x00", "\n", ""])], capture_output=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_long_text_is_cut_and_other_text_looks_as_before():
    assert text_size("x" * 100_000, 14)[0] < 10_000
    assert text_size("a\ud800b", 14) == text_size("a\ufffdb", 14)
    one, two = (np.full((40, 300, 3), 255, np.uint8) for _ in range(2))
    draw_text(one, "3.1 N — α × β", 10, 20)
    draw_text(two, "3.1 N — α × γ", 10, 20)
    assert (one != two).any()


def test_pictures_lie_in_rows_below_their_titles():
    reds = [(f"{k}", np.full((30, 40, 3), (200, k, 0), np.uint8)) for k in range(3)]
    sheet = contact_sheet(reds, columns=2)
    found = (sheet[..., 0] == 200) & (sheet[..., 2] == 0)
    assert [int((found & (sheet[..., 1] == k)).sum()) for k in range(3)] == [1200, 1200, 1200]
    rows = [np.flatnonzero((found & (sheet[..., 1] == k)).any(axis=1))[0] for k in range(3)]
    assert rows[0] == rows[1] < rows[2]
    assert (sheet[: rows[0]] < 100).any()
