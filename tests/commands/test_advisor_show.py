import pytest

from coral.advisor.prompt import kinds, version


def test_all_kinds_are_listed(told):
    assert told("advisor", "show", "list")[1].split() == kinds()


@pytest.mark.parametrize("kind", [kind for kind in kinds() if not kind.startswith("reef-")])
def test_a_prompt_is_shown_whole_and_written_as_it_is_shown(told, tmp_path, kind):
    code, result, _ = told("advisor", "show", kind, "--out", tmp_path / "shown", "--json")
    assert code == 0
    assert (result["kind"], result["version"], result["pictures"]) == (kind, version(kind), [])
    assert result["written"] == [str(tmp_path / "shown" / "prompt.md")]
    assert (tmp_path / "shown" / "prompt.md").read_text(encoding="utf-8") == result["prompt"]
    assert "{{" not in result["prompt"]


def test_a_reef_question_comes_with_the_pictures_of_a_mission(told, tmp_path):
    code, result, _ = told("advisor", "show", "reef-centroid", "--out", tmp_path, "--json")
    assert code == 0
    assert "map" in result["pictures"]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        ["prompt.md", *(f"{name}.png" for name in result["pictures"])]
    )
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in tmp_path.glob("*.png"))


def test_bad_words_are_one_line(refused, tmp_path):
    assert "did you mean 'reef-centroid'?" in refused("advisor", "show", "reef-centriod")
    (tmp_path / "file").write_text("")
    assert "--out" in refused("advisor", "show", "cost-function", "--out", tmp_path / "file" / "x")
