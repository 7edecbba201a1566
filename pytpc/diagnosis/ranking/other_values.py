"""The diagnosis with what is known beside the log: good runs, changes, defaults in the code.

`known_good` says which values are known to be good, `replayed_outcomes` what they would have
changed; both are joined here with what the log says alone (`posterior`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pytpc.base.columns import Floats
from pytpc.diagnosis.ranking.known_good import (
    DEFAULT,
    UNCHANGED,
    KnownGood,
    before_changes,
    of_changes,
    of_defaults,
    of_others,
    of_references,
    of_settings,
)
from pytpc.diagnosis.ranking.mark_evidence import marked
from pytpc.diagnosis.ranking.posterior import Posterior, diagnose_log, softmax
from pytpc.diagnosis.ranking.reach import reach_prior
from pytpc.diagnosis.ranking.replayed_outcomes import UNKNOWN_CHARGE, replayed
from pytpc.diagnosis.ranking.result_streams import ResultStreams
from pytpc.diagnosis.ranking.summarised import with_summarised
from pytpc.diagnosis.results.differences import RunDifferences
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc.static.static_info import StaticInfo

ALONE = 0.5
"""Weight of the log alone beside the replay, which uses the same marks."""

REPLAYED = 0.65
"""Weight of the replay. Both weights are near the likeliest ones on the tuning half of the study,
for one observer, beside one, two or four good runs with other settings, and beside defaults."""

NOBODY = -2.5
"""The score of "none of them" if it is known what differs. With it, of the tuning half's missions
with a wrong parameter, judged by one observer's marks, "none of them" is first in 5 to 10 %, and of
those without one 0 to 4 % accuse somebody (`pytpc.diagnosis.results.suspects.SURE`)."""

FAULTS = 2 / 3
"""The share of faults in the code among the missions of the tuning half in which no parameter is to
blame: six of nine."""

OTHER_CODE = 2.0
"""How much likelier a fault is if the code is not that of any good run: who changed the code has
often changed parameters, too."""

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

    - With the code of the good run, most faults in the code would have shown there. With other
      code, it may have a fault that none of them had.
    - If the values of all parameters are known as well, the cause is one that differs, or something
      around the robot. One of them is to blame, so the fewer could be, the likelier is each. Those
      could be with which decisions shortly before the marks would have come out otherwise.

    Args:
        differences: what differs from good runs; None if there is none.
    """
    if differences is None or differences.code is None:
        return NOBODY
    if not differences.code.is_same:
        return NOBODY + math.log(OTHER_CODE)
    score = NOBODY + math.log(1.0 - FAULTS * (1.0 - HIDDEN))
    candidates = len(differences.unreported)
    candidates += sum(one.turned_near > 0 for one in differences.found)
    if not candidates or not differences.is_complete:
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
    """Judge all parameters by all marks, by what other values would have changed, and by where.

    Args:
        recording: the mission with its marks, of any types or none, and its graph.
        static_info: what the analysis found.
        references: good runs, the last one last; their thresholds count.
        changes: what was changed since the robot worked, newest last; empty if not known. Their
            order does not count, but the oldest change of a parameter has the value that worked.
            With references, too, a parameter is unlikely if either says that it did not change; if
            the references say nothing of it, the changes count. Of several old values, the nearest
            one of a reference counts.
        differences: what differs from the references, for ``nobody``.
    """
    known = _known(recording, static_info, references, changes)
    found = _by_values(recording, static_info, known, changes, nobody(differences))
    return _in_reach(found, recording, static_info)


def diagnose_among(
    recording: Recording, static_info: StaticInfo, others: Sequence[Recording]
) -> Posterior:
    """The same among runs of which nobody says that they went right, at least one.

    What their values would have changed is replayed, and says nothing more.
    """
    here = with_summarised(recording)
    known = of_others(static_info, Tpcs.of(static_info), here, list(map(with_summarised, others)))
    return _in_reach(
        _by_values(recording, static_info, [known], (), NOBODY), recording, static_info
    )


def _in_reach(found: Posterior, recording: Recording, static_info: StaticInfo) -> Posterior:
    """The diagnosis with what the graph says of who could have done it."""
    prior = reach_prior(recording, static_info, Tpcs.of(static_info))
    return found if not prior.any() else _with_prior(found, prior)


def _with_prior(found: Posterior, prior: Floats) -> Posterior:
    """The diagnosis with more log odds for each parameter, float64[p]."""
    weights = found.posterior * np.exp(prior)
    total = float(weights.sum()) + found.none
    return replace(
        found,
        scores=found.scores + prior,
        posterior=weights / total,
        none=found.none / total,
    )


