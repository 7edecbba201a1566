"""What may go wrong with an observer's files; shown in one line."""


class ObserverError(Exception):
    """A file or message that is not as it has to be. The text names it."""
