"""Nodes are interrupted at any time while they report: none crashes, and none hangs.

Two kinds of nodes: `interrupted`, whose own handler calls ros::shutdown() inside a report of its
three threads that never pause, and `reporter`, which leaves the signal to roscpp.
"""

from __future__ import annotations

import os
import random
import select
import signal
import subprocess
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from test_sinks import graph, nodes

from pytpc.ros.ros1.graph import RosGraph

__all__ = ["graph", "nodes"]
RUNS = int(os.environ.get("TPC_INTERRUPTIONS", "1000"))
AT_ONCE = 2
PATIENCE_S = 60.0
LONGEST_S = 0.3
SINKS = ({"TPC_SINK": "rosout", "TPC_POLICY": "every"}, {"TPC_SINK": "auto"})
LOADED = ["reporter", "--rate=100000", "--threads=3", "--seconds=60", "--flops=1"]


def interrupt(graph: RosGraph, nodes: Path, run: int) -> str:
    """Run one node and interrupt it; says how that ended: ``ended``, its status, or a fault."""
    env = {name: text for name, text in os.environ.items() if not name.startswith("TPC_")}
    program, *options = LOADED if run // 2 % 2 else ["interrupted"]
    process = subprocess.Popen(
        [str(nodes / program), *options, f"__name:=run{run}"],
        env={**env, **graph.env, **SINKS[run % 2]},
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )
    assert process.stdout is not None
    try:
        chance = random.Random(run)
        # One in ten while it starts: before roscpp has its handler, the signal ends it. Not with a
        # handler that calls ros::shutdown(): while a thread is created, signals go to another one,
        # and in a thread of roscpp this aborts one node in a thousand, with and without TPC.
        starts = program == "reporter" and chance.random() < 0.1
        if not starts:
            if not select.select([process.stdout], [], [], PATIENCE_S)[0]:
                return "does not start"
            process.stdout.readline()
        time.sleep(LONGEST_S * chance.random())
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=PATIENCE_S)
    except subprocess.TimeoutExpired:
        return "hangs"
    finally:
        process.kill()
        process.wait()
    good = (0, -signal.SIGINT) if starts else (0,)
    return "ended" if process.returncode in good else f"status {process.returncode}"


@pytest.mark.slow
def test_a_thousand_interrupted_nodes_end(graph, nodes):
    with ThreadPoolExecutor(AT_ONCE) as pool:
        found = Counter(pool.map(lambda run: interrupt(graph, nodes, run), range(RUNS)))
    assert found == {"ended": RUNS}
