"""Commands about a running graph: ``sink`` and ``relay``."""

from __future__ import annotations

from contextlib import closing
from dataclasses import asdict
from pathlib import Path

import click
from rich.table import Table

from pytpc.base.errors import RunError
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON
from pytpc.cli.console import console, print_json, progress, table_of, telling, warn
from pytpc.cli.lines import say
from pytpc.cli.running_graph import RUNNING, use_graph
from pytpc.python_runtime.config import POLICIES, SINKS
from pytpc.ros.graphs import nodes_at
from pytpc.ros.node_status import NodeStatus, SettableNodes, Value, chosen
from pytpc.ros.ros1 import relay
from pytpc.ros.ros2.address import is_ros2

_COUNT = click.IntRange(min=0, max=(1 << 31) - 1)


@click.command("sink")
@click.argument("nodes", nargs=-1, metavar="[NODE]...")
@click.option("--sink", type=click.Choice(SINKS), help="Send reports there.")
@click.option(
    "--policy",
    type=click.Choice(POLICIES),
    help="Report every evaluation, or only changes and summaries.",
)
@click.option(
    "--period",
    type=click.FloatRange(0.001, 3600.0),
    help="Seconds covered by a summary (--policy edges).",
)
@click.option(
    "--site-cap", type=_COUNT, help="Most reports per second of one comparison; 0: no limit."
)
@click.option(
    "--process-cap", type=_COUNT, help="Most reports per second of one process; 0: no limit."
)
@click.option("--clear", is_flag=True, help="Forget earlier settings first.")
@RUNNING
@JSON
def sink_command(
    *,
    nodes: tuple[str, ...],
    clear: bool,
    running_folder: Path | None,
    as_json: bool,
    **options: Value,
) -> None:
    """Show or change what instrumented NODEs report, and where to, while they run.

    Without a NODE, it applies to all running nodes and to those started later. Settings are stored
    as ROS parameters (NODE/tpc/sink, or /tpc/sink for all), so they last until the master ends. The
    setting of a node overrides the one for all. Where files go and how large they grow is decided
    by the environment of the node alone (TPC_FOLDER, TPC_FILE_LIMIT, TPC_FILE_RESERVE). On ROS 2,
    settings are the parameters of the hidden node NODE/_tpc: they last until NODE ends, and without
    a NODE they apply to those that run.
    """
    settings = {name: value for name, value in options.items() if value is not None}
    with closing(nodes_at(use_graph(running_folder).master)) as graph:
        found = _settled(graph, nodes, settings, clear=clear)
    if as_json:
        print_json([asdict(status) for status in found])
    else:
        console().print(_table(found), highlight=False)
    failed = [status for status in found if not status.success]
    for status in failed:
        warn(f"{status.node}: {plain(status.message)}")
    if failed:
        raise RunError(f"{many(len(failed), 'node')} did not accept the settings")


def _settled(
    graph: SettableNodes, nodes: tuple[str, ...], settings: dict[str, Value], *, clear: bool
) -> list[NodeStatus]:
    """Set the nodes, and ask them."""
    with telling("looking for the nodes"):
        named = chosen(graph.names(), nodes)
    for node in named if nodes else [None]:
        if clear:
            graph.clear(node)
        graph.set(node, settings)
    found = []
    with progress("asking the nodes") as advance:
        for status in graph.reload_all(named):
            found.append(status)
            advance(len(found), len(named))
    return found


@click.command("relay", context_settings={"ignore_unknown_options": True})
@click.argument("ros_arguments", nargs=-1, metavar="[NAME:=VALUE]...")
def relay_command(*, ros_arguments: tuple[str, ...]) -> None:
    """Forward reports from /rosout to /threshold_information, as a ROS node, until stopped.

    Each report becomes one message TIME,KEY,RESULT,cmp:C,thresh:T,res:R. In a launch file:
    <node pkg="rosout" type="rosout" name="tpc_relay" launch-prefix="pytpc relay"/>. It is for ROS 1
    alone: on ROS 2, the sink `topic` needs none.
    """
    if is_ros2(use_graph().master):
        raise RunError(
            "relay is for ROS 1; nodes of ROS 2 publish on /threshold_information by themselves,"
            " and those that report on /rosout do so after: pytpc sink --sink topic"
        )
    relay.run(ros_arguments, lambda text: say(f"pytpc relay: {plain(text)}"))


def _table(found: list[NodeStatus]) -> Table:
    shown = ("sink", "policy", "sites", "dropped")
    rows = []
    for status in found:
        rest = [f"{name}={value}" for name, value in status.values.items() if name not in shown]
        cells = [status.values.get(name, "") for name in shown]
        rows.append((status.node, *cells, " ".join(rest) if status.values else status.message))
    headings = ("Node", "Sink", "Policy", "Sites", "Dropped", "More")
    return table_of(headings, rows, right=("Sites", "Dropped"))


COMMANDS: list[click.Command] = [sink_command, relay_command]
