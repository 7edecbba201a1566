"""Shows TPC at work on ROS 2: analyses the image capture mission, flies it, names the culprit.

    .venv/bin/python examples/image_capture_ros2/demo.py --out out/demo-ros2

Three missions: a clean one, one with a threshold that is too low (type I) and one with a threshold
that is too high (type II). A scripted observer, who sees only what the UAV does, says when it does
wrong. Status 1 if a mission does not go as its treatment demands, or if the
diagnosis does not blame the changed parameter.
"""

from pytpc_evaluation.demo.demo_examples import IMAGE_CAPTURE_ROS2
from pytpc_evaluation.demo.demo_show import demonstration
from pytpc_evaluation.demo.ros2_missions import analysed_package

if __name__ == "__main__":
    about = "Analyse, fly, rank and report the image capture mission on ROS 2."
    demonstration(IMAGE_CAPTURE_ROS2, about, analysed_package)()
