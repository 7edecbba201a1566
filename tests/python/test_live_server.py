"""The server of `pytpc live`: who is let in, what is refused, and what each page is told."""

from __future__ import annotations

import asyncio
import contextlib
import json
import socket
import threading
from collections.abc import Awaitable, Callable, Iterator
from pathlib import Path

import pytest
from live_samples import board_of, mission
from tornado.httpclient import AsyncHTTPClient, HTTPClientError, HTTPRequest
from tornado.websocket import WebSocketClientConnection, WebSocketClosedError, websocket_connect

from patience import PATIENCE_S
from pytpc.api.live_observers import Answer
from pytpc.api.live_values import Planned
from pytpc.base.errors import InputError, RunError
from pytpc.present.live.assets import assets
from pytpc.recording.marks import read_marks
from pytpc.serve.access import host_name, is_same_origin, names_of
from pytpc.serve.limits import LONGEST_MESSAGE, MOST_PAGES, Rate
from pytpc.serve.server import LiveServer, ServeOptions

FILES = sorted(assets())


class Served:
    """A server in a thread of its own."""

    def __init__(self, folder: Path, **options) -> None:
        self.folder = folder
        self.board = board_of(folder, *mission())
        self._options = ServeOptions(**options)
        self._ready = threading.Event()
        self._sockets: list[WebSocketClientConnection] = []
        self._thread = threading.Thread(target=lambda: asyncio.run(self._run()))

    def __enter__(self) -> Served:
        self._thread.start()
        assert self._ready.wait(PATIENCE_S)
        return self

    def __exit__(self, *_: object) -> None:
        self._loop.call_soon_threadsafe(self.server.stop)
        self._thread.join(PATIENCE_S)
        assert not self._thread.is_alive()
        assert self.board.close() == ""

    async def _run(self) -> None:
        self.server = LiveServer(self.board, self._options)
        self._loop = asyncio.get_running_loop()
        self._ready.set()
        await self.server.run()

    @property
    def origin(self) -> str:
        return f"http://127.0.0.1:{self.server.port}"

    @property
    def cookie(self) -> dict[str, str]:
        return {"Cookie": f"{self.server.access.cookie}={self.server.access.cookie_value}"}

    def get(self, path: str, **headers: str):
        """The answer, whatever its status."""

        async def ask():
            request = HTTPRequest(f"{self.origin}{path}", headers=headers, follow_redirects=False)
            return await AsyncHTTPClient().fetch(request, raise_error=False)

        return asyncio.run(ask())

    async def connect(self, **headers: str) -> WebSocketClientConnection:
        sent = {**self.cookie, "Origin": self.origin, **headers}
        request = HTTPRequest(f"ws://127.0.0.1:{self.server.port}/socket", headers=sent)
        found = await websocket_connect(request)
        self._sockets.append(found)
        return found

    def run(self, steps: Callable[[], Awaitable[None]]) -> None:
        """Does the steps of a test, and closes what they have opened."""

        async def all_of_them() -> None:
            try:
                await steps()
            finally:
                for one in self._sockets:
                    one.close()
                    while one.close_code is None:
                        if await asyncio.wait_for(one.read_message(), PATIENCE_S) is None:
                            break
                self._sockets.clear()
                # The ends of the connections are noted in the next turns.
                await asyncio.sleep(0.05)

        asyncio.run(all_of_them())


