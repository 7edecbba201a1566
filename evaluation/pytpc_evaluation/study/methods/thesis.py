"""The thesis's ranking, joined over the marks as its table 6.16 does: by the mean rank.

A parameter without a score at a mark has rank 0 there. Marks without a type are ranked by both.
"""

from __future__ import annotations

import numpy as np

from pytpc.diagnosis.question import Question, Types
from pytpc.diagnosis.ranking.mark_ranking import rank_marks
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc_evaluation.study.case import Case, Verdict

_DIGITS = 12
"""Mean ranks that differ by rounding only are tied."""


def thesis(case: Case) -> Verdict:
    """The thesis's: the types of the marks are believed."""
    return mean_rank(case, "believe")


def thesis_doubt(case: Case) -> Verdict:
    """The same scores, the types doubted by table 6.13."""
    return mean_rank(case, "doubt")


def mean_rank(case: Case, types: Types) -> Verdict:
    """The parameters by their mean rank over all marks; those that have 0 at each are left out."""
    names = Tpcs.of(case.static_info).names
    rankings = rank_marks(case.recording, case.static_info, Question(types=types))
    sums = dict.fromkeys(names, 0.0)
    for ranking in rankings:
        for suspect in ranking.suspects:
            sums[suspect.parameter] += suspect.rank
    means = {name: round(total / len(rankings), _DIGITS) for name, total in sums.items() if total}
    order = sorted(means, key=lambda name: (-means[name], name))
    return Verdict(tuple(order), scores=tuple(np.array([means[name] for name in order]).tolist()))
