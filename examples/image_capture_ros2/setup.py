"""Installs the nodes of the package."""

from setuptools import setup

PACKAGE = "image_capture_ros2"

setup(
    name=PACKAGE,
    version="0.1.0",
    packages=[PACKAGE],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (f"share/{PACKAGE}", ["package.xml"]),
        (f"share/{PACKAGE}/config", ["config/params.yaml"]),
        (f"share/{PACKAGE}/launch", ["launch/image_capture.launch.py"]),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="The TPC maintainers",
    maintainer_email="tpc@example.org",
    description="A simulated UAV that takes a picture of a person: nodes of rclpy.",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "face_detector = image_capture_ros2.face_detector:main",
            "flight_controller = image_capture_ros2.flight_controller:main",
            "mission = image_capture_ros2.mission:main",
            "radio_link = image_capture_ros2.radio_link:main",
            "uav_simulator = image_capture_ros2.uav_simulator:main",
        ]
    },
)
