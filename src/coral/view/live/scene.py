"""The 3D part of the live page: ground, lines, markers and bodies; only changes are sent."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.view.live.state import Ground, Line, LiveBody, LivePart, LiveState, Marker
from coral.view.pictures import RGB

FACES: NDArray[np.uint32] = np.array(
    [(4, 5, 6), (4, 6, 7), (0, 1, 5), (0, 5, 4), (1, 2, 6), (1, 6, 5), (2, 3, 7), (2, 7, 6), (3, 0, 4), (3, 4, 7)],
    np.uint32,
)
"""Top and sides of a block; its bottom is never visible."""


def blocks(
    mask: NDArray[np.bool_], cell_m: float, origin: tuple[float, float], height: float
) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Build upright blocks from cells, one for every run of cells in a row.

    Args:
        mask: Shape=(H, W), the cells to raise; row 0 is the smallest y.
        cell_m: Edge of a cell (m).
        origin: World position of the corner of cell [0, 0].
        height: Height of the blocks (m).

    Returns:
        Vertices, Shape=(8 R, 3), and faces, Shape=(10 R, 3).
    """
    edges = np.diff(np.pad(mask, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, starts = np.nonzero(edges == 1)
    ends = np.nonzero(edges == -1)[1]
    x0, x1 = origin[0] + cell_m * starts, origin[0] + cell_m * ends
    y0 = origin[1] + cell_m * rows
    y1 = y0 + cell_m
    vertices = np.zeros((len(rows), 8, 3), np.float32)
    vertices[:, :, 0] = np.stack([x0, x1, x1, x0] * 2, 1)
    vertices[:, :, 1] = np.stack([y0, y0, y1, y1] * 2, 1)
    vertices[:, 4:, 2] = height
    faces = (FACES[None] + 8 * np.arange(len(rows), dtype=np.uint32)[:, None, None]).reshape(-1, 3)
    return vertices.reshape(-1, 3), faces.astype(np.uint32)


class LiveScene:
    """Keeps the drawing of a viser server equal to the last state shown."""

    def __init__(self, server: Any) -> None:
        self._server, self._scene = server, server.scene
        self._cells: NDArray[np.uint8] | None = None
        self._lines: dict[str, tuple[Any, Line]] = {}
        self._markers: list[tuple[Any, Any, Marker]] = []
        self._bodies: dict[str, Any] = {}
        self._ground: Any = None
        self._solids: dict[int, Any] = {}
        self._hidden: set[str] = {"truth"}
        self._framed = False
        self._scene.world_axes.visible = False

    def show(self, state: LiveState) -> None:
        """Draw a state."""
        if state.ground is not None:
            self._show_ground(state.ground)
        if state.view is not None and not self._framed:
            self._framed = True
            self._server.initial_camera.position, self._server.initial_camera.look_at = state.view
        for line in state.lines:
            self._show_line(line)
        self._show_markers(state.markers)
        for body in state.bodies:
            self._show_body(body)

    def hide(self, layer: str, hidden: bool) -> None:
        """Set the visibility of one layer."""
        (self._hidden.add if hidden else self._hidden.discard)(layer)
        for handle, line in list(self._lines.values()):
            handle.visible = line.layer not in self._hidden and len(line.segments) > 0
        for handle in list(self._solids.values()):
            handle.visible = "shapes" not in self._hidden

    def _show_ground(self, ground: Ground) -> None:
        if self._cells is not None and np.array_equal(self._cells, ground.cells):
            return
        self._cells = ground.cells
        h, w = ground.cells.shape
        size = (w * ground.cell_m, h * ground.cell_m)
        rgb = ground.palette[ground.cells[::-1]]
        if self._ground is None:
            center = (ground.origin[0] + size[0] / 2, ground.origin[1] + size[1] / 2)
            # Half a turn about x: a picture's rows run down, the world's y runs up.
            self._ground = self._scene.add_image(
                "/ground",
                rgb,
                *size,
                format="png",
                wxyz=(0.0, 1.0, 0.0, 0.0),
                position=(*center, 0.0),
                cast_shadow=False,
                receive_shadow=False,
            )
            self._frame(center, size, ground.grid_m)
        else:
            self._ground.image = rgb
        for kind, (height, color) in ground.heights.items():
            self._show_solid(kind, ground, height, color)

    def _show_solid(self, kind: int, ground: Ground, height: float, color: RGB) -> None:
        vertices, faces = blocks(ground.cells == kind, ground.cell_m, ground.origin, height)
        if kind in self._solids:
            self._solids.pop(kind).remove()
        if len(vertices):
            self._solids[kind] = self._scene.add_mesh_simple(
                f"/solids/{kind}",
                vertices,
                faces,
                color=color,
                flat_shading=True,
                cast_shadow=False,
                receive_shadow=False,
                visible="shapes" not in self._hidden,
            )

    def _frame(self, center: tuple[float, float], size: tuple[float, float], grid_m: float) -> None:
        """Look at the whole ground from the south, and draw a grid on it."""
        span, (cx, cy) = max(size), center
        camera = self._server.initial_camera
        camera.position = (cx, cy - 0.56 * span, 0.78 * span)
        camera.look_at = (cx, cy - 0.05 * span, 0.0)
        self._scene.add_grid(
            "/grid",
            width=size[0],
            height=size[1],
            plane="xy",
            cell_size=grid_m,
            section_size=5.0 * grid_m,
            cell_color=(222, 226, 232),
            section_color=(196, 202, 210),
            position=(cx, cy, 0.015 * grid_m),
        )

    def _show_line(self, line: Line) -> None:
        shown = line.layer not in self._hidden and len(line.segments) > 0
        handle, before = self._lines.get(line.name, (None, None))
        if handle is None:
            if not len(line.segments):
                return
            handle = self._scene.add_line_segments(
                f"/lines/{line.name}",
                line.segments,
                line.color,
                thickness=line.width_px,
                thickness_units="screen",
                visible=shown,
            )
        elif before is not None and before.segments is not line.segments:
            if len(line.segments):
                handle.points = line.segments
            handle.visible = shown
        self._lines[line.name] = handle, line

    def _show_markers(self, markers: tuple[Marker, ...]) -> None:
        while len(self._markers) > len(markers):
            ball, label, _ = self._markers.pop()
            ball.remove()
            label.remove()
        for k, marker in enumerate(markers):
            above = np.add(marker.position, (0.0, 0.0, 1.6 * marker.radius_m))
            if k == len(self._markers):
                ball = self._scene.add_icosphere(
                    f"/markers/{k}",
                    radius=marker.radius_m,
                    color=marker.color,
                    position=marker.position,
                    cast_shadow=False,
                    receive_shadow=False,
                )
                label = self._scene.add_label(
                    f"/marker-labels/{k}", marker.label, position=above, anchor="bottom-center", font_screen_scale=1.1
                )
                self._markers.append((ball, label, marker))
                continue
            ball, label, before = self._markers[k]
            if marker != before:
                ball.position, ball.color = marker.position, marker.color
                label.position, label.text = above, marker.label
                self._markers[k] = ball, label, marker

    def _show_body(self, body: LiveBody) -> None:
        if body.name not in self._bodies:
            root = f"/bodies/{body.name}"
            self._bodies[body.name] = self._scene.add_frame(root, show_axes=False)
            for k, part in enumerate(body.parts):
                self._add_part(f"{root}/{k}", part)
            for line in body.lines:
                self._scene.add_line_segments(
                    f"{root}/{line.name}", line.segments, line.color, thickness=line.width_px, thickness_units="screen"
                )
        self._bodies[body.name].position = body.position
        self._bodies[body.name].wxyz = body.wxyz

    def _add_part(self, name: str, part: LivePart) -> None:
        look = {
            "color": part.color,
            "opacity": part.opacity if part.opacity < 1 else None,
            "position": part.center,
            "cast_shadow": False,
            "receive_shadow": False,
        }
        if part.shape == "box":
            self._scene.add_box(name, dimensions=part.size, **look)
        elif part.shape == "ball":
            self._scene.add_icosphere(name, radius=part.size[0] / 2, **look)
        else:
            self._scene.add_cylinder(name, radius=part.size[0] / 2, height=part.size[2], **look)
