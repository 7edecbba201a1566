"""A marking session in a terminal, even a simple one: keys in, a few lines out."""

from __future__ import annotations

import select
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import replace
from typing import NamedTuple, Protocol

from prompt_toolkit.input import Input, create_input
from prompt_toolkit.key_binding import KeyPress
from prompt_toolkit.keys import Keys
from rich.console import Console
from rich.live import Live
from rich.text import Text

from pytpc.base.errors import RunError
from pytpc.base.signals import signals_end
from pytpc.base.wording import plain
from pytpc.recording.graph_places import Place
from pytpc.recording.marking_session import (
    BEGAN_PROMPT,
    PLAYER_HELP,
    MarkChange,
    Player,
    Session,
    View,
    clock_text,
    press,
    screen,
    to_choose,
    with_places,
)
from pytpc.recording.marks_file import END_PATIENCE_S, KEY_PATIENCE_S, MarksFile

_TURN_S = 0.2
_ESCAPE_S = 0.05
_DUMB_WIDTH, _DUMB_HEIGHT = 200, 40
_NAMES = {
    Keys.Enter: "enter",
    Keys.ControlJ: "enter",
    Keys.Backspace: "backspace",
    Keys.Delete: "backspace",
    Keys.Escape: "escape",
    Keys.Left: "left",
    Keys.Right: "right",
    Keys.Up: "up",
    Keys.Down: "down",
    Keys.ControlC: "end",
    Keys.ControlD: "end",
}
"""What ``marking.press`` calls these keys; other keys are characters, or do nothing."""


class MarkedMission(Protocol):
    """What is marked: a graph, or a recording that a clock runs through."""

    def now_ns(self) -> int | None:
        """The time that a mark would have now."""

    def press(self, key: str) -> bool:
        """Handle a key; False if it is not for the mission."""

    def view(self) -> View:
        """What the screen shows of it."""

    def send(self, change: MarkChange) -> str:
        """Publish a change of the marks; what to tell the observer, or nothing."""

    def tick(self) -> None:
        """Called several times a second."""

    def close(self) -> None:
        """The session has ended."""

    def unheard(self) -> int:
        """How many messages about marks nobody got."""


class RecordedMission:
    """A recording that a ``Player`` runs through."""

    def __init__(
        self, title: str, start_ns: int, end_ns: int, places: tuple[Place, ...] = ()
    ) -> None:
        """The clock stands at ``start_ns``; ``places`` are those of the recorded graph."""
        self._title = title
        self._places = places
        self._player = Player.of(start_ns, end_ns)

    def now_ns(self) -> int | None:
        """Where the clock is."""
        return self._player.time_ns(time.monotonic_ns())

    def press(self, key: str) -> bool:
        """Go, stop, seek, change the speed."""
        after = self._player.press(key, time.monotonic_ns())
        if after is None:
            return False
        self._player = after
        return True

    @property
    def player(self) -> Player:
        """The clock."""
        return self._player

    def go_to(self, time_ns: int) -> None:
        """Go to a time of the recording, or to the end that is nearest to it."""
        self._player = self._player.go_to(time_ns, time.monotonic_ns())

    def view(self) -> View:
        """Where the clock is, and the length of the recording."""
        player = self._player
        at = clock_text((self.now_ns() or 0) - player.start_ns)
        whole = clock_text(player.end_ns - player.start_ns)
        state = "going" if player.playing else "stopped"
        status = f"{at} of {whole}, {state}, speed {player.speed:g}"
        now_ns = self.now_ns()
        return View(
            self._title, (status,), player.start_ns, now_ns, PLAYER_HELP, places=self._places
        )

    def send(self, change: MarkChange) -> str:
        """Nobody else needs to know."""
        return ""

    def tick(self) -> None:
        """Nothing to do: the clock runs by itself."""

    def close(self) -> None:
        """Nothing to close."""

    def unheard(self) -> int:
        """None: nobody else needs to know."""
        return 0


Paint = Callable[[Session, View, int, int, bool], Sequence[Text]]
"""Makes the lines of a screen, at most as wide and high as the two numbers; the last argument says
whether the terminal takes more than ASCII."""


def paint_marks(
    session: Session, view: View, width: int, height: int, _utf8: bool
) -> Sequence[Text]:
    """The screen of ``mark``."""
    return [Text(line) for line in screen(session, view, width, height)]


class Showing(NamedTuple):
    """How a session is shown, and what ends it besides the observer.

    ``paint`` makes the screen; ``full``: use the whole screen, and restore it afterwards.
    ``is_over`` says whether the mission has ended, which ends the session, but not while typing;
    with it, signals are the caller's. ``must_end`` says whether to end at once, as after a signal.
    """

    paint: Paint = paint_marks
    full: bool = False
    is_over: Callable[[], bool] | None = None
    must_end: Callable[[], bool] = lambda: False


