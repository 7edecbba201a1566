"""Warnings of the hook: one line on standard error each, as from the C++ runtime."""

from __future__ import annotations

import os


def warn(text: str) -> None:
    """Write one line. It is one write, so that lines of several processes do not mix."""
    try:
        os.write(2, ("tpc: " + " ".join(text.split()) + "\n").encode("utf-8", "replace"))
    except OSError:
        # A program without standard error.
        return


def many(count: int, noun: str) -> str:
    """``1 comparison``, ``2 comparisons``."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
