"""How long who is on a graph of ROS 2 may take to be discovered."""

from __future__ import annotations

from dataclasses import dataclass, field

# Participants of DDS announce themselves every 3 s. On a busy machine an announcement gets lost,
# as the one that a newcomer is answered with may: two more come within this time.
_ANNOUNCED_TWICE_S = 7.0
# Where one's own start took long, so do the answers of others: this many times as long.
_LONG_STARTS = 10.0
# Somebody may come and go all the time.
_MOST = 4


@dataclass(slots=True)
class Discovery:
    """How far the discovery of a graph is; times are steady, in seconds.

    A participant is found bit by bit: first topics, then the names of its nodes. So after each
    change of the graph there is as much time as there was for the first one.

    Attributes:
        began_s: when this process joined the graph.
        took_s: how long that took, with the start of its interpreter.
        changed_s: when something was found last.
        patience_s: for how long nothing may be found before the discovery counts as complete.
    """

    began_s: float
    took_s: float
    changed_s: float = 0.0
    patience_s: float = field(init=False)

    def __post_init__(self) -> None:
        """Work out the patience."""
        self.patience_s = max(_ANNOUNCED_TWICE_S, _LONG_STARTS * self.took_s)

    @property
    def until_s(self) -> float:
        """When it counts as complete, unless something is found before."""
        last_s = max(self.began_s, self.changed_s)
        return min(last_s + self.patience_s, self.began_s + _MOST * self.patience_s)
