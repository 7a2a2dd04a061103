"""A small recorded scene: two pictures of a box and a can, 64 x 48 pixels."""

import dataclasses

from coral.contact.perception.camera import RgbdCameraCfg
from coral.contact.perception.object_model import from_trial
from coral.contact.real_scenes.bop_writing import BopWriter
from coral.contact.real_scenes.tracking_accuracy import AccuracyCfg, take_motion

CFG = AccuracyCfg(camera=RgbdCameraCfg(width=64, height=48), noise=None, period_s=0.1)


def write_scene(folder, trial, pictures=2, colours="none"):
    """Write the first pictures of the trial's motion; return models, pictures and true poses by name."""
    scene, frames, truths = take_motion(trial, dataclasses.replace(CFG, colours=colours))
    models = {name: from_trial(scene, trial, name) for name in trial.objects}
    writer = BopWriter(folder, models)
    for frame, truth in zip(frames[:pictures], truths[:pictures], strict=True):
        writer.add(frame, truth)
    writer.close()
    return models, frames[:pictures], truths[:pictures]
