"""The files of a run's folder: writers and readers take their names from here, and the reference its tables."""

from __future__ import annotations

from typing import Final


class RunFiles:
    """Files of every run."""

    REPORT: Final = "report.html"
    """One page with pictures, charts and every decision; it needs no other file."""
    CONFIG: Final = "config.yaml"
    """Every configuration value, with version, machine and date."""
    EVENTS: Final = "events.jsonl"
    """What happened, one JSON object a line."""
    TRAJECTORY: Final = "trajectory.csv"
    """One row per control step."""
    ATTEMPTS: Final = "attempts.jsonl"
    """Every question with its answer and the verdict, one JSON object a line; only where an advisor was asked."""
    PICTURES: Final = "pictures/"
    """The pictures of the questions, each once, named by its digest."""
    METRICS: Final = "metrics.json"
    """The metrics: the same seed gives the same file, byte for byte."""
    TIMING: Final = "timing.json"
    """What depends on the machine: wall time, time of control and planning."""
    INBOX: Final = "inbox/"
    """Open questions, where a person answers at the desk and no other inbox is named."""


class SurveyFiles(RunFiles):
    """Files of a survey."""

    WORLD: Final = "world.yaml"
    """The reef; at sea, the area with its fence."""
    MAP: Final = "map.png"
    """The map with the robot's path."""
    VIDEO: Final = "mission.mp4"
    """The mission as a video (`--video`)."""
    JUDGE: Final = "judge.csv"
    """What only the experimenter knows, at each step: `step`, `t`, shares `imaged` and `inspected`, distance from the
    reef (`reef_m`)."""
    FRAMES: Final = "frames/"
    """Pictures by number of the step: the map and the camera every 2 s; twice a second those that `poses.csv` lists,
    of classes, depth (mm, 16 bits) and, where there are any, colours and doubt. Without them, the final map alone."""
    POSES: Final = "frames/poses.csv"
    """Where each picture was taken: `t`, `x`, `y`, `z`, `roll`, `pitch`, `yaw` as the robot believed, `odo_x`, `odo_y`,
    `odo_yaw` by odometry alone, and its files `labels`, `depth`, `rgb`, `doubt`."""
    SAVED: Final = "survey.npz"
    """What `coral reef sail` knows, saved as it grows; `--resume` reads it."""
    PREFLIGHT: Final = "preflight.txt"
    """What `coral reef sail` checked before it armed."""


class TaskFiles(RunFiles):
    """Files of a contact task."""

    TASK: Final = "task.yaml"
    """The task."""
    STATES: Final = "states.csv"
    """The simulator's joint positions every 0.08 s; pictures and video are drawn from them by ray casting."""
    KEYFRAMES: Final = "keyframes.png"
    """The report's pictures alone."""
    VIDEO: Final = "episode.mp4"
    """The episode as a video (`--video`)."""
    SEEN: Final = "seen.png"
    """The first pictures that a served policy was sent."""
    REMEMBERED: Final = "remembered.sqlite"
    """In a bench with a memory: a memory of the success alone."""