class Page:
    """What a page does, without a browser."""

    def __init__(self, socket: WebSocketClientConnection) -> None:
        self.socket = socket
        self.boards: list[dict] = []

    @classmethod
    async def open(cls, served: Served, observer: str | None = None, **headers: str) -> Page:
        page = cls(await served.connect(**headers))
        token = served.server.access.token
        page.hello = await page.ask("hello", observer=observer, token=token)
        return page

    async def say(self, **message) -> None:
        await self.socket.write_message(json.dumps(message))

    async def read(self) -> dict | None:
        text = await asyncio.wait_for(self.socket.read_message(), PATIENCE_S)
        if text is None:
            return None
        message = json.loads(text)
        if "board" in message:
            self.boards.append(message)
        return message

    async def answer(self, ident: str) -> dict:
        while (message := await self.read()) is not None:
            if "board" in message:
                await self.say(do="seen")
            if message.get("done") == ident:
                return message
        raise AssertionError(f"closed: {self.socket.close_code} {self.socket.close_reason}")

    async def ask(self, what: str, ident: str = "", **more) -> dict:
        self._count = getattr(self, "_count", 0) + 1
        ident = ident or f"q{self._count}"
        await self.say(do=what, id=ident, **more)
        return await self.answer(ident)

    async def closed(self) -> tuple[int | None, str | None]:
        while await self.read() is not None:
            pass
        return self.socket.close_code, self.socket.close_reason


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    with Served(tmp_path) as running:
        yield running


def test_the_token_lets_in_and_sets_a_cookie(served: Served):
    page = served.get(f"/?token={served.server.access.token}")
    assert page.code == 200
    assert b"<title>pytpc live</title>" in page.body
    (cookie,) = page.headers.get_list("Set-Cookie")
    name, *flags = cookie.split("; ")
    # A browser sends it to every port of this host, so it must not let in by itself.
    assert served.server.access.token not in cookie
    assert {"HttpOnly", "SameSite=Strict"} <= set(flags)
    assert served.get("/", Cookie=name).code == 200


@pytest.mark.parametrize("path", ["/", "/assets/live.js", "/qr.svg", "/socket", "/nothing"])
@pytest.mark.parametrize("cookie", ["", "tpc_live=wrong", "\x01;=;;", "tpc_live_00=a; =b"])
def test_without_the_token_there_is_nothing(served: Served, path: str, cookie: str):
    headers = {"Cookie": cookie} if cookie and cookie.isprintable() else {}
    answer = served.get(path, **headers)
    assert answer.code == 403
    assert b"needs the token" in answer.body
    assert not answer.headers.get_list("Set-Cookie")


@pytest.mark.parametrize("token", ["", "x", "%00", "%ff%fe", "ä" * 10])
def test_a_wrong_token_is_refused(served: Served, token: str):
    assert served.get(f"/?token={token}").code in (400, 403)
    right = served.server.access.token
    assert served.get(f"/?token={right[:-1]}").code == 403
    assert served.get(f"/assets/live.js?token={right}").code == 403


# A name that an attacker points at 127.0.0.1 (DNS rebinding) comes with the cookie of nobody, but
# the token may have leaked: the name is refused all the same.
@pytest.mark.parametrize(
    "host", ["evil.example", "127.0.0.1.evil.example", "[::2]", "a b", "@127.0.0.1"]
)
def test_another_host_is_refused(served: Served, host: str):
    answer = served.get(f"/?token={served.server.access.token}", Host=host, **served.cookie)
    assert answer.code in (400, 421)
    assert b"<html" not in answer.body


@pytest.mark.parametrize("host", ["localhost", "127.0.0.1", "LOCALHOST:9000", "[::1]:80"])
def test_names_of_this_machine_and_tunnels_are_served(served: Served, host: str):
    assert served.get("/", Host=host, **served.cookie).code == 200


def test_headers_keep_others_out(served: Served):
    headers = served.get("/", **served.cookie).headers
    policy = headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "script-src 'self';" in policy
    assert headers["X-Frame-Options"] == "DENY"
    assert headers["Referrer-Policy"] == "no-referrer"
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert "Server" not in headers


