import os

from coral.desk.front.run_list import run_card, run_folders


def test_the_latest_run_comes_first_and_links_are_left_out(tmp_path):
    for k, name in enumerate(("a", "campaign/b")):
        folder = tmp_path / name
        folder.mkdir(parents=True)
        (folder / "config.yaml").write_text("system: contact\ntask: pick-box\n")
        os.utime(folder / "config.yaml", (k, k))
    (tmp_path / "link").symlink_to(tmp_path / "a")
    assert [path.name for path in run_folders(tmp_path)] == ["b", "a"]


def test_a_run_that_was_killed_has_no_end_and_no_numbers(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "a/config.yaml").write_text("system: contact\ntask: pick-box\nseed: 2\n")
    (tmp_path / "a/metrics.json").write_text('{"end_rea')
    card = run_card(tmp_path / "a", tmp_path)
    assert (card["task"], card["seed"], card["ended"], card["numbers"]) == ("pick-box", "2", "", [])
