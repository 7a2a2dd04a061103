import numpy as np
import pytest
from painted_table import BOX

from coral.contact.real_scenes.masks import mask_source
from coral.contact.real_scenes.masks.colour_masks import ColourMasks
from coral.contact.real_scenes.masks.mask_source import clean_mask, make_masks
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.errors import InputError

TRIAL = sample_trial(load_task("pick-box"), 0)
MODELS = {"box": BOX}


def test_colours_of_the_task_or_of_a_file(tmp_path):
    (tmp_path / "c.yaml").write_text("objects: {box: {hue_deg: [0, 20]}}")
    assert isinstance(make_masks("colour", TRIAL, MODELS), ColourMasks)
    assert make_masks(f"colour:{tmp_path / 'c.yaml'}", TRIAL, MODELS).regions["box"].hue_deg == (0, 20)


@pytest.mark.parametrize(("word", "told"), [("color", "did you mean 'colour'"), ("", "colour")])
def test_a_word_that_names_none_is_one_line(word, told):
    with pytest.raises(InputError, match=told):
        make_masks(word, TRIAL, MODELS)


def test_another_package_offers_masks(monkeypatch):
    monkeypatch.setattr(mask_source, "named_plugin", lambda *words: lambda *given: given)
    assert make_masks("network:box.onnx", TRIAL, MODELS) == ("box.onnx", TRIAL, MODELS)


def test_speckles_go_and_large_parts_stay():
    mask = np.zeros((40, 40), bool)
    mask[2:12, 2:12] = mask[2:10, 20:28] = mask[30:33, 30:33] = True  # 100, 64 and 9 pixels
    mask[20, 5] = True
    cleaned = clean_mask(mask)
    assert cleaned[5, 5]
    assert cleaned[5, 24]
    assert not cleaned[20:].any()


def test_an_empty_mask_stays_empty():
    assert not clean_mask(np.zeros((8, 8), bool)).any()
