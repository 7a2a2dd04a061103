"""Facts of scenes, written by hand."""


def brick(size=(0.06, 0.04, 0.02), at=(0.0, 0.0, 0.01), quat=(1.0, 0.0, 0.0, 0.0), **more):
    """One object that moves, on the table by default."""
    return {
        "label": "brick",
        "size_m": list(size),
        "pose": [*at, *quat],
        "shapes": ["box"],
        "solid_share": 1.0,
        "parts": [{"size_m": list(size), "position": [0.0, 0.0, 0.0]}],
        "points": {},
        **more,
    }


def fixture(size, at, yaw_deg=0.0):
    return {"size_m": list(size), "position": list(at), "yaw_deg": yaw_deg}


def written(objects, fixtures=None, places=None, goals=()):
    """A scene on a table of 0.8 by 0.8 m."""
    return {
        "task": "new",
        "instruction": "Do it.",
        "goals": list(goals),
        "objects": objects,
        "fixtures": fixtures or {},
        "places": places or {},
        "numbers": {},
        "table": {"x": [-0.4, 0.4], "y": [-0.4, 0.4]},
        "hand": {"pose": [0.0, 0.0, 0.3, 0.0, 1.0, 0.0, 0.0], "opening_m": 0.04, "widest_opening_m": 0.08},
    }
