"""A master that hangs, dies or never answers, and more names than are kept: the node goes on.

The node is tests/ros/sinks/steady: 100 turns a second, whatever happens, each with 40 evaluations.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from ill_master import IllMaster, Illness
from test_sinks import graph, nodes

from patience import PATIENCE_S
from pytpc.ros.ros1.graph import RosGraph

__all__ = ["graph", "nodes"]
SILENT = "tpc: the ROS master has not answered for 5 s"
UNSENT = re.compile(r"tpc: 32000 evaluations were not sent on /\w+: nobody listened")
TURNS = re.compile(r"turns=[0-9]+ median=[0-9.]+ longest=(?P<longest>[0-9.]+)")
# A turn that waits for the master takes at least so long; usually it takes 10 ms.
LONGEST_MS = 5000.0
FULL = "tpc: this process reads more than 10000 parameters"


def warnings_of(graph: RosGraph, nodes: Path, *options: str, **env: str) -> list[str]:
    """The warnings of a node that has made all its turns and has ended by itself."""
    kept = {name: text for name, text in os.environ.items() if not name.startswith("TPC_")}
    folder = str(graph.folder / "files")
    command = [str(nodes / "steady"), *options]
    process = graph.start("steady", command, env={**kept, "TPC_FOLDER": folder, **env})
    assert process.popen.wait(PATIENCE_S) == 0
    said = process.log.read_text().splitlines()
    (turns,) = filter(None, map(TURNS.match, said))
    assert float(turns["longest"]) < LONGEST_MS
    return [line for line in said if line.startswith("tpc:")]


# ros::master::check() asks for getPid; a node of roscpp does not by itself.
@pytest.mark.parametrize(
    ("request_", "illness"),
    [("getPid", "deaf"), ("getParam.*/tpc", "deaf"), ("getParam.*/tpc", "dies")],
)
@pytest.mark.parametrize("sink", ["auto", "topic", "file"])
def test_a_master_that_does_not_answer_gets_one_warning(
    graph: RosGraph, nodes: Path, sink: str, request_: str, illness: Illness
) -> None:
    port = int(graph.uri.rstrip("/").rsplit(":", 1)[1])
    with IllMaster(port, request_, illness) as master:
        env = {"ROS_MASTER_URI": master.uri, "TPC_SINK": sink}
        said = warnings_of(graph, nodes, "--seconds=8", **env)
        assert master.is_ill.is_set()
    assert [line for line in said if not UNSENT.match(line)] == said[:1]
    assert said[0].startswith(SILENT)


@pytest.mark.parametrize("sink", ["auto", "rosout", "file"])
def test_more_names_than_are_kept_get_one_warning(graph: RosGraph, nodes: Path, sink: str) -> None:
    said = warnings_of(graph, nodes, "--seconds=3", "--names=12000", TPC_SINK=sink)
    assert len(said) == 1
    assert said[0].startswith(FULL)
