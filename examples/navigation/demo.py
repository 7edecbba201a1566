"""Shows TPC at work on a ground robot: six nodes and a plugin in C++, the mission in Python.

    .venv/bin/python examples/navigation/demo.py --out out/demo-navigation

A clean mission, and missions with one changed parameter, which is compared in a plugin or in
Python; one ranking across all. A scripted observer, who sees and hears only what the robot does,
says when it does wrong. Status 1 if a mission does not go as its treatment demands, or if the
diagnosis does not blame the changed parameter.
"""

from pytpc_evaluation.demo.demo_examples import NAVIGATION
from pytpc_evaluation.demo.demo_show import demonstration

if __name__ == "__main__":
    demonstration(NAVIGATION, "Build, drive, rank and report the navigation mission.")()
