"""Shows TPC at work: builds the image capture mission with its passes, flies it, names the culprit.

    .venv/bin/python examples/image_capture/demo.py --out out/demo

Three missions: a clean one, one with a threshold that is too low (type I) and one with a threshold
that is too high (type II). A scripted observer, who sees only what the UAV does, says when it does
wrong. Status 1 if a mission does not go as its treatment demands, or if the
diagnosis does not blame the changed parameter.
"""

from pytpc_evaluation.demo.demo_examples import IMAGE_CAPTURE
from pytpc_evaluation.demo.demo_show import demonstration

if __name__ == "__main__":
    demonstration(IMAGE_CAPTURE, "Build, fly, rank and report the image capture mission.")()
