import pytest
from painted_table import BOX

from coral.contact.real_scenes.masks import mask_registry
from coral.contact.real_scenes.masks.colour_masks import ColourMasks
from coral.contact.real_scenes.masks.mask_registry import make_masks, mask_help
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.errors import InputError

TRIAL = sample_trial(load_task("pick-box"), 0)
MODELS = {"box": BOX}


def test_colours_of_the_task_or_of_a_file(tmp_path):
    (tmp_path / "c.yaml").write_text("objects: {box: {hue_deg: [0, 20]}}")
    assert isinstance(make_masks("colour", TRIAL, MODELS), ColourMasks)
    assert make_masks(f"colour:{tmp_path / 'c.yaml'}", TRIAL, MODELS).regions["box"].hue_deg == (0, 20)


def test_an_object_that_a_file_does_not_name_is_one_line(tmp_path):
    (tmp_path / "c.yaml").write_text("objects: {can: {hue_deg: [0, 20]}}")
    with pytest.raises(InputError, match=r"objects\.box: found missing"):
        make_masks(f"colour:{tmp_path / 'c.yaml'}", TRIAL, MODELS)


@pytest.mark.parametrize(("word", "told"), [("color", "did you mean 'colour'"), ("", "colour")])
def test_a_word_that_names_none_is_one_line(word, told):
    with pytest.raises(InputError, match=told):
        make_masks(word, TRIAL, MODELS)


def test_another_package_offers_masks(monkeypatch):
    monkeypatch.setattr(mask_registry, "named_plugin", lambda *words, ours: lambda *given: given)
    assert make_masks("network:box.onnx", TRIAL, MODELS) == ("box.onnx", TRIAL, MODELS)


def test_the_help_lists_all_forms():
    assert "colour[:FILE]" in mask_help()
