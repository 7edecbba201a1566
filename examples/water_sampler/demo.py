"""Shows TPC at work on a robot of two languages: the water sampler.

    .venv/bin/python examples/water_sampler/demo.py --out out/demo-water

A clean mission, and missions with one changed parameter, which is compared in C++ or in Python;
one ranking across both. A scripted observer, who sees and hears only what the UAV does, says when
it does wrong. Status 1 if a mission does not go as its treatment demands, or if the
diagnosis does not blame the changed parameter.
"""

from pytpc_evaluation.demo.demo_examples import WATER_SAMPLER
from pytpc_evaluation.demo.demo_show import demonstration

if __name__ == "__main__":
    demonstration(WATER_SAMPLER, "Build, fly, rank and report the water sampling mission.")()