# Nothing of a request is ever a path.
@pytest.mark.parametrize(
    "path",
    [
        "/assets/../../../../etc/passwd",
        "/assets/..%2f..%2fassets.py",
        "/assets/%2e%2e/live.html",
        "/assets/live.html",
        "/assets/assets.py",
        "/assets//etc/passwd",
        "//etc/passwd",
        "/assets/",
    ],
)
def test_no_other_file_is_served(served: Served, path: str):
    async def ask() -> bytes:
        # A client would tidy the path.
        reader, writer = await asyncio.open_connection("127.0.0.1", served.server.port)
        cookie = served.cookie["Cookie"]
        head = [f"GET {path} HTTP/1.1", "Host: localhost", f"Cookie: {cookie}", "Connection: close"]
        writer.write("\r\n".join([*head, "", ""]).encode())
        answer = await asyncio.wait_for(reader.read(), PATIENCE_S)
        writer.close()
        return answer

    answer = asyncio.run(ask())
    assert answer.startswith(b"HTTP/1.1 404 ")
    assert b"root:" not in answer


@pytest.mark.parametrize("name", FILES)
def test_the_page_has_its_files(served: Served, name: str):
    answer = served.get(f"/assets/{name}", **served.cookie)
    assert answer.code == 200
    assert answer.body == assets()[name].data


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS", "HEAD"])
def test_nothing_but_get(served: Served, method: str):
    async def ask():
        request = HTTPRequest(
            f"{served.origin}/",
            method=method,
            headers=served.cookie,
            allow_nonstandard_methods=True,
        )
        return await AsyncHTTPClient().fetch(request, raise_error=False)

    assert asyncio.run(ask()).code == 405


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "https://127.0.0.1"},
        {"Host": "evil.example", "Origin": "http://evil.example"},
        {"Cookie": "tpc_live=x"},
    ],
)
def test_a_socket_needs_the_cookie_and_the_pages_own_origin(served: Served, headers):
    with pytest.raises(HTTPClientError) as error:
        asyncio.run(served.connect(**headers))
    assert error.value.code in (403, 421)


@pytest.mark.parametrize("token", ["", "x", "{cookie}"])
def test_a_socket_tells_nothing_without_the_token(served: Served, token: str):
    async def go() -> None:
        page = Page(await served.connect())
        given = token.format(cookie=served.server.access.cookie_value)
        await page.say(do="hello", id="1", observer=None, token=given)
        code, reason = await page.closed()
        assert code == 4003
        assert "needs the token" in str(reason)
        assert page.boards == []

    served.run(go)


# A page that confirms boards without reading them: what waits for it stays small.
def test_who_confirms_and_does_not_read_gets_no_more(tmp_path: Path, monkeypatch):
    with Served(tmp_path) as served:

        async def go() -> None:
            await Page.open(served)
            quick = await Page.open(served)
            (deaf,) = [one for one in served.server.pages if one.observer == "observer"]
            monkeypatch.setattr(type(deaf.ws_connection.stream), "writing", lambda _: True)
            await quick.ask("seek", to=20.0)
            before = deaf._sent[0] if deaf._sent else 0
            for n in range(5):
                await quick.ask("seek", to=20.0 + n)
            assert (deaf._sent[0] if deaf._sent else 0) == before

        served.run(go)


# `seen` has no answer, and is bounded all the same.
def test_a_flood_of_confirmations_ends_the_connection(served: Served):
    async def go() -> None:
        page = await Page.open(served)
        for _ in range(1000):
            with contextlib.suppress(WebSocketClosedError):
                await page.say(do="seen")
        assert (await page.closed())[0] == 4002

    served.run(go)


def test_a_page_gets_a_board_and_then_what_changed(served: Served):
    async def go() -> None:
        page = await Page.open(served)
        assert page.hello["hello"]["observer"] == "observer"
        assert page.hello["hello"]["recording"] is True
        await page.ask("seek", to=36.0)
        while not any("order" in board["changes"].get("near", {}) for board in page.boards):
            await page.read()
            await page.say(do="seen")
        first = page.boards[0]["changes"]
        assert {"clock", "state", "near", "held", "turns", "marks", "suspects"} <= set(first)
        # Nothing but the time, once the suspects of the jump are worked out.
        while not set(page.boards[-1]["changes"]) <= {"clock"}:
            await page.read()
            await page.say(do="seen")

    served.run(go)


