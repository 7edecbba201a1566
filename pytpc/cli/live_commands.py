"""The command ``live``: a page that shows what decides now."""

from __future__ import annotations

import asyncio
import contextlib
import html
import os
import signal
import sys
import tempfile
import webbrowser
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from pytpc.api.comparing import RecordedRun
from pytpc.api.live_board import LiveBoard
from pytpc.api.live_mission import Feed, RecordedFeed, WatchedMission, Watching, fresh_watching
from pytpc.api.live_observers import ObserverMissions, Observers
from pytpc.api.live_values import LiveValues
from pytpc.base.errors import RunError, TpcError
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import PATH, REFERENCE, as_object
from pytpc.cli.console import telling, warn
from pytpc.cli.lines import say
from pytpc.cli.mark_commands import (
    MarksTarget,
    check_observer,
    graph_to_mark,
    marks_target,
    recorded,
    tell_where,
)
from pytpc.cli.options import (
    STATIC,
    TYPES,
    WINDOW,
    AskArguments,
    good_runs,
    recording_of,
    refuse_itself,
)
from pytpc.cli.running_graph import RUNNING, UsedGraph
from pytpc.cli.watch_commands import judged_by, opened_graph, static_to_watch
from pytpc.diagnosis.question import Question
from pytpc.present.live.assets import qr_lines
from pytpc.present.marking_terminal import RecordedMission
from pytpc.present.watch_screen import LAYOUTS, WatchOptions
from pytpc.recording.marks_file import MarksFile
from pytpc.ros.graphs import marks_at
from pytpc.serve.access import is_private
from pytpc.serve.server import LiveServer, ServeOptions

_WIDEST_QR = 60
_TERMINATED = 128


@dataclass(frozen=True)
class _LiveArguments(AskArguments):
    recording: Path | None
    running_folder: Path | None
    observer: str
    output: Path | None
    references: tuple[Path, ...]
    host: str
    port: int
    no_browser: bool
    allow_apply: bool


@click.command("live")
@click.argument("recording", type=PATH, required=False)
@STATIC
@RUNNING
@click.option(
    "--host",
    default="127.0.0.1",
    show_default=True,
    metavar="ADDRESS",
    help="Listen at this address of this machine. 0.0.0.0: at all of them, so that a phone can"
    " open the page.",
)
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=0,
    show_default=True,
    metavar="N",
    help="Listen at this port. 0: any that is free.",
)
@click.option("--no-browser", is_flag=True, help="Do not open the page in a browser.")
@click.option(
    "--observer",
    default="observer",
    show_default=True,
    metavar="NAME",
    help="Name of the first observer, used as a topic namespace; further ones get a number. Each"
    " can choose another name on the page.",
)
@click.option("-o", "--output", type=PATH, help="Write the marks to this CSV file, as `mark` does.")
@click.option(
    "--allow-apply",
    is_flag=True,
    help="Let the page change values of parameters, each after its change was shown.",
)
@REFERENCE
@WINDOW
@click.option(
    "--top",
    type=click.IntRange(min=1, max=100),
    default=10,
    show_default=True,
    metavar="N",
    help="Show this many suspects of each type.",
)
@TYPES
@as_object(lambda **given: _LiveArguments(as_json=False, **given))
def live_command(given: _LiveArguments) -> None:
    """Serve a page that shows what decides now, and takes marks.

    The page shows the comparisons nearest to turning, those that have not turned for long, the last
    turns, and the suspects. It has buttons and keys for marks, for several observers at once. It is
    of the graph that `watch` would use; with RECORDING, its clock can be played and moved.

    The address has a token: whoever has it sees the page and can mark. Nothing listens beyond this
    machine without --host. Ctrl-C ends the server; the marks are kept.

    \b
    pytpc live                        # of the recording that runs on this machine
    pytpc live --host 0.0.0.0         # the same, with a QR code for a phone
    pytpc live out/today              # of a recording
    """
    check_observer(given.observer)
    if not given.observer:
        raise click.BadParameter("a name is needed", param_hint="--observer")
    graph = graph_to_mark(given.recording, given.running_folder)
    run = None
    if given.recording is not None:
        run = RecordedRun(recording_of(given.recording), given.recording)
    static = static_to_watch(given.static_source, given.recording, graph, run)
    question = Question(given.types, given.window_s)
    good = good_runs(given.references, static)
    if run is not None:
        refuse_itself(good, run.recording)
    fresh = fresh_watching(static, question)
    target = marks_target(given.recording, "", given.output, graph)
    file = MarksFile(target.home)
    layout = (None,) if given.types == "ignore" else LAYOUTS[0]
    options = WatchOptions(layout=layout, top=given.top)
    mission, feed, clock = _opened(graph, run, fresh)
    judged = judged_by((graph, run), static, given.static_source, question, good) if good else None
    believe = given.types != "ignore"
    watched = WatchedMission(mission, feed, options, believe=believe, judged=judged)
    board = LiveBoard(watched, Observers(watched, file), clock, given.window_s)
    values = None
    if given.allow_apply:
        values = LiveValues("" if graph is None else graph.master, given.recording)
    serving = ServeOptions(given.host, given.port, given.observer, values)
    wrong = _served(board, serving, open_browser=not given.no_browser)
    _tell_marks(file, target, is_heard=not watched.unheard())
    tell_where(graph)
    if wrong:
        raise RunError(wrong)


