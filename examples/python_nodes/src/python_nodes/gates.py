"""Decisions that look at the settings."""

from . import settings


class Gate:
    """Open for what is above the limit."""

    def is_open(self, value):
        """Whether a value may pass."""
        return value > settings.LIMIT


def is_noted(value):
    """Whether a value is worth a line in the log."""
    return value > settings.NOTED
