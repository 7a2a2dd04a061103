"""Whatever is wrong with the input, the user reads one line that names it, and nothing is written or overwritten."""

import os
import re

import pytest
import yaml

from coral.cli import main

RUN = ("reef", "run", "{place}/pond.yaml", "--cfg.time-limit-s", "5", "--quiet")


@pytest.fixture
def refused(place, capsys, monkeypatch):
    """Run the command in-process; returns its one line on standard error."""

    def run(*words):
        monkeypatch.chdir(place)
        before = sorted(path.relative_to(place) for path in place.rglob("*"))
        code = main([word.format(place=place) for word in words])
        told = capsys.readouterr()
        assert code == 2
        assert told.out == ""
        assert re.fullmatch(r"coral[^\n]*: (found [^\n]+, expected [^\n]+|line \d+: [^\n]+)\n", told.err), told.err
        assert "Traceback" not in told.err
        assert sorted(path.relative_to(place) for path in place.rglob("*")) == before
        return told.err

    return run


def changed(place, world, change):
    """The valid world with a change made to it, as a file."""
    content = world()
    change(content)
    path = place / "bad.yaml"
    path.write_text(yaml.safe_dump(content, sort_keys=False))
    return path


def ring(content):
    """Close a wall around the second cluster."""
    content["obstacles"] += [
        {"shape": "box", "x": 5.9, "y": 5.25, "z": 0.6, "size": [0.1, 1.75, 0.6]},
        {"shape": "box", "x": 7.45, "y": 3.5, "z": 0.6, "size": [1.55, 0.1, 0.6]},
    ]
    content["clusters"][0]["oysters"] = [dict(o, x=o["x"] - 1.0) for o in content["clusters"][0]["oysters"]]
    content["obstacles"][1]["x"] = 5.0
    content["size_m"] = [12.0, 11.0]
    content["clusters"][1]["oysters"] = [
        dict(o, x=o["x"] + 1.5, y=o["y"] + 3.0) for o in content["clusters"][1]["oysters"]
    ]
    content["obstacles"] += [
        {"shape": "box", "x": 9.0, "y": 5.0, "z": 0.6, "size": [2.9, 0.1, 0.6]},
        {"shape": "box", "x": 6.0, "y": 8.0, "z": 0.6, "size": [0.1, 3.0, 0.6]},
    ]


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (
            lambda w: w["clusters"][0]["oysters"][3].update(radii=[0.1, 0.1, -0.1]),
            r"clusters\[0\]\.oysters\[3\]\.radii\[2\]: found -0\.1",
        ),
        (lambda w: w.update(clutsers=[]), r"clutsers: found an unknown key.*did you mean 'clusters'"),
        (ring, r"clusters\[1\]: found cluster 'far' out of the robot's reach"),
    ],
)
def test_a_fault_in_a_world_is_named(place, world, refused, change, named):
    changed(place, world, change)
    assert re.search(named, refused("reef", "run", "{place}/bad.yaml"))
    assert re.search(named, refused("reef", "envs", "{place}/bad.yaml"))


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("reef", "run", "none.yaml"), "none.yaml"),
        (("reef", "run"), "WORLD"),
        (("reef", "run", "{place}"), "{place}"),
        ((*RUN, "--advisor", "huristic"), "--advisor: found 'huristic'.*did you mean 'heuristic'"),
        ((*RUN, "--advisor", "openai:gpt-4o"), "OPENAI_API_KEY"),
        ((*RUN, "--advisor", "replay:none.jsonl"), "--advisor.*none.jsonl"),
        ((*RUN, "--sead", "1"), "--sead"),
        ((*RUN, "--cfg.time-limit-s", "-5"), "time_limit_s: found -5"),
        ((*RUN, "--cfg.map.cell-m", "1e-9"), "map.cell_m: found 1e-09"),
        ((*RUN, "--model.attempt-timeout-s", "-1"), "--model: attempt_timeout_s: found -1"),
        ((*RUN, "--out", "{place}/pond.yaml/run"), "--out"),
        ((*RUN, "--config", "none.yaml"), "none.yaml: found no such file"),
        (
            (
                *RUN,
                "--config",
            ),
            "--config",
        ),
        (("reef", "rum", "s1"), "'reef rum'.*did you mean 'reef run'"),
        (("report", "{place}"), "{place}.*events.jsonl"),
        (("reef", "generate", "--out", "new.yaml", "--polyline", "[[1,2]"), "--polyline"),
        (
            ("reef", "generate", "--out", "new.yaml", "--clusters", "2", "--preview", "{place}/pond.yaml/x.png"),
            "--preview",
        ),
        (("advisor", "show", "reef-centriod"), "KIND.*did you mean 'reef-centroid'"),
    ],
)
def test_bad_words_are_named(place, refused, monkeypatch, words, named):
    for key in ("OPENAI_API_KEY", "CORAL_LOCAL_API_KEY"):
        monkeypatch.delenv(key, raising=False)
    assert re.search(named.format(place=re.escape(str(place))), refused(*words))


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("time_limits: 5\n", "time_limits: found an unknown key.*did you mean 'time_limit_s'"),
        ("time_limit_s: soon\n", "time_limit_s: found 'soon'"),
        ("controller: {costs: {gaol: 1}}\n", r"controller\.costs\.gaol: found an unknown key.*did you mean 'goal'"),
        ("- a list\n", "cfg.yaml: found a list"),
        ("a: [1\n", "cfg.yaml: line 2: a "),
        ("\x00", "cfg.yaml"),
    ],
)
def test_a_fault_in_a_configuration_is_named(place, refused, text, named):
    (place / "cfg.yaml").write_text(text)
    assert re.search(named, refused(*RUN, "--config", "cfg.yaml"))


@pytest.mark.parametrize(
    "text", ["size_m: [1, 2\n", "just words\n", "", "\tx: 1\n", "format: coral-reef/2\n", "a: &a [*a]\n"]
)
def test_a_world_that_is_none_is_named(place, refused, text):
    (place / "bad.yaml").write_text(text)
    assert "bad.yaml" in refused("reef", "run", "{place}/bad.yaml")


def test_a_world_of_bytes_is_named(place, refused):
    (place / "bad.yaml").write_bytes(os.urandom(2000))
    assert "bad.yaml" in refused("reef", "run", "{place}/bad.yaml")


def test_nothing_that_exists_is_overwritten(place, refused):
    kept = place / "kept"
    kept.mkdir()
    (kept / "metrics.json").write_text("mine")
    assert "--out" in refused(*RUN, "--out", "{place}/kept")
    assert (kept / "metrics.json").read_text() == "mine"


def test_the_installed_command_says_it_in_one_line_too(place, coral):
    done = coral(place, "reef", "run", "pond.yaml", "--cfg.time-limit", "5")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert "--cfg.time-limit-s" in done.stderr
