"""The pages that are open: each gets boards as fast as it takes them, and its messages are done."""

from __future__ import annotations

import asyncio
import json
import math
from collections import OrderedDict
from typing import TYPE_CHECKING, Any, cast

from tornado.iostream import IOStream
from tornado.websocket import WebSocketClosedError, WebSocketHandler

from pytpc.base.errors import TpcError
from pytpc.present.live.assets import qr_svg
from pytpc.serve.access import is_same_origin
from pytpc.serve.board_changes import Board, changes, is_news
from pytpc.serve.handlers import CheckedHandler
from pytpc.serve.limits import BOARDS_ON_THE_WAY, MOST_PAGES, Rate

if TYPE_CHECKING:
    from pytpc.serve.server import LiveServer

Message = dict[str, Any]

_MOST_REFUSED = 400
_LONGEST_ID = 64
_KEPT_ANSWERS = 256
_TIME_EACH = 10
"""A page is told the time with each so-many-th board, even if nothing else is new."""
TOO_MANY, NO_TOKEN, BAD = 4008, 4003, 4002
"""Why a socket is closed: there are too many pages; it has no token; it sent what no page of ours
sends."""
NEEDS_TOKEN = "this page needs the token: open the whole address that pytpc live printed"
MARKS = frozenset({"1", "2", "3", "undo", "note", "where", "began"})
PLAYS = frozenset({"play", "pause", "seek", "step", "speed", "faster"})


class BadMessageError(ValueError):
    """A message that no page of ours sends."""


class Answers(OrderedDict[str, Message]):
    """The last answers by the ids of messages: what a page sends again is not done again."""

    def keep(self, ident: str, answer: Message) -> None:
        """Remember an answer."""
        self[ident] = answer
        while len(self) > _KEPT_ANSWERS:
            self.popitem(last=False)


