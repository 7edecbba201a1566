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
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from pytpc.base.columns import Floats
from pytpc.base.wording import Number, exact, many, show, tidy
from pytpc.diagnosis.question import PLAIN, Question, Source
from pytpc.diagnosis.results.advice import Basis, Direction, KnownValue, Remedy, Suggestion
from pytpc.diagnosis.suggestion.known_values import (
    case_of_track,
    kind_of,
    known_values,
    value_in,
)
from pytpc.diagnosis.suggestion.lasting import Lasting, lasting
from pytpc.diagnosis.suggestion.plausible import (
    NOBODY,
    ParameterKind,
)
from pytpc.diagnosis.suggestion.smallest_change import At, smallest_change_for_most
from pytpc.diagnosis.suggestion.suggestion_case import (
    NoneBecauseError,
    SuggestionCase,
    refuse,
    shown_current,
    values_for,
)
from pytpc.diagnosis.suggestion.wanted_value import Wanted, value_to_try
from pytpc.diagnosis.suggestion.what_if import spans_before, stops_all
from pytpc.diagnosis.thresholds.intervals import Interval, Intervals, holds, intersection, words
from pytpc.diagnosis.thresholds.replay import Track, tracks_of
from pytpc.diagnosis.thresholds.threshold_sets import thresholds_for
from pytpc.diagnosis.thresholds.units import NoUnitError
from pytpc.recording.marks import MARK_TYPES, Mark, MarkType
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo

NAMES: dict[Source, str] = {
    "reference": "the value of the good run",
    "default": "the default in the source",
    "declared": "the declared default",
}
"""What each kind of evidence is called, the strongest first."""

_MOST_REASONS = 2  # of a parameter whose comparisons all have one


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
    flown = question.flown
    name, tracks, without = tracks_of(recording.events, recording.summaries, static_info, parameter)
    reason = _in_short(without) or "none of its comparisons was evaluated"
    for kind, times_ns in _kinds(marks, tracks, question.window_s):
        smallest = smallest_change_for_most(
            recording,
            static_info,
            [track.comparison for track in tracks],
            [At(time_ns, kind) for time_ns in times_ns],
            question,
        )
        wanted, refused = [], None
        for track in tracks:
            found = lasting(track, kind, times_ns, question.window_s, len(flown))
            if found is None:
                continue
            try:
                case = _case(track, static_info, question, max(times_ns))
                usual = kind_of(case, recording, static_info, question)
                wanted.append(_wanted(track, found, case, usual))
            except (NoneBecauseError, NoUnitError) as why:
                reason = str(why)
        if wanted:
            wanted.sort(key=lambda one: (one.found.near, one.track.comparison.key))
            known = known_values(wanted[0].case, static_info, name, question.reference)
            allowed = [
                one for one in known if one.source in question.sources and one.value not in flown
            ]
            stops = _stops(tracks, kind, times_ns, question.window_s)
            try:
                chosen = _chosen(name, wanted, allowed, flown, stops)
            except NoneBecauseError as why:
                chosen, refused = None, str(why)
            off = chosen is not None and chosen.value == 0 and _switches_off(wanted[0], chosen)
            if chosen is not None and not (off and smallest[0].value):
                return replace(chosen, smallest=smallest[0], known=tuple(known))
        # If nothing that lasts is between the values that were tried, this is not either.
        if smallest[0].value is not None and not (wanted and flown):
            return _as_smallest(name, kind, *smallest)
        reason = refused or smallest[0].reason or reason
    current = value_in(recording, static_info, name)
    return Remedy(name, current, None, None, None, reason, reason, None, None, None)


def _in_short(reasons: Sequence[str]) -> str:
    """The first ones; a parameter of a large program may have hundreds of comparisons."""
    text = "; ".join(reasons[:_MOST_REASONS])
    more = len(reasons) - _MOST_REASONS
    return f"{text}; and {more} more" if more > 0 else text


