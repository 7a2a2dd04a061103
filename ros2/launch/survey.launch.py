"""A survey over ROS 2: ros2 launch coral_ros survey.launch.py area:=survey.yaml topic:=/rov/camera/image_raw."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.substitutions import LaunchConfiguration as Given


def generate_launch_description() -> LaunchDescription:
    """Start `coral reef sail`; the service coral/start arms."""
    defaults = {
        "area": "s1",
        "vehicle": "/bluerov2",
        "topic": "/bluerov2/camera/image_raw",
        "perception": "rgb",
        "advisor": "heuristic",
    }
    command = ["coral", "reef", "sail", Given("area"), "--vehicle", ["ros2:", Given("vehicle")]]
    command += ["--camera", ["ros2:", Given("topic")], "--perception", Given("perception")]
    command += ["--advisor", Given("advisor")]
    return LaunchDescription(
        [
            *(DeclareLaunchArgument(name, default_value=value) for name, value in defaults.items()),
            ExecuteProcess(cmd=command, output="screen"),
        ]
    )
