"""The templates of the pages."""

from __future__ import annotations

import re

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

# Control characters but for tabs and line ends, what turns the direction of text (a name could
# pass for another), and halves of characters, which no file can have.
_UNSEEN = re.compile(
    r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]"
)


def environment() -> Environment:
    """An environment in which every text is escaped and seen, and a misspelt name is an error."""
    return Environment(
        finalize=_seen,
        loader=PackageLoader("pytpc.present.page"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )


def seen(text: str) -> str:
    """``text`` with a sign for what cannot be seen."""
    return _UNSEEN.sub("\N{REPLACEMENT CHARACTER}", text)


def _seen(value: object) -> object:
    """Texts with a sign for what cannot be seen; Markup is ours and stays."""
    return seen(value) if isinstance(value, str) and not isinstance(value, Markup) else value
