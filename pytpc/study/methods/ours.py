"""The diagnosis of `pytpc.scoring.diagnosis`, alone and with what may be known beside the log."""

from __future__ import annotations

from pytpc.advice.other_values import before_changes, diagnose_replayed, of_clean_run
from pytpc.scoring.diagnosis import Diagnosis, diagnose
from pytpc.scoring.diagnosis_priors import of_changes, of_reference
from pytpc.scoring.tables import Tpcs
from pytpc.study.case import Case, Verdict


def tpc(case: Case) -> Verdict:
    """From the log and the marks alone."""
    return verdict(diagnose(case.recording, case.static_info))


def tpc_reference(case: Case) -> Verdict:
    """With the thresholds of a clean run, where there is one, and what they would have changed."""
    if case.reference is None:
        return tpc(case)
    tpcs = Tpcs.of(case.static_info)
    events, clean = case.recording.events, case.reference.events
    prior, others = of_reference(tpcs, events, clean), of_clean_run(tpcs, events, clean)
    return verdict(diagnose_replayed(case.recording, case.static_info, prior, others))


def tpc_changes(case: Case) -> Verdict:
    """With the history of changes, where it is known, and what the old values would have changed.

    The order of the changes says nothing.
    """
    changes = [(change.parameter, change.old, change.new) for change in case.changes]
    old = [(change.parameter, change.old) for change in case.changes]
    prior = of_changes(Tpcs.of(case.static_info).names, changes)
    if not changes:
        return tpc(case)
    others = before_changes(case.static_info, old)
    return verdict(diagnose_replayed(case.recording, case.static_info, prior, others))


def verdict(found: Diagnosis) -> Verdict:
    """The order, and the posterior of the first as the confidence; 0 where there is nobody."""
    order = found.order
    return Verdict(
        tuple(found.names[n] for n in order),
        float(found.posterior[order[0]]) if order else 0.0,
        tuple(float(found.scores[n]) for n in order),
    )