def _opened(
    graph: UsedGraph | None, run: RecordedRun | None, fresh: Watching
) -> tuple[ObserverMissions, Feed, RecordedMission | None]:
    """What is marked, where its reports come from, and the clock of a recording."""
    if graph is not None:
        with telling("connecting"):
            base, feed = opened_graph(graph.master, "", fresh)
        master = graph.master
        missions = ObserverMissions(
            base, lambda name: marks_at(master, name, "watching", advertise=False)
        )
        return missions, feed, None
    assert run is not None
    assert run.source is not None
    clock = recorded(run.recording, run.source)
    return ObserverMissions(clock), RecordedFeed(run.recording, fresh), clock


def _served(board: LiveBoard, serving: ServeOptions, *, open_browser: bool) -> str:
    """Serve until a signal; what is wrong with the marks, or nothing."""
    status = 0
    try:
        status = asyncio.run(_serve(board, serving, open_browser=open_browser))
    finally:
        wrong = board.close()
    if status:
        raise SystemExit(_TERMINATED + status)
    return wrong


async def _serve(board: LiveBoard, serving: ServeOptions, *, open_browser: bool) -> int:
    server = LiveServer(board, serving)
    came: list[int] = []

    def end(number: int) -> None:
        came.append(number)
        server.stop()

    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN:
            loop.add_signal_handler(number, end, number)
    _tell_address(server, serving)
    with _browser(server.url) if open_browser else contextlib.nullcontext():
        await server.run()
    # Ctrl-C is how it is ended.
    return 0 if came[:1] in ([], [signal.SIGINT]) else came[0]


def _tell_address(server: LiveServer, serving: ServeOptions) -> None:
    """Print where the page is; for a phone, as a QR code, too."""
    click.echo(server.url)
    sys.stdout.flush()
    if not server.phone_url:
        if not is_private(serving.host):
            warn("no address of this machine was found that a phone could reach")
        say("only this machine can open it; for a phone: --host 0.0.0.0")
        return
    encoding = (sys.stdout.encoding or "").lower()
    if sys.stdout.isatty() and encoding.startswith("utf"):
        click.echo(qr_lines(server.phone_url))
    say("whoever has this address sees the page and can mark; the connection is not encrypted")


@contextlib.contextmanager
def _browser(url: str) -> Iterator[None]:
    """Open the page in a browser, if there is one.

    The command line of a browser can be read by every user of the machine, so that it names a file
    that only this user can read, and that leads to the page.
    """
    if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY") or _is_mac()):
        yield
        return
    with tempfile.TemporaryDirectory(prefix="pytpc-live-") as folder:
        page = Path(folder) / "open.html"
        page.touch(mode=0o600)
        target = html.escape(url, quote=True)
        page.write_text(
            '<!DOCTYPE html><meta charset="utf-8">'
            f'<meta http-equiv="refresh" content="0;url={target}">'
            f'<a href="{target}">pytpc live</a>\n',
            encoding="utf-8",
        )
        with contextlib.suppress(webbrowser.Error):
            webbrowser.open(page.as_uri())
        yield


def _is_mac() -> bool:
    return sys.platform == "darwin"


def _tell_marks(file: MarksFile, target: MarksTarget, *, is_heard: bool) -> None:
    """Say where the marks are."""
    try:
        count = len(MarksFile(target.home).before)
    except TpcError:
        return
    if not count and not file.path.exists():
        click.echo("nothing was marked")
        return
    click.echo(f"{many(count, 'mark')}: {plain(str(target.shown))}")
    if count and (how := target.how_to_read(is_heard=is_heard)):
        click.echo(how)


COMMANDS: Sequence[click.Command] = [live_command]
