"""The files of the page, by the names under which they are served; no other file is."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from io import BytesIO, StringIO
from typing import NamedTuple

import segno
from bokeh.resources import Resources

_TYPES = {
    "html": "text/html; charset=utf-8",
    "css": "text/css; charset=utf-8",
    "js": "text/javascript; charset=utf-8",
}
_OWN = ("live.css", "live.js", "link.js", "view.js", "dialogs.js", "chart.js")


class Asset(NamedTuple):
    """The bytes of a file, and its media type."""

    data: bytes
    type: str


@cache
def assets() -> dict[str, Asset]:
    """All files but the page itself."""
    # The third script of Bokeh only sets the level of the console's log.
    bokeh, bokeh_api = Resources(mode="inline", components=["bokeh", "bokeh-api"]).js_raw[:2]
    found = {name: _own(name) for name in _OWN}
    found["bokeh.js"] = Asset(bokeh.encode(), _TYPES["js"])
    found["bokeh-api.js"] = Asset(bokeh_api.encode(), _TYPES["js"])
    return found


def page() -> Asset:
    """The page; what it shows comes over its socket."""
    return _own("live.html")


def qr_svg(address: str) -> bytes:
    """An address as a QR code, black on white: readers need the contrast in the dark, too."""
    written = BytesIO()
    segno.make(address, micro=False).save(
        written, kind="svg", scale=6, border=4, light="white", xmldecl=False, nl=False
    )
    return written.getvalue()


def qr_lines(address: str) -> str:
    """The same for a terminal that shows UTF-8."""
    written = StringIO()
    segno.make(address, micro=False).terminal(written, border=2, compact=True)
    return written.getvalue()


def _own(name: str) -> Asset:
    data = files("pytpc.present.live").joinpath("web").joinpath(name).read_bytes()
    return Asset(data, _TYPES[name.rpartition(".")[2]])
