import pytest

from coral.errors import InputError
from coral.reef.world.world_names import WORLDS_DIR, shipped_worlds, world_file


def test_a_name_means_a_shipped_file_and_a_path_itself(tmp_path):
    assert world_file("k1") == WORLDS_DIR / "k1.yaml"
    assert world_file(tmp_path / "own.yaml") == tmp_path / "own.yaml"  # whether it is there is told by reading it
    assert all(world_file(name).is_file() for name in shipped_worlds())


def test_a_mistyped_name_is_answered_with_the_nearest():
    with pytest.raises(InputError, match=r"world: found 'K1x', expected a YAML file or one of l1, .*did you mean 'k1'"):
        world_file("K1x")


def test_a_file_beside_without_its_ending_is_suggested(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bay.yaml").write_text("")
    with pytest.raises(InputError, match=r"did you mean 'bay\.yaml'"):
        world_file("bay")
