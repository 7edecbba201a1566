"""The values of a parameter that are known to be good, and what is known of its kind."""

from __future__ import annotations

import numpy as np

from pytpc.base.columns import Floats
from pytpc.base.errors import InputError
from pytpc.base.wording import Number
from pytpc.diagnosis.question import Question, Source
from pytpc.diagnosis.results.advice import KnownValue
from pytpc.diagnosis.suggestion.kinds_by_name import kinds_by_name
from pytpc.diagnosis.suggestion.plausible import ParameterKind, Shown, spread_of
from pytpc.diagnosis.suggestion.suggestion_case import (
    NoneBecauseError,
    SuggestionCase,
    SuggestionEvidence,
    case_of,
    shown_current,
)
from pytpc.diagnosis.thresholds.replay import Track, tracks_of
from pytpc.diagnosis.thresholds.units import NoUnitError
from pytpc.recording.declaration import Declared
from pytpc.recording.mission import Recording
from pytpc.static.link_unit import Default
from pytpc.static.parameters import parameter_name
from pytpc.static.static_info import StaticInfo


def kind_of(
    case: SuggestionCase, recording: Recording, static_info: StaticInfo, question: Question
) -> ParameterKind:
    """What is known of a parameter at one of its comparisons.

    Of the known good values only those count that the question's ``sources`` allow.
    """
    name, key = parameter_name(case.comparison), case.comparison.key
    reference = question.reference if "reference" in question.sources else None

    def look() -> Shown:
        known = known_values(case, static_info, name, reference)
        return Shown(
            tuple(one.value for one in known if one.source in question.sources),
            None if reference is None else spread_of(reference, key),
            spread_of(recording, key),
        )

    return ParameterKind(
        case.present, case.possible.interval, kinds_by_name(name), look, case.how.forward
    )


def case_of_track(
    track: Track, seen: Floats, static_info: StaticInfo, declared: Declared | None
) -> SuggestionCase:
    """The case of a comparison whose thresholds were ``seen``; see `case_of`."""
    nothing = np.zeros(0)
    evidence = SuggestionEvidence(nothing, nothing, float(seen[-1]), seen, bool(len(track.kept)))
    unit = static_info.unit_of(track.comparison.key)
    return case_of(track.comparison, unit, evidence, declared)


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
    return [*found, *_numbers(case.comparison.default, case.possible.declared)]


def defaults(
    static_info: StaticInfo, parameter: str, declared: Declared | None
) -> list[KnownValue]:
    """The default of a parameter in the source, and the declared one."""
    own = (one for one in static_info.thresholds.values() if parameter_name(one) == parameter)
    given = (one.default for one in own if one.default is not None)
    return _numbers(next(given, None), declared)


def _numbers(default: Default, declared: Declared | None) -> list[KnownValue]:
    found: list[tuple[Source, Default]] = [
        ("default", default),
        ("declared", None if declared is None else declared.default),
    ]
    return [
        KnownValue(source, float(value))
        for source, value in found
        if value is not None and not isinstance(value, str)
    ]


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
            return shown_current(case_of_track(track, seen, static_info, None))
        except (NoneBecauseError, NoUnitError):
            continue
    return None
