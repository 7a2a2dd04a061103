from dataclasses import dataclass

import pytest

from coral.commands.config_flag import configured, given_keys, set_keys
from coral.commands.contact_bench import ContactBench
from coral.commands.reef_bench import ReefBench
from coral.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Cfg:
    speed: float = 1.0
    count: int = 2
    noisy_picture: bool = True
    sigma: tuple[float, float] = (0.1, 0.2)


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "a.yaml"
    path.write_text("speed: 3.0\n")
    return path


def test_the_file_is_read_with_a_space_and_with_an_equals_sign(file):
    for words in (["run", "--config", str(file)], ["run", f"--config={file}", "--quiet"]):
        assert configured(words, Cfg()) == Cfg(speed=3.0)


def test_without_the_flag_there_is_none():
    assert configured(["run", "--configure", "x"], Cfg()) is None
    assert configured(["run", "--config"], Cfg()) is None


def test_a_missing_file_is_one_clear_line(tmp_path):
    with pytest.raises(InputError, match="a readable YAML file"):
        configured(["--config", str(tmp_path / "none.yaml")], Cfg())


@pytest.mark.parametrize(
    ("command", "text", "key"),
    [(ContactBench, "replan_steps: 1\n", "replan_steps"), (ReefBench, "time_limit_s: 9.0\n", "time_limit_s")],
)
def test_campaigns_read_it_too(tmp_path, command, text, key):
    path = tmp_path / "b.yaml"
    path.write_text(text)
    made = command.from_file([f"--config={path}"])
    assert f"{key}: {getattr(made.cfg, key)}\n" == text


def test_keys_are_given_by_flags_and_by_the_file_be_it_to_the_default(file):
    words = [
        "run",
        "--config",
        str(file),
        "--cfg.no-noisy-picture",
        "--cfg.a.depth-sigma=0",
        "--cfg.a.no-b",
        "--x",
        "2",
    ]
    assert given_keys(words) == ("noisy_picture", "a.depth_sigma", "a.b", "speed")
    assert given_keys(["run", "--seed", "1"]) == ()


def test_keys_that_differ_from_the_default_count_as_set():
    assert set_keys(Cfg(speed=3.0), Cfg(), ["count"]) == {"speed", "count"}
