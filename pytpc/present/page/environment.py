"""The templates and scripts of the pages."""

from __future__ import annotations

import base64
import hashlib
import re
from importlib.resources import files

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

# Control characters except tabs and line ends, characters that turn the direction of text (a name
# could look like another), and halves of characters, which a file cannot have.
_UNSEEN = re.compile(
    r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]"
)


def environment() -> Environment:
    """An environment that escapes every text, shows what is unseen, and rejects misspelt names."""
    made = Environment(
        finalize=_seen,
        loader=PackageLoader("pytpc.present.page"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    made.filters["breakable"] = _breakable
    return made


def seen(text: str) -> str:
    """``text`` with a sign for each unseen character."""
    return _UNSEEN.sub("\N{REPLACEMENT CHARACTER}", text)


def page_script(name: str) -> str:
    """One of our scripts."""
    return files("pytpc.present.page").joinpath("templates").joinpath(name).read_text("utf-8")


def script_hash(script: str) -> str:
    """The name by which a page's content security policy allows a script."""
    return f"sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}"


def _seen(value: object) -> object:
    """Make texts visible; Markup is ours and stays."""
    return seen(value) if isinstance(value, str) and not isinstance(value, Markup) else value


def _breakable(text: str) -> Markup:
    """A text, escaped, whose paths may be broken behind each slash."""
    return Markup(str(escape(seen(text))).replace("/", "/<wbr>"))
