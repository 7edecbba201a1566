"""Nodes of real rclcpp: built by colcon and TPC, analysed, and heard on a graph.

PyPI has no wheel of rclcpp. These tests run where a ROS 2 with it was sourced, or is in
``/opt/ros``.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from patience import PATIENCE_S, wait_for
from pytpc.build.build import BuildResult, build_workspace
from pytpc.build.nodes_env import nodes_env
from pytpc.ingest.reading import read
from pytpc.workspace.ros2 import AMENT
from ros2_graph import needs_backend, ros2_env
from ros2_rclcpp import ROS, needs_rclcpp
from ros2_reporting import Listener

CELL = Path(__file__).parent / "cell"
pytestmark = [needs_rclcpp, needs_backend]


def sourced(domain: dict[str, str], **more: str) -> dict[str, str]:
    """The environment of a terminal in which the ROS 2 with rclcpp was sourced."""
    return ros2_env(
        domain,
        PATH=f"{ROS}/bin:{os.defpath}",
        LD_LIBRARY_PATH=f"{ROS}/lib",
        **{AMENT: str(ROS), "CMAKE_PREFIX_PATH": str(ROS)},
        **more,
    )


@pytest.fixture(scope="module")
def built(
    tmp_path_factory: pytest.TempPathFactory, domain: dict[str, str]
) -> Iterator[tuple[Path, BuildResult]]:
    workspace = tmp_path_factory.mktemp("rclcpp") / "ws"
    shutil.copytree(CELL, workspace / "src/cell")
    with pytest.MonkeyPatch.context() as patch:
        for name in (*os.environ,):
            if name in ("ROS_VERSION", "ROS_DISTRO", "PYTHONPATH", "VIRTUAL_ENV"):
                patch.delenv(name)
        for name, value in sourced(domain).items():
            patch.setenv(name, value)
        yield workspace, build_workspace(workspace)


def marked() -> set[tuple[str, int, str]]:
    """File, line and parameter of each comparison that the sources name at the end of a line."""
    found = set()
    for source in sorted((CELL / "src").iterdir()):
        for number, line in enumerate(source.read_text().splitlines(), 1):
            code, is_marked, names = line.partition(" // ")
            if is_marked and code.lstrip().startswith("if "):
                found |= {(f"src/{source.name}", number, name) for name in names.split()}
    return found


def run(
    built: tuple[Path, BuildResult], name: str, domain: dict[str, str], **settings: str
) -> subprocess.CompletedProcess[str]:
    """Run a node of the workspace until it ends."""
    workspace, _ = built
    env = nodes_env(workspace, sourced(domain))
    ran = subprocess.run(
        [workspace / ".tpc/install/cell/lib/cell" / name],
        env={**env, **{f"TPC_{key.upper()}": value for key, value in settings.items()}},
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    assert "tpc:" not in ran.stderr
    return ran


def parameters(built: tuple[Path, BuildResult]) -> dict[str, str]:
    """The parameter of each comparison, by its key."""
    return {
        one.key: str(one.source)
        for unit in built[1].units
        for one in unit.comparisons
        if one.type != "constant"
    }


def test_each_comparison_is_found_and_none_that_decides_nothing(
    built: tuple[Path, BuildResult],
) -> None:
    found = {
        (one.file, one.lineno, str(one.source))
        for unit in built[1].units
        for one in unit.comparisons
        if one.type != "constant"
    }
    assert found == marked()
    assert len(found) == 13


# 40 steps count 0 to 9 four times.
GUARD = {
    "limits.speed": (40, 12),  # 7, 8 and 9 are more than 6.5
    "min": (40, 0),
    "use": (40, 40),
    "weights": (40, 20),  # 5 to 9 are more than 4
    "mode": (40, 40),
    "angle_deg": (40, 16),  # 3 sin(x) > pi / 2 for 1, 2, 7 and 8
}


def counts(path: Path, of: dict[str, str]) -> dict[str, tuple[int, int]]:
    """How often each parameter was compared, and with which outcome true."""
    events = read(path).events
    keys = [of[events.keys[number]] for number in events.key.tolist()]
    true = Counter(key for key, result in zip(keys, events.result.tolist(), strict=True) if result)
    return {key: (count, true[key]) for key, count in Counter(keys).items()}


def test_a_node_reports_each_evaluation_into_its_file(
    built: tuple[Path, BuildResult], domain: dict[str, str], tmp_path: Path
) -> None:
    run(built, "guard", domain, sink="file", policy="every", folder=str(tmp_path))
    (file,) = tmp_path.iterdir()
    assert file.name.startswith("robot1_guard") or file.name.startswith("guard")
    found = counts(tmp_path, parameters(built))
    assert found.pop("patience")[0] == 40  # how often it is true is the machine's
    assert found == GUARD


def test_a_lifecycle_node_and_an_action_report_under_their_names(
    built: tuple[Path, BuildResult], domain: dict[str, str], tmp_path: Path
) -> None:
    of = parameters(built)
    for name in ("pump", "counter"):
        run(built, name, domain, sink="file", policy="every", folder=str(tmp_path / name))
    assert counts(tmp_path / "pump", of) == {
        "rate": (1, 0),  # 100 <= 0 is false
        "pressure": (40, 16),  # 6 to 9 are more than 5
        "steps": (40, 1),
    }
    # Order 8 makes 7 new numbers up to 21; order 16 ends at 55, its ninth. Feedback: I is 3 or 7.
    assert counts(tmp_path / "counter", of) == {
        "largest_order": (3, 1),
        "cap": (7 + 9, 1),
        "feedback_every": (7 + 8, 4),
    }


@pytest.mark.parametrize("sink", ["topic", "rosout"])
def test_a_listener_hears_every_report_and_full_name(
    built: tuple[Path, BuildResult], domain: dict[str, str], tmp_path: Path, sink: str
) -> None:
    listener = Listener(domain, tmp_path)
    try:
        run(built, "guard", domain, sink=sink, policy="every", folder=str(tmp_path / "unused"))
        of = parameters(built)

        def heard() -> list[str]:
            if sink == "rosout":
                return [text for text, *_ in listener.logs("robot1.guard")]
            batches = listener.batches("/robot1/guard")
            return [line for batch in batches for line in batch.lines]

        def reports() -> list[str]:
            return [
                of[key] for line in heard() for key in of if f"{key}," in line and ",cmp:" in line
            ]

        wait_for(lambda: len(reports()) >= 40 * (len(GUARD) + 1))
        assert set(Counter(reports()).values()) == {40}
        names = {line.rpartition(",")[2] for line in heard() if "threshold_name:" in line}
        assert {f"/robot1/guard/{name}" for name in (*GUARD, "patience")} <= names
    finally:
        listener.end()
    assert not (tmp_path / "unused").exists()
