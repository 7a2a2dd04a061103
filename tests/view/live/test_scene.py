import numpy as np
import pytest

from coral.view.live.scene import LiveScene, blocks
from coral.view.live.state import Ground, Line, LiveState, Marker


def test_blocks_stand_on_the_cells_and_nowhere_else():
    mask = np.random.default_rng(1).random((9, 13)) < 0.4
    vertices, faces = blocks(mask, 0.5, (2.0, -1.0), 0.3)
    assert faces.max() < len(vertices)
    top = vertices[faces].reshape(-1, 3, 3)
    top = top[(top[:, :, 2] == np.float32(0.3)).all(axis=1)]
    areas = 0.5 * np.cross(top[:, 1] - top[:, 0], top[:, 2] - top[:, 0])[:, 2]
    assert (areas > 0).all()  # seen from above
    assert areas.sum() == pytest.approx(0.25 * mask.sum())
    boxes = vertices.reshape(-1, 8, 3)
    covered = np.zeros_like(mask)
    for box in boxes:
        x0, x1 = (round((v - 2.0) / 0.5) for v in (box[:, 0].min(), box[:, 0].max()))
        y0 = round((box[:, 1].min() + 1.0) / 0.5)
        covered[y0, x0:x1] = True
    assert (covered == mask).all()


def test_blocks_of_nothing():
    vertices, faces = blocks(np.zeros((3, 4), bool), 1.0, (0.0, 0.0), 1.0)
    assert (vertices.shape, faces.shape) == ((0, 3), (0, 3))


class Drawing:
    """What viser would draw; notes what is added and changed."""

    def __init__(self):
        self.there, self.sent = {}, []
        self.scene = self
        self.world_axes = self.initial_camera = type("Any", (), {})()

    def __getattr__(self, name):
        if not name.startswith("add_"):
            raise AttributeError(name)
        return self._add

    def _add(self, name, *values, **fields):
        drawing = self

        class Handle:
            def __setattr__(self, key, value):
                drawing.sent.append(name)
                object.__setattr__(self, key, value)

            def remove(self):
                del drawing.there[name]

        self.there[name] = handle = Handle()
        handle.__dict__.update(fields)
        self.sent.append(name)
        return handle


SEGMENTS = np.zeros((1, 2, 3), np.float32)


def ground(cells):
    return Ground(cells=cells, palette=np.zeros((4, 3), np.uint8), cell_m=0.5, heights={2: (0.4, (1, 2, 3))})


def test_the_truth_is_hidden_until_it_is_asked_for():
    drawing = Drawing()
    scene = LiveScene(drawing)
    lines = tuple(Line(name=name, segments=SEGMENTS, color=(0, 0, 0), layer=name) for name in ("truth", "rollouts"))
    scene.show(LiveState(title="x", lines=lines))
    assert [drawing.there[f"/lines/{name}"].visible for name in ("truth", "rollouts")] == [False, True]
    scene.hide("truth", False)
    scene.hide("rollouts", True)
    assert [drawing.there[f"/lines/{name}"].visible for name in ("truth", "rollouts")] == [True, False]


def test_only_what_changed_is_sent_again():
    drawing = Drawing()
    scene = LiveScene(drawing)
    marker = Marker(label="1", position=(0.0, 0.0, 0.0), color=(1, 2, 3))
    line = Line(name="plan", segments=SEGMENTS, color=(0, 0, 0))
    state = LiveState(title="x", lines=(line,), markers=(marker,), ground=ground(np.full((2, 3), 2, np.uint8)))
    scene.show(state)
    drawing.sent.clear()
    scene.show(state)
    assert drawing.sent == []
    scene.show(LiveState(title="x", lines=(Line(name="plan", segments=SEGMENTS + 1, color=(0, 0, 0)),)))
    assert set(drawing.sent) == {"/lines/plan"}


def test_what_is_gone_is_removed():
    drawing = Drawing()
    scene = LiveScene(drawing)
    markers = tuple(Marker(label=str(k), position=(k, 0.0, 0.0), color=(1, 2, 3)) for k in range(3))
    scene.show(LiveState(title="x", markers=markers, ground=ground(np.full((2, 3), 2, np.uint8))))
    assert {"/solids/2", "/markers/2", "/marker-labels/2"} <= set(drawing.there)
    scene.show(LiveState(title="x", markers=markers[:1], ground=ground(np.zeros((2, 3), np.uint8))))
    assert set(drawing.there) == {"/ground", "/grid", "/markers/0", "/marker-labels/0"}
