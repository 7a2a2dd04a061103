import json

from coral.contact.episode import identification_episode as module
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.identification_episode import probe_episode
from coral.contact.scene.trial import PhysicalParameters, sample_trial
from coral.contact.tasks import load_task

TRUTH, FIRST = PhysicalParameters(0.1, 0.5), PhysicalParameters(2.0, 0.9)


def test_the_truth_stays_in_the_world_and_the_belief_in_the_mind(tmp_path, monkeypatch):
    seen = {}

    class Staged:
        def __init__(self, trial, world, strategist, cfg, folder, **_):
            seen.update(truth=trial.objects["board"].physical, given=strategist._given, world=world)
            self.folder = folder

        def run(self, observers):
            lines = [
                {"event": "correction", "object": "board", "text": "too little was touched"},
                {"event": "correction", "object": "board", "after": [0.1, 0.5]},
                {"event": "end"},
            ]
            (self.folder / "events.jsonl").write_text("\n".join(json.dumps(line) for line in lines))
            return {"end_reason": "success", "sim_time_s": 9.0}

    monkeypatch.setattr(module, "Episode", Staged)
    found = probe_episode(sample_trial(load_task("push-pick-board"), 0), "board", TRUTH, FIRST, EpisodeCfg(), tmp_path)
    assert seen == {"truth": TRUTH, "given": {"board": FIRST}, "world": "panda"}
    assert [event["after"] for event in found.corrections] == [[0.1, 0.5]]
