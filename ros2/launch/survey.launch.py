"""A survey over ROS 2: ros2 launch coral_ros survey.launch.py area:=survey.yaml topic:=/rov/camera/image_raw."""

from pathlib import Path

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.substitutions import LaunchConfiguration

SIMULATION = Path(__file__).resolve().parents[1] / "config" / "simulation.yaml"
DEFAULTS = {
    "area": ("s1", "Survey file, or a reef to rehearse in."),
    "vehicle": ("/bluerov2", "Namespace of the vehicle."),
    "params_file": ("", "File of ROS parameters: names of topics, publish_tf."),
    "use_sim_time": ("false", "true: the clock of a simulator (/clock)."),
    "topic": ("/bluerov2/camera/image_raw", "Pictures."),
    "perception": ("rgb", "Network that looks at them."),
    "advisor": ("heuristic", "Who decides."),
}


def start(context: LaunchContext) -> list[ExecuteProcess]:
    """Start `coral reef sail`."""
    said = {name: LaunchConfiguration(name).perform(context) for name in DEFAULTS}
    clock = str(SIMULATION) if said["use_sim_time"].lower() in ("true", "1") else ""
    places = ",".join(filter(None, (said["vehicle"], said["params_file"], clock)))
    command = ["coral", "reef", "sail", said["area"], "--vehicle", f"ros2:{places}"]
    command += ["--camera", f"ros2:{said['topic']}", "--perception", said["perception"], "--advisor", said["advisor"]]
    return [ExecuteProcess(cmd=command, output="screen")]


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments and start; the service coral/start arms."""
    arguments = [
        DeclareLaunchArgument(name, default_value=value, description=text) for name, (value, text) in DEFAULTS.items()
    ]
    return LaunchDescription([*arguments, OpaqueFunction(function=start)])
