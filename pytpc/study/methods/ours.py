"""The diagnosis of `pytpc.scoring.diagnosis`, alone and with what may be known beside the log."""

from __future__ import annotations

from pytpc.scoring.diagnosis import Diagnosis, diagnose
from pytpc.scoring.diagnosis_priors import of_changes, of_reference
from pytpc.scoring.tables import Tpcs
from pytpc.study.case import Case, Verdict


def tpc(case: Case) -> Verdict:
    """From the log and the marks alone."""
    return verdict(diagnose(case.recording, case.static_info))


def tpc_reference(case: Case) -> Verdict:
    """With the thresholds of a clean run, where there is one."""
    if case.reference is None:
        return tpc(case)
    tpcs = Tpcs.of(case.static_info)
    prior = of_reference(tpcs, case.recording.events, case.reference.events)
    return verdict(diagnose(case.recording, case.static_info, prior=prior))


def tpc_changes(case: Case) -> Verdict:
    """With the history of changes, where it is known; their order says nothing."""
    changes = [(change.parameter, change.old, change.new) for change in case.changes]
    prior = of_changes(Tpcs.of(case.static_info).names, changes)
    return verdict(diagnose(case.recording, case.static_info, prior=prior))


def verdict(found: Diagnosis) -> Verdict:
    """The order, and the posterior of the first as the confidence; 0 where there is nobody."""
    order = found.order
    return Verdict(
        tuple(found.names[n] for n in order),
        float(found.posterior[order[0]]) if order else 0.0,
        tuple(float(found.scores[n]) for n in order),
    )
