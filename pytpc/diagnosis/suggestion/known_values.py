"""Values of a parameter that are known to be good, whatever the log says."""

from __future__ import annotations

import numpy as np

from pytpc.base.errors import InputError
from pytpc.base.wording import Number
from pytpc.diagnosis.question import Source
from pytpc.diagnosis.results.advice import KnownValue
from pytpc.diagnosis.suggestion.suggestion_case import SuggestionCase, case_of, shown_current
from pytpc.diagnosis.suggestion.suggestion_evidence import NoneBecauseError, SuggestionEvidence
from pytpc.diagnosis.thresholds.replay import tracks_of
from pytpc.diagnosis.thresholds.units import NoUnitError
from pytpc.recording.mission import Recording
from pytpc.static.link_unit import Default
from pytpc.static.static_info import StaticInfo

NAMES: dict[Source, str] = {
    "reference": "the value of the clean run",
    "default": "the default in the source",
    "declared": "the declared default",
}
"""How each kind of evidence is called, the strongest first."""


def known_values(
    case: SuggestionCase, static_info: StaticInfo, parameter: str, reference: Recording | None
) -> list[KnownValue]:
    """Those that there are, the strongest evidence first.

    A good run has shown that its value does; a default is what its author thought would; one that
    is declared may hold for other robots, too.

    Args:
        case: the parameter at one of its comparisons.
        static_info: what the analysis found, of the reference's build, too.
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
    """The value that a parameter last had in a mission; None where the log does not say."""
    try:
        _, tracks, _ = tracks_of(recording.events, recording.summaries, static_info, parameter)
    except InputError:
        return None
    for track in tracks:
        seen = np.concatenate([track.kept.thresh, track.thresh])
        seen = seen[np.isfinite(seen)]
        if not seen.size:
            continue
        found, nothing = track.comparison, np.zeros(0)
        evidence = SuggestionEvidence(
            nothing, nothing, float(seen[-1]), seen, bool(len(track.kept))
        )
        try:
            return shown_current(case_of(found, static_info.unit_of(found.key), evidence, None))
        except (NoneBecauseError, NoUnitError):
            continue
    return None
