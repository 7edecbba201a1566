"""Commands about a running graph: ``sink`` and ``relay``."""

from __future__ import annotations

import json
import os
from dataclasses import asdict

import click
from rich.table import Table

from pytpc.base.errors import RunError
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON
from pytpc.cli.console import console, progress, table_of, warn
from pytpc.python_runtime.config import POLICIES, SINKS
from pytpc.ros.ros1 import relay
from pytpc.ros.ros1.instrumented_nodes import InstrumentedNodes, NodeStatus, Value, chosen
from pytpc.ros.ros1.master import uri_of

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
@JSON
def sink_command(*, nodes: tuple[str, ...], clear: bool, as_json: bool, **options: Value) -> None:
    """Show or change what instrumented NODEs report, and where to, while they run.

    Without a NODE, it applies to all running nodes and to those started later. Settings are stored
    as ROS parameters (NODE/tpc/sink, or /tpc/sink for all), so they last until the master ends. The
    setting of a node overrides the one for all. Where files go and how large they grow is decided
    by the environment of the node alone (TPC_FOLDER, TPC_FILE_LIMIT, TPC_FILE_RESERVE).
    """
    settings = {name: value for name, value in options.items() if value is not None}
    graph = InstrumentedNodes(uri_of(os.environ))
    named = chosen(graph.names(), nodes)
    for node in named if nodes else [None]:
        if clear:
            graph.clear(node)
        graph.set(node, settings)
    found = []
    with progress("asking the nodes") as advance:
        for node in named:
            found.append(graph.reload(node))
            advance(len(found), len(named))
    if as_json:
        click.echo(json.dumps([asdict(status) for status in found], indent=1))
    else:
        console().print(_table(found), highlight=False)
    failed = [status for status in found if not status.success]
    for status in failed:
        warn(f"{status.node}: {plain(status.message)}")
    if failed:
        raise RunError(f"{many(len(failed), 'node')} did not accept the settings")


@click.command("relay", context_settings={"ignore_unknown_options": True})
@click.argument("ros_arguments", nargs=-1, metavar="[NAME:=VALUE]...")
def relay_command(*, ros_arguments: tuple[str, ...]) -> None:
    """Forward reports from /rosout to /threshold_information, as a ROS node, until stopped.

    Each report becomes one message TIME,KEY,RESULT,cmp:C,thresh:T,res:R. In a launch file:
    <node pkg="rosout" type="rosout" name="tpc_relay" launch-prefix="pytpc relay"/>.
    """
    relay.run(ros_arguments, lambda text: click.echo(f"pytpc relay: {plain(text)}", err=True))


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
