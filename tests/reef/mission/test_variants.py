"""Baselines and ablations of the one pipeline."""

import dataclasses

import pytest

from coral.advisor.rules import RuleAdvisor
from coral.config import to_mapping
from coral.errors import InputError
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.mission.variants import VARIANTS, apply_variant

QUIET = MissionCfg(time_limit_s=4.0, latency="fixed:1", record=RecordCfg(pictures=False, frames=False))


@pytest.mark.parametrize("variant", sorted(VARIANTS))
def test_every_variant_runs(pond, tmp_path, variant):
    cfg = apply_variant(variant, QUIET)
    assert Mission(pond, cfg, RuleAdvisor(REEF_RULES), tmp_path / "run", variant=variant).run()["steps"] == 40


def flat(cfg, path=""):
    """Values of a configuration by their path."""
    if not isinstance(cfg, dict):
        return {path: cfg}
    return {key: value for name, part in cfg.items() for key, value in flat(part, f"{path}.{name}").items()}


def changes(variant):
    """What a variant changes in a configuration that is not the default."""
    alone = dataclasses.replace(MissionCfg().pilot, fallback="hold")
    base = dataclasses.replace(MissionCfg(), time_limit_s=77.0, lane_m=4.0, pilot=alone)
    before, after = flat(to_mapping(base)), flat(to_mapping(apply_variant(variant, base)))
    return {key: value for key, value in after.items() if value != before[key]}


def test_the_full_system_is_what_was_configured():
    assert changes("full") == {}


def test_the_rule_on_the_paper_s_pipeline_changes_what_both_change():
    rule = {**changes("paper"), **changes("rule-based")}
    assert changes("rule-based-dots-only") == {**rule, ".planner.explore": False}


def test_variants_are_told_apart():
    made = [str(apply_variant(name, MissionCfg())) for name in VARIANTS]
    assert len(set(made)) == len(VARIANTS)


def test_unknown_variants_are_named():
    with pytest.raises(InputError, match="did you mean 'full'"):
        apply_variant("ful", QUIET)


def test_a_random_advisor_without_checks_loses_what_no_verification_loses():
    drawn = changes("random")
    assert changes("random-unchecked") == {**changes("no-verification"), **drawn}
    assert changes("no-cost-to-go-no-ddp") == {**changes("no-cost-to-go"), **changes("no-ddp")}
