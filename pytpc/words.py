"""Small wordings that several outputs share."""

from __future__ import annotations


def many(count: int, noun: str) -> str:
    """``1 report``, ``1,000 reports``."""
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


def plain(text: str) -> str:
    """``text`` without control characters: a log must not steer the terminal."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)
