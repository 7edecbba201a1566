"""The diagnosis of `pytpc.scoring.diagnosis`, alone and with what may be known beside the log."""

from __future__ import annotations

from pytpc.scoring.diagnosis import Diagnosis, diagnose
from pytpc.study.case import Case, Verdict


def tpc(case: Case) -> Verdict:
    """From the log and the marks alone."""
    return verdict(diagnose(case.recording, case.static_info))


def tpc_reference(case: Case) -> Verdict:
    """With a clean run."""
    return tpc(case)


def tpc_changes(case: Case) -> Verdict:
    """With the history of changes."""
    return tpc(case)


def verdict(found: Diagnosis) -> Verdict:
    """The order and the posterior of the first."""
    order = found.order
    return Verdict(
        tuple(found.names[n] for n in order),
        float(found.posterior[order[0]]) if order else 0.0,
        tuple(float(found.scores[n]) for n in order),
    )
