import numpy as np

from coral.view.contact_sheet import contact_sheet


def test_pictures_lie_in_rows_below_their_titles():
    reds = [(f"{k}", np.full((30, 40, 3), (200, k, 0), np.uint8)) for k in range(3)]
    sheet = contact_sheet(reds, columns=2)
    found = (sheet[..., 0] == 200) & (sheet[..., 2] == 0)
    assert [int((found & (sheet[..., 1] == k)).sum()) for k in range(3)] == [1200, 1200, 1200]
    rows = [np.flatnonzero((found & (sheet[..., 1] == k)).any(axis=1))[0] for k in range(3)]
    assert rows[0] == rows[1] < rows[2]
    assert (sheet[: rows[0]] < 100).any()
