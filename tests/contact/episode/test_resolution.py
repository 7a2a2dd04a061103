import pytest

from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.resolution import check_combination, resolve_episode
from coral.errors import InputError

FINE = {"variant": "full", "advisor": "recorded", "seed": 0}


def test_values_are_taken_and_none_leaves_them():
    cfg = resolve_episode(EpisodeCfg(), samples=7, poses="ground-truth", fallback="fail")
    assert (cfg.controller.mppi.samples, cfg.poses, cfg.think.fallback) == (7, "ground-truth", "fail")
    assert resolve_episode(EpisodeCfg()) == EpisodeCfg()


def test_the_paper_s_variant_plans_as_the_paper_does():
    assert EpisodeCfg().controller.mppi.samples == 48
    cfg = resolve_episode(EpisodeCfg(), variant="paper")
    assert (cfg.controller.mppi.samples, cfg.controller.mppi.fine, cfg.replan_steps) == (200, 0.0, 1)
    assert (cfg.think.prompt, cfg.think.outer.attempt_s) == ("paper", cfg.planning.step_s)
    assert resolve_episode(EpisodeCfg(), variant="paper", prompt="words").think.prompt == "words"
    assert resolve_episode(EpisodeCfg(), variant="paper", samples=7).controller.mppi.samples == 7


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"seed": -1}, "--seed: found -1"),
        ({"seed": 0.5}, "--seed: found 0.5"),
        ({"variant": "ful"}, "did you mean 'full'"),
        ({"cost": "c.py", "variant": "expert"}, "--cost: found also --variant expert"),
        ({"policy": "ws://h:1", "variant": "expert"}, "--policy: found also --variant expert"),
        ({"cost": "c.py", "policy": "ws://h:1"}, "--cost: found also --policy"),
        ({"cost": "c.py", "advisor": "desk"}, "desk with --cost"),
        ({"cost": "c.py", "memory": "m"}, "--memory: found also --cost"),
        ({"cost": "c.py", "believe": "box=1,1"}, "--believe: found also --cost"),
        ({"variant": "expert", "prompt": "words"}, "--prompt: found also --variant expert"),
        ({"variant": "no-tracking", "tracker": "model"}, "--tracker: found also --variant no-tracking"),
    ],
)
def test_what_does_not_go_together_is_refused(changes, said):
    with pytest.raises(InputError, match=said):
        check_combination(**{**FINE, **changes})


def test_what_goes_together_passes():
    check_combination(**FINE)
    check_combination(**{**FINE, "cost": "c.py", "tracker": "model"})