MARKS_SHOWN = Showing()
"""The screen of ``mark``."""


def run_marking(
    session: Session, mission: MarkedMission, file: MarksFile, how: Showing = MARKS_SHOWN
) -> Session:
    """Mark until the observer or a signal ends the session; then the marks are in the file.

    A note that a signal or the end of the terminal interrupts is kept as far as it was typed.

    Args:
        session: with earlier marks.
        mission: what is marked.
        file: where the marks go.
        how: how it is shown.

    Raises:
        RunError: standard input is no terminal.
        SystemExit: SIGTERM or SIGHUP.
    """
    if not sys.stdin.isatty():
        raise RunError("standard input is not a terminal, so no keys can be read")
    console = Console()
    try:
        signals = signals_end() if how.is_over is None else nullcontext()
        with signals, _keys() as read, _shown(console, how.paint, full=how.full) as show:
            while not (session.ended or how.must_end()):
                if how.is_over is not None and not session.is_typing and how.is_over():
                    break
                view = mission.view()
                session = with_places(session, view.places)
                show(session, view)
                for key in read():
                    if not session.is_typing and mission.press(key):
                        continue
                    session, change = press(session, key, mission.now_ns(), view.places)
                    if change is not None:
                        file.take(change)
                        told = mission.send(change)
                        if told:
                            session = replace(session, said=f"{session.said}: {told}")
                        session = _saved(session, file)
                mission.tick()
                session = _saved(session, file)
    finally:
        if session.is_typing:
            session, noted = press(session, "closed", None)
            if noted is not None:
                file.take(noted)
                mission.send(noted)
        # Nobody tries again after this.
        wrong = file.flush(END_PATIENCE_S)
        mission.close()
        if wrong:
            raise RunError(wrong)
    return session


def _saved(session: Session, file: MarksFile) -> Session:
    """The session with a word on whether all marks are in the file."""
    wrong = file.flush(KEY_PATIENCE_S)
    if wrong:
        return replace(session, said=wrong)
    return replace(session, said="saved now") if session.said == file.fault else session


@contextmanager
def _keys() -> Iterator[Callable[[], list[str]]]:
    """A function that waits a little for keys."""
    source: Input = create_input()
    with source.raw_mode():

        def read() -> list[str]:
            if not _is_ready(source, _TURN_S):
                return []
            pressed = source.read_keys()
            # A lone Escape may begin an arrow key. A closed terminal is always ready to be read,
            # until the signal comes.
            if not pressed:
                time.sleep(_ESCAPE_S)
                pressed = source.read_keys() if _is_ready(source) else source.flush_keys()
            found = [key for one in pressed for key in _named(one)]
            return [*found, "closed"] if source.closed else found

        yield read
    source.close()


def _is_ready(source: Input, patience_s: float = 0.0) -> bool:
    return bool(select.select([source.fileno()], [], [], patience_s)[0])


def _named(pressed: KeyPress) -> list[str]:
    if pressed.key == Keys.BracketedPaste:
        return list(pressed.data)
    if not isinstance(pressed.key, Keys):
        return [pressed.key]
    return [_NAMES[pressed.key]] if pressed.key in _NAMES else []


@contextmanager
def _shown(
    console: Console, paint: Paint, *, full: bool
) -> Iterator[Callable[[Session, View], None]]:
    """A function that shows the session in place, or on simple terminals line by line."""
    if console.is_terminal and not console.is_dumb_terminal:
        utf8 = console.encoding.startswith("utf")
        with Live(console=console, auto_refresh=False, transient=not full, screen=full) as live:

            def draw(session: Session, view: View) -> None:
                lines = paint(session, view, console.width, console.height, utf8)
                text = Text("\n", no_wrap=True, overflow="crop").join(lines)
                live.update(text, refresh=True)

            yield draw
        return
    told: tuple[int, str] | None = None

    def tell(session: Session, view: View) -> None:
        nonlocal told
        said = session.said if session.typing is None else "note (Enter ends it):"
        if session.naming is not None and not said:
            said = "where (number, name or part; Enter ends it):"
        if session.dating is not None and not said:
            said = BEGAN_PROMPT
        if told is None:
            lines = paint(session, view, _DUMB_WIDTH, _DUMB_HEIGHT, False)
            print("\n".join(line.plain for line in lines if line.plain), flush=True)
        elif said and told != (len(session.marks), said):
            choices = to_choose(session, _DUMB_WIDTH, _DUMB_HEIGHT) if not session.said else []
            print("\n".join([*choices, plain(said)]), flush=True)
        told = len(session.marks), said

    yield tell