def shown_time(board: dict) -> float | None:
    return board["changes"].get("clock", {}).get("is", {}).get("now")


# A page that confirms nothing has two boards on the way, and no queue behind them. Once it
# confirms, it gets the newest.
def test_a_slow_page_gets_newer_boards_and_no_queue(served: Served):
    async def go() -> None:
        slow, quick = await Page.open(served), await Page.open(served)
        await slow.read()
        await quick.ask("seek", to=1.0)
        await slow.read()
        assert len(slow.boards) == 2
        for n in range(2, 20):
            await quick.ask("seek", to=float(n))
        await quick.ask("seek", to=31.0)
        # Boards may come after all answers.
        while not quick.boards or shown_time(quick.boards[-1]) != 31.0:
            await quick.read()
            await quick.say(do="seen")
        await slow.say(do="seen")
        message = await slow.read()
        assert len(slow.boards) == 3
        assert message["changes"]["clock"]["is"]["now"] == 31.0

    served.run(go)


def test_two_observers_mark_at_once(served: Served):
    async def go() -> None:
        one, two = await Page.open(served), await Page.open(served)
        assert [page.hello["hello"]["observer"] for page in (one, two)] == ["observer", "observer2"]
        third = await Page.open(served, "ana")
        assert third.hello["hello"]["observer"] == "ana"
        answers = await asyncio.gather(
            one.ask("1"), two.ask("2"), third.ask("3"), one.ask("note", text="a"), two.ask("undo")
        )
        assert all(answer["ok"] for answer in answers)

    served.run(go)
    found = read_marks(served.folder / "marks.csv")
    assert {(mark.observer, mark.type, mark.note) for mark in found} == {
        ("observer", "I", "a"),
        ("ana", None, ""),
    }


# After a lost connection a page cannot know whether its mark arrived: it sends it again.
def test_a_mark_that_is_sent_again_is_made_once(served: Served):
    async def go() -> None:
        page = await Page.open(served, "ana")
        first = await page.ask("1", ident="run-1")
        page.socket.close()
        again = await Page.open(served, "ana")
        assert await again.ask("1", ident="run-1") == first

    served.run(go)
    assert len(read_marks(served.folder / "marks.csv")) == 1


def test_a_late_mark_keeps_its_own_time(served: Served):
    async def go() -> None:
        page = await Page.open(served)
        await page.ask("seek", to=30.0)
        assert (await page.ask("2", at=12.5))["ok"]
        answer = await page.ask("2", at=300.0)
        assert not answer["ok"]
        assert answer["said"].startswith("not marked: its time is not in this mission")

    served.run(go)
    assert [mark.time_ns for mark in read_marks(served.folder / "marks.csv")] == [12_500_000_000]


@pytest.mark.parametrize("name", ["2nd", "a b", "a/../b", "ä", "x" * 61, "", "a\nb", "<b>"])
def test_a_name_that_is_no_namespace_is_refused(served: Served, name: str):
    async def go() -> None:
        page = Page(await served.connect())
        token = served.server.access.token
        await page.say(do="hello", id="h", observer=name, token=token)
        if len(name) > 60:
            assert (await page.closed())[0] == 4002
        elif name:
            answer = await page.answer("h")
            assert not answer["ok"]
            assert "begins with a letter" in answer["said"]
        else:
            # As with `mark`: without a namespace.
            assert (await page.answer("h"))["ok"]

    served.run(go)


@pytest.mark.parametrize(
    "message",
    [
        "",
        "[]",
        "{",
        "null",
        '{"do":1}',
        '{"id":"x"}',
        '{"do":"hello","id":5}',
        '{"do":"1","id":"x"}',
        "[" * 4000,
        '{"do":"hello","id":"' + "x" * 100 + '"}',
        '{"do":"hello","id":"h","observer":5}',
        b"\xff\xfe",
    ],
)
def test_what_no_page_sends_ends_the_connection(served: Served, message):
    async def go() -> None:
        page = Page(await served.connect())
        await page.socket.write_message(message, binary=isinstance(message, bytes))
        assert (await page.closed())[0] == 4002

    served.run(go)


