"""`pytpc stream --diagnostics` on a ROS 2 graph, read by a real rclpy subscriber."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from patience import PATIENCE_S
from ros2_graph import PYTHON, needs_wheels
from terminals import pytpc

sys.path.insert(0, str(Path(__file__).parents[1] / "python"))
from mission_samples import comparison, key, static_info

pytestmark = needs_wheels
ROOT = Path(__file__).parents[2]
OK, WARN = 0, 1


@pytest.fixture
def dashboard(env: dict[str, str]) -> Iterator[subprocess.Popen[str]]:
    program = Path(__file__).with_name("dashboard.py")
    process = subprocess.Popen(
        [PYTHON, program, key(0)],
        env=env,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    with process:
        yield process
        process.kill()


# The node logs five reports a second, and marks once somebody listens. The only comparison
# that reports is the first suspect.
def test_rclpy_hears_of_the_node_and_of_the_first_suspect(
    env: dict[str, str], tmp_path: Path, dashboard: subprocess.Popen[str]
) -> None:
    static = tmp_path / "static.json"
    static_info(comparison(0, "~limit"), comparison(1, "~near")).save(static)
    stream = subprocess.Popen(
        pytpc("stream", "--diagnostics", "--static", str(static), "--ros", "2"),
        cwd=tmp_path,
        env={**env, "PYTHONPATH": str(ROOT)},
        stderr=subprocess.DEVNULL,
    )
    assert dashboard.stdout is not None
    try:
        for _ in range(round(PATIENCE_S)):
            found = json.loads(dashboard.stdout.readline())
            if "first suspect" in found["tpc: suspects"]["values"]:
                break
    finally:
        stream.terminate()
        assert stream.wait(PATIENCE_S) == 128 + 15
    assert found["tpc: suspects"]["level"] == WARN
    assert found["tpc: suspects"]["values"]["first suspect"] == "~limit"
    assert found["tpc: suspects"]["values"]["marks"] == "1"
    guard = found["tpc: arm/guard"]
    assert guard["level"] == OK
    assert float(guard["values"]["reports per second"]) == pytest.approx(5.0, abs=4.0)
