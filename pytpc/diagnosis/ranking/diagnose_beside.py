"""The diagnosis with what is known beside the log: a good run, or a list of changes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pytpc.diagnosis.ranking.other_values import before_changes, diagnose_replayed, of_good_run
from pytpc.diagnosis.ranking.posterior import Posterior, diagnose_log
from pytpc.diagnosis.ranking.priors import of_changes, of_reference
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc.static.static_info import StaticInfo


def diagnose_beside(
    recording: Recording,
    static_info: StaticInfo,
    *,
    reference: Recording | None = None,
    changes: Sequence[Change] = (),
) -> Posterior:
    """Judge all parameters by all marks, and by what the other values would have changed.

    Args:
        recording: the mission with its marks, of any types or none.
        static_info: what the analysis found.
        reference: a good run, whose thresholds are looked at; None where there is none.
        changes: what was changed since the robot went right, newest last, empty where that is not
            known. Their order says nothing; of several changes of one parameter the oldest has the
            value with which the robot went right. Beside a reference, what either of them says is
            as it was is unlikely; the values of before are taken from the changes first.
    """
    tpcs = Tpcs.of(static_info)
    priors, others = [], {}
    if reference is not None:
        events, clean = recording.events, reference.events
        priors.append(of_reference(tpcs, events, clean))
        others.update(of_good_run(tpcs, events, clean))
    if changes:
        priors.append(of_changes(tpcs.names, changes))
        # The last of them counts there.
        oldest_last = [(one.parameter, one.old) for one in reversed(changes)]
        others.update(before_changes(static_info, oldest_last))
    if not priors:
        return diagnose_log(recording, static_info)
    return diagnose_replayed(recording, static_info, np.min(priors, axis=0), others)
