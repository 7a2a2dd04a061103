"""Every key of a survey's configuration is read by the command that takes it, or refused by it."""

import dataclasses
import inspect
import re
from pathlib import Path

import pytest

from config_reads import keys_of, watched
from coral import reef
from coral.cli import COMMANDS, _parse, main
from coral.commands.reef_eyes import ReefEyes
from coral.commands.unread_settings import UNREAD, refuse_unread, refused_by
from coral.config import changed_keys, merge
from coral.contact.episode.cfg import EpisodeCfg
from coral.errors import InputError
from coral.reef.mission.campaign_episode import run_episode
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.world.world import load_world
from coral.surface import described

SMALL = "--quiet --cfg.latency fixed:0.2 --cfg.simulator.camera.width 64 --cfg.simulator.camera.height 48"
MISSIONS = (
    f"{SMALL} --cfg.time-limit-s 5 --sonar --cfg.simulator.sonar.width 48 --cfg.simulator.sonar.height 16 "
    "--cfg.simulator.pictures --cfg.localization.drift-xy 0.01 "
    "--cfg.record.frames",
    f"{SMALL} --cfg.time-limit-s 5 --cfg.driver pd --cfg.record.no-report --cfg.record.no-pictures "
    "--cfg.simulator.noise.drift-xy 0.01 --cfg.simulator.noise.oyster-missed 0.1 --cfg.simulator.noise.visibility-m 4",
    f"{SMALL} --cfg.time-limit-s 2 --cfg.decider sweep --cfg.simulator.vehicle.model kinematic --cfg.record.no-report",
)
RARE = {
    "belief.chain.drop_after": "map/chain.py",
    "belief.visit_radius_m": "map/belief.py",
    "controller.recovery_speed_m_s": "drive/controller.py",
    "belief.inspect.confirmed": "map/belief.py",
    "lane_m": "mission/assembly.py",
    "map.doubt": "eyes/doubt.py",
    "map.sight": "map/sight_layer.py",
    "pilot.action_s": "pilot/pilot.py",
    "pilot.blind_speed_m_s": "pilot/pilot.py",
    "pilot.guard.surface_after_s": "pilot/safety.py",
    "pilot.monitor.max_replans": "drive/monitor.py",
    "pilot.passed_m": "pilot/pilot.py",
    "pilot.trigger": "decide/trigger.py",
    "planner.checks": "decide/tour_planner.py",
    "planner.instruction.clear_m": "decide/planner.py",
    "planner.instruction": "decide/mission_planner.py",
    "planner.finished": "decide/tour_planner.py",
    "planner.separation_m": "decide/tour_planner.py",
    "planner.route": "decide/route.py",
    "planner.verify.enabled": "decide/planner.py",
    "planner.verify": "decide/verify.py",
}
"""What a few seconds of a survey may not come to, and the file that reads it."""


def covers(declared, key):
    return any(key == one or key.startswith(f"{one}.") for one in declared)


def run(words, folder):
    """Run a command, and return what it read of its configuration."""
    command = _parse(" ".join(words[:2]), words[2:])
    if hasattr(command, "out"):
        command = dataclasses.replace(command, out=folder / "run")
    with watched(command.cfg) as reads:
        command()
    return reads


def read(reads):
    """The keys that were read; to read a group is to pass it on."""
    return set(reads.by_key) & set(keys_of(MissionCfg()))


@pytest.fixture(scope="module")
def mission_reads(tmp_path_factory):
    """All that `coral reef run` reads in a few short missions."""
    walks = [run(["reef", "run", "s1", *words.split()], tmp_path_factory.mktemp("walk")) for words in MISSIONS]
    return set().union(*map(read, walks))


def test_a_mission_reads_every_key(mission_reads):
    unread = {key for key in keys_of(MissionCfg()) if key not in mission_reads and not covers(RARE, key)}
    assert unread == set(UNREAD["reef run"])


@pytest.mark.parametrize("key", [key for key in keys_of(MissionCfg()) if covers(RARE, key)])
def test_what_is_read_rarely_is_read_in_the_file_that_is_named(key):
    file = next(file for group, file in RARE.items() if covers([group], key))
    text = (Path(reef.__file__).parent / file).read_text(encoding="utf-8")
    assert re.search(rf"\.{key.rpartition('.')[2]}\b", text)


def test_a_campaign_refuses_what_it_overwrites(tmp_path):
    cfg = merge(MissionCfg(), {"time_limit_s": 1.0}, "here")
    with watched(cfg) as reads:
        run_episode(load_world("s1"), cfg, tmp_path / "run", variant="full", advisor="heuristic", seed=0)
    assert {key for key in reads.overwritten if not covers(UNREAD["reef bench"], key)} == set()
    assert {key for key in read(reads) if covers(UNREAD["reef bench"], key)} == set()


OF_THE_COMMAND = (
    *("decider", "record", "time_limit_s", "latency", "perception", "depth", "pilot.fallback"),
    *("simulator.pictures", "simulator.painter", "simulator.water", "simulator.water_depth_m", "simulator.contact"),
    *("simulator.sonar", "simulator.noise", "pilot.guard", "localization.use_covariance"),
    "localization.start_m",
)
"""What `coral reef sail` reads before and after the survey, when it opens the camera and the sonar, and to resume."""


