import numpy as np
import pytest
from given_networks import given, one_hot

from coral.errors import InputError
from coral.reef.eyes.doubt import choose_labels
from coral.reef.eyes.ground_plane import ground_depth
from coral.reef.eyes.perception import CameraAttitude
from coral.reef.networks.class_table import ClassTable
from coral.reef.networks.semantic_map import SemanticEyes, gather_labels, resize_channels
from coral.reef.vehicle.camera import CameraCfg
from coral.reef.world.geometry import Label

CAMERA = CameraCfg(width=4, height=2)
LABELS = [[0, 2, 0, 0], [3, 2, 1, 3]]


def perceive(**outputs):
    file = given(outputs)
    seen = SemanticEyes(file).perceive(np.full((2, 4, 3), 255, np.uint8), CAMERA, CameraAttitude(height=0.8))
    return seen, file.session.fed


def test_without_depth_it_follows_from_the_height():
    seen, fed = perceive(logits=one_hot(LABELS))
    ground = ground_depth(CAMERA, 0.8)
    assert seen.labels.tolist() == LABELS
    assert seen.depth[1].tolist() == ground[1].tolist()
    assert seen.depth[0, 1] == ground[1, 1]
    assert fed.shape == (1, 3, 2, 4)
    assert (fed == 1.0).all()


def test_a_depth_of_its_own_is_taken_as_it_is_but_not_for_water():
    seen, _ = perceive(logits=one_hot(LABELS), depth=np.full((1, 1, 2, 4), 1.5, np.float32))
    assert seen.depth[1, 2] == 1.5
    assert np.isinf(seen.depth[0, 0])


def test_coarse_maps_are_scaled_to_the_camera():
    assert resize_channels(np.ones((4, 1, 2), np.float32), CAMERA).shape == (4, 2, 4)


def test_a_missing_map_and_a_wrong_number_of_classes_are_named():
    with pytest.raises(InputError, match=r"net\.onnx: metadata.names: found none, expected a class"):
        SemanticEyes(given({"y": np.zeros((1, 4, 2, 4), np.float32)}))
    with pytest.raises(InputError, match=r"net\.onnx: outputs: found y .*, expected logits of shape"):
        SemanticEyes(given({"y": np.zeros((1, 1, 2, 4), np.float32)}))
    with pytest.raises(InputError, match=r"outputs\.logits: found 2 channels for the classes 0"):
        SemanticEyes(given({"logits": np.zeros((1, 2, 2, 4), np.float32)}, metadata={"names": "{0: 'oyster'}"}))


def test_classes_of_one_meaning_are_added():
    table = ClassTable({}, {0: Label.SEABED, 1: Label.OYSTER, 2: Label.OYSTER})
    shares = np.array([0.4, 0.3, 0.3], np.float32)[:, None, None]
    gathered = gather_labels(shares, table)
    labels, doubt = choose_labels(gathered, 0.4)
    assert labels[0, 0] == Label.OYSTER
    assert doubt[0, 0] == pytest.approx(0.4, abs=1e-4)
