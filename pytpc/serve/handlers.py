"""The HTTP side: the page and its files, each checked and with headers that keep others out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tornado.web import HTTPError, RequestHandler

from pytpc.present.live.assets import Asset, assets, page

if TYPE_CHECKING:
    from pytpc.serve.server import LiveServer

NO_TOKEN = "This page needs the token: open the whole address that pytpc live printed.\n"
NOT_HERE = "pytpc live does not serve this name: open the address that it printed.\n"
_MISDIRECTED, _FORBIDDEN = 421, 403


class CheckedHandler(RequestHandler):
    """Answers only who asks for this machine and has the token."""

    server: LiveServer

    def initialize(self, server: LiveServer) -> None:
        """Keep the server."""
        self.server = server

    def set_default_headers(self) -> None:
        """Nothing is loaded from elsewhere, framed, or told to other sites."""
        host = self.request.host
        # Some browsers do not count the socket as 'self'.
        socket = f" ws://{host}" if host and host.isascii() and " " not in host else ""
        policy = {
            "default-src": "'none'",
            "script-src": "'self'",
            # Bokeh makes style elements.
            "style-src": "'self' 'unsafe-inline'",
            "img-src": "'self' data:",
            "connect-src": f"'self'{socket}",
            "base-uri": "'none'",
            "form-action": "'none'",
            "frame-ancestors": "'none'",
        }
        text = "; ".join(f"{name} {value}" for name, value in policy.items())
        self.set_header("Content-Security-Policy", text.replace(";;", ";"))
        self.set_header("X-Frame-Options", "DENY")
        self.set_header("X-Content-Type-Options", "nosniff")
        self.set_header("Referrer-Policy", "no-referrer")
        self.set_header("Cross-Origin-Opener-Policy", "same-origin")
        self.set_header("Cross-Origin-Resource-Policy", "same-origin")
        self.set_header("Cache-Control", "no-store")
        self.clear_header("Server")

    def prepare(self) -> None:
        """Check the name that is asked for, and the token."""
        if not self.server.serves(self.request):
            raise HTTPError(_MISDIRECTED, reason="Misdirected Request")
        cookies = "; ".join(self.request.headers.get_list("Cookie"))
        if not self.is_let_in() and not self.server.access.has_cookie(cookies):
            raise HTTPError(_FORBIDDEN)

    def is_let_in(self) -> bool:
        """Whether it may go on without a cookie."""
        return False

    def write_error(self, status_code: int, **_: Any) -> None:  # noqa: ANN401
        """One line, without anything of the request in it."""
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        told = {_MISDIRECTED: NOT_HERE, _FORBIDDEN: NO_TOKEN}
        self.finish(told.get(status_code, f"{status_code}\n"))

    def answer(self, asset: Asset) -> None:
        """Send a file."""
        self.set_header("Content-Type", asset.type)
        self.finish(asset.data)


class PageHandler(CheckedHandler):
    """The page; with the token in its address, it sets the cookie."""

    def is_let_in(self) -> bool:
        """With the token."""
        token = self.get_query_argument("token", "")
        if not token or not self.server.access.knows(token):
            return False
        self.set_header("Set-Cookie", self.server.access.set_cookie)
        return True

    def get(self) -> None:
        """The page."""
        self.answer(page())


class AssetHandler(CheckedHandler):
    """A file of the page: by its name, which is never a path."""

    def get(self, name: str) -> None:
        """The file."""
        asset = assets().get(name)
        if asset is None:
            raise HTTPError(404)
        # The browser asks whether it has changed: the script of Bokeh is large.
        self.set_header("Cache-Control", "no-cache")
        self.answer(asset)
