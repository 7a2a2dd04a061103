"""Eyes that see flat sea floor everywhere, and remember what they were asked."""

import numpy as np

from coral.reef.eyes.ground_plane import ground_depth
from coral.reef.eyes.perception import SeenPicture
from coral.reef.world.geometry import Label


class FlatEyes:
    about = ()

    def __init__(self, doubt=0.1):
        self.looks, self.doubt, self.attitude, self.camera = 0, doubt, None, None

    def perceive(self, rgb, camera, attitude):
        self.looks, self.attitude, self.camera = self.looks + 1, attitude, camera
        depth = np.minimum(ground_depth(camera, attitude.height, roll=attitude.roll, pitch=attitude.pitch), 9.0)
        shape = depth.shape
        return SeenPicture(np.full(shape, Label.SEABED, np.uint8), depth, np.full(shape, self.doubt, np.float32))
