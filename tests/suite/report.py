"""Prints what the analysis finds of what a reader finds, node by node: ``tools/suite-report``.

With ``--python`` it is the suite of Python nodes, with ``--rclpy`` that of ROS 2, which need not be
built; with ``--rclcpp`` that of C++ nodes of ROS 2, where rclcpp is installed.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from pytpc.base.errors import RunError, TpcError
from pytpc.static.static_info import StaticInfo
from suite.build import build_suite
from suite.expectations import (
    PACKAGE,
    PYTHON_PACKAGE,
    RCLCPP_PACKAGE,
    RCLPY_PACKAGE,
    Verdict,
    judge,
    load,
    nodes,
)


def judge_all(static: StaticInfo, package: Path | None = None) -> list[Verdict]:
    """The verdict on every node; a node whose link unit is not there has found nothing."""
    where = {} if package is None else {"package": package}
    units = {unit.link_unit: unit for unit in static.units}
    return [
        judge(load(node, **where), units[node].comparisons if node in units else ())
        for node in nodes(**where)
    ]


def table(verdicts: Sequence[Verdict], *, only_wrong: bool = False) -> str:
    """One line a node, what is wrong below it, and the totals."""
    lines = [f"{'node':32} {'expected':>8} {'found':>6} {'missing':>8} {'false':>6}"]
    for verdict in verdicts:
        if only_wrong and verdict.is_right:
            continue
        notes = [f"of {verdict.limits} beyond the limits {verdict.limits_found}"] * bool(
            verdict.limits
        ) + ["imprecise"] * verdict.imprecise
        lines.append(
            f"{verdict.node:32} {verdict.expected:8} {verdict.found:6} {len(verdict.missing):8}"
            f" {len(verdict.false):6}  {', '.join(notes)}".rstrip()
        )
        lines += [f"    missing: {text}" for text in verdict.missing]
        lines += [f"    false: {text}" for text in verdict.false]
    plain = [verdict for verdict in verdicts if not verdict.imprecise]
    lines.append(
        f"{'total':32} {sum(v.expected for v in plain):8} {sum(v.found for v in plain):6}"
        f" {sum(len(v.missing) for v in plain):8} {sum(len(v.false) for v in plain):6}"
    )
    limits = sum(v.limits_found for v in verdicts), sum(v.limits for v in verdicts)
    wrong = sum(not v.is_right for v in verdicts)
    lines.append(
        f"{len(verdicts)} nodes, {wrong} of them not right; beyond the limits {limits[0]} of"
        f" {limits[1]} found; {len(verdicts) - len(plain)} imprecise nodes are not in the total"
    )
    return "\n".join(lines)


def analyse_python(folder: Path, package: Path | None = None) -> StaticInfo:
    """What ``pytpc analyse`` finds in the Python nodes, constants among it.

    Raises:
        RunError: the command fails.
    """
    output = folder / "static.json"
    words = ["analyse", str(package or PYTHON_PACKAGE), "--constants", "-o", str(output)]
    command = [sys.executable, "-m", "pytpc", *words]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    if ran.returncode:
        said = ran.stderr.strip().splitlines() or ["it says nothing"]
        raise RunError(f"pytpc analyse ended with status {ran.returncode}: {said[-1]}")
    return StaticInfo.load(output)


def main() -> None:
    """Build the suite, or read what was built, and print the table."""
    parser = argparse.ArgumentParser(prog="suite-report", description=__doc__)
    parser.add_argument("--python", action="store_true", help="the suite of Python nodes")
    parser.add_argument("--rclpy", action="store_true", help="the suite of nodes of rclpy")
    parser.add_argument("--rclcpp", action="store_true", help="the suite of nodes of rclcpp")
    parser.add_argument("--static", type=Path, help="static information of an earlier build")
    parser.add_argument("--build-type", default="RelWithDebInfo", help="CMAKE_BUILD_TYPE")
    parser.add_argument("--wrong", action="store_true", help="only the nodes that are not right")
    arguments = parser.parse_args()
    python = PYTHON_PACKAGE if arguments.python else None
    package = RCLPY_PACKAGE if arguments.rclpy else python
    compiled = RCLCPP_PACKAGE if arguments.rclcpp else PACKAGE
    try:
        if arguments.static:
            static = StaticInfo.load(arguments.static)
        else:
            with tempfile.TemporaryDirectory(prefix="tpc-suite-") as folder:
                where = Path(folder)
                static = (
                    analyse_python(where, package)
                    if package is not None
                    else build_suite(
                        where / "ws", arguments.build_type, package=compiled
                    ).result.static
                )
    except TpcError as error:
        raise SystemExit(f"error: {error}") from error
    verdicts = judge_all(static, package or compiled)
    print(table(verdicts, only_wrong=arguments.wrong))
    raise SystemExit(any(not verdict.is_right for verdict in verdicts))


if __name__ == "__main__":
    main()
