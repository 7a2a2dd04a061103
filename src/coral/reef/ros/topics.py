"""Topics and services of a vehicle over ROS 2, in its namespace."""

from __future__ import annotations

TOPICS = {
    "odom": "nav_msgs/Odometry",
    "battery": "sensor_msgs/BatteryState",
    "cmd_vel": "geometry_msgs/Twist",
    "arm": "std_srvs/SetBool",
    "coral/map": "nav_msgs/OccupancyGrid",
    "coral/path": "nav_msgs/Path",
    "coral/oysters": "visualization_msgs/MarkerArray",
    "coral/goal": "geometry_msgs/PoseStamped",
    "coral/events": "std_msgs/String",
    "coral/instruction": "std_msgs/String",
    "coral/instruct": "std_msgs/String",
    "diagnostics": "diagnostic_msgs/DiagnosticArray",
    "coral/WORD": "std_srvs/Trigger",
    "coral/question": "std_msgs/String",
    "coral/question/pictures": "sensor_msgs/CompressedImage",
    "coral/answer": "std_msgs/String",
}
"""Type of each."""
WHAT = {
    "odom": "Read: x east, y north, z up, z = 0 at the surface; twist in the body's frame (REP-103).",
    "battery": "Read; optional.",
    "cmd_vel": "10 Hz: forward, up (to hold the depth), yaw rate.",
    "arm": "Called if it exists.",
    "coral/map": "Latched: free 0, oysters 50, obstacle 100, unexplored −1.",
    "coral/path": "In the survey's own frame, `map`, as the next two.",
    "coral/oysters": "The clusters.",
    "coral/goal": "The goal at hand.",
    "coral/events": "Each event of the run as JSON, decisions included.",
    "coral/instruction": "Latched, of a mission in words: its instruction, as it is now.",
    "coral/instruct": "Read: another instruction; `coral/events` tells a refusal.",
    "diagnostics": "The state and its reason, late ticks.",
    "coral/WORD": "The operator's commands: `start`, `hold`, `resume`, `surface`, `stop`, `disarm`.",
    "coral/question": "With `--advisor ros2:NAMESPACE`: a question, as at the desk.",
    "coral/question/pictures": "Its pictures.",
    "coral/answer": 'Read: `{"id": "000001-...", "answer": {...}}`.',
}
"""What is on each."""
