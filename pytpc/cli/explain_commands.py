"""Commands that say why: ``explain``, ``coverage`` and ``blind-spots``."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path

import click
from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON, PATH, as_object
from pytpc.cli.console import console, print_json, warn_of_failed
from pytpc.cli.long_table import print_table
from pytpc.cli.sources import SOURCES, SOURCES_AND_QUESTION, static_of
from pytpc.static.across import across, changes
from pytpc.static.coverage import STATES, Covered, State, coverage, totals
from pytpc.static.explanations import (
    Explanation,
    FoundComparison,
    look_up,
    where,
    why_no_comparison,
)
from pytpc.static.link_unit import LinkUnit, PathStep
from pytpc.static.message_paths import MessagePaths, path_json, path_text, routes
from pytpc.static.parameters import parameter_name
from pytpc.static.static_info import StaticInfo
from pytpc.static.wiring import UNKNOWN, Wiring

_MOST_WAYS = 20
_KINDS = {
    "lost_value": "value lost",
    "lost_outcome": "outcome lost",
    "unknown_pointer": "pointer to nowhere known",
    "many_targets": "pointer to very many",
    "unread": "stored, not read here",
    "dynamic_name": "name put together",
    "outside_sources": "compared in other code",
    "without_debug_info": "no debug information",
    "indirect_call": "call of unknown function",
}


@dataclass(frozen=True)
class _ExplainArguments:
    sources: tuple[Path, ...]
    question: str
    show_all: bool
    launch: Path | None
    mission: Path | None
    as_json: bool

    def __post_init__(self) -> None:
        if self.launch is not None and self.mission is not None:
            raise click.UsageError("give --launch or --mission, not both")


def _wiring(given: _ExplainArguments) -> Wiring:
    """What is known of the nodes."""
    if given.launch is None and given.mission is None:
        return UNKNOWN
    # Their import takes longer than that of the commands that need no recording.
    from pytpc.api.missions import read_named  # noqa: PLC0415
    from pytpc.api.wired_robot import wiring_of_launch, wiring_of_mission  # noqa: PLC0415

    if given.mission is not None:
        return wiring_of_mission(read_named(given.mission), given.mission)
    assert given.launch is not None
    return wiring_of_launch(given.launch, given.sources)


@click.command("explain")
@SOURCES_AND_QUESTION
@click.option("--all", "show_all", is_flag=True, help="Show the path of every matching comparison.")
@click.option(
    "--launch",
    type=PATH,
    metavar="FILE",
    help="Launch file that starts the nodes and names their topics.",
)
@click.option(
    "--mission",
    type=PATH,
    metavar="MISSION",
    help="Recorded mission whose nodes and topics count, in place of --launch.",
)
@JSON
@as_object(_ExplainArguments)
def explain_command(given: _ExplainArguments) -> None:
    """Show the path from where a parameter is read, through the comparison, to what is exposed.

    Where the path enters another library of the process, the library is named.

    If other nodes compare something that depends on the messages which it decides, "goes on to"
    shows the paths over the nodes. Without --launch or --mission, each link unit counts as one
    node, and topics have the names that the code gives them.

    SOURCE is a static.json, a build base or a workspace; without it, this folder is used. Without
    --all, the path is shown for the comparison nearest to an exposing statement; the others get one
    line each.
    """
    static = static_of(given.sources)
    explanation = look_up(static, given.question)
    paths = MessagePaths(static, _wiring(given))
    if given.as_json:
        print_json(_json(explanation, paths))
        return
    out = console()
    shown = explanation.comparisons if given.show_all else explanation.comparisons[:1]
    for found in shown:
        _print_way(out, found)
        _print_goes_on(out, paths, found)
    rest = explanation.comparisons[len(shown) :]
    if rest:
        out.print(Text(f"{many(len(rest), 'more comparison')} (use --all to show their paths):"))
        for found in rest:
            out.print(Padding(_heading(found), (0, 0, 0, 2), expand=False))
    if not explanation.comparisons:
        print_why_not(out, explanation)


@click.command("blind-spots")
@SOURCES
@JSON
def blind_spots_command(sources: tuple[Path, ...], as_json: bool) -> None:
    """List the places in SOURCE that the analysis cannot see past."""
    static = static_of(sources)
    if as_json:
        spots = [
            {"package": unit.package, "link_unit": unit.link_unit, **asdict(spot)}
            for unit in static.units
            for spot in unit.blind_spots
        ]
        print_json(spots)
        return
    out = console()
    for unit in static.units:
        if unit.blind_spots:
            out.print(Text(plain(f"{unit.package}/{unit.link_unit}"), style="bold"))
            out.print(_spots_table(unit), highlight=False)
    click.echo(_spots_summary(static))


@click.command("coverage")
@SOURCES
@click.option(
    "--state", "states", multiple=True, type=click.Choice(list(STATES)), help="Show only these."
)
@JSON
def coverage_command(sources: tuple[Path, ...], states: tuple[State, ...], as_json: bool) -> None:
    """Show what became of each parameter that is read in SOURCE.

    \b
    compared  a comparison reports it
    hidden    it is compared, but nothing exposed depends on that
    lost      the analysis cannot follow its value; the table says where, and why
    unread    it is stored or passed on, and its link unit does not read it there
    used      it is used, and never compared: a gain, a name, a rate

    Of several states, a parameter has the first. SOURCE is a static.json, a build base or a
    workspace; without it, this folder is used.
    """
    static = static_of(sources)
    covered = coverage(static)
    counted = totals(covered)
    shown = [found for found in covered if not states or found.state in states]
    if as_json:
        print_json({"totals": counted, "parameters": [asdict(found) for found in shown]})
        return
    rows = [_covered_row(found) for found in shown]
    print_table(
        console(), ("Parameter", "Link unit", "State", "Read at", "What became of it"), rows
    )
    click.echo(
        f"{many(len(covered), 'parameter')} in {many(len(static.units), 'link unit')}: "
        + ", ".join(f"{count:,} {state}" for state, count in counted.items() if count)
    )
    warn_of_failed(static)


COMMANDS: list[click.Command] = [explain_command, coverage_command, blind_spots_command]


def _covered_row(found: Covered) -> list[str]:
    read_at = found.reads[0] if found.reads else ""
    cells = [found.parameter, f"{found.package}/{found.link_unit}", found.state, read_at]
    match found.state:
        case "compared":
            became = _places(found.comparisons)
        case "hidden":
            became = _places(found.hidden)
        case "lost" | "unread":
            places = found.lost or found.unread
            others = f"; and {len(places) - 1} more" if len(places) > 1 else ""
            became = f"{places[0].place}: {places[0].why}{others}"
        case _:
            became = STATES[found.state]
    return [*cells, became]


def _places(places: tuple[str, ...]) -> str:
    others = f" and {len(places) - 1} more" if len(places) > 1 else ""
    return f"compared at {places[0]}{others}"


def _heading(found: FoundComparison) -> Text:
    comparison, unit = found.comparison, found.unit
    text = Text(plain(parameter_name(comparison)), style="bold")
    text.append(f"  {plain(where(comparison))}", style="default not bold")
    text.append(
        f"  {comparison.type}, distance {comparison.distance},"
        f" in {plain(unit.package)}/{plain(unit.link_unit)}, key {comparison.key}",
        style="dim not bold",
    )
    return text


def _print_way(console: Console, found: FoundComparison) -> None:
    console.print(_heading(found))
    path = found.comparison.path
    for line in _found_in(found):
        console.print(Padding(Text(plain(line)), (0, 0, 0, 2), expand=False), highlight=False)
    if not path:
        console.print(
            Padding(Text("this static information contains no paths"), (0, 0, 1, 2), expand=False)
        )
        return
    table = _plain_table(3)
    for step, entered in zip(path, changes(path), strict=True):
        if entered is not None:
            table.add_row(Text("in"), Text(plain(entered), style="bold"), Text(""))
        table.add_row(*_cells(step))
    console.print(Padding(table, (0, 0, 1, 2), expand=False), highlight=False)


def _print_goes_on(console: Console, paths: MessagePaths, found: FoundComparison) -> None:
    """The paths over nodes, the shortest first: one for each row of topics and nodes."""
    ways = routes(paths.from_key(found.comparison.key))
    if not ways:
        return
    console.print(Padding(Text("goes on to", style="bold"), (0, 0, 0, 2), expand=False))
    for way, others in ways[:_MOST_WAYS]:
        line = Text(plain(path_text(paths.static, way, others)))
        console.print(Padding(line, (0, 0, 0, 4), expand=False), highlight=False)
    if len(ways) > _MOST_WAYS:
        more = Text(f"and {many(len(ways) - _MOST_WAYS, 'more path')}; --json has all", style="dim")
        console.print(Padding(more, (0, 0, 0, 4), expand=False))
    console.print()


def _found_in(found: FoundComparison) -> list[str]:
    """Which link unit does what, and the processes."""
    lines = [across(found.comparison.path)]
    processes = found.comparison.processes or ()
    if processes:
        some = "process" if len(processes) == 1 else f"{len(processes)} processes:"
        lines.append(f"found in {some} {', '.join(processes)}")
    return [line for line in lines if line]


def _cells(step: PathStep) -> tuple[Text, Text, Text]:
    what = Text(plain(step.what))
    # The line of a closing brace is not worth showing.
    if step.source_code and step.source_code.strip("}; "):
        what.append("\n    " + plain(step.source_code), style="dim")
    place = Text(plain(where(step)) if step.file else "")
    strong = "bold" if step.step in {"read", "compare", "expose"} else ""
    return Text(step.step, style=strong), place, what


def print_why_not(console: Console, explanation: Explanation) -> None:
    """Say why no comparison of a parameter is reported."""
    for unit, read in explanation.reads:
        text = Text(plain(read.name), style="bold")
        text.append(
            f"  read at {plain(where(read))} in {plain(unit.package)}/{plain(unit.link_unit)}",
            style="not bold",
        )
        console.print(text)
    console.print(Text("no comparison of it is reported:"))
    for reason in why_no_comparison(explanation):
        console.print(Padding(Text(plain(reason)), (0, 0, 0, 2), expand=False))


def _json(explanation: Explanation, paths: MessagePaths) -> dict[str, object]:
    def with_unit(unit: LinkUnit, fields: dict[str, object]) -> dict[str, object]:
        return {"package": unit.package, "link_unit": unit.link_unit, **fields}

    return {
        "question": explanation.question,
        "comparisons": [
            with_unit(
                each.unit,
                {
                    **asdict(each.comparison),
                    "path": [step.to_json() for step in each.comparison.path],
                    "goes_on": [
                        path_json(paths.static, path)
                        for path in paths.from_key(each.comparison.key)
                    ],
                },
            )
            for each in explanation.comparisons
        ],
        "reads": [with_unit(unit, asdict(read)) for unit, read in explanation.reads],
        "not_exposed": [with_unit(unit, asdict(found)) for unit, found in explanation.not_exposed],
        "blind_spots": [with_unit(unit, asdict(spot)) for unit, spot in explanation.blind_spots],
        "why_no_comparison": why_no_comparison(explanation),
    }


def _spots_table(unit: LinkUnit) -> Padding:
    table = _plain_table(4)
    for spot in unit.blind_spots:
        what = Text(plain(spot.what))
        if spot.source_code:
            what.append("\n    " + plain(spot.source_code), style="dim")
        cells = (_KINDS.get(spot.kind, spot.kind), spot.parameter or "", where(spot))
        table.add_row(*(Text(plain(cell)) for cell in cells), what)
    return Padding(table, (0, 0, 1, 2), expand=False)


def _plain_table(columns: int) -> Table:
    table = Table(box=None, show_header=False, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column(no_wrap=True)
    for _ in range(columns - 1):
        table.add_column(overflow="fold")
    return table


def _spots_summary(static: StaticInfo) -> str:
    """The number of blind spots of each kind, and of those that are not listed."""
    listed = Counter(spot.kind for unit in static.units for spot in unit.blind_spots)
    total = sum(unit.counts.blind_spots for unit in static.units)
    kinds = ", ".join(f"{count} {_KINDS.get(kind, kind)}" for kind, count in listed.items())
    inside = sum(unit.counts.indirect_calls for unit in static.units)
    text = many(total, "blind spot") + (f": {kinds}" if kinds else "")
    hidden = total - listed.total()
    if hidden:
        text += f"; {hidden} more are not listed"
    text += f"; {many(inside, 'call')} of unknown functions with those inside libraries"
    too_large = [unit.link_unit for unit in static.units if unit.counts.given_up]
    if too_large:
        text += f"; too large to tell which reads see a write: {', '.join(map(plain, too_large))}"
    return text