@pytest.mark.wing("coral.reef.rehearsal")
def test_a_survey_in_real_time_refuses_what_it_does_not_read(tmp_path, monkeypatch):
    from reef.sea import voyage

    small = {"camera": {"width": 64, "height": 48}, "sonar": {"enabled": True}}
    cfg = merge(MissionCfg(), {"simulator": small, "localization": {"drift_xy": 0.01}}, "here")
    monkeypatch.setattr(voyage, "MissionCfg", lambda **values: cfg)
    with watched(cfg) as reads:
        voyage.Voyage(tmp_path / "run", sonar=True).run()
    declared = UNREAD["reef sail"]
    assert {key for key in read(reads) if covers(declared, key)} == set()
    unread = {
        key for key in keys_of(cfg) if key not in read(reads) and not covers({*RARE, *OF_THE_COMMAND, *declared}, key)
    }
    assert unread == set()


@pytest.mark.parametrize(("command", "key"), [(command, key) for command in UNREAD for key in UNREAD[command]])
def test_every_refused_key_exists(command, key):
    if key.startswith("--"):
        flags = described(COMMANDS[" ".join(command.split()[:2])][0]).flags
        assert any(covers([key], flag.name) for flag in flags)
    else:
        assert any(covers([key], known) for known in keys_of(EpisodeCfg() if "contact" in command else MissionCfg()))


def test_a_cost_of_ones_own_asks_nobody(task, tmp_path):
    cost = tmp_path / "cost.py"
    cost.write_text("def state_cost(self):\n    return np.linalg.norm(self.ee_pos - self.box_pos)\n")
    words = ["contact", "run", task, "--world", "hand", "--samples", "4", "--cost", str(cost), "--quiet"]
    reads = run([*words, "--cfg.record.no-report"], tmp_path)
    assert "coral.contact.control.mppi_controller" in set().union(*reads.by_key.values())
    declared = {key: modules for key, modules in reads.by_key.items() if covers(UNREAD["contact run --cost"], key)}
    assert not any(module.startswith(OUTER) for modules in declared.values() for module in modules)


OUTER = ("coral.contact.thinker", "coral.contact.memory", "coral.contact.world_model")
"""Who asks an advisor, and reads what it says."""
ACTIONS = {
    "reef eyes train": (ReefEyes._train,),
    "reef eyes score": (ReefEyes._score, ReefEyes._taken),
    "reef eyes score --labelled": (ReefEyes._score_labelled,),
}


@pytest.mark.parametrize("action", ACTIONS)
def test_an_action_refuses_the_flags_that_it_does_not_read(action):
    read = set(re.findall(r"self\.(\w+)", "".join(map(inspect.getsource, ACTIONS[action]))))
    flags = {field.name for field in dataclasses.fields(ReefEyes)} - {"action", "json"}
    refused = [found for case, found in UNREAD.items() if set(action.split()) >= set(case.split())]
    missing = {f"--{flag.replace('_', '-')}" for flag in flags - read} - set().union(*refused)
    # Without --labelled there is nothing to name the oysters of.
    assert missing - {"--labelled", "--oysters"} == set()
    assert {key[2:].replace("-", "_") for found in refused for key in found} & read == set()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            "reef sail s1 --cfg.simulator.stills",
            "coral reef sail: --cfg.simulator.stills: found a setting that it never reads, expected nothing: a camera "
            "at sea has its own pictures",
        ),
        (
            "reef eyes train --perception rgb",
            "coral reef eyes train: --perception: found a setting that it never reads, expected --labelled, --oysters, "
            "--without, --reefs, --pictures, --steps, --batch, --device, --limit-s, --begin, --threads, --out, --seed",
        ),
        (
            "reef run s1 --cfg.driver pd --cfg.controller.costs.goal 2",
            "coral reef run --cfg.driver=pd: --cfg.controller.costs.goal: found a setting that it never reads, "
            "expected nothing: --cfg.controller is DDP-MPPI's, and a PD controller drives",
        ),
        (
            "contact run pick-box --variant expert-fsm --cfg.think.latency 3",
            "coral contact run --variant=expert-fsm: --cfg.think.latency: found a setting that it never reads, "
            "expected nothing: no advisor is asked",
        ),
    ],
)
def test_the_command_line_refuses_it_in_one_line(capsys, words, said):
    assert main(words.split()) == 2
    assert capsys.readouterr().err == f"coral: {said}\n"


def test_a_file_may_have_such_a_key_with_its_default(tmp_path):
    file = tmp_path / "a.yaml"
    file.write_text("simulator: {stills: false}\ntime_limit_s: 20\n")
    assert _parse("reef sail", ["s1", "--config", str(file)]).cfg.time_limit_s == 20.0
    file.write_text("driver: pd\n")
    with pytest.raises(InputError, match=r"--cfg.driver=pd: --cfg.controller.costs.goal: found"):
        _parse("reef run", ["s1", "--config", str(file), "--cfg.controller.costs.goal", "2"])
    file.write_text("simulator: {stills: true}\n")
    with pytest.raises(InputError, match=r"--cfg.simulator.stills: found a setting that it never reads"):
        _parse("reef sail", ["s1", "--config", str(file)])


def test_groups_and_who_refuses_them():
    with pytest.raises(InputError, match=r"--cfg.simulator.stills"):
        refuse_unread("reef sail", ["time_limit_s", "simulator.noise.drift_xy", "simulator.stills"])
    refuse_unread("reef run", ["driver"])
    assert refused_by("simulator.stills") == ["reef sail"]
    assert refused_by("record.video") == ["reef bench"]
    assert changed_keys(merge(MissionCfg(), {"map": {"obstacles": "sonar"}}, "here"), MissionCfg()) == ["map.obstacles"]
