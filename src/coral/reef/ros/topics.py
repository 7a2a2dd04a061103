"""Topics and services of a vehicle over ROS 2, in its namespace."""

from __future__ import annotations

TOPICS = {
    "odom": (
        "nav_msgs/Odometry",
        "Read: x east, y north, z up, z = 0 at the surface; twist in the body's frame (REP-103).",
    ),
    "battery": ("sensor_msgs/BatteryState", "Read; optional."),
    "cmd_vel": ("geometry_msgs/Twist", "10 Hz: forward, up (to hold the depth), yaw rate."),
    "arm": ("std_srvs/SetBool", "Called if it exists."),
    "coral/map": ("nav_msgs/OccupancyGrid", "Latched: free 0, oysters 50, obstacle 100, unexplored −1."),
    "coral/path": ("nav_msgs/Path", "In the survey's own frame, `map`, as the next three."),
    "coral/oysters": ("visualization_msgs/MarkerArray", "The clusters."),
    "coral/goal": ("geometry_msgs/PoseStamped", "The goal at hand."),
    "coral/goal/marker": ("visualization_msgs/Marker", "The same as a marker, namespace `goal`."),
    "coral/events": ("std_msgs/String", "Each event of the run as JSON, decisions included."),
    "coral/instruction": ("std_msgs/String", "Latched, of a mission in words: its instruction, as it is now."),
    "coral/instruct": ("std_msgs/String", "Read: another instruction; `coral/events` tells a refusal."),
    "diagnostics": ("diagnostic_msgs/DiagnosticArray", "The state and its reason, late ticks."),
    "coral/WORD": (
        "std_srvs/Trigger",
        "The operator's commands: `start`, `hold`, `resume`, `home`, `surface`, `stop`, `disarm`.",
    ),
    "coral/question": ("std_msgs/String", "With `--advisor ros2:NAMESPACE`: a question, as at the desk."),
    "coral/question/pictures": ("sensor_msgs/CompressedImage", "Its pictures."),
    "coral/answer": ("std_msgs/String", 'Read: `{"id": "000001-...", "answer": {...}}`.'),
}
"""Type of each, and what is on it."""
