"""The value to try: it should prevent the error for good, not only its last occurrence.

The smallest change is often not enough: a counter reaches the next number, too, and noise the next
bit. This looks at all marks of a mission at once. The evidence, the strongest first:

1. the value of a good run, in whichever direction: it worked, while the direction in the log
   depends on the types of error that people named;
2. the direction in the log (`pytpc.diagnosis.suggestion.lasting`);
3. the default in the source, or a declared one, if it would last; if the log cannot say how far is
   enough (values that grow until the program acts), any default beyond the smallest change;
4. the nearest value that would last;
5. the smallest change, if nothing else is known (flags, equality).

Values that were tried and did not help bound the next one: it is beyond them, but not beyond a
value from which the log pointed back.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pytpc.base.columns import Floats
from pytpc.base.errors import InputError
from pytpc.base.wording import Number, exact, many, show
from pytpc.diagnosis.question import PLAIN, Question, Source
from pytpc.diagnosis.results.advice import Basis, Direction, KnownValue, Remedy, Suggestion
from pytpc.diagnosis.suggestion.choice import choose
from pytpc.diagnosis.suggestion.lasting import Lasting, lasting
from pytpc.diagnosis.suggestion.smallest_change import At, smallest_change_for_most
from pytpc.diagnosis.suggestion.suggestion_case import (
    NoneBecauseError,
    SuggestionCase,
    SuggestionEvidence,
    case_of,
    refuse,
    shown_current,
    values_for,
)
from pytpc.diagnosis.thresholds.intervals import Interval, Intervals, holds, intersection, words
from pytpc.diagnosis.thresholds.replay import Track, tracks_of
from pytpc.diagnosis.thresholds.threshold_sets import thresholds_for
from pytpc.diagnosis.thresholds.units import NoUnitError
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import MARK_TYPES, Mark, MarkType
from pytpc.recording.mission import Recording
from pytpc.static.link_unit import Default
from pytpc.static.static_info import StaticInfo

NAMES: dict[Source, str] = {
    "reference": "the value of the good run",
    "default": "the default in the source",
    "declared": "the declared default",
}
"""What each kind of evidence is called, the strongest first."""


@dataclass(frozen=True, slots=True)
class _Wanted:
    """A comparison, the values of the parameter that would last, and those that do the least."""

    track: Track
    case: SuggestionCase
    found: Lasting
    lasting: Intervals
    least: Intervals

    @property
    def rises(self) -> bool:
        """Whether the nearest value that would do is above the present one."""
        ends = [
            part.first() if part.first() > self.case.present else part.last() for part in self.least
        ]
        return min(ends, key=lambda end: abs(end - self.case.present)) > self.case.present


def remedy(
    recording: Recording,
    static_info: StaticInfo,
    parameter: str,
    marks: Sequence[Mark],
    question: Question = PLAIN,
) -> Remedy:
    """The value of one parameter to try, from all marks of a mission.

    Args:
        recording: the mission.
        static_info: what the analysis found.
        parameter: its name in the source, or what `same_parameter` takes for it.
        marks: at least one, of any type or none.
        question: its ``sources``, ``window_s`` and ``reference``, whose value goes before the log;
            ``flown`` is without this mission's value, and ``declared`` has at most the one of this
            parameter.

    Raises:
        InputError: there is no such parameter, or several.
    """
    reference = question.reference
    right = None if reference is None else value_in(reference, static_info, parameter)
    found = _by_log(recording, static_info, parameter, marks, question)
    if right is None or right in question.flown or "reference" not in question.sources:
        return found
    if found.current is None:
        found = replace(found, current=value_in(recording, static_info, parameter))
    return restored(found, float(right), "reference", NAMES["reference"])


def _by_log(
    recording: Recording,
    static_info: StaticInfo,
    parameter: str,
    marks: Sequence[Mark],
    question: Question,
) -> Remedy:
    """The remedy in the direction that the log shows; the arguments are those of ``remedy``."""
    flown, declared = question.flown, question.declaration
    name, tracks, without = tracks_of(recording.events, recording.summaries, static_info, parameter)
    reason = "; ".join(without) or "none of its comparisons was evaluated"
    for kind, times_ns in _kinds(marks, tracks, question.window_s):
        smallest = smallest_change_for_most(
            recording,
            static_info,
            [track.comparison for track in tracks],
            [At(time_ns, kind) for time_ns in times_ns],
            question,
        )
        wanted = []
        for track in tracks:
            found = lasting(track, kind, times_ns, question.window_s, len(flown))
            if found is None:
                continue
            try:
                wanted.append(_wanted(track, found, static_info, declared, max(times_ns)))
            except (NoneBecauseError, NoUnitError) as why:
                reason = str(why)
        if wanted:
            wanted.sort(key=lambda one: (one.found.near, one.track.comparison.key))
            known = known_values(wanted[0].case, static_info, name, question.reference)
            allowed = [
                one for one in known if one.source in question.sources and one.value not in flown
            ]
            chosen = _chosen(name, wanted, allowed, flown)
            if chosen is not None:
                return replace(chosen, smallest=smallest[0], known=tuple(known))
        # If nothing that lasts is between the values that were tried, this is not either.
        if smallest[0].value is not None and not (wanted and flown):
            return _as_smallest(name, kind, *smallest)
        reason = smallest[0].reason or reason
    return Remedy(name, None, None, None, None, reason, reason, None, None, None)


def restored(found: Remedy, value: float, basis: Basis, words: str) -> Remedy:
    """The remedy with a value that the parameter had when the robot worked.

    It does not change if the present value is unknown, or is that value. ``words`` say when the
    parameter had it. The text says if the log points the other way: the log's direction depends on
    the types of error that people named, and they confuse these.
    """
    current = found.current
    if current is None or not math.isfinite(value) or value == current:
        return found
    number: Number = value
    if isinstance(current, bool):
        number = bool(value)
    elif isinstance(current, int) and value.is_integer():
        number = int(value)
    direction: Direction = "raise" if number > current else "lower"
    if isinstance(current, bool) or found.direction == "switch":
        direction = "switch"
    elif found.basis != "reference" and found.direction not in {None, direction}:
        words += "; the log alone points the other way"
    text = f"{direction} {found.parameter} from {show(current)} to {exact(number)} ({words})"
    return replace(found, direction=direction, value=number, basis=basis, text=text, reason=None)


def _kinds(
    marks: Sequence[Mark], tracks: Sequence[Track], window_s: float
) -> list[tuple[MarkType, list[int]]]:
    """The types of error with their times, beginning with the type of the first marks.

    The first error causes the later ones. Marks without a type have one type together: I if a
    result of the parameter changed in the windows before most of them, else II.
    """
    if not tracks or not marks:
        return []
    window = round(window_s * 1e9)
    untyped = np.array([mark.time_ns for mark in marks if mark.type is None], dtype=np.int64)
    flops = np.sort(np.concatenate([track.flop_ns for track in tracks]))
    begin, end = np.searchsorted(flops, untyped - window), np.searchsorted(flops, untyped, "right")
    meant: MarkType = "I" if 2 * np.count_nonzero(begin < end) > untyped.size else "II"
    times: dict[MarkType, list[int]] = {kind: [] for kind in MARK_TYPES}
    for mark in sorted(marks, key=Mark.order):
        times[mark.type or meant].append(mark.time_ns)
    soon = min(mark.time_ns for mark in marks) + window
    early = {kind: sum(one <= soon for one in found) for kind, found in times.items()}
    order = sorted(
        (kind for kind in MARK_TYPES if times[kind]),
        key=lambda kind: (-early[kind], times[kind][0]),
    )
    return [(kind, times[kind]) for kind in order]


def _wanted(
    track: Track,
    found: Lasting,
    static_info: StaticInfo,
    declared: Declared | None,
    end_ns: int,
) -> _Wanted:
    comparison = track.comparison
    refuse(comparison, static_info.unit_of(comparison.key))
    case = _case(track, _thresholds(track, end_ns), static_info, declared)
    edges = [
        values_for(case, thresholds_for(comparison.relation, edge, found.outcome))
        for edge in (found.edge, found.least)
    ]
    return _Wanted(track, case, found, edges[0], edges[1])


def _case(
    track: Track, seen: Floats, static_info: StaticInfo, declared: Declared | None
) -> SuggestionCase:
    """The case of a comparison whose thresholds were ``seen``; see `case_of`."""
    nothing = np.zeros(0)
    evidence = SuggestionEvidence(nothing, nothing, float(seen[-1]), seen, bool(len(track.kept)))
    unit = static_info.unit_of(track.comparison.key)
    return case_of(track.comparison, unit, evidence, declared)


def _thresholds(track: Track, end_ns: int) -> Floats:
    """float64[n]: the thresholds up to a time, in order; there is at least one."""
    time_ns = np.concatenate([track.time_ns, track.kept.end_ns])
    thresh = np.concatenate([track.thresh, track.kept.thresh])
    order = np.argsort(time_ns, kind="stable")
    return thresh[order[time_ns[order] <= end_ns]]


def _chosen(
    name: str, wanted: Sequence[_Wanted], known: Sequence[KnownValue], flown: Sequence[float]
) -> Remedy | None:
    """The remedy by the nearest comparison, and by others that want the same direction."""
    first = wanted[0]
    case, rises = first.case, first.rises
    lasts, against = first.lasting, False
    for other in wanted[1:]:
        if other.rises != rises:
            against = True
            continue
        both = intersection(lasts, other.lasting)
        lasts = both or lasts
    side = [Interval.above(case.present) if rises else Interval.below(case.present)]
    least = intersection(first.least, side) or first.least
    lasts = intersection(lasts, side) or lasts
    within = _bounds(case.present, rises, flown)
    value, basis = _value(replace(first, lasting=lasts, least=least), known, within)
    if value is None:
        return None
    direction: Direction = "raise" if value > case.present else "lower"
    number = case.number(value)
    why = _why(first.found, basis, lasts, least, len(flown))
    if against:
        why += "; another comparison of it would want the other direction"
    text = f"{direction} {name} from {show(shown_current(case))} to {exact(number)} ({why})"
    return Remedy(
        name, shown_current(case), direction, number, basis, text, None, first.found.kind,
        first.track.comparison.key, None,
    )  # fmt: skip


def _bounds(present: float, rises: bool, flown: Sequence[float]) -> Interval:
    """Between the present value and the nearest one beyond it that was tried and was too much."""
    beyond = [value for value in flown if (value > present) == rises and value != present]
    if rises:
        return Interval(present, min(beyond, default=math.inf))
    return Interval(max(beyond, default=-math.inf), present)


def _value(
    wanted: _Wanted, known: Sequence[KnownValue], within: Interval
) -> tuple[float | None, Basis]:
    """The value inside ``within`` with the best evidence, if there is one, and which evidence."""
    case, found, lasts, least = wanted.case, wanted.found, wanted.lasting, wanted.least
    possible = case.possible
    for one in known:
        anywhere = found.ground == "growth"
        if within.holds(one.value) and holds(least if anywhere else lasts, one.value):
            return one.value, one.source
    chosen = choose(lasts, case.present, possible, up_first=found.up)
    if isinstance(chosen, str):
        # Nothing that lasts is in the parameter's range: take the end of the range, if that helps.
        ends = (possible.interval.high, possible.interval.low)
        beyond = [end for end in ends if math.isfinite(end) and holds(least, end)]
        if not beyond:
            return None, "lasting"
        value = min(beyond, key=lambda end: abs(end - case.present))
    else:
        value = chosen.value
    if not within.holds(value):
        between = _between(within)
        value = float(round(between)) if possible.whole else between
        return (value, "between") if within.holds(value) else (None, "between")
    return value, "growth" if found.ground == "growth" else "lasting"


def _between(within: Interval) -> float:
    """The geometric mean of two values of one sign, else the arithmetic one; three digits."""
    low, high = within.low, within.high
    mean = (low + high) / 2
    if low * high > 0:
        mean = math.copysign(math.sqrt(low * high), low)
    short = float(f"{mean:.3g}")
    return short if within.holds(short) else mean


def _why(found: Lasting, basis: Basis, lasts: Intervals, least: Intervals, tries: int) -> str:
    """The evidence in words."""
    if basis in NAMES:
        return f"{NAMES[basis]}; {words(least)} would do at least once"
    if basis == "between":
        return "between values that were flown"
    if found.ground == "steady":
        said = f"nearly all of {many(found.count, 'evaluation')} before the marks go the other way"
    elif found.ground == "ramps":
        said = f"{many(found.count, 'ramp')} before the marks get there"
    elif found.ground == "peaks":
        said = f"beyond {many(found.count, 'peak')} before the marks"
    else:
        said = f"the value grew until the program acted: {_ordinal(tries)} step beyond it"
    return f"{words(lasts)}: {said}"


def _ordinal(tries: int) -> str:
    return ["a first", "a second", "a third"][tries] if tries <= 2 else "one more"


def _as_smallest(name: str, kind: MarkType, found: Suggestion, key: str | None) -> Remedy:
    return Remedy(
        name, found.current, found.direction, found.value, "smallest", found.text, None, kind, key,
        found,
    )  # fmt: skip


def known_values(
    case: SuggestionCase, static_info: StaticInfo, parameter: str, reference: Recording | None
) -> list[KnownValue]:
    """The known good values, the strongest evidence first.

    The value of a good run has worked; a default is the author's choice; a declared default may be
    meant for other robots.

    Args:
        case: the parameter at one of its comparisons.
        static_info: what the analysis found; it holds for the good run, too.
        parameter: its name in the source.
        reference: a good run.
    """
    found: list[KnownValue] = []
    flown = None if reference is None else value_in(reference, static_info, parameter)
    if flown is not None:
        found.append(KnownValue("reference", float(flown)))
    declared = case.possible.declared
    defaults: list[tuple[Source, Default]] = [
        ("default", case.comparison.default),
        ("declared", None if declared is None else declared.default),
    ]
    for source, value in defaults:
        if value is not None and not isinstance(value, str):
            found.append(KnownValue(source, float(value)))
    return found


def value_in(recording: Recording, static_info: StaticInfo, parameter: str) -> Number | None:
    """The last value of a parameter in a mission; None if the log does not say."""
    try:
        _, tracks, _ = tracks_of(recording.events, recording.summaries, static_info, parameter)
    except InputError:
        return None
    for track in tracks:
        seen = np.concatenate([track.kept.thresh, track.thresh])
        seen = seen[np.isfinite(seen)]
        if not seen.size:
            continue
        try:
            return shown_current(_case(track, seen, static_info, None))
        except (NoneBecauseError, NoUnitError):
            continue
    return None
