from dataclasses import dataclass, field

import pytest

from coral.config import (
    Count,
    Fraction,
    Positive,
    Signed,
    changes,
    checked,
    merge,
    read_config,
    resolve_settings,
    to_mapping,
    whole_steps,
)
from coral.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Camera:
    range_m: Positive = 2.0
    dropout: Fraction = 0.1


@dataclass(frozen=True, kw_only=True)
class Cfg:
    camera: Camera = field(default_factory=Camera)
    robots: Count = 1
    heading: Signed = 0.0
    gain: float = 1.0
    size: tuple[float, float] = (1.0, 2.0)
    name: str = "a"


def test_a_file_changes_only_the_fields_that_it_names(tmp_path):
    path = tmp_path / "a.yaml"
    path.write_text("camera: {range_m: 3}\nheading: -1.5\nsize: [4, 5]\n")
    assert read_config(path, Cfg(name="b")) == Cfg(camera=Camera(range_m=3.0), heading=-1.5, size=(4.0, 5.0), name="b")


def test_what_is_written_back_is_complete_and_read_as_the_same():
    cfg = Cfg(camera=Camera(dropout=0.5), size=(3.0, 4.0))
    written = to_mapping(cfg)
    assert written == {
        "camera": {"range_m": 2.0, "dropout": 0.5},
        "robots": 1,
        "heading": 0.0,
        "gain": 1.0,
        "size": [3.0, 4.0],
        "name": "a",
    }
    assert merge(Cfg(), written, "a.yaml") == cfg


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"camera": {"rnge_m": 1}}, r"camera\.rnge_m: found an unknown key, .*did you mean 'range_m'"),
        ({"camera": 3}, r"camera: found 3, expected a mapping"),
        ({"camera": {"range_m": 0}}, r"camera\.range_m: found 0, expected greater than 0"),
        ({"camera": {"dropout": 1.1}}, r"camera\.dropout: found 1\.1, expected less than or equal to 1"),
        ({"robots": 1.5}, r"robots: found 1\.5, expected a valid integer"),
        ({"gain": -1.0}, r"gain: found -1\.0, expected a finite number of 0 or more"),
        ({"gain": float("inf")}, r"gain: found inf, expected a finite number"),
        ({"heading": float("nan")}, r"heading: found nan, expected a finite number"),
        ({"size": [1]}, r"size"),
    ],
)
def test_a_wrong_value_is_named_by_its_dotted_path(changes, said):
    with pytest.raises(InputError, match=rf"^a\.yaml: {said}"):
        merge(Cfg(), changes, "a.yaml")


def test_a_configuration_made_in_python_is_checked_too():
    good = Cfg()
    assert checked(good, "--cfg") is good
    with pytest.raises(InputError, match=r"--cfg: camera\.range_m: found -1\.0"):
        checked(Cfg(camera=Camera(range_m=-1.0)), "--cfg")


@pytest.mark.parametrize(("period_s", "step_s", "steps"), [(0.1, 0.002, 50), (0.3, 0.1, 3), (0.1, 0.1, 1)])
def test_whole_steps_in_spite_of_rounding(period_s, step_s, steps):
    assert whole_steps(period_s, step_s, "world", "dt_s") == steps


@pytest.mark.parametrize(("period_s", "step_s"), [(0.1, 0.03), (0.1, 0.2), (0.1, 0.3)])
def test_a_step_that_does_not_divide_its_period_is_refused(period_s, step_s):
    with pytest.raises(InputError, match=rf"world: dt_s: found {step_s} s, expected a whole number of them in 0\.1 s"):
        whole_steps(period_s, step_s, "world", "dt_s")


def test_only_what_differs_from_the_default_is_named_by_its_dotted_key():
    default = {"camera": {"range_m": 2.0, "noise": {"sigma": 0.1}}, "seed": 0, "size": [1, 2]}
    now = {"camera": {"range_m": 2.0, "noise": {"sigma": 0.2}}, "seed": 0, "size": [1, 3], "new": None}
    assert changes(now, default, "cfg") == [("cfg.camera.noise.sigma", 0.2), ("cfg.size", [1, 3])]
    assert changes(default, default, "cfg") == []


@dataclass(frozen=True, kw_only=True)
class Inner:
    depth_m: float = 1.0
    width_m: float = 2.0


@dataclass(frozen=True, kw_only=True)
class Outer:
    limit_s: float = 5.0
    inner: Inner = field(default_factory=Inner)


def test_nothing_is_the_default():
    assert resolve_settings(None, Outer()) == (Outer(), frozenset())


@pytest.mark.parametrize(
    "given",
    [
        {"inner.depth_m": 3.0, "inner.width_m": 4.0},
        {"inner": {"depth_m": 3.0}, "inner.width-m": 4.0},
        {"inner": {"depth_m": 3.0, "width_m": 4.0}},
        Outer(inner=Inner(depth_m=3.0, width_m=4.0)),
    ],
)
def test_keys_may_be_nested_or_dotted_or_the_configuration_itself(given):
    cfg, keys = resolve_settings(given, Outer())
    assert cfg == Outer(inner=Inner(depth_m=3.0, width_m=4.0))
    assert keys == {"inner.depth_m", "inner.width_m"}


def test_a_file_is_read(tmp_path):
    (tmp_path / "cfg.yaml").write_text("limit_s: 9\n")
    assert resolve_settings(tmp_path / "cfg.yaml", Outer())[0].limit_s == 9


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"limitt_s": 3}, "did you mean 'limit_s'"),
        ({"inner": 3}, "a mapping"),
        ({"limit_s": "long"}, "cfg: limit_s: found 'long'"),
        ({3: 3}, "names of keys"),
        ({"inner": 1, "inner.depth_m": 2}, "one of the two"),
        (Inner(), "found Inner, expected a Outer"),
        (7, "found int"),
    ],
)
def test_what_is_no_configuration_is_refused(given, said):
    with pytest.raises(InputError, match=said):
        resolve_settings(given, Outer())
