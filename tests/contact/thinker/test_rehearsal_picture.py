from types import SimpleNamespace

import cv2
import numpy as np

from coral.contact.plan.imagined_run import ImaginedMoment
from coral.contact.scene.observation import BodyState, Observation
from coral.contact.thinker.rehearsal_picture import SIZE, draw_rehearsal


def test_moments_stand_side_by_side_and_show_where_things_were(scene):
    one = scene("pick-box")
    box = one.now.objects["box"]
    moved = {"box": BodyState(box.position + np.array([0.1, 0.1, 0.0]), box.quaternion)}
    later = Observation(1.0, one.now.tool, one.now.opening_m, one.now.wrench, moved)
    moments = [ImaginedMoment(now, "reach", "reach", SimpleNamespace()) for now in (one.now, one.now, later)]
    image = cv2.imdecode(np.frombuffer(draw_rehearsal(one.world, one.trial, moments).png, np.uint8), cv2.IMREAD_COLOR)
    assert image.shape == (SIZE[1], 3 * SIZE[0], 3)
    below_text = image[30:]
    first, second, third = (below_text[:, k * SIZE[0] : (k + 1) * SIZE[0]] for k in range(3))
    np.testing.assert_array_equal(first, second)
    assert (first != third).any()
