from dataclasses import dataclass, field

import pytest

from coral.errors import InputError
from coral.interface.settings import resolve_settings


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
