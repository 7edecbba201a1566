"""The methods that the study compares, by the names that its tables have."""

from __future__ import annotations

from collections.abc import Mapping

from pytpc_evaluation.study.case import Method
from pytpc_evaluation.study.methods.importance import importance
from pytpc_evaluation.study.methods.ours import (
    GoodRuns,
    tpc,
    tpc_changes,
    tpc_log,
    tpc_other_defaults,
    tpc_reference,
    tpc_where,
)
from pytpc_evaluation.study.methods.plain import (
    by_chance,
    differs_at_random,
    largest_change,
    recent_change,
    turned_decisions,
)
from pytpc_evaluation.study.methods.thesis import thesis, thesis_doubt

METHODS: Mapping[str, Method] = {
    "thesis": thesis,
    "thesis-doubt": thesis_doubt,
    "importance": importance,
    "recent-change": recent_change,
    "largest-change": largest_change,
    "turned-decisions": turned_decisions,
    "differs-at-random": differs_at_random,
    "random": by_chance,
    "tpc-log": tpc_log,
    "tpc": tpc,
    "tpc-other-defaults": tpc_other_defaults,
    "tpc+where": tpc_where,
    "tpc+1-run": GoodRuns(1),
    "tpc+2-runs": GoodRuns(2),
    "tpc+4-runs": GoodRuns(4),
    "tpc+2-runs+where": GoodRuns(2, where=True),
    "tpc+reference": tpc_reference,
    "tpc+changes": tpc_changes,
}
"""In the order of the tables: baselines first."""
