"""The diagnosis that users get, alone and with what may be known beside the log."""

from __future__ import annotations

from dataclasses import dataclass

from pytpc.diagnosis.ranking.other_values import diagnose_beside
from pytpc.diagnosis.ranking.posterior import Posterior, diagnose_log
from pytpc_evaluation.study.case import Case, Verdict


def tpc(case: Case) -> Verdict:
    """From the log, the marks and the static information, defaults in the code among it."""
    return verdict(diagnose_beside(case.recording, case.static_info))


def tpc_log(case: Case) -> Verdict:
    """The same without the defaults."""
    return verdict(diagnose_log(case.recording, case.static_info))


def tpc_where(case: Case) -> Verdict:
    """With what the observer says of where it was wrong."""
    return verdict(diagnose_beside(case.with_places, case.static_info))


@dataclass(frozen=True, slots=True)
class GoodRuns:
    """With so many good runs that have other settings than the mission and each other.

    ``where``: the marks say where it was wrong.
    """

    count: int
    where: bool = False

    def __call__(self, case: Case) -> Verdict:
        """Judge a mission."""
        recording = case.with_places if self.where else case.recording
        good = case.good[: self.count]
        return verdict(diagnose_beside(recording, case.static_info, references=good))


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
        found.none,
    )
