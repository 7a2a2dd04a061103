from dataclasses import replace

import pytest

from coral.errors import InputError
from coral.lens import Lens, check_lens

PLAIN = Lens(width=64, height=48, fx=40.0, fy=40.0, cx=31.5, cy=23.5)


@pytest.mark.parametrize(
    ("lens", "said"),
    [
        (replace(PLAIN, fx=-1.0), "fx: found -1"),
        (replace(PLAIN, fx=float("nan")), "fx: found nan"),
        (replace(PLAIN, cy=90.0), "cy: found 90.0, expected a principal point within the 48 pixels"),
        (replace(PLAIN, model="double_sphere"), "model: found 'double_sphere'"),
        (replace(PLAIN, distortion=(0.1, 0.2)), "distortion: found .*, expected 0 or 4 or 5 finite numbers"),
        (replace(PLAIN, width=10**9), "width, height"),
        (replace(PLAIN, width=0), "width, height"),
    ],
)
def test_a_lens_that_cannot_be_is_one_line(lens, said):
    with pytest.raises(InputError, match=said):
        check_lens(lens, "cam")
