import importlib.util
from pathlib import Path

FILE = Path(__file__).parents[2] / "benchmarks" / "size.py"
SPEC = importlib.util.spec_from_file_location("size_of_a_checkout", FILE)
size = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(size)

TYPED = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from coral.reef.world import scene\n"
LINK = "from coral.reef.map.belief import B\nimport coral.reef.world.scene\n\nclass Link:\n    pass\n"


def test_rooms_arrows_and_floors_are_counted(tmp_path, monkeypatch):
    for name, text in {
        "reef/world/scene.py": "X = 1\n",
        "reef/map/belief.py": TYPED,
        "reef/sea/link.py": LINK,
        "advisor/cfg.py": "class AskCfg:\n    a: int = 1\n    b: int = 2\n\nclass _Own:\n    pass\n",
    }.items():
        path = tmp_path / "src/coral" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    (tmp_path / "tests").mkdir()
    monkeypatch.setattr(size, "_ask", lambda checkout, code: {"reef run": 40} if "help" in code else 7)
    found = size.sizes(tmp_path)
    assert (found["reef rooms"], found["reef arrows"], found["reef floors"]) == (3, 3, 3)
    assert (found["source lines"], found["of them wings"], found["public classes"]) == (15, 5, 2)
    assert (found["configuration fields"], found["flags"], found["longest help"]) == (2, 7, 40)