def restored(found: Remedy, value: float, basis: Basis, words: str) -> Remedy:
    """The remedy with a value that the parameter had when the robot worked.

    It does not change if the present value is unknown, or is that value. ``words`` say when the
    parameter had it. The text says if the log points the other way: the log's direction depends on
    the types of error that people named, and they confuse these.
    """
    current = found.current
    if current is None or not math.isfinite(value) or value == current:
        return found
    value = float(tidy(value))
    if value == current:
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
    return replace(
        found, direction=direction, value=number, basis=basis, text=text, reason=None, doubt=""
    )


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


def _case(track: Track, static_info: StaticInfo, question: Question, end_ns: int) -> SuggestionCase:
    refuse(track.comparison, static_info.unit_of(track.comparison.key))
    return case_of_track(track, _thresholds(track, end_ns), static_info, question.declaration)


def _wanted(track: Track, found: Lasting, case: SuggestionCase, kind: ParameterKind) -> Wanted:
    edges = [
        values_for(case, thresholds_for(case.relation, edge, found.outcome))
        for edge in (found.edge, found.least)
    ]
    return Wanted(track, case, found, edges[0], edges[1], kind)


def _thresholds(track: Track, end_ns: int) -> Floats:
    """float64[n]: the thresholds up to a time, in order; there is at least one."""
    time_ns = np.concatenate([track.time_ns, track.kept.end_ns])
    thresh = np.concatenate([track.thresh, track.kept.thresh])
    order = np.argsort(time_ns, kind="stable")
    return thresh[order[time_ns[order] <= end_ns]]


def _stops(
    tracks: Sequence[Track], kind: MarkType, times_ns: Sequence[int], window_s: float
) -> Callable[[float], bool]:
    """Whether a value would answer marks of type I by stopping all that the parameter decides."""
    near = spans_before(times_ns, window_s)
    return lambda value: kind == "I" and stops_all(tracks, value, near)


def _switches_off(wanted: Wanted, found: Remedy) -> bool:
    """Whether 0 is suggested by the log alone, and often switches such a parameter off."""
    return found.basis not in NAMES and wanted.kind.doubt(0.0).what == "zero"


def _chosen(
    name: str,
    wanted: Sequence[Wanted],
    known: Sequence[KnownValue],
    flown: Sequence[float],
    stops: Callable[[float], bool],
) -> Remedy | None:
    """The remedy by the nearest comparison, and by others that want the same direction.

    Raises:
        NoneBecauseError: only a value that nobody would try would do.
    """
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
    asked = replace(first, lasting=lasts, least=least)
    value, basis, doubt = value_to_try(asked, known, within, stops)
    if value is None:
        if doubt.grade == NOBODY:
            raise NoneBecauseError(f"{doubt.text}: {words(least)}")
        return None
    direction: Direction = "raise" if value > case.present else "lower"
    number = case.number(value)
    why = _why(first.found, basis, lasts, least, len(flown))
    if basis in {"lasting", "growth"} and not holds(lasts, value):
        why = f"{doubt.text or 'one order of magnitude'}; to last it would be {why}"
    elif doubt.words:
        why += f"; this is {doubt.words.rstrip(',')}"
    if against:
        why += "; another comparison of it would want the other direction"
    text = f"{direction} {name} from {show(shown_current(case))} to {exact(number)} ({why})"
    return Remedy(
        name, shown_current(case), direction, number, basis, text, None, first.found.kind,
        first.track.comparison.key, None, doubt=doubt.words.rstrip(","),
    )  # fmt: skip


def _bounds(present: float, rises: bool, flown: Sequence[float]) -> Interval:
    """Between the present value and the nearest one beyond it that was tried and was too much."""
    beyond = [value for value in flown if (value > present) == rises and value != present]
    if rises:
        return Interval(present, min(beyond, default=math.inf))
    return Interval(max(beyond, default=-math.inf), present)


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