def _known(
    recording: Recording,
    static_info: StaticInfo,
    references: Sequence[Recording],
    changes: Sequence[Change],
) -> list[KnownGood]:
    """What the changes and the good runs say of the values, in this order."""
    tpcs = Tpcs.of(static_info)
    here = with_summarised(recording)
    found: list[KnownGood] = []
    if changes:
        old = before_changes(static_info, changes)
        found.append(KnownGood(of_changes(tpcs.names, changes), old))
    if references:
        known = of_references(static_info, tpcs, here, list(map(with_summarised, references)))
        # A text gives thresholds (its length, for example) that another text may give, too.
        texts = [one for one in changes if math.isnan(one.old) or math.isnan(one.new)]
        is_text = of_changes(tpcs.names, texts) == 0.0
        found.append(known._replace(prior=np.where(is_text, np.nan, known.prior)))
    return found


def _by_values(
    recording: Recording,
    static_info: StaticInfo,
    known: Sequence[KnownGood],
    changes: Sequence[Change],
    none_score: float,
) -> Posterior:
    """The diagnosis without the graph."""
    tpcs = Tpcs.of(static_info)
    here = with_summarised(recording)
    default = of_defaults(static_info, tpcs, here)
    anew = of_settings(static_info, tpcs, here)
    found = list(known)
    if found:
        prior = np.fmin.reduce([one.prior for one in found])
        prior[np.isnan(prior)] = UNCHANGED / 2
        prior += np.nan_to_num(default.prior)
    elif default.others or anew.others:
        prior = np.where(np.isnan(default.prior), _unknown(default.prior), default.prior)
        found.append(default)
    else:
        # If all have their defaults, these tell nobody from anybody else.
        return diagnose_log(recording, static_info)
    # What is known to have kept its value was not set, whatever the thresholds do.
    kept = found[0].prior == UNCHANGED if changes else np.zeros(prior.size, np.bool_)
    prior = np.where(np.isnan(anew.prior) | kept, prior, anew.prior)
    others = {key: value for one in (*found, anew) for key, value in one.others.items()}
    same = frozenset(key for one in found for key in one.same) - others.keys()
    return diagnose_replayed(recording, static_info, KnownGood(prior, others, same), none_score)


def unheard(recording: Recording, streams: ResultStreams) -> frozenset[int]:
    """The columns of parameters that were compared while their nodes were set up only.

    Args:
        recording: with its marks, at least one.
        streams: of the recording.
    """
    first_s = float(marked(recording.marks, streams).firsts.min())
    return streams.only_at_set_up(first_s)


def _unknown(prior: Floats) -> float:
    """The log odds of a parameter without a default, if it differs as often as the others do."""
    known = prior[~np.isnan(prior)]
    differs = (1.0 + np.count_nonzero(known == 0.0)) / (2.0 + known.size)
    return math.log(differs + (1.0 - differs) * math.exp(DEFAULT))


def diagnose_replayed(
    recording: Recording,
    static_info: StaticInfo,
    known: KnownGood,
    none_score: float = NOBODY,
) -> Posterior:
    """The diagnosis of `pytpc.diagnosis.ranking.posterior` with what the replay says.

    Args:
        recording: the mission with its marks.
        static_info: what the analysis found.
        known: the prior, without a nan, and the other thresholds.
        none_score: that of "none of them".
    """
    alone = diagnose_log(recording, static_info)
    if not np.isfinite(alone.scores).any():
        return alone
    prior, tpcs = known.prior, Tpcs.of(static_info)
    found = replayed(recording, static_info, known.others, known.same)
    charges = np.array([found.get(name, math.nan) for name in alone.names])
    # What kept its value, or its default, has no other threshold.
    unknown = np.where(prior > DEFAULT, UNKNOWN_CHARGE, 0.0)
    charges = np.where(np.isnan(charges), unknown, charges)
    by_log = alone.scores.copy()
    # What was decided at the set-up holds all mission long, and the log has no word of it.
    silent = sorted(unheard(recording, ResultStreams.of(with_summarised(recording), tpcs)))
    by_log[silent] = np.maximum(by_log[silent], -math.log(np.isfinite(by_log).sum()))
    charges[silent] = np.maximum(charges[silent], unknown[silent])
    scores = ALONE * by_log + REPLAYED * charges + prior
    posterior, none = softmax(scores, none_score)
    return replace(alone, scores=scores, posterior=posterior, none=none)