@pytest.mark.parametrize(
    "message",
    [
        {"do": "1", "at": "now"},
        {"do": "1", "at": True},
        {"do": "seek", "to": 1e300},
        {"do": "seek", "to": []},
        {"do": "note", "text": 5},
        {"do": "open", "key": "x" * 200},
        {"do": "open"},
        {"do": "shutdown"},
    ],
)
def test_a_wrong_value_ends_the_connection_and_changes_nothing(served: Served, message):
    async def go() -> None:
        page = await Page.open(served)
        await page.say(id="x", **message)
        assert (await page.closed())[0] == 4002
        assert (await Page.open(served)).hello["ok"]

    served.run(go)
    assert not (served.folder / "marks.csv").exists()


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1" * 400])
def test_numbers_that_are_none(served: Served, number: str):
    async def go() -> None:
        page = await Page.open(served)
        await page.socket.write_message(f'{{"do":"seek","id":"x","to":{number}}}')
        assert (await page.closed())[0] == 4002

    served.run(go)


def test_a_message_that_is_too_long_ends_the_connection(served: Served):
    async def go() -> None:
        page = await Page.open(served)
        await page.say(do="note", id="x", text="x" * LONGEST_MESSAGE)
        assert (await page.closed())[0] == 1009

    served.run(go)


# 60 at once, then 20 a second: of 90, some are refused, and each of them is told so.
def test_too_many_messages_are_refused_and_told(served: Served):
    async def go() -> None:
        page = await Page.open(served)
        for n in range(90):
            await page.say(do="pause", id=f"p{n}")
        refused = [
            answer for n in range(90) if (answer := await page.answer(f"p{n}")).get("refused")
        ]
        assert refused
        assert all("too many" in answer["said"] for answer in refused)

    served.run(go)


def test_a_bucket_fills_with_time():
    now = [0.0]
    rate = Rate(2.0, 3.0, lambda: now[0])
    assert [rate.take() for _ in range(4)] == [True, True, True, False]
    now[0] = 0.5
    assert [rate.take() for _ in range(2)] == [True, False]
    now[0] = 100.0
    assert [rate.take() for _ in range(4)] == [True, True, True, False]


def test_one_page_too_many_is_told(served: Served):
    async def go() -> None:
        pages = [await Page.open(served, "ana") for _ in range(MOST_PAGES)]
        code, reason = await Page(await served.connect()).closed()
        assert code == 4008
        assert "close one of them" in (reason or "")
        pages[0].socket.close()
        while True:
            # Its place is free soon; nothing else is wrong with the next one.
            try:
                await Page.open(served)
                break
            except AssertionError as error:
                assert "4008" in str(error)

    served.run(go)


def test_a_comparison_and_its_line(served: Served):
    async def go() -> None:
        page = await Page.open(served)
        await page.ask("seek", to=5.0)
        found = (await page.ask("open", key="00000000-0000-5000-8000-000000000000"))["detail"]
        assert found["parameter"] == "~near"
        assert not (await page.ask("open", key="no such key"))["ok"]
        await page.ask("open", key="00000000-0000-5000-8000-000000000000")
        await page.ask("seek", to=20.0)
        while True:
            message = await page.read()
            if "board" in message:
                await page.say(do="seen")
            if message.get("line", {}).get("t", [0])[-1] > 19:
                break

    served.run(go)


