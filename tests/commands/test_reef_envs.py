import subprocess
import sys

import pytest
from PIL import Image

from coral.cli import main
from coral.reef.world.world import Cluster, Oyster, ReefWorld, Start, load_world, save_world, shipped_worlds

BED = Cluster(name="bed", oysters=(Oyster(x=5.0, y=3.0, z=0.05, radii=(0.12, 0.09, 0.06)),))


@pytest.fixture
def puddle(tmp_path):
    """Makes a file of a small world."""

    def make(name):
        path = tmp_path / "world.yaml"
        start = Start(x=1.5, y=3.0, theta=0.0)
        save_world(ReefWorld(name=name, size_m=(8.0, 6.0), start=start, clusters=(BED,)), path)
        return path

    return make


def test_shipped_reefs_and_files_are_listed_together(told, puddle):
    code, text, _ = told("reef", "envs", "l1", puddle("pond"))
    assert code == 0
    assert [line.split()[0] for line in text.splitlines()] == ["name", "l1", "pond", "pond:"]
    assert text.splitlines()[-1].startswith("pond: clusters[0] 'bed': too few oysters to be recognised")


def test_a_reef_is_described_in_numbers(told):
    world = load_world("l1")
    (found,) = told("reef", "envs", "l1", "--json")[1]["worlds"]
    assert (found["name"], found["topology"], found["size_m"]) == ("l1", "L", list(world.size_m))
    assert (found["clusters"], found["obstacles"]) == (len(world.clusters), len(world.obstacles))
    assert found["oysters"] == sum(len(cluster.oysters) for cluster in world.clusters)


def test_a_net_is_not_counted_as_oysters(told, puddle):
    path = puddle("pond")
    path.write_text(path.read_text() + "things:\n  - {name: net, kind: ghost-net, x: 4, y: 1.5}\n")
    (found,) = told("reef", "envs", path, "--json")[1]["worlds"]
    assert (found["clusters"], found["oysters"]) == (1, 1)


def test_a_wall_counts_as_an_obstacle(told, puddle):
    path = puddle("pond")
    path.write_text(path.read_text() + "walls:\n  - {begin: [1, 5], end: [3, 5], height_m: 1.3}\n")
    (found,) = told("reef", "envs", path, "--json")[1]["worlds"]
    assert found["obstacles"] == 1


def test_the_list_from_the_cache_is_the_same(told, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    first, second = told("reef", "envs", "l1", "s2", "--json"), told("reef", "envs", "l1", "s2", "--json")
    assert first == second
    assert [world["name"] for world in first[1]["worlds"]] == ["l1", "s2"]


def test_without_a_name_all_shipped_reefs_are_listed(told):
    assert [line.split()[0] for line in told("reef", "envs")[1].splitlines()] == ["name", *shipped_worlds()]


@pytest.mark.wing("coral.view")
@pytest.mark.parametrize("name", ["../../up", "a\0b"])
def test_no_name_of_a_world_leads_its_preview_elsewhere(told, puddle, tmp_path, name):
    folder = tmp_path / "here" / "pictures"
    code, result, _ = told("reef", "envs", puddle(name), "--preview", folder, "--json")
    assert code == 0
    assert {str(path) for path in tmp_path.rglob("*.png")} == {*result["previews"], result["sheet"]}
    assert len(list(folder.glob("*.png"))) == 2
    assert Image.open(result["sheet"]).size[0] > 300


def test_a_world_that_is_missing_and_a_folder_that_is_a_file_are_one_line(refused, puddle):
    assert "expected" in refused("reef", "envs", "s9")
    assert "--preview" in refused("reef", "envs", "s1", "--preview", puddle("s1") / "x")


HEAVY = ("numba", "mujoco", "scipy", "matplotlib", "pyarrow", "pydantic_ai")


@pytest.mark.parametrize(
    ("words", "heavy"),
    [
        (["reef", "envs", "l1"], (*HEAVY, "numpy", "pydantic")),
        (["contact", "tasks", "pick-box"], [module for module in HEAVY if module != "mujoco"]),
        (["--help"], (*HEAVY, "numpy", "cv2", "pydantic")),
        (["--version"], (*HEAVY, "numpy", "cv2", "pydantic")),
        (["--complete", "reef", "ru"], (*HEAVY, "numpy", "cv2", "pydantic")),
        (["reef", "run", "nope"], (*HEAVY, "numpy", "cv2", "pydantic")),
        (["contact", "run", "nope"], (*HEAVY, "numpy", "cv2", "pydantic")),
    ],
    ids=lambda part: " ".join(part) if isinstance(part, list) else "",
)
def test_what_a_short_command_does_not_import(words, heavy):
    main(words)  # fills the cache
    code = (
        "import sys\nfrom coral.cli import main\n"
        f"try:\n    main({words})\nexcept SystemExit:\n    pass\n"
        f"print([module for module in {heavy} if module in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"
