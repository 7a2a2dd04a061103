"""A small recording: two pictures of a box and a can, 64 x 48 pixels."""

import dataclasses

from coral.contact.perception.camera import RgbdCameraCfg
from coral.contact.real_scenes.bop_writing import BopWriter
from coral.contact.real_scenes.tracking_accuracy import AccuracyCfg, take_motion

CFG = AccuracyCfg(camera=RgbdCameraCfg(width=64, height=48), noise=None, period_s=0.1)


def write_scene(folder, trial, pictures=2, colours="none"):
    """Write the first pictures of the trial's motion; return them."""
    _, frames, _ = take_motion(trial, dataclasses.replace(CFG, colours=colours))
    writer = BopWriter(folder)
    for frame in frames[:pictures]:
        writer.add(frame)
    writer.close()
    return frames[:pictures]
