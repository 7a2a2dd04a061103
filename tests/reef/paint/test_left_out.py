import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="torch is only for training (extra train)")
pytest.importorskip("onnx", reason="onnx is only for training (extra train)")


def test_a_network_that_calls_all_oyster_has_full_recall_and_the_precision_of_the_share():
    from coral.reef.paint.collage import OTHER
    from coral.reef.paint.labelled_pictures import LabelledPicture
    from coral.reef.paint.left_out import measure_left_out
    from coral.reef.paint.unet import ReefNet
    from coral.reef.world.geometry import Label

    net = ReefNet().eval()
    net.lean[int(Label.OYSTER)] = 1e3
    target = np.full((40, 60), OTHER, np.uint8)
    target[:, :30] = int(Label.OYSTER)
    rows = measure_left_out(net, [LabelledPicture(f"v-{k}", np.zeros((40, 60, 3), np.uint8), target) for k in (1, 2)])
    assert rows == [{"video": "v", "iou": 0.5, "precision": 0.5, "recall": 1.0, "said": 1.0, "true": 0.5}]
