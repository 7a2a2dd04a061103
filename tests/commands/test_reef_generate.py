import pytest

from coral.reef.world.world import load_world

SMALL = ("--clusters", "2", "--obstacles", "3", "--seed", "4")


def test_the_file_is_the_reef_that_was_told_and_says_how_it_was_made(told, tmp_path):
    path = tmp_path / "new" / "mine.yaml"
    code, result, err = told("reef", "generate", "--out", path, *SMALL, "--json")
    assert (code, err) == (0, "")
    world = load_world(path)
    assert result == {"world": str(path), "clusters": len(world.clusters), "obstacles": len(world.obstacles)}
    assert (world.name, len(world.clusters)) == ("mine", 2)
    assert "coral reef generate" in path.read_text().splitlines()[0]


def test_the_same_flags_make_the_same_file(told, tmp_path):
    for folder in ("a", "b"):
        assert told("reef", "generate", "--out", tmp_path / folder / "w.yaml", *SMALL)[0] == 0
    assert (tmp_path / "a" / "w.yaml").read_bytes() == (tmp_path / "b" / "w.yaml").read_bytes()


@pytest.mark.wing("coral.view")
def test_a_reef_grows_along_a_polyline_and_is_drawn(told, tmp_path):
    path, picture = tmp_path / "w.yaml", tmp_path / "w.png"
    line = "[[3,3],[12,4],[15,12]]"
    code, text, _ = told("reef", "generate", "--out", path, *SMALL, "--polyline", line, "--preview", picture)
    assert (code, text.split(": ")[-1]) == (0, f"coral reef run {path}\n")
    assert load_world(path).spine == (((3.0, 3.0), (12.0, 4.0), (15.0, 12.0)),)
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--polyline", "[[1,2]"), "--polyline: found '[[1,2]', expected JSON like"),
        (("--polyline", "[[1,2,3]]"), "--polyline"),
        (("--polyline", "5"), "--polyline"),
        (("--polyline", "[[3,3]]"), "--polyline: found 1 point"),
        (
            ("--polyline", "[[3,3],[25,4]]"),
            "--polyline: point 2: found (25, 4), expected a point at least 0.5 m inside --size-m, 22 x 22 m",
        ),
        (("--size-m", "2", "2"), "--size-m: found (2.0, 2.0), expected edges from 8 to 100 m"),
    ],
)
def test_a_line_that_is_none_is_refused(refused, tmp_path, words, said):
    assert said in refused("reef", "generate", "--out", tmp_path / "w.yaml", *words)
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_is_there_stays(refused, tmp_path):
    path = tmp_path / "w.yaml"
    path.write_text("mine")
    assert "found a file that exists, expected a new file" in refused("reef", "generate", "--out", path, *SMALL)
    assert path.read_text() == "mine"