class Values:
    """Plans and makes no real change."""

    def __init__(self) -> None:
        self.made: list[int] = []

    def plan(self, parameter: str, value: str) -> Planned:
        if value == "bad":
            raise InputError("no such value", "params.yaml", 3)
        return Planned(7, f"{parameter} -> {value}", ("-a: 1", f"+a: {value}"))

    def apply(self, number: int) -> Answer:
        self.made.append(number)
        return Answer(True, "written")


def test_values_are_changed_only_if_that_is_allowed(served: Served, tmp_path: Path):
    async def refused() -> None:
        page = await Page.open(served)
        assert page.hello["hello"]["apply"] is False
        for what, more in (("plan", {"parameter": "~a", "value": "1"}), ("apply", {"plan": 7})):
            answer = await page.ask(what, **more)
            assert not answer["ok"]
            assert "--allow-apply" in answer["said"]

    served.run(refused)
    values = Values()
    with Served(tmp_path, values=values) as allowing:

        async def allowed() -> None:
            page = await Page.open(allowing)
            assert page.hello["hello"]["apply"] is True
            bad = await page.ask("plan", parameter="~a", value="bad")
            assert bad["said"] == "params.yaml:3: no such value"
            planned = await page.ask("plan", parameter="~a", value="2")
            assert planned["plan"] == {"number": 7, "title": "~a -> 2", "lines": ["-a: 1", "+a: 2"]}
            assert values.made == []
            assert (await page.ask("apply", plan=7))["said"] == "written"

        allowing.run(allowed)
    assert values.made == [7]


def test_a_port_that_is_in_use(served: Served, tmp_path: Path):
    with pytest.raises(RunError, match="is in use: choose another one"):
        LiveServer(served.board, ServeOptions(port=served.server.port))
    with pytest.raises(RunError, match="does not have this address"):
        LiveServer(served.board, ServeOptions(host="192.0.2.7"))


def test_it_listens_on_loopback_alone(served: Served):
    assert served.server._socket.getsockname()[0] == "127.0.0.1"
    assert served.server.phone_url == ""

    async def go() -> None:
        assert (await (await Page.open(served)).ask("phone"))["ok"] is False

    served.run(go)


def test_for_a_phone_there_is_a_code(tmp_path: Path):
    with Served(tmp_path, host="0.0.0.0") as running:
        if not running.server.phone_url:
            pytest.skip("this machine has no address that others reach")
        assert running.server.access.token in running.server.phone_url
        # Who has the cookie alone must not get the address with the token.
        assert running.get("/qr.svg", **running.cookie).code == 404

        async def go() -> None:
            assert (await (await Page.open(running)).ask("phone"))["code"].startswith("<svg")

        running.run(go)
        name = socket.gethostname()
        assert running.get("/", Host=f"{name}:80", **running.cookie).code == 200
        assert running.get("/", Host="evil.example", **running.cookie).code == 421


@pytest.mark.skipif(not socket.has_dualstack_ipv6(), reason="this machine has no IPv6")
def test_all_addresses_are_those_of_both_families(tmp_path: Path):
    with Served(tmp_path, host="::") as running:
        assert running.get("/", **running.cookie).code == 200


# Another name than the machine's own, as ROS may have for it.
def test_the_printed_name_is_served(tmp_path: Path, monkeypatch):
    monkeypatch.setenv("ROS_HOSTNAME", "Arm.lab.example")
    with Served(tmp_path, host="0.0.0.0") as running:
        assert running.server.url.startswith("http://Arm.lab.example:")
        assert running.get("/", Host="arm.lab.example:80", **running.cookie).code == 200


def test_hosts_and_origins():
    assert host_name("127.0.0.1:80") == "127.0.0.1"
    assert host_name("[::1") == ""
    assert host_name("evil/127.0.0.1") == ""
    assert is_same_origin("HTTP://Robot:80", "robot:80")
    assert not is_same_origin("http://robot:80", "robot:81")
    assert not is_same_origin("", "")
    assert names_of("127.0.0.1") == {"localhost", "127.0.0.1", "::1"}
    assert "10.0.0.5" in names_of("10.0.0.5")
