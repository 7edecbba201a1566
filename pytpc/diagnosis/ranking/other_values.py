"""The diagnosis with what is known beside the log: good runs, and what was changed.

`known_good` says which values are known to be good, `replayed_outcomes` what they would have
changed; both are joined here with what the log says alone (`posterior`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from pytpc.base.columns import Floats
from pytpc.diagnosis.ranking.known_good import (
    UNCHANGED,
    before_changes,
    of_changes,
    of_good_run,
    of_references,
)
from pytpc.diagnosis.ranking.posterior import Posterior, diagnose_log, softmax
from pytpc.diagnosis.ranking.replayed_outcomes import replayed
from pytpc.diagnosis.ranking.summarised import with_summarised
from pytpc.diagnosis.results.differences import RunDifferences
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc.static.static_info import StaticInfo

ALONE = 0.2
"""Weight of the log alone beside the replay, which uses the same marks."""

REPLAYED = 1.0
"""Weight of the replay. Both weights, and ``NOBODY``, maximise the likelihood of the true cause on
the tuning half of the study, whose missions have eight large harmless changes each."""

NOBODY = -0.4
"""The score of "none of them" if it is known what differs. The likeliest value is lower; with -0.4
no clean mission and no fault in the code of the tuning half is blamed on a parameter."""

FAULTS = 2 / 3
"""The share of faults in the code among the missions of the tuning half in which no parameter is to
blame: six of nine."""

HIDDEN = 0.2
"""The share of faults that a good run of the same code does not show, as other input or another
order of events brings them about. Of the faults of three open-source systems 72 to 87 % did not
depend on anything around the program (Chandra and Chen, Whither generic recovery from application
faults?, DSN 2000)."""

CANDIDATES = 6
"""How many parameters could be the cause in a mission of the study, with which ``NOBODY`` was
chosen: 2 to 6 that differ turn decisions shortly before the marks, and 2 to 5 that differ are
reported by no comparison. (Six is the mean of seven missions of one robot.)"""


def nobody(differences: RunDifferences | None) -> float:
    """The score of "none of them", by what is known to be as it was in a good run.

    - With the code of the good run, most faults in the code would have shown there.
    - If the values of all parameters are known as well, the cause is one that differs, or something
      around the robot. One of them is to blame, so the fewer could be, the likelier is each. Those
      could be with which decisions shortly before the marks would have come out otherwise.

    Args:
        differences: what differs from good runs; None if there is none.
    """
    if differences is None or differences.code is None or not differences.code.is_same:
        return NOBODY
    score = NOBODY + math.log(1.0 - FAULTS * (1.0 - HIDDEN))
    candidates = sum(one.turned_near > 0 for one in differences.found)
    if not candidates or not differences.is_complete or differences.unreported:
        return score
    return score + min(0.0, math.log(candidates / CANDIDATES))


def diagnose_beside(
    recording: Recording,
    static_info: StaticInfo,
    *,
    references: Sequence[Recording] = (),
    changes: Sequence[Change] = (),
    differences: RunDifferences | None = None,
) -> Posterior:
    """Judge all parameters by all marks, and by what the other values would have changed.

    Args:
        recording: the mission with its marks, of any types or none.
        static_info: what the analysis found.
        references: good runs, the last one last; their thresholds count.
        changes: what was changed since the robot worked, newest last; empty if not known. Their
            order does not count, but the oldest change of a parameter has the value that worked.
            With references, too, a parameter is unlikely if either says that it did not change; if
            the references say nothing of it, the changes count. Old values come from the changes
            first.
        differences: what differs from the references, for ``nobody``.
    """
    tpcs = Tpcs.of(static_info)
    priors, others = [], {}
    if references:
        here, good = with_summarised(recording), [with_summarised(run) for run in references]
        priors.append(of_references(tpcs, here, good))
        for there in good:
            others.update(of_good_run(tpcs, here, there))
    if changes:
        priors.append(of_changes(tpcs.names, changes))
        # The last value for a parameter counts.
        oldest_last = [(one.parameter, one.old) for one in reversed(changes)]
        others.update(before_changes(static_info, oldest_last))
    if not priors:
        return diagnose_log(recording, static_info)
    prior = np.fmin.reduce(priors)
    prior[np.isnan(prior)] = UNCHANGED / 2
    return diagnose_replayed(recording, static_info, prior, others, nobody(differences))


def diagnose_replayed(
    recording: Recording,
    static_info: StaticInfo,
    prior: Floats,
    others: Mapping[str, float],
    none_score: float = NOBODY,
) -> Posterior:
    """The diagnosis of `pytpc.diagnosis.ranking.posterior` with what the replay says.

    Args:
        recording: the mission with its marks.
        static_info: what the analysis found.
        prior: float64[p], see `pytpc.diagnosis.ranking.known_good`.
        others: the other thresholds that are known, by the key of the comparison.
        none_score: that of "none of them".
    """
    alone = diagnose_log(recording, static_info)
    if not np.isfinite(alone.scores).any():
        return alone
    found = replayed(recording, static_info, others)
    charges = np.array([found.get(name, 0.0) for name in alone.names])
    scores = ALONE * alone.scores + REPLAYED * charges + prior
    posterior, none = softmax(scores, none_score)
    return replace(alone, scores=scores, posterior=posterior, none=none)
