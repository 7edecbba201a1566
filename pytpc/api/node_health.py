"""How well the nodes of a running robot report: what `pytpc stream --diagnostics` says of each."""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from pytpc.base.wording import listed, many, percent
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.diagnosis.results.suspects import MarkRanking
from pytpc.ros.diagnostic_messages import DiagnosticStatus, Level
from pytpc.ros.node_status import NodeStatus

PREFIX = "tpc: "
"""How the names of all states begin, so that an aggregator can group them."""

_RATE_S = 5.0
_STALE_S = 10.0
_FRESH_DROP_S = 30.0
_MOST_NODES = 200
_SUSPECTS = 5


@dataclass(slots=True)
class _Node:
    """What is known of a node; times are of a steady clock, in seconds."""

    first_s: float
    last_s: float
    rates: deque[tuple[float, int, int]] = field(default_factory=deque)
    said: int | None = None
    heard: int = 0
    dropped_s: float | None = None

    @property
    def dropped(self) -> int:
        """As its process has said, since its start; or more, as its reports said meanwhile."""
        return max(self.said or 0, self.heard)


class NodeHealth:
    """Counts the reports of each node; of more than 200 nodes, the first ones.

    Every time is one of a steady clock, in seconds.
    """

    def __init__(self) -> None:
        """No node has reported."""
        self._nodes: dict[str, _Node] = {}
        self._settings: Mapping[str, NodeStatus] = {}
        self._whys: dict[str, dict[str, int]] = defaultdict(dict)
        self.left_out = 0

    def see(self, node: str, evaluations: int, now_s: float) -> None:
        """A report or a summary of so many evaluations has come."""
        known = self._nodes.get(node)
        if known is None:
            if len(self._nodes) >= _MOST_NODES:
                self.left_out += 1
                return
            known = self._nodes[node] = _Node(now_s, now_s)
        known.last_s = now_s
        if known.rates and now_s - known.rates[-1][0] < _RATE_S / 50:
            at_s, reports, before = known.rates[-1]
            known.rates[-1] = at_s, reports + 1, before + evaluations
        else:
            known.rates.append((now_s, 1, evaluations))

    def tell_settings(self, found: Mapping[str, NodeStatus], now_s: float) -> None:
        """What the nodes say of their settings."""
        self._settings = found
        for node, status in found.items():
            known, text = self._nodes.get(node), status.values.get("dropped")
            if known is None or text is None:
                continue
            count = _whole(text)
            # What was dropped before we asked for the first time was not dropped just now.
            if known.said is not None and count > known.said:
                known.dropped_s = now_s
            known.said = count

    def tell_dropped(self, dropped: Mapping[tuple[str, str], int], now_s: float) -> None:
        """How many reports each node has dropped since we listen, by node and reason."""
        for (node, why), count in dropped.items():
            self._whys[node][why] = count
        for node, whys in self._whys.items():
            known, count = self._nodes.get(node), sum(whys.values())
            if known is not None and count > known.heard:
                known.heard, known.dropped_s = count, now_s

    def statuses(self, now_s: float) -> list[DiagnosticStatus]:
        """The state of each node, by name."""
        return [self._status(node, now_s) for node in sorted(self._nodes)]

    def _status(self, node: str, now_s: float) -> DiagnosticStatus:
        known = self._nodes[node]
        while known.rates and known.rates[0][0] < now_s - _RATE_S:
            known.rates.popleft()
        seconds = min(_RATE_S, max(1.0, now_s - known.first_s))
        rate = sum(reports for _, reports, _ in known.rates) / seconds
        evaluated = sum(count for _, _, count in known.rates) / seconds
        settings = self._settings.get(node)
        said = {} if settings is None else settings.values
        cap = _whole(said.get("process_cap"))
        level, message = self._judged(known, settings, rate, now_s)
        whys = [f"{why}: {count}" for why, count in sorted(self._whys[node].items())]
        values = [
            ("reports per second", f"{rate:.1f}"),
            ("evaluations per second", f"{evaluated:.1f}"),
            ("seconds since the last report", f"{now_s - known.last_s:.1f}"),
            ("reports dropped", str(known.dropped)),
            ("dropped since we listen, by reason", ", ".join(whys) or "none"),
            ("cap of reports per second", str(cap) if cap else "none" if said else "not known"),
            ("budget used", percent(min(1.0, rate / cap)) if cap else "no cap"),
        ]
        values += [(name, said[name]) for name in ("sink", "policy", "sites") if name in said]
        return DiagnosticStatus(level, PREFIX + node.lstrip("/"), message, "tpc", tuple(values))

    @staticmethod
    def _judged(
        known: _Node, settings: NodeStatus | None, rate: float, now_s: float
    ) -> tuple[Level, str]:
        silent_s = now_s - known.last_s
        if silent_s >= _STALE_S:
            return Level.STALE, f"no report for {silent_s:.0f} s"
        if known.dropped_s is not None and now_s - known.dropped_s < _FRESH_DROP_S:
            return Level.WARN, f"{many(known.dropped, 'report')} dropped"
        if settings is not None and not settings.success:
            return Level.WARN, f"its settings are not known: {settings.message}"
        if settings is not None and settings.values.get("state") == "stopped":
            return Level.WARN, "its file is full, so it writes no reports any more"
        return Level.OK, f"{rate:.1f} reports per second"


def suspects_status(
    diagnosis: Diagnosis | None, ranking: MarkRanking | None, marks: int, fault: str
) -> DiagnosticStatus:
    """The state ``tpc: suspects``: OK without a mark, else a warning that names the first one.

    Args:
        diagnosis: by all marks; None before it is worked out.
        ranking: of now, as `watch` shows it for marks without a type; None without reports.
        marks: how many there are.
        fault: what is wrong with the connection, or empty.
    """
    values = [("marks", str(marks))]
    if fault:
        values.append(("fault", fault))
    level, message = Level.OK, "no mark yet"
    if diagnosis is not None and marks:
        level, message = Level.WARN, diagnosis.headline
        values += _suspected(diagnosis)
    elif marks:
        level, message = Level.WARN, f"{many(marks, 'mark')}, not judged yet"
    if fault:
        level = Level.WARN
    if ranking is not None and ranking.suspects:
        first = [f"{one.parameter} {one.rank:.2f}" for one in ranking.suspects[:_SUSPECTS]]
        values.append(("highest ranks now", listed(first, _SUSPECTS)))
    return DiagnosticStatus(level, f"{PREFIX}suspects", message, "tpc", tuple(values))


def _suspected(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    """The first suspects, and what to try."""
    suspects: Sequence[tuple[str, float]] = [
        (one.parameter, one.probability) for one in diagnosis.blame.suspects[:_SUSPECTS]
    ]
    values = []
    if suspects:
        values = [("first suspect", suspects[0][0]), ("probability", percent(suspects[0][1]))]
    first = diagnosis.to_try
    if first is not None and first.remedy.value is not None:
        values.append(("value to try", str(first.remedy.value)))
    if diagnosis.action:
        values.append(("to try", diagnosis.action))
    others = [f"{name} {percent(probability)}" for name, probability in suspects[1:]]
    if others:
        values.append(("next suspects", ", ".join(others)))
    values.append(("none of the parameters", percent(diagnosis.blame.none)))
    return values


def _whole(text: str | None) -> int:
    """A count that a node has said; 0 if it said none."""
    return int(text) if text is not None and text.isdecimal() and len(text) < 19 else 0
