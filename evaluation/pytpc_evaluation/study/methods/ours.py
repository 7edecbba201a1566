"""The diagnosis that users get, alone and with what may be known beside the log."""

from __future__ import annotations

from pytpc.diagnosis.ranking.other_values import diagnose_beside
from pytpc.diagnosis.ranking.posterior import Posterior
from pytpc_evaluation.study.case import Case, Verdict


def tpc(case: Case) -> Verdict:
    """From the log and the marks alone."""
    return verdict(diagnose_beside(case.recording, case.static_info))


def tpc_reference(case: Case) -> Verdict:
    """With the thresholds of a good run, where there is one, and what they would have changed."""
    return verdict(diagnose_beside(case.recording, case.static_info, references=case.references))


def tpc_changes(case: Case) -> Verdict:
    """With the history of changes, where it is known, and what the old values would have changed.

    The order of the changes says nothing.
    """
    return verdict(diagnose_beside(case.recording, case.static_info, changes=case.changes))


def verdict(found: Posterior) -> Verdict:
    """The order, and the posterior of the first as the confidence; 0 where there is nobody."""
    order = found.order
    return Verdict(
        tuple(found.names[n] for n in order),
        float(found.posterior[order[0]]) if order else 0.0,
        tuple(float(found.scores[n]) for n in order),
    )
