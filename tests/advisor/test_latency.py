from types import SimpleNamespace

import numpy as np
import pytest

from coral.advisor.latency import LatencyCfg, default_latency, latency_for, parse_latency
from coral.errors import InputError


@pytest.mark.parametrize(
    ("spec", "cfg"),
    [
        ("0", LatencyCfg(median_s=0.0)),
        ("10", LatencyCfg(median_s=10.0)),
        ("fixed:2.5", LatencyCfg(median_s=2.5)),
        ("lognormal:10:0.3", LatencyCfg(kind="lognormal", median_s=10.0, sigma=0.3)),
        ("measured", LatencyCfg(kind="measured")),
        ("recorded", LatencyCfg(kind="recorded")),
    ],
)
def test_latency_forms(spec, cfg):
    assert parse_latency(spec) == cfg


@pytest.mark.parametrize(
    "spec", ["", "fast", "fixed", "fixed:x", "fixed:-1", "lognormal:10", "lognormal:1:2:3", "inf", "measured:3", "nan"]
)
def test_bad_latency(spec):
    with pytest.raises(InputError):
        parse_latency(spec)


def test_lognormal_median_and_spread():
    rng = np.random.default_rng(1)
    draws = np.array([parse_latency("lognormal:10:0.3").draw(rng) for _ in range(4000)])
    assert np.median(draws) == pytest.approx(10.0, rel=0.03)
    assert np.std(np.log(draws)) == pytest.approx(0.3, rel=0.05)


@pytest.mark.parametrize("spec", ["0", "2.5", "lognormal:10:0.3", "measured", "recorded"])
def test_a_latency_is_read_as_it_is_written(spec):
    assert parse_latency(str(parse_latency(spec))) == parse_latency(spec)


def test_only_what_can_be_known_beforehand_is_drawn():
    rng = np.random.default_rng(0)
    assert parse_latency("2.5").draw(rng) == 2.5
    assert parse_latency("measured").draw(rng) is None
    assert parse_latency("recorded").draw(rng) is None


def test_the_advisors_own_latency_holds_unless_another_is_set_and_a_recordings_always():
    rules, unknown, recording = (
        SimpleNamespace(name="a", **own) for own in ({"latency": "3"}, {}, {"latency": "recorded"})
    )
    assert [str(default_latency(who)) for who in (rules, unknown, recording)] == ["fixed:3", "measured", "recorded"]
    assert [str(latency_for(who, "9")) for who in (rules, unknown, recording)] == ["fixed:9", "fixed:9", "recorded"]
    assert str(latency_for(rules)) == "fixed:3"