class PageSocket(CheckedHandler, WebSocketHandler):
    """The socket of one page (docs/reference/formats.md#the-socket-of-the-page)."""

    def initialize(self, server: LiveServer) -> None:
        """Nothing is sent yet."""
        super().initialize(server)
        self.observer: str | None = None
        self.opened: tuple[str, str] | None = None
        self._rate = Rate()
        self._refused = 0
        self._sent: tuple[int, Board] | None = None
        self._on_the_way = 0
        self._line: Board | None = None
        self._tasks: set[asyncio.Future[None]] = set()

    def check_origin(self, origin: str) -> bool:
        """Only the page itself may open it."""
        return is_same_origin(origin, self.request.host)

    def open(self, *_: str, **__: str) -> None:
        """Count it; one too many is told so."""
        self.set_nodelay(True)
        if len(self.server.pages) >= MOST_PAGES:
            self.close(TOO_MANY, f"{MOST_PAGES} pages are open already: close one of them")
            return
        self.server.pages.add(self)

    def on_close(self) -> None:
        """It is gone."""
        self.server.pages.discard(self)

    async def send(self, message: Message) -> None:
        """Send a message, unless the page is gone; wait until it has been taken."""
        try:
            await self.write_message(json.dumps(message, allow_nan=False))
        except WebSocketClosedError:
            self.server.pages.discard(self)

    @property
    def _takes_more(self) -> bool:
        """Whether it has taken what was sent, and confirmed most of its boards.

        A page that confirms and does not read would otherwise fill the memory.
        """
        stream = getattr(self.ws_connection, "stream", None)
        is_writing = isinstance(stream, IOStream) and stream.writing()
        return not is_writing and self._on_the_way < BOARDS_ON_THE_WAY

    def offer(self, number: int, board: Board) -> None:
        """Send what is new, unless the page has not confirmed the boards before."""
        if self.observer is None or not self._takes_more:
            return
        last = self._sent[0] if self._sent is not None else 0
        found = changes(self._sent[1] if self._sent is not None else None, board)
        if not is_news(found) and number - last < _TIME_EACH:
            return
        self._sent = number, board
        self._on_the_way += 1
        self._tell({"board": number, "changes": found})

    def offer_line(self, key: str, line: Board) -> None:
        """Send the last values of the comparison that it looks at, if it takes what is sent."""
        if self._takes_more and self._line != line:
            self._line = line
            self._tell({"line": line, "key": key})

    def _tell(self, message: Message) -> None:
        """Send a message, and do not wait."""
        task = asyncio.ensure_future(self.send(message))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def on_message(self, message: str | bytes) -> None:
        """Do what the page asks; the next message waits until it is done."""
        try:
            asked = _parsed(message)
        except BadMessageError as error:
            self.close(BAD, str(error))
            return
        is_seen = asked["do"] == "seen"
        if is_seen and self._on_the_way > 0:
            self._on_the_way -= 1
            return
        ident = asked["id"]
        if not self._rate.take():
            self._refused += 1
            if self._refused > _MOST_REFUSED:
                self.close(BAD, "too many messages")
                return
            said = "refused: too many at a time; wait a moment"
            await self.send({"done": ident, "ok": False, "refused": True, "said": said})
            return
        if is_seen:
            # A board of before the last hello.
            return
        try:
            answer = await self._answer(asked)
        except BadMessageError as error:
            self.close(BAD, str(error))
            return
        # The next message is not read before the answer is taken.
        await self.send({"done": ident, **answer})

    async def _answer(self, asked: Message) -> Message:
        if asked["do"] == "hello":
            return await self._hello(asked)
        if self.observer is None:
            raise BadMessageError("the first message must be hello")
        answers = self.server.answers.setdefault(self.observer, Answers())
        known = answers.get(asked["id"])
        if known is not None:
            return known
        answer = await self._done(asked)
        answers.keep(asked["id"], answer)
        return answer

    async def _hello(self, asked: Message) -> Message:
        if self.observer is None and not self.server.access.knows(_text(asked, "token", 100)):
            self.close(NO_TOKEN, NEEDS_TOKEN)
            return {"ok": False, "said": NEEDS_TOKEN}
        wanted = _text(asked, "observer", 60) if asked.get("observer") is not None else None
        name, answer = await self.server.join(self, wanted)
        if answer.ok:
            self.observer = name
            # All of the next board, whatever was sent before.
            self._sent, self._on_the_way = None, 0
        return {"ok": answer.ok, "said": answer.said, "hello": self.server.about(name)}

    async def _done(self, asked: Message) -> Message:
        """Do anything but hello."""
        what = asked["do"]
        server = self.server
        assert self.observer is not None
        if what in MARKS:
            at_s = None if asked.get("at") is None else _number(asked, "at")
            text = _text(asked, "text", 600) if "text" in asked else ""
            return (await server.mark(self.observer, what, text, at_s))._asdict()
        if what in PLAYS:
            to = _number(asked, "to") if "to" in asked else 0.0
            return (await server.play(what, to))._asdict()
        if what in ("open", "close"):
            return await self._look(asked)
        if what == "phone":
            code = qr_svg(server.phone_url).decode() if server.phone_url else ""
            return {"ok": bool(code), "said": "", "code": code}
        if what in ("plan", "apply"):
            return await self._change(asked)
        raise BadMessageError("nothing is called that")

    async def _look(self, asked: Message) -> Message:
        """Open a comparison, or close the one that is open."""
        self.opened = None
        if asked["do"] == "close":
            return {"ok": True, "said": ""}
        key = _text(asked, "key", 100)
        node = _text(asked, "node", 300) if "node" in asked else ""
        detail = await self.server.detail(key, node)
        if detail is None:
            return {"ok": False, "said": "this comparison is not known any more"}
        self.opened = key, node
        return {"ok": True, "said": "", "detail": detail}

    async def _change(self, asked: Message) -> Message:
        """Plan or make a change of a value."""
        if not self.server.allows_apply:
            said = "values cannot be changed from this page: start pytpc live with --allow-apply"
            return {"ok": False, "said": said}
        if asked["do"] == "apply":
            return (await self.server.apply(round(_number(asked, "plan"))))._asdict()
        try:
            planned = await self.server.plan(
                _text(asked, "parameter", 300), _text(asked, "value", 300)
            )
        except TpcError as error:
            return {"ok": False, "said": str(error)}
        plan = {"number": planned.number, "title": planned.title, "lines": list(planned.lines)}
        return {"ok": True, "said": "", "plan": plan}


def _parsed(message: str | bytes) -> Message:
    """A message as an object with ``do`` and ``id``.

    Raises:
        BadMessageError: it is none.
    """
    try:
        found = json.loads(message)
    except (ValueError, RecursionError):
        raise BadMessageError("not JSON") from None
    if not isinstance(found, dict) or not isinstance(found.get("do"), str):
        raise BadMessageError("not an object that says what to do")
    ident = found.get("id", "")
    if not isinstance(ident, str) or len(ident) > _LONGEST_ID:
        raise BadMessageError("not an id")
    return cast("Message", {**found, "id": ident})


def _text(asked: Message, name: str, most: int) -> str:
    value = asked.get(name)
    if not isinstance(value, str) or len(value) > most:
        raise BadMessageError(f"{name} is no text, or too long")
    return value


def _number(asked: Message, name: str) -> float:
    value = asked.get(name)
    # Whole numbers of JSON may be longer than a float.
    if isinstance(value, bool) or not isinstance(value, int | float) or abs(value) > 1e12:
        raise BadMessageError(f"{name} is no number")
    if not math.isfinite(value):
        raise BadMessageError(f"{name} is no number")
    return float(value)
