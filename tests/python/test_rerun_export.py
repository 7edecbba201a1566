"""Recordings of Rerun, read back by Rerun's own reader, and a stream to its server."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
from collections import defaultdict
from pathlib import Path
from typing import Any

import pytest
from export_samples import exported
from mission_samples import ns

from patience import PATIENCE_S, wait_for
from pytpc.present.viewers.rerun_export import write_rerun
from terminals import pytpc

chunk = pytest.importorskip("rerun.chunk", reason="rerun-sdk needs Python 3.11")
EXAMPLE = Path(__file__).parents[2] / "examples/recorded_mission"
RERUN = Path(sys.executable).with_name("rerun")
LIMIT = "/arm/guard/limit/node_cpp_10"


def columns_of(path: Path, component: str) -> dict[str, list[tuple[int, Any]]]:
    """The values of a component by path: the time (ns) and the value, by time."""
    found: defaultdict[str, list[tuple[int, Any]]] = defaultdict(list)
    for one in chunk.RrdReader(path).stream():
        batch = one.to_record_batch()
        if "robot" not in batch.schema.names or component not in batch.schema.names:
            continue
        times = [time.value for time in batch.column("robot").to_pylist()]
        values = batch.column(component).to_pylist()
        found[one.entity_path] += zip(times, (value[0] for value in values), strict=True)
    return {name: sorted(rows) for name, rows in found.items()}


@pytest.fixture
def rrd(tmp_path: Path) -> Path:
    write_rerun(exported(), tmp_path / "mission.rrd")
    return tmp_path / "mission.rrd"


# The numbers are those of test_exporting.
def test_reruns_own_reader_reads_it(rrd: Path) -> None:
    scalars = columns_of(rrd, "Scalars:scalars")
    assert scalars[f"{LIMIT}/value"] == [(ns(1), 4.0), (ns(2), 2.0), (ns(4), 4.0)]
    assert scalars[f"{LIMIT}/threshold"] == [(ns(1), 3.0), (ns(2), 3.0), (ns(4), 3.5)]
    assert scalars[f"{LIMIT}/margin"] == [(ns(1), 1.0), (ns(2), -1.0), (ns(4), 0.5)]
    assert scalars["/arm/guard/near/node_cpp_11/margin"] == [(ns(2.5), 1.5), (ns(3.5), -0.5)]
    assert scalars["/arm/guard/limit/parameter"] == [(ns(1), 3.0), (ns(4), 3.5)]
    assert "/arm/guard/used/node_cpp_12/margin" not in scalars


def test_results_are_states_that_change(rrd: Path) -> None:
    states = columns_of(rrd, "StateChange:state")
    assert states[f"{LIMIT}/result"] == [(ns(1), "true"), (ns(2), "false"), (ns(4), "true")]
    assert states["/arm/guard/used/node_cpp_12/result"] == [(ns(3), "true")]


def test_marks_and_verdicts_are_lines_of_the_log(rrd: Path) -> None:
    (lines,) = columns_of(rrd, "TextLog:text").values()
    marks = [(time, text) for time, text in lines if "mark" in text]
    assert (ns(4.5), "ann: mark type I: =SUM(A1)") in marks
    (texts,) = columns_of(rrd, "TextDocument:text").values()
    assert [time for time, _ in texts] == [ns(4.5), ns(5.0)]
    assert "~limit" in texts[0][1]


def test_it_opens_with_a_blueprint_and_is_valid(rrd: Path) -> None:
    assert len(chunk.RrdReader(rrd).blueprints()) == 1
    said = subprocess.run(
        [RERUN, "rrd", "verify", rrd],
        capture_output=True,
        text=True,
        check=True,
        timeout=PATIENCE_S,
        env={**os.environ, "HOME": str(rrd.parent)},
    )
    assert "1 file verified without error" in said.stdout + said.stderr


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


# The example has 12,797 evaluations and 5 marks. Rerun's server keeps what it gets in a file.
@pytest.mark.filterwarnings("ignore:RRD file has no footer")
def test_a_recording_is_streamed_to_a_viewer(tmp_path: Path) -> None:
    port = free_port()
    kept = tmp_path / "kept.rrd"
    mission = shutil.copytree(EXAMPLE, tmp_path / "mission")
    env = {**os.environ, "HOME": str(tmp_path), "PYTHONPATH": str(EXAMPLE.parents[1])}
    words = ["--save", str(kept), "--port", str(port), "--bind", "127.0.0.1"]
    log = tmp_path / "viewer.txt"
    with log.open("w") as output:
        # The command starts the viewer itself as a process of its own.
        viewer = subprocess.Popen(
            [RERUN, *words], env=env, stdout=output, stderr=output, start_new_session=True
        )
    try:
        wait_for(lambda: is_open(port))
        address = f"127.0.0.1:{port}"
        said = subprocess.run(
            pytpc("stream", str(mission), "--rerun", address, "--speed", "50"),
            env=env,
            capture_output=True,
            text=True,
            check=True,
            timeout=PATIENCE_S,
        )
        assert "passed on 12,797 evaluations" in said.stderr
    finally:
        os.killpg(viewer.pid, signal.SIGTERM)
        viewer.wait(PATIENCE_S)
        wait_for(lambda: not is_open(port))
    # So fast, most evaluations are left out.
    values = columns_of(kept, "Scalars:scalars")
    times = [time for time, _ in values["/mission/mission_timeout/mission_states_cpp_40/value"]]
    assert len(times) > 10
    assert times[-1] - times[0] > 60 * 10**9
    (log_lines,) = columns_of(kept, "TextLog:text").values()
    assert sum("mark type" in text for _, text in log_lines) == 5


def is_open(port: int) -> bool:
    with socket.socket() as one:
        return one.connect_ex(("127.0.0.1", port)) == 0


def test_a_viewer_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    port = free_port()
    said = subprocess.run(
        pytpc("stream", str(EXAMPLE), "--rerun", f"127.0.0.1:{port}"),
        env={**os.environ, "PYTHONPATH": str(EXAMPLE.parents[1])},
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )
    assert said.returncode == 1
    (line,) = said.stderr.splitlines()
    assert line.startswith(f"pytpc: error: no viewer of Rerun's answers at 127.0.0.1:{port}")
    assert line.endswith(f"start one with: rerun --port {port}")
