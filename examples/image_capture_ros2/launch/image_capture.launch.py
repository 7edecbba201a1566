"""Starts the robot and its world: ros2 launch image_capture_ros2 image_capture.launch.py."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, Shutdown
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

PACKAGE = "image_capture_ros2"
ROBOT = ("face_detector", "flight_controller", "mission", "radio_link")


def generate_launch_description() -> LaunchDescription:
    """The arguments, and one process for each node."""
    params = PathJoinSubstitution([FindPackageShare(PACKAGE), "config", "params.yaml"])
    files = [params, LaunchConfiguration("treatment")]
    pace = {
        "rate": ParameterValue(LaunchConfiguration("rate"), value_type=float),
        "seed": ParameterValue(LaunchConfiguration("seed"), value_type=int),
    }
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "treatment",
                default_value=params,
                description="parameters that are loaded over config/params.yaml",
            ),
            DeclareLaunchArgument(
                "rate", default_value="3.0", description="simulated seconds in one second"
            ),
            DeclareLaunchArgument("seed", default_value="1", description="of all noise"),
            *(
                Node(package=PACKAGE, executable=name, name=name, parameters=files)
                for name in ROBOT
            ),
            Node(
                package=PACKAGE,
                executable="uav_simulator",
                name="uav_simulator",
                parameters=[*files, pace],
                on_exit=Shutdown(),
            ),
        ]
    )
